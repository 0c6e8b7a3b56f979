"""Compute the cases, check them, write them.

    python generate.py                 every case
    python generate.py 03 14           cases whose name begins so
    python generate.py --verify        compute again and compare with the files
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np

from break_points import break_points
from case_list import all_cases
from method_of_steps import solve
from problem import phase_starts, reference_of

FOLDER = Path(__file__).parent / "cases"
SELF_LIMIT = 1e-9
JITCDDE_LIMIT = 1e-7
ENERGY_LIMIT = 1e-9


def sample_times(problem):
    """About twenty times, some of them on and just after break-points."""
    end = problem["end_s"]
    even = [end * k / 12 for k in range(13)]
    breaks = [t for t, _ in break_points(problem, 1) if 0.0 < t < end]
    chosen = [breaks[round(x)] for x in np.linspace(0, len(breaks) - 1, 4)] if breaks else []
    times = {round(t, 12) for t in even}
    for b in chosen:
        times |= {b, b + 1e-3}
    times = sorted(t for t in times if t <= end)
    return [t for k, t in enumerate(times) if k == 0 or t - times[k - 1] > 1e-6]


def reference_rows(loop, y, asked, i):
    """What a reader compares: z, z', .., z^(l-1), or z and dz of the baseline, whose filter is its own affair."""
    if loop.kind == "backstepping":
        return [asked[0][i].tolist(), asked[1][i].tolist()]
    return loop.unpack(y)[0][2:, i].tolist()


def samples(problem, times, states, loop, asked):
    per_agent = [{"q": [], "dq": [], "reference": [], "theta_hat": [], "V": [],
                  "dissipation": []} for _ in range(loop.n)]
    for y, wanted in zip(states, asked):
        motion, theta_hat, dissipation = loop.unpack(y)
        V = loop.storage(y, wanted[0])
        for i, rows in enumerate(per_agent):
            rows["q"].append(motion[0, i].tolist())
            rows["dq"].append(motion[1, i].tolist())
            rows["reference"].append(reference_rows(loop, y, wanted, i))
            rows["theta_hat"].append(theta_hat[i, : loop.sizes[i]].tolist())
            rows["V"].append(float(V[i]))
            rows["dissipation"].append(float(dissipation[i]))
    return {"times_s": times, "agents": per_agent}


def by_agent(states, loop):
    """The order of the other solver: agent after agent, without dissipation."""
    rows = []
    for y in states:
        motion, theta_hat, _ = loop.unpack(y)
        rows.append(np.concatenate([
            np.concatenate([motion[:, i].ravel(), theta_hat[i, : loop.sizes[i]]])
            for i in range(loop.n)]))
    return np.array(rows)


def largest(difference):
    return float(np.abs(difference).max())


def shortest_constant_delay(problem):
    phases = phase_starts(problem["schedule"], problem["end_s"])
    return min((e["delay"]["s"] for _, edges in phases for e in edges
                if e["delay"]["kind"] == "constant" and e["delay"]["s"] > 0), default=1.0)


def agreement(problem, times, states, loop, asked):
    """How far other computations of the same case are from this one."""
    from jitcdde_check import Check

    shortest = shortest_constant_delay(problem)
    finer, _, asked_finer = solve(problem, times, rtol=5e-14, atol=5e-15, generations=3,
                     longest_step=min(0.007, 0.7 * shortest))
    found = {"halved_tolerances": largest(finer - states)}

    if reference_of(problem)["kind"] == "backstepping":
        # Its z jumps and its dz is not the derivative of z, so nothing balances.
        found["halved_tolerances"] = max(found["halved_tolerances"], *(
            largest(np.array(a) - np.array(b)) for a, b in zip(asked_finer, asked)))
    else:
        energy = np.array([loop.storage(y, z) + loop.unpack(y)[2]
                           for y, (z, _) in zip(states, asked)])
        found["energy_balance"] = largest(energy - energy[0])

    # Below the shortest delay: with longer steps jitcdde extrapolates.
    check, step = Check(problem), min(2.5e-4, shortest / 2)
    coarse, fine = check.run(times, step), check.run(times, step / 2)
    mine = by_agent(states, loop)
    found["jitcdde"] = {
        "step_s": step / 2,
        "at_this_step": largest(fine - mine),
        "extrapolated": largest((8 * fine - coarse) / 7 - mine),
    }
    return found


def rows_on_lines(value, indent=1):
    """JSON with innermost lists kept on one line."""
    pad = " " * indent
    if isinstance(value, dict):
        parts = [f"{pad}{json.dumps(k)}: {rows_on_lines(v, indent + 1)}" for k, v in value.items()]
        one_line = json.dumps(value)
        if len(one_line) < 100:
            return one_line
        return "{\n" + ",\n".join(parts) + "\n" + pad[1:] + "}"
    if isinstance(value, list) and len(json.dumps(value)) >= 100:
        parts = [pad + rows_on_lines(v, indent + 1) for v in value]
        return "[\n" + ",\n".join(parts) + "\n" + pad[1:] + "]"
    return json.dumps(value, allow_nan=False)


def generate(problem):
    times = sample_times(problem)
    states, loop, asked = solve(problem, times)
    found = agreement(problem, times, states, loop, asked)
    kept = True
    for label, value, limit in (
            ("halved tolerances", found["halved_tolerances"], SELF_LIMIT),
            ("energy balance", found.get("energy_balance", 0.0), ENERGY_LIMIT),
            ("jitcdde", found["jitcdde"]["extrapolated"], JITCDDE_LIMIT)):
        if not value <= limit:
            print(f"  {label}: {value:.1e} exceeds {limit:.0e}")
            kept = False
    case = problem | {"samples": samples(problem, times, states, loop, asked), "agreement": found}
    path = FOLDER / f"{problem['name']}.json"
    if kept:
        path.write_text(rows_on_lines(case) + "\n")
    return found, kept


def verify(problem):
    stored = json.loads((FOLDER / f"{problem['name']}.json").read_text())
    for key in problem:
        if stored[key] != json.loads(json.dumps(problem[key])):
            print(f"  {key} has changed")
            return None, False
    times = stored["samples"]["times_s"]
    states, loop, asked = solve(problem, times)
    again = samples(problem, times, states, loop, asked)
    difference = max(
        largest(np.array(a[key]) - np.array(b[key]))
        for a, b in zip(again["agents"], stored["samples"]["agents"]) for key in a)
    return {"difference": difference}, difference <= SELF_LIMIT


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="beginnings of names; all cases if none")
    parser.add_argument("--verify", action="store_true", help="compare with the files")
    arguments = parser.parse_args()
    good = True
    for problem in all_cases():
        if arguments.names and not problem["name"].startswith(tuple(arguments.names)):
            continue
        began = time.time()
        found, kept = (verify if arguments.verify else generate)(problem)
        good &= kept
        print(f"{problem['name']}: {json.dumps(found)} in {time.time() - began:.0f} s", flush=True)
    raise SystemExit(0 if good else 1)


if __name__ == "__main__":
    main()
