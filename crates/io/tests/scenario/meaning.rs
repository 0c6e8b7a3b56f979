//! What a sound scenario turns into.

use forwardstep_core::Gain;
use forwardstep_core::reference::{RootPair, RootSet};
use forwardstep_core::robot::PlanarArm;
use forwardstep_io::scenario::Goal;
use forwardstep_sim::delay::{Delay, PiecewiseConstant, SawTooth, Sinusoid};
use forwardstep_sim::schedule::{Once, Periodic, RandomSwitching};
use forwardstep_sim::{Adaptive, Exchange, Known, Method, Setup};

use super::{SOUND, changed, read};

fn setup(text: &str) -> Setup {
    read(text).unwrap_or_else(|error| panic!("{error}")).setup
}

#[test]
fn the_sound_scenario_is_read_as_written() {
    let scenario = read(SOUND).unwrap();
    assert_eq!(scenario.title, "test");
    assert_eq!(scenario.goal, Some(Goal::DisagreementBelow(1e-3)));
    let setup = scenario.setup;
    let names: Vec<_> = setup.agents.iter().map(|agent| agent.name.as_str()).collect();
    assert_eq!(names, ["arm-1", "arm-2", "cart"]);
    assert_eq!(setup.exchange, Exchange::PositionVelocity);
    assert_eq!((setup.time.end_s, setup.time.record_every_s), (10.0, 0.1));
    let [arm, _, cart] = setup.agents.as_slice() else { panic!("three agents") };
    assert!(arm.robot.kind.is::<PlanarArm>());
    assert_eq!((arm.robot.theta.len(), arm.robot.theta_names.len()), (5, 5));
    assert_eq!(arm.roots_per_s.real, [1.0, 2.0]);
    assert_eq!((arm.start.q.as_slice(), arm.start.dq.as_slice()), ([0.1, 0.2].as_slice(), [0.0, 0.0].as_slice()));
    assert_eq!(setup.agents[1].start.q, [0.3, 0.4]);
    assert_eq!(
        arm.law.downcast(),
        Some(&Adaptive {
            damping: Gain::Number(8.0),
            adaptation: Gain::Number(10.0),
            estimate_start: vec![0.0; 5],
            bounds: None
        })
    );
    assert_eq!((cart.start.q.as_slice(), cart.robot.theta.as_slice()), ([0.0, 0.0].as_slice(), [4.0].as_slice()));
    let schedule = &setup.network.schedule;
    assert!(schedule.downcast::<Periodic>().is_some(), "it repeats");
    let edges: Vec<_> = schedule.graphs.iter().flatten().map(|edge| (edge.from, edge.to)).collect();
    assert_eq!(edges, [(0, 1), (1, 2), (2, 0)]);
    assert_eq!(setup.network.delays, [Delay::new(SawTooth { min_s: 0.1, max_s: 0.4, period_s: 0.6, offset_s: 0.0 })]);
}

#[test]
fn arms_from_a_urdf_have_bandwidths_by_default_and_others_numbers() {
    let text = changed("dimension = 2", "dimension = 6").replace("damping.gain = 8\nadaptation_gain = 10\n", "");
    let planar = "robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }\n\
                  start.position_rad = [[0.1, 0.2], [0.3, 0.4]]";
    let setup = setup(&text.replace(planar, "robot.urdf.file = \"ur5e.urdf\""));
    let gains = |k: usize| {
        let law = setup.agents[k].law.downcast::<Adaptive>().unwrap();
        (law.damping.clone(), law.adaptation.clone())
    };
    assert_eq!(gains(0), (Gain::Bandwidth(20.0), Gain::Bandwidth(5.0)));
    assert_eq!(gains(2), (Gain::Number(8.0), Gain::Number(10.0)));
}

