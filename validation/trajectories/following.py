"""Three point masses that follow a leader by (110), (119) and (122), with sat(e/eps) in place of the sign.

Written from the paper alone, in the form in which it prints the equations: (119) and (122) with their own second
derivatives of z as states, not with the integrated variable of the Rust code. Integrated by the classical Runge-Kutta
method with a step so short that halving it changes nothing by more than 1e-8. Needs nothing but Python.

    python3 following.py > following.json
"""

import json
import math
import sys

MASS = [1.0, 2.0, 1.5]
DAMPING = 8.0
ALPHA, BETA, GAMMA, WIDTH = 1.3, 2.1, 2.5, 0.1
# i hears j with weight w; 3 is the leader.
EDGES = [(0, 3, 1.0), (1, 0, 1.5), (2, 1, 0.7), (0, 2, 0.4)]
Q0, DQ0, Z0, DZ0 = [0.8, -0.5, 0.3], [0.1, 0.0, -0.2], [0.3, 0.1, 0.0], [0.0, 0.2, -0.1]
END, STEPS = 8.0, int(sys.argv[1]) if len(sys.argv) > 1 else 160_000


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


def solve(design):
    x = Q0 + DQ0 + Z0 + (DZ0 if design != "110" else [])
    h, rows = END / STEPS, []
    for k in range(STEPS):
        t = k * h
        a = rates(design, t, x)
        b = rates(design, t + h / 2, [x + h / 2 * r for x, r in zip(x, a)])
        c = rates(design, t + h / 2, [x + h / 2 * r for x, r in zip(x, b)])
        d = rates(design, t + h, [x + h * r for x, r in zip(x, c)])
        x = [x + h / 6 * (a + 2 * b + 2 * c + d) for x, a, b, c, d in zip(x, a, b, c, d)]
        if (k + 1) % (STEPS // 8) == 0:
            rows.append({"t_s": round((k + 1) * h, 9), "q": x[0:3], "dq": x[3:6], "z": x[6:9]})
    return rows


print(json.dumps({design: solve(design) for design in ("110", "119", "122")}, indent=1))
