"""A tip with uncertain link lengths, (76) to (82), or by its measured velocity, and spacecraft without angular velocity, (97) to (105), computed without any part
of forwardstep.

Written from the paper and the corrections to it: dJ_hat/dt holds the rate of the estimate; M d(omega)/dt = S(h) omega + tau with
tau = -A u for several wheels; wheel momenta are integrated, and h comes from them, where the program's law takes the constant
h_I. The quaternion between R_z and R is integrated from (106), where the program integrates R_z by (104) and (105). Beside them
spacecraft under a passivity filter, whose attitude error is integrated, where the program computes it from q and the target.
Needs nothing but Python. Writes single.json beside itself.

    python3 validation/single/generate.py
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import steps  # noqa: E402


def times(matrix, x):
    return [sum(a * b for a, b in zip(row, x)) for row in matrix]


def transposed(matrix):
    return [list(column) for column in zip(*matrix)]


def solve_small(matrix, x):
    """matrix^-1 x by elimination with pivots."""
    rows = [list(row) + [b] for row, b in zip(matrix, x)]
    n = len(rows)
    for k in range(n):
        best = max(range(k, n), key=lambda r: abs(rows[r][k]))
        rows[k], rows[best] = rows[best], rows[k]
        for r in range(n):
            if r != k:
                f = rows[r][k] / rows[k][k]
                rows[r] = [a - f * b for a, b in zip(rows[r], rows[k])]
    return [rows[k][n] / rows[k][k] for k in range(n)]


def wave(offset, size, rate, phase):
    """A value and its first two derivatives."""
    return lambda t: [size * rate**k * math.sin(rate * t + phase + k * math.pi / 2) + (offset if k == 0 else 0.0)
                      for k in range(3)]


# The arm: masses 2 and 1, lengths 1 and 0.8, uniform links, q_1 from the horizontal, q_2 from the first link, gravity down.
LENGTHS = [1.0, 0.8]
I1, I2 = 2.0 * 1.0 / 12, 1.0 * 0.64 / 12
THETA = [I1 + I2 + 2.0 * 0.25 + 1.0 * (1.0 + 0.16), I2 + 0.16, 0.4, 9.81 * (2.0 * 0.5 + 1.0), 9.81 * 0.4]
K, GAMMA, KAPPA, ALPHA = 20.0, 30.0, 5.0, 3.0
K_STAR, LAMBDA = [[20.0, 2.0], [2.0, 25.0]], [0.3, 0.4]
CIRCLE = [wave(0.8, 0.3, 1.0, math.pi / 2), wave(0.6, 0.3, 1.0, 0.0)]


def jacobian(q, lengths):
    a, b = lengths
    s1, c1, s12, c12 = math.sin(q[0]), math.cos(q[0]), math.sin(q[0] + q[1]), math.cos(q[0] + q[1])
    return [[-a * s1 - b * s12, -b * s12], [a * c1 + b * c12, b * c12]]


def jacobian_rate(q, dq, lengths, d_lengths):
    a, b = lengths
    s1, c1, s12, c12 = math.sin(q[0]), math.cos(q[0]), math.sin(q[0] + q[1]), math.cos(q[0] + q[1])
    w = dq[0] + dq[1]
    turned = [[-a * c1 * dq[0] - b * c12 * w, -b * c12 * w], [-a * s1 * dq[0] - b * s12 * w, -b * s12 * w]]
    learnt = jacobian(q, d_lengths)
    return [[x + y for x, y in zip(r, t)] for r, t in zip(turned, learnt)]


def regressor(q, dq, z, dz):
    s2, c2, c1, c12 = math.sin(q[1]), math.cos(q[1]), math.cos(q[0]), math.cos(q[0] + q[1])
    # Columns of M dz + C z + g, with C from the Christoffel symbols of M.
    return [
        [dz[0], dz[1], c2 * (2 * dz[0] + dz[1]) - s2 * (dq[1] * z[0] + (dq[0] + dq[1]) * z[1]), c1, c12],
        [0.0, dz[0] + dz[1], c2 * dz[0] + s2 * dq[0] * z[0], 0.0, c12],
    ]


def arm(state, t):
    """The rate of q, q', z, the estimates of dynamics and lengths; and the torque."""
    q, dq, z, dynamic, lengths = state[0:2], state[2:4], state[4:6], state[6:11], state[11:13]
    a, b = LENGTHS
    x = [a * math.cos(q[0]) + b * math.cos(q[0] + q[1]), a * math.sin(q[0]) + b * math.sin(q[0] + q[1])]
    x_d = [path(t) for path in CIRCLE]
    pull = times(K_STAR, [x[k] - x_d[k][0] for k in range(2)])
    # (82): column k of Z is the Jacobian of a unit length k, times the velocity.
    z_t = [times(jacobian(q, unit), dq) for unit in ([1.0, 0.0], [0.0, 1.0])]
    d_lengths = [LAMBDA[k] * sum(u * v for u, v in zip(z_t[k], pull)) for k in range(2)]
    j, dj = jacobian(q, lengths), jacobian_rate(q, dq, lengths, d_lengths)
    z_r = solve_small(j, [x_d[k][1] for k in range(2)])
    behind = times(dj, z_r)
    dz_r = solve_small(j, [x_d[k][2] - behind[k] for k in range(2)])
    j_pull = times(transposed(j), pull)
    dz = [dz_r[k] - ALPHA * (z[k] - z_r[k]) - j_pull[k] for k in range(2)]
    s = [dq[k] - z[k] for k in range(2)]
    y = regressor(q, dq, z, dz)
    model = times(y, dynamic)
    tau = [-K * s[k] - KAPPA * j_pull[k] + model[k] for k in range(2)]
    d_dynamic = [-GAMMA * sum(y[k][p] * s[k] for k in range(2)) for p in range(5)]
    c2, still = math.cos(q[1]), times(regressor(q, dq, dq, [0.0, 0.0]), THETA)
    m = [[THETA[0] + 2 * THETA[2] * c2, THETA[1] + THETA[2] * c2], [THETA[1] + THETA[2] * c2, THETA[1]]]
    ddq = solve_small(m, [tau[k] - still[k] for k in range(2)])
    return dq + ddq + dz + d_dynamic + d_lengths, {"tau": tau, "x": x, "dz": dz}