#[test]
fn pairs_of_complex_roots_count_twice_wherever_they_stand() {
    let pair = |real, imaginary| RootPair { real, imaginary };
    let text = changed("[1.0, 2.0]", "[{ real = 0.1, imaginary = 2 }, 3, { real = 1.5, imaginary = 0.5 }]");
    let own = "name = \"cart\"\nreference.consensus.roots_per_s = [2, { real = 1, imaginary = 1 }]";
    let setup = setup(&text.replace("name = \"cart\"", own));
    let [arm, _, cart] = setup.agents.as_slice() else { panic!("three agents") };
    assert_eq!(arm.roots_per_s, RootSet { real: vec![3.0], pairs: vec![pair(0.1, 2.0), pair(1.5, 0.5)] });
    assert_eq!((arm.roots_per_s.len(), arm.roots_per_s.first_real()), (5, Some(3.0)));
    assert_eq!(cart.roots_per_s, RootSet { real: vec![2.0], pairs: vec![pair(1.0, 1.0)] });
    // As many as the coefficients tell apart: each of these pairs costs 0.38 digits.
    let pairs = |count: usize| vec!["{ real = 1, imaginary = 1 }"; count].join(", ");
    let many = |list: &str| {
        read(&changed("[1.0, 2.0]", list).replace("position_velocity", "position")).map(|read| read.setup.agents.len())
    };
    assert_eq!(many(&format!("[{}]", pairs(31))).unwrap(), 3);
    let refused = many(&format!("[{}]", pairs(32))).unwrap_err().to_string();
    assert!(refused.contains("of these 64 roots say 12.2 of 16 digits less"), "{refused}");
}

#[test]
fn an_agents_own_tables_win() {
    let own = "name = \"cart\"\nlaw.known.damping.gain = [[3, 1], [1, 3]]\nreference.consensus.roots_per_s = [1, 4, 9]\n\
               start = { velocity = [1, 2], reference = { z = [3, 4], derivatives = [[5, 6]] } }\nenforce_limits = false";
    let text = changed("name = \"cart\"", own) + "\n[start]\nposition = [7, 8]\nvelocity = [9, 9]\n";
    let setup = setup(&text);
    let [arm, _, cart] = setup.agents.as_slice() else { panic!("three agents") };
    assert_eq!(cart.law.downcast(), Some(&Known { damping: Gain::Matrix(vec![3.0, 1.0, 1.0, 3.0]) }));
    assert_eq!(cart.roots_per_s.real, [1.0, 4.0, 9.0]);
    assert_eq!((cart.start.q.as_slice(), cart.start.dq.as_slice()), ([7.0, 8.0].as_slice(), [1.0, 2.0].as_slice()));
    assert_eq!(cart.start.reference, [[3.0, 4.0], [5.0, 6.0]]);
    assert!(!cart.enforce_limits && !arm.enforce_limits);
    // Key by key: the arms have positions of their own, but no velocity.
    assert_eq!((arm.start.q.as_slice(), arm.start.dq.as_slice()), ([0.1, 0.2].as_slice(), [9.0, 9.0].as_slice()));
    assert!(arm.start.reference.is_empty());
}

#[test]
fn estimates_start_as_they_are_told() {
    let first = |choice: &str| {
        let setup = setup(
            &changed("estimate_start = \"zero\"", choice)
                .replace("name = \"cart\"", "name = \"cart\"\nlaw = { adaptive = {} }"),
        );
        let arm = &setup.agents[0];
        let law = arm.law.downcast::<Adaptive>().unwrap();
        law.estimate_start.iter().zip(&arm.robot.theta).map(|(a, b)| a / b).collect::<Vec<_>>()
    };
    assert_eq!(first("estimate_start = \"true\""), [1.0; 5]);
    assert_eq!(first("estimate_start.scaled = 0.5"), [0.5; 5]);
    assert_eq!(first(""), [0.0; 5]);
    assert_eq!(first("estimate_start.given = [0, 0, 0, 0, 0]"), [0.0; 5]);
}

#[test]
fn random_starts_repeat_and_stay_when_agents_are_added() {
    let random = |count: &str, seed: u64| {
        let text =
            changed("[[0.1, 0.2], [0.3, 0.4]]", &format!("{{ random = {{ seed = {seed}, within = [-2, 3] }} }}"));
        let agents = setup(&text.replace("count = 2", count)).agents;
        agents.iter().filter(|agent| agent.name != "cart").flat_map(|agent| agent.start.q.clone()).collect::<Vec<_>>()
    };
    let two = random("count = 2", 7);
    assert_eq!(two, random("count = 2", 7));
    assert_ne!(two, random("count = 2", 8));
    let many = random("count = 500", 7);
    assert_eq!(many[..4], two[..]);
    assert!(many.iter().all(|q| (-2.0..=3.0).contains(q)));
    let mean = many.iter().sum::<f64>() / many.len() as f64;
    assert!((mean - 0.5).abs() < 0.15, "uniform on [-2, 3], but the mean is {mean}");
}

