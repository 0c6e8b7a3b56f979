"""Point masses without velocity, (a7) to (a9), and consensus of many, computed without any part of forwardstep.

Written from the paper in its own terms: y and the estimate of the mass are integrated from their equations with the velocity in
them, which the program avoids. Needs nothing but Python. Writes masses.json beside itself.

    python3 validation/masses/generate.py

m x'' = u,  u = m_hat z' - k y,  y' + f y = f s,  m_hat' = -g z's (a scalar product over the axes),  s = x' - z

Tracking: z'' is (a9). Consensus of order l, announced by Remark 7: z^(l) is (24) with z where (24) has the velocity,

    z^(l) = - sum_{r=0}^{l-1} a_r z^(r) - sum_j w_ij [ sum_{r=1}^{l} a_r z^(r-1) + a_0 x - a_0 x_j(t - T_ij) ]

with a_0 .. a_l the coefficients of prod (p + root).

By a model, in the way the books on adaptive control write it for relative degree two: with w1' = u - f w1, w2' = x - f w2 and the
polynomial s^2 + a1 s + a0 of the model, the input that fits is u = -a1 w1 + m (r - (a0 + a1 f) x + a1 f^2 w2), r = x_d'' + a1 x_d' + a0 x_d.
Behind m stands v, m_hat' = -g phi (x - x_d) with phi = v/(s + p), and the input takes m_hat v + m_hat' phi.
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import steps  # noqa: E402

DAMPING, FILTER, ADAPTATION, ESTIMATE = 20.0, 20.0, 5.0, 0.3
SAMPLES = [0.31 * k for k in range(1, 21)]
VELOCITY = [0.2, -0.1]


def target(t):
    """x_d and three derivatives, for each axis."""
    wave = lambda size, rate: [size * rate**k * math.sin(rate * t + 0.4 + k * math.pi / 2) + (0.1 if k == 0 else 0.0)
                               for k in range(4)]
    return [wave(1.0, 1.0), wave(0.5, 1.7)]


def law(x, dx, z, dz, ddz, y, m_hat, mass):
    """Rates of x', y and m_hat; z has been led."""
    u = [m_hat * dz[k] - DAMPING * y[k] for k in range(2)]
    s = [dx[k] - z[k] for k in range(2)]
    d_y = [FILTER * (s[k] - y[k]) for k in range(2)]
    return [u[k] / mass for k in range(2)], d_y, -ADAPTATION * sum(dz[k] * s[k] for k in range(2)), u


def cut(state, agent, order):
    """x, x', the vectors of z, y and m_hat of one agent."""
    size = 7 + 2 * order
    own = state[agent * size:(agent + 1) * size]
    vectors = [own[4 + 2 * r:6 + 2 * r] for r in range(order)]
    return own[0:2], own[2:4], vectors, own[-3:-1], own[-1]


def rate(state, order, masses, led):
    """`led(agent, x, vectors)` gives the highest derivative of z."""
    out, inputs = [], []
    for agent, mass in enumerate(masses):
        x, dx, vectors, y, m_hat = cut(state, agent, order)
        rates = vectors[1:] + [led(agent, x, vectors)]
        ddx, d_y, d_m_hat, u = law(x, dx, vectors[0], rates[0], None, y, m_hat, mass)
        out += dx + ddx + [v for r in rates for v in r] + d_y + [d_m_hat]
        inputs.append(u)
    return out, inputs


def case(name, order, masses, starts, led, stops):
    """`led(t, middle, past)` gives `led` of `rate`."""
    size = 7 + 2 * order
    start = [v for x in starts for v in x + VELOCITY + [0.0] * (2 * order) + [0.0, 0.0, ESTIMATE]]
    field = lambda t, state, middle, past: rate(state, order, masses, led(t, middle, past))[0]
    sent = [agent * size + k for agent in range(len(masses)) for k in range(2)]
    rows, gap = steps.checked(lambda h: steps.solve(field, start, SAMPLES, h, stops, sent), 0.001, 1e-8)
    print(name, "half as many steps change it by", gap)
    agents = []
    for agent in range(len(masses)):
        parts = [cut(row, agent, order) for row in rows]
        agents.append({
            "q": [p[0] for p in parts], "dq": [p[1] for p in parts], "z": [p[2][0] for p in parts],
            "y": [p[3] for p in parts], "theta_hat": [[p[4]] for p in parts],
            "tau": [[p[4] * dz - DAMPING * y for dz, y in zip(p[2][1], p[3])] for p in parts],
        })
    return {"name": name, "t_s": SAMPLES, "agents": agents}


