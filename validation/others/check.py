"""Robots that other people wrote, in forwardstep and in Pinocchio.

    cargo build --release
    python check.py                    compare, and print where table.md differs
    python check.py --write            compare, and write table.md

Every URDF of the package example-robot-data goes through the program itself,
`forwardstep robot FILE.urdf --at STATE.json --json`, at random states:

    M        the mass matrix
    g        gravity
    tau      M dz + C(q, dq) z + g, with the Coriolis matrix of Christoffel symbols
    ddq      solves M ddq + C(q, dq) dq + g = tau

Exits with 1 when the program crashes, a number is too far from Pinocchio's, a
file is refused that Pinocchio has a use for, or a file fares otherwise than in
table.md.
"""

import argparse
import importlib.metadata
import json
import re
import subprocess
import tempfile
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent
TABLE = HERE / "table.md"
BINARY = HERE.parent.parent / "target" / "release" / "forwardstep"
PACKAGE = "example-robot-data"

STATES = 5
TIMEOUT_S = 60
# Differences over max(1, the largest number).
TOLERANCE = 1e-11
# Two exact methods differ in ddq by rounding times the condition of M.
ROUNDING = 1e-15
# A mass matrix whose least eigenvalue is this small beside the largest has no inverse.
SINGULAR = 1e-13


class Crash(Exception):
    """The program ended in a way that it never should."""


class Refused(Exception):
    """The program says why it does not take a file."""


@dataclass
class Row:
    file: str
    status: str = ""
    joints: str = ""
    locked: list = field(default_factory=list)
    friction: bool = False
    damping: bool = False
    mimics: int = 0
    errors: dict = field(default_factory=dict)
    condition: float = 0.0
    note: str = ""
    faults: list = field(default_factory=list)


# ---------------------------------------------------------------- the program

def forwardstep(binary, folder, *arguments):
    """What the program prints as JSON."""
    command = [str(binary), "robot", *arguments, "--json"]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired as late:
        raise Crash(f"no answer in {TIMEOUT_S} s") from late
    if done.returncode not in (0, 2) or "panicked" in done.stderr:
        raise Crash(f"status {done.returncode}: {done.stderr.strip()[:300]}")
    if done.returncode == 2:
        raise Refused(one_line(done.stderr))
    return json.loads(done.stdout)


def one_line(stderr):
    """The problem, without the excerpt of the file below it."""
    problem = next((line for line in stderr.splitlines() if line.strip().startswith("×")), None)
    if problem is None:
        raise Crash(f"status 2 without a problem: {stderr.strip()[:300]}")
    return re.sub(r"^.*\.urdf:(\d+:\d+:)? ?", "", problem.strip().removeprefix("×").strip())


# ---------------------------------------------------------------- states

def random_range(model, joint):
    """Where a joint with one degree of freedom may be drawn from."""
    if joint.nq == 2:
        return -np.pi, np.pi
    low, high = model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q]
    if not low <= high or not np.isfinite(high - low):
        return -np.pi, np.pi
    return max(low, -2 * np.pi), min(high, 2 * np.pi)


def random_state(model, rng):
    q = np.array([rng.uniform(*random_range(model, joint)) for joint in list(model.joints)[1:]])
    return (q, *rng.uniform(-2.0, 2.0, (3, model.nv)))


def configuration(model, q):
    """Pinocchio keeps a continuous joint as cosine and sine."""
    full = pin.neutral(model)
    for joint in list(model.joints)[1:]:
        x = q[joint.idx_v]
        if joint.nq == 1:
            full[joint.idx_q] = x
        else:
            full[joint.idx_q : joint.idx_q + 2] = np.cos(x), np.sin(x)
    return full


# ---------------------------------------------------------------- comparison

def distance(got, truth, size):
    """The largest difference, over `size`."""
    got, truth = np.asarray(got, dtype=float), np.asarray(truth, dtype=float)
    if got.shape != truth.shape or not np.isfinite(got).all():
        return np.inf
    return float(np.abs(got - truth).max() / size)


def at_least_one(numbers):
    return max(1.0, np.abs(numbers).max())


def mass_matrix(model, data, q):
    mass = np.array(pin.crba(model, data, q))
    return np.triu(mass) + np.triu(mass, 1).T


