//! The stepping itself.

mod failure;

use super::delayed_inputs::{DelayedInputs, Heard, Needs, Port};
use super::forcing::Forcing;
use super::history::History;
use super::kernels::{PieceSource, combine, error_norm, make_piece, piece_gap};
use super::system::{DelaySystem, EventOutcome, Step};
use super::tableau::{CLASSICAL, DORMAND_PRINCE, Tableau};
use super::timeline::{Passed, Timeline, merge_until};
use crate::network::Network;
use crate::recording::Statistics;
use crate::setup::{Method, Solver};
pub(crate) use failure::{Failure, FailureCause};

/// The part of the tolerance that one step may use up, so that the error of the whole run stays below ten times what was
/// asked for even where the problem magnifies what goes in (by twenty to forty in the worst of the test problems).
const SHARE_PER_STEP: f64 = 0.2;

/// After a jump of the right-hand side fast transients start anew: a step of the old length would be rejected, or worse,
/// pass by luck.
const RESTART: f64 = 0.2;

/// Second-generation images are worth landing on below this relative tolerance.
const SECOND_GENERATION_BELOW: f64 = 1e-5;

/// Rounds of the fixed point when a delay is shorter than the step; it contracts by about h·w per round.
const DRAFT_ROUNDS: u32 = 12;

/// The draft is good enough when it differs from the piece that it led to by no more than this part of the tolerance; what
/// is left in the piece is smaller by the contraction.
const DRAFT_ACCURACY: f64 = 0.3;

/// After a jump there is nothing to draft from. A step is then cut down to the shortest delay, if it is not longer than
/// this many times that delay: the fixed point would take about four rounds.
const WORTH_CUTTING: f64 = 4.0;

/// Coefficients of a piece of history for every number that is sent.
const COEFFICIENTS: usize = 5;

/// Steps through a [`DelaySystem`] on a [`Network`].
#[derive(Debug)]
pub(crate) struct Integrator<'a> {
    network: &'a Network,
    timeline: Timeline<'a>,
    hearing: DelayedInputs,
    history: History,
    heard: Heard,
    tableau: &'static Tableau,
    /// Tolerances of the error control; with a fixed step only those of the draft.
    rtol: f64,
    atol: f64,
    fixed_step_s: Option<f64>,
    min_step_s: f64,
    max_step_s: f64,
    forcing: Forcing,
    forget_s: f64,
    end_s: f64,

    step: Step,
    /// State at the start of the step, at its end, and of the stage at hand.
    x0: Vec<f64>,
    x1: Vec<f64>,
    stage: Vec<f64>,
    /// Derivatives at the stages.
    k: [Vec<f64>; 7],
    /// The piece that the last round made, to compare the draft with.
    piece: Vec<f64>,
    /// k[0] must be computed anew: at the start and after a jump of the right-hand side.
    stale: bool,
    /// The last piece of history goes on smoothly into this step.
    smooth: bool,
    /// What the network did at the start of this step.
    passed: Passed,
    /// The step that the error control would like next, s.
    proposed_step_s: f64,
    statistics: Statistics,
}

impl<'a> Integrator<'a> {
    /// Prepares a run over [0, `end_s`] from the state `x`.
    ///
    /// `ports` says where every agent's message of `entries` numbers stands; `forcing` is what enters as a function of time.
    pub(crate) fn new(
        network: &'a Network,
        solver: &Solver,
        end_s: f64,
        x: Vec<f64>,
        ports: Vec<Port>,
        entries: usize,
        forcing: Forcing,
    ) -> Self {
        let (tableau, rtol, atol, fixed_step_s) = match solver.method {
            Method::Adaptive { rtol, atol } => (&DORMAND_PRINCE, SHARE_PER_STEP * rtol, SHARE_PER_STEP * atol, None),
            Method::Fixed { step_s } => (&CLASSICAL, 1e-10, 1e-12, Some(step_s)),
        };
        let generations = if rtol < SHARE_PER_STEP * SECOND_GENERATION_BELOW || fixed_step_s.is_some() { 2 } else { 1 };
        let timeline = Timeline::new(network, end_s, generations);
        let mut heard = Heard { degree: vec![0.0; ports.len()], sums: vec![0.0; ports.len() * entries] };
        let mut hearing = DelayedInputs::new(ports, entries, &x, network.coupling);
        hearing.rewire(&timeline, network.schedule.graph(timeline.graph()), &mut heard);
        let width = COEFFICIENTS * hearing.width();
        let n = x.len();
        let stages = tableau.c.len();
        Integrator {
            network,
            timeline,
            history: History::new(width, solver.memory_budget_bytes),
            hearing,
            heard,
            tableau,
            rtol,
            atol,
            fixed_step_s,
            min_step_s: solver.min_step_s,
            max_step_s: solver.max_step_s.unwrap_or(f64::INFINITY),
            forcing,
            forget_s: network.max_delay_s(),
            end_s,
            step: Step { start_s: 0.0, end_s: 0.0 },
            x0: x.clone(),
            x1: x,
            stage: vec![0.0; n],
            k: std::array::from_fn(|s| if s < stages { vec![0.0; n] } else { Vec::new() }),
            piece: vec![0.0; width],
            stale: true,
            smooth: false,
            passed: Passed::default(),
            proposed_step_s: 0.0,
            statistics: Statistics::default(),
        }
    }