#[test]
fn every_axis_may_start_within_an_interval_of_its_own() {
    let drawn = |within: &str| {
        let text = changed("[[0.1, 0.2], [0.3, 0.4]]", &format!("{{ random = {{ seed = 7, within = {within} }} }}"));
        setup(&text).agents[..2].iter().flat_map(|agent| agent.start.q.clone()).collect::<Vec<_>>()
    };
    let (one, each) = (drawn("[0, 1]"), drawn("[[-2, 3], [5, 5.5]]"));
    for (axis, (unit, found)) in one.iter().zip(&each).enumerate() {
        let [low, high] = [[-2.0, 3.0], [5.0, 5.5]][axis % 2];
        assert!((low + (high - low) * unit - found).abs() < 1e-12, "{one:?} {each:?}");
    }
}

#[test]
fn networks_of_every_kind() {
    let phases = &SOUND[SOUND.find("[[network.phases]]").unwrap()..SOUND.find("[goal]").unwrap()];
    let fixed = SOUND.replace(
        phases,
        "edges = [[\"cart\", \"arm-1\"], { from = \"arm-1\", to = \"cart\", weight = 2, delay.constant_s = 0 }]\n",
    );
    let network = setup(&fixed).network;
    let edges = &network.schedule.graphs[0];
    assert_eq!((edges[0].from, edges[0].to, edges[0].weight, edges[0].delay), (2, 0, 1.0.into(), 0));
    assert_eq!((edges[1].from, edges[1].to, edges[1].weight), (0, 2, 2.0.into()));
    assert_eq!(network.delays[edges[1].delay], Delay::constant(0.0));

    let once = read(&changed("weight = 1.0", "switching = \"once\"")).unwrap();
    let schedule = &once.setup.network.schedule;
    assert!(schedule.downcast::<Once>().is_some() && schedule.graphs.len() == 2);
    let notices: Vec<String> = once.notices.iter().map(ToString::to_string).collect();
    assert_eq!(notices, ["`dwell_s` on line 34 is not used"]);
    assert!(
        read(&changed("weight = 1.0", "switching = \"once\"").replace("dwell_s = 2.0\n", ""))
            .unwrap()
            .notices
            .is_empty()
    );

    let random = read(&changed("weight = 1.0", "switching.random = { seed = 3, dwell_s = [1, 2] }")).unwrap();
    let drawn = &random.setup.network.schedule;
    assert_eq!(drawn.downcast(), Some(&RandomSwitching { dwell_s: [1.0, 2.0], seed: 3 }));
    assert_eq!(drawn.graphs.len(), 2);
    assert_eq!(random.notices.len(), 2);
}

#[test]
fn delays_of_every_kind() {
    let delay = |text: &str| {
        let saw_tooth = "delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }";
        setup(&changed(saw_tooth, text)).network.delays.remove(0)
    };
    assert_eq!(delay(""), Delay::constant(0.0));
    assert_eq!(
        delay("delay.sinusoid = { mean_s = 0.2, amplitude_s = 0.2, period_s = 2, phase_rad = 1 }"),
        Delay::new(Sinusoid { mean_s: 0.2, amplitude_s: 0.2, period_s: 2.0, phase_rad: 1.0 })
    );
    assert_eq!(
        delay("delay.piecewise_constant = { times_s = [0, 1], values_s = [0.1, 0], period_s = 2 }"),
        Delay::new(PiecewiseConstant { times_s: vec![0.0, 1.0], values_s: vec![0.1, 0.0], period_s: Some(2.0) })
    );
    assert_eq!(
        delay("delay.saw_tooth = { min_s = 0, max_s = 0.4, period_s = 0.6, offset_s = 0.1 }"),
        Delay::new(SawTooth { min_s: 0.0, max_s: 0.4, period_s: 0.6, offset_s: 0.1 })
    );
}

