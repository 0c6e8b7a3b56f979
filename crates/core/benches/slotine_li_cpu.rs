//! The same step in thread CPU time, one JSON line per case, to stand beside a peer's: see `validation/peers/`.
#![allow(clippy::unwrap_used)] // A broken fixture should stop a benchmark.

mod arms;

use std::hint::black_box;

use rustix::time::{ClockId, clock_gettime};

const BATCHES: usize = 200;
const CALLS: usize = 2000;

fn cpu_ns() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1.0e9 + now.tv_nsec as f64
}

/// Prints median, least and largest time per robot.
fn measure<T>(arm: &str, case: &str, robots: usize, mut call: impl FnMut() -> T) {
    let mut times: Vec<f64> = (0..BATCHES)
        .map(|_| {
            let start = cpu_ns();
            for _ in 0..CALLS / robots {
                black_box(call());
            }
            (cpu_ns() - start) / (CALLS / robots * robots) as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let (median, min, max) = (times[BATCHES / 2], times[0], times[BATCHES - 1]);
    println!(
        "{{\"arm\":\"{arm}\",\"case\":\"{case}\",\"median_ns\":{median:.1},\"min_ns\":{min:.1},\"max_ns\":{max:.1}}}"
    );
}

fn main() {
    for (name, assembled) in arms::arms() {
        let mut one = arms::one(&assembled);
        measure(&name, "forwardstep f64", 1, || one.slotine_li());
        let mut eight = arms::lanes::<8>(&assembled);
        measure(&name, "forwardstep 8 lanes", 8, || eight.slotine_li());
        measure(&name, "forwardstep forward dynamics f64", 1, || one.acceleration());
        measure(&name, "forwardstep forward dynamics 8 lanes", 8, || eight.acceleration());
    }
}