    /// What everybody sent before t = 0; see [`DelayedInputs::told_before`].
    pub(crate) fn told_before(&mut self, messages: &[Vec<f64>]) {
        self.hearing.told_before(messages);
    }

    /// The least that history takes when all agents together send so many numbers.
    pub(crate) fn least_bytes(numbers: usize) -> u64 {
        History::least_bytes(COEFFICIENTS.saturating_mul(numbers))
    }

    /// The state at the end of the last step.
    pub(crate) fn state(&self) -> &[f64] {
        &self.x1
    }

    /// What the network did at the start of the last step.
    pub(crate) fn passed(&self) -> Passed {
        self.passed
    }

    /// Work done so far.
    pub(crate) fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Makes one step. `None` when the horizon has been reached.
    pub(crate) fn advance(&mut self, system: &mut impl DelaySystem) -> Result<Option<Step>, Failure> {
        let t = self.step.end_s;
        if t >= self.end_s {
            return Ok(None);
        }
        // The rows within the last step have been read.
        if !self.history.make_room(t - self.forget_s) {
            return Err(self.history_is_full(system, t));
        }
        self.begin(system, t);
        self.smooth = !self.stale;
        if self.stale {
            self.derivative_at_start(system, t)?;
        }
        if self.proposed_step_s == 0.0 {
            self.proposed_step_s = self.fixed_step_s.unwrap_or_else(|| self.first_step());
        }
        let mut limit_s = self.max_step_s;
        if self.fixed_step_s.is_none() {
            let proposed_s = self.proposed_step_s.min(limit_s).min(self.end_s - t);
            limit_s = limit_s.min(self.forcing.longest_step_s(t, proposed_s));
        }
        if !self.smooth {
            let shortest_s = self.hearing.shortest_delay(&self.timeline, t);
            if self.proposed_step_s > shortest_s && self.proposed_step_s < WORTH_CUTTING * shortest_s {
                limit_s = limit_s.min(shortest_s);
            }
        }
        loop {
            let next = self.timeline.next_s().min(self.timeline.or_horizon(system.next_event_s()));
            let left = next - t;
            let h = self.proposed_step_s.min(limit_s);
            // Never leave a sliver before a break-point: land on it, or go half-way.
            let (h, lands) = if h >= left * (1.0 - 1e-9) {
                (left, true)
            } else if self.fixed_step_s.is_none() && 2.0 * h > left {
                (0.5 * left, false)
            } else {
                (h, false)
            };
            if h < self.min_step_s && !lands || t + h <= t {
                return Err(self.step_is_under_floor(system, t, h));
            }
            let predicted_step_s = self.stages(system, t, h);
            let (error, finite) = self.judge(h);
            if !finite {
                if h <= self.min_step_s * 4.0 || self.fixed_step_s.is_some() {
                    return Err(Failure { t_s: t, state: self.first_not_finite(), cause: FailureCause::NotFinite });
                }
                limit_s = 0.25 * h;
                self.proposed_step_s = limit_s;
                self.statistics.rejected += 1;
                continue;
            }
            if predicted_step_s.is_none() || error > 1.0 {
                limit_s = h * if predicted_step_s.is_some() { step_factor(error) } else { 0.5 };
                if self.fixed_step_s.is_none() {
                    self.proposed_step_s = limit_s;
                }
                self.statistics.rejected += 1;
                continue;
            }
            if self.fixed_step_s.is_none() {
                let growth = step_factor(error);
                // A step cut short by a break-point says little about the step that would have been possible.
                self.proposed_step_s =
                    if h < self.proposed_step_s { self.proposed_step_s.max(h * growth) } else { h * growth };
                self.proposed_step_s = self.proposed_step_s.min(predicted_step_s.unwrap_or(f64::INFINITY));
            }
            let end_s = if lands { next } else { t + h };
            self.keep(t, h, end_s);
            return Ok(Some(self.step));
        }
    }

