//! What is said of robots before a run: Property 1 by a bound, bounded C and g, targets within reach, how fast K is.

use std::sync::Arc;

use crate::common::kinds::{alone, blind_mass, change_tip, formula, planar_tip, rest_at, tracking, tree_tip};
use crate::common::{About, answer, arm, noise, setup};
use forwardstep_check::hypothesis::{InertiaUnit, ReachSide, RobotEvidence};
use forwardstep_check::{Answer, Evidence, Hypothesis, Id, Rigour, SamplingMargin, check, fastest_damping, practical};
use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::robot::tree::{JointKind, LinkJoint, LinkSpec, Placement, Tree, Uncertain, inertia_about_frame};
use forwardstep_core::robot::{Lagrangian, PointMass};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Sinusoid, Spline};
use forwardstep_sim::{Adaptive, AgentSetup, Axis, AxisUnit, Control, Exchange, Setup, TipSetup};

const Z: [f64; 3] = [0.0, 0.0, 1.0];
const X: [f64; 3] = [1.0, 0.0, 0.0];

fn all(setup: &Setup, id: Id) -> Vec<Hypothesis> {
    check(setup).hypotheses.into_iter().filter(|hypothesis| hypothesis.id == id).collect()
}

/// The only hypothesis of this kind, with what was found of robots.
fn one(setup: &Setup, id: Id) -> (Answer, Rigour, RobotEvidence) {
    let mut found = all(setup, id);
    assert_eq!(found.len(), 1, "{found:?}");
    let found = found.remove(0);
    match &found.evidence {
        Evidence::Robot(evidence) => (found.answer(), found.rigour(), evidence.clone()),
        other => panic!("{other:?}"),
    }
}

fn agreeing(agents: Vec<AgentSetup>) -> Setup {
    setup(agents, Exchange::Position, Schedule::fixed(Vec::new()), Vec::new(), 20.0)
}

fn body(mass_kg: f64) -> [f64; 10] {
    inertia_about_frame(mass_kg, [0.2, 0.0, 0.0], [0.01, 0.0, 0.02, 0.0, 0.0, 0.02].map(|moment| moment * mass_kg))
}

/// A tree under (6)–(7), each joint behind the one before.
fn tree(links: &[(JointKind, [f64; 3], [f64; 10])]) -> AgentSetup {
    let link = |(index, (kind, axis, inertia)): (usize, &(JointKind, [f64; 3], [f64; 10]))| LinkSpec {
        parent: index.checked_sub(1),
        x_parent_joint: Placement { translation: [0.3, 0.0, 0.1], ..Placement::IDENTITY },
        joint: LinkJoint::Moving { kind: *kind, axis: *axis, damping: 0.0 },
        inertia: *inertia,
    };
    let links: Vec<LinkSpec> = links.iter().enumerate().map(link).collect();
    let assembled = Tree::assemble(&links, [0.0, 0.0, -9.81]).unwrap();
    let axis = |(index, kind)| Axis {
        unit: if kind == JointKind::Revolute { AxisUnit::Radian } else { AxisUnit::Metre },
        ..crate::common::axis(["first", "second", "third"][index])
    };
    let mut agent = arm(0, &[1.0, 2.0]);
    agent.name = "tree".into();
    agent.robot.axes = assembled.tree.joint_kinds().enumerate().map(axis).collect();
    agent.robot.theta_names = vec![String::new(); assembled.theta.len()];
    agent.law = Arc::new(Adaptive {
        damping: Gain::Number(8.0),
        adaptation: Gain::Number(10.0),
        estimate_start: vec![0.0; assembled.theta.len()],
        bounds: None,
    });
    agent.robot.theta = assembled.theta;
    agent.robot.kind = Arc::new(Arc::new(assembled.tree));
    agent.start.q = vec![0.1; links.len()];
    agent.start.dq = vec![0.0; links.len()];
    agent
}

