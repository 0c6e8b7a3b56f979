"""Point masses that follow a leader by an observer of it, computed without any part of forwardstep.

Written in the coordinates of the proof: the observer as its errors relative to the leader, xi = (v - q0') + a (x - q0) and
chi = x - q0, and each robot as its distance r = q - x from its estimate and s = q' - z. Needs nothing but Python. Writes
observer.json beside itself.

    python3 validation/observer/generate.py

xi' = -L xi - g sat(L xi / width) - (q0'' + a q0'),  chi' = -a chi + xi
r' = -kappa r + s,  m s' = -k s + (m_hat - m) z',  m_hat' = -G z' s
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import steps  # noqa: E402

ALPHA, GAMMA, KAPPA, WIDTH = 1.2, 2.0, 1.5, 0.05
DAMPING, ADAPTATION, ESTIMATE = 3.0, 2.0, 0.2
MASSES = [0.8, 1.5, 2.3]
STARTS, VELOCITIES = [0.9, -0.7, 0.4], [0.1, -0.3, 0.2]
SAMPLES = [0.25 * k for k in range(1, 25)]
# w_ij by receiver, leader in the place of "0".
WEIGHTS = [{"0": 1.4}, {0: 0.9, 2: 0.5}, {1: 1.1}]


def leader(t):
    """q0, q0', q0''."""
    return [0.6 * 0.8**k * math.sin(0.8 * t + 0.3 + k * math.pi / 2) for k in range(3)]


def rate(t, state, *_):
    xi, chi, r, s, m_hat = (state[3 * k:3 * k + 3] for k in range(5))
    _, dq_0, ddq_0 = leader(t)
    out = [[], [], [], [], []]
    for i, weights in enumerate(WEIGHTS):
        e = sum(w * (xi[i] - (0.0 if j == "0" else xi[j])) for j, w in weights.items())
        d_xi = -e - GAMMA * max(-1.0, min(1.0, e / WIDTH)) - ddq_0 - ALPHA * dq_0
        d_chi = -ALPHA * chi[i] + xi[i]
        d_r = -KAPPA * r[i] + s[i]
        # v' = q0'' + (xi - a chi)', and z = v - kappa r.
        dz = ddq_0 + d_xi - ALPHA * d_chi - KAPPA * d_r
        d_s = (-DAMPING * s[i] + (m_hat[i] - MASSES[i]) * dz) / MASSES[i]
        for column, value in zip(out, [d_xi, d_chi, d_r, d_s, -ADAPTATION * dz * s[i]]):
            column.append(value)
    return sum(out, [])


def run():
    q_0, dq_0, _ = leader(0.0)
    # x(0) = q(0), v(0) = 0, so that z(0) = 0.
    chi = [q - q_0 for q in STARTS]
    start = [-dq_0 + ALPHA * c for c in chi] + chi + [0.0] * 3 + VELOCITIES + [ESTIMATE] * 3
    found, _ = steps.checked(lambda step: steps.solve(rate, start, SAMPLES, step), 1.25e-4, 2e-8)
    agents = [{"x": [], "v": [], "q": [], "dq": [], "theta_hat": []} for _ in MASSES]
    for t, state in zip(SAMPLES, found):
        q_0, dq_0, _ = leader(t)
        for i, agent in enumerate(agents):
            xi, chi, r, s, m_hat = state[i::3]
            x, v = q_0 + chi, dq_0 + xi - ALPHA * chi
            for name, value in [("x", x), ("v", v), ("q", x + r), ("dq", s + v - KAPPA * r), ("theta_hat", m_hat)]:
                agent[name].append(value)
    return {"name": "three point masses", "t_s": SAMPLES, "agents": agents}


steps.write(HERE / "observer.json", [run()])
