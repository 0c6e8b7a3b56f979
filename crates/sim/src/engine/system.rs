//! What is integrated: a right-hand side that knows the past only through what is heard.

use super::delayed_inputs::Heard;

/// A right-hand side that knows the past only through what is heard.
pub(crate) trait DelaySystem {
    /// dx = f(t, x, heard). Time enters through what acts from outside only.
    fn rates(&mut self, t_s: f64, x: &[f64], heard: &Heard, dx: &mut [f64]);

    /// Brings a state that a step has just reached back to its manifold; changes it by less than the step's error.
    fn settle(&mut self, x: &mut [f64]) {
        let _ = x;
    }

    /// When something happens next that the network does not know of, s: a push begins, a controller samples.
    fn next_event_s(&self) -> f64 {
        f64::INFINITY
    }

    /// Lets everything happen that is due until `until_s`, a rounding error after the instant at hand; may change `x`. `heard` is what is
    /// heard then, over the links that are in force from now on, and `network` what the network did; the answer is what else happened.
    fn happen(&mut self, until_s: f64, x: &mut [f64], heard: &Heard, network: EventOutcome) -> EventOutcome {
        let _ = (until_s, x, heard, network);
        EventOutcome::Nothing
    }
}

/// What an event did to the right-hand side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum EventOutcome {
    /// It goes on as before.
    Nothing,
    /// Held inputs changed. What follows is as smooth as what was before, so steps stay as long as they were.
    Sampled,
    /// It jumped: fast transients may start, and what is sent has a kink.
    Jumped,
}

/// An accepted step. Its interior can be read until the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// Start, s.
    pub(crate) start_s: f64,
    /// End, s.
    pub(crate) end_s: f64,
}