#[test]
fn prop_1_agents_with_one_unit_share_a_line_with_the_smallest_bound() {
    let mut mass = arm(3, &[1.0, 2.0]);
    mass.robot.kind = Arc::new(PointMass { dimension: 2 });
    mass.robot.theta = vec![0.25];
    mass.robot.axes.iter_mut().for_each(|axis| axis.unit = AxisUnit::Metre);
    let mut setup = agreeing(vec![arm(2, &[1.0, 2.0]), arm(0, &[1.0, 2.0]), arm(1, &[1.0, 2.0]), mass]);
    // The first weighs less than its siblings, as robots with a variation of their own may.
    setup.agents[1].robot.theta.iter_mut().for_each(|entry| *entry *= 0.5);
    let found = all(&setup, Id::UniformInertia);
    assert_eq!(found.len(), 2, "{found:?}");
    for (found, unit, whose, count) in
        [(&found[0], InertiaUnit::Turning, "arm-1", 3), (&found[1], InertiaUnit::Sliding, "arm-4", 1)]
    {
        assert_eq!((found.answer(), found.rigour()), (Answer::Holds, Rigour::Enclosed));
        let Evidence::Robot(RobotEvidence::UniformInertia { least, unit: own, agent, agents, .. }) = &found.evidence
        else {
            panic!("{found:?}")
        };
        assert_eq!((*own, &*agent.name, *agents), (unit, whose, count));
        if unit == InertiaUnit::Sliding {
            assert_eq!(*least, 0.25);
            assert!(
                found.because().contains("no eigenvalue of M(q) is below 0.25 kg at any q (arm-4)"),
                "{}",
                found.because()
            );
        } else {
            assert!(found.because().contains("(arm-1, the smallest of 3)"), "{}", found.because());
        }
    }
}

#[test]
fn prop_1_a_link_without_mass_violates_it_with_a_posture_that_shows_it() {
    use JointKind::Revolute;
    let setup = agreeing(vec![tree(&[(Revolute, Z, body(2.0)), (Revolute, Z, [0.0; 10])])]);
    let (answer, rigour, evidence) = one(&setup, Id::UniformInertia);
    assert_eq!((answer, rigour), (Answer::Violated, Rigour::Enclosed));
    let RobotEvidence::SingularInertia { agent, q, direction } = evidence else { panic!("{evidence:?}") };
    assert_eq!((&*agent.name, &direction[..]), ("tree", &[0.0, 1.0][..]));
    // The witness can be replayed.
    let model = setup.agents[0].robot.kind.downcast::<Arc<Tree>>().unwrap();
    let (mut scratch, mut m) = (Lagrangian::<f64>::scratch(&**model), vec![0.0; 4]);
    model.mass_matrix(&mut scratch, &q, &setup.agents[0].robot.theta, &mut m).unwrap();
    assert_eq!(m[3], 0.0);
    // A point that slides through the axis which turns it is singular there, at no posture that is looked at.
    let point = inertia_about_frame(2.0, [0.0; 3], [0.0; 6]);
    let setup = agreeing(vec![tree(&[(Revolute, Z, [0.0; 10]), (JointKind::Prismatic, X, point)])]);
    let (answer, rigour, evidence) = one(&setup, Id::UniformInertia);
    assert_eq!((answer, rigour), (Answer::NotShown, Rigour::Sampled));
    assert!(matches!(evidence, RobotEvidence::UnknownInertia { least, .. } if least > 0.0), "{evidence:?}");
}

