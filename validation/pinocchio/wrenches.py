"""Truth for forces on links: J^T w, and where a point of a link is and how it moves, for the models of generate.py.

Usage: python wrenches.py [folder]      (default: fixtures/ beside this file)

A case names a model of the other fixtures and one of its links, a point in the frame of that link, and a force and a moment
whose components refer to the base ("base") or to the link ("link"). Every link of every model has a case, those that are
lumped into others too.
"""

import json
import pathlib
import sys

import numpy as np
import pinocchio as pin

import generate


def case(name, model, held, link, axes, rng):
    joint, x_joint_link = held[link]
    at, force, moment = (rng.uniform(-scale, scale, size=3) for scale in (0.5, 30.0, 5.0))
    frame = model.addFrame(pin.Frame(f"point_{model.nframes}", joint, 0, x_joint_link * pin.SE3(np.eye(3), at), pin.OP_FRAME))
    q, dq = rng.uniform(-3, 3, size=model.nv), rng.uniform(-2, 2, size=model.nv)
    data = model.createData()
    # With one joint only, numpy drops a dimension.
    base, link_axes = (
        pin.computeFrameJacobian(model, data, q, frame, axes).reshape(6, model.nv).copy()
        for axes in (pin.LOCAL_WORLD_ALIGNED, pin.LOCAL)
    )
    jacobian = base if axes == "base" else link_axes
    pin.framesForwardKinematics(model, data, q)
    numbers = {
        "at": at, "force": force, "moment": moment, "q": q, "dq": dq,
        "tau": jacobian.T @ np.concatenate([force, moment]),
        "position": data.oMf[frame].translation, "velocity": base[:3] @ dq,
    }
    return {"model": name, "link": link, "axes": axes} | {key: [float(x) for x in value] for key, value in numbers.items()}


def cases():
    rng = np.random.default_rng(21)
    for models in generate.FILES.values():
        for model in models():
            pinocchio, held = generate.build_held(model["links"])
            for link in range(len(held)):
                yield case(model["name"], pinocchio, held, link, ("base", "link")[link % 2], rng)


def main():
    here = pathlib.Path(__file__).resolve().parent
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "fixtures"
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"pinocchio": pin.__version__, "cases": list(cases())}, separators=(",", ":"))
    (folder / "wrenches.json").write_text(text.replace('},{"model"', '},\n{"model"') + "\n")


if __name__ == "__main__":
    main()
