"""Two-link arms that estimate their parameters, led by a nonlinear protocol over a switching network with a delay.

Written from (1) to (7) with the inertia, centrifugal and gravity terms of two rods, from (43), and from Remark 6 for the variables that the
protocol is written in. Computed without any part of forwardstep. Needs nothing but Python. Writes protocols.json beside itself.

    python3 validation/protocols/generate.py

On every joint, with S = sum_j w_ij q_j(t - T_ij) and d = sum_j w_ij,

    q''' = - 3 q'' - 2 q' + (2 + sin 3 t) tanh(S - d q) - 0.3 q''^3          where q'' is z', and q' is q' ("measured") or z ("z")
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import steps  # noqa: E402

SAMPLES = [0.31 * k for k in range(1, 21)]
NETWORK = steps.Network([[(0, 1), (1, 0)], [(1, 2), (2, 0)]], 0.8, 0.05, 0.3, 0.5)
DAMPING, ADAPTATION, BELIEVED = 20.0, 10.0, 0.7
STARTS = [[0.4 * k, 0.3 - 0.2 * k] for k in range(3)]
SIZE = 2 + 2 + 2 + 2 + 5


def parameters(index):
    """Two uniform rods; the first one is heavier from arm to arm."""
    (m1, m2), (l1, l2), g = (2.0 + 0.2 * index, 1.5), (1.0, 0.8), 9.81
    return [m1 * l1**2 / 3 + m2 * l2**2 / 3 + m2 * l1**2, m2 * l2**2 / 3, m2 * l1 * l2 / 2,
            g * (m1 * l1 / 2 + m2 * l1), g * m2 * l2 / 2]


def torque_of(theta, q, v, z, a):
    """M(q) a + C(q, v) z + g(q), joint by joint."""
    t1, t2, t3, t4, t5 = theta
    bend, fall = t3 * math.cos(q[1]), t3 * math.sin(q[1])
    hang = t5 * math.cos(q[0] + q[1])
    return [(t1 + 2 * bend) * a[0] + (t2 + bend) * a[1] - fall * (v[1] * z[0] + (v[0] + v[1]) * z[1])
            + t4 * math.cos(q[0]) + hang,
            (t2 + bend) * a[0] + t2 * a[1] + fall * v[0] * z[0] + hang]


def arm(theta, own, written, t, told, weights):
    """The rates of q, q', z, z' and the estimate."""
    q, v, z, dz, hat = own[0:2], own[2:4], own[4:6], own[6:8], own[8:13]
    velocity = v if written == "measured" else z
    ddz = [-3 * dz[k] - 2 * velocity[k] + (2 + math.sin(3 * t)) * math.tanh(told[k] - weights * q[k]) - 0.3 * dz[k]**3
           for k in range(2)]
    s = [v[k] - z[k] for k in range(2)]
    tau = [f - DAMPING * e for f, e in zip(torque_of(hat, q, v, z, dz), s)]
    free = [f - g for f, g in zip(tau, torque_of(theta, q, v, v, [0.0, 0.0]))]
    at_rest = [torque_of(theta, q, [0, 0], [0, 0], a) for a in ([0.0, 0.0], [1.0, 0.0])]
    (m11, m12), m22 = [with_a - without for without, with_a in zip(*at_rest)], theta[1]
    det = m11 * m22 - m12**2
    acceleration = [(m22 * free[0] - m12 * free[1]) / det, (m11 * free[1] - m12 * free[0]) / det]
    # Y, column by column, from what each parameter alone asks for.
    columns = [torque_of([float(j == k) for j in range(5)], q, v, z, dz) for k in range(5)]
    learned = [-ADAPTATION * (c[0] * s[0] + c[1] * s[1]) for c in columns]
    return v + acceleration + dz + ddz + learned


def case(written):
    thetas = [parameters(k) for k in range(3)]
    start = []
    for theta, q in zip(thetas, STARTS):
        v = [0.2, -0.1] if q is STARTS[1] else [0.0, 0.0]
        start += q + v + v + [0.0, 0.0] + [BELIEVED * t for t in theta]

    def field(t, state, middle, past):
        sent_s, rates = NETWORK.sent_s(t, middle), []
        for i, theta in enumerate(thetas):
            heard = NETWORK.heard_by(i, middle)
            told = [sum(past.at(2 * j + k, sent_s) for j in heard) for k in range(2)]
            rates += arm(theta, state[SIZE * i:SIZE * (i + 1)], written, t, told, float(len(heard)))
        return rates

    sent = [SIZE * i + k for i in range(3) for k in range(2)]
    rows, gap = steps.checked(lambda h: steps.solve(field, start, SAMPLES, h, NETWORK.stops(SAMPLES[-1]), sent), 0.001, 1e-8)
    print(written, "half as many steps change it by", gap)
    cut = lambda i, a, b: [row[SIZE * i + a:SIZE * i + b] for row in rows]
    agents = [{"q": cut(i, 0, 2), "dq": cut(i, 2, 4), "z": cut(i, 4, 6), "theta_hat": cut(i, 8, 13)} for i in range(3)]
    return {"name": written, "t_s": SAMPLES, "agents": agents}


steps.write(HERE / "protocols.json", [case("measured"), case("z")])
