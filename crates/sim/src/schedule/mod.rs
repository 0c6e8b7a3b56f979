//! Which graph is in force when: graphs, and a switching signal that takes one after the other.
//!
//! A signal from outside comes through the same trait as those of forwardstep. It is judged up to the end of the run, and
//! what its author says of it is probed ([`Schedule::probe`]).
//!
//! ```
//! use forwardstep_sim::schedule::{KnownSwitching, Schedule, Segment, Segments, SwitchingSignal};
//! use forwardstep_sim::quantity::QuantityError;
//!
//! /// Takes the graphs in turn, for 1 s, 2 s, 3 s, ….
//! #[derive(Debug, PartialEq)]
//! struct Slower;
//!
//! impl SwitchingSignal for Slower {
//!     fn words(&self) -> &'static str {
//!         "slower and slower"
//!     }
//!     fn validate(&self, _: usize, _: f64) -> Result<(), QuantityError> {
//!         Ok(())
//!     }
//!     fn segments(&self, graphs: usize) -> Segments<'_> {
//!         let start_s = |k: usize| 0.5 * (k * (k + 1)) as f64;
//!         let segment = move |k| Segment { start_s: start_s(k), end_s: start_s(k + 1), graph: k % graphs };
//!         Segments::new((0..).map(segment))
//!     }
//!     fn known(&self) -> KnownSwitching {
//!         KnownSwitching::declared(1.0)
//!     }
//! }
//!
//! let schedule = Schedule::new(vec![vec![], vec![]], Slower);
//! assert_eq!(schedule.probe(100.0), Ok(()));
//! assert_eq!(schedule.segments().nth(2).map(|segment| (segment.start_s, segment.graph)), Some((3.0, 0)));
//! ```

mod logged;
mod once;
mod periodic;
mod probe;
mod random;
mod union;
mod window;

use std::any::{Any, TypeId};
use std::fmt;
use std::sync::Arc;

use crate::graph::Edge;
use crate::quantity::{Path, QuantityError, as_many, positive};
use crate::same::Same;

pub use logged::Logged;
pub use once::Once;
pub use periodic::Periodic;
pub use probe::ScheduleFault;
pub use random::RandomSwitching;
pub use window::Window;

/// The signals that come with forwardstep. What any other says of itself is declared by its author.
fn is_shipped(signal: TypeId) -> bool {
    [TypeId::of::<Once>(), TypeId::of::<Periodic>(), TypeId::of::<RandomSwitching>(), TypeId::of::<Logged>()]
        .contains(&signal)
}

/// Which of some graphs is in force when, the same whenever it is asked.
pub trait SwitchingSignal: Same + fmt::Debug + Send + Sync {
    /// What it is called in messages, as in `random switching`.
    fn words(&self) -> &'static str;

    /// Checks the parameters beside so many graphs for a run of `end_s`, under the keys that they have in `network` of a
    /// scenario file.
    ///
    /// # Errors
    /// [`QuantityError`] for the first that makes no sense.
    fn validate(&self, graphs: usize, end_s: f64) -> Result<(), QuantityError>;

    /// The stretches of time in order, from t = 0, with `graphs` graphs; endless unless the last graph stays for ever.
    fn segments(&self, graphs: usize) -> Segments<'_>;

    /// What is known of it.
    fn known(&self) -> KnownSwitching;
}

/// A graph that stays in force for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Its edges; at most one from any agent to any other.
    pub edges: Vec<Edge>,
    /// How long it lasts, s. Ignored for the last phase of [`Schedule::once`].
    pub dwell_s: f64,
}

/// One stretch of time with one graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// From here on, s.
    pub start_s: f64,
    /// Until here, s; infinite when the graph stays for ever.
    pub end_s: f64,
    /// Index of the graph, see [`Schedule::graphs`].
    pub graph: usize,
}

/// What is known of a switching signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownSwitching {
    /// How many of its segments tell all of them.
    pub extent: Extent,
    /// How short a segment can be, but for one that has no end.
    pub dwell: Dwell,
}

impl KnownSwitching {
    /// What the author of a signal answers for: no graph is in force for less than `least_dwell_s`.
    pub fn declared(least_dwell_s: f64) -> Self {
        KnownSwitching { extent: Extent::Horizon, dwell: Dwell::Declared(least_dwell_s) }
    }
}

/// How many segments of a switching signal tell all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// They end with one that stays for ever.
    Whole,
    /// So many, again and again.
    Period(usize),
    /// Each is drawn among all graphs; those of a run tell nothing about later ones.
    Drawn,
    /// Those of a run tell nothing about later ones.
    Horizon,
}

/// How short a segment can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dwell {
    /// It never switches.
    NeverSwitches,
    /// The shortest lasts so long, s.
    Shortest(f64),
    /// Segments are drawn, and last at least so long, s.
    Drawn(f64),
    /// Its author says that they last at least so long, s.
    Declared(f64),
}

