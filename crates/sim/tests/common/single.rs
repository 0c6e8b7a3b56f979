//! A tip with uncertain lengths, and spacecraft without angular velocity.

use forwardstep_sim::reference::Tracking;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::plant::{Wheel, Wheels};
use forwardstep_core::robot::tree::{Follows, JointKind, LinkJoint, LinkPoint, LinkSpec, Placement, Tree, Uncertain};
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PlanarTip};
use forwardstep_sim::trajectory::{Path, Spline, Trajectory};
use forwardstep_sim::{
    AgentSetup, AttitudeLaw, AxisUnit, Law, Method, PassivityFilterLaw, RobotSetup, Setup, SpacecraftModel, Start,
    TaskSpaceLaw, TipSetup,
};

use super::{RTOL, axes, fixed, setup, silent, wave};

pub fn alone(robot: RobotSetup, law: Arc<dyn Law>, start: Start, target: Vec<Path>, end_s: f64) -> Setup {
    let agent = AgentSetup {
        name: "agent".into(),
        robot,
        roots_per_s: Vec::new().into(),
        manipulability: 0.0,
        law,
        target: Some(Trajectory::new(target).unwrap()),
        start,
        enforce_limits: false,
        pushes: Vec::new(),
    };
    let mut setup = setup(vec![agent], Arc::new(Tracking), silent(1), end_s);
    setup.solver.method = Method::Adaptive { rtol: RTOL, atol: 1e-11 };
    setup
}

pub fn planar(bounds: Option<ParameterBounds>, kinematic_gain: f64) -> Setup {
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let robot = RobotSetup {
        kind: Arc::new(PlanarArm),
        theta: links.theta().to_vec(),
        theta_names: (0..5).map(|k| format!("p{k}")).collect(),
        axes: axes(&["shoulder", "elbow"], AxisUnit::Radian),
    };
    let law = TaskSpaceLaw {
        tip: TipSetup::Planar(PlanarTip { length_m: links.length_m }),
        by_velocity: false,
        damping: Gain::Number(20.0),
        adaptation: Gain::Number(30.0),
        estimate_start: vec![0.0; 5],
        estimate_bounds: None,
        task_gain: Gain::Number(20.0),
        attitude_gain: 20.0,
        null_space: None,
        kappa: 5.0,
        alpha_per_s: 3.0,
        kinematic_adaptation: Some(Gain::Number(kinematic_gain)),
        kinematic_names: vec!["length_1_m".into(), "length_2_m".into()],
        kinematic_start: vec![1.2, 0.96],
        bounds,
        determinant_floor: 0.01,
    };
    let start = Start { q: vec![0.2, 1.4], dq: vec![0.1, -0.2], rest: Vec::new(), reference: Vec::new() };
    let circle = vec![wave(0.8, 0.3, 1.0, FRAC_PI_2), wave(0.6, 0.3, 1.0, 0.0)];
    alone(robot, Arc::new(law), start, circle, 20.0)
}

/// Three joints, z up: a turntable, a shoulder and an elbow; damping in the shoulder.
pub fn anthropomorphic(uncertain: Uncertain) -> Setup {
    let link = |parent, offset: [f64; 3], axis, damping, reach: f64| LinkSpec {
        parent,
        x_parent_joint: Placement { translation: offset, ..Placement::IDENTITY },
        joint: LinkJoint::Moving { kind: JointKind::Revolute, axis, damping },
        inertia: [3.0, 3.0 * reach / 2.0, 0.0, 0.0, 0.02, 0.0, reach * reach + 0.02, 0.0, 0.0, reach * reach + 0.02],
    };
    let y = [0.0, 1.0, 0.0];
    let assembled = Tree::assemble(
        &[
            link(None, [0.0, 0.0, 0.3], [0.0, 0.0, 1.0], 0.0, 0.1),
            link(Some(0), [0.05, 0.1, 0.1], y, 2.0, 0.6),
            link(Some(1), [0.6, 0.0, 0.0], y, 0.0, 0.5),
        ],
        [0.0, 0.0, -9.81],
    )
    .unwrap();
    let point = LinkPoint { link: assembled.anchors[2], at: [0.5, 0.0, 0.02] };
    let (theta, p) = match uncertain {
        Uncertain::Tool => (vec![0.6, 0.05, 0.0], 3),
        Uncertain::Chain => (vec![0.05, 0.1, 0.1, 0.7, 0.0, 0.0, 0.6, 0.0, 0.02], 9),
    };
    let law = TaskSpaceLaw {
        tip: TipSetup::Point { point, coordinates: vec![0, 1, 2], follows: Follows::Position, uncertain },
        by_velocity: false,
        damping: Gain::Bandwidth(20.0),
        adaptation: Gain::Bandwidth(3.0),
        estimate_start: vec![0.0; assembled.theta.len()],
        estimate_bounds: None,
        task_gain: Gain::Diagonal(vec![20.0, 25.0, 15.0]),
        attitude_gain: 20.0,
        null_space: None,
        kappa: 5.0,
        alpha_per_s: 3.0,
        kinematic_adaptation: Some(Gain::Number(0.3)),
        kinematic_names: (0..p).map(|k| format!("t{k}")).collect(),
        kinematic_start: theta,
        bounds: None,
        determinant_floor: 0.01,
    };
    let robot = RobotSetup {
        theta_names: (0..assembled.theta.len()).map(|k| format!("p{k}")).collect(),
        theta: assembled.theta,
        kind: Arc::new(Arc::new(assembled.tree)),
        axes: axes(&["turntable", "shoulder", "elbow"], AxisUnit::Radian),
    };
    let start = Start { q: vec![0.3, -0.8, 1.5], dq: vec![0.0; 3], rest: Vec::new(), reference: Vec::new() };
    let path = vec![wave(0.6, 0.1, 1.0, 0.0), wave(0.25, 0.1, 0.7, 0.5), wave(0.3, 0.1, 1.3, 1.0)];
    alone(robot, Arc::new(law), start, path, 10.0)
}

