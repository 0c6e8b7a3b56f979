//! The columns of a leader that is no agent: its motion and its velocity, which are no results but stand beside those that follow.

use forwardstep_sim::recording::Signal;
use forwardstep_sim::setup::Setup;
use forwardstep_sim::trajectory::Path;

use super::names;

/// One column: an axis of the leader's motion, or of its velocity.
pub(crate) struct LeaderColumn<'a> {
    pub(crate) name: String,
    pub(crate) unit: String,
    path: &'a Path,
    derivative: usize,
}

impl<'a> LeaderColumn<'a> {
    /// All of them; none where no motion leads.
    pub(crate) fn all(setup: &'a Setup) -> Vec<LeaderColumn<'a>> {
        let Some(leader) = setup.following().and_then(|following| following.motion()) else { return Vec::new() };
        let mut columns = Vec::new();
        for (derivative, signal) in [Signal::Position, Signal::Velocity].into_iter().enumerate() {
            for (axis, path) in leader.trajectory.paths().iter().enumerate() {
                // It moves in the coordinates of those that follow.
                let (own, unit) = (names::axis_name(setup, 0, axis), names::unit(setup, 0, signal, axis));
                let name = format!("{}.{}.{own}", leader.name, signal.name());
                columns.push(LeaderColumn { name, unit, path, derivative });
            }
        }
        columns
    }

    /// Its value at a time.
    pub(crate) fn at(&self, t_s: f64) -> f64 {
        self.path.jet(t_s)[self.derivative]
    }
}