def watched_arm(state, t):
    """The same where the velocity of the tip is measured, and z is a function: the rate of q, q', the estimates."""
    q, dq, dynamic, lengths = state[0:2], state[2:4], state[4:9], state[9:11]
    a, b = LENGTHS
    x = [a * math.cos(q[0]) + b * math.cos(q[0] + q[1]), a * math.sin(q[0]) + b * math.sin(q[0] + q[1])]
    dx, x_d = times(jacobian(q, LENGTHS), dq), [path(t) for path in CIRCLE]
    off = [x[k] - x_d[k][0] for k in range(2)]
    pull = times(K_STAR, off)
    z_t = [times(jacobian(q, unit), dq) for unit in ([1.0, 0.0], [0.0, 1.0])]
    d_lengths = [LAMBDA[k] * sum(u * v for u, v in zip(z_t[k], pull)) for k in range(2)]
    j, dj = jacobian(q, lengths), jacobian_rate(q, dq, lengths, d_lengths)
    z = solve_small(j, [x_d[k][1] - ALPHA * off[k] for k in range(2)])
    behind = times(dj, z)
    dz = solve_small(j, [x_d[k][2] - ALPHA * (dx[k] - x_d[k][1]) - behind[k] for k in range(2)])
    s, j_pull = [dq[k] - z[k] for k in range(2)], times(transposed(j), pull)
    y = regressor(q, dq, z, dz)
    model = times(y, dynamic)
    tau = [-K * s[k] - KAPPA * j_pull[k] + model[k] for k in range(2)]
    d_dynamic = [-GAMMA * sum(y[k][p] * s[k] for k in range(2)) for p in range(5)]
    c2, still = math.cos(q[1]), times(regressor(q, dq, dq, [0.0, 0.0]), THETA)
    m = [[THETA[0] + 2 * THETA[2] * c2, THETA[1] + THETA[2] * c2], [THETA[1] + THETA[2] * c2, THETA[1]]]
    ddq = solve_small(m, [tau[k] - still[k] for k in range(2)])
    return dq + ddq + d_dynamic + d_lengths, {"tau": tau, "x": x, "dx": dx, "z": z, "dz": dz}