#[test]
fn solver_and_goal() {
    let solver = |text: &str| setup(&changed("[goal]", &format!("[solver]\n{text}\n[goal]"))).solver;
    assert_eq!(solver("method.fixed.step_s = 0.01").method, Method::Fixed { step_s: 0.01 });
    assert_eq!(solver("method.adaptive.rtol = 1e-9").method, Method::Adaptive { rtol: 1e-9, atol: 1e-8 });
    let rest = solver("max_step_s = 0.5\nlyapunov_balance = false\nmin_step_s = 1e-9\nmemory_budget_bytes = 2_000_000");
    assert_eq!((rest.max_step_s, rest.balance, rest.min_step_s), (Some(0.5), false, 1e-9));
    assert_eq!((rest.memory_budget_bytes, solver("").memory_budget_bytes), (2_000_000, 1 << 30));
    let goal = |text: &str| read(&changed("disagreement_below = 1e-3", text)).unwrap().goal;
    assert_eq!(goal("expect = \"diverges\""), Some(Goal::ExpectDiverges));
    assert_eq!(goal("disagreement_below = 1\nexpect = \"agrees\""), Some(Goal::DisagreementBelow(1.0)));
    assert_eq!(read(&changed("[goal]\ndisagreement_below = 1e-3\n", "")).unwrap().goal, None);
}

#[test]
fn files_are_looked_for_beside_the_scenario_before_the_shipped_ones() {
    use forwardstep_io::scenario::open_scenario;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("network.toml");
    let text = changed("robot.point_mass = { dimension = 2, mass_kg = 4.0 }", "robot.urdf.file = \"panda.urdf\"");
    std::fs::write(&path, text.replace("count = 2", "count = 1").replace("[[0.1, 0.2], [0.3, 0.4]]", "[0, 0]"))
        .unwrap();
    let open = || open_scenario(path.to_str().unwrap()).unwrap_err().to_string();
    assert!(
        open().ends_with("`arm-1` has 2 axes and `cart` has 7, but all agents of a scenario need as many"),
        "{}",
        open()
    );
    std::fs::write(folder.path().join("panda.urdf"), "<sdf/>").unwrap();
    assert!(open().contains("panda.urdf:1:"), "{}", open());
    std::fs::write(folder.path().join("panda.urdf"), [0xff, 0xfe]).unwrap();
    assert!(
        open().contains("cannot read the robot file `panda.urdf`: it is no UTF-8 text: byte 0xff in line 1, column 1"),
        "{}",
        open()
    );
}

#[test]
fn a_robot_of_which_nothing_moves_is_reported_at_its_locks() {
    let joints = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"];
    let locks: Vec<String> = joints.iter().map(|joint| format!("{joint}_joint = 0")).collect();
    let robot = format!("robot.urdf = {{ file = \"ur5e.urdf\", locked = {{ {} }} }}", locks.join(", "));
    let error = read(&changed("robot.point_mass = { dimension = 2, mass_kg = 4.0 }", &robot)).unwrap_err();
    assert!(error.to_string().starts_with("test.toml:16:"), "{error}");
    assert!(error.to_string().ends_with("no joint moves (fixed: 1, locked: 6)"), "{error}");
}