#[test]
fn thm1_c_and_g_are_bounded_unless_a_revolute_joint_swings_a_prismatic_one() {
    use JointKind::{Prismatic, Revolute};
    let found = |agent: &AgentSetup| {
        let (answer, rigour, evidence) = one(&agreeing(vec![agent.clone()]), Id::BoundedDynamics);
        (answer, rigour, evidence)
    };
    let (answer, rigour, _) = found(&arm(0, &[1.0, 2.0]));
    assert_eq!((answer, rigour), (Answer::Holds, Rigour::Exact));
    let (answer, rigour, _) = found(&tree(&[(Prismatic, X, body(1.0)), (Revolute, Z, body(1.0))]));
    assert_eq!((answer, rigour), (Answer::Holds, Rigour::Computed), "what slides on the base carries what turns");
    let (answer, rigour, _) = found(&tree(&[(Revolute, Z, body(1.0)), (Prismatic, Z, body(1.0))]));
    assert_eq!((answer, rigour), (Answer::Holds, Rigour::Computed), "it slides along the axis");
    // Where nothing slides no direction is compared.
    let (answer, rigour, evidence) = found(&tree(&[(Revolute, Z, body(1.0)), (Revolute, X, body(1.0))]));
    assert_eq!((answer, rigour), (Answer::Holds, Rigour::Exact));
    assert!(matches!(evidence, RobotEvidence::BoundedDynamics { sliding: false }), "{evidence:?}");
    let mut swung = tree(&[(Revolute, Z, body(1.0)), (Prismatic, X, body(1.0))]);
    let (answer, _, evidence) = found(&swung);
    assert_eq!(answer, Answer::NotShown);
    assert!(matches!(&evidence, RobotEvidence::Swung { joint, limits: None, .. } if joint == "second"), "{evidence:?}");
    // Limits bound it where they end the run, and not where they are reported.
    swung.robot.axes[1].position_limits = Some([0.0, 0.5]);
    swung.robot.axes.iter_mut().for_each(|axis| axis.effort_limit = Some(100.0));
    assert_eq!(found(&swung).0, Answer::NotShown);
    swung.enforce_limits = true;
    let (answer, rigour, evidence) = found(&swung);
    assert_eq!((answer, rigour), (Answer::Watched, Rigour::Watched));
    // One end alone bounds nothing.
    let mut open = swung.clone();
    open.robot.axes[1].position_limits = Some([0.0, f64::INFINITY]);
    assert_eq!(found(&open).0, Answer::NotShown);
    assert!(matches!(evidence, RobotEvidence::Swung { limits: Some([0.0, 0.5]), .. }));
    // One that is not kept is enough.
    let mut other = swung.clone();
    (other.name, other.enforce_limits) = ("other".into(), false);
    let (answer, _, evidence) = one(&agreeing(vec![swung.clone(), other]), Id::BoundedDynamics);
    assert!(
        answer == Answer::NotShown && matches!(&evidence, RobotEvidence::Swung { agents, .. } if agents.len() == 2)
    );
    // Who follows a target of its own keeps near it.
    swung.roots_per_s = vec![1.0].into();
    assert!(all(&tracking(swung, vec![rest_at(0.1), rest_at(0.2)]), Id::BoundedDynamics).is_empty());
}

fn circle(radius: f64, middle: [f64; 2]) -> Vec<Path> {
    let wave = |offset, phase_rad| Path::Sinusoids {
        offset,
        waves: vec![Sinusoid { amplitude: radius, rad_per_s: 1.0, phase_rad }],
    };
    vec![wave(middle[0], 0.0), wave(middle[1], std::f64::consts::FRAC_PI_2)]
}

