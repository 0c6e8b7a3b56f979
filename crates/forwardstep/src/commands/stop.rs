//! Ctrl-C and its kin: a run that is told to stop ends in order.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use crate::status::Status;

/// Whether somebody asked the run to stop, and how.
#[derive(Clone, Default)]
pub(crate) struct Stop {
    /// The status to end with; zero until somebody asks.
    asked: Arc<AtomicU8>,
    /// Whether nothing is there that has to be ended in order.
    at_once: Arc<AtomicBool>,
}

impl Stop {
    /// Listens from now on. The first signal lets the run end in order; the second ends the program.
    pub(crate) fn listen() -> Self {
        let stop = Stop::default();
        let interrupted = stop.clone();
        // Without a handler Ctrl-C still ends the program, only nothing is kept.
        let _ = ctrlc::set_handler(move || interrupted.ask(Status::Interrupted));
        #[cfg(unix)]
        stop.listen_to_termination();
        stop
    }

    /// The status to end with, once somebody has asked.
    pub(crate) fn asked(&self) -> Option<Status> {
        let asked = self.asked.load(Ordering::Relaxed);
        [Status::Interrupted, Status::Terminated, Status::HungUp].into_iter().find(|status| *status as u8 == asked)
    }

    /// The same for what asks after every step whether to go on.
    pub(crate) fn flow(&self) -> ControlFlow<()> {
        if self.asked().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Does something that may take long and leaves nothing to be kept: a signal ends the program meanwhile.
    pub(crate) fn at_once<T>(&self, work: impl FnOnce() -> T) -> T {
        self.at_once.store(true, Ordering::Relaxed);
        let done = work();
        self.at_once.store(false, Ordering::Relaxed);
        done
    }

    fn ask(&self, status: Status) {
        if self.asked.swap(status as u8, Ordering::Relaxed) != 0 || self.at_once.load(Ordering::Relaxed) {
            std::process::exit(status as i32);
        }
    }

    /// `kill`, a machine that shuts down, a scheduler whose time is over, a terminal that is closed.
    #[cfg(unix)]
    fn listen_to_termination(&self) {
        use signal_hook::consts::{SIGHUP, SIGTERM};
        use signal_hook::iterator::Signals;

        // Who starts a run under `nohup` wants it to outlive the terminal.
        let wanted = if hangups_are_ignored() { &[SIGTERM][..] } else { &[SIGTERM, SIGHUP] };
        let Ok(mut signals) = Signals::new(wanted) else { return };
        let stop = self.clone();
        std::thread::spawn(move || {
            for signal in signals.forever() {
                stop.ask(if signal == SIGHUP { Status::HungUp } else { Status::Terminated });
            }
        });
    }
}

/// Whether the program was started with SIGHUP ignored, as far as the system tells.
#[cfg(unix)]
fn hangups_are_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    // A bit per signal, from one; SIGHUP is the first.
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}
