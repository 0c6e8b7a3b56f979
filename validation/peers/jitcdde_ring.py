"""A ring of robots in jitcdde: time per simulated second, and error.

    python jitcdde_ring.py --agents 16 --model linear --end 20

Agent i hears agent i - 1 with weight 1 after 0.1 + 0.3 (i mod 7) / 7 seconds,
positions and velocities exchanged, reference of order one with alpha = 1,
K = 8, at rest at first.
  linear: point masses of 1 kg on a line that know their mass, q_i(0) = sin i;
  arms:   two-link arms (rods of 1 m and 1 kg, gravity 9.81), adaptive with
          Gamma = 10 from theta_hat(0) = 0, q_i(0) = (sin i, cos i).

Prints one line of JSON.  The error is the largest in q and dq of any agent at
the sampled times, against ../trajectories' solver at a tolerance of 1e-10.
"""

import argparse
import importlib.metadata
import json
import math
import platform
import statistics
import sys
import time
from pathlib import Path

import numpy as np
from jitcdde import jitcdde, t, y
from symengine import Symbol, cos, sin

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "trajectories"))
from method_of_steps import solve  # noqa: E402
from problem import agent, constant, edge, fixed, planar_arm, point_mass, problem  # noqa: E402

# jitcdde sorts helpers recursively, one level for each.
sys.setrecursionlimit(100_000)

TOLERANCE = 1e-6
REFERENCE_TOLERANCE = 1e-10
K, GAMMA, ALPHA = 8.0, 10.0, 1.0


def ring_problem(model, count, end):
    if model == "linear":
        agents = [agent(point_mass(1, 1.0), [ALPHA], K=K, knows_theta=True, q=[math.sin(i)])
                  for i in range(count)]
    else:
        arm = planar_arm((1.0, 1.0), (1.0, 1.0))
        agents = [agent(arm, [ALPHA], K=K, Gamma=GAMMA, q=[math.sin(i), math.cos(i)])
                  for i in range(count)]
    edges = [edge((i - 1) % count, i, 1.0, constant(heard_after(i))) for i in range(count)]
    return problem(f"ring-{model}-{count}", __doc__, end, "position_velocity", agents,
                   fixed(edges))


def heard_after(i):
    return 0.1 + 0.3 * (i % 7) / 7


def sampled_times(end):
    early = [0.5, 1.0, 1.5]
    return [s for s in early if s < end] + [float(s) for s in range(2, math.ceil(end), 2)] + [end]


def rounded(values):
    return [float(f"{v:.12g}") for v in values.ravel()]


def reference(model, count, end):
    """{times_s, q, dq}, from a file if there is one."""
    path = HERE / "references" / f"{model}-{count}-{end:g}s.json"
    if path.exists():
        return json.loads(path.read_text())
    times = sampled_times(end)
    states, loop, _ = solve(ring_problem(model, count, end), times,
                         rtol=REFERENCE_TOLERANCE, atol=REFERENCE_TOLERANCE)
    motions = [loop.unpack(state)[0] for state in states]
    result = {
        "model": model, "agents": count, "end_s": end, "tolerance": REFERENCE_TOLERANCE,
        "times_s": times,
        "q": [rounded(motion[0]) for motion in motions],
        "dq": [rounded(motion[1]) for motion in motions],
    }
    path.parent.mkdir(exist_ok=True)
    lines = ",\n".join(f" {json.dumps(k)}: {json.dumps(v)}" for k, v in result.items())
    path.write_text("{\n" + lines + "\n}\n")
    return result


# ---------------------------------------------------------------- equations

def linear_ring(count):
    """Per agent q, dq, z."""
    f = []
    for i in range(count):
        q, dq, z = (y(3 * i + c) for c in range(3))
        sender, then = 3 * ((i - 1) % count), t - heard_after(i)
        dz = -ALPHA * dq - (dq + ALPHA * q - y(sender + 1, then) - ALPHA * y(sender, then))
        f += [dq, dz - K * (dq - z), dz]
    return f, (), np.array([v for i in range(count) for v in (math.sin(i), 0.0, 0.0)])


