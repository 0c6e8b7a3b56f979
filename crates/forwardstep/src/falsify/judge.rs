//! What a case is held against.
//!
//! Where no tracking error is left, s ≡ 0, the interval of the cascaded variables and of what is on its way never grows, whatever the
//! graphs and delays do, and shrinks by what is guaranteed: that can be refuted in finite time. Of whole closed loops the balance of V has to hold, a run whose hypotheses
//! all hold must not break down, its error must fall over doubled horizons, and where the value agreed upon is known beforehand it must be
//! that one. That a limit exists no run refutes: what has not fallen after the last doubling is undecided.

use std::ops::ControlFlow;

use forwardstep::check::hypothesis::FollowingEvidence;
use forwardstep::check::prediction::guaranteed::WORK;
use forwardstep::check::prediction::{CascadeSpread, Fall, guaranteed_rate};
use forwardstep::check::{Answer, Evidence, Report, check, ideal, predict};
use forwardstep::io::diagnostic::SourceText;
use forwardstep::io::output::{BalanceResidual, Disagreement, Metrics, ending_sentence};
use forwardstep::io::scenario::{Inputs, Scenario, read_scenario};
use forwardstep::sim::reference::PureIntegral;
use forwardstep::sim::{Ending, Method, Outcome, Setup, simulate};

use crate::number::short;

use super::case::Case;

/// Doublings of the horizon at most.
const DOUBLINGS: u32 = 4;
/// A part of the largest error so far that counts as fallen, and a multiple of it that counts as risen.
const FALLEN: f64 = 0.5;
const RISEN: f64 = 1.5;
/// Errors below this are rounding and tolerance.
const SMALL: f64 = 1e-5;
/// How far V + ∫ dissipation may be off, as a part of V(0): by a tenth of it where tolerances are tight.
const BALANCE: f64 = 1e-4;
const TIGHT: Method = Method::Adaptive { rtol: 1e-11, atol: 1e-13 };
/// Parts of the first disagreement: what is left of one that is over, and how far from the value that was predicted it may then be, beside some
/// times what is left. Tracking errors fall without a rate, and the last of them still moves all.
const OVER: f64 = 1e-3;
const NEAR: f64 = 1e-2;
const TIMES_LEFT: f64 = 20.0;
/// How far the interval may grow by tolerance, as a part of what it was.
const GROWTH: f64 = 1e-6;

/// What became of a case.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Verdict {
    /// The interval of the cascade did not grow; no fall of it is guaranteed on the horizon.
    Kept,
    /// It shrank at least by what is guaranteed.
    Shrank,
    /// The balance holds and the error falls.
    Fell,
    /// It falls, and all come to where it was predicted.
    Reached,
    /// The balance holds; `check` promises nothing more.
    Balanced,
    /// The error had not fallen after the last doubling.
    Undecided,
    /// No scenario, or one that `check` or the cascade says nothing about.
    Silent(String),
    /// What was claimed is not so.
    Failed(Failure),
}

/// What was claimed and is not so.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Failure {
    /// The interval of the cascade grew by this part.
    Grew { part: f64, t_s: f64 },
    /// More of the interval of the cascade is left than is guaranteed.
    LeftMore { left: f64, guaranteed: f64, t_s: f64 },
    /// V + ∫ dissipation − V(0) is this part of V(0).
    Unbalanced { relative: f64, t_s: f64 },
    /// A run broke down though all hypotheses hold.
    BrokeDown(String),
    /// The error over the longest horizon is above all before though all hypotheses hold.
    Rose { most: f64, last: f64 },
    /// All agree, so far from the value that was predicted.
    Elsewhere { away: f64, disagreement: f64 },
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Failure::Grew { part, t_s } => {
                write!(
                    f,
                    "without tracking errors the spread of the cascade grew by {} of itself until t = {t_s} s",
                    short(*part)
                )
            }
            Failure::LeftMore { left, guaranteed, t_s } => {
                write!(
                    f,
                    "without tracking errors {} of the spread of the cascade is left at t = {t_s} s, guaranteed is {}",
                    short(*left),
                    short(*guaranteed)
                )
            }
            Failure::Unbalanced { relative, t_s } => {
                write!(f, "V + ∫ dissipation differs from V(0) by {} of it at t = {t_s} s", short(*relative))
            }
            Failure::BrokeDown(why) => write!(f, "all hypotheses hold, and the run broke down: {why}"),
            Failure::Rose { most, last } => {
                write!(
                    f,
                    "all hypotheses hold, and the error over 16 times the horizon is {}, above {} over shorter ones",
                    short(*last),
                    short(*most)
                )
            }
            Failure::Elsewhere { away, disagreement } => {
                write!(
                    f,
                    "they agree to {}, {} from the value that is predicted for certain",
                    short(*disagreement),
                    short(*away)
                )
            }
        }
    }
}

