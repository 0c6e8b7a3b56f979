//! The course of agreement: the disagreement over time and the value agreed upon, by simulating the reference dynamics alone.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_sim::reference::PureIntegral;
use forwardstep_sim::{
    Adaptive, AgentSetup, ChainLaw, PositionOnlyLaw, Progress, RecordAt, Recording, Setup, Signal, ThrustLaw, TimeSpan,
    check_setup,
};
use thiserror::Error;

use crate::agreement::{NoPrediction, predict};
use crate::kinds::{is_its_own_reference, is_lagrangian};
use crate::practical::{Gains, fastest_reference_per_s, start_energy_j};
use crate::surroundings::acts;

use super::cascade::{CascadeSpread, NoCascade};
use super::ideal::{NoIdeal, behind_leader, ideal, start_error, told_before};
use super::settled::{Settled, only_passes, settled};
use super::torque::{PeakTorque, peak_torques, relative_error};
use super::unfinished::{Unfinished, completed, simulated};

/// How agreement comes about when every agent follows its reference exactly, s ≡ 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// Time of every row, s: those of a run of the robots, or a quarter of what fits into memory where a run's do not.
    pub t_s: Vec<f64>,
    /// max |q_i − q_j| over agents and axes, row by row; rad or m.
    pub disagreement: Vec<f64>,
    /// The mean of the positions at the last row, one entry per axis.
    pub value: Vec<f64>,
    /// Where the value agreed upon lies, one interval per axis: the cascaded variables and the messages on their way at the
    /// last row. Theirs is an interval that never grows.
    pub within: Result<Vec<[f64; 2]>, NoCascade>,
    /// When the disagreement has settled.
    pub settled: Settled,
    /// The largest torque of every axis of robots under (6)–(7).
    pub peak_torques: Vec<PeakTorque>,
    /// How far a run begins from this course.
    pub start: StartError,
    /// Whether s can move the value, so that a run in which s is not zero may agree elsewhere.
    pub moved_by_s: bool,
}

/// How far from s ≡ 0 a run begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartError {
    /// The largest |s(0)| of an axis, where z(0) is given beside the velocity.
    pub s: f64,
    /// V(0) of all robots under (6)–(7) together, J; `None` where it is not known.
    pub energy_j: Option<f64>,
    /// The largest relative error of an estimate of any law; zero where all is known.
    pub estimate_off: f64,
}

impl StartError {
    fn of(setup: &Setup) -> StartError {
        let pure = setup.reference.is::<PureIntegral>();
        let errors = setup.agents.iter().filter(|_| !pure).map(start_error);
        let energy = |(index, agent)| start_energy_j(setup, index, &Gains::of(agent)?);
        let robots = setup.agents.iter().enumerate().filter(|(_, agent)| is_lagrangian(agent));
        let energies: Option<Vec<f64>> = robots.map(energy).collect();
        let energy_j =
            energies.filter(|all| !all.is_empty()).map(|all| all.iter().sum()).filter(|sum: &f64| sum.is_finite());
        let estimate_off = setup.agents.iter().map(estimate_off).fold(0.0, f64::max);
        StartError { s: errors.fold(0.0, f64::max), energy_j, estimate_off }
    }
}

/// Whether s can move the value that is agreed upon. Over a fixed graph with constant delays Q of `agreement` holds it whatever s does,
/// where s drops out of Q; there `predict` has a value. While graphs or delays change nothing holds it, and q̇ = z + s makes positions run
/// on by ∫ s, unless s ≡ 0 is what a run has. Without a measured velocity z stands in the place of q̇ in all that is conserved, and ∫ s
/// is never in it. With λ of Remark 4, and by forces under (46), Q itself moves.
fn moved_by_s(setup: &Setup) -> bool {
    let conserved = match predict(setup) {
        // Q is there, and too few of its digits, or that all come to rest by it.
        Ok(_) | Err(NoPrediction::Uncertain { .. } | NoPrediction::ComplexRoots { .. }) => true,
        Err(_) => false,
    };
    let moves_it = |agent: &AgentSetup| {
        agent.manipulability != 0.0 || is_its_own_reference(agent) && agent.pushes.iter().any(acts)
    };
    let held = conserved && !setup.agents.iter().any(moves_it);
    let nothing_moves = setup.control.is_none() && setup.agents.iter().all(stays_zero);
    !(held || nothing_moves)
}

/// Whether s of an agent begins at zero, and nothing drives it away: of (6)–(7) and (a8) with the true parameters, and under (46), which has none.
fn stays_zero(agent: &AgentSetup) -> bool {
    let rubs = !agent.robot.interface().drives.friction.is_empty();
    if rubs || agent.enforce_limits || agent.pushes.iter().any(acts) {
        return false;
    }
    let from_reference = || {
        let at_rest = vec![0.0; agent.start.dq.len()];
        let followed = if agent.law.is::<PositionOnlyLaw>() { &at_rest } else { &agent.start.dq };
        *agent.start.reference.first().unwrap_or(followed) == agent.start.dq
    };
    let leads = is_lagrangian(agent) || agent.law.is::<PositionOnlyLaw>();
    is_its_own_reference(agent) || leads && from_reference() && estimate_off(agent) == 0.0
}

