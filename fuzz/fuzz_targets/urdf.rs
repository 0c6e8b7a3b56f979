//! A robot from a file: described, moved, with joints locked, and as the robot of a scenario.

#![no_main]

use std::sync::LazyLock;

use forwardstep::io::robot::{JointState, OpenRobotError, open_robot};
use forwardstep::io::urdf::FrictionPolicy;
use forwardstep::io::{UrdfOptions, UrdfRobot};
use forwardstep_fuzz::{Scratch, complaint, described, moved, open, prompt, tried};
use libfuzzer_sys::fuzz_target;

/// Robots with more joints are not put into a scenario.
const MOST_JOINTS: usize = 30;

static SCRATCH: LazyLock<Scratch> = LazyLock::new(|| {
    let scratch = Scratch::new();
    scratch.write("pair.toml", include_bytes!("../pair.toml"));
    scratch
});

/// Opens the robot as `forwardstep robot` does; `None` when it is refused, with a message that can be shown.
fn read(options: &UrdfOptions) -> Option<UrdfRobot> {
    let path = SCRATCH.folder().join("fuzzed.urdf");
    let open = || open_robot(path.to_str().expect("a path of our own"), options);
    match prompt("reading", open) {
        Ok(robot) => {
            let again = open().expect("what was read can be read again");
            assert_eq!(format!("{:?}", again.robot), format!("{:?}", robot.robot), "read twice");
            Some(robot)
        }
        Err(error) => {
            let shown = complaint(&error);
            assert!(!matches!(error, OpenRobotError::Unknown { .. }), "{shown}");
            assert_eq!(complaint(&open().expect_err("what was refused is refused again")), shown, "read twice");
            None
        }
    }
}

fuzz_target!(|bytes: &[u8]| {
    SCRATCH.write("fuzzed.urdf", bytes);
    let ignoring = UrdfOptions { friction: FrictionPolicy::Ignore, ..UrdfOptions::default() };
    let strict = read(&UrdfOptions::default());
    let Some(robot) = read(&ignoring) else {
        assert!(strict.is_none(), "refused only when friction is left out");
        return;
    };
    described(&robot);
    let names: Vec<&str> = robot.robot.axes.iter().map(|axis| axis.name.as_str()).collect();
    let zeros = vec![0.0; names.len()];
    let rest = JointState { q: zeros.clone(), dq: zeros.clone(), z: zeros.clone(), dz: zeros };
    moved(&robot, &rest);
    if let [first, _, ..] = names[..] {
        let options = UrdfOptions { locked: vec![(first.to_owned(), 0.5)], ..ignoring };
        if let Some(locked) = read(&options) {
            assert_eq!(locked.robot.axes.len(), names.len() - 1);
            described(&locked);
        }
    }
    if strict.is_some() && names.len() <= MOST_JOINTS {
        let scenario = open(&SCRATCH.folder().join("pair.toml")).expect("a robot by itself is a robot in a scenario");
        tried(&SCRATCH, scenario);
    }
});