#[test]
fn thm6_a_target_keeps_within_reach_or_leaves_it_at_a_time() {
    // Lengths of 1 m and 0.8 m: between 0.2 m and 1.8 m.
    let found = |target| one(&tracking(planar_tip(), target), Id::TargetWithinReach);
    let (answer, rigour, evidence) = found(circle(0.3, [0.8, 0.6]));
    assert_eq!((answer, rigour), (Answer::Holds, Rigour::Enclosed));
    let RobotEvidence::WithinReach { target, reach, exact: true } = evidence else { panic!("{evidence:?}") };
    assert!(target.least > 0.58 && target.least <= 0.7 && target.most >= 1.3 && target.most < 1.43, "{target:?}");
    assert!((reach.least - 0.2).abs() < 1e-12 && (reach.most - 1.8).abs() < 1e-12);
    // About the shoulder, where the box of the circle holds the shoulder itself, the square of the distance shows it.
    let (answer, rigour, evidence) = found(circle(0.5, [0.0, 0.0]));
    assert_eq!((answer, rigour), (Answer::Holds, Rigour::Enclosed), "{evidence:?}");
    // Out at 8 s, farther at 20 s: the first time is named.
    let leaving = vec![formula(Expression::variable(0) * 0.125 + 0.8), rest_at(0.0)];
    let (answer, rigour, evidence) = found(leaving);
    assert_eq!((answer, rigour), (Answer::Violated, Rigour::Sampled));
    let RobotEvidence::OutOfReach { side: ReachSide::Beyond, t_s, distance_m, limit_m } = evidence else {
        panic!("{evidence:?}")
    };
    assert!((t_s - 8.0).abs() < 0.01 && distance_m > limit_m && (limit_m - 1.8).abs() < 1e-12, "{t_s} {distance_m}");
    let (answer, _, evidence) = found(circle(0.1, [0.0, 0.0]));
    assert_eq!(answer, Answer::Violated);
    assert!(matches!(evidence, RobotEvidence::OutOfReach { side: ReachSide::Inside, t_s: 0.0, .. }), "{evidence:?}");
    // With links alike the arm folds up entirely; there its Jacobian is singular all the same.
    let mut alike = planar_tip();
    change_tip(&mut alike, |law| {
        if let TipSetup::Planar(tip) = &mut law.tip {
            tip.length_m = [0.9, 0.9];
        }
    });
    let across = vec![formula(Expression::variable(0) * 0.1 + -1.0), rest_at(0.0)];
    let (answer, _, evidence) = one(&tracking(alike, across), Id::TargetWithinReach);
    assert_eq!(answer, Answer::Violated);
    assert!(matches!(evidence, RobotEvidence::OutOfReach { side: ReachSide::Inside, t_s: 10.0, .. }), "{evidence:?}");
    // On the edge up to rounding: neither.
    let (answer, rigour, evidence) = found(vec![rest_at(1.8), rest_at(0.0)]);
    assert_eq!((answer, rigour), (Answer::NotShown, Rigour::Sampled), "{evidence:?}");
}

/// The run ends at 20 s, and tells nothing of what a target does later.
#[test]
fn regress_a_target_that_leaves_its_reach_after_the_run_is_refuted_at_that_time() {
    let found = |target| one(&tracking(planar_tip(), target), Id::TargetWithinReach);
    let t = || Expression::variable(0);
    // 1 + 0.9 sin(t/100) comes to 1.8 at 109.5 s.
    let wave = Sinusoid { amplitude: 0.9, rad_per_s: 0.01, phase_rad: 0.0 };
    let swinging = Path::Sinusoids { offset: 1.0, waves: vec![wave] };
    for path in [formula((t() * 0.01).sin_of() * 0.9 + 1.0), swinging, formula(t() * 0.007 + 1.0)] {
        let (answer, _, evidence) = found(vec![path, rest_at(0.0)]);
        let RobotEvidence::OutOfReach { side: ReachSide::Beyond, t_s, distance_m, .. } = evidence else {
            panic!("{evidence:?}")
        };
        assert!(answer == Answer::Violated && t_s > 109.4 && t_s < 120.0 && distance_m > 1.8, "{t_s} {distance_m}");
    }
    // Into the hole that a folded arm cannot reach.
    let (_, _, evidence) = found(vec![formula((t() * -0.02).exp_of() * 1.5), rest_at(0.0)]);
    assert!(
        matches!(evidence, RobotEvidence::OutOfReach { side: ReachSide::Inside, t_s, .. } if t_s > 100.0),
        "{evidence:?}"
    );
    // Its corner is farther than the arm is long, and the circle never is.
    assert_eq!(found(circle(1.4, [0.0, 0.0])).0, Answer::Holds);
    // A curve through points stays where it ends, also where that is after the run.
    let curve = |x: [f64; 4], y: [f64; 4]| {
        [x, y].map(|values| Path::Spline(Spline::new(vec![0.0, 20.0, 40.0, 60.0], values.to_vec()).unwrap())).to_vec()
    };
    assert_eq!(found(curve([1.3, 0.0, -1.3, 0.0], [0.0, 1.3, 0.0, -1.3])).0, Answer::Holds);
    let (answer, _, evidence) = found(curve([1.3, 1.3, 1.3, 1.3], [0.0, 0.0, 1.0, 1.4]));
    assert!(answer == Answer::Violated, "{evidence:?}");
}

