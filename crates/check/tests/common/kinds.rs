//! One agent of every kind beside arms and masses under (6)–(7).

use forwardstep_sim::reference::Tracking;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::controller::{Floor, Yaw};
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{CascadeTerms, Formulas, Wheel, Wheels};
use forwardstep_core::robot::tree::{Follows, JointKind, LinkJoint, LinkPoint, LinkSpec, Placement, Tree, Uncertain};
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PlanarTip, PointMass};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Trajectory};
use forwardstep_sim::{
    AgentSetup, AttitudeLaw, Axis, AxisUnit, ChainLaw, ChainModel, ChainStep, Estimate, Exchange, Law,
    ModelReferenceLaw, PassivityFilterLaw, PositionOnlyLaw, Robot, RobotSetup, Setup, SpacecraftModel, Start,
    TaskSpaceLaw, ThrustKind, ThrustLaw, TipSetup, VehicleModel,
};

use super::{axis, setup};

pub fn formula(formula: Expression) -> Path {
    Path::Formula(formula)
}

pub fn rest_at(offset: f64) -> Path {
    Path::Sinusoids { offset, waves: Vec::new() }
}

/// c tᵖ.
pub fn power_of_time(c: f64, exponent: f64) -> Path {
    formula(Expression::variable(0).power(exponent) * c)
}

/// c tᵖ e⁻ᵗ, which fades with all of its derivatives.
pub fn fading_power_of_time(c: f64, exponent: f64) -> Path {
    let t = || Expression::variable(0);
    formula(t().power(exponent) * (-t()).exp_of() * c)
}

