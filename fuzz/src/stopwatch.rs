//! Small files are answered at once.

use rustix::time::{ClockId, clock_gettime};

/// Processor time that one step may take for a file of at most [`LONGEST`] bytes, in seconds. Instrumented code is about
/// three times as slow as the program.
const MOST_S: f64 = 3.0;

/// Does one step, and fails when it takes too long. Time is that of the processor: others may be busy on this machine.
pub fn prompt<T>(what: &str, step: impl FnOnce() -> T) -> T {
    within(MOST_S, what, step)
}

/// The same with another bound.
pub fn within<T>(most_s: f64, what: &str, step: impl FnOnce() -> T) -> T {
    let started = processor_s();
    let result = step();
    let took_s = processor_s() - started;
    assert!(took_s <= most_s, "{what} took {took_s:.2} s");
    result
}

fn processor_s() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
}