#[test]
fn regress_what_leaves_a_reach_by_little_is_said_with_the_digits_that_tell() {
    let said = |x: f64| {
        let mut found = all(&tracking(planar_tip(), vec![rest_at(x), rest_at(0.0)]), Id::TargetWithinReach);
        let found = found.remove(0);
        (found.because(), found.change().unwrap_or_default())
    };
    let (because, change) = said(1.800_03);
    assert_eq!(because, "at t = 0 s it is 1.80003 m away, and the end-effector cannot be farther than 1.8 m");
    assert_eq!(change, "a target that keeps closer than 1.8 m at all times");
    let (because, _) = said(0.199_98);
    assert_eq!(
        because,
        "at t = 0 s it is 0.19998 m away, and the end-effector cannot be closer than 0.2 m without a singular Jacobian"
    );
    let (because, change) = said(1.8);
    assert_eq!(
        because,
        "it comes to 1.8 m, up to rounding the edge of what the end-effector can reach, where its Jacobian is singular"
    );
    assert_eq!(change, "a target that keeps clearly closer than 1.8 m");
}

#[test]
fn thm6_the_tip_of_a_tree_is_no_farther_than_its_links_are_long() {
    let y = [0.0, 1.0, 0.0];
    let agent = |kinds| tree_tip(kinds, [Z, y, y], Uncertain::Tool);
    let turning = [JointKind::Revolute; 3];
    let at = |x| vec![rest_at(x), rest_at(0.2), rest_at(0.5)];
    // From the first joint at (0.3, 0.2, 0.5): twice |(0.3, 0.2, 0.5)| and the tool.
    let length = 2.0 * 0.38_f64.sqrt() + 0.17_f64.sqrt();
    let (answer, _, evidence) = one(&tracking(agent(turning), at(0.29 + length)), Id::TargetWithinReach);
    assert_eq!(answer, Answer::Holds, "{evidence:?}");
    assert!(matches!(evidence, RobotEvidence::WithinReach { exact: false, .. }));
    let (answer, _, evidence) = one(&tracking(agent(turning), at(0.31 + length)), Id::TargetWithinReach);
    assert_eq!(answer, Answer::Violated, "{evidence:?}");
    let sliding = [JointKind::Revolute, JointKind::Revolute, JointKind::Prismatic];
    assert!(all(&tracking(agent(sliding), at(0.5)), Id::TargetWithinReach).is_empty());
}