    /// Moves to the start of the next step: what happens at this instant happens now.
    fn begin(&mut self, system: &mut impl DelaySystem, t: f64) {
        if self.statistics.steps > 0 {
            std::mem::swap(&mut self.x0, &mut self.x1);
            self.k.swap(0, self.tableau.c.len() - 1);
            system.settle(&mut self.x0);
        }
        self.passed = Passed::default();
        if t > 0.0 && self.timeline.next_s() <= merge_until(t) {
            self.statistics.break_points += 1;
            self.passed = self.timeline.pass(t);
            if self.passed.switched {
                let edges = self.network.schedule.graph(self.timeline.graph());
                self.hearing.rewire(&self.timeline, edges, &mut self.heard);
            }
            if self.passed.jumped {
                self.restart();
            }
        }
        let until_s = merge_until(t);
        if self.passed.jumped || system.next_event_s() <= until_s {
            self.hear(t);
            let network = if self.passed.jumped { EventOutcome::Jumped } else { EventOutcome::Nothing };
            match system.happen(until_s, &mut self.x0, &self.heard, network) {
                EventOutcome::Nothing => {}
                EventOutcome::Sampled => self.stale = true,
                EventOutcome::Jumped => {
                    self.restart();
                    self.timeline.send_images(t, 0);
                }
            }
        }
    }

    /// The right-hand side has jumped.
    fn restart(&mut self) {
        self.stale = true;
        if self.fixed_step_s.is_none() {
            self.proposed_step_s *= RESTART;
        }
    }

    /// Gathers what is heard at the start of the next step.
    fn hear(&mut self, t: f64) {
        let offset = self.history.draft().0;
        self.hearing.look(&self.timeline, &self.history, t, (t, 1.0, offset));
        self.hearing.gather(&self.history, &self.x0, &mut self.heard);
    }

    fn derivative_at_start(&mut self, system: &mut impl DelaySystem, t: f64) -> Result<(), Failure> {
        self.hear(t);
        system.rates(t, &self.x0, &self.heard, &mut self.k[0]);
        self.statistics.evaluations += 1;
        self.stale = false;
        match self.k[0].iter().position(|rate| !rate.is_finite()) {
            Some(state) => Err(Failure { t_s: t, state, cause: FailureCause::NotFinite }),
            None => Ok(()),
        }
    }

    /// A first step from the size of the state and its rate; the error control corrects it.
    fn first_step(&self) -> f64 {
        let (mut size, mut rate) = (0.0_f64, 0.0_f64);
        for (x, k) in self.x0.iter().zip(&self.k[0]) {
            let scale = self.rtol * x.abs() + self.atol;
            size = size.max(x.abs() / scale);
            rate = rate.max(k.abs() / scale);
        }
        let h = if size < 1e-5 || rate < 1e-5 { 1e-6 } else { 0.01 * size / rate };
        // A guess that is too short is no reason to give up: the error of the step says what it should be.
        h.max(self.min_step_s).min(self.end_s)
    }

    /// Fills k and `x1`. Where a delay is shorter than the step the piece being made is drafted, used, made, and compared
    /// with its draft until they agree. The step for which one round would do; `None` when no number of rounds did.
    fn stages(&mut self, system: &mut impl DelaySystem, t: f64, h: f64) -> Option<f64> {
        let tableau = self.tableau;
        let last = tableau.c.len() - 1;
        let mut drafted = false;
        let (mut first, mut before) = (0.0, 0.0);
        for round in 0..DRAFT_ROUNDS {
            let mut any = Needs::default();
            let mut gathered_at = -1.0;
            for s in 1..=last {
                let mut weights = [0.0; 7];
                for (weight, a) in weights.iter_mut().zip(tableau.a[s]) {
                    *weight = h * a;
                }
                let row = &weights[..tableau.a[s].len()];
                let state = if s == last { &mut self.x1 } else { &mut self.stage };
                combine(&self.x0, row, &self.k, state);
                let stage_s = t + tableau.c[s] * h;
                if tableau.c[s] != gathered_at || any.present {
                    let offset = self.history.draft().0;
                    let needs = self.hearing.look(&self.timeline, &self.history, stage_s, (t, h, offset));
                    if needs.draft && !drafted {
                        self.predict(t, h);
                        drafted = true;
                    }
                    any.draft |= needs.draft;
                    any.present |= needs.present;
                    let state = if s == last { &self.x1 } else { &self.stage };
                    self.hearing.gather(&self.history, state, &mut self.heard);
                    gathered_at = tableau.c[s];
                }
                let state = if s == last { &self.x1 } else { &self.stage };
                system.rates(stage_s, state, &self.heard, &mut self.k[s]);
            }
            self.statistics.evaluations += last as u64;
            if !any.draft {
                return Some(f64::INFINITY);
            }
            let gap = self.redraft(h);
            if round == 0 {
                first = gap;
            }
            // What the next round would still change, by the contraction seen between the last two; after the first nothing is known of it.
            let contraction = if round == 0 { 1.0 } else { (gap / before).min(1.0) };
            before = gap;
            if gap <= DRAFT_ACCURACY || contraction < 0.5 && contraction * gap <= DRAFT_ACCURACY {
                // A step a little shorter that needs one round is cheaper; one less than half as long is not.
                let factor = fifth_root_factor(first / DRAFT_ACCURACY);
                return Some(if (0.5..1.0).contains(&factor) { h * factor } else { f64::INFINITY });
            }
        }
        None
    }

