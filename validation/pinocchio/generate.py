"""Truth for the rigid-body kernels: models, states, and what Pinocchio says about them.

Usage: python generate.py [folder]      (default: fixtures/ beside this file)

A fixture holds models as the links that `Tree::assemble` takes and, for some states of each, the mass matrix M, the
Coriolis matrix C of Christoffel symbols, gravity g, inverse dynamics (rnea), the two-velocity torque M dz + C z + g, the
two-velocity regressor put together from two standard ones, and forward dynamics (aba). Fixed links are lumped by
Pinocchio itself. Floats are written with all their digits; nothing depends on the clock.
"""

import json
import math
import pathlib
import sys

import numpy as np
import pinocchio as pin

GRAVITY = [0.0, 0.0, -9.81]


def link(parent, xyz, rpy, kind, axis, mass, com, inertia_com):
    """One link; `inertia_com` is [xx, xy, yy, xz, yz, zz] about the centre of mass."""
    xx, xy, yy, xz, yz, zz = inertia_com
    inertia = pin.Inertia(mass, np.array(com), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    rotation = pin.rpy.rpyToMatrix(*rpy)
    return {
        "parent": parent,
        "rotation": [list(map(float, row)) for row in rotation],
        "translation": list(map(float, xyz)),
        "kind": kind,
        "axis": list(map(float, axis)),
        "inertia": list(map(float, inertia.toDynamicParameters())),
    }


Z = (0.0, 0.0, 1.0)
QUARTER = math.pi / 2


def ur5e_like():
    chain = [
        ((0, 0, 0.1625), (0, 0, 0), 3.761, (0, -0.02561, 0.00193), (0.010267, 0, 0.010267, 0, 0, 0.00666)),
        ((0, 0, 0), (QUARTER, 0, 0), 8.058, (-0.2125, 0, 0.11336), (0.0151, 0, 0.13389, 0, 0, 0.13389)),
        ((-0.425, 0, 0), (0, 0, 0), 2.846, (-0.24225, 0, 0.0265), (0.0040, 0, 0.03121, 0, 0, 0.03121)),
        ((-0.3922, 0, 0.1333), (0, 0, 0), 1.37, (0, -0.01634, -0.0018), (0.00256, 0, 0.00256, 0, 0, 0.00219)),
        ((0, -0.0997, 0), (QUARTER, 0, 0), 1.3, (0, 0.01634, -0.0018), (0.00256, 0, 0.00256, 0, 0, 0.00219)),
        ((0, 0.0996, 0), (QUARTER, math.pi, math.pi), 0.365, (0, 0, -0.001159), (9.9e-5, 0, 9.9e-5, 0, 0, 1.321e-4)),
    ]
    return [
        link(None if i == 0 else i - 1, xyz, rpy, "revolute", Z, mass, com, inertia)
        for i, (xyz, rpy, mass, com, inertia) in enumerate(chain)
    ]


def panda_like():
    q = QUARTER
    chain = [
        ((0, 0, 0.333), (0, 0, 0), 4.97, (0.003875, 0.002081, -0.04762), (0.7034, -0.00014, 0.70661, 0.00677, 0.01917, 0.00912)),
        ((0, 0, 0), (-q, 0, 0), 0.6469, (-0.003141, -0.02872, 0.003495), (0.00796, -0.00393, 0.02811, 0.01025, 0.0007, 0.02600)),
        ((0, -0.316, 0), (q, 0, 0), 3.2286, (0.02752, 0.03925, -0.0665), (0.03724, -0.00476, 0.03616, -0.0114, -0.01281, 0.01083)),
        ((0.0825, 0, 0), (q, 0, 0), 3.5879, (-0.05317, 0.10442, 0.02745), (0.02585, 0.0078, 0.01955, -0.00133, 0.00864, 0.02832)),
        ((-0.0825, 0.384, 0), (-q, 0, 0), 1.2259, (-0.01195, 0.04107, -0.03844), (0.03555, -0.00212, 0.02947, -0.00404, 0.00023, 0.00863)),
        ((0, 0, 0), (q, 0, 0), 1.6666, (0.06015, -0.01412, -0.01052), (0.00196, 0.00011, 0.00435, -0.00116, 0.00034, 0.00543)),
        ((0.088, 0, 0), (q, 0, 0), 0.7355, (0.01052, -0.00425, 0.0616), (0.01252, -0.00043, 0.01003, -0.0012, -0.00074, 0.00482)),
    ]
    links = [
        link(None if i == 0 else i - 1, xyz, rpy, "revolute", Z, mass, com, inertia)
        for i, (xyz, rpy, mass, com, inertia) in enumerate(chain)
    ]
    # A flange that does not move: to be lumped into the seventh body.
    links.append(link(6, (0, 0, 0.107), (0, 0, 0.3), "fixed", Z, 0.4, (0.01, 0.02, 0.03), (1e-3, 1e-4, 2e-3, 0, -1e-4, 1.5e-3)))
    return links


def pendulum():
    return [link(None, (0.1, -0.2, 0.3), (0.4, 0.5, -0.6), "revolute", (0, 1, 0), 1.5, (0.1, 0.2, -0.3), (0.02, 0.001, 0.03, -0.002, 0.003, 0.04))]


def two_axes():
    return [
        link(None, (0, 0, 0), (0, 0, 0), "fixed", Z, 5.0, (0, 0, 0.1), (0.1, 0, 0.1, 0, 0, 0.1)),
        link(0, (0, 0.1, 0.5), (-QUARTER, 0, 0), "revolute", (0, 0, -1), 2.0, (0.25, 0, 0.02), (0.002, 0, 0.05, 0, 0, 0.05)),
        link(1, (0.5, 0, 0), (0, 0.2, 0), "revolute", (1, 0, 0), 1.0, (0.2, 0.1, 0), (0.01, 0.001, 0.02, 0, 0, 0.02)),
    ]


def random_tree(seed, joints, branching, prismatic, tilted, fixed):
    """`joints` moving links and some fixed ones; the shares say how many branch, slide, and have axes off x, y, z.

    A branch starts at an ancestor of the last link: Pinocchio wants the joints of a subtree to be neighbours.
    """
    rng = np.random.default_rng(seed)
    links, moving = [], 0
    while moving < joints:
        parent = None
        if links:
            parent = len(links) - 1
            if rng.random() < branching:
                path = [parent]
                while links[path[-1]]["parent"] is not None:
                    path.append(links[path[-1]]["parent"])
                parent = path[rng.integers(0, len(path))]
        held = links and rng.random() < fixed
        kind = "fixed" if held else "prismatic" if rng.random() < prismatic else "revolute"
        axis = np.zeros(3)
        if rng.random() < tilted:
            axis = rng.normal(size=3)
            axis /= np.linalg.norm(axis)
        else:
            axis[rng.integers(0, 3)] = rng.choice([-1.0, 1.0])
        mass = float(np.exp(rng.uniform(-1.5, 1.5)))
        # Second moments of a random cloud: any positive definite matrix is one, so the inertia is physical.
        a = rng.normal(size=(3, 3)) * 0.15
        cloud = mass * (a @ a.T + 1e-3 * np.eye(3))
        i = np.trace(cloud) * np.eye(3) - cloud
        inertia_com = (i[0, 0], i[0, 1], i[1, 1], i[0, 2], i[1, 2], i[2, 2])
        links.append(
            link(parent, rng.normal(size=3) * 0.3, rng.uniform(-3, 3, size=3), kind, axis, mass, rng.normal(size=3) * 0.1, inertia_com)
        )
        moving += kind != "fixed"
    return links


def joint_model(kind, axis):
    for k, letter in enumerate("XYZ"):
        if axis[k] == 1.0:
            return getattr(pin, f"JointModel{'R' if kind == 'revolute' else 'P'}{letter}")()
    unaligned = pin.JointModelRevoluteUnaligned if kind == "revolute" else pin.JointModelPrismaticUnaligned
    return unaligned(np.array(axis))


def build(links):
    return build_held(links)[0]


def build_held(links):
    """The model and, for every link, the joint that carries it and the placement of the link in it."""
    model = pin.Model()
    model.gravity.linear = np.array(GRAVITY)
    held = []
    for k, spec in enumerate(links):
        joint, x_joint_parent = (0, pin.SE3.Identity()) if spec["parent"] is None else held[spec["parent"]]
        x = x_joint_parent * pin.SE3(np.array(spec["rotation"]), np.array(spec["translation"]))
        inertia = pin.Inertia.FromDynamicParameters(np.array(spec["inertia"]))
        if spec["kind"] == "fixed":
            model.appendBodyToJoint(joint, inertia, x)
            held.append((joint, x))
        else:
            joint = model.addJoint(joint, joint_model(spec["kind"], spec["axis"]), x, f"joint_{k}")
            model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
            held.append((joint, pin.SE3.Identity()))
    return model, held


def state(model, rng, with_regressor):
    n = model.nv
    data = model.createData()
    q, dq, z, dz, tau = (rng.uniform(-scale, scale, size=n) for scale in (3.0, 2.0, 2.0, 5.0, 10.0))
    zero = np.zeros(n)
    m = pin.crba(model, data, q).copy()
    m = np.triu(m) + np.triu(m, 1).T
    c = pin.computeCoriolisMatrix(model, data, q, dq).copy()
    g = pin.computeGeneralizedGravity(model, data, q).copy()
    rnea = pin.rnea(model, data, q, dq, dz).copy()
    out = {
        "q": q, "dq": dq, "z": z, "dz": dz, "tau": tau,
        "mass_matrix": m.ravel(), "coriolis_matrix": c.ravel(), "gravity": g, "rnea": rnea,
        "two_velocity": m @ dz + c @ z + g,
        "aba": pin.aba(model, data, q, dq, tau).copy(),
    }
    if with_regressor:
        plus = pin.computeJointTorqueRegressor(model, data, q, (dq + z) / 2, dz).copy()
        weight = model.gravity.linear.copy()
        model.gravity.linear = np.zeros(3)
        minus = pin.computeJointTorqueRegressor(model, data, q, (dq - z) / 2, zero).copy()
        model.gravity.linear = weight
        out["regressor"] = (plus - minus).ravel()
    return {key: [float(x) for x in value] for key, value in out.items()}


def fixture(name, links, states, seed, with_regressor=True):
    model = build(links)
    rng = np.random.default_rng(seed)
    return {
        "name": name,
        "gravity": GRAVITY,
        "links": links,
        "theta": [float(x) for k in range(1, model.njoints) for x in model.inertias[k].toDynamicParameters()],
        "states": [state(model, rng, with_regressor) for _ in range(states)],
    }


FILES = {
    "arms.json": lambda: [
        fixture("ur5e-like", ur5e_like(), 2, 1),
        fixture("panda-like", panda_like(), 2, 2),
    ],
    "trees.json": lambda: [
        fixture("pendulum", pendulum(), 2, 3),
        fixture("two axes on a fixed base link", two_axes(), 2, 4),
        fixture("sliding chain", random_tree(11, 5, 0.0, 0.6, 0.0, 0.0), 1, 5),
        fixture("branched, axes along x, y, z", random_tree(12, 8, 0.5, 0.2, 0.0, 0.2), 1, 6),
        fixture("branched, any axes", random_tree(13, 9, 0.6, 0.3, 0.7, 0.2), 1, 7),
        fixture("32 joints", random_tree(14, 32, 0.3, 0.15, 0.4, 0.15), 1, 8, with_regressor=False),
    ],
}


def main():
    here = pathlib.Path(__file__).resolve().parent
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "fixtures"
    folder.mkdir(parents=True, exist_ok=True)
    for name, models in FILES.items():
        text = json.dumps({"pinocchio": pin.__version__, "models": models()}, separators=(",", ":"))
        (folder / name).write_text(text.replace('},{"parent"', '},\n{"parent"').replace(',"mass', ',\n"mass') + "\n")


if __name__ == "__main__":
    main()
