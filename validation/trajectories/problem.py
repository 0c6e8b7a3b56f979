"""Problems as plain dictionaries: robots, gains, graphs, delays.

A problem is exactly what is written into a case file, so everything below
works on what a reader of the file sees.
"""

import math

import numpy as np

GRAVITY = 9.81


# ---------------------------------------------------------------- robots

def planar_arm(lengths, masses, centres=None, inertias=None, gravity=GRAVITY):
    """Two-link arm in a vertical plane; thin rods unless told otherwise."""
    l1, l2 = lengths
    m1, m2 = masses
    lc1, lc2 = centres or (l1 / 2, l2 / 2)
    i1, i2 = inertias or (m1 * l1**2 / 12, m2 * l2**2 / 12)
    theta = [
        i1 + i2 + m1 * lc1**2 + m2 * (l1**2 + lc2**2),
        i2 + m2 * lc2**2,
        m2 * l1 * lc2,
        gravity * (m1 * lc1 + m2 * l1),
        gravity * m2 * lc2,
    ]
    return {
        "kind": "planar_arm",
        "lengths_m": [l1, l2],
        "masses_kg": [m1, m2],
        "centres_m": [lc1, lc2],
        "inertias_kg_m2": [i1, i2],
        "gravity_m_s2": gravity,
        "theta": theta,
    }


def point_mass(dimension, mass):
    return {"kind": "point_mass", "dimension": dimension, "mass_kg": mass, "theta": [mass]}


def dimension(robot):
    return 2 if robot["kind"] == "planar_arm" else robot["dimension"]


# ---------------------------------------------------------------- agents

def polynomial_of_roots(roots):
    """alpha_0 .. alpha_{l-1} of prod_r (p + kappa_r); the leading 1 is left out."""
    coefficients = np.array([1.0])
    for kappa in roots:
        coefficients = np.convolve(coefficients, [kappa, 1.0])
    return [float(a) for a in coefficients[:-1]]


def agent(robot, roots, K=8.0, Gamma=10.0, knows_theta=False, q=None, dq=None,
          reference=None, theta_hat=None, manipulability=0.0):
    """One agent with every default written out, but for `lambda`, which is zero where it is missing."""
    m = dimension(robot)
    q = [0.0] * m if q is None else list(q)
    dq = [0.0] * m if dq is None else list(dq)
    if reference is None:
        reference = [list(dq)] * bool(roots) + [[0.0] * m for _ in roots[1:]]
    if theta_hat is None:
        theta_hat = robot["theta"] if knows_theta else [0.0] * len(robot["theta"])
    return {
        "robot": robot,
        "roots": list(roots),
        "alpha": polynomial_of_roots(roots),
    } | ({"lambda": manipulability} if manipulability else {}) | {
        "K": K,
        "Gamma": Gamma,
        "knows_theta": knows_theta,
        "start": {
            "q": q,
            "dq": dq,
            "reference": [list(row) for row in reference],
            "theta_hat": list(theta_hat),
        },
    }


def as_matrix(gain, size):
    """A gain given as a number, a diagonal or a full matrix."""
    gain = np.asarray(gain, dtype=float)
    if gain.ndim == 0:
        return float(gain) * np.eye(size)
    return np.diag(gain) if gain.ndim == 1 else gain


# ---------------------------------------------------------------- delays

def constant(seconds):
    return {"kind": "constant", "s": seconds}


def sinusoid(mean, amplitude, period, phase=0.0):
    return {"kind": "sinusoid", "mean_s": mean, "amplitude_s": amplitude,
            "period_s": period, "phase_rad": phase}


def piecewise_constant(times, values, period=None):
    delay = {"kind": "piecewise_constant", "times_s": times, "values_s": values}
    return delay if period is None else delay | {"period_s": period}


def saw_tooth(smallest, largest, period, offset=0.0):
    return {"kind": "saw_tooth", "min_s": smallest, "max_s": largest,
            "period_s": period, "offset_s": offset}


