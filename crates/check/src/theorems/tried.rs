//! A nonlinear protocol, tried: the desired dynamics alone, from states that are drawn.
//!
//! Every plant is replaced by the chain of integrators of its order, under feedback linearisation; every robot by a mass whose number is
//! known, under (5) with M = 1. With z(0) = x^(k−1)(0) that leaves s ≡ 0;
//! with another z(0) s falls exponentially, which is bounded and vanishes. Runs cannot show that all of them converge, so nothing holds
//! by them. One that ends farther from what it is for than it began is made longer: where it breaks down, or comes to be a thousand
//! times farther, it speaks against what is declared, and `check` says so with its start. That is no refutation in the strict sense
//! of *violated*, whose witnesses others can replay exactly: the run is computed in floating point. To end farther is not enough: a
//! run may be too short, and what swings comes back.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::expression::Expression;
use forwardstep_core::plant::VectorFormulas;
use forwardstep_sim::{
    AgentSetup, ChainLaw, ChainModel, ChainStep, Ending, Known, Outcome, RecordAt, RobotSetup, Setup, Signal, Solver,
    Start, TimeSpan, simulate,
};

use crate::hypothesis::{ReferenceEvidence, TriedRun};

/// Runs; every other one with an s.
const RUNS: usize = 8;
/// States are drawn from [−REACH, REACH].
const REACH: f64 = 2.0;
/// How fast s vanishes, 1/s.
const GAIN_PER_S: f64 = 1.0;
/// How many times longer a run is made that ends farther than it began, one after the other.
const LONGER: [f64; 4] = [4.0, 16.0, 64.0, 256.0];
/// Steps after which a run is given up: it is too stiff to tell anything in time.
const MOST_STEPS: usize = 20_000;

/// What runs from drawn states show.
pub(super) fn tried(setup: &Setup) -> ReferenceEvidence {
    let (mut runs, mut farther) = (0, None);
    for run in 0..RUNS {
        let first = match ended(setup, run, 1.0) {
            Tried::Ended(found) => found,
            Tried::GivenUp => continue,
            Tried::NotBuilt => break,
        };
        runs += 1;
        if first.to <= first.from {
            continue;
        }
        let last = made_longer(setup, run, first);
        if last.diverges() {
            return ReferenceEvidence::Tried { runs, found: Some(last) };
        }
        farther = farther.or(Some(last));
    }
    ReferenceEvidence::Tried { runs, found: farther }
}

/// What becomes of a run that ends farther than it began, for as long as it goes on doing so.
fn made_longer(setup: &Setup, run: usize, mut last: TriedRun) -> TriedRun {
    for longer in LONGER {
        if last.diverges() {
            break;
        }
        match ended(setup, run, longer) {
            Tried::Ended(next) if next.to > last.to || next.to.is_nan() => last = TriedRun { from: last.from, ..next },
            Tried::Ended(_) | Tried::GivenUp | Tried::NotBuilt => break,
        }
    }
    last
}

/// What becomes of a run.
enum Tried {
    Ended(TriedRun),
    /// It took too long.
    GivenUp,
    /// The plant has no order, or what is from outside ends before the run.
    NotBuilt,
}

