"""The same problem in jitcdde, built a second time from the case alone.

Nothing is shared with the other solver but the times at which to restart: the
plant comes from the kinetic and potential energy of the links (Christoffel
symbols by differentiation, no parameter vector), delays and graph from their
plain definitions.

jitcdde is of third order.  It is run with fixed steps that land on the
break-points, at two step sizes, and extrapolated to step size zero.
"""

import math
import warnings

import numpy as np
from jitcdde import jitcdde, t, y
from symengine import Matrix, Symbol, cos, sin, sympify

from break_points import SAME_TIME, break_points
from problem import (as_matrix, delay_at, dimension, edges_at, reference_of, reference_start,
                     reference_vectors)

# jitcdde puts a second, corrected derivative on a break-point this long
# after the first one.
CORNER = 1e-9


def energies(robot, q):
    """(mass matrix, potential energy) from where the links are."""
    if robot["kind"] == "point_mass":
        size = robot["dimension"]
        return [[robot["mass_kg"] if a == b else 0 for b in range(size)]
                for a in range(size)], sympify(0)
    l1, _ = robot["lengths_m"]
    lc1, lc2 = robot["centres_m"]
    angles = [q[0], q[0] + q[1]]
    centres = [
        (lc1 * cos(angles[0]), lc1 * sin(angles[0])),
        (l1 * cos(angles[0]) + lc2 * cos(angles[1]), l1 * sin(angles[0]) + lc2 * sin(angles[1])),
    ]
    M = [[sympify(0)] * 2 for _ in range(2)]
    potential = sympify(0)
    for angle, centre, mass, inertia in zip(
            angles, centres, robot["masses_kg"], robot["inertias_kg_m2"]):
        for a in range(2):
            for b in range(2):
                M[a][b] += (inertia * angle.diff(q[a]) * angle.diff(q[b])
                            + mass * sum(x.diff(q[a]) * x.diff(q[b]) for x in centre))
        potential += mass * robot["gravity_m_s2"] * centre[1]
    return M, potential


def plant_acceleration(robot, q, dq, tau):
    size = dimension(robot)
    names = [Symbol(f"coordinate_{a}") for a in range(size)]
    M, potential = energies(robot, names)
    force = []
    for a in range(size):
        coriolis = sum(
            (sympify(M[a][b]).diff(names[c]) - sympify(M[b][c]).diff(names[a]) / 2)
            * dq[b] * dq[c] for b in range(size) for c in range(size))
        force.append(tau[a] - coriolis - potential.diff(names[a]))
    if robot["kind"] == "point_mass":
        result = [f / robot["mass_kg"] for f in force]
    else:
        determinant = M[0][0] * M[1][1] - M[0][1] * M[1][0]
        result = [(M[1][1] * force[0] - M[0][1] * force[1]) / determinant,
                  (M[0][0] * force[1] - M[1][0] * force[0]) / determinant]
    values = dict(zip(names, q))
    return [sympify(r).subs(values) for r in result]


def regressor(robot, q, dq, z, dz):
    if robot["kind"] == "point_mass":
        return [[rate] for rate in dz]
    c2, s2 = cos(q[1]), sin(q[1])
    g1, g2 = cos(q[0]), cos(q[0] + q[1])
    return [
        [dz[0], dz[1],
         2 * c2 * dz[0] + c2 * dz[1] - s2 * dq[1] * z[0] - s2 * (dq[0] + dq[1]) * z[1], g1, g2],
        [0, dz[0] + dz[1], c2 * dz[0] + s2 * dq[0] * z[0], 0, g2],
    ]


def place_state(problem):
    """Index of the first component of each agent's block and their total."""
    places, total = [], 0
    for a in problem["agents"]:
        places.append(total)
        total += (2 + reference_vectors(problem)) * dimension(a["robot"]) + len(a["robot"]["theta"])
    return places, total


