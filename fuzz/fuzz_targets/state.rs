//! A state of a robot from a file, and the dynamics there.

#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use forwardstep::io::robot::{open_robot, open_state};
use forwardstep::io::{UrdfOptions, UrdfRobot};
use forwardstep_fuzz::{Scratch, complaint, moved, prompt};
use libfuzzer_sys::fuzz_target;

/// A shipped robot, and one with the joints `shoulder` and `elbow` of the seeds.
static ROBOTS: LazyLock<(Scratch, [UrdfRobot; 2])> = LazyLock::new(|| {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("two-joints.urdf");
    let robot = |name: &str| open_robot(name, &UrdfOptions::default()).expect("a sound robot");
    (Scratch::new(), [robot(own.to_str().expect("a path in UTF-8")), robot("ur5e")])
});

fuzz_target!(|bytes: &[u8]| {
    let (scratch, robots) = &*ROBOTS;
    let path = scratch.write("fuzzed.json", bytes);
    for robot in robots {
        match prompt("reading", || open_state(&path, robot)) {
            Ok(state) => {
                for numbers in [&state.q, &state.dq, &state.z, &state.dz] {
                    assert_eq!(numbers.len(), robot.robot.axes.len());
                    assert!(numbers.iter().all(|number| number.is_finite()), "{numbers:?}");
                }
                assert_eq!(open_state(&path, robot).expect("what was read can be read again"), state);
                moved(robot, &state);
            }
            Err(error) => {
                let shown = complaint(&error);
                let again = open_state(&path, robot).expect_err("what was refused is refused again");
                assert_eq!(complaint(&again), shown, "read twice");
            }
        }
    }
});