def delay_at(delay, t):
    """The definition, to the letter.  Only for times well inside a piece: at
    the jumps themselves rounding decides which side is seen."""
    kind = delay["kind"]
    if kind == "constant":
        return delay["s"]
    if kind == "sinusoid":
        angle = 2 * math.pi * t / delay["period_s"] + delay["phase_rad"]
        return delay["mean_s"] + delay["amplitude_s"] * math.sin(angle)
    if kind == "piecewise_constant":
        if "period_s" in delay:
            t = math.fmod(t, delay["period_s"])
        latest = max(k for k, start in enumerate(delay["times_s"]) if start <= t)
        return delay["values_s"][latest]
    if kind == "saw_tooth":
        turns = (t + delay["offset_s"]) / delay["period_s"]
        span = delay["max_s"] - delay["min_s"]
        return delay["min_s"] + span * (turns - math.floor(turns))
    raise ValueError(kind)


# ---------------------------------------------------------------- graphs

def edge(sender, receiver, weight, delay):
    """The receiver hears the sender."""
    return {"from": sender, "to": receiver, "weight": weight, "delay": delay}


def fixed(edges):
    return {"kind": "fixed", "edges": edges}


def repeat(*phases):
    return {"kind": "repeat",
            "phases": [{"dwell_s": dwell, "edges": edges} for dwell, edges in phases]}


def once(*phases):
    """Each phase in turn; the last one lasts for ever, whatever its dwell."""
    return repeat(*phases) | {"kind": "once"}


def phase_starts(schedule, end):
    """(start time, edges) of every phase that begins before the end."""
    if schedule["kind"] == "fixed":
        return [(0.0, schedule["edges"])]
    dwells = [phase["dwell_s"] for phase in schedule["phases"]]
    offsets = [sum(dwells[:k]) for k in range(len(dwells))]
    period = sum(dwells)
    cycles = 1 if schedule["kind"] == "once" else math.ceil(end / period) + 1
    starts = [
        (cycle * period + offset, phase["edges"])
        for cycle in range(cycles)
        for offset, phase in zip(offsets, schedule["phases"])
    ]
    return [(start, edges) for start, edges in starts if start < end]


def edges_at(schedule, t):
    """The definition, to the letter; as `delay_at`, for times inside a phase."""
    if schedule["kind"] == "fixed":
        return schedule["edges"]
    phases = schedule["phases"]
    if schedule["kind"] == "repeat":
        t = math.fmod(t, sum(phase["dwell_s"] for phase in phases))
    for phase in phases:
        if t < phase["dwell_s"]:
            return phase["edges"]
        t -= phase["dwell_s"]
    return phases[-1]["edges"]


# ---------------------------------------------------------------- whole problems

CONSENSUS = {"kind": "consensus"}
PURE_INTEGRAL = {"kind": "pure_integral"}


def backstepping(filter_s):
    return {"kind": "backstepping", "filter_s": filter_s}


def reference_of(problem):
    return problem.get("reference", CONSENSUS)


def reference_vectors(problem):
    """How many vectors of state the reference dynamics have: z, z', .., or the filter."""
    return 1 if reference_of(problem)["kind"] == "backstepping" else problem["order"]


def reference_start(problem):
    """Those vectors at t = 0, agent by agent.  The filter starts settled, at
    sum_j w_ij (q_j - q_i), and everybody hears initial positions."""
    agents = problem["agents"]
    if reference_of(problem)["kind"] != "backstepping":
        return [a["start"]["reference"] for a in agents]
    settled = [[0.0] * dimension(a["robot"]) for a in agents]
    for e in edges_at(problem["schedule"], 0.0):
        mine, told = (agents[e[end]]["start"]["q"] for end in ("to", "from"))
        for axis in range(len(mine)):
            settled[e["to"]][axis] += e["weight"] * (told[axis] - mine[axis])
    return [[vector] for vector in settled]


def problem(name, description, end, exchange, agents, schedule, reference=CONSENSUS):
    """`reference` is left out of the file for the consensus family."""
    return {
        "format": "forwardstep trajectory, version 1",
        "name": name,
        "description": description,
        "end_s": end,
    } | ({} if reference == CONSENSUS else {"reference": reference}) | {
        "order": len(agents[0]["roots"]),
        "exchange": exchange,
        "agents": agents,
        "schedule": schedule,
    }
