"""Where the closed loop is not smooth, found before the run.

A delay is cut into pieces that are smooth functions of time.  A break-point
of generation 0 is t = 0, a switch of the graph or a jump of a delay; one of
generation k + 1 is a time at which some agent hears a break-point of
generation k, that is, a root t of t - T(t) = b.
"""

import math
from dataclasses import dataclass

from scipy.optimize import brentq

from problem import phase_starts

SAME_TIME = 1e-11


@dataclass(frozen=True)
class DelayPiece:
    """T(t) = offset + slope (t - origin) + amplitude sin(omega t + phase)
    for start <= t <= stop."""

    start: float
    stop: float
    offset: float
    slope: float = 0.0
    origin: float = 0.0
    amplitude: float = 0.0
    omega: float = 0.0
    phase: float = 0.0

    def at(self, t):
        return (self.offset + self.slope * (t - self.origin)
                + self.amplitude * math.sin(self.omega * t + self.phase))

    def is_zero(self):
        return self.offset == self.slope == self.amplitude == 0.0

    def largest_step(self):
        """A step from any t0 of this piece may not be longer than this, so
        that what is heard within the step lies before t0."""
        if self.is_zero() or self.slope >= 1.0:
            # Zero delay is read from the state.  With a slope of one or more
            # the heard time does not move forwards at all.
            return math.inf
        smallest = min(self.at(self.start), self.at(self.stop))
        if self.amplitude:
            smallest = self.offset - abs(self.amplitude)
        if smallest < 1e-6:
            raise NotImplementedError("a delay that touches zero without staying there")
        return smallest

    def hears(self, instant):
        """All t in this piece with t - T(t) = instant."""
        if not self.amplitude:
            rate = 1.0 - self.slope
            if abs(rate) < 1e-12:
                return []  # the heard time stands still; only jumps matter
            roots = [(instant + self.offset - self.slope * self.origin) / rate]
        else:
            roots = self._sinusoid_roots(instant)
        return [t for t in roots if self.start <= t <= self.stop]

    def _sinusoid_roots(self, instant):
        low = instant + self.offset - abs(self.amplitude) - 1e-9
        high = instant + self.offset + abs(self.amplitude) + 1e-9
        turning = []
        steepness = 1.0 / (self.amplitude * self.omega)
        if abs(steepness) < 1.0:
            # t - T(t) runs backwards at times: cut where its rate is zero.
            for angle in (math.acos(steepness), -math.acos(steepness)):
                first = math.floor((self.omega * low + self.phase - angle) / (2 * math.pi))
                last = math.ceil((self.omega * high + self.phase - angle) / (2 * math.pi))
                for turn in range(first, last + 1):
                    turning.append((2 * math.pi * turn + angle - self.phase) / self.omega)
        marks = [low] + sorted(t for t in turning if low < t < high) + [high]
        gap = lambda t: t - self.at(t) - instant
        return [brentq(gap, a, b, xtol=1e-15, rtol=1e-15)
                for a, b in zip(marks, marks[1:]) if gap(a) * gap(b) < 0]


def delay_pieces(delay, end):
    kind = delay["kind"]
    if kind == "constant":
        return [DelayPiece(0.0, end, delay["s"])]
    if kind == "sinusoid":
        return [DelayPiece(0.0, end, delay["mean_s"], amplitude=delay["amplitude_s"],
                           omega=2 * math.pi / delay["period_s"], phase=delay["phase_rad"])]
    if kind == "piecewise_constant":
        period = delay.get("period_s")
        cycles = 1 if period is None else math.ceil(end / period) + 1
        marks = [((period or 0.0) * cycle + start, value)
                 for cycle in range(cycles)
                 for start, value in zip(delay["times_s"], delay["values_s"])]
        stops = [start for start, _ in marks[1:]] + [math.inf]
        return [DelayPiece(start, min(stop, end), value)
                for (start, value), stop in zip(marks, stops) if start < end]
    if kind == "saw_tooth":
        period = delay["period_s"]
        slope = (delay["max_s"] - delay["min_s"]) / period
        pieces = []
        turn = math.floor(delay["offset_s"] / period)
        while (wrap := turn * period - delay["offset_s"]) < end:
            turn += 1
            stop = min(turn * period - delay["offset_s"], end)
            if stop > 0.0:
                pieces.append(DelayPiece(max(wrap, 0.0), stop, delay["min_s"], slope, wrap))
        return pieces
    raise ValueError(kind)


def piece_at(pieces, t):
    return next(piece for piece in pieces if piece.start <= t <= piece.stop)


def break_points(problem, generations):
    """Sorted [(time, generation)] in [0, end], and the end itself."""
    end = problem["end_s"]
    phases = phase_starts(problem["schedule"], end)
    stops = [start for start, _ in phases[1:]] + [end]

    # (sender, receiver, piece) for every stretch of every edge in use, and the
    # times at which something jumps for the receiver.
    stretches = []
    current = {(0.0, i) for i in range(len(problem["agents"]))}
    for (start, edges), stop in zip(phases, stops):
        current |= {(start, i) for i in range(len(problem["agents"]))}
        for e in edges:
            for piece in delay_pieces(e["delay"], end):
                if piece.stop > start and piece.start < stop:
                    clipped = DelayPiece(**(vars(piece) | {
                        "start": max(piece.start, start), "stop": min(piece.stop, stop)}))
                    stretches.append((e["from"], e["to"], clipped))
                    current.add((clipped.start, e["to"]))

    found = {}  # (rounded time, agent) -> (time, generation)
    for generation in range(generations + 1):
        fresh = set()
        for t, i in current:
            key = (round(t / SAME_TIME), i)
            if not any((key[0] + shift, i) in found for shift in (-1, 0, 1)):
                found[key] = (t, generation)
                fresh.add((t, i))
        current = {
            (heard, receiver)
            for t, i in fresh
            for sender, receiver, piece in stretches if sender == i
            for heard in piece.hears(t)
        }

    merged = []
    for t, generation in sorted(found.values()):
        if merged and t - merged[-1][0] < 10 * SAME_TIME:
            if generation < merged[-1][1]:
                merged[-1] = (t, generation)
        elif t < end - 10 * SAME_TIME:
            merged.append((t, generation))
    return merged