def distinct_edges(problem):
    schedule = problem["schedule"]
    phases = [schedule] if schedule["kind"] == "fixed" else schedule["phases"]
    found = []
    for phase in phases:
        for e in phase["edges"]:
            key = {name: e[name] for name in ("from", "to", "delay")}
            if key not in found:
                found.append(key)
    return found


def delay_expression(delay, k):
    """Delays with jumps are a + b t between two of them, with a and b as
    parameters that are set anew at every restart."""
    if delay["kind"] == "constant":
        return sympify(delay["s"]), []
    if delay["kind"] == "sinusoid":
        angle = 2 * math.pi * t / delay["period_s"] + delay["phase_rad"]
        return delay["mean_s"] + delay["amplitude_s"] * sin(angle), []
    parameters = [Symbol(f"delay_{k}_offset"), Symbol(f"delay_{k}_slope")]
    return parameters[0] + parameters[1] * t, parameters


def longest_delay(delay):
    return {"constant": lambda: delay["s"],
            "sinusoid": lambda: delay["mean_s"] + abs(delay["amplitude_s"]),
            "piecewise_constant": lambda: max(delay["values_s"]),
            "saw_tooth": lambda: delay["max_s"]}[delay["kind"]]()


def equations(problem, edges):
    """Right-hand sides, parameters (a weight per edge, then those of delays)."""
    l, kind = problem["order"], reference_of(problem)["kind"]
    count = reference_vectors(problem)
    places, total = place_state(problem)
    weights = [Symbol(f"weight_{k}") for k in range(len(edges))]
    delays = [delay_expression(e["delay"], k) for k, e in enumerate(edges)]
    parameters = weights + [p for _, more in delays for p in more]
    f = [None] * total
    for i, a in enumerate(problem["agents"]):
        robot, m, base = a["robot"], dimension(a["robot"]), places[i]
        block = lambda r: [y(base + r * m + axis) for axis in range(m)]
        q, dq, reference = block(0), block(1), [block(2 + r) for r in range(count)]
        theta_place = base + (2 + count) * m
        size = len(robot["theta"])
        theta_hat = Matrix(size, 1, [y(theta_place + c) for c in range(size)])
        hears = []  # weight, (q_j, dq_j) as heard
        for k, e in enumerate(edges):
            if e["to"] == i:
                sender, (delay, _) = places[e["from"]], delays[k]
                then = t if delay == 0 else t - delay
                hears.append((weights[k], [[y(sender + r * m + axis, then) for axis in range(m)]
                                           for r in range(2)]))

        def act(z, dz):
            """The acceleration and the rate of the estimate."""
            s = Matrix(m, 1, [dq[axis] - z[axis] for axis in range(m)])
            Y = Matrix(regressor(robot, q, dq, z, dz))
            tau = Y * theta_hat - Matrix(as_matrix(a["K"], m).tolist()) * s
            Gamma = as_matrix(0.0 if a["knows_theta"] else a["Gamma"], size)
            return (plant_acceleration(robot, q, dq, [tau[axis, 0] for axis in range(m)]),
                    -(Matrix(Gamma.tolist()) * (Y.T * s)))

        def highest(own):
            """The equation of the reference, from x_0 .. x_l."""
            alpha, result = a["alpha"] + [1.0], []
            for axis in range(m):
                rate = -sum(alpha[r] * own[r + 1][axis] for r in range(l))
                rate += a.get("lambda", 0.0) * (dq[axis] - reference[0][axis])
                for weight, told in hears:
                    message = alpha[0] * told[0][axis]
                    if problem["exchange"] == "position_velocity":
                        message += alpha[0] / a["roots"][0] * told[1][axis]
                    rate -= weight * (sum(alpha[r] * own[r][axis] for r in range(l + 1)) - message)
                result.append(rate)
            return result

        if kind == "backstepping":
            z = [sum(weight * (told[0][axis] - q[axis]) for weight, told in hears)
                 for axis in range(m)]
            rates = [[(z[axis] - reference[0][axis]) / reference_of(problem)["filter_s"]
                      for axis in range(m)]]
            ddq, adapt = act(z, rates[0])
        elif kind == "pure_integral":
            ddq, adapt = act(*reference)
            rates = [reference[1], highest([q, dq, ddq])]
        else:
            rates = reference[1:] + [highest([q, dq] + reference[1:])]
            ddq, adapt = act(reference[0], rates[0])
        rows = dq + ddq + sum(rates, []) + [adapt[c, 0] for c in range(size)]
        f[base : base + len(rows)] = rows
    return f, parameters, weights, delays