# The spacecraft.
M = [[10.0, 0.5, -0.3], [0.5, 8.0, 0.2], [-0.3, 0.2, 6.0]]
AXES = [[1.0, 0.0, 0.8], [-1.0, 0.0, 0.8], [0.0, 1.0, 0.8], [0.0, -1.0, 0.8]]
A = transposed([[x / math.sqrt(sum(y * y for y in axis)) for x in axis] for axis in AXES])
ALPHA_1, ALPHA_2 = 0.5, 1.2
K_ERROR = 4.0
K_4, LAMBDA_F = [3.0, 2.5, 2.0, 3.5], [1.0, 1.2, 0.8, 1.1]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def product(a, b):
    """Of quaternions, vector part first."""
    v = cross(a, b)
    return [a[3] * b[k] + b[3] * a[k] + v[k] for k in range(3)] + [a[3] * b[3] - sum(a[k] * b[k] for k in range(3))]


def conjugate(a):
    return [-a[0], -a[1], -a[2], a[3]]


def rotation(q):
    """R, which turns vectors of the body into inertial ones."""
    units = [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]
    return transposed([product(product(q, unit + [0.0]), conjugate(q))[:3] for unit in units])


def desired(path, t):
    """q_d, and the angular velocity and acceleration in inertial coordinates, for a quaternion p of any length."""
    rows = [entry(t) for entry in path]
    p, dp, ddp = [[row[k] for row in rows] for k in range(3)]
    n2 = sum(x * x for x in p)
    dn2 = 2 * sum(x * y for x, y in zip(p, dp))
    # omega = 2 vec(dq q*), and vec(p p*) = 0, so that the length of p enters as a factor only.
    turn, turn_rate = product(dp, conjugate(p))[:3], product(ddp, conjugate(p))[:3]
    omega = [2 * x / n2 for x in turn]
    d_omega = [2 * (y / n2 - x * dn2 / n2**2) for x, y in zip(turn, turn_rate)]
    return [x / math.sqrt(n2) for x in p], omega, d_omega


def craft(state, t, path):
    """The rate of q, omega, wheel momenta, z, the quaternion of R_z^T R, y."""
    q, omega, wheels, z = state[0:4], state[4:7], state[7:11], state[11:14]
    apart, y = state[14:18], state[18:22]
    q_d, omega_i, d_omega_i = desired(path, t)
    back = transposed(rotation(q))
    omega_d, pull = times(back, omega_i), times(back, d_omega_i)
    error = product(conjugate(q_d), q)
    swing = cross(z, omega_d)
    dz = [pull[k] - swing[k] - ALPHA_2 * (z[k] - omega_d[k]) - ALPHA_1 * error[k] for k in range(3)]
    dy = [K_4[k] * apart[k] - LAMBDA_F[k] * y[k] for k in range(4)]
    turn = lambda w: [0.5 * v for v in product(apart, w + [0.0])]
    d_columns = [turn(unit) for unit in ([1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0])]
    h = [a + b for a, b in zip(times(M, omega), times(A, wheels))]
    feed, coupling = times(M, dz), cross(h, z)
    tau = [feed[k] - coupling[k] - sum(d_columns[k][r] * K_4[r] * dy[r] for r in range(4)) for k in range(3)]
    square = [[sum(a * b for a, b in zip(p, r)) for r in A] for p in A]
    u = [-x for x in times(transposed(A), solve_small(square, tau))]
    gyroscopic = cross(h, omega)
    d_omega = solve_small(M, [gyroscopic[k] + tau[k] for k in range(3)])
    d_q = [0.5 * v for v in product(q, omega + [0.0])]
    d_apart = turn([a - b for a, b in zip(omega, z)])
    return d_q + d_omega + u + dz + d_apart + dy, {"wheel_torque": u, "dz": dz, "dy": dy, "tau": tau}


def filtered(state, t, path):
    """The rate of q, omega, wheel momenta, the quaternion of R_d^T R, y, under a filter of the attitude error."""
    q, omega, wheels, error, y = state[0:4], state[4:7], state[7:11], state[11:15], state[15:19]
    _, omega_i, d_omega_i = desired(path, t)
    back = transposed(rotation(q))
    omega_d, pull = times(back, omega_i), times(back, d_omega_i)
    dy = [K_4[k] * error[k] - LAMBDA_F[k] * y[k] for k in range(4)]
    turn = lambda w: [0.5 * v for v in product(error, w + [0.0])]
    d_columns = [turn(unit) for unit in ([1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0])]
    h = [a + b for a, b in zip(times(M, omega), times(A, wheels))]
    feed, coupling = times(M, pull), cross(h, omega_d)
    damped = [sum(column[r] * K_4[r] * dy[r] for r in range(4)) for column in d_columns]
    tau = [feed[k] - coupling[k] - K_ERROR * error[k] - damped[k] for k in range(3)]
    square = [[sum(a * b for a, b in zip(p, r)) for r in A] for p in A]
    u = [-x for x in times(transposed(A), solve_small(square, tau))]
    gyroscopic = cross(h, omega)
    d_omega = solve_small(M, [gyroscopic[k] + tau[k] for k in range(3)])
    d_q = [0.5 * v for v in product(q, omega + [0.0])]
    d_error = turn([a - b for a, b in zip(omega, omega_d)])
    return d_q + d_omega + u + d_error + dy, {"wheel_torque": u, "dy": dy, "tau": tau}


