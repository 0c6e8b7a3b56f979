"""Closed loops by the classical Runge-Kutta method, with delays by the method of steps. Needs nothing but Python.

Steps are of equal length between stops: times at which the graph switches or a delay jumps, the times at which that is heard and
heard again, and the times of samples. What happens between two stops is decided by their middle, so both sides of a jump see
their own limit. What was sent is read from cubic Hermite pieces, one per step, which are as good as the method; no delay is
shorter than a step.
"""

import bisect
import json
import math
import pathlib

# Stops this close to one another are one.
SAME_S = 1e-10


class Network:
    """Graphs in turn, each for `dwell` seconds: lists of (from, to). One delay: `low` at first, growing to `high` within `period`,
    and so on."""

    def __init__(self, graphs, dwell, low=0.0, high=0.0, period=math.inf):
        self.graphs, self.dwell = graphs, dwell
        self.low, self.high, self.period = low, high, period

    def heard_by(self, agent, middle):
        graph = self.graphs[int(middle // self.dwell) % len(self.graphs)]
        return [sender for sender, receiver in graph if receiver == agent]

    def sent_s(self, t, middle):
        """When what is heard at t was sent."""
        if self.period == math.inf:
            return t - self.low
        since = t - math.floor(middle / self.period) * self.period
        return t - self.low - (self.high - self.low) * since / self.period

    def stops(self, end):
        """Jumps in [0, end], and their images through the delay, twice."""
        teeth = [(k * self.period, (k + 1) * self.period) for k in range(math.ceil(end / self.period))] \
            if self.period < math.inf else [(0.0, end)]
        jumps = [k * self.dwell for k in range(math.ceil(end / self.dwell))] + [begin for begin, _ in teeth]
        slope = (self.high - self.low) / self.period
        found, fresh = set(jumps), jumps
        for _ in range(2):
            images = [(t + self.low - slope * begin) / (1 - slope) for t in fresh for begin, _ in teeth]
            fresh = [image for image in images
                     if any(b <= image < e and abs(self.sent_s(image, (b + e) / 2) - t) < 1e-9
                            for t in fresh for b, e in teeth)]
            found.update(fresh)
        return [t for t in found if 0.0 < t < end]


class Past:
    """The numbers of a state that others hear, at every time so far."""

    def __init__(self, state, sent):
        self.sent, self.first = sent, [state[k] for k in sent]
        self.begins, self.pieces = [], []

    def add(self, begin, length, state, rate, next_state, next_rate):
        self.begins.append(begin)
        self.pieces.append([(length, state[k], rate[k], next_state[k], next_rate[k]) for k in self.sent])

    def at(self, entry, t):
        if t <= 0.0 or not self.begins:
            return self.first[entry]
        k = bisect.bisect_right(self.begins, t) - 1
        h, x, dx, y, dy = self.pieces[k][entry]
        u = (t - self.begins[k]) / h
        assert u < 1.0 + 1e-6, "a delay shorter than a step"
        v = 1.0 - u
        return v * v * ((1.0 + 2.0 * u) * x + u * h * dx) + u * u * ((1.0 + 2.0 * v) * y - v * h * dy)


def solve(rate, state, samples, step, stops=(), sent=()):
    """The states at `samples`. `rate(t, state, middle, past)` is the vector field between two stops around `middle`."""
    marks = []
    for t in sorted([0.0, *stops, *samples]):
        if t <= samples[-1] and (not marks or t - marks[-1] > SAME_S):
            marks.append(t)
    past, seen, state = Past(state, sent), [], list(state)
    moved = lambda k, h: [x + h * dx for x, dx in zip(state, k)]
    for begin, stop in zip(marks, marks[1:]):
        count = max(1, math.ceil((stop - begin) / step - 1e-6))
        h, middle = (stop - begin) / count, (begin + stop) / 2
        k1 = rate(begin, state, middle, past)
        for n in range(count):
            t = begin + n * h
            k2 = rate(t + h / 2, moved(k1, h / 2), middle, past)
            k3 = rate(t + h / 2, moved(k2, h / 2), middle, past)
            k4 = rate(t + h, moved(k3, h), middle, past)
            after = [x + h / 6 * (a + 2 * (b + c) + d) for x, a, b, c, d in zip(state, k1, k2, k3, k4)]
            # Nobody can hear this step before its end, so its last rate may come first.
            end_rate = rate(t + h, after, middle, past)
            past.add(t, h, state, k1, after, end_rate)
            state, k1 = after, end_rate
        if any(abs(stop - t) <= SAME_S for t in samples):
            seen.append(state)
    assert len(seen) == len(samples)
    return seen


def checked(run, step, limit):
    """What `run(step)` gives, which half as many steps must not change by more than `limit`."""
    fine, coarse = run(step), run(2 * step)
    gap = max(abs(a - b) for p, q in zip(fine, coarse) for a, b in zip(p, q))
    assert gap < limit, gap
    return fine, gap


def rounded(value):
    """Numbers with twelve digits, which is more than is known."""
    if isinstance(value, float):
        return float(f"{value:.12g}")
    if isinstance(value, dict):
        return {key: rounded(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(entry) for entry in value]
    return value


def write(path, cases):
    """A line per signal."""
    lines = []
    for case in cases:
        agents = [",\n   ".join(f"{json.dumps(k)}: {json.dumps(rounded(v))}" for k, v in agent.items())
                  for agent in case["agents"]]
        body = "},\n  {".join(agents)
        lines.append(f' {{"name": {json.dumps(case["name"])}, "t_s": {json.dumps(rounded(case["t_s"]))}, "agents": [\n'
                     f"  {{{body}}}]}}")
    text = "[\n" + ",\n".join(lines) + "\n]\n"
    json.loads(text)
    pathlib.Path(path).write_text(text)


def polynomial(roots):
    """The coefficients of the product of all (p + root), the constant one first, the leading one last."""
    out = [1.0]
    for root in roots:
        out = [root * a + b for a, b in zip(out + [0.0], [0.0] + out)]
    return out
