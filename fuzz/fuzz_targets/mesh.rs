//! A mesh of a robot, as `run --meshes` reads it: STL, OBJ or DAE by the first byte, the rest is the file.

#![no_main]

use std::sync::LazyLock;

use forwardstep::io::scenario::Scenario;
use forwardstep::io::shapes::Shapes;
use forwardstep_fuzz::{Scratch, one_line, open, prompt};
use libfuzzer_sys::fuzz_target;

const ENDINGS: [&str; 3] = ["stl", "obj", "dae"];

/// Scenarios with a robot that looks like a mesh of each format.
static SCENARIOS: LazyLock<(Scratch, [Scenario; 3])> = LazyLock::new(|| {
    let scratch = Scratch::new();
    let robot = include_str!("../two-joints.urdf");
    let scenarios = ENDINGS.map(|ending| {
        let shape = format!(
            "<link name=\"base\"><visual><geometry><mesh filename=\"fuzzed.{ending}\"/></geometry></visual></link>"
        );
        let shaped = robot.replacen("<link name=\"base\"/>", &shape, 1);
        assert!(shaped != robot, "the robot has a base without a shape");
        scratch.write("fuzzed.urdf", shaped.as_bytes());
        open(&scratch.write("pair.toml", include_bytes!("../pair.toml"))).expect("a sound scenario")
    });
    (scratch, scenarios)
});

fuzz_target!(|bytes: &[u8]| {
    let Some((format, bytes)) = bytes.split_first() else { return };
    let (scratch, scenarios) = &*SCENARIOS;
    let format = usize::from(*format) % ENDINGS.len();
    scratch.write(&format!("fuzzed.{}", ENDINGS[format]), bytes);
    let read = || Shapes::read(&scenarios[format].models);
    let (shapes, left_out) = prompt("reading", read);
    assert!(shapes.is_sound());
    left_out.iter().for_each(|why| one_line(why));
    assert_eq!(read(), (shapes, left_out), "read twice");
});
