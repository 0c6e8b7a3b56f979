"""Writes drives.json: what Pinocchio and MuJoCo make of rotors, damping and dry friction.

    python3 -m venv venv
    venv/bin/pip install -r requirements.txt
    venv/bin/python generate.py

`robots`: shipped robots with an armature and a damping at every joint. For random q, dq, tau:
    mass      M(q) + A, by Pinocchio
    ddq       solves (M + A) ddq = tau - C dq - g - D dq, by Pinocchio
MuJoCo reads the same files, and must find the same numbers to 1e-9 before anything is written.

`friction`: one joint with an armature and MuJoCo's `frictionloss`, which is a soft constraint: it lets a joint that sticks
creep by fractions of a millimetre. A block on rails that slides and stops, one that is pushed by 2 t N, and a pendulum that
swings until it sticks beside its lowest point.
"""

import json
import pathlib

import mujoco
import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).resolve().parent
ROBOTS = HERE.parent.parent / "crates" / "io" / "robots"
STATES = 6
STEP_S = 2e-5
EVERY_S = 0.05
MASS_KG, ARMATURE, FRICTION = 2.0, 0.1, 3.0

ONE = """<mujoco><option timestep="{step}" gravity="0 0 -9.81" integrator="implicit" iterations="200" tolerance="1e-14"/>
<worldbody><body>
  <joint name="j" type="{kind}" axis="{axis}" armature="{armature}" frictionloss="{friction}"
         solreffriction="{ref} 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"/>
  <inertial pos="{at}" mass="{mass}" diaginertia="0.03 0.05 0.04"/>
</body></worldbody></mujoco>"""


def of_mujoco(file, joints, armature, damping):
    text = file.read_text().replace(
        "</robot>", '<mujoco><compiler discardvisual="true" balanceinertia="false"/></mujoco></robot>'
    )
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    order = [model.jnt_dofadr[mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)] for name in joints]
    assert model.nv == len(joints)
    model.dof_armature[order], model.dof_damping[order] = armature, damping
    data = mujoco.MjData(model)

    def at(q, dq, tau):
        data.qpos[order], data.qvel[order], data.qfrc_applied[order] = q, dq, tau
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        return mass[np.ix_(order, order)], data.qacc[order].copy()

    return at


def robot(name, rng):
    file = ROBOTS / f"{name}.urdf"
    model = pin.buildModelFromUrdf(str(file))
    joints = list(model.names)[1:]
    armature = np.round(rng.uniform(0.02, 0.8, model.nv), 3)
    damping = np.round(rng.uniform(0.1, 2.0, model.nv), 3)
    # One joint without either.
    armature[2], damping[1] = 0.0, 0.0
    model.armature = armature
    data, other = model.createData(), of_mujoco(file, joints, armature, damping)
    states = []
    for _ in range(STATES):
        q, dq, tau = rng.uniform(-2.0, 2.0, (3, model.nv))
        mass = np.array(pin.crba(model, data, q))
        mass = np.triu(mass) + np.triu(mass, 1).T
        ddq = np.array(pin.aba(model, data, q, dq, tau - damping * dq))
        for ours, theirs in zip((mass, ddq), other(q, dq, tau)):
            apart = np.max(np.abs(ours - theirs)) / np.max(np.abs(ours))
            assert apart < 1e-9, (name, apart)
        state = {"q": q, "dq": dq, "tau": tau, "mass": mass.ravel(), "ddq": ddq}
        states.append({key: value.tolist() for key, value in state.items()})
    return {"robot": name, "joints": joints, "armature": armature.tolist(), "damping": damping.tolist(), "states": states}


def one(kind, axis, at, start, speed, force, end_s):
    text = ONE.format(
        step=STEP_S, kind=kind, axis=axis, at=at, armature=ARMATURE, friction=FRICTION, mass=MASS_KG, ref=4 * STEP_S
    )
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = start, speed
    rows, every = [], round(EVERY_S / STEP_S)
    for step in range(round(end_s / STEP_S) + 1):
        if step % every == 0:
            rows.append([data.qpos[0], data.qvel[0]])
        data.qfrc_applied[0] = force * (step + 0.5) * STEP_S
        mujoco.mj_step(model, data)
    return {"start": start, "speed": speed, "ramp_per_s": force, "rows": rows}


def main():
    rng = np.random.default_rng(31)
    document = {
        "pinocchio": pin.__version__,
        "mujoco": mujoco.__version__,
        "robots": [robot(name, rng) for name in ("ur5e", "panda")],
        "friction": {
            "every_s": EVERY_S,
            "block": one("slide", "1 0 0", "0 0 0", 0.0, 1.2, 0.0, 2.0),
            "pushed": one("slide", "1 0 0", "0 0 0", 0.0, 0.0, 2.0, 4.0),
            "pendulum": one("hinge", "0 -1 0", "0.6 0 0", 0.3, 0.0, 0.0, 4.0),
        },
    }
    (HERE / "drives.json").write_text(json.dumps(document, indent=1) + "\n")


if __name__ == "__main__":
    main()
