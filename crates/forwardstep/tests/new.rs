//! `new`: every combination of its options is a scenario that runs.
#![cfg(feature = "program")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs;
use std::ops::ControlFlow;

use forwardstep::io::SourceText;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::scenario::{RobotTemplate, Template, TemplateDelay, TemplateGraph, read_scenario};
use forwardstep::sim::{Ending, Exchange, simulate};
use support::{folder, forwardstep, stderr, stdout};

const TREE: &str = include_str!("../../../validation/urdf/tree.urdf");

#[test]
fn every_combination_is_a_scenario_that_runs() {
    let (kinds, urdf) = (Kinds::shipped(), |file| RobotTemplate::urdf(file, false));
    let known = |key| kinds.template(key).unwrap();
    let robots = [known("planar_arm"), known("point_mass"), urdf("ur5e.urdf"), urdf("panda.urdf")];
    let exchanges = [Exchange::Position, Exchange::PositionVelocity];
    let graphs = [TemplateGraph::Ring, TemplateGraph::Path, TemplateGraph::Complete];
    let delays = [TemplateDelay::Constant, TemplateDelay::SawTooth, TemplateDelay::None];
    let mut count = 0;
    for robot in &robots {
        for (exchange, graph) in exchanges.iter().flat_map(|exchange| graphs.map(|graph| (*exchange, graph))) {
            for (delay, agents, order) in
                delays.iter().flat_map(|delay| [(*delay, 2, 1), (*delay, 3, 8), (*delay, 5, 3)])
            {
                let title = format!("{}, \"{exchange:?}\", {graph:?}, {delay:?} \\ {agents}, {order}", robot.line);
                let template = Template { title, agents, robot: robot.clone(), order, exchange, graph, delay };
                let text = template.text();
                let mut scenario = read_scenario("new", &SourceText::new("new", text.as_str()), None)
                    .unwrap_or_else(|error| panic!("{error}\n{text}"));
                assert_eq!(scenario.title, template.title);
                assert_eq!(scenario.setup.agents.len(), agents as usize);
                assert_eq!(scenario.setup.agents[0].roots_per_s.len(), order as usize);
                scenario.setup.time.end_s = 0.3;
                let outcome = simulate(&scenario.setup, &mut |_| ControlFlow::Continue(())).unwrap();
                assert_eq!(outcome.ending, Ending::Completed, "{}", template.title);
                count += 1;
            }
        }
    }
    assert_eq!(count, 4 * 2 * 3 * 3 * 3);
}

#[test]
fn options_are_written_down_and_the_scenario_runs() {
    let folder = folder();
    let cases: [&[&str]; 5] = [
        &[],
        &["--robot", "point_mass", "--agents", "2", "--order", "1", "--graph", "path", "--delay", "none"],
        &["--robot", "ur5e", "--order", "3", "--exchange", "position", "--graph", "complete"],
        &["--robot", "panda", "--agents", "3", "--delay", "saw_tooth", "--name", "Three \"arms\""],
        &["--robot", "planar_arm", "--exchange", "position-velocity", "--delay", "saw-tooth", "--order", "4"],
    ];
    for (k, options) in cases.iter().enumerate() {
        let file = format!("case-{k}.toml");
        let mut arguments = vec!["new", &file];
        arguments.extend(*options);
        let written = forwardstep(&folder, &arguments).success();
        assert_eq!(
            (stdout(&written), stderr(&written)),
            (format!("wrote {file}; next: forwardstep run {file}\n"), String::new())
        );
        let text = fs::read_to_string(folder.path().join(&file)).unwrap();
        if !options.contains(&"--name") {
            arguments.extend(["--name", file.trim_end_matches(".toml")]);
        }
        arguments.remove(1);
        assert_eq!(stdout(&forwardstep(&folder, &arguments).success()), text, "to standard output as well");
        forwardstep(&folder, &["run", &file]).success();
    }
    let text = fs::read_to_string(folder.path().join("case-3.toml")).unwrap();
    for line in ["count = 3 ", "delay.saw_tooth = ", "[\"arm-3\", \"arm-1\"]", "robot.urdf = { file = \"panda.urdf\" }"]
    {
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
        ("ur5e", "robot.urdf = { file = \"ur5e.urdf\", friction.dry = { coulomb = 0.5 } }"),
        ("tree.urdf", "robot.urdf = { file = \"tree.urdf\", friction.dry = {} }"),
    ] {
        let file = format!("{}.toml", robot.trim_end_matches(".urdf"));
        forwardstep(&folder, &["new", &file, "--robot", robot, "--agents", "2", "--dry-friction"]).success();
        let text = fs::read_to_string(folder.path().join(&file)).unwrap();
        assert!(text.contains(line) && text.contains("bounds.within = 0.3") && !text.contains("\"ignore\""), "{text}");
        assert_eq!(text.matches("estimate_start").count(), 1, "{text}");
        let report = stdout(&forwardstep(&folder, &["check", &file]).code(1));
        assert!(report.contains("smooth-friction") || report.contains("dry friction"), "{report}");
    }
}

#[test]
fn mistakes_are_status_two_and_nothing_is_overwritten() {
    let folder = folder();
    fs::write(folder.path().join("mine.toml"), "mine").unwrap();
    let cases: [(&[&str], &str); 8] = [
        (&["mine.toml"], "`mine.toml` already exists"),
        (&["none/new.toml"], "make its folder first"),
        (&["new.toml", "--robot", "ur5"], "did you mean `ur5e`?"),
        (&["new.toml", "--robot", "none.urdf"], "cannot read `none.urdf`"),
        (&["new.toml", "--agents", "1"], "must be a whole number from 2 to 100"),
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
