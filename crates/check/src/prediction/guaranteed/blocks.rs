//! How much of the spread is left when, for certain: the operator over blocks of time, each begun anew where the one before it no longer
//! gains.

use forwardstep_core::expression::Interval;
use forwardstep_sim::delay::{Basis, Delay, HoldLog, RandomHold};
use forwardstep_sim::schedule::{Extent, Segment};

use super::super::repeats::Repeats;
use super::cells::Cells;
use super::network::Network;
use super::{Fall, Repeat};
use crate::prediction::SHARE;

/// What looking at a cell costs, of what making one does.
const LOOK: f64 = 0.02;
/// Times the fastest rate that a cell is long, where that is not too much work.
const SHORT: f64 = 0.05;
/// The same where a weight changes: what is not known of it in a cell is lost.
const SHORTER: f64 = 0.0125;
/// How much later than the one before it the next look at what is left is, as a part of the time since the beginning of a block.
const LATER: f64 = 0.02;
/// Times the horizon of the run that is looked ahead where all is known for ever.
const HORIZONS: f64 = 10.0;
/// A block ends when its mean rate has fallen to this part of the best one, and that was reached in half the time: what is on its way makes
/// steps.
const TIRED: f64 = 0.7;
/// A block that leaves more than this gains nothing.
const NOTHING: f64 = 0.999;
/// A part by which less must be left for it to be listed.
const LISTED: f64 = 0.9;
/// Numbers of past cells that are kept.
const MOST_NUMBERS: f64 = 8e6;

/// What is worked with.
#[derive(Debug)]
pub(super) struct Blocks<'a> {
    network: &'a Network,
    repeats: Option<Repeats>,
    /// No cell is longer, s.
    cell_s: f64,
    /// How far what is known reaches, s.
    reach_s: f64,
    /// Cells that may be made.
    cells: f64,
}

/// When what is looked at.
#[derive(Clone, Copy, Debug)]
enum Looks {
    /// Ever later.
    Later,
    /// After whole periods, s.
    Every(f64),
}

impl<'a> Blocks<'a> {
    /// Blocks of `network` of so much work: multiplications, roughly. In short cells they may not reach far; in long ones they reach the end
    /// of the run, and lose more.
    pub(super) fn of(network: &'a Network, repeats: Option<Repeats>, work: f64) -> [Self; 2] {
        let (end_s, n) = (network.ideal.time.end_s, network.components() as f64);
        let on_run = Interval { low: 0.0, high: end_s };
        let graphs = &network.ideal.network.schedule.graphs;
        let edges = graphs.iter().map(Vec::len).max().unwrap_or(0) as f64 * network.sent as f64;
        let cells = work / (n * (n + 8.0 * edges));
        let sent = (network.sent * network.first.len()) as f64;
        let short = if network.has_constant_weights() { SHORT } else { SHORTER };
        let short_s =
            (short / network.fastest_per_s(on_run)).max(network.window_s * 2.0 * sent * n / MOST_NUMBERS).min(end_s);
        let reach_s = if repeats.is_some() { HORIZONS * end_s } else { end_s };
        [short_s, short_s.max(2.0 * end_s / cells)].map(|cell_s| Blocks { network, repeats, cell_s, reach_s, cells })
    }

    /// When what is left at most for certain, from the start on.
    pub(super) fn falls(&self) -> Vec<Fall> {
        let (mut falls, mut before, mut from_s): (Vec<Fall>, f64, f64) = (Vec::new(), 1.0, 0.0);
        let mut cells = self.cells;
        loop {
            let looks = self.block(from_s, from_s == 0.0, Looks::Later, SHARE / before, &mut cells);
            let Some(best) = best(&looks, from_s).filter(|best| best.left < NOTHING) else { return falls };
            for look in looks {
                falls.push(Fall { t_s: look.t_s, left: (before * look.left).next_up() });
            }
            if falls.last().is_some_and(|last| last.left <= SHARE) {
                return falls;
            }
            (before, from_s) = ((before * best.left).next_up(), best.t_s);
        }
    }

