"""Three point masses that follow a leader by (110), (119) and (122), with sat(e/eps) in place of the sign.

Written from the paper alone, in the form in which it prints the equations: (119) and (122) with their own second
derivatives of z as states, not with the integrated variable of the Rust code. Needs nothing but Python. Writes following.json
beside itself.

    python3 validation/trajectories/following.py
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import steps  # noqa: E402

MASS = [1.0, 2.0, 1.5]
DAMPING = 8.0
ALPHA, BETA, GAMMA, WIDTH = 1.3, 2.1, 2.5, 0.1
# i hears j with weight w; 3 is the leader.
EDGES = [(0, 3, 1.0), (1, 0, 1.5), (2, 1, 0.7), (0, 2, 0.4)]
Q0, DQ0, Z0, DZ0 = [0.8, -0.5, 0.3], [0.1, 0.0, -0.2], [0.3, 0.1, 0.0], [0.0, 0.2, -0.1]
SAMPLES = [1.0 * k for k in range(1, 9)]


def leader(t):
    """q_0 and its first three derivatives."""
    a, w, b, v = 0.6, 0.8, 0.2, 1.7
    return [
        0.1 + a * math.sin(w * t) + b * math.sin(v * t + 0.5),
        a * w * math.cos(w * t) + b * v * math.cos(v * t + 0.5),
        -a * w * w * math.sin(w * t) - b * v * v * math.sin(v * t + 0.5),
    ]


def saturated(e):
    return max(-1.0, min(1.0, e / WIDTH))


def differences(values, lead):
    everybody = values + [lead]
    sums = [0.0, 0.0, 0.0]
    for i, j, w in EDGES:
        sums[i] += w * (everybody[i] - everybody[j])
    return sums


def accelerations(dq, z, dz):
    """m q'' = -K (q' - z) + m z', the law with a known mass."""
    return [dz[i] - DAMPING / MASS[i] * (dq[i] - z[i]) for i in range(3)]


def rates(design, t, x):
    q, dq, z = x[0:3], x[3:6], x[6:9]
    q0, dq0, ddq0 = leader(t)
    if design == "110":
        e = differences([dq[i] + ALPHA * q[i] for i in range(3)], dq0 + ALPHA * q0)
        dz = [-ALPHA * dq[i] - e[i] - GAMMA * saturated(e[i]) for i in range(3)]
        return dq + accelerations(dq, z, dz) + dz
    dz = x[9:12]
    ddq = accelerations(dq, z, dz)
    e = differences([ddq[i] + BETA * dq[i] + ALPHA * q[i] for i in range(3)], ddq0 + BETA * dq0 + ALPHA * q0)
    inside = e
    if design == "122":
        inside = differences([dz[i] + BETA * dq[i] + ALPHA * q[i] for i in range(3)], ddq0 + BETA * dq0 + ALPHA * q0)
    ddz = [-BETA * ddq[i] - ALPHA * dq[i] - e[i] - GAMMA * saturated(inside[i]) for i in range(3)]
    return dq + ddq + dz + ddz


def case(design):
    x = Q0 + DQ0 + Z0 + (DZ0 if design != "110" else [])
    field = lambda t, x, middle, past: rates(design, t, x)
    # The layer has corners, so the method is of lower order there: short steps.
    rows, gap = steps.checked(lambda h: steps.solve(field, x, SAMPLES, h), 1e-4, 1e-7)
    print(design, "half as many steps change it by", gap)
    agents = [{"q": [[r[k]] for r in rows], "dq": [[r[3 + k]] for r in rows], "z": [[r[6 + k]] for r in rows]}
              for k in range(3)]
    return {"name": design, "t_s": SAMPLES, "agents": agents}


steps.write(HERE / "following.json", [case(design) for design in ("110", "119", "122")])