#[test]
fn no_posture_makes_the_damping_faster_than_is_said() {
    let agents = || vec![arm(0, &[1.0, 2.0]), arm(1, &[1.0, 2.0]), arm(2, &[1.0, 2.0])];
    let mut setup = agreeing(agents());
    let first = fastest_damping(&setup).unwrap();
    let anywhere = first.anywhere_per_s.unwrap();
    let mut seen = 0.0_f64;
    for k in 0..2000 {
        for (index, agent) in setup.agents.iter_mut().enumerate() {
            agent.start.q = vec![3.0 * noise(k + index), 3.2 * noise(7 * k + index)];
        }
        let found = fastest_damping(&setup).unwrap();
        assert!(found.at_start_per_s <= anywhere, "{found:?} exceeds {anywhere}");
        assert_eq!(found.anywhere_per_s, first.anywhere_per_s, "K is a number here, whatever the posture");
        seen = seen.max(found.at_start_per_s);
    }
    assert!(seen > 0.999 * anywhere, "{seen} of {anywhere}: for a planar arm the bound is attained");
    // The largest bound of several counts, wherever it stands.
    for order in [[0, 5], [5, 0]] {
        let own = |index: usize| arm(index, &[1.0, 2.0]);
        let bound = |agents: Vec<AgentSetup>| fastest_damping(&agreeing(agents)).unwrap().anywhere_per_s.unwrap();
        let [first, second] = order.map(|index| bound(vec![own(index)]));
        assert!(first != second && bound(order.map(own).to_vec()) == first.max(second), "{first}, {second}");
    }
    // One robot without a bound leaves all without.
    setup.agents.push(tree(&[(JointKind::Revolute, Z, body(2.0)), (JointKind::Revolute, Z, [0.0; 10])]));
    setup.network.agents += 1;
    let found = fastest_damping(&setup).unwrap();
    assert!(found.anywhere_per_s.is_none() && found.agent < 3, "{found:?}");
}

#[test]
fn sampling_is_said_to_be_stable_at_every_posture_where_the_bound_shows_it() {
    let mut setup = agreeing(vec![alone(arm(0, &[1.0, 2.0])).agents.remove(0)]);
    let because = |setup: &Setup| practical(setup).findings[0].because();
    let rates = |setup: &Setup| {
        let found = SamplingMargin::of(setup).unwrap();
        (found.start.damping_sigma, found.anywhere.unwrap())
    };
    setup.control = Some(Control {
        sample_hz: 1000.0,
        computation_delay_s: 0.0,
        sensors: Default::default(),
        actuators: Default::default(),
        failures: Default::default(),
    });
    let (value, anywhere) = rates(&setup);
    assert!(value < anywhere && anywhere < 1.0, "{value} {anywhere}");
    assert!((anywhere - 0.5e-3 * fastest_damping(&setup).unwrap().anywhere_per_s.unwrap()).abs() < 1e-12);
    assert!(because(&setup).contains("at any q"), "{}", because(&setup));
    if let Some(control) = &mut setup.control {
        control.sample_hz *= 0.99 * anywhere;
    }
    assert!(rates(&setup).1 > 1.0 && !because(&setup).contains("at any q"), "{}", because(&setup));
}

/// Where M, C and g are bounded for all q, a joint may turn for ever.
#[test]
fn a_robot_may_travel_where_its_dynamics_are_bounded_wherever_it_is() {
    use JointKind::{Prismatic, Revolute};
    let travels = || formula(Expression::variable(0) + Expression::variable(0).sin_of());
    let setup = tracking(arm(0, &[2.0]), vec![travels(), rest_at(0.0)]);
    let report = check(&setup);
    assert_eq!(report.worst(), Answer::Holds);
    let bounded = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::BoundedTarget).unwrap();
    assert_eq!(
        bounded.requires(),
        "the derivatives of the target of arm-1, which may travel, up to the second are bounded"
    );
    // One that stays is said to.
    let swings = tracking(arm(0, &[2.0]), vec![formula(Expression::variable(0).sin_of()), rest_at(0.0)]);
    let [stays] = &all(&swings, Id::BoundedTarget)[..] else { panic!() };
    assert_eq!(stays.requires(), "the target of arm-1 and its derivatives up to the second are bounded");
    // A slide that a joint turns has a lever that grows with its travel, and a law without velocities another proof.
    let swung = tree(&[(Revolute, Z, body(1.0)), (Prismatic, X, body(1.0))]);
    assert_eq!(answer(&tracking(swung, vec![rest_at(0.0), travels()]), About::Target), Answer::Violated);
    assert_eq!(answer(&tracking(blind_mass(5.0, 0.3), vec![travels()]), About::Target), Answer::Violated);
}