    /// What is left after so long, from any time on that is a whole number of periods after the start, again and again.
    pub(super) fn repeat(&self) -> Option<Repeat> {
        let looks = match self.repeats? {
            Repeats::Always => Looks::Later,
            Repeats::Every(period_s) => Looks::Every(period_s),
        };
        let looks = self.block(0.0, false, looks, 0.0, &mut self.cells.clone());
        let best = best(&looks, 0.0).filter(|best| best.left < NOTHING)?;
        Some(Repeat { over_s: best.t_s, left: best.left })
    }

    /// One block, until it leaves `enough`, gains no more, or nothing more is known: what it leaves at some times.
    fn block(&self, from_s: f64, from_start: bool, looks: Looks, enough: f64, left: &mut f64) -> Vec<Fall> {
        let mut cells = Cells::new(self.network, from_s, from_start);
        let (mut found, mut best, mut best_s): (Vec<Fall>, f64, f64) = (Vec::new(), 0.0, from_s);
        let next = |t_s: f64, count: usize| match looks {
            Looks::Later => t_s + (LATER * (t_s - from_s)).max(10.0 * self.cell_s),
            Looks::Every(period_s) => from_s + (count + 1) as f64 * period_s,
        };
        let mut look_s = next(from_s, 0);
        for Segment { start_s, end_s, graph } in self.network.ideal.network.schedule.segments() {
            if start_s >= self.reach_s {
                break;
            }
            while cells.t_s < end_s {
                let until_s = end_s.min(look_s).min(self.reach_s);
                // As many cells of one length as it takes.
                let count = ((until_s - cells.t_s) / self.cell_s).ceil().max(1.0);
                let to_s = if count <= 1.0 { until_s } else { cells.t_s + (until_s - cells.t_s) / count };
                if to_s <= cells.t_s || *left <= 0.0 {
                    return found;
                }
                cells.advance(to_s, graph);
                *left -= 1.0;
                if to_s >= look_s {
                    let fall = Fall { t_s: to_s, left: cells.left() };
                    *left -= LOOK * cells.kept() as f64;
                    found.push(fall);
                    look_s = next(to_s, found.len());
                    let rate = fall.rate_per_s(from_s);
                    if rate > best {
                        (best, best_s) = (rate, to_s);
                    }
                    let is_late = to_s - from_s > 2.0 * (best_s - from_s);
                    if fall.left <= enough || (best > 0.0 && rate < TIRED * best && is_late) {
                        return found;
                    }
                }
            }
        }
        found
    }
}

/// In the order of time those that leave less than all before them, by enough to be listed.
pub(super) fn listed(mut falls: Vec<Fall>) -> Vec<Fall> {
    falls.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
    let mut least = NOTHING;
    falls.retain(|fall| {
        let is_less = fall.left <= LISTED * least || (fall.left <= SHARE && least > SHARE);
        least = if is_less { fall.left } else { least };
        is_less
    });
    falls
}

/// The look of the best mean rate.
fn best(looks: &[Fall], from_s: f64) -> Option<Fall> {
    let rate = |look: &Fall| look.rate_per_s(from_s);
    looks.iter().copied().max_by(|a, b| rate(a).total_cmp(&rate(b)))
}

impl Fall {
    fn rate_per_s(&self, from_s: f64) -> f64 {
        -libm::log(self.left.max(f64::MIN_POSITIVE)) / (self.t_s - from_s)
    }
}

/// Whether the run is one of many that were drawn, or is only known as far as it goes by what somebody says.
pub(super) fn is_drawn(network: &Network) -> bool {
    let ideal = &network.ideal.network;
    let drawn = |delay: &Delay| {
        let known = delay.known();
        let drawn = delay.downcast::<RandomHold>().is_some() || delay.downcast::<HoldLog>().is_some();
        known.holds_packets || known.basis == Basis::Declared || drawn
    };
    let switching = match ideal.schedule.known().extent {
        Extent::Drawn => ideal.schedule.constant_graph().is_none(),
        Extent::Horizon => true,
        Extent::Whole | Extent::Period(_) => false,
    };
    switching || ideal.used_delays().any(|index| drawn(&ideal.delays[index]))
}
