//! Every shipped scenario shows what it says: its hypotheses hold, it completes, and it meets its goal.

use forwardstep::core::reference::WrittenIn;
use forwardstep::core::signal::Signal;
use forwardstep::sim::reference::{Backstepping, Desired};
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::support::some;
use forwardstep::check::{Answer, check};
use forwardstep::core::Gain;
use forwardstep::io::SourceText;
use forwardstep::io::output::{Disagreement, Metrics};
use forwardstep::io::scenario::{SHIPPED_SCENARIOS, open_scenario, read_scenario, shipped_scenario};
use forwardstep::sim::probe::{STATES, probe_balance};
use forwardstep::sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep::sim::{Adaptive, Column, Ending, RotorcraftModel, TaskSpaceLaw, simulate};

fn shows_what_it_says(name: &str) {
    let scenario = open_scenario(name).unwrap_or_else(|error| panic!("{error}"));
    let setup = &scenario.setup;
    let worst = check(setup).worst();
    // The paper promises nothing about the baseline that it argues against, sampled controllers, bodies with inertia,
    // networks of different kinds, pushes that never end, and designs that it does not print.
    let expected: &[Answer] = match name {
        "backstepping"
        | "six-arms-over-radio"
        | "six-arms-with-friction"
        | "formation"
        | "gusts"
        | "mixed-network"
        | "swarm-tracking"
        | "desired-in-x" => &[Answer::NotCovered],
        // What its author says of a nonlinear protocol is declared.
        "desired-nonlinear" | "desired-nonlinear-arms" | "desired-together" => &[Answer::NotShown],
        _ => &[Answer::Holds, Answer::HoldsOnHorizon, Answer::Watched],
    };
    assert!(expected.contains(&worst), "{name}: {}", worst.words());
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    let metrics = Metrics::of(setup, &outcome.recording, None, scenario.goal);
    let goal = scenario.goal.unwrap();
    assert!(goal.is_met(setup, &outcome, &metrics), "{}: {:?}", goal.words(), metrics.disagreement);
}