    /// A first draft of the current piece: the last piece continued or, after a jump, a straight line.
    fn predict(&mut self, t: f64, h: f64) {
        let width = self.hearing.width();
        if self.smooth && self.history.extrapolate(width, t, h) {
            return;
        }
        let (_, draft) = self.history.draft();
        draft.fill(0.0);
        for &(state, entry, n) in self.hearing.blocks() {
            for i in 0..n {
                draft[entry + i] = self.x0[state + i];
                draft[width + entry + i] = h * self.k[0][state + i];
            }
        }
    }

    /// Makes the piece anew from the stages and puts it in the place of its draft; the largest difference between the two
    /// as a part of the tolerance.
    fn redraft(&mut self, h: f64) -> f64 {
        let (source, blocks, width) = piece_source(self.tableau, &self.x0, &self.x1, &self.k, h, &self.hearing);
        make_piece(source, blocks, width, &mut self.piece);
        let (_, draft) = self.history.draft();
        let gap = piece_gap(&self.piece, draft, width, self.atol, self.rtol);
        draft.copy_from_slice(&self.piece);
        gap
    }

    /// The error as a part of the tolerance, and whether everything is finite.
    fn judge(&self, h: f64) -> (f64, bool) {
        if self.tableau.error.is_empty() {
            return (0.0, self.x1.iter().all(|x| x.is_finite()));
        }
        let mut weights = [0.0; 7];
        for (weight, e) in weights.iter_mut().zip(self.tableau.error) {
            *weight = h * e;
        }
        error_norm(&self.x0, &self.x1, &weights, &self.k, self.atol, self.rtol)
    }

    fn keep(&mut self, t: f64, h: f64, end_s: f64) {
        let (source, blocks, width) = piece_source(self.tableau, &self.x0, &self.x1, &self.k, h, &self.hearing);
        make_piece(source, blocks, width, self.history.draft().1);
        self.history.commit(t, end_s);
        self.step = Step { start_s: t, end_s };
        self.statistics.steps += 1;
    }

    /// The state and what is heard at `t_s` within the last step; at its ends from the inside.
    pub(crate) fn look_inside(&mut self, t_s: f64) -> (&[f64], &Heard) {
        self.state_at(t_s);
        let (offset, end_s) = (self.history.draft().0, self.step.end_s);
        self.hearing.look(&self.timeline, &self.history, t_s, (end_s, 1.0, offset));
        self.hearing.gather(&self.history, &self.stage, &mut self.heard);
        (&self.stage, &self.heard)
    }

    /// The state alone.
    pub(crate) fn state_at(&mut self, t_s: f64) -> &[f64] {
        let Step { start_s, end_s } = self.step;
        let h = end_s - start_s;
        if t_s >= end_s {
            self.stage.copy_from_slice(&self.x1);
        } else {
            let mut weights = self.tableau.dense_weights((t_s - start_s) / h);
            for weight in &mut weights {
                *weight *= h;
            }
            combine(&self.x0, &weights[..self.tableau.c.len()], &self.k, &mut self.stage);
        }
        &self.stage
    }
}

/// By how much the next step may differ from one with this `error`, which goes with its fifth power.
fn step_factor(error: f64) -> f64 {
    const SAFETY: f64 = 0.9;
    const GROWTH: f64 = 5.0;
    (SAFETY * fifth_root_factor(error)).clamp(1.0 / GROWTH, GROWTH)
}

/// error^(−1/5), cut off outside [1/8, 8].
fn fifth_root_factor(error: f64) -> f64 {
    if error < 3.0e-5 { 8.0 } else { libm::pow(error, -0.2).max(0.125) }
}

/// What [`make_piece`] needs.
fn piece_source<'a>(
    tableau: &Tableau,
    x0: &'a [f64],
    x1: &'a [f64],
    k: &'a [Vec<f64>; 7],
    h: f64,
    hearing: &'a DelayedInputs,
) -> (PieceSource<'a>, &'a [(usize, usize, usize)], usize) {
    let mut dense = [0.0; 7];
    for (dense, d) in dense.iter_mut().zip(tableau.dense) {
        *dense = h * d;
    }
    (PieceSource { x0, x1, k: &k[..tableau.c.len()], dense, h }, hearing.blocks(), hearing.width())
}
