//! Chains of Section IV.

use forwardstep_sim::reference::{Consensus, Tracking};
use std::sync::Arc;

use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{CascadeTerms, Formulas};
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{AgentSetup, AxisUnit, ChainLaw, ChainModel, ChainStep, Estimate, RobotSetup, Setup, Start};

use super::{axes, setup, silent, switching, wave};

pub fn x(index: usize) -> Expression {
    Expression::variable(index)
}

pub fn number(value: f64) -> Expression {
    Expression::number(value)
}

pub fn estimate(gamma: &[f64]) -> Estimate {
    Estimate { adaptation: gamma.to_vec(), start: vec![0.0; gamma.len()], bounds: None }
}

pub fn agent(
    index: usize,
    model: ChainModel,
    theta: &[f64],
    step: ChainStep,
    roots: &[f64],
    state: &[f64],
) -> AgentSetup {
    let (position, above) = state.split_at(1);
    let (velocity, rest) = above.split_at(usize::from(model.has_velocity()));
    let (q, dq, rest) = (position.to_vec(), velocity.to_vec(), rest.to_vec());
    AgentSetup {
        name: format!("chain-{index}"),
        robot: RobotSetup {
            kind: Arc::new(model),
            theta: theta.to_vec(),
            theta_names: (1..=theta.len()).map(|k| format!("theta{k}")).collect(),
            axes: axes(&["x"], AxisUnit::Metre),
        },
        roots_per_s: roots.to_vec().into(),
        manipulability: 0.0,
        law: Arc::new(ChainLaw { step, floor: 1e-3 }),
        target: None,
        start: Start { q, dq, rest, reference: Vec::new() },
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

/// ẍ = −x³ + θ₁ sin x + θ₂ ẋ² + (2 + cos x) u.
pub fn second_order() -> ChainModel {
    let phi = vec![x(0).sin_of(), x(1).power(2.0)];
    ChainModel::Derivatives(Arc::new(Formulas::new(2, &-x(0).power(3.0), phi, &(x(0).cos_of() + 2.0)).unwrap()))
}

/// d³x/dt³ = −ẋ ẍ + θ₁ x² + θ₂ sin ẍ + u.
pub fn third_order() -> ChainModel {
    let phi = vec![x(0).power(2.0), x(2).sin_of()];
    ChainModel::Derivatives(Arc::new(Formulas::new(3, &-(x(1) * x(2)), phi, &number(1.0)).unwrap()))
}

/// d⁴x/dt⁴ = −x ẍ − sin ẋ + θ₁ tanh d³x/dt³ + θ₂ x ẋ + (1.5 + 0.5 sin x) u.
pub fn fourth_order() -> ChainModel {
    let (chi, phi) = (-(x(0) * x(2)) - x(1).sin_of(), vec![x(3).tanh_of(), x(0) * x(1)]);
    ChainModel::Derivatives(Arc::new(Formulas::new(4, &chi, phi, &(x(0).sin_of() * 0.5 + 1.5)).unwrap()))
}

pub fn strict(order: usize) -> ChainModel {
    let all = [
        vec![x(0).power(2.0), number(0.0)],
        vec![x(0) * x(1), x(1).sin_of()],
        vec![number(0.0), x(2) * x(0)],
        vec![x(3).tanh_of(), x(0)],
    ];
    ChainModel::Cascade(Arc::new(CascadeTerms::strict(all[..order].to_vec()).unwrap()))
}

/// ẋ_1 = x_2 + 0.2 x_2³ + θ₁ x_1², ẋ_2 = u + θ₂ x_1 x_2 + θ₁ tanh x_2, where θ₁ also bends x_2 in the first equation.
pub fn pure() -> ChainModel {
    let known = vec![x(1) + x(1).power(3.0) * 0.2, number(0.0)];
    let regressors = vec![vec![x(0).power(2.0) + x(1).tanh_of() * 0.3, number(0.0)], vec![x(1).tanh_of(), x(0) * x(1)]];
    ChainModel::Cascade(Arc::new(CascadeTerms::new(known, regressors, number(1.0)).unwrap()))
}

/// Linearisation, adaptation, and immersion side by side, of orders two and three.
pub fn derivatives() -> Setup {
    let antiderivatives = vec![x(1) * x(0).sin_of(), x(1).power(3.0) / 3.0];
    let steps = [
        ChainStep::Linearising { gain_per_s: 2.0 },
        ChainStep::Adaptive { gain_per_s: 2.0, estimate: estimate(&[2.0, 2.0]) },
        ChainStep::Immersion { gain_per_s: 2.0, estimate: estimate(&[2.0, 2.0]), antiderivatives },
    ];
    let [known, adaptive, immersion] = steps;
    let agents = vec![
        agent(1, second_order(), &[0.8, -0.4], known, &[1.0, 2.0], &[1.0, 0.2]),
        agent(2, third_order(), &[0.5, 0.6], adaptive, &[1.0, 2.0, 1.5], &[-0.5, 0.1, 0.3]),
        agent(3, second_order(), &[0.8, -0.4], immersion, &[1.5, 2.0], &[-1.0, 0.3]),
    ];
    setup(agents, Arc::new(Consensus), switching(), 40.0)
}

/// Orders two, three and four with one second step, and with different numbers of differentiators.
pub fn of_all_orders(step: &ChainStep, roots: [usize; 3]) -> Setup {
    let of = |index: usize, model, theta: &[f64], state: &[f64]| {
        agent(index, model, theta, step.clone(), &[1.0, 2.0, 1.5, 1.2][..roots[index - 1]], state)
    };
    let agents = vec![
        of(1, second_order(), &[0.8, -0.4], &[1.0, 0.2]),
        of(2, third_order(), &[0.5, 0.6], &[-0.5, 0.1, 0.3]),
        of(3, fourth_order(), &[0.4, -0.3], &[0.4, -0.2, 0.1, 0.0]),
    ];
    setup(agents, Arc::new(Consensus), switching(), 40.0)
}

pub fn linearising() -> Setup {
    of_all_orders(&ChainStep::Linearising { gain_per_s: 2.0 }, [1, 2, 4])
}

pub fn adaptive() -> Setup {
    of_all_orders(&ChainStep::Adaptive { gain_per_s: 2.0, estimate: estimate(&[2.0, 2.0]) }, [3, 2, 3])
}

/// Strict-feedback chains of orders two, three and four.
pub fn cascades() -> Setup {
    let of = |index: usize, order: usize, state: &[f64]| {
        let step = ChainStep::Backstepping { gains_per_s: vec![1.0; order], estimate: estimate(&[1.0, 1.0]) };
        agent(index, strict(order), &[0.3, -0.2], step, &[1.0, 2.0, 1.5, 1.2][..order], state)
    };
    let agents = vec![of(1, 2, &[0.6, 0.0]), of(2, 3, &[-0.4, 0.1, 0.0]), of(3, 4, &[0.2, 0.0, 0.1, 0.0])];
    setup(agents, Arc::new(Consensus), switching(), 60.0)
}

/// Pure-feedback chains.
pub fn pure_feedback() -> Setup {
    let of = |index: usize, state: &[f64]| {
        let step = ChainStep::Backstepping { gains_per_s: vec![1.0; 2], estimate: estimate(&[1.0, 1.0]) };
        agent(index, pure(), &[0.4, -0.3], step, &[1.0, 2.0], state)
    };
    setup(vec![of(1, &[0.6, 0.1]), of(2, &[-0.5, 0.0]), of(3, &[0.1, -0.2])], Arc::new(Consensus), switching(), 60.0)
}

/// A chain of each kind that follows a trajectory.
pub fn tracking() -> Setup {
    let step = ChainStep::Backstepping { gains_per_s: vec![1.0; 3], estimate: estimate(&[1.0, 1.0]) };
    let adaptive = ChainStep::Adaptive { gain_per_s: 2.0, estimate: estimate(&[5.0, 5.0]) };
    let known = ChainStep::Linearising { gain_per_s: 2.0 };
    let mut agents = vec![
        agent(1, strict(3), &[0.3, -0.2], step, &[1.0, 2.0, 1.5], &[0.6, 0.0, 0.0]),
        agent(2, third_order(), &[0.5, 0.6], adaptive, &[1.0, 2.0, 1.5, 1.2], &[-0.5, 0.1, 0.3]),
        agent(3, second_order(), &[0.8, -0.4], known, &[1.0, 2.0], &[1.0, 0.2]),
    ];
    for agent in &mut agents {
        agent.target = Some(Trajectory::new(vec![wave(0.1, 0.5, 0.8, 0.4)]).unwrap());
    }
    setup(agents, Arc::new(Tracking), silent(3), 100.0)
}