/// At random states, times and messages, by differences of V and without a run.
#[test]
fn thm_lyapunov_function_of_every_kind_changes_as_its_law_says() {
    let mut failed = Vec::new();
    for name in SHIPPED_SCENARIOS.iter().map(|scenario| scenario.name) {
        let mut setup = open_scenario(name).unwrap().setup;
        for agent in &mut setup.agents {
            // What rotors do not give is not what the balance balances.
            if let Some(model) = agent.robot.kind.downcast::<RotorcraftModel>() {
                agent.robot.kind = Arc::new(RotorcraftModel { rotors: None, ..model.clone() });
            }
        }
        // There z is a sum of messages, which do not stand still while the agent moves.
        if setup.reference.is::<Backstepping>() {
            continue;
        }
        for agent in 0..setup.agents.len() {
            let probe = probe_balance(&setup, agent).unwrap();
            if probe.found.is_some() || probe.states <= STATES / 2 {
                failed.push((name, agent, probe));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

/// Its gains were found by trial. With any of them a fifth smaller or larger the goal is met as well.
#[test]
fn prop_the_goal_of_theorem_6_does_not_hang_on_one_gain() {
    let scenario = open_scenario("theorem-6").unwrap();
    let scaled = |gain: &Gain, factor: f64| match gain {
        Gain::Number(number) => Gain::Number(factor * number),
        other => panic!("{other:?}"),
    };
    let changes: [fn(&mut TaskSpaceLaw) -> Knob<'_>; 6] = [
        |law| Knob::Gain(&mut law.damping),
        |law| Knob::Gain(&mut law.adaptation),
        |law| Knob::Gain(&mut law.task_gain),
        |law| Knob::Gain(law.kinematic_adaptation.as_mut().unwrap()),
        |law| Knob::Number(&mut law.kappa),
        |law| Knob::Number(&mut law.alpha_per_s),
    ];
    for (index, change) in changes.iter().enumerate() {
        for factor in [0.8, 1.2] {
            let mut setup = scenario.setup.clone();
            let changed = setup.agents[0].change_law(|law| match change(law) {
                Knob::Gain(gain) => *gain = scaled(gain, factor),
                Knob::Number(number) => *number *= factor,
            });
            assert!(changed);
            let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
            let metrics = Metrics::of(&setup, &outcome.recording, None, scenario.goal);
            assert!(scenario.goal.unwrap().is_met(&setup, &outcome, &metrics), "gain {index}, {factor}");
        }
    }
}

/// Six UR5e with 0.5 N m at every joint: other starts, and a law that takes F for half of what it is, or half as much again.
#[test]
fn arms_with_dry_friction_agree_from_other_starts_and_with_a_wrong_guess_and_not_without_their_column() {
    /// The largest disagreement in the last fifth.
    fn apart(seed: i64, change: impl Fn(&mut Adaptive, std::ops::Range<usize>)) -> f64 {
        let text = shipped_scenario("six-arms-with-friction").unwrap().text;
        let text = text.replace("seed = 7", &format!("seed = {seed}"));
        let mut setup = read_scenario("friction", &SourceText::new("friction.toml", text), None).unwrap().setup;
        for agent in &mut setup.agents {
            let [.., frictions] = agent.robot.interface().drives.ranges_in(agent.robot.theta.len()).unwrap();
            assert!(agent.change_law(|law: &mut Adaptive| change(law, frictions.clone())));
        }
        let mut outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(outcome.ending, Ending::Completed);
        let from = 4 * outcome.recording.t_s.len() / 5;
        outcome.recording.t_s.drain(..from);
        outcome.recording.columns.iter_mut().for_each(|column| drop(column.values.drain(..from)));
        match Metrics::of(&setup, &outcome.recording, None, None).disagreement {
            Disagreement::Measured { largest, .. } => largest,
            Disagreement::Absent(reason) => panic!("{reason:?}"),
        }
    }
    for (seed, guess) in some([(1, 0.5), (2, 1.5), (3, 1.0)], 3) {
        let largest = apart(seed, |law, frictions| {
            law.estimate_start[frictions].iter_mut().for_each(|force| *force = guess * 0.5);
        });
        assert!(largest < 5e-3, "seed {seed}, {guess} F: {largest}");
    }
    let without = apart(7, |law, frictions| {
        law.estimate_start[frictions.clone()].fill(0.0);
        law.bounds.as_mut().unwrap().upper[frictions].fill(1e-9);
    });
    assert!(without > 0.1, "{without}");
}

/// Of a push that grows with time 𝓕 of (43) leaves nothing where 𝒵 is written in x, a_k ṡ/a₀ where it holds ṡ, and more and more where it
/// holds s: ṡ → 0.05, a₀ = 3, a₁ = 6.5, a₂ = 4.5.
#[test]
fn remark_6_a_growing_push_is_left_out_by_what_is_written_in_x() {
    let scenario = open_scenario("desired-in-x").unwrap();
    let errors = |written: WrittenIn| {
        let mut setup = scenario.setup.clone();
        assert!(setup.change_reference(|desired: &mut Desired| desired.written = written));
        let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
        [0, 1].map(|agent| {
            let of = |column: &&Column| column.agent == agent && column.signal == Signal::Error;
            outcome.recording.columns.iter().find(of).and_then(|column| column.values.last()).unwrap().abs()
        })
    };
    let [in_x, measured, in_z] = [WrittenIn::X, WrittenIn::Measured, WrittenIn::Z].map(errors);
    assert!(in_x.iter().all(|error| *error < 1e-6), "{in_x:?}");
    for (error, coefficient) in measured.into_iter().zip([6.5, 4.5]) {
        assert!((error - coefficient * 0.05 / 3.0).abs() < 1e-3, "{error}");
    }
    assert!(in_z.iter().all(|error| *error > 1.0), "{in_z:?}");
}

/// A desired quaternion of which one entry stays away from zero, one whose norm does, and one that comes to zero.
#[test]
fn thm7_the_quaternion_to_follow_is_bounded_away_from_zero_or_found_there() {
    let answer = |paths: [(f64, f64, f64); 4]| {
        let mut setup = open_scenario("theorem-7").unwrap().setup;
        let path = |(offset, amplitude, phase_rad)| Path::Sinusoids {
            offset,
            waves: vec![Sinusoid { amplitude, rad_per_s: 1.0, phase_rad }],
        };
        setup.agents[0].target = Some(Trajectory::new(paths.map(path).to_vec()).unwrap());
        let report = check(&setup);
        report.hypotheses.iter().find(|hypothesis| hypothesis.requires().contains("never zero")).unwrap().answer()
    };
    let nothing = (0.0, 0.0, 0.0);
    assert_eq!(answer([(0.0, 0.5, 0.0), nothing, nothing, (-1.0, 0.2, 0.0)]), Answer::Holds);
    assert_eq!(answer([(0.0, 1.0, 0.0), (0.0, 1.0, 1.57), nothing, nothing]), Answer::Holds);
    assert_eq!(answer([(0.0, 1.0, 0.0), (0.0, 0.5, 0.0), nothing, nothing]), Answer::Violated);
}

/// What can be turned a little.
enum Knob<'a> {
    Gain(&'a mut Gain),
    Number(&'a mut f64),
}

macro_rules! shipped {
    ($($test:ident: $name:literal),* $(,)?) => {
        $(#[test]
        fn $test() {
            shows_what_it_says($name);
        })*

        #[test]
        fn all_of_them_are_tested() {
            let shipped: Vec<&str> = SHIPPED_SCENARIOS.iter().map(|scenario| scenario.name).collect();
            assert_eq!(shipped, [$($name),*]);
        }
    };
}

shipped! {
    six_arms: "six-arms",
    first_order: "first-order",
    theorem_1: "theorem-1",
    remark_3: "remark-3",
    remark_4: "remark-4",
    remark_4_on_a_table: "remark-4-on-a-table",
    teleoperation: "teleoperation",
    theorem_2: "theorem-2",
    theorem_3_a5_order_3: "theorem-3-a5-order-3",
    theorem_3_24_order_4: "theorem-3-24-order-4",
    ten_different_robots: "ten-different-robots",
    backstepping: "backstepping",
    from_a_log: "from-a-log",
    replayed_draws: "replayed-draws",
    six_arms_over_radio: "six-arms-over-radio",
    six_arms_with_friction: "six-arms-with-friction",
    planar_arms_with_friction: "planar-arms-with-friction",
    without_velocity: "without-velocity",
    double_integrators: "double-integrators",
    thrust_continuous: "thrust-continuous",
    theorem_4: "theorem-4",
    theorem_5: "theorem-5",
    formation: "formation",
    gusts: "gusts",
    mixed_network: "mixed-network",
    through_waypoints: "through-waypoints",
    theorem_6: "theorem-6",
    task_space_ur5e: "task-space-ur5e",
    pose_ur5e: "pose-ur5e",
    redundant_panda: "redundant-panda",
    theorem_7: "theorem-7",
    the_long_way_round: "the-long-way-round",
    tumbling_target: "tumbling-target",
    rest_to_rest: "rest-to-rest",
    sinusoidal_attitude: "sinusoidal-attitude",
    attitude_from_a_table: "attitude-from-a-table",
    theorem_8: "theorem-8",
    leader_over_turns: "leader-over-turns",
    leader_over_late_links: "leader-over-late-links",
    vehicles_behind_a_leader: "vehicles-behind-a-leader",
    theorem_9: "theorem-9",
    remark_12: "remark-12",
    leader_by_one_vector: "leader-by-one-vector",
    swarm_tracking: "swarm-tracking",
    framework: "framework",
    vector_plants: "vector-plants",
    desired_dynamics: "desired-dynamics",
    desired_in_z: "desired-in-z",
    desired_in_x: "desired-in-x",
    desired_nonlinear: "desired-nonlinear",
    desired_nonlinear_arms: "desired-nonlinear-arms",
    desired_together: "desired-together",
    strict_feedback: "strict-feedback",
    strict_feedback_order_10: "strict-feedback-order-10",
    pure_feedback: "pure-feedback",
    immersion_and_invariance: "immersion-and-invariance",
    estimates_within_bounds: "estimates-within-bounds",
    saturated_coupling: "saturated-coupling",
    five_ships: "five-ships",
    pilot_ship: "pilot-ship",
}
