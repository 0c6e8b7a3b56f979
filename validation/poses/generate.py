"""Writes poses.json: where Pinocchio finds the tool of the scenario pose-ur5e, how it turns, and how far it is from a desired pose.

    python3 -m venv venv
    venv/bin/pip install -r requirements.txt
    venv/bin/python generate.py

A point 0.15 m along the axis of the flange `tool0` of the shipped UR5e. For random q, dq and a random desired pose:
    position      of the point in coordinates of the base
    jacobian      rows of the velocity of the point, then of the angular velocity, both in coordinates of the base
    rate          its derivative by the time along dq
    desired       the desired position and quaternion, vector part first
    error         the difference of the positions, then sin(angle/2) times the axis of R R_dᵀ by its matrix logarithm
    scalar        cos(angle/2)
The derivative is held against differences of the Jacobian before anything is written.
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).resolve().parent
ROBOT = HERE.parent.parent / "crates" / "io" / "robots" / "ur5e.urdf"
TOOL = np.array([0.0, 0.0, 0.15])
STATES = 12
ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


def main():
    model = pin.buildModelFromUrdf(str(ROBOT))
    flange = model.frames[model.getFrameId("tool0")]
    placement = flange.placement * pin.SE3(np.eye(3), TOOL)
    tip = model.addFrame(pin.Frame("tip", flange.parentJoint, placement, pin.FrameType.OP_FRAME))
    data = model.createData()
    rng = np.random.default_rng(20260801)

    def jacobian(q):
        return np.array(pin.computeFrameJacobian(model, data, q, tip, ALIGNED))

    states = []
    for _ in range(STATES):
        q, dq = rng.uniform(-2.5, 2.5, (2, model.nv))
        desired = rng.normal(size=4)
        desired /= np.linalg.norm(desired)
        wanted = rng.uniform(-0.6, 0.6, 3)
        pin.computeJointJacobiansTimeVariation(model, data, q, dq)
        pin.updateFramePlacements(model, data)
        rate = np.array(pin.getFrameJacobianTimeVariation(model, data, tip, ALIGNED))
        placed = pin.SE3(data.oMf[tip])
        h = 1e-6
        differences = (jacobian(q + h * dq) - jacobian(q - h * dq)) / (2 * h)
        assert np.max(np.abs(differences - rate)) < 1e-7, np.max(np.abs(differences - rate))
        turned = placed.rotation @ pin.Quaternion(desired[3], *desired[:3]).toRotationMatrix().T
        log = pin.log3(turned)
        angle = np.linalg.norm(log)
        vector = np.sin(angle / 2) * log / angle
        state = {
            "q": q,
            "dq": dq,
            "position": placed.translation,
            "jacobian": jacobian(q).ravel(),
            "rate": rate.ravel(),
            "desired": np.concatenate([wanted, desired]),
            "error": np.concatenate([placed.translation - wanted, vector]),
            "scalar": np.array(np.cos(angle / 2)),
        }
        states.append({key: value.tolist() for key, value in state.items()})
    text = json.dumps({"pinocchio": pin.__version__, "states": states}, indent=1)
    (HERE / "poses.json").write_text(text + "\n")


main()