#[test]
fn near_matches_for_names_and_paths() {
    use forwardstep_io::scenario::open_scenario;
    use miette::Diagnostic;
    let open = |name: &str| {
        let error = open_scenario(name).unwrap_err();
        (error.to_string(), error.help().map(|help| help.to_string()).unwrap_or_default())
    };
    let (error, help) = open("theorem2");
    assert_eq!(error, "there is no scenario `theorem2`");
    assert!(help.starts_with("did you mean `theorem-2`?"), "{help}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("network.toml"), SOUND).unwrap();
    let latin = folder.path().join("latin.toml");
    std::fs::write(&latin, b"format = 2\ntitle = \"\xc3\xa9caf\xe9\"\n").unwrap();
    let (error, help) = open(latin.to_str().unwrap());
    assert!(error.ends_with("it is no UTF-8 text: byte 0xe9 in line 2, column 14"), "{error}");
    assert_eq!(help, "save it as UTF-8");
    let missing = folder.path().join("netwrk.toml");
    let (error, help) = open(missing.to_str().unwrap());
    assert_eq!(error, format!("cannot read `{}`: there is no such file", missing.display()));
    assert!(help.starts_with("did you mean `network.toml`?"), "{help}");
    assert_eq!(
        open(folder.path().to_str().unwrap()).0,
        format!("cannot read `{}`: it is a folder", folder.path().display())
    );
}

/// Two masses in a plane under (aa6), of which one states what its filter holds.
const FILTERED: &str = r#"format = 2
time = { end_s = 0.5, record_every_s = 0.1 }
[[agents]]
name = "mass"
count = 2
robot.point_mass = { dimension = 2, mass_kg = 2 }
start.position_m = [[0, 1], [2, 4]]
[[agents]]
name = "other"
robot.point_mass = { dimension = 2, mass_kg = 3 }
start = { position_m = [1, 0], reference.filter = [0.25, -0.5] }
[reference.backstepping]
filter_s = 0.5
[network]
edges.ring = {}
"#;

#[test]
fn what_the_filter_of_the_baseline_holds_is_stated_or_settled() {
    use forwardstep_sim::{Signal, simulate};
    let control = "[control]\nsample_hz = 100\n";
    for text in [FILTERED.to_owned(), format!("{FILTERED}{control}")] {
        let setup = read(&text).unwrap_or_else(|error| panic!("{error}")).setup;
        assert_eq!(setup.agents[2].start.reference, [[0.25, -0.5]]);
        let outcome = simulate(&setup, &mut |_| std::ops::ControlFlow::Continue(())).unwrap();
        let at_start = |agent: usize, signal: Signal, axis: usize| {
            let columns = &outcome.recording.columns;
            let found = columns.iter().find(|c| (c.agent, c.signal, c.axis) == (agent, signal, axis));
            found.unwrap().values[0]
        };
        // q̇_r = −(q − q_j), ż = (q̇_r − f)/ε: `other` hears mass-2, and those whose filter has settled have none.
        for (axis, f) in [0.25, -0.5].into_iter().enumerate() {
            let z = [1.0, 4.0][axis];
            assert_eq!(at_start(2, Signal::Reference(0), axis), z);
            assert_eq!(at_start(2, Signal::Reference(1), axis), (z - f) / 0.5);
            assert_eq!(at_start(0, Signal::Reference(1), axis), 0.0);
            assert_eq!(at_start(1, Signal::Reference(1), axis), 0.0);
        }
    }
    let each = FILTERED.replace("start.position_m", "start.reference.filter = [[1, 2], [3, 4]]\nstart.position_m");
    assert_eq!(read(&each).unwrap().setup.agents[1].start.reference, [[3.0, 4.0]]);
    #[rustfmt::skip]
    let cases: &[super::Case] = &[
        ("reference.filter = [0.25, -0.5]", "reference.filter = [0.25]",
            "test.toml:11:51: `filter` has 1 entry, but `other` needs 2", ""),
        ("reference.filter = [0.25, -0.5]", "reference.z = [0.25, 1]",
            "test.toml:11:46: `z` says nothing about `other`", "`filter` may be stated"),
        ("[reference.backstepping]\nfilter_s = 0.5", "[reference.consensus]\nroots_per_s = [1]\nexchange = \"position\"",
            "test.toml:11:51: `filter` says nothing about `other`", "agents under `reference.backstepping`"),
        ("reference.filter = [0.25, -0.5]", "reference.attitude = [0, 0, 0, 1]",
            "test.toml:11:53: `attitude` says nothing about `other`", "vehicles, rotorcraft and spacecraft have an attitude"),
    ];
    super::refused(FILTERED, cases);
}

/// One that switches at 1 s and at 3 s, to be recorded in many ways.
fn recorded(record: &str, control: &str) -> String {
    let text = super::SOUND.replace("record_every_s = 0.1\n", record).replace("end_s = 10", "end_s = 2.5");
    text.replace("[goal]", &format!("{control}[goal]"))
}

#[test]
fn rows_are_where_they_are_asked_for() {
    use forwardstep_sim::{RecordAt, simulate};
    const HZ: f64 = 70.0;
    let control = format!("[control]\nsample_hz = {HZ}\n");
    let outcome = |text: &str| {
        let setup = read(text).unwrap_or_else(|error| panic!("{error}")).setup;
        simulate(&setup, &mut |_| std::ops::ControlFlow::Continue(())).unwrap()
    };
    let times = |text: &str| outcome(text).recording.t_s;
    // Samples, to the bit, and the end.
    let at_samples = recorded("record_at = \"samples\"\n", &control);
    let expected: Vec<f64> = (0..175).map(|k| f64::from(k) / HZ).chain([2.5]).collect();
    assert_eq!(times(&at_samples), expected);
    // Times as they are stated, with the start and the end; at a switch just after it.
    let stated = |list: &str| recorded(&format!("record_at.times_s = [{list}]\n"), "");
    assert_eq!(times(&stated("0.3, 1, 1.7")), [0.0, 0.3, 1.0, 1.7, 2.5]);
    assert_eq!(times(&stated("0, 2.5")), [0.0, 2.5]);
    assert_eq!(times(&stated("0, 1e-9")), [0.0, 1e-9, 2.5]);
    assert_eq!(times(&stated("")), [0.0, 2.5]);
    // What is recorded does not depend on where else there are rows.
    for control in ["", &control] {
        let often = outcome(&recorded("record_every_s = 0.25\n", control)).recording;
        let some = outcome(&recorded("record_at.times_s = [0.5, 1, 2.25]\n", control)).recording;
        for (row, k) in [0, 2, 4, 9, 10].into_iter().enumerate() {
            assert_eq!(some.t_s[row], often.t_s[k]);
            for (some, often) in some.columns.iter().zip(&often.columns) {
                assert_eq!(some.values[row].to_bits(), often.values[k].to_bits(), "{:?} at row {row}", some.signal);
            }
        }
    }
    let setup = read(&at_samples).unwrap().setup;
    assert_eq!(setup.time.record_at, RecordAt::Rate { hz: HZ });
}

#[test]
fn times_of_rows_come_from_a_table_too() {
    let folder = tempfile::tempdir().unwrap();
    let read = |table: &str| {
        std::fs::write(folder.path().join("times.csv"), table).unwrap();
        let text = recorded("record_at.csv.file = \"times.csv\"\n", "");
        let source = forwardstep_io::SourceText::new("test.toml", text);
        forwardstep_io::scenario::read_scenario("test", &source, Some(folder.path()))
    };
    let scenario = read("t_s\n0.25\n2\n").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scenario.setup.time.record_at, forwardstep_sim::RecordAt::Times([0.25, 2.0].into()));
    assert_eq!(scenario.inputs.len(), 1);
    for (table, line) in [
        ("t_s\n2\n0.25\n", "times.csv:3:1: `t_s` goes from 2 to 0.25, but must rise"),
        ("t_s\n2\n3\n", "times.csv:3:1: `t_s` is 3, but must be from 0 to 2.5"),
        ("t_s\n-1\n", "times.csv:2:1: `t_s` is -1, but must be from 0 to 2.5"),
    ] {
        let error = read(table).unwrap_err().to_string();
        assert!(error.ends_with(line), "{error}");
    }
}

