//! A word on standard error when something takes long that shows no progress.

use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use crate::console::remark;

/// How long nothing needs to be said.
const AFTER: Duration = Duration::from_secs(5);

/// Says a sentence once, if it is still there after some seconds.
pub(crate) struct Patience {
    /// Whoever waits at the other end hears when it is gone.
    _ended: Option<Sender<()>>,
}

impl Patience {
    pub(crate) fn with(sentence: &'static str) -> Self {
        let (ended, waits) = mpsc::channel::<()>();
        let watch = move || {
            if waits.recv_timeout(AFTER) == Err(RecvTimeoutError::Timeout) {
                remark(sentence);
            }
        };
        // Without a thread it stays silent.
        Patience { _ended: thread::Builder::new().spawn(watch).ok().map(|_| ended) }
    }
}

/// What is said while a scenario is read and looked at.
pub(crate) const LOOKING: &str = "still checking: predictions, or many joints or agents, take a while";
