"""Writes pinocchio.json: what Pinocchio makes of the shipped robots and of tree.urdf.

    python -m venv /tmp/validation-urdf
    /tmp/validation-urdf/bin/pip install -r requirements.txt
    /tmp/validation-urdf/bin/python generate.py

For random q, dq, z, dz, tau:
    mass      M(q)
    gravity   g(q)
    torque    M dz + C(q, dq) z + g + D z, with the Coriolis matrix of Christoffel symbols
    ddq       solves M ddq = tau - C dq - g - D dq
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).resolve().parent
ROBOTS = HERE.parent.parent / "crates" / "io" / "robots"
CASES = [
    {"name": "ur5e", "file": ROBOTS / "ur5e.urdf", "locked": {}},
    {"name": "panda", "file": ROBOTS / "panda.urdf", "locked": {}},
    {"name": "panda", "file": ROBOTS / "panda.urdf", "locked": {"panda_joint4": -1.5, "panda_joint7": 0.7}},
    {"name": "tree", "file": HERE / "tree.urdf", "locked": {}},
    {"name": "tree", "file": HERE / "tree.urdf", "locked": {"z_slide": 0.2, "a_left": -0.9}},
]
STATES = 8


def reduced(model, locked):
    q = pin.neutral(model)
    ids = []
    for name, value in locked.items():
        joint = model.getJointId(name)
        assert joint < model.njoints, name
        assert model.joints[joint].nq == 1, name
        q[model.joints[joint].idx_q] = value
        ids.append(joint)
    return pin.buildReducedModel(model, ids, q) if ids else model


def configuration(model, angles):
    """Pinocchio keeps a continuous joint as cosine and sine."""
    q = pin.neutral(model)
    for joint in list(model.joints)[1:]:
        x = angles[joint.idx_v]
        if joint.nq == 1:
            q[joint.idx_q] = x
        else:
            q[joint.idx_q : joint.idx_q + 2] = np.cos(x), np.sin(x)
    return q


def case(spec, rng):
    model = reduced(pin.buildModelFromUrdf(str(spec["file"])), spec["locked"])
    assert list(model.gravity.linear) == [0, 0, -9.81]
    data = model.createData()
    damping = np.array(model.damping)
    states = []
    for _ in range(STATES):
        angles, dq, z, dz, tau = rng.uniform(-2.0, 2.0, (5, model.nv))
        q = configuration(model, angles)
        mass = np.array(pin.crba(model, data, q))
        mass = np.triu(mass) + np.triu(mass, 1).T
        coriolis = np.array(pin.computeCoriolisMatrix(model, data, q, dq))
        gravity = np.array(pin.computeGeneralizedGravity(model, data, q))
        states.append(
            {
                "q": angles.tolist(),
                "dq": dq.tolist(),
                "z": z.tolist(),
                "dz": dz.tolist(),
                "tau": tau.tolist(),
                "mass": mass.ravel().tolist(),
                "gravity": gravity.tolist(),
                "torque": (mass @ dz + coriolis @ z + gravity + damping * z).tolist(),
                "ddq": np.array(pin.aba(model, data, q, dq, tau - damping * dq)).tolist(),
            }
        )
    return {
        "robot": spec["name"],
        "locked": spec["locked"],
        "joints": list(model.names)[1:],
        "damping": damping.tolist(),
        "states": states,
    }


def main():
    rng = np.random.default_rng(20)
    document = {"pinocchio": pin.__version__, "cases": [case(spec, rng) for spec in CASES]}
    (HERE / "pinocchio.json").write_text(json.dumps(document, indent=1) + "\n")


if __name__ == "__main__":
    main()