def arm_ring(count):
    """Per agent q, dq, z (two each) and five estimates.  Expressions used more
    than once are helpers, which jitcdde computes once per call: seven to nine
    times faster than without."""
    arm = planar_arm((1.0, 1.0), (1.0, 1.0))
    th1, th2, th3, th4, th5 = arm["theta"]
    f, helpers, start = [], [], []

    def name(label, expression):
        symbol = Symbol(label)
        helpers.append((symbol, expression))
        return symbol

    for i in range(count):
        base, sender = 11 * i, 11 * ((i - 1) % count)
        then = t - heard_after(i)
        q1, q2, v1, v2, z1, z2 = (y(base + c) for c in range(6))
        estimate = [y(base + 6 + c) for c in range(5)]
        c2, s2 = name(f"c2_{i}", cos(q2)), name(f"s2_{i}", sin(q2))
        c1, c12 = name(f"c1_{i}", cos(q1)), name(f"c12_{i}", cos(q1 + q2))
        w1, w2 = (
            name(f"w{axis + 1}_{i}",
                 -ALPHA * v - (v + ALPHA * q - y(sender + 2 + axis, then)
                               - ALPHA * y(sender + axis, then)))
            for axis, (q, v) in enumerate([(q1, v1), (q2, v2)]))
        row1 = [w1, w2, name(f"y13_{i}", c2 * (2 * w1 + w2) - s2 * (v2 * z1 + (v1 + v2) * z2)),
                c1, c12]
        row2 = [0, name(f"y22_{i}", w1 + w2), name(f"y23_{i}", c2 * w1 + s2 * v1 * z1), 0, c12]
        e1, e2 = name(f"e1_{i}", v1 - z1), name(f"e2_{i}", v2 - z2)
        tau1 = sum(a * b for a, b in zip(row1, estimate)) - K * e1
        tau2 = sum(a * b for a, b in zip(row2, estimate)) - K * e2
        f1 = name(f"f1_{i}", tau1 + th3 * s2 * (2 * v1 + v2) * v2 - th4 * c1 - th5 * c12)
        f2 = name(f"f2_{i}", tau2 - th3 * s2 * v1 * v1 - th5 * c12)
        m11, m12 = name(f"m11_{i}", th1 + 2 * th3 * c2), name(f"m12_{i}", th2 + th3 * c2)
        scale = name(f"scale_{i}", 1 / (m11 * th2 - m12 * m12))
        f += [v1, v2, scale * (th2 * f1 - m12 * f2), scale * (m11 * f2 - m12 * f1), w1, w2]
        f += [-GAMMA * (a * e1 + b * e2) for a, b in zip(row1, row2)]
        start += [math.sin(i), math.cos(i)] + [0.0] * 9
    return f, helpers, np.array(start)


# ---------------------------------------------------------------- measurement

def run(solver, start, times):
    """States at the times, and thread CPU seconds.

    The derivative jumps at t = 0; `adjust_diff` sets it right and leaves the
    images of the jump to the step size control.  Against that, on 16 linear
    agents: `step_on_discontinuities` of jitcdde 1.8.3 costs the same, but with
    seven delays adds each to the time reached so far, so it lands on none but
    the first and only returns at 1.6 s, their sum, past the early samples;
    landing on the seven images with `integrate_blindly` costs a little more
    for the same error.
    """
    solver.purge_past()
    solver.constant_past(start, time=0.0)
    solver.set_integration_parameters(rtol=TOLERANCE, atol=TOLERANCE)
    solver.t  # builds the integrator, outside the measured time
    began = time.thread_time()
    solver.adjust_diff()
    states = [solver.integrate(s) for s in times]
    return np.array(states), time.thread_time() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--agents", type=int, required=True)
    parser.add_argument("--model", choices=["linear", "arms"], required=True)
    parser.add_argument("--end", type=float, default=20.0)
    parser.add_argument("--repeats", type=int, default=7)
    arguments = parser.parse_args()

    f, helpers, start = (linear_ring if arguments.model == "linear" else arm_ring)(arguments.agents)
    delays = sorted({0.0} | {heard_after(i) for i in range(arguments.agents)})
    # Looking up each of the (at most seven) delays once per call, not once per
    # use, halves the time; one C function instead of chunks gains 5 % more.
    solver = jitcdde(f, helpers=helpers, n=len(f), delays=delays, verbose=False,
                     automatic_anchor_helpers=True)
    solver.compile_C(simplify=False, do_cse=False, chunk_size=0)

    expected = reference(arguments.model, arguments.agents, arguments.end)
    times = expected["times_s"]
    seconds, states = [], None
    while len(seconds) < arguments.repeats:
        states, spent = run(solver, start, times)
        seconds.append(spent)

    axes = 1 if arguments.model == "linear" else 2
    blocks = states.reshape(len(times), arguments.agents, -1)
    error_q, error_dq = (
        float(np.abs(blocks[:, :, c * axes : (c + 1) * axes].reshape(len(times), -1)
                     - np.array(expected[name])).max())
        for c, name in enumerate(("q", "dq")))
    per_second = [1e3 * s / arguments.end for s in seconds]
    print(json.dumps({
        "model": arguments.model,
        "agents": arguments.agents,
        "end_s": arguments.end,
        "tolerance": TOLERANCE,
        "repeats": len(seconds),
        "ms_per_simulated_second": statistics.median(per_second),
        "min": min(per_second),
        "max": max(per_second),
        "max_error": max(error_q, error_dq),
        "max_error_q": error_q,
        "versions": {"python": platform.python_version()}
        | {name: importlib.metadata.version(name)
           for name in ("jitcdde", "jitcxde_common", "symengine", "numpy")},
    }))


if __name__ == "__main__":
    main()