def start_state(problem):
    values = []
    for a, reference in zip(problem["agents"], reference_start(problem)):
        start = a["start"]
        values += start["q"] + start["dq"] + sum(reference, []) + start["theta_hat"]
    return np.array(values, dtype=float)


class Check:
    def __init__(self, problem):
        self.problem = problem
        self.edges = distinct_edges(problem)
        f, parameters, self.weights, self.delays = equations(problem, self.edges)
        # Delays beyond the horizon only ever hear the constant past.
        self.max_delay = max(longest_delay(e["delay"]) for e in self.edges) + 1.0
        self.solver = jitcdde(f, n=len(f), control_pars=parameters, verbose=False,
                              max_delay=self.max_delay)
        with warnings.catch_warnings():
            # Networks without any delay are among the cases.
            warnings.filterwarnings("ignore", message=".*does not include a delay term.*")
            self.solver.compile_C(simplify=False, do_cse=False)

    def parameters(self, begin, stop):
        middle = (begin + stop) / 2
        present = edges_at(self.problem["schedule"], middle)
        values = []
        for e in self.edges:
            values.append(float(sum(
                p["weight"] for p in present
                if (p["from"], p["to"], p["delay"]) == (e["from"], e["to"], e["delay"]))))
        for e, (_, more) in zip(self.edges, self.delays):
            if more:
                t1, t2 = begin + (stop - begin) / 4, begin + (stop - begin) * 3 / 4
                T1, T2 = delay_at(e["delay"], t1), delay_at(e["delay"], t2)
                slope = (T2 - T1) / (t2 - t1)
                # Over a short stretch the slope of a constant is rounding only.
                if e["delay"]["kind"] == "piecewise_constant":
                    slope = 0.0
                values += [T1 - slope * t1, slope]
        return values

    def run(self, sample_times, step, generations=2):
        """States at the sample times."""
        end = self.problem["end_s"]
        start = start_state(self.problem)
        breaks = [time for time, _ in break_points(self.problem, generations)]
        # Restarts closer than the corner would run backwards.
        breaks = [b for k, b in enumerate(breaks) if k == 0 or b - breaks[k - 1] > 10 * CORNER]
        solver = self.solver
        solver.purge_past()
        solver.DDE = None
        # The sender's first values, dq among them, as constants: not its motion.
        solver.constant_past(start, time=0.0)
        samples = {}
        stops = breaks + [end]
        for begin, stop in zip(stops, stops[1:]):
            solver.set_parameters(self.parameters(begin, stop))
            solver.jump(0.0, begin, width=CORNER, forward=False)
            inside = [s for s in sample_times if begin - SAME_TIME <= s <= stop + SAME_TIME]
            for target in sorted(set(inside + [stop])):
                if abs(target - begin) < 10 * CORNER:
                    samples.setdefault(target, np.array(solver.DDE.get_current_state()))
                    continue
                if abs(target - stop) < 10 * CORNER:
                    target_time = stop
                else:
                    target_time = target
                if target_time - solver.t > 10 * CORNER:
                    solver.integrate_blindly(target_time, step)
                samples[target] = np.array(solver.DDE.get_current_state())
        return np.array([samples[s] for s in sample_times])