def tracking():
    a = steps.polynomial([1.0, 1.5, 2.0])

    def led(t, middle, past):
        x_d = target(t)
        return lambda agent, x, vectors: [
            x_d[k][3] - a[2] * (vectors[1][k] - x_d[k][2]) - a[1] * (vectors[0][k] - x_d[k][1])
            - a[0] * (x[k] - x_d[k][0]) for k in range(2)
        ]

    return case("tracking", 2, [2.0], [[0.4, -0.3]], led, [])


def consensus(order):
    a = steps.polynomial([1.0, 2.0, 1.5][:order])
    network = steps.Network([[(0, 1), (1, 0)], [(1, 2), (2, 0)]], 0.8, 0.05, 0.3, 0.5)

    def led(t, middle, past):
        sent_s = network.sent_s(t, middle)

        def of(agent, x, vectors):
            out = []
            for k in range(2):
                own = sum(a[r] * vectors[r - 1][k] for r in range(1, order + 1)) + a[0] * x[k]
                heard = [own - a[0] * past.at(2 * j + k, sent_s) for j in network.heard_by(agent, middle)]
                out.append(-sum(a[r] * vectors[r][k] for r in range(order)) - sum(heard))
            return out

        return of

    starts = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.5]]
    return case(f"consensus of order {order}", order, [1.0, 1.7, 2.4], starts, led, network.stops(SAMPLES[-1]))


def by_model():
    a = steps.polynomial([1.0, 2.0])
    zero, mass, gain = a[0] * a[1] / (a[1] ** 2 + 2 * a[0]), 2.0, 20.0

    def rates(t, state):
        x, dx, w1, w2, phi, m_hat = *(state[2 * k:2 * k + 2] for k in range(5)), state[10]
        x_d = target(t)
        v = [x_d[k][2] + a[1] * x_d[k][1] + a[0] * x_d[k][0] - (a[0] + a[1] * FILTER) * x[k] + a[1] * FILTER**2 * w2[k] for k in range(2)]
        d_m_hat = -gain * sum(phi[k] * (x[k] - x_d[k][0]) for k in range(2))
        u = [-a[1] * w1[k] + m_hat * v[k] + d_m_hat * phi[k] for k in range(2)]
        out = list(dx) + [u[k] / mass for k in range(2)] + [u[k] - FILTER * w1[k] for k in range(2)]
        return out + [x[k] - FILTER * w2[k] for k in range(2)] + [v[k] - zero * phi[k] for k in range(2)] + [d_m_hat], u

    x = [0.4, -0.3]
    start = x + VELOCITY + [0.0] * 2 + [v / FILTER for v in x] + [0.0] * 2 + [ESTIMATE]
    field = lambda t, state, middle, past: rates(t, state)[0]
    rows, gap = steps.checked(lambda h: steps.solve(field, start, SAMPLES, h, [], [0, 1]), 0.001, 1e-8)
    print("by a model", "half as many steps change it by", gap)
    agent = {
        "q": [row[0:2] for row in rows], "dq": [row[2:4] for row in rows],
        "y": [[FILTER * (row[k] - FILTER * row[6 + k]) for k in range(2)] for row in rows],
        "theta_hat": [[row[10]] for row in rows], "tau": [rates(t, row)[1] for t, row in zip(SAMPLES, rows)],
    }
    return {"name": "by a model", "t_s": SAMPLES, "agents": [agent]}


steps.write(HERE / "masses.json", [tracking(), consensus(2), consensus(3), by_model()])
