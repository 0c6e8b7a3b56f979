"""Point masses that agree with their leader on one vector and follow it, computed without any part of forwardstep.

Written with z and z' as they are, not with the vector: y is put together from them wherever it is told or heard. Over links that
lead one way, over graphs that take turns, and over links that delay by saw teeth. Needs nothing but Python. Writes composite.json
beside itself.

    python3 validation/composite/generate.py

z'' = -b z' - a q' - sum_j w_ij (y_i - y_j) - g sat(sum_j w_ij (y_i - y_j) / width),  y = z' + b z + a q
m q'' = m_hat z' - k s,  s = q' - z,  m_hat' = -G z' s
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import steps  # noqa: E402

ALPHA, BETA, GAMMA, WIDTH = 1.3, 2.1, 2.5, 0.1
DAMPING, ADAPTATION, ESTIMATE = 3.0, 2.0, 0.2
MASSES = [0.8, 1.5, 2.3]
STARTS, VELOCITIES = [0.9, -0.7, 0.4], [0.1, -0.3, 0.2]
Z, DZ = [0.3, 0.1, 0.0], [0.0, 0.2, -0.1]
SAMPLES = [0.25 * k for k in range(1, 25)]
LEADER = 3
# w_ij by sender and receiver.
ONE_WAY = {(LEADER, 0): 1.4, (0, 1): 0.9, (2, 1): 0.5, (1, 2): 1.1}
OTHER = {(LEADER, 2): 0.8, (2, 0): 1.6, (0, 1): 0.4}
NUMBERS = 5


def leader(t):
    """q0, q0', q0''."""
    return [0.6 * 0.8**k * math.sin(0.8 * t + 0.3 + k * math.pi / 2) for k in range(3)]


def told(q, z, dz):
    return dz + BETA * z + ALPHA * q


def rate_over(network, weights):
    def rate(t, state, middle, past):
        graph = weights[int(middle // network.dwell) % len(weights)]
        sent_s = network.sent_s(t, middle)

        def heard(j):
            if j == LEADER:
                q_0, dq_0, ddq_0 = leader(max(0.0, sent_s))
                return told(q_0, dq_0, ddq_0)
            if network.high == 0.0:
                q, _, z, dz, _ = state[NUMBERS * j:NUMBERS * (j + 1)]
                return told(q, z, dz)
            return told(*(past.at(3 * j + k, sent_s) for k in range(3)))

        out = []
        for i, mass in enumerate(MASSES):
            q, dq, z, dz, m_hat = state[NUMBERS * i:NUMBERS * (i + 1)]
            e = sum(w * (told(q, z, dz) - heard(j)) for (j, to), w in graph.items() if to == i)
            ddz = -BETA * dz - ALPHA * dq - e - GAMMA * max(-1.0, min(1.0, e / WIDTH))
            s = dq - z
            out += [dq, (m_hat * dz - DAMPING * s) / mass, dz, ddz, -ADAPTATION * dz * s]
        return out
    return rate


def run(name, weights, dwell=math.inf, low=0.0, high=0.0, period=math.inf):
    network = steps.Network([list(graph) for graph in weights], min(dwell, 1e6), low, high, period)
    start = sum(([q, dq, z, dz, ESTIMATE] for q, dq, z, dz in zip(STARTS, VELOCITIES, Z, DZ)), [])
    # q, z and z' are what a neighbour needs.
    sent = [NUMBERS * i + k for i in range(len(MASSES)) for k in (0, 2, 3)]
    stops = network.stops(SAMPLES[-1]) if dwell < math.inf or high > 0.0 else ()
    found, _ = steps.checked(
        lambda step: steps.solve(rate_over(network, weights), start, SAMPLES, step, stops, sent), 1.25e-4, 5e-8)
    agents = []
    for i in range(len(MASSES)):
        rows = [dict(zip(("q", "dq", "z", "dz", "theta_hat"), state[NUMBERS * i:])) for state in found]
        for row in rows:
            row["composite"] = told(row["q"], row["z"], row["dz"])
        agents.append({name: [[row[name]] for row in rows] for name in rows[0]})
    return {"name": name, "t_s": SAMPLES, "agents": agents}


steps.write(HERE / "composite.json", [
    run("over links that lead one way", [ONE_WAY]),
    run("over graphs that take turns", [ONE_WAY, OTHER], dwell=0.7),
    run("over links that delay", [ONE_WAY], low=0.02, high=0.12, period=0.5),
])