def case(name, start, samples, step, law, parts):
    field = lambda t, state, middle, past: law(state, t)[0]
    rows, gap = steps.checked(lambda h: steps.solve(field, start, samples, h), step, 1e-8)
    print(name, "half as many steps change it by", gap)
    agent = {key: [row[a:b] for row in rows] for key, (a, b) in parts.items()}
    shown = [law(row, t)[1] for row, t in zip(rows, samples)]
    agent |= {key: [row[key] for row in shown] for key in shown[0]}
    return {"name": name, "t_s": samples, "agents": [agent]}


def main():
    samples = [0.31 * k for k in range(1, 25)]
    start = [0.2, 1.4, 0.1, -0.2, 0.1, -0.2] + [0.0] * 5 + [1.2, 0.96]
    parts = {"q": (0, 2), "dq": (2, 4), "z": (4, 6), "theta_hat": (6, 11), "kinematic_hat": (11, 13)}
    cases = [case("tip", start, samples, 0.0002, arm, parts)]

    start = [0.2, 1.4, 0.1, -0.2] + [0.0] * 5 + [1.2, 0.96]
    parts = {"q": (0, 2), "dq": (2, 4), "theta_hat": (4, 9), "kinematic_hat": (9, 11)}
    watched = case("tip by its velocity", start, samples, 0.0002, watched_arm, parts)

    half, wide = math.radians(179.9) / 2, math.sqrt(6.0)
    q = [x / wide * math.sin(half) for x in (1.0, 2.0, -1.0)] + [math.cos(half)]
    start = q + [0.1, -0.05, 0.08] + [0.3, -0.2, 0.1, 0.4] + [0.0] * 3 + [0.0, 0.0, 0.0, 1.0]
    start += [0.0, 0.0, 0.0, K_4[3] / LAMBDA_F[3]]
    fixed = lambda value: lambda t: [value, 0.0, 0.0]
    paths = {
        "rest": [fixed(0.0), fixed(0.0), fixed(0.0), fixed(2.0)],
        "swing": [wave(0.1, 0.3, 0.4, 0.0), wave(0.0, 0.2, 0.3, 1.0), wave(0.0, 0.2, 0.5, 2.0), fixed(1.0)],
        # Turns by 0.05 t about the inertial z axis, by 0.5 about x, by 0.2 t about the body's z axis.
        "tumbling": [wave(0.0, math.sin(0.25), 0.075, math.pi / 2), wave(0.0, -math.sin(0.25), 0.075, 0.0),
                     wave(0.0, math.cos(0.25), 0.125, 0.0), wave(0.0, math.cos(0.25), 0.125, math.pi / 2)],
    }
    parts = {"q": (0, 4), "dq": (4, 7), "wheel_momentum": (7, 11), "z": (11, 14)}
    samples = [1.0 * k for k in range(1, 25)]
    for name, path in paths.items():
        cases.append(case(name, start, samples, 0.01, lambda state, t, path=path: craft(state, t, path), parts))
    parts = {"q": (0, 4), "dq": (4, 7), "wheel_momentum": (7, 11)}
    for name, path in paths.items():
        error = product(conjugate(desired(path, 0.0)[0]), q)
        start = q + [0.1, -0.05, 0.08] + [0.3, -0.2, 0.1, 0.4] + error + [K_4[k] / LAMBDA_F[k] * error[k] for k in range(4)]
        law = lambda state, t, path=path: filtered(state, t, path)
        cases.append(case("filter, " + name, start, samples, 0.005, law, parts))
    cases.append(watched)
    steps.write(HERE / "single.json", cases)


main()