/// A run of `longer` times the length that the scenario states.
fn ended(setup: &Setup, run: usize, longer: f64) -> Tried {
    let Some(mut alone) = alone(setup, run) else { return Tried::NotBuilt };
    alone.time = TimeSpan {
        end_s: longer * setup.time.end_s,
        record_every_s: longer * setup.time.record_every_s,
        record_at: if longer > 1.0 { RecordAt::Intervals } else { setup.time.record_at.clone() },
    };
    let mut steps = 0;
    let mut observer = |_| {
        steps += 1;
        if steps > MOST_STEPS { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    // A setup that cannot be built is refused before anybody asks what follows from it.
    let Ok(outcome) = simulate(&alone, &mut observer) else { return Tried::NotBuilt };
    let (from, to) = match outcome.ending {
        Ending::Interrupted { .. } | Ending::CutOff { .. } => return Tried::GivenUp,
        Ending::Completed => distances(setup, &outcome),
        Ending::BrokeDown(_) => (distances(setup, &outcome).0, f64::INFINITY),
    };
    let start = alone.agents.iter().flat_map(|agent| agent.start.q.iter().copied()).collect();
    Tried::Ended(TriedRun { start, disturbed: is_disturbed(run), from, to, until_s: alone.time.end_s })
}

fn is_disturbed(run: usize) -> bool {
    run % 2 == 1
}

/// Numbers that are spread evenly, always the same.
fn drawn(index: usize) -> f64 {
    let share = (index + 1) as f64 * 0.618_033_988_749_894_9;
    REACH * (2.0 * (share - share.floor()) - 1.0)
}

/// The desired dynamics alone; `None` for a plant without an order.
fn alone(setup: &Setup, run: usize) -> Option<Setup> {
    let integrators = |(index, own): (usize, &AgentSetup)| {
        let drawn_as = run * setup.agents.len() + index;
        if own.law.is::<ChainLaw>() { chain(own, drawn_as, run) } else { Some(mass(own, drawn_as, run)) }
    };
    let agents = setup.agents.iter().enumerate().map(integrators).collect::<Option<_>>();
    let solver = Solver { balance: false, ..setup.solver };
    Some(Setup { agents: agents?, solver, control: None, ..setup.clone() })
}

/// In place of a robot.
fn mass(own: &AgentSetup, drawn_as: usize, run: usize) -> AgentSetup {
    let axes = own.robot.axes.len();
    AgentSetup {
        robot: RobotSetup::point_mass(axes, 1.0),
        law: Arc::new(Known::gain(GAIN_PER_S)),
        start: start(2, axes, drawn_as, run),
        enforce_limits: false,
        pushes: Vec::new(),
        ..own.clone()
    }
}

/// x, ẋ, … of a plant of order `order`, and z where there is an s.
fn start(order: usize, axes: usize, drawn_as: usize, run: usize) -> Start {
    let state: Vec<f64> = (0..order * axes).map(|r| drawn(drawn_as * 8 + r)).collect();
    let top = &state[state.len() - axes..];
    let (q, above) = state.split_at(axes);
    let (dq, rest) = above.split_at(above.len().min(axes));
    let beside = || top.iter().map(|top| top + drawn(drawn_as + 7)).collect();
    let reference = if is_disturbed(run) { vec![beside()] } else { Vec::new() };
    Start { q: q.to_vec(), dq: dq.to_vec(), rest: rest.to_vec(), reference }
}

/// In place of a chain.
fn chain(own: &AgentSetup, drawn_as: usize, run: usize) -> Option<AgentSetup> {
    let law: &ChainLaw = own.law.downcast()?;
    let (order, axes) = match (&law.step, own.robot.kind.downcast::<ChainModel>()?) {
        (ChainStep::Backstepping { .. }, _) => (1, 1),
        (_, model) => (model.order(), model.axes()),
    };
    let unit = |row| (0..axes).map(|column| Expression::number(f64::from(u8::from(row == column)))).collect();
    let (drift, factor) = (vec![Expression::number(0.0); axes], (0..axes).map(unit).collect());
    let terms = VectorFormulas::new(order, drift, vec![Vec::new(); axes], factor).ok()?;
    Some(AgentSetup {
        robot: RobotSetup {
            kind: Arc::new(ChainModel::Vector(Arc::new(terms))),
            theta: Vec::new(),
            theta_names: Vec::new(),
            axes: own.robot.axes.clone(),
        },
        law: Arc::new(ChainLaw { step: ChainStep::Linearising { gain_per_s: GAIN_PER_S }, floor: law.floor.min(0.5) }),
        start: start(order, axes, drawn_as, run),
        enforce_limits: false,
        pushes: Vec::new(),
        ..own.clone()
    })
}

/// How far it is from agreement, or from the targets: at most in the first tenth of the run, and at its end.
fn distances(setup: &Setup, outcome: &Outcome) -> (f64, f64) {
    let tracks = setup.all_track();
    let wanted = if tracks { Signal::Error } else { Signal::Position };
    let columns: Vec<_> = outcome.recording.columns.iter().filter(|column| column.signal == wanted).collect();
    let axes = columns.iter().map(|column| column.axis + 1).max().unwrap_or(0);
    let distance_along = |row: usize, axis: usize| {
        let along = columns.iter().filter(|column| column.axis == axis);
        let values = along.filter_map(|column| column.values.get(row).copied());
        if tracks {
            return values.map(f64::abs).fold(0.0, f64::max);
        }
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    let distance = |row: usize| (0..axes).map(|axis| distance_along(row, axis)).fold(0.0, f64::max);
    let rows = outcome.recording.t_s.len();
    let from = (0..rows.div_ceil(10)).map(distance).fold(0.0, f64::max);
    (from, rows.checked_sub(1).map_or(f64::NAN, distance))
}
