//! A trajectory by pieces: between its kinks it is smooth, and at a kink it has derivatives on either side.
//!
//! A step of the integrator never sees both sides: it ends at the kink, and evaluates until then by the piece before and from
//! then on by the piece after.

use forwardstep_core::controller::JetsBuffer;
use forwardstep_core::expression::Switch;

use super::{Path, Trajectory, TrajectoryError};

/// A trajectory with its kinks until the end of a run, and the piece in force.
#[derive(Clone, Debug)]
pub(crate) struct Pieces {
    trajectory: Trajectory,
    /// Those of every axis.
    switches: Vec<Vec<Switch>>,
    /// When the piece in force has begun, s.
    since_s: f64,
}

impl Pieces {
    /// Of `trajectory`, from 0 to `end_s`; the first is in force.
    pub(crate) fn new(trajectory: Trajectory, end_s: f64) -> Result<Self, TrajectoryError> {
        let found = |(axis, path): (usize, &Path)| match path {
            Path::Formula(formula) => {
                formula.switches(0.0, end_s).map_err(|error| TrajectoryError::Kinks { axis, error })
            }
            Path::Sinusoids { .. } | Path::Spline(_) => Ok(Vec::new()),
        };
        let switches = trajectory.paths().iter().enumerate().map(found).collect::<Result<_, _>>()?;
        Ok(Pieces { trajectory, switches, since_s: 0.0 })
    }

    /// The whole, without its pieces.
    pub(crate) fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// m.
    pub(crate) fn axes(&self) -> usize {
        self.trajectory.axes()
    }

    /// Value and derivatives of every axis by the piece in force, as far as `out` has room for them.
    pub(crate) fn jets(&self, t_s: f64, out: &mut JetsBuffer) {
        let paths = self.trajectory.paths().iter().zip(&self.switches);
        for (jet, (path, switches)) in out.iter_mut().zip(paths) {
            match path {
                Path::Formula(formula) if !switches.is_empty() => {
                    formula.derivatives_on(switches, self.since_s, t_s, jet);
                }
                smooth => smooth.derivatives(t_s, jet),
            }
        }
    }

    fn kinks_s(&self) -> impl Iterator<Item = f64> {
        self.switches.iter().flatten().flat_map(|switch| switch.at().iter().copied())
    }

    /// The first time after `after_s` at which a derivative may jump that is used: a kink of a formula, or where a table
    /// begins or ends. Infinite when there is none.
    pub(crate) fn next_kink_s(&self, after_s: f64) -> f64 {
        let ends_s = self.trajectory.paths().iter().filter_map(|path| match path {
            Path::Spline(spline) => Some(spline.ends_s()),
            Path::Formula(_) | Path::Sinusoids { .. } => None,
        });
        let kinks_s = ends_s.flatten().chain(self.kinks_s());
        kinks_s.filter(|kink_s| *kink_s > after_s).fold(f64::INFINITY, f64::min)
    }

    /// When, until `until_s` and after the piece in force has begun, the first derivative last jumps: at a kink of a formula.
    pub(crate) fn next_jump_s(&self, until_s: f64) -> Option<f64> {
        self.kinks_s().filter(|kink_s| *kink_s > self.since_s && *kink_s <= until_s).reduce(f64::max)
    }

    /// Goes on to the piece that is in force right after `until_s`.
    pub(crate) fn pass(&mut self, until_s: f64) {
        self.since_s = until_s;
    }
}
