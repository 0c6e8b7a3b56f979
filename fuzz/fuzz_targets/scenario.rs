//! A scenario from a file, with a table and a robot beside it, all the way to a few steps of its run.

#![no_main]

use std::sync::LazyLock;

use forwardstep_fuzz::{Scratch, open, tried};
use libfuzzer_sys::fuzz_target;

static SCRATCH: LazyLock<Scratch> = LazyLock::new(|| {
    let scratch = Scratch::new();
    scratch.write("edges.csv", b"from,to,weight,delay_s\narm-1,arm-2,2,0.1\narm-2,arm-1,,\n");
    scratch.write("panda.urdf", include_bytes!("../../crates/io/robots/panda.urdf"));
    scratch
});

fuzz_target!(|bytes: &[u8]| {
    let path = SCRATCH.write("fuzzed.toml", bytes);
    if let Some(scenario) = open(&path) {
        tried(&SCRATCH, scenario);
    }
});