impl Failure {
    /// Whether another failure is of the same kind.
    pub(crate) fn is_like(&self, other: &Failure) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

/// Judges a case.
pub(crate) fn judge(case: &Case) -> Verdict {
    let scenario = match read(case) {
        Ok(scenario) => scenario,
        Err(error) => return Verdict::Silent(error),
    };
    if case.alone { without_errors(&scenario.setup) } else { whole(case, &scenario.setup) }
}

/// The scenario of a case.
pub(crate) fn read(case: &Case) -> Result<Scenario, String> {
    let source = SourceText::new("drawn.toml", case.to_string());
    read_scenario("drawn", &source, Inputs::default()).map_err(|error| error.to_string())
}

pub(super) fn run(setup: &Setup) -> Result<Outcome, String> {
    simulate(setup, &mut |_| ControlFlow::Continue(())).map_err(|error| error.to_string())
}

/// The same, given up when it is `stopped`: one run of a large scenario may take longer than all of a search.
pub(super) fn run_unless(setup: &Setup, stopped: &dyn Fn() -> bool) -> Result<Outcome, String> {
    let mut goes_on = |_| if stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let outcome = simulate(setup, &mut goes_on).map_err(|error| error.to_string())?;
    match outcome.ending {
        Ending::Interrupted { .. } => Err("it was stopped".to_owned()),
        _ => Ok(outcome),
    }
}

fn without_errors(setup: &Setup) -> Verdict {
    let ideal = match ideal(setup) {
        Ok(ideal) => ideal,
        Err(reason) => return Verdict::Silent(reason.to_string()),
    };
    let varies = setup.network.schedule.graphs.iter().flatten().any(|edge| edge.weight.constant().is_none());
    if varies && setup.reference.is::<PureIntegral>() {
        // ẇ (ψᵢ − ψⱼ) is in what (3) and (23) integrate.
        return Verdict::Silent("a weight varies under (3) or (23), of which nothing is claimed".into());
    }
    let spread = run(&ideal).and_then(|outcome| match outcome.ending {
        Ending::Completed => {
            let spread = CascadeSpread::of(&ideal, &outcome.recording).map_err(|reason| reason.to_string())?;
            Ok((spread, outcome.recording.t_s))
        }
        Ending::Interrupted { .. } | Ending::CutOff { .. } | Ending::BrokeDown(_) => {
            Err("the run did not complete".into())
        }
    });
    match spread {
        Ok((spread, t_s)) => match grown(&spread, &t_s) {
            Some(failure) => Verdict::Failed(failure),
            None => shrunk(setup, &spread, &t_s),
        },
        Err(reason) => Verdict::Silent(reason),
    }
}

/// Whether the interval shrinks by what is guaranteed, as far as anything is.
fn shrunk(setup: &Setup, spread: &CascadeSpread, t_s: &[f64]) -> Verdict {
    let Ok(found) = guaranteed_rate(setup, WORK) else { return Verdict::Kept };
    match left_more(spread, t_s, setup.time.record_every_s, &found.falls) {
        Some(Some(failure)) => Verdict::Failed(failure),
        Some(None) => Verdict::Shrank,
        None => Verdict::Kept,
    }
}

/// Of which fall the interval of an axis leaves more than it should; nothing where none can be judged before the last row.
pub(super) fn left_more(spread: &CascadeSpread, t_s: &[f64], every_s: f64, falls: &[Fall]) -> Option<Option<Failure>> {
    // What is on its way at a row is looked at from the last row before the window on.
    let row_of = |fall: &Fall| t_s.partition_point(|t_s| *t_s < fall.t_s + every_s);
    let mut judged = falls.iter().filter_map(|fall| Some((*fall, row_of(fall), *t_s.get(row_of(fall))?))).peekable();
    judged.peek()?;
    let size = size(spread);
    Some(judged.find_map(|(Fall { left: guaranteed, .. }, row, t_s)| {
        let widths = spread.low.iter().zip(&spread.high).map(|(low, high)| (high[0] - low[0], high[row] - low[row]));
        let more = |(start, now): &(f64, f64)| {
            let over = now - guaranteed * start;
            over > GROWTH * size || over.is_nan()
        };
        let (start, now) = widths.into_iter().find(more)?;
        Some(Failure::LeftMore { left: now / start, guaranteed, t_s })
    }))
}

/// The size of the numbers at the start. Tolerances go by it: of an axis on which all start in one place the others tell.
fn size(spread: &CascadeSpread) -> f64 {
    let first = |row: &[f64]| row.first().copied().unwrap_or(0.0);
    let axes = spread.low.iter().zip(&spread.high);
    let sizes = axes.flat_map(|(low, high)| [first(high) - first(low), first(low).abs(), first(high).abs()]);
    sizes.fold(f64::MIN_POSITIVE, f64::max)
}

/// When, and by how much, the interval left what it was at the start: there, what is on its way is known exactly.
pub(super) fn grown(spread: &CascadeSpread, t_s: &[f64]) -> Option<Failure> {
    let first = |row: &[f64]| row.first().copied().unwrap_or(0.0);
    let size = size(spread);
    let worst = spread.low.iter().zip(&spread.high).flat_map(|(low, high)| {
        let out = |(now_low, now_high): (&f64, &f64)| (first(low) - now_low).max(now_high - first(high)) / size;
        low.iter().zip(high).map(out).zip(t_s).collect::<Vec<_>>()
    });
    let (part, t_s) = worst.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    (part > GROWTH || part.is_nan()).then_some(Failure::Grew { part, t_s: *t_s })
}

fn whole(case: &Case, setup: &Setup) -> Verdict {
    let report = check(setup);
    let (never_ends, small) = (promised(&report, &[]), SMALL.max(4.0 * left(&report)));
    // What a run watches was so in one that did not end by it.
    let promised = promised(&report, &[Answer::Watched]);
    let value = predict(setup).ok().filter(|_| promised).map(|prediction| prediction.value);
    let mut errors = Vec::new();
    for doublings in 0..=DOUBLINGS {
        // What is drawn or bounded is made for a horizon.
        let mut setup = match read(&Case { end_s: case.end_s * f64::from(1 << doublings), ..case.clone() }) {
            Ok(scenario) => scenario.setup,
            Err(reason) => return Verdict::Silent(reason),
        };
        let outcome = match run(&setup) {
            Ok(outcome) => outcome,
            Err(reason) => return Verdict::Silent(reason),
        };
        if let Ending::BrokeDown(_) = &outcome.ending {
            return match never_ends {
                true => Verdict::Failed(Failure::BrokeDown(ending_sentence(&setup, &outcome.ending))),
                false => Verdict::Silent("it broke down, and nothing is promised".into()),
            };
        }
        let metrics = Metrics::of(&setup, &outcome.recording, value.as_deref(), None);
        if metrics.balance_residual.is_some_and(|residual| is_off(residual.relative, BALANCE)) {
            // What tolerances leave falls with them.
            setup.solver.method = TIGHT;
            match run(&setup).map(|outcome| Metrics::of(&setup, &outcome.recording, None, None).balance_residual) {
                Ok(Some(BalanceResidual { relative, t_s, .. })) if is_off(relative, 0.1 * BALANCE) => {
                    return Verdict::Failed(Failure::Unbalanced { relative, t_s });
                }
                Ok(_) => {}
                Err(reason) => return Verdict::Silent(reason),
            }
        }
        let Some(late) = late(&setup, outcome).filter(|_| promised) else { return Verdict::Balanced };
        errors.push(late);
        match (decided(&errors, small), Whither::of(&metrics, late)) {
            // What is left may still be on its way there.
            (Some(Verdict::Fell), Some(Whither::Unclear | Whither::Elsewhere { .. })) if doublings < DOUBLINGS => {}
            (Some(Verdict::Fell), Some(Whither::There)) => return Verdict::Reached,
            (Some(Verdict::Fell), Some(Whither::Elsewhere { away })) => {
                return Verdict::Failed(Failure::Elsewhere { away, disagreement: late });
            }
            (Some(verdict), _) => return verdict,
            (None, _) => {}
        }
    }
    Verdict::Undecided
}

/// Where agents come to that are to agree on a value known beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Whither {
    There,
    Elsewhere {
        away: f64,
    },
    /// Too much of the disagreement is left.
    Unclear,
}