/// Graphs and a switching signal.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// The graphs.
    pub graphs: Vec<Vec<Edge>>,
    signal: Arc<dyn SwitchingSignal>,
    known: KnownSwitching,
}

impl Schedule {
    /// `graphs` as `signal` takes them.
    pub fn new<S: SwitchingSignal>(graphs: Vec<Vec<Edge>>, signal: S) -> Schedule {
        let mut known = signal.known();
        if !is_shipped(TypeId::of::<S>()) {
            let least_s = match known.dwell {
                Dwell::Shortest(least_s) | Dwell::Drawn(least_s) | Dwell::Declared(least_s) => least_s,
                Dwell::NeverSwitches => f64::INFINITY,
            };
            known = KnownSwitching::declared(least_s);
        }
        Schedule { graphs, signal: Arc::new(signal), known }
    }

    /// The signal as an `S`, if it is one.
    pub fn downcast<S: SwitchingSignal>(&self) -> Option<&S> {
        (&*self.signal as &dyn Any).downcast_ref()
    }

    /// What the signal is called in messages.
    pub fn words(&self) -> &'static str {
        self.signal.words()
    }

    /// Checks the parameters of the signal for a run of `end_s`.
    ///
    /// # Errors
    /// [`QuantityError`] for the first that makes no sense.
    pub fn check(&self, end_s: f64) -> Result<(), QuantityError> {
        self.signal.validate(self.graphs.len(), end_s).map_err(|error| error.under("network"))
    }

    /// What is known of the signal.
    pub fn known(&self) -> KnownSwitching {
        self.known
    }

    /// The edges of one graph; empty for an index that does not exist.
    pub fn graph(&self, index: usize) -> &[Edge] {
        self.graphs.get(index).map_or(&[], |graph| graph)
    }

    /// The one graph that is in force for ever: the only one, or any of several that have the same edges with the same weights
    /// and delays, in whatever order.
    pub fn constant_graph(&self) -> Option<&[Edge]> {
        let (first, others) = self.graphs.split_first()?;
        let sorted = |graph: &[Edge]| {
            let mut edges = graph.to_vec();
            edges.sort_by_key(|edge| (edge.to, edge.from));
            edges
        };
        let (as_long, expected) = (|graph: &Vec<Edge>| graph.len() == first.len(), sorted(first));
        let same = |graph: &Vec<Edge>| as_long(graph) && (graph == first || sorted(graph) == expected);
        others.iter().all(same).then_some(first)
    }

    /// The graphs that may be in force at arbitrarily late times: of a schedule that ends, the one that stays.
    pub fn recurring_graphs(&self) -> &[Vec<Edge>] {
        match self.known().extent {
            Extent::Whole => &self.graphs[self.graphs.len().saturating_sub(1)..],
            Extent::Period(_) | Extent::Drawn | Extent::Horizon => &self.graphs,
        }
    }

    /// From when on the last graph stays, s, if it has no edge of this kind: what such edges do later does not count.
    pub fn gone_s(&self, is_it: impl Fn(&Edge) -> bool) -> Option<f64> {
        let ends = self.known.extent == Extent::Whole;
        let stays = || self.recurring_graphs().iter().flatten().any(is_it);
        if ends && !stays() { self.segments().last().map(|last| last.start_s) } else { None }
    }

    /// The stretches of time in order, from t = 0; endless unless the last graph stays for ever.
    pub fn segments(&self) -> Segments<'_> {
        self.signal.segments(self.graphs.len())
    }
}

impl PartialEq for Schedule {
    /// Whether both have the same graphs and the same signal.
    fn eq(&self, other: &Self) -> bool {
        self.graphs == other.graphs && self.signal.same(&*other.signal)
    }
}

/// The graphs and the dwell times of phases.
fn split(phases: Vec<Phase>) -> (Vec<Vec<Edge>>, Vec<f64>) {
    phases.into_iter().map(|phase| (phase.edges, phase.dwell_s)).unzip()
}

/// There must be `need` dwell times, all of them positive.
fn check_dwell(dwell_s: &[f64], need: usize) -> Result<(), QuantityError> {
    as_many("phases", "dwell_s", dwell_s, ("the list of graphs that end", need))?;
    let at = |phase| Path::from("phases").index(phase);
    dwell_s.iter().enumerate().try_for_each(|(phase, dwell_s)| positive(at(phase), "dwell_s", *dwell_s))
}

/// Iterator over the stretches of a schedule.
pub struct Segments<'a>(Box<dyn Iterator<Item = Segment> + 'a>);

impl<'a> Segments<'a> {
    /// The stretches in this order.
    pub fn new(segments: impl Iterator<Item = Segment> + 'a) -> Self {
        Segments(Box::new(segments))
    }
}

impl fmt::Debug for Segments<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Segments")
    }
}

impl Iterator for Segments<'_> {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        self.0.next()
    }
}

#[cfg(test)]
mod tests;
