//! What a switching signal from outside says of itself, put to the test.

use thiserror::Error;

use super::window::MOST_SEGMENTS;
use super::{Dwell, Schedule};

/// Why a switching signal is not what its author says.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ScheduleFault {
    /// A segment that does not begin where the one before it ends; the first begins at zero.
    #[error("a segment begins at {start_s} s, but the one before it ends at {before_s} s")]
    Gap {
        /// Where it begins, s.
        start_s: f64,
        /// Where it should begin, s.
        before_s: f64,
    },
    /// A segment that is shorter than is declared.
    #[error("a graph is in force from {start_s} s to {end_s} s only, but is declared to stay for {least_s} s at least")]
    Short {
        /// Where it begins, s.
        start_s: f64,
        /// Where it ends, s.
        end_s: f64,
        /// How long it should last, s.
        least_s: f64,
    },
    /// A segment with a graph that does not exist.
    #[error("graph {graph} is in force at t = {t_s} s, but there are {graphs}")]
    NoSuchGraph {
        /// When, s.
        t_s: f64,
        /// Its index.
        graph: usize,
        /// How many graphs there are.
        graphs: usize,
    },
    /// No graph is in force.
    #[error("no graph is in force from {t_s} s on")]
    Ends {
        /// From then on, s.
        t_s: f64,
    },
    /// Too many segments for any run.
    #[error("it has more than {most} segments until {t_s} s; each ends a step")]
    TooMany {
        /// How many are accepted.
        most: usize,
        /// Where the last of these ends, s.
        t_s: f64,
    },
}

impl Schedule {
    /// Looks at every segment until `end_s` for what refutes the author of the signal. What forwardstep brings has been shown
    /// in other ways.
    ///
    /// # Errors
    /// The first [`ScheduleFault`] in time.
    pub fn probe(&self, end_s: f64) -> Result<(), ScheduleFault> {
        let Dwell::Declared(least_s) = self.known().dwell else { return Ok(()) };
        let mut before_s = 0.0;
        for segment in self.segments().take(MOST_SEGMENTS) {
            let (start_s, next_s) = (segment.start_s, segment.end_s);
            if start_s != before_s {
                return Err(ScheduleFault::Gap { start_s, before_s });
            }
            if segment.graph >= self.graphs.len() {
                return Err(ScheduleFault::NoSuchGraph {
                    t_s: start_s,
                    graph: segment.graph,
                    graphs: self.graphs.len(),
                });
            }
            // A length is the difference of two rounded times.
            let lasts = next_s > start_s && next_s - start_s >= least_s - 1e-9 * next_s.abs();
            if !lasts && next_s != f64::INFINITY {
                return Err(ScheduleFault::Short { start_s, end_s: next_s, least_s });
            }
            if next_s >= end_s {
                return Ok(());
            }
            before_s = next_s;
        }
        let ended = self.segments().nth(MOST_SEGMENTS - 1).is_none();
        Err(if ended {
            ScheduleFault::Ends { t_s: before_s }
        } else {
            ScheduleFault::TooMany { most: MOST_SEGMENTS, t_s: before_s }
        })
    }
}