impl Whither {
    /// Nothing where no value was predicted.
    fn of(metrics: &Metrics, late: f64) -> Option<Whither> {
        let away = metrics.agreement.as_ref()?.iter().map(|axis| axis.distance).fold(0.0, f64::max);
        let Disagreement::Measured { initial, .. } = metrics.disagreement else { return None };
        Some(Whither::judged(away, initial, late))
    }

    pub(super) fn judged(away: f64, initial: f64, late: f64) -> Whither {
        match away {
            away if away <= (NEAR * initial).max(SMALL) + TIMES_LEFT * late => Whither::There,
            away if late <= (OVER * initial).max(SMALL) => Whither::Elsewhere { away },
            _ => Whither::Unclear,
        }
    }
}

/// What the errors late in runs over doubled horizons decide, if anything. They are held against the largest before: an error that falls without
/// a rate may be small by chance over a short horizon.
pub(super) fn decided(errors: &[f64], small: f64) -> Option<Verdict> {
    let (last, before) = errors.split_last()?;
    let most = before.iter().copied().fold(0.0, f64::max);
    if *last <= small || *last < FALLEN * most {
        return Some(Verdict::Fell);
    }
    let rose = before.len() == DOUBLINGS as usize && *last > RISEN * most;
    rose.then_some(Verdict::Failed(Failure::Rose { most, last: *last }))
}

