//! Sample runs for the eye and for `validation/browser/check_report.sh`: `sample_reports DIR`.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[path = "../tests/support/mod.rs"]
mod support;

use std::path::PathBuf;
use std::sync::Arc;

use forwardstep_core::robot::PlanarArm;
use forwardstep_io::output::{GoalOutcome, Options, RunFolder, write_run};
use forwardstep_io::scenario::Goal;
use forwardstep_sim::recording::BreakdownCause;
use forwardstep_sim::{Breakdown, Ending, Recording, Signal};
use support::{agent, outcome, record, setup, verdicts};

fn folder(name: &str) -> RunFolder {
    let base = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("target/samples"), PathBuf::from);
    RunFolder::create(base.join(name), true).unwrap()
}

fn main() {
    let report = verdicts();
    let csv = Options { csv: true };

    let arms: Vec<_> = (1..=6).map(|k| agent(&format!("arm-{k}"), 6, 60)).collect();
    let six = setup(arms, 60.0, 0.02);
    let done = outcome(&six);
    write_run(&folder("six-arms"), &record(&six, &done, &report), csv).unwrap();

    let mut broken = done.clone();
    let half = broken.recording.t_s.len() / 2;
    broken.recording.t_s.truncate(half);
    for column in &mut broken.recording.columns {
        column.values.truncate(half);
        if column.agent == 2 && column.signal != Signal::Estimate {
            let n = column.values.len();
            column.values[n - 3..].copy_from_slice(&[1e30, f64::INFINITY, f64::NAN]);
        }
    }
    let breakdown =
        Breakdown { t_s: 29.993, agent: 2, signal: Signal::Velocity, axis: 3, cause: BreakdownCause::NotFinite };
    broken.ending = Ending::BrokeDown(breakdown);
    let mut it = record(&six, &broken, &report);
    it.goal = Some(GoalOutcome { goal: Goal::DisagreementBelow(1e-3), met: false });
    it.notices = vec!["The adaptation gain is far above its usual range; see `forwardstep check`.".into()];
    write_run(&folder("broken"), &it, Options::default()).unwrap();

    let crowd = setup((1..=64).map(|k| agent(&format!("robot-{k}"), 3, 10)).collect(), 120.0, 0.05);
    let many = outcome(&crowd);
    write_run(&folder("crowd"), &record(&crowd, &many, &report), Options::default()).unwrap();

    let mut mixed = setup(vec![agent("<script>alert(1)</script>", 2, 5), agent("b & \"c\" 'd'", 3, 0)], 10.0, 0.01);
    mixed.agents[1].robot.kind = Arc::new(PlanarArm);
    let two = outcome(&mixed);
    let mut it = record(&mixed, &two, &report);
    it.title = "</title></script><script>document.title='gone'</script>";
    it.predicted_agreement = None;
    write_run(&folder("hostile"), &it, Options::default()).unwrap();

    let snake = setup(vec![agent("snake", 32, 320)], 20.0, 0.01);
    let alone = outcome(&snake);
    write_run(&folder("snake"), &record(&snake, &alone, &report), Options::default()).unwrap();

    let mut nothing = done.clone();
    nothing.recording = Recording::default();
    nothing.ending = Ending::Interrupted { t_s: 0.0 };
    write_run(&folder("nothing"), &record(&six, &nothing, &report), csv).unwrap();
}