fn agent(
    kind: Arc<dyn Robot>,
    theta: Vec<f64>,
    law: Arc<dyn Law>,
    start: Start,
    axes: usize,
    unit: AxisUnit,
) -> AgentSetup {
    AgentSetup {
        name: "agent".into(),
        robot: RobotSetup {
            kind,
            theta_names: vec![String::new(); theta.len()],
            theta,
            axes: (0..axes).map(|k| Axis { unit, ..axis(["x", "y", "z", "o"][k % 4]) }).collect(),
        },
        roots_per_s: Vec::new().into(),
        manipulability: 0.0,
        law,
        target: None,
        start,
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

fn start(q: &[f64], dq: &[f64], rest: &[f64]) -> Start {
    Start { q: q.to_vec(), dq: dq.to_vec(), rest: rest.to_vec(), reference: Vec::new() }
}

/// It follows a target of its own.
pub fn tracking(mut agent: AgentSetup, target: Vec<Path>) -> Setup {
    agent.target = Some(Trajectory::new(target).unwrap());
    let mut setup = setup(vec![agent], Exchange::Position, Schedule::fixed(Vec::new()), Vec::new(), 20.0);
    setup.reference = Arc::new(Tracking);
    setup
}

/// It agrees with nobody.
pub fn alone(agent: AgentSetup) -> Setup {
    setup(vec![agent], Exchange::Position, Schedule::fixed(Vec::new()), Vec::new(), 20.0)
}

/// A mass of 2 kg without velocity, whose estimate starts at `estimate_start`.
pub fn blind_mass(adaptation: f64, estimate_start: f64) -> AgentSetup {
    let law = Arc::new(PositionOnlyLaw { damping: 20.0, filter_per_s: 20.0, adaptation, estimate_start, bounds: None });
    let mut agent =
        agent(Arc::new(PointMass { dimension: 1 }), vec![2.0], law, start(&[0.3], &[0.0], &[]), 1, AxisUnit::Metre);
    agent.roots_per_s = vec![1.0, 1.5, 2.0].into();
    agent
}

/// The same by a model.
pub fn modelled_mass(adaptation: f64, estimate_start: f64) -> AgentSetup {
    let law = Arc::new(ModelReferenceLaw { filter_per_s: 20.0, adaptation, estimate_start });
    AgentSetup { law, roots_per_s: vec![1.0, 2.0].into(), ..blind_mass(adaptation, estimate_start) }
}

/// A vehicle of 2 kg.
pub fn vehicle(design: ThrustKind, floor: Floor) -> AgentSetup {
    let law = ThrustLaw {
        design,
        yaw: Yaw { heading: 0.0, rate: 0.0, gain: 1.0 },
        floor,
        thrust_start: None,
        bandwidth_per_s: 30.0,
    };
    let rest = start(&[0.0; 3], &[0.0; 3], &[0.0, 0.0, 0.0, 1.0]);
    let kind = Arc::new(VehicleModel { gravity: 9.81 });
    let mut agent = agent(kind, vec![2.0], Arc::new(law), rest, 3, AxisUnit::Metre);
    agent.roots_per_s = vec![1.0; design.order()].into();
    agent
}

/// The end of a planar arm with lengths 1 m and 0.8 m.
pub fn planar_tip() -> AgentSetup {
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let law = task_space(TipSetup::Planar(PlanarTip { length_m: links.length_m }), &[1.2, 0.96], 5);
    let start = start(&[0.2, 1.4], &[0.0; 2], &[]);
    agent(Arc::new(PlanarArm), links.theta().to_vec(), law, start, 2, AxisUnit::Radian)
}

fn task_space(tip: TipSetup, kinematic_start: &[f64], parameters: usize) -> Arc<dyn Law> {
    Arc::new(TaskSpaceLaw {
        tip,
        by_velocity: false,
        damping: Gain::Number(20.0),
        adaptation: Gain::Number(30.0),
        estimate_start: vec![0.0; parameters],
        estimate_bounds: None,
        task_gain: Gain::Number(20.0),
        attitude_gain: 20.0,
        null_space: None,
        kappa: 5.0,
        alpha_per_s: 3.0,
        kinematic_adaptation: Some(Gain::Number(0.3)),
        kinematic_names: (0..kinematic_start.len()).map(|k| format!("length-{k}")).collect(),
        kinematic_start: kinematic_start.to_vec(),
        bounds: None,
        determinant_floor: 0.01,
    })
}

/// Joints, each `kinds[k]` along `axes[k]`; a joint is (0.3, 0.2, 0.5) m behind the one before, a tool (0.4, 0, 0.1) m behind
/// the last. Of a chain that is uncertain there are three.
pub fn tree_tip<const N: usize>(kinds: [JointKind; N], axes: [[f64; 3]; N], uncertain: Uncertain) -> AgentSetup {
    let place = Placement { translation: [0.3, 0.2, 0.5], ..Placement::IDENTITY };
    let link = |k: usize| LinkSpec {
        parent: k.checked_sub(1),
        x_parent_joint: place,
        joint: LinkJoint::Moving { kind: kinds[k], axis: axes[k], damping: 0.0 },
        inertia: [3.0, 0.5, 0.0, 0.0, 0.02, 0.0, 0.5, 0.0, 0.0, 0.5],
    };
    let assembled = Tree::assemble(&std::array::from_fn::<_, N, _>(link), [0.0, 0.0, -9.81]).unwrap();
    let point = LinkPoint { link: assembled.anchors[N - 1], at: [0.4, 0.0, 0.1] };
    let tip = TipSetup::Point { point, coordinates: vec![0, 1, 2], follows: Follows::Position, uncertain };
    let mut theta = vec![0.4, 0.0, 0.1];
    if uncertain == Uncertain::Chain {
        theta = [[0.3, 0.2, 0.5], [0.3, 0.2, 0.5], [0.4, 0.0, 0.1]].concat();
    }
    let law = task_space(tip, &theta.iter().map(|length| 1.2 * length).collect::<Vec<_>>(), assembled.theta.len());
    let bent: [f64; N] = std::array::from_fn(|k| [0.3, -0.8, 1.5][k % 3]);
    let start = start(&bent, &[0.0; N], &[]);
    agent(Arc::new(Arc::new(assembled.tree)), assembled.theta, law, start, N, AxisUnit::Radian)
}

/// Changes the law of an agent that has one for a tip.
pub fn change_tip(agent: &mut AgentSetup, change: impl FnOnce(&mut TaskSpaceLaw)) {
    assert!(agent.change_law(change), "no tip");
}

/// A spacecraft with three wheels.
pub fn spacecraft() -> AgentSetup {
    let wheel = |axis| Wheel { axis, torque_limit_n_m: None, momentum_limit_n_m_s: None };
    let wheels = Wheels::new(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(wheel)).unwrap();
    let inertia_kg_m2 = [[10.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 6.0]];
    let law = AttitudeLaw { alpha: [0.5, 1.2], filter: Gain::Number(1.0), damping: Gain::Number(3.0) };
    let start = start(&[0.0, 0.0, 0.0, 1.0], &[0.0; 3], &[0.0; 3]);
    let kind = Arc::new(SpacecraftModel { inertia_kg_m2, wheels });
    agent(kind, Vec::new(), Arc::new(law), start, 4, AxisUnit::One)
}

/// The same under a filter of the attitude error.
pub fn filtered_spacecraft() -> AgentSetup {
    let [filter, damping] = [1.0, 3.0].map(Gain::Number);
    AgentSetup { law: Arc::new(PassivityFilterLaw { error_gain_n_m: 4.0, filter, damping }), ..spacecraft() }
}

/// ẍ = φᵀθ + ψ u with one term φ = ẋ, or none, and the factor ψ.
pub fn chain(psi: &Expression, parameters: usize, adaptive: bool) -> AgentSetup {
    let phi = vec![Expression::variable(1); parameters];
    let model = Formulas::new(2, &Expression::number(0.0), phi, psi).unwrap();
    let estimate = Estimate { adaptation: vec![1.0; parameters], start: vec![0.0; parameters], bounds: None };
    let step = if adaptive {
        ChainStep::Adaptive { gain_per_s: 2.0, estimate }
    } else {
        ChainStep::Linearising { gain_per_s: 2.0 }
    };
    of_chain(ChainModel::Derivatives(Arc::new(model)), parameters, step)
}

/// ẋ_1 = h(x_1, x_2), ẋ_2 = θᵀφ + b u with `parameters` terms.
pub fn cascade(known: Expression, input: Expression, parameters: usize) -> AgentSetup {
    let regressors = vec![vec![Expression::number(0.0); parameters], vec![Expression::variable(0); parameters]];
    let terms = CascadeTerms::new(vec![known, Expression::number(0.0)], regressors, input).unwrap();
    let estimate = Estimate { adaptation: vec![1.0; parameters], start: vec![0.0; parameters], bounds: None };
    let step = ChainStep::Backstepping { gains_per_s: vec![1.0; 2], estimate };
    of_chain(ChainModel::Cascade(Arc::new(terms)), parameters, step)
}

fn of_chain(model: ChainModel, parameters: usize, step: ChainStep) -> AgentSetup {
    let law = Arc::new(ChainLaw { step, floor: 1e-3 });
    let start = if model.has_velocity() { start(&[0.3], &[0.0], &[]) } else { start(&[0.3], &[], &[0.0]) };
    let mut agent = agent(Arc::new(model), vec![0.5; parameters], law, start, 1, AxisUnit::Metre);
    agent.roots_per_s = vec![1.0, 2.0].into();
    agent
}