/// What is not a number is off.
fn is_off(relative: f64, bound: f64) -> bool {
    relative > bound || relative.is_nan()
}

/// The largest error, or disagreement, of the last quarter of a run: at its end alone it may be zero by chance.
pub(super) fn late(setup: &Setup, mut outcome: Outcome) -> Option<f64> {
    let recording = &mut outcome.recording;
    let from = 3 * recording.t_s.len() / 4;
    recording.t_s.drain(..from);
    recording.columns.iter_mut().for_each(|column| drop(column.values.drain(..from)));
    match Metrics::of(setup, recording, None, None).disagreement {
        Disagreement::Measured { largest, .. } => Some(largest),
        Disagreement::Absent(_) => None,
    }
}

/// What a sign that is held for a while leaves, by what is known before the run.
fn left(report: &Report) -> f64 {
    let mut most: f64 = 0.0;
    for hypothesis in &report.hypotheses {
        if let Evidence::Following(FollowingEvidence::Sign { left, .. }) = &hypothesis.evidence
            && left.is_finite()
        {
            most = most.max(*left);
        }
    }
    most
}

/// Whether all hypotheses hold, for all time or as long as anything is known, or have one of these answers.
fn promised(report: &Report, also: &[Answer]) -> bool {
    report.hypotheses.iter().all(|hypothesis| match hypothesis.answer() {
        Answer::Holds | Answer::HoldsOnHorizon => true,
        other @ (Answer::Watched | Answer::NotShown | Answer::NotCovered | Answer::Violated) => also.contains(&other),
    })
}
