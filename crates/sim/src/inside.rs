//! What sampled agents do between samples, at the nodes of a quadrature in every step.

use crate::closed_loop::{ClosedLoop, Energy};
use crate::engine::{Integrator, Step};
use crate::recording::SampleTaken;

/// Nodes and weights of the rule of Gauss and Legendre on [0, 1] that is exact for polynomials of degree five.
const NODES: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Where in a step an instant is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At its start, just after a sample; steps that begin without one do not show it.
    Start,
    /// A node of the quadrature, with its weight in an integral over time.
    Node {
        /// The weight, s.
        weight_s: f64,
    },
    /// At its end, before the event there if there is one.
    End,
}

/// One agent at one instant of a step.
#[derive(Clone, Copy, Debug)]
pub struct Inside<'a> {
    /// Index of the agent.
    pub agent: usize,
    /// The instant, s.
    pub t_s: f64,
    /// Where it is.
    pub place: Place,
    /// Its signals, as [`crate::recorded_columns`] lists them.
    pub values: &'a [f64],
    /// V and what changes it, of an agent that is by itself: all but the robots under (6)–(7) of a network.
    pub energy: Option<Energy>,
    /// What dry friction takes from its joints, which is in `values` as a part of what acts from outside; empty where none is set.
    pub rubs: &'a [f64],
}

/// Who looks at a run under digital control from inside.
pub trait Watch {
    /// An agent has taken a sample, and no step has been looked at since.
    fn sampled(&mut self, taken: SampleTaken<'_>);

    /// A step was made; its instants come in the order of time, all agents at each.
    fn inside(&mut self, at: Inside<'_>);
}

/// Shows `step`, the last that was made, to `watch`, after the sample at its start if there was one; `samples` were shown before.
pub(crate) fn show(
    integrator: &mut Integrator<'_>,
    closed_loop: &mut ClosedLoop<'_>,
    step: Step,
    samples: &mut u64,
    watch: &mut dyn Watch,
) {
    let Some(taken) = closed_loop.samples() else { return };
    let sampled = taken > *samples;
    if sampled {
        *samples = taken;
        closed_loop.last_samples(&mut |taken| watch.sampled(taken));
    }
    let length_s = step.end_s - step.start_s;
    let mut energies = Vec::new();
    // Dry friction is held over a step.
    let rubs = closed_loop.rubs();
    let mut look = |t_s: f64, place: Place| {
        let (x, heard) = integrator.look_inside(t_s);
        energies.clear();
        closed_loop.energies(t_s, x, heard, &mut |agent, energy| energies.push((agent, energy)));
        closed_loop.record(t_s, x, heard, |agent, values| {
            let energy = energies.iter().find(|(of, _)| *of == agent).map(|(_, energy)| *energy);
            let rubs = rubs.iter().find(|(of, _)| *of == agent).map_or(&[][..], |(_, rubs)| rubs);
            watch.inside(Inside { agent, t_s, place, values, energy, rubs });
        });
    };
    if sampled {
        look(step.start_s, Place::Start);
    }
    for (node, weight) in NODES {
        look(step.start_s + node * length_s, Place::Node { weight_s: weight * length_s });
    }
    look(step.end_s, Place::End);
}
