"""Closed loops of vehicles with one thrust, (44) with (46), (50) or (57) and (58), computed without any part of forwardstep.

Written from the paper in its own terms, and unlike the program on purpose: attitudes are rotation matrices, the mass estimate
is integrated directly from (58) with the acceleration, and z is (49) written out; by a measured acceleration, which a bias shifts, it
is (24) of order two. Needs nothing but Python. Writes vehicles.json beside itself.

    python3 validation/vehicles/generate.py
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import steps  # noqa: E402

G = 9.81
ROOTS = (1.0, 1.5, 2.0)
ALPHA_STAR, STIFFNESS, GAMMA_STAR = 3.0, 4.0, 0.2
BIAS = [0.1, -0.2, 0.15]
YAW_GAIN, HEADING = 1.0, 0.5
SAMPLES = [0.62 * k for k in range(1, 11)]
# Two graphs in turn, as (from, to), all weights one, no delay.
NETWORK = steps.Network([[(0, 1), (1, 0)], [(1, 2), (2, 0)]], 0.8)
START = [[1.0, 0.0, -1.0], [0.0, 1.5, -2.0], [-1.0, 0.5, -1.5]]
VELOCITY = [0.2, -0.1, 0.1]
MASSES = [1.0, 1.3, 1.6]
ESTIMATE = 0.8


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def offset(agent, t, formation):
    """d, its first four derivatives, axis by axis."""
    zero = [0.0] * 5
    if not formation:
        return [zero, zero, zero]
    rate, phase = 0.4, 2.1 * agent
    wave = lambda shift: [rate**k * math.sin(rate * t + phase + shift + k * math.pi / 2) for k in range(5)]
    return [wave(0.0), wave(math.pi / 2), [-0.2 * agent, 0.0, 0.0, 0.0, 0.0]]


# The state of one agent: x, dx, R by rows, sigma, z, dz, ddz, m_hat.
LENGTH = 3 + 3 + 9 + 1 + 9 + 1


def start(agent, design):
    mass = ESTIMATE if design in ("adaptive", "by acceleration") else MASSES[agent]
    state = list(START[agent]) + list(VELOCITY) + [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0] + [mass * G] + [0.0] * 9
    return state + [mass]


def rate(t, state, middle, design, formation):
    agents = [state[k * LENGTH:(k + 1) * LENGTH] for k in range(3)]
    centres = [[s[k] - offset(i, t, formation)[k][0] for k in range(3)] for i, s in enumerate(agents)]
    out = []
    for i, s in enumerate(agents):
        x, dx, r, sigma = s[0:3], s[3:6], [s[6:9], s[9:12], s[12:15]], s[15]
        z, dz, ddz, m_hat = s[16:19], s[19:22], s[22:25], s[25]
        d = offset(i, t, formation)
        heard = NETWORK.heard_by(i, middle)
        thrust = [r[k][2] for k in range(3)]
        ddx = [-sigma / MASSES[i] * thrust[k] + (G if k == 2 else 0.0) for k in range(3)]
        y, dy = centres[i], [dx[k] - d[k][1] for k in range(3)]
        d_m_hat, dddz = 0.0, [0.0] * 3
        if design == "continuous":
            alpha, beta = ROOTS[0], ROOTS[1]
            a = alpha + beta + len(heard)
            psi = [
                -alpha * beta * dy[k]
                - sum((alpha + beta) * dy[k] + alpha * beta * (y[k] - centres[j][k]) for j in heard)
                for k in range(3)
            ]
            jerk = [psi[k] + d[k][3] + a * d[k][2] for k in range(3)]
            u = [MASSES[i] * (jerk[k] - (a * G if k == 2 else 0.0)) for k in range(3)]
        elif design == "by acceleration":
            first, second = ROOTS[0] + ROOTS[1], ROOTS[0] * ROOTS[1]
            # z, dz, and in the place of ddz nothing.
            jerk = [
                -first * dz[k] - second * dy[k]
                - sum(dz[k] + first * dy[k] + second * (y[k] - centres[j][k]) for j in heard)
                for k in range(3)
            ]
            a = ALPHA_STAR
            w = [jerk[k] + d[k][3] + a * (dz[k] + d[k][2]) - (a * G if k == 2 else 0.0) for k in range(3)]
            d_m_hat = -GAMMA_STAR * sum(w[k] * (ddx[k] + BIAS[k] - dz[k] - d[k][2]) for k in range(3))
            u = [m_hat * w[k] for k in range(3)]
            ddz = jerk
        else:
            p, q, c = ROOTS
            first, second, third = p + q + c, p * q + p * c + q * c, p * q * c
            dddz = [
                -first * ddz[k] - second * dz[k] - third * dy[k]
                - sum(ddz[k] + first * dz[k] + second * dy[k] + third * (y[k] - centres[j][k]) for j in heard)
                for k in range(3)
            ]
            a = ALPHA_STAR
            w = [ddz[k] + d[k][3] + a * (dz[k] + d[k][2]) - (a * G if k == 2 else 0.0) for k in range(3)]
            s_star = [dx[k] - z[k] - d[k][1] for k in range(3)]
            ds_star = [ddx[k] - dz[k] - d[k][2] for k in range(3)]
            if design == "adaptive":
                d_m_hat = -GAMMA_STAR * sum(w[k] * ds_star[k] for k in range(3))
                u = [m_hat * w[k] for k in range(3)]
            else:
                u = [MASSES[i] * w[k] - STIFFNESS * s_star[k] for k in range(3)]
        v = [-sum(r[row][k] * u[row] for row in range(3)) for k in range(3)]
        look = [r[0][0], r[1][0]]
        turn = YAW_GAIN * (look[0] * math.sin(HEADING) - look[1] * math.cos(HEADING))
        omega = [-v[1] / sigma, v[0] / sigma, turn]
        # R S(omega): every row of R crossed with omega.
        d_r = [cross(row, omega) for row in r]
        out += list(dx) + ddx + d_r[0] + d_r[1] + d_r[2] + [v[2] - a * sigma] + dz + ddz + dddz + [d_m_hat]
        if design == "continuous":
            out[-10:-1] = [0.0] * 9
        if design == "by acceleration":
            out[-4:-1] = [0.0] * 3
    return out


def case(design, formation):
    state = [value for agent in range(3) for value in start(agent, design)]
    field = lambda t, state, middle, past: rate(t, state, middle, design, formation)
    run = lambda h: steps.solve(field, state, SAMPLES, h, NETWORK.stops(SAMPLES[-1]))
    rows, gap = steps.checked(run, 0.001 if design in ("continuous", "differentiable") else 0.0005, 1e-8)
    name = design + (" in formation" if formation else "")
    print(name, "half as many steps change it by", gap)
    agents = []
    for k in range(3):
        own = [row[k * LENGTH:(k + 1) * LENGTH] for row in rows]
        agents.append({"q": [s[0:3] for s in own], "dq": [s[3:6] for s in own], "sigma": [[s[15]] for s in own]})
        if design in ("adaptive", "by acceleration"):
            agents[-1]["theta_hat"] = [[s[25]] for s in own]
    return {"name": name, "t_s": SAMPLES, "agents": agents}


designs = ("continuous", "differentiable", "adaptive", "by acceleration")
steps.write(HERE / "vehicles.json", [case(design, formation) for design in designs for formation in (False, True)])