pub fn craft(start: Start, target: Vec<Path>, torque_limit_n_m: f64) -> Setup {
    let wheel = |axis| Wheel { axis, torque_limit_n_m: Some(torque_limit_n_m), momentum_limit_n_m_s: Some(20.0) };
    let wheels =
        Wheels::new(&[[1.0, 0.0, 0.8], [-1.0, 0.0, 0.8], [0.0, 1.0, 0.8], [0.0, -1.0, 0.8]].map(wheel)).unwrap();
    let robot = RobotSetup {
        kind: Arc::new(SpacecraftModel {
            inertia_kg_m2: [[10.0, 0.5, -0.3], [0.5, 8.0, 0.2], [-0.3, 0.2, 6.0]],
            wheels,
        }),
        theta: Vec::new(),
        theta_names: Vec::new(),
        axes: axes(&["x", "y", "z", "o"], AxisUnit::One),
    };
    let law = AttitudeLaw { alpha: [0.5, 1.2], filter: Gain::Number(1.0), damping: Gain::Number(3.0) };
    alone(robot, Arc::new(law), start, target, 60.0)
}

/// The same under a filter of the attitude error.
pub fn filtered_craft(start: Start, target: Vec<Path>) -> Setup {
    let mut setup = craft(start, target, 5.0);
    let [filter, damping] = [1.0, 3.0].map(Gain::Number);
    setup.agents[0].law = Arc::new(PassivityFilterLaw { error_gain_n_m: 4.0, filter, damping });
    setup
}

pub fn half_a_turn(rate: [f64; 3]) -> Start {
    let half = 179.9_f64.to_radians() / 2.0;
    let axis = [1.0, 2.0, -1.0].map(|x| x / 6.0_f64.sqrt() * libm::sin(half));
    Start {
        q: vec![axis[0], axis[1], axis[2], libm::cos(half)],
        dq: rate.to_vec(),
        rest: vec![0.3, -0.2, 0.1, 0.4],
        reference: Vec::new(),
    }
}

fn through(values: [f64; 3]) -> Path {
    Path::Spline(Spline::new(vec![1.0, 6.0, 12.0], values.to_vec()).unwrap())
}

/// Rest, a swing of sinusoids, and a body that tumbles: it turns by 0.05 t about the inertial z axis, by 0.5 about x, and by 0.2 t
/// about its own z axis. Then half a turn and back to a quarter through points of a table, with rest before and after.
pub fn targets() -> Vec<Vec<Path>> {
    let rest = vec![fixed(0.0), fixed(0.0), fixed(0.0), fixed(2.0)];
    let swing = vec![wave(0.1, 0.3, 0.4, 0.0), wave(0.0, 0.2, 0.3, 1.0), wave(0.0, 0.2, 0.5, 2.0), fixed(1.0)];
    let (lean, tall) = (libm::sin(0.25), libm::cos(0.25));
    let tumbling = vec![
        wave(0.0, lean, 0.075, FRAC_PI_2),
        wave(0.0, -lean, 0.075, 0.0),
        wave(0.0, tall, 0.125, 0.0),
        wave(0.0, tall, 0.125, FRAC_PI_2),
    ];
    let [x, z, o] = [[0.0, 0.6, 0.0], [0.0, 0.2, 0.7], [1.0, 0.8, 0.7]];
    let table = vec![through(x), fixed(0.0), through(z), through(o)];
    vec![rest, swing, tumbling, table]
}
