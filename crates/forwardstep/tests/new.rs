//! `new`: every combination of its options is a scenario that runs.

use std::fs;
use std::ops::ControlFlow;

use crate::support::{folder, forwardstep, is_long, some, stderr, stdout};
use forwardstep::check::{Answer, check};
use forwardstep::io::robot::open_robot;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::scenario::{
    RobotTemplate, SHIPPED_SCENARIOS, Scenario, TaskTemplate, Template, TemplateDelay, TemplateGraph, read_scenario,
};
use forwardstep::io::{SourceText, UrdfOptions};
use forwardstep::sim::{Ending, Exchange, simulate};

const TREE: &str = include_str!("../../../validation/urdf/tree.urdf");

/// Every kind of robot that `new` offers, and two from URDFs.
fn robots() -> Vec<RobotTemplate> {
    let kinds = Kinds::shipped();
    let known = kinds.robot_keys().into_iter().filter_map(|key| kinds.template(key));
    let urdf = |file| RobotTemplate::urdf(file, false, &open_robot(file, &UrdfOptions::default()).unwrap().robot);
    known.chain([urdf("ur5e.urdf"), urdf("panda.urdf")]).collect()
}

fn read(template: &Template) -> Scenario {
    let text = template.text();
    read_scenario("new", &SourceText::new("new", text.as_str()), None).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn runs(template: &Template) {
    let mut scenario = read(template);
    assert_eq!(scenario.title, template.title);
    assert_eq!(scenario.setup.agents.len(), template.agents as usize);
    scenario.setup.time.end_s = 0.3;
    let outcome = simulate(&scenario.setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed, "{}", template.text());
}

#[test]
fn every_combination_is_a_scenario_that_runs() {
    use TemplateGraph::{Complete, Path, Random, Ring, Star, Switching};
    let graphs = [Ring, Path, Star, Complete, Random, Switching];
    let delays = [TemplateDelay::Constant, TemplateDelay::SawTooth, TemplateDelay::Radio, TemplateDelay::None];
    let exchanges = [Exchange::Position, Exchange::PositionVelocity];
    let (mut count, robots) = (0, robots());
    for robot in &robots {
        let TaskTemplate::Agree { orders: [lowest, highest], exchange: only, follows } = robot.task else {
            runs(&Template::new(robot.clone()));
            continue;
        };
        let links = graphs.iter().flat_map(|graph| delays.map(|delay| (*graph, delay)));
        for (k, (graph, delay)) in some(links.enumerate(), 5) {
            let (agents, order) = [(2, 1), (3, 8), (5, 3)][k % 3];
            for exchange in exchanges.into_iter().filter(|exchange| only.is_none_or(|only| only == *exchange)) {
                let title = format!("{}, \"{exchange:?}\", {graph:?}, {delay:?} \\ {agents}, {order}", robot.line);
                let usual = Template::new(robot.clone());
                let template =
                    Template { title, agents, order: order.clamp(lowest, highest), exchange, graph, delay, ..usual };
                assert_eq!(read(&template).setup.agents[0].roots_per_s.len(), template.order as usize);
                runs(&template);
                count += 1;
            }
        }
        if follows {
            for graph in [Ring, Path, Star, Complete, Random, Switching] {
                let usual = Template::new(robot.clone());
                runs(&Template { leader: true, graph, delay: TemplateDelay::None, ..usual });
            }
        }
    }
    let choosing =
        robots.iter().filter(|robot| matches!(robot.task, TaskTemplate::Agree { exchange: None, .. })).count();
    assert_eq!((robots.len(), choosing, count), (12, 5, some(0..24, 5).count() * (2 * 5 + 6)));
}

#[test]
fn agents_start_within_their_limits_and_a_random_graph_reaches_everybody() {
    for robot in robots() {
        for agent in read(&Template { agents: 9, ..Template::new(robot) }).setup.agents {
            for (axis, q) in agent.robot.axes.iter().zip(&agent.start.q) {
                let [low, high] = axis.position_limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
                assert!(low < *q && *q < high, "{} of {} starts at {q}", axis.name, agent.name);
            }
        }
    }
    for agents in [2, 3, 17, 100] {
        let arm = Kinds::shipped().template("planar_arm").unwrap();
        let report = check(&read(&Template { agents, graph: TemplateGraph::Random, ..Template::new(arm) }).setup);
        assert_eq!(report.worst(), Answer::Holds, "{agents}");
    }
}

#[test]
fn options_are_written_down_and_the_scenario_runs() {
    let folder = folder();
    let cases: [&[&str]; 10] = [
        &[],
        &["--robot", "point_mass", "--agents", "2", "--order", "1", "--graph", "path", "--delay", "none"],
        &["--robot", "ur5e", "--order", "3", "--exchange", "position", "--graph", "complete"],
        &["--robot", "panda", "--agents", "3", "--delay", "saw_tooth", "--name", "Three \"arms\""],
        &["--robot", "planar_arm", "--exchange", "position-velocity", "--delay", "saw-tooth", "--order", "4"],
        &["--robot", "ship", "--leader", "--agents", "1"],
        &["--robot", "planar_arm", "--leader", "--graph", "switching", "--agents", "4"],
        &["--robot", "spacecraft"],
        &["--robot", "vehicle", "--graph", "switching", "--delay", "radio", "--agents", "3"],
        &["--robot", "strict-feedback", "--graph", "star"],
    ];
    // The fourth is looked at below.
    for (k, options) in cases.iter().enumerate().filter(|(k, _)| is_long() || [3, 9].contains(k)) {
        let file = format!("case-{k}.toml");
        let mut arguments = vec!["new", &file];
        arguments.extend(*options);
        let written = forwardstep(&folder, &arguments).success();
        assert_eq!(stdout(&written), format!("wrote {file}; next: forwardstep run {file}\n"));
        // On a slow machine it says before that it is still trying.
        assert!(stderr(&written).lines().any(|line| line.starts_with("tried ")), "{}", stderr(&written));
        let text = fs::read_to_string(folder.path().join(&file)).unwrap();
        let (schema, text) = text.split_once('\n').unwrap();
        assert_eq!(schema, "#:schema ./forwardstep.schema.json");
        assert!(text.contains("\n[goal]\n"), "what was reached is the goal: {text}");
        if !options.contains(&"--name") {
            arguments.extend(["--name", file.trim_end_matches(".toml")]);
        }
        arguments.remove(1);
        assert_eq!(stdout(&forwardstep(&folder, &arguments).success()), text, "to standard output as well");
        forwardstep(&folder, &["run", &file]).success();
    }
    let schema = fs::read_to_string(folder.path().join("forwardstep.schema.json")).unwrap();
    assert_eq!(schema, stdout(&forwardstep(&folder, &["schema"]).success()));
    let text = fs::read_to_string(folder.path().join("case-3.toml")).unwrap();
    for line in ["count = 3 ", "delay.saw_tooth = ", "[\"arm-3\", \"arm-1\"]", "robot.urdf.file = \"panda.urdf\""] {
        assert!(text.lines().any(|found| found.trim_start().starts_with(line)), "no {line} in {text}");
    }
}

#[test]
fn a_robot_of_ones_own_is_found_from_the_scenario() {
    let folder = folder();
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::write(folder.path().join("tree.urdf"), TREE.replace("damping=\"0.7\"", "damping=\"0.7\" friction=\"0.1\""))
        .unwrap();
    for file in ["here.toml", "sub/there.toml"] {
        forwardstep(&folder, &["new", file, "--robot", "tree.urdf", "--agents", "2"]).success();
        forwardstep(&folder, &["run", file]).success();
        let text = fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(text.contains("friction = \"ignore\""), "{text}");
    }
}

#[test]
fn dry_friction_is_written_for_robots_with_joints_and_estimates_are_kept_near_what_is_known() {
    let folder = folder();
    fs::write(folder.path().join("tree.urdf"), TREE.replace("damping=\"0.7\"", "damping=\"0.7\" friction=\"0.1\""))
        .unwrap();
    for (robot, line) in [
        ("planar_arm", "friction.dry = { coulomb = 0.5 } }"),
        ("point_mass", "friction.dry = { coulomb = 0.5 } }"),
        ("ur5e", "robot.urdf.friction.dry = { coulomb = 0.5 }"),
        ("tree.urdf", "robot.urdf.friction.dry = {}"),
    ] {
        let file = format!("{}.toml", robot.trim_end_matches(".urdf"));
        let arguments = ["new", &file, "--robot", robot, "--agents", "2", "--dry-friction"];
        let told = stderr(&forwardstep(&folder, &arguments).success());
        assert!(told.contains("0.8 of everything known") && !told.contains("nothing known"), "{told}");
        let text = fs::read_to_string(folder.path().join(&file)).unwrap();
        assert!(text.contains(line) && text.contains("bounds.within = 0.3") && !text.contains("\"ignore\""), "{text}");
        assert_eq!(text.matches("estimate_start").count(), 1, "{text}");
        let report = stdout(&forwardstep(&folder, &["check", &file]).code(1));
        assert!(report.contains("smooth-friction") || report.contains("dry friction"), "{report}");
    }
    // Nobody pushes them.
    forwardstep(&folder, &["run", "point_mass.toml"]);
    let page = fs::read_to_string(folder.path().join("forwardstep-runs/point_mass/report.html")).unwrap();
    assert!(page.contains("τ_ext, by the joints themselves") && !page.contains("τ_ext, by pushes"));
}

#[test]
fn mistakes_are_status_two_and_nothing_is_overwritten() {
    let folder = folder();
    fs::write(folder.path().join("mine.toml"), "mine").unwrap();
    let cases: [(&[&str], &str); 19] = [
        (&["mine.toml"], "`mine.toml` already exists"),
        (&["none/new.toml"], "make it first"),
        (&["new.toml", "--robot", "ur5"], "did you mean `ur5e`?"),
        (&["new.toml", "--robot", "none.urdf"], "cannot read `none.urdf`"),
        (&["new.toml", "--agents", "0"], "must be a whole number from 1 to 100"),
        (&["new.toml", "--agents", "1"], "no other to agree with"),
        (&["new.toml", "--robot", "vehicle", "--order", "2"], "dynamics of order 3, not 2"),
        (&["new.toml", "--robot", "chain", "--exchange", "position_velocity"], "positions of others only"),
        (&["new.toml", "--robot", "rotorcraft", "--leader"], "vehicles-behind-a-leader"),
        (&["new.toml", "--robot", "chain", "--leader"], "`reference.desired`"),
        (&["new.toml", "--robot", "quadrotor"], "`robot.rotorcraft`"),
        (&["new.toml", "--leader", "--delay", "radio"], "leader-over-late-links"),
        (&["new.toml", "--leader", "--order", "2"], "cannot be used with"),
        (&["new.toml", "--robot", "spacecraft", "--graph", "star"], "a target of its own"),
        (&["new.toml", "--robot", "ship", "--dry-friction"], "no joints, so that friction has no effect"),
        (&["new.toml", "--like", "theorem-11"], "did you mean"),
        (&["new.toml", "--order", "0"], "must be a whole number from 1 to 8"),
        (&["new.toml", "--graph", "rings"], "ring"),
        (&["new.toml", "--delay", "some"], "saw_tooth"),
    ];
    for (options, message) in cases {
        let mut arguments = vec!["new"];
        arguments.extend(options);
        let error = stderr(&forwardstep(&folder, &arguments).code(2));
        assert!(error.contains(message), "{arguments:?}: {error}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(fs::read_to_string(folder.path().join("mine.toml")).unwrap(), "mine");
}

#[test]
fn any_shipped_scenario_is_a_place_to_start_from() {
    let folder = folder();
    for shipped in SHIPPED_SCENARIOS {
        let file = format!("{}-of-mine.toml", shipped.name);
        assert_eq!(stderr(&forwardstep(&folder, &["new", &file, "--like", shipped.name]).success()), "");
        let text = fs::read_to_string(folder.path().join(&file)).unwrap();
        assert_eq!(text.split_once('\n').unwrap().1, shipped.text);
    }
    // Tables are found beside a copy as well.
    forwardstep(&folder, &["run", "from-a-log-of-mine.toml"]).success();
}

#[test]
fn what_does_not_agree_in_time_gets_more_time_or_other_gains_or_says_why_not() {
    let folder = folder();
    let told = stderr(&forwardstep(&folder, &["new", "slow.toml", "--agents", "12"]).success());
    let text = fs::read_to_string(folder.path().join("slow.toml")).unwrap();
    assert!(!text.contains("\nend_s = 60 ") && told.lines().count() == 1, "{told}{text}");
    forwardstep(&folder, &["run", "slow.toml"]).success();
    // A joint that leaves its limits while nothing is known of the robot.
    fs::write(folder.path().join("tight.urdf"), PENDULUM.replace("LIMIT", "0.3").replace("DAMPING", "0")).unwrap();
    let told =
        stderr(&forwardstep(&folder, &["new", "tight.toml", "--robot", "tight.urdf", "--agents", "2"]).success());
    let text = fs::read_to_string(folder.path().join("tight.toml")).unwrap();
    assert!(told.lines().count() == 2 && told.contains("but hinge of arm-1 leaves its limits"), "{told}");
    assert!(!told.contains("no trial kept"), "{told}");
    assert!(text.contains("adaptation_gain = { bandwidth_per_s = 20 }"), "{text}");
    // Damping without the inertia of the rotors behind it.
    fs::write(folder.path().join("light.urdf"), PENDULUM.replace("LIMIT", "3").replace("DAMPING", "1e5")).unwrap();
    let written = forwardstep(&folder, &["new", "light.toml", "--robot", "light.urdf", "--agents", "2"]).code(1);
    let told = stderr(&written);
    assert!(told.contains("too stiff for a trial") && !told.contains("Broke down"), "{told}");
    assert!(!stdout(&written).contains("; next: forwardstep run"), "{}", stdout(&written));
    assert!(told.contains("D/λ_min(M)") && told.contains("`armature`") && told.contains("no trial did"), "{told}");
    let text = fs::read_to_string(folder.path().join("light.toml")).unwrap();
    assert!(text.contains("# [goal]") && text.contains("damping.bandwidth_per_s = 20 "), "{text}");
    assert!(text.contains("\n# No trial of this did what it should: ") && text.contains("`armature`"), "{text}");
    // What fails alike however long it is waited for is said once.
    let tight = PENDULUM.replace("-LIMIT", "0.1").replace("LIMIT", "0.1001").replace("DAMPING", "0");
    fs::write(folder.path().join("narrow.urdf"), tight).unwrap();
    let arguments = ["new", "narrow.toml", "--robot", "narrow.urdf", "--agents", "2", "--dry-friction"];
    let told = stderr(&forwardstep(&folder, &arguments));
    let mut lines: Vec<&str> = told.lines().collect();
    let count = lines.len();
    lines.sort_unstable();
    lines.dedup();
    assert_eq!(lines.len(), count, "{told}");
    // A motor that is too weak for what the trial asks of it.
    fs::write(
        folder.path().join("weak.urdf"),
        PENDULUM.replace("LIMIT", "3").replace("DAMPING", "0").replace("effort=\"100\"", "effort=\"0.1\""),
    )
    .unwrap();
    let told = stderr(&forwardstep(&folder, &["new", "weak.toml", "--robot", "weak.urdf", "--agents", "2"]).success());
    assert!(told.contains("but hinge of arm-") && told.contains("where its effort limit is 0.1 N"), "{told}");
    let text = fs::read_to_string(folder.path().join("weak.toml")).unwrap();
    assert!(text.contains("\n# In the trial hinge of arm-") && text.contains("`enforce_limits = true`"), "{text}");
    // Of those that all take too much the one that takes least, which is what it takes to be held.
    assert!(told.contains("takes 6.2 N m") && text.contains("takes 4.9 N m"), "{told}{text}");
    // That none kept within them is said, with what was taken all the same.
    let taken = "no trial kept within the effort limits, which runs report and do not enforce; what is written is the one that came nearest: with \
                 bandwidths of 1 and 1 per second and all known";
    assert!(told.lines().last().is_some_and(|last| last.contains(taken)), "{told}");
    // Gains that need no more than there is are taken where others would.
    fs::write(
        folder.path().join("fair.urdf"),
        PENDULUM.replace("LIMIT", "3").replace("DAMPING", "0").replace("effort=\"100\"", "effort=\"5\""),
    )
    .unwrap();
    let told = stderr(&forwardstep(&folder, &["new", "fair.toml", "--robot", "fair.urdf", "--agents", "2"]).success());
    assert!(told.contains("where its effort limit is 5 N"), "{told}");
    let text = fs::read_to_string(folder.path().join("fair.toml")).unwrap();
    assert!(!text.contains("In the trial"), "{told}{text}");
    forwardstep(&folder, &["run", "weak.toml"]).success();
    forwardstep(&folder, &["new", "untried.toml", "--robot", "light.urdf", "--agents", "2", "--untried"]).success();
}

/// What cannot be written, or could not be named in any other command, is refused before gains are tried.
#[cfg(unix)]
#[test]
fn regress_where_nothing_can_be_written_is_said_before_gains_are_tried() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let folder = folder();
    let new = |file: &OsStr| {
        let mut command = assert_cmd::Command::cargo_bin("forwardstep").unwrap();
        stderr(&command.current_dir(&folder).arg("new").arg(file).args(["--agents", "2"]).assert().code(2))
    };
    fs::write(folder.path().join("file"), "").unwrap();
    for (file, said) in [
        (OsStr::from_bytes(b"f\xff.toml"), "not UTF-8"),
        (OsStr::new("file/own.toml"), "`file` exists and is no folder"),
        (OsStr::new("none/own.toml"), "there is no folder `none`"),
    ] {
        let told = new(file);
        assert!(told.contains(said) && !told.contains("tried"), "{told}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// A pendulum of 1 kg, half a metre long.
const PENDULUM: &str = r#"<robot name="pendulum"><link name="base"/><link name="rod"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
<limit lower="-LIMIT" upper="LIMIT" effort="100" velocity="10"/><dynamics damping="DAMPING"/></joint></robot>
"#;