def compare_state(model, answer, state):
    """Errors of the four quantities, what is left of the equation of motion, and the condition of M.

    `tiny` judges M, g and tau once more for robots whose numbers are all far
    below one: over the largest entry of M, and over what adds up to tau.
    """
    data = model.createData()
    angles, dq, z, dz = state
    q = configuration(model, angles)
    mass = mass_matrix(model, data, q)
    coriolis = np.array(pin.computeCoriolisMatrix(model, data, q, dq))
    gravity = np.array(pin.computeGeneralizedGravity(model, data, q))
    torque = mass @ dz + coriolis @ z + gravity
    ddq = np.array(pin.aba(model, data, q, dq, torque))
    got = np.array(answer["ddq"])
    left = mass @ got + coriolis @ dq + gravity
    forces = (np.abs(mass) @ np.abs(dz) + np.abs(coriolis) @ np.abs(z) + np.abs(gravity)).max()
    forces_of_ddq = (np.abs(mass) @ np.abs(got) + np.abs(coriolis) @ np.abs(dq) + np.abs(gravity)).max()
    errors = {
        "M": distance(answer["M"], mass, at_least_one(mass)),
        "g": distance(answer["g"], gravity, at_least_one(gravity)),
        "tau": distance(answer["tau"], torque, at_least_one(torque)),
        "ddq": distance(got, ddq, at_least_one(ddq)),
        "residual": distance(left, answer["tau"], forces_of_ddq),
        "tiny": max(distance(answer["M"], mass, np.abs(mass).max()), distance(answer["g"], gravity, forces),
                    distance(answer["tau"], torque, forces)),
    }
    return errors, float(np.linalg.cond(mass))


def compare(row, binary, folder, model):
    """Fills the row of a file that loads; `row.locked` holds (joint, value)."""
    locks = [word for name, value in row.locked for word in ("--lock", f"{name}={value!r}")]
    described = forwardstep(binary, folder, row.file, *locks, "--ignore-friction")
    names = list(model.names)[1:]
    joints = [joint["name"] for joint in described["joints"]]
    row.joints = str(len(joints))
    if joints != names:
        row.faults.append(f"{row.file}: the joints are {joints}, but Pinocchio has {names}")
        return
    # What a file adds to the rigid bodies is left out on both sides.
    row.friction = any(joint["friction"] for joint in described["joints"])
    row.damping = bool(np.any(np.array(model.damping) != 0.0))
    row.mimics = sum("mimic" in notice for notice in described["notices"])
    assert not np.any(model.armature), row.file
    assert list(model.gravity.linear) == [0, 0, -9.81], row.file

    rng = np.random.default_rng(zlib.crc32(row.file.encode()))
    for _ in range(STATES):
        state = random_state(model, rng)
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump({name: dict(zip(("q", "dq", "z", "dz"), map(float, numbers)))
                       for name, *numbers in zip(names, *state)}, file)
            file.flush()
            answer = forwardstep(binary, folder, row.file, *locks, "--at", file.name)
        errors, condition = compare_state(model, answer, state)
        row.condition = max(row.condition, condition)
        for quantity, error in errors.items():
            row.errors[quantity] = max(row.errors.get(quantity, 0.0), error)
    for quantity, error in row.errors.items():
        allowed = max(TOLERANCE, ROUNDING * row.condition) if quantity == "ddq" else TOLERANCE
        if not error <= allowed:
            row.faults.append(f"{row.file}: {quantity} differs by {error:.1e}, allowed are {allowed:.1e}")


def reduced(model, locked):
    """The model without the locked joints."""
    q = pin.neutral(model)
    ids = []
    for name, value in locked:
        joint = model.getJointId(name)
        q[model.joints[joint].idx_q] = value
        ids.append(joint)
    return pin.buildReducedModel(model, ids, q)


# ---------------------------------------------------------------- files

def read(path):
    """Pinocchio's model; joints that mimic others are free, as they are in forwardstep."""
    try:
        return pin.buildModelFromUrdf(str(path), mimic=False)
    except Exception as error:  # Boost hands out whatever it likes
        return f"{type(error).__name__}"


def least_eigenvalue(model):
    """Beside the largest, over random states."""
    rng = np.random.default_rng(0)
    data = model.createData()
    values = [np.linalg.eigvalsh(mass_matrix(model, data, configuration(model, random_state(model, rng)[0])))
              for _ in range(STATES)]
    return min(float(v[0] / v[-1]) for v in values)


def examine_refusal(row, binary, folder, model, reason):
    """Was it right to refuse?  Robots with joints that carry nothing load once those are locked."""
    row.status = "refused"
    row.note = reason
    if isinstance(model, str):
        row.note += "; Pinocchio refuses it, too"
        return
    if model.nv == 0:
        row.note += "; nothing moves in Pinocchio either"
        return
    if least_eigenvalue(model) <= SINGULAR:
        row.note += "; M is singular in Pinocchio, too"
    else:
        row.faults.append(f"{row.file}: refused, but M can be inverted")
        return
    while (named := re.search(r"mass matrix is not positive definite: joint `([^`]+)`", reason)) is not None:
        row.locked.append((named[1], 0.0))
        locks = [word for name, value in row.locked for word in ("--lock", f"{name}={value!r}")]
        try:
            forwardstep(binary, folder, row.file, *locks, "--ignore-friction")
        except Refused as refused:
            reason = str(refused)
            continue
        compare(row, binary, folder, reduced(model, row.locked))
        return
    row.faults.append(f"{row.file}: with {row.locked} locked: {reason}")


