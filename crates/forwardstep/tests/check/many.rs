//! More agents than a run could record.

use std::fs;

use crate::support::{folder, forwardstep, stderr, stdout};

const RING: &str = r#"
format = 2
time = { end_s = 60 }
[[agents]]
name = "mass"
count = 12000
robot.point_mass = { dimension = 1, mass_kg = 2 }
start.position_m = { random = { seed = 1, within = [-1.0, 1.0] } }
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position"
[network]
edges.ring = {}
"#;

#[test]
fn regress_a_check_is_not_refused_for_what_a_run_would_record() {
    let folder = folder();
    fs::write(folder.path().join("ring.toml"), RING).unwrap();
    let said = stdout(&forwardstep(&folder, &["check", "ring.toml"]).code(0));
    assert!(said.contains("all in all: holds"), "{said}");
    for command in [&["run"][..], &["compare", "six-arms"], &["explain", "--along"], &["sampling-limit"]] {
        let refused = stderr(&forwardstep(&folder, &[command, &["ring.toml"]].concat()).code(2));
        assert!(refused.contains("the recording would hold"), "{command:?}: {refused}");
        assert!(refused.contains("let `record_every_s` be at least"), "{command:?}: {refused}");
    }
}
