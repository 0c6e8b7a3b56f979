"""Delay equations by the method of steps, on SciPy's DOP853.

The integration restarts at every break-point, so within one run everything
is smooth; which phase of the graph and which piece of a delay holds is
decided once per run, at its middle, hence one-sided values at both ends.
What was heard is read from the dense output of earlier steps, never from the
step under way: no step is longer than the smallest delay in use.
"""

import math

import numpy as np
from scipy.integrate import DOP853

from break_points import SAME_TIME, break_points, delay_pieces, piece_at
from closed_loop import ClosedLoop
from problem import phase_starts


class History:
    """q and dq of every agent as the pieces of DOP853's dense output."""

    def __init__(self, start):
        self.count = 0
        shape = start.shape  # (n, 2, m)
        self.begin = np.empty(64)
        self.length = np.empty(64)
        self.value = np.empty((64, *shape))
        self.F = np.empty((64, 7, *shape))
        self.start = start

    def append(self, dense, n, m):
        if self.count == len(self.begin):
            for name in ("begin", "length", "value", "F"):
                old = getattr(self, name)
                setattr(self, name, np.concatenate([old, np.empty_like(old)]))
        k = self.count
        self.begin[k] = dense.t_old
        self.length[k] = dense.h
        self.value[k] = dense.y_old[: 2 * n * m].reshape(2, n, m).swapaxes(0, 1)
        self.F[k] = dense.F[:, : 2 * n * m].reshape(7, 2, n, m).swapaxes(1, 2)
        self.count += 1

    def at(self, times, senders):
        """(q, dq) of senders[e] at times[e], shape (edges, 2, m)."""
        if self.count == 0:
            return self.start[senders]
        k = np.searchsorted(self.begin[: self.count], times, side="right") - 1
        # Before t = 0 the piece of t = 0 is read at its beginning, where it
        # holds the initial values.
        k = np.maximum(k, 0)
        x = np.maximum((times - self.begin[k]) / self.length[k], 0.0)[:, None, None]
        F = self.F[k, :, senders]
        y = np.zeros_like(F[:, 0])
        for order in range(6, -1, -1):
            y += F[:, order]
            y *= x if order % 2 == 0 else 1.0 - x
        return y + self.value[k, senders]


class Links:
    """The edges of one smooth stretch of time."""

    def __init__(self, loop, edges, pieces):
        n, count = loop.n, len(edges)
        self.senders = np.array([e["from"] for e in edges], dtype=int)
        receivers = np.array([e["to"] for e in edges], dtype=int)
        weights = np.array([e["weight"] for e in edges], dtype=float)
        self.mix = np.zeros((n, count))
        self.mix[receivers, np.arange(count)] = weights
        self.total_weight = self.mix.sum(axis=1, keepdims=True)
        self.gain = loop.message_gain[receivers][:, :, None]
        self.zero = np.array([piece.is_zero() for piece in pieces], dtype=bool)
        self.any_zero, self.all_zero = self.zero.any(), self.zero.all()
        names = ("offset", "slope", "origin", "amplitude", "omega", "phase")
        (self.offset, self.slope, self.origin, self.amplitude, self.omega, self.phase) = (
            np.array([getattr(piece, name) for piece in pieces]) for name in names)
        self.largest_step = min((piece.largest_step() for piece in pieces), default=math.inf)

    def heard(self, t, now, history):
        if not self.senders.size:
            return 0.0
        if self.all_zero:
            messages = now[self.senders]
        else:
            delay = (self.offset + self.slope * (t - self.origin)
                     + self.amplitude * np.sin(self.omega * t + self.phase))
            messages = history.at(t - delay, self.senders)
            if self.any_zero:
                messages[self.zero] = now[self.senders[self.zero]]
        return self.mix @ (self.gain * messages).sum(axis=1)


def solve(problem, sample_times, rtol=1e-13, atol=1e-14, generations=2, longest_step=0.02):
    """States at the sample times, shape (times, state), the closed loop, and what
    is asked for at those times, z and dz: from the left, but at t = 0.

    Error control sees the ends of steps only; the longest step keeps the dense
    output between them, which others hear, as good as the ends.
    """
    loop = ClosedLoop(problem)
    n, m, end = loop.n, loop.m, problem["end_s"]
    breaks = [t for t, _ in break_points(problem, generations)]
    # Samples are ends of steps, not interpolated.
    stops = list(breaks) + [end]
    for t in sample_times:
        if min(abs(t - stop) for stop in stops) > SAME_TIME:
            stops.append(t)
    stops = np.array(sorted(stops))

    phases = phase_starts(problem["schedule"], end)
    starts = np.array([start for start, _ in phases])
    pieces_of = [[delay_pieces(e["delay"], end) for e in edges] for _, edges in phases]

    now_of = lambda y: y[: 2 * n * m].reshape(2, n, m).swapaxes(0, 1)
    y = loop.start
    history = History(now_of(y).copy())
    at_stop, asked_at_stop = [y.copy()], []
    for begin, stop in zip(stops, stops[1:]):
        middle = (begin + stop) / 2
        phase = int(np.searchsorted(starts, middle, side="right")) - 1
        links = Links(loop, phases[phase][1],
                      [piece_at(pieces, middle) for pieces in pieces_of[phase]])

        def rate(t, y):
            return loop.rate(y, links.heard(t, now_of(y), history), links.total_weight)

        def asked(t, y):
            return loop.asked(y, links.heard(t, now_of(y), history), links.total_weight)

        if begin == 0.0:
            asked_at_stop.append(asked(begin, y))
        solver = DOP853(rate, begin, y, stop, rtol=rtol, atol=atol,
                        max_step=min(links.largest_step, longest_step))
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed":
                raise RuntimeError(f"t = {solver.t}: {message}")
            history.append(solver.dense_output(), n, m)
        y = solver.y
        at_stop.append(y.copy())
        asked_at_stop.append(asked(stop, y))

    nearest = [int(np.abs(stops - t).argmin()) for t in sample_times]
    return np.array([at_stop[k] for k in nearest]), loop, [asked_at_stop[k] for k in nearest]