#[rustfmt::skip]
const RECORDS: &[super::Case] = &[
    ("record_every_s = 0.1", "record_every_s = 0.1\nrecord_at = \"samples\"",
        "test.toml:6:18: both `record_every_s` and `record_at` say when rows are recorded", "leave one of them out"),
    ("record_every_s = 0.1", "record_at = \"samples\"",
        "test.toml:6:13: rows are to be recorded at samples, but control is continuous", "`[control]`"),
    ("record_every_s = 0.1", "record_at.times_s = [1, 1]",
        "test.toml:6:25: `times_s` goes from 1 to 1, but must rise", ""),
    ("record_every_s = 0.1", "record_at.times_s = [1, 11]",
        "test.toml:6:25: `times_s` is 11, but must be from 0 to 10", ""),
    ("record_every_s = 0.1", "record_at.times_s = [nan]",
        "test.toml:6:22: nan is not a finite number", ""),
    ("record_every_s = 0.1", "record_at = \"sample\"",
        "test.toml:6:13: unknown choice `sample`", "did you mean `samples`?"),
];

#[test]
fn mistakes_about_rows_are_reported_at_their_place() {
    super::refused(super::SOUND, RECORDS);
    // As many rows as at an interval, and no more.
    let many = super::SOUND.replace("record_every_s = 0.1\n", "record_at = \"samples\"\n");
    let many = many.replace("[goal]", "[control]\nsample_hz = 900000\n[goal]");
    let error = read(&many).unwrap().check_recording().unwrap_err();
    assert!(error.to_string().contains("the recording would hold"), "{error}");
    assert!(miette::Diagnostic::help(&error).unwrap().to_string().contains("record at fewer times"));
}
