//! Poses of an end-effector as Pinocchio has them: `validation/poses/generate.py`.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::robot::tree::Tree;
use forwardstep_core::robot::{Posture, TipKinematics};
use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Scenario, read_scenario, shipped_scenario};
use forwardstep_sim::{Signal, TaskSpaceLaw, simulate};
use serde_json::Value;

const TRUTH: &str = include_str!("../../../../validation/poses/poses.json");

fn states() -> Vec<Value> {
    let truth: Value = serde_json::from_str(TRUTH).unwrap();
    truth["states"].as_array().unwrap().clone()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn near(ours: &[f64], theirs: &[f64], what: &str) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    for (ours, theirs) in ours.iter().zip(theirs) {
        assert!((ours - theirs).abs() < 1e-12, "{what}: {ours} is not {theirs}");
    }
}

fn pose(text: &str) -> Scenario {
    read_scenario("pose", &SourceText::new("pose.toml", text), None).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn val_pinocchio_poses_have_the_same_jacobian_and_its_rate() {
    let setup = pose(shipped_scenario("pose-ur5e").unwrap().text).setup;
    let agent = &setup.agents[0];
    let law: &TaskSpaceLaw = agent.law.downcast().unwrap();
    let tip = law.tip.of_tree(agent.robot.kind.downcast::<Arc<Tree>>().unwrap()).unwrap().unwrap();
    let (theta, still) = (tip.parameters(), vec![0.0; tip.parameter_count()]);
    for state in states() {
        let (q, dq) = (numbers(&state["q"]), numbers(&state["dq"]));
        let mut x = [0.0; 3];
        tip.position(&q, &theta, &mut x).unwrap();
        near(&x, &numbers(&state["position"]), "position");
        let (mut j, mut dj) = ([0.0; 36], [0.0; 36]);
        tip.jacobian(Posture { q: &q, dq: &dq, theta: &theta, d_theta: &still }, &mut j, &mut dj).unwrap();
        near(&j, &numbers(&state["jacobian"]), "jacobian");
        near(&dj, &numbers(&state["rate"]), "rate");
    }
}

/// What the law shows at the start of a run.
#[test]
fn val_pinocchio_poses_have_the_same_error() {
    let text = shipped_scenario("pose-ur5e").unwrap().text;
    let (before, rest) = text.split_once("target.formulas = [").unwrap();
    let (_, after) = rest.split_once("]\n").unwrap();
    for state in states() {
        let desired: Vec<String> = numbers(&state["desired"]).iter().map(|entry| format!("{entry}")).collect();
        let mut setup = pose(&format!("{before}target.formulas = [{}]\n{after}", desired.join(", "))).setup;
        setup.agents[0].start.q = numbers(&state["q"]);
        setup.time.end_s = 1e-6;
        let recording = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap().recording;
        let first = |signal| {
            let columns = recording.columns.iter().filter(move |column| column.signal == signal);
            columns.map(|column| column.values[0]).collect::<Vec<f64>>()
        };
        let scalar = state["scalar"].as_f64().unwrap();
        // q and −q are one attitude: Pinocchio's angle is at most half a turn.
        assert!(scalar >= 0.0);
        near(&first(Signal::Error), &numbers(&state["error"]), "error");
        near(&first(Signal::ErrorScalar), &[scalar], "scalar");
    }
}
