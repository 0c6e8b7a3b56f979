//! A nonlinear protocol, tried: the desired dynamics alone, from states that are drawn.
//!
//! Every plant is replaced by the chain of integrators of its order, under feedback linearisation. With z(0) = x^(k−1)(0) that leaves s ≡ 0;
//! with another z(0) s falls exponentially, which is bounded and vanishes. Runs cannot show that all of them converge, so nothing holds
//! by them. One that ends farther from what it is for than it began, or breaks down, refutes what is declared.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::expression::Expression;
use forwardstep_core::plant::Formulas;
use forwardstep_sim::{
    AgentSetup, ChainLaw, ChainModel, ChainStep, Ending, Outcome, RobotSetup, Setup, Signal, Solver, Start, simulate,
};

use crate::hypothesis::{ReferenceEvidence, TriedRun};

/// Runs; every other one with an s.
const RUNS: usize = 8;
/// States are drawn from [−REACH, REACH].
const REACH: f64 = 2.0;
/// How fast s vanishes, 1/s.
const GAIN_PER_S: f64 = 1.0;
/// Steps after which a run is given up: it is too stiff to tell anything in time.
const MOST_STEPS: usize = 20_000;

/// What runs from drawn states show.
pub(super) fn tried(setup: &Setup) -> ReferenceEvidence {
    let mut runs = 0;
    for run in 0..RUNS {
        let Some(alone) = alone(setup, run) else { break };
        let mut steps = 0;
        let mut observer = |_| {
            steps += 1;
            if steps > MOST_STEPS { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        // A setup that cannot be built is refused before anybody asks what follows from it.
        let Ok(outcome) = simulate(&alone, &mut observer) else { break };
        let (from, to) = match outcome.ending {
            Ending::Interrupted { .. } | Ending::CutOff { .. } => continue,
            Ending::Completed => distances(setup, &outcome),
            Ending::BrokeDown(_) => (distances(setup, &outcome).0, f64::INFINITY),
        };
        runs += 1;
        if to.is_nan() || to > from {
            let start = alone.agents.iter().flat_map(|agent| agent.start.q.iter().copied()).collect();
            let found = TriedRun { start, disturbed: is_disturbed(run), from, to };
            return ReferenceEvidence::Tried { runs, found: Some(found) };
        }
    }
    ReferenceEvidence::Tried { runs, found: None }
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
    let agents = setup.agents.iter().enumerate();
    let agents =
        agents.map(|(index, own)| integrators(own, run * setup.agents.len() + index, run)).collect::<Option<_>>();
    let solver = Solver { balance: false, ..setup.solver };
    Some(Setup { agents: agents?, solver, control: None, ..setup.clone() })
}

fn integrators(own: &AgentSetup, drawn_as: usize, run: usize) -> Option<AgentSetup> {
    let law: &ChainLaw = own.law.downcast()?;
    let order = match (&law.step, own.robot.kind.downcast::<ChainModel>()?) {
        (ChainStep::Backstepping { .. }, _) => 1,
        (_, model) => model.order(),
    };
    let zero = Expression::number(0.0);
    let terms = Formulas::new(order, &zero, Vec::new(), &Expression::number(1.0)).ok()?;
    let state: Vec<f64> = (0..order).map(|r| drawn(drawn_as * 8 + r)).collect();
    let top = state.last().copied()?;
    let (q, above) = state.split_at(1);
    let (dq, rest) = above.split_at(above.len().min(1));
    let reference = if is_disturbed(run) { vec![vec![top + drawn(drawn_as + 7)]] } else { Vec::new() };
    Some(AgentSetup {
        robot: RobotSetup {
            kind: Arc::new(ChainModel::Derivatives(Arc::new(terms))),
            theta: Vec::new(),
            theta_names: Vec::new(),
            axes: own.robot.axes.clone(),
        },
        law: Arc::new(ChainLaw { step: ChainStep::Linearising { gain_per_s: GAIN_PER_S }, floor: law.floor.min(0.5) }),
        start: Start { q: q.to_vec(), dq: dq.to_vec(), rest: rest.to_vec(), reference },
        enforce_limits: false,
        pushes: Vec::new(),
        ..own.clone()
    })
}

/// How far it is from agreement, or from the targets: at most in the first tenth of the run, and at its end.
fn distances(setup: &Setup, outcome: &Outcome) -> (f64, f64) {
    let tracks = setup.all_track();
    let wanted = if tracks { Signal::Error } else { Signal::Position };
    let columns: Vec<&[f64]> = outcome
        .recording
        .columns
        .iter()
        .filter(|column| column.signal == wanted)
        .map(|column| column.values.as_slice())
        .collect();
    let distance = |row: usize| {
        let values = columns.iter().filter_map(|column| column.get(row).copied());
        if tracks {
            return values.map(f64::abs).fold(0.0, f64::max);
        }
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    let rows = outcome.recording.t_s.len();
    let from = (0..rows.div_ceil(10)).map(distance).fold(0.0, f64::max);
    (from, rows.checked_sub(1).map_or(f64::NAN, distance))
}
