"""Chains of Section IV: feedback linearisation, adaptation, immersion and invariance, adaptive backstepping; consensus and tracking.

Written from (33) to (43), (24) and Remark 6, from the literature on backstepping with tuning functions for strict feedback (with
virtual controls, where the program defines errors), and from what the program says of the designs that are its own. The whole
estimate of immersion and invariance is integrated with the acceleration, where the program splits it. Computed without any part
of forwardstep. Needs nothing but Python. Writes chains.json beside itself.

    python3 validation/chains/generate.py

For a plant of order k and l vectors z, z', .., let N = k + l - 1, x_r be the r-th derivative of x for r < k and z^(r-k+1) above:

    z^(l) = x_d^(N) - sum_{r<N} a_r (x_r - x_d^(r))                                            tracking, N roots
    z^(l) = - sum_{r<N-1} a_r x_{r+1} - sum_j w_ij [ sum_{r<N} a_r x_r - a_0 x_j(t - T_ij) ]     consensus, N - 1 roots

Under backstepping z follows x_1 itself, which is k = 1.
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import steps  # noqa: E402
from formulas import ZERO, cos, formula, function, sin, tanh, variables  # noqa: E402

SAMPLES = [0.31 * k for k in range(1, 21)]
NETWORK = steps.Network([[(0, 1), (1, 0)], [(1, 2), (2, 0)]], 0.8, 0.05, 0.3, 0.5)


def target(t):
    """x_d and four derivatives."""
    return [0.5 * 0.8**k * math.sin(0.8 * t + 0.4 + k * math.pi / 2) + (0.1 if k == 0 else 0.0) for k in range(5)]


def guide(k, roots, x, z, lead):
    """z^(l). `lead` is a list: x_d and derivatives; or a number for each neighbour: what is heard."""
    tracks, heard = lead
    a = steps.polynomial(roots)
    top = len(roots) if tracks else len(roots) + 1
    at = lambda r: x[r] if r < k else z[r - k + 1]
    if tracks:
        return tracks[top] - sum(a[r] * (at(r) - tracks[r]) for r in range(top))
    own = sum(a[r] * at(r) for r in range(top))
    return -sum(a[r] * at(r + 1) for r in range(top - 1)) - sum(own - a[0] * x_j for x_j in heard)


# Plants (33): chi, phi and psi of x, x', ..

def second(x):
    return -x[0]**3, [math.sin(x[0]), x[1]**2], 2.0 + math.cos(x[0])


def third(x):
    return -x[1] * x[2], [x[0]**2, math.sin(x[2])], 1.0


def fourth(x):
    return -x[0] * x[2] - math.sin(x[1]), [math.tanh(x[3]), x[0] * x[1]], 1.5 + 0.5 * math.sin(x[0])


PLANTS = {2: (second, [0.8, -0.4]), 3: (third, [0.5, 0.6]), 4: (fourth, [0.4, -0.3])}


class Derivatives:
    """An agent of order k; `design` is linearising, adaptive or immersion. State: x, .., z, .., the estimate."""

    def __init__(self, k, design, roots, start, tracks=False, gain=2.0, gamma=2.0):
        self.k, self.design, self.roots, self.gain, self.gamma = k, design, roots, gain, gamma
        self.l = len(roots) + (1 if tracks else 2) - k
        self.estimates = 0 if design == "linearising" else 2
        self.start = start + [start[-1]] + [0.0] * (self.l - 1) + [0.0] * self.estimates
        self.names = ["q", "dq", "d2q", "d3q"][:k]

    def rate(self, state, lead):
        k, l = self.k, self.l
        terms, theta = PLANTS[k]
        x, z, theta_hat = state[:k], state[k:k + l], state[k + l:]
        top = guide(k, self.roots, x, z, lead)
        dz = z[1:] + [top]
        chi, phi, psi = terms(x)
        s = x[-1] - z[0]
        believed = theta_hat if self.estimates else theta
        u = (dz[0] - chi - sum(p * t for p, t in zip(phi, believed)) - self.gain * s) / psi
        highest = chi + sum(p * t for p, t in zip(phi, theta)) + psi * u
        if self.design == "immersion":
            # d/dt of theta_hat + Gamma Phi: what is left is by how much v' is not as it was meant to be.
            d_theta = [self.gamma * p * (highest - dz[0] + self.gain * s) for p in phi]
        else:
            d_theta = [self.gamma * p * s for p in phi][:self.estimates]
        return x[1:] + [highest] + dz + d_theta, u


def by_the_book(n, phi, gains, gamma):
    """Adaptive backstepping for x_i' = x_{i+1} + phi_i' theta: u and the rate of the estimate, of x, theta_hat, y, .., y^(n).

    z_i = x_i - y^(i-1) - a_{i-1}, where a_i are the virtual controls.
    """
    p = len(phi[0])
    v = variables(n + p + n + 1)
    x, theta, y = v[:n], v[n:n + p], v[n + p:]
    dot = lambda a, b: sum((r * s for r, s in zip(a, b)), ZERO)
    regressors = [[f(x) for f in row] for row in phi]
    z, a, w_z = [], [], []
    tau = [ZERO] * p
    for i in range(n):
        last = a[i - 1] if i else ZERO
        z.append(x[i] - y[i] - last)
        w = [regressors[i][j] - sum((last.by(x[k]) * regressors[k][j] for k in range(i)), ZERO) for j in range(p)]
        tau = [t + r * z[i] for t, r in zip(tau, w)]
        new = -gains[i] * z[i] - dot(w, theta)
        if i:
            new = new - z[i - 1]
        new = new + sum((last.by(x[k]) * x[k + 1] + last.by(y[k]) * y[k + 1] for k in range(i)), ZERO)
        new = new + dot([last.by(t) for t in theta], [gamma * t for t in tau])
        for k in range(1, i):
            new = new + dot([a[k - 1].by(t) for t in theta], [gamma * r for r in w]) * z[k]
        a.append(new)
    return function(v, [a[-1] + y[n]] + [gamma * t for t in tau])


STRICT = [
    [lambda x: x[0] * x[0], lambda x: ZERO],
    [lambda x: x[0] * x[1], lambda x: sin(x[1])],
    [lambda x: ZERO, lambda x: x[2] * x[0]],
    [lambda x: tanh(x[3]), lambda x: x[0]],
]


class Strict:
    """A strict-feedback chain under backstepping. State: x_1, .., z, .., the estimate."""

    def __init__(self, n, roots, start, tracks=False):
        self.n, self.l, self.roots, self.theta = n, len(roots) + (0 if tracks else 1), roots, [0.3, -0.2]
        self.start = start + [start[0]] + [0.0] * (self.l - 1) + [0.0, 0.0]
        self.law = by_the_book(n, STRICT[:n], [1.0] * n, 1.0)
        self.k, self.estimates = n, 2
        self.names = ["q", "x2", "x3", "x4"][:n]
        x = variables(n)
        self.phi = function(x, [f(x) for row in STRICT[:n] for f in row])

    def rate(self, state, lead):
        n, l = self.n, self.l
        x, z, theta_hat = state[:n], state[n:n + l], state[n + l:]
        dz = z[1:] + [guide(1, self.roots, x[:1], z, lead)]
        u, *d_theta = self.law(x + theta_hat + ([z[0]] + dz)[:n + 1])
        phi = self.phi(x)
        drift = [phi[2 * i] * self.theta[0] + phi[2 * i + 1] * self.theta[1] for i in range(n)]
        return [a + b for a, b in zip(x[1:] + [u], drift)] + dz + d_theta, u


class Pure:
    """x_1' = f + phi_1' theta with f = x_2 + 0.2 x_2^3, phi_1 = (x_1^2 + 0.3 tanh x_2, 0); x_2' = u + tanh(x_2) theta_1
    + x_1 x_2 theta_2. The errors, written out for two steps with unit gains:

        e_1 = x_1 - y,  e_2 = e_1 + f + phi_1' theta_hat - y'
        0 = e_2 + e_1 + (de_2/dx_1) (f + phi_1' theta_hat) + (de_2/dx_2) (u + phi_2' theta_hat) - y' - y'' + phi_1' Gamma tau_2
        w_1 = phi_1,  w_2 = (de_2/dx_1) phi_1 + (de_2/dx_2) phi_2,  theta_hat' = Gamma tau_2 = Gamma (w_1 e_1 + w_2 e_2)
    """

    def __init__(self, roots, start):
        self.roots, self.l, self.theta, self.k, self.estimates = roots, len(roots) + 1, [0.4, -0.3], 2, 2
        self.start = start + [start[0]] + [0.0] * (self.l - 1) + [0.0, 0.0]
        self.names = ["q", "x2"]

    def rate(self, state, lead):
        x, z, t = state[:2], state[2:2 + self.l], state[2 + self.l:]
        dz = z[1:] + [guide(1, self.roots, x[:1], z, lead)]
        y, dy, ddy = z[0], dz[0], dz[1]
        bend = math.tanh(x[1])
        f, phi_1, phi_2 = x[1] + 0.2 * x[1]**3, x[0]**2 + 0.3 * bend, [bend, x[0] * x[1]]
        e_1 = x[0] - y
        e_2 = e_1 + f + phi_1 * t[0] - dy
        by_1 = 1.0 + 2 * x[0] * t[0]
        by_2 = 1.0 + 0.6 * x[1]**2 + 0.3 * (1 - bend**2) * t[0]
        d_t = [phi_1 * e_1 + (by_1 * phi_1 + by_2 * phi_2[0]) * e_2, by_2 * phi_2[1] * e_2]
        rest = e_2 + e_1 + by_1 * (f + phi_1 * t[0]) - dy - ddy + phi_1 * d_t[0]
        u = -rest / by_2 - phi_2[0] * t[0] - phi_2[1] * t[1]
        d_x = [f + phi_1 * self.theta[0], u + phi_2[0] * self.theta[0] + phi_2[1] * self.theta[1]]
        return d_x + dz + d_t, u


def case(name, agents, tracks=False):
    cuts, start = [], []
    for agent in agents:
        cuts.append((len(start), len(start) + len(agent.start)))
        start += agent.start

    def leads(t, middle, past):
        if tracks:
            return [(target(t), [])] * len(agents)
        sent_s = NETWORK.sent_s(t, middle)
        return [([], [past.at(j, sent_s) for j in NETWORK.heard_by(i, middle)]) for i in range(len(agents))]

    def each(t, state, middle, past):
        return [agent.rate(state[a:b], lead) for agent, (a, b), lead in zip(agents, cuts, leads(t, middle, past))]

    field = lambda t, state, middle, past: [v for rates, _ in each(t, state, middle, past) for v in rates]
    stops = [] if tracks else NETWORK.stops(SAMPLES[-1])
    sent = [a for a, _ in cuts]
    rows, gap = steps.checked(lambda h: steps.solve(field, start, SAMPLES, h, stops, sent), 0.005, 1e-8)
    print(name, "half as many steps change it by", gap)
    out = []
    for agent, (a, b) in zip(agents, cuts):
        own = [row[a:b] for row in rows]
        columns = {key: [[row[r]] for row in own] for r, key in enumerate(agent.names)}
        columns["z"] = [[row[agent.k]] for row in own]
        if agent.estimates:
            columns["theta_hat"] = [row[-2:] for row in own]
        out.append(columns)
    return {"name": name, "t_s": SAMPLES, "agents": out}


def main():
    x_2, x_3, x_4 = [1.0, 0.2], [-0.5, 0.1, 0.3], [0.4, -0.2, 0.1, 0.0]
    long = [1.0, 2.0, 1.5, 1.2]
    steps.write(HERE / "chains.json", [
        case("mixed", [Derivatives(2, "linearising", [1.0, 2.0], x_2), Derivatives(3, "adaptive", long[:3], x_3),
                       Derivatives(2, "immersion", [1.5, 2.0], [-1.0, 0.3])]),
        case("linearising", [Derivatives(2, "linearising", long[:1], x_2), Derivatives(3, "linearising", long[:2], x_3),
                             Derivatives(4, "linearising", long, x_4)]),
        case("adaptive", [Derivatives(2, "adaptive", long[:3], x_2), Derivatives(3, "adaptive", long[:2], x_3),
                          Derivatives(4, "adaptive", long[:3], x_4)]),
        case("strict feedback", [Strict(2, long[:2], [0.6, 0.0]), Strict(3, long[:3], [-0.4, 0.1, 0.0]),
                                 Strict(4, long, [0.2, 0.0, 0.1, 0.0])]),
        case("pure feedback", [Pure(long[:2], x) for x in ([0.6, 0.1], [-0.5, 0.0], [0.1, -0.2])]),
        case("tracking", [Strict(3, long[:3], [0.6, 0.0, 0.0], True),
                          Derivatives(3, "adaptive", long, x_3, True, gamma=5.0),
                          Derivatives(2, "linearising", long[:2], x_2, True)], True),
    ])


main()