/// The largest relative error that an estimate of the agent's law starts with.
fn estimate_off(agent: &AgentSetup) -> f64 {
    let law = &agent.law;
    let mass: Option<f64> = law
        .downcast()
        .map(|law: &PositionOnlyLaw| law.estimate_start)
        .or_else(|| law.downcast().and_then(|law: &ThrustLaw| law.design.estimate_start()));
    let mass = mass.as_ref().map(std::slice::from_ref);
    let own = || law.downcast().map(|law: &Adaptive| law.estimate_start.as_slice());
    let chain = || law.downcast().and_then(ChainLaw::estimate).map(|estimate| estimate.start.as_slice());
    let estimate = mass.or_else(own).or_else(chain).unwrap_or_default();
    estimate
        .iter()
        .zip(&agent.robot.theta)
        .map(|(estimate, theta)| relative_error(*estimate, *theta))
        .fold(0.0, f64::max)
}

/// Why the course of agreement cannot be predicted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoCourse {
    /// The references depend on more than the network.
    #[error(transparent)]
    Ideal(#[from] NoIdeal),
    /// There is nothing to compare.
    #[error("there are no two agents to compare")]
    FewerThanTwoAgents,
    /// The reference dynamics alone were not simulated to the end.
    #[error(transparent)]
    Unfinished(#[from] Unfinished),
}

impl Course {
    /// Whether agreement is reached on the horizon: the last disagreement is at most 1 % of the largest, and not only in passing.
    pub fn is_reached(&self) -> bool {
        let largest = self.disagreement.iter().copied().fold(0.0, f64::max);
        let bound = super::settled::SHARE * largest;
        let is_near = self.disagreement.last().is_some_and(|last| *last <= bound);
        is_near && !only_passes(&self.t_s, &self.disagreement, bound)
    }
}

/// Predicts the course of agreement of `setup` by simulating [`ideal`]; `observer` as that of [`simulate`](forwardstep_sim::simulate).
///
/// **Guarantees**: where ϑ is known and z(0) = q̇(0) it is that of the robots, to the tolerance of the solver. Otherwise it is a prediction for s ≡ 0,
/// and so is the value where it is [`Course::moved_by_s`].
///
/// # Errors
/// [`NoCourse`] when there is none.
pub fn course(setup: &Setup, observer: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<Course, NoCourse> {
    course_within(setup, f64::INFINITY, observer)
}

/// Work for a course, in nanoseconds, roughly: about three seconds.
pub const COURSE_WORK: f64 = 3e9;

/// The same with so much `work`, such as [`COURSE_WORK`], which is counted, so that it ends at the same place everywhere.
///
/// # Errors
/// [`NoCourse`] when there is none, or it is more work.
pub fn course_within(
    setup: &Setup,
    mut work: f64,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Course, NoCourse> {
    let ideal = ideal(setup)?;
    check_setup(setup).map_err(Unfinished::from)?;
    let [first, _, ..] = ideal.agents.as_slice() else { return Err(NoCourse::FewerThanTwoAgents) };
    let axes = first.robot.axes.len();
    let before = told_before(setup, &ideal);
    let Rows { ideal, of_run, are_close } = with_enough_rows(ideal);
    let recording = completed(&ideal, before.as_deref(), &mut work, observer)?;
    let disagreement = disagreement(&recording, axes);
    let within = match before {
        // What was sent before t = 0 is in no row.
        Some(_) if ideal.network.max_delay_s() >= ideal.time.end_s => Err(NoCascade::StillOnItsWay),
        Some(_) | None => CascadeSpread::of(&ideal, &recording).map(|spread| spread.last()),
    };
    let settled = settled(&recording.t_s, &disagreement);
    let (value, mut peak_torques) = (means(&recording, axes), peak_torques(setup, &recording));
    // What lies between rows is then not known.
    peak_torques.iter_mut().filter(|_| !are_close).for_each(|peak| peak.at_most = None);
    let (start, moved_by_s) = (StartError::of(setup), moved_by_s(setup));
    let last = recording.t_s.len().saturating_sub(1);
    let is_of_run: Vec<bool> =
        recording.t_s.iter().enumerate().map(|(row, t_s)| row == last || of_run.holds(row, *t_s)).collect();
    let of_run = |all: Vec<f64>| -> Vec<f64> {
        all.into_iter().zip(&is_of_run).filter(|(_, is_of_run)| **is_of_run).map(|(value, _)| value).collect()
    };
    let (t_s, disagreement) = (of_run(recording.t_s), of_run(disagreement));
    Ok(Course { disagreement, value, within, settled, peak_torques, start, moved_by_s, t_s })
}

/// Rows of a course at least, since what settles, and what peaks, does so between the rows of a run that has few; how far apart they are in units
/// of the fastest answer of a reference, so that what swings once in between exceeds them by (0.05)²/8 of itself; and rows times axes that are not
/// exceeded for that.
const LEAST_ROWS: f64 = 1000.0;
const CLOSE: f64 = 0.05;
const MOST_ENTRIES: f64 = 1e6;

/// A setup with rows that are close enough, as far as there is room for them.
struct Rows {
    ideal: Setup,
    of_run: OfRun,
    are_close: bool,
}

/// Which of its rows are those of the run.
enum OfRun {
    /// One in so many.
    OneIn(usize),
    /// Those at these times, which rise, s.
    At(Arc<[f64]>),
}

impl OfRun {
    fn holds(&self, row: usize, t_s: f64) -> bool {
        match self {
            OfRun::OneIn(parts) => row.is_multiple_of(*parts),
            OfRun::At(times_s) => row == 0 || times_s.binary_search_by(|own_s| own_s.total_cmp(&t_s)).is_ok(),
        }
    }
}

/// The same setup with each interval between two rows cut into parts.
fn with_enough_rows(mut ideal: Setup) -> Rows {
    let axes: usize = ideal.agents.iter().map(|agent| agent.robot.axes.len()).sum();
    let close_s = CLOSE / fastest_reference_per_s(&ideal);
    let TimeSpan { end_s, record_every_s, record_at } = &mut ideal.time;
    let apart_s = close_s.min(*end_s / LEAST_ROWS).max(*end_s * axes as f64 / MOST_ENTRIES);
    let parts = |interval_s: f64| (interval_s / apart_s).ceil().max(1.0);
    let (of_run, found_s) = match record_at {
        RecordAt::Intervals => {
            let parts = parts(*record_every_s);
            *record_every_s /= parts;
            (OfRun::OneIn(parts as usize), *record_every_s)
        }
        RecordAt::Rate { hz } => {
            let parts = parts(1.0 / *hz);
            *hz *= parts;
            (OfRun::OneIn(parts as usize), 1.0 / *hz)
        }
        RecordAt::Times(times_s) => {
            let own: Arc<[f64]> = times_s.clone();
            let between = |from_s: f64, to_s: f64| {
                let parts = parts(to_s - from_s);
                (1..=parts as usize)
                    .map(move |k| if k as f64 == parts { to_s } else { from_s + (to_s - from_s) * k as f64 / parts })
            };
            let ends = own.iter().copied().chain([*end_s]).filter(|t_s| *t_s > 0.0);
            let mut rows_s = vec![0.0];
            for to_s in ends {
                let from_s = rows_s[rows_s.len() - 1];
                if to_s > from_s {
                    rows_s.extend(between(from_s, to_s));
                }
            }
            *times_s = rows_s.into();
            (OfRun::At(own), apart_s)
        }
    };
    Rows { ideal, of_run, are_close: found_s <= close_s }
}

/// What the reference dynamics alone record, as far as so much `work` leads; `None` where they depend on more than the network.
pub(crate) fn reference_alone(setup: &Setup, work: f64) -> Option<Recording> {
    followed(setup, &ideal(setup).ok()?, work)
}

/// The same with rows that are close enough for integrals.
pub(crate) fn reference_closely(setup: &Setup, work: f64) -> Option<Recording> {
    followed(setup, &with_enough_rows(ideal(setup).ok()?).ideal, work)
}

fn followed(setup: &Setup, ideal: &Setup, mut work: f64) -> Option<Recording> {
    let before = told_before(setup, ideal);
    Some(simulated(ideal, before.as_deref(), &mut work, &mut |_| ControlFlow::Continue(())).ok()?.0.recording)
}

/// The same where a leader is followed.
pub(crate) fn reference_behind(setup: &Setup, mut work: f64) -> Option<Recording> {
    let behind = behind_leader(setup)?;
    Some(simulated(&behind, None, &mut work, &mut |_| ControlFlow::Continue(())).ok()?.0.recording)
}

/// The positions of all agents on an axis.
pub(super) fn positions(recording: &Recording, axis: usize) -> impl Iterator<Item = &[f64]> {
    let of_axis = move |column: &&forwardstep_sim::Column| column.signal == Signal::Position && column.axis == axis;
    recording.columns.iter().filter(of_axis).map(|column| column.values.as_slice())
}

/// The largest difference of two positions on one of so many axes, row by row.
pub(crate) fn disagreement(recording: &Recording, axes: usize) -> Vec<f64> {
    let rows = recording.t_s.len();
    let mut largest = vec![0.0_f64; rows];
    for axis in 0..axes {
        let (mut low, mut high) = (vec![f64::INFINITY; rows], vec![f64::NEG_INFINITY; rows]);
        for column in positions(recording, axis) {
            for ((low, high), q) in low.iter_mut().zip(&mut high).zip(column) {
                (*low, *high) = (low.min(*q), high.max(*q));
            }
        }
        for ((largest, low), high) in largest.iter_mut().zip(low).zip(high) {
            *largest = largest.max(high - low);
        }
    }
    largest
}

fn means(recording: &Recording, axes: usize) -> Vec<f64> {
    let mean = |axis| {
        let last: Vec<f64> = positions(recording, axis).filter_map(|column| column.last().copied()).collect();
        last.iter().sum::<f64>() / last.len() as f64
    };
    (0..axes).map(mean).collect()
}