def examine(file, binary, folder):
    row = Row(file)
    try:
        model = read(folder / file)
        try:
            forwardstep(binary, folder, file)
        except Refused as refused:
            try:
                forwardstep(binary, folder, file, "--ignore-friction")
                if "Coulomb friction" not in str(refused):
                    row.faults.append(f"{file}: {refused}")
            except Refused as refused:
                examine_refusal(row, binary, folder, model, str(refused))
                return row
        row.status = "loads"
        if isinstance(model, str):
            row.joints = "?"
            row.note = f"Pinocchio refuses it: {model}"
            row.faults.append(f"{file}: {row.note}")
            return row
        compare(row, binary, folder, model)
    except Crash as crash:
        row.status = "crashed"
        row.note = str(crash)
        row.faults.append(f"{file}: {crash}")
    return row


def files_of_the_package():
    distribution = importlib.metadata.distribution(PACKAGE)
    found = sorted(str(f) for f in distribution.files if str(f).endswith(".urdf"))
    root = "share/example-robot-data/robots/"
    folder = Path(distribution.locate_file(found[0][: found[0].index(root) + len(root)]))
    return distribution.version, folder, [f[f.index(root) + len(root) :] for f in found]


# ---------------------------------------------------------------- the table

def number(value):
    return f"{value:.0e}"


def line(row):
    errors = [number(row.errors[q]) if q in row.errors else "" for q in ("M", "g", "tau", "ddq", "residual")]
    remarks = []
    if row.friction:
        remarks.append("friction left out")
    if row.damping:
        remarks.append("damping left out")
    if row.mimics:
        remarks.append(f"{row.mimics} mimicking joint{'s' if row.mimics > 1 else ''} left free")
    if row.note:
        remarks.insert(0, row.note)
    if row.locked and row.errors:
        count = len(row.locked)
        names = ", ".join(f"`{name}`" for name, _ in row.locked)
        remarks.append(f"compared with {count} joint{'s' if count > 1 else ''} locked at 0: {names}")
    condition = number(row.condition) if row.errors else ""
    text = "; ".join(remarks).replace("|", "\\|")
    return f"| {row.file} | {row.status} | {row.joints} | {' | '.join(errors)} | {condition} | {text} |"


def table(rows, version):
    compared = [row for row in rows if row.errors]
    worst = {q: max((row.errors[q] for row in compared), default=0.0) for q in ("M", "g", "tau", "ddq", "residual", "tiny")}
    count = lambda status: sum(row.status == status for row in rows)
    largest = max((int(row.joints) for row in compared), default=0)
    return "\n".join([
        f"# {len(rows)} robots that other people wrote",
        "",
        f"{PACKAGE} {version} through forwardstep, beside Pinocchio {pin.__version__}; written by `check.py --write`, "
        "explained in [README.md](README.md).",
        "",
        f"**{count('loads')} load, {count('refused')} are refused, {count('crashed')} crash.** {len(compared)} were "
        f"compared at {STATES} states each, up to {largest} joints; worst errors: M {number(worst['M'])}, "
        f"g {number(worst['g'])}, tau {number(worst['tau'])}, ddq {number(worst['ddq'])}, "
        f"residual {number(worst['residual'])}. Over the size of each robot's own numbers M, g and tau differ by "
        f"{number(worst['tiny'])} at most.",
        "",
        "| File | Status | Joints | M | g | tau | ddq | Residual | Condition of M | Remarks |",
        "|---|---|--:|--:|--:|--:|--:|--:|--:|---|",
        *map(line, rows),
        "",
    ])


def fates(text):
    """File, status, joints and remarks of every row: what must not change unnoticed."""
    rows = [line.strip("|").split(" | ") for line in text.splitlines() if line.startswith("| ")]
    return {row[0].strip(): (row[1], row[2], row[-1].strip()) for row in rows if row[0].strip() != "File"}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", type=Path, default=BINARY, help="the forwardstep to try")
    parser.add_argument("--write", action="store_true", help="write table.md instead of comparing with it")
    arguments = parser.parse_args()
    version, folder, files = files_of_the_package()
    rows = []
    for file in files:
        rows.append(examine(file, arguments.binary.resolve(), folder))
        print(line(rows[-1]), flush=True)
    text = table(rows, version)
    print("\n" + next(line for line in text.splitlines() if line.startswith("**")))

    faults = [fault for row in rows for fault in row.faults]
    if arguments.write:
        TABLE.write_text(text)
    else:
        before, now = fates(TABLE.read_text()), fates(text)
        faults += [f"{file}: table.md says {before.get(file)}, now {now.get(file)}"
                   for file in sorted(before.keys() | now.keys()) if before.get(file) != now.get(file)]
    for fault in faults:
        print(f"fault: {fault}")
    raise SystemExit(1 if faults else 0)


if __name__ == "__main__":
    main()
