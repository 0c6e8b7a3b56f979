//! `[network]` → [`Network`].

use std::collections::HashMap;
use std::fmt;
use std::ops::Range;

use forwardstep_sim::Network;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Constant, Delay};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::quantity::QuantityError;
use forwardstep_sim::schedule::Schedule;

use super::at::At;
use super::de::ValueDe;
use super::document::{Document, Tables};
use super::fault::{Fault, fault, filled};
use super::inputs::InputFolder;
use super::kinds::Kinds;
use super::kinds::delays::DelayPlan;
use super::kinds::schedules::ScheduleKind;
use super::kinds::schedules::repeat::RepeatFile;
use super::links::Links;
use super::network_file::{CouplingFile, DelayFile, NetworkFile, PhaseFile};
use super::network_problem::NetworkProblem;
use super::notice::Notice;
use super::value_problem::ValueProblem;
use crate::SourceText;

/// Builds the network of the vertices `names`, of which the first `agents` hear others; `folder` is where tables are looked
/// for.
pub(super) fn network(
    file: &NetworkFile,
    (document, kinds): (&Document<'_>, &Kinds),
    (names, agents): (&[String], usize),
    end_s: f64,
    source: &SourceText,
    folder: &mut InputFolder,
    notices: &mut Vec<Notice>,
) -> Result<Network, Fault> {
    let mut reader = NetworkReader {
        names,
        agents,
        index: names.iter().enumerate().map(|(k, name)| (name.as_str(), k)).collect(),
        weight: Weight::Constant(1.0),
        default_delay: DelayPlan::Shared(Delay::constant(0.0)),
        delays: Vec::new(),
        constants: HashMap::new(),
        weights: Vec::new(),
        links: Links::default(),
        tables: document.network_tables(),
        kinds,
        edges_so_far: 0,
        end_s,
        source,
        folder,
    };
    if let Some(weight) = &file.weight {
        reader.weight = reader.weight(weight)?;
    }
    if let Some(delay) = &file.delay {
        reader.default_delay = reader.plan(delay)?;
    }
    reader.link_delays(&file.link_delays)?;
    let schedule = match (&file.edges, &file.phases) {
        (Some(_), Some(phases)) => return Err(fault(phases, NetworkProblem::EdgesAndPhases)),
        (None, None) => return Err(Fault::new(NetworkProblem::NoGraph)),
        (Some(edges), None) => match &file.switching {
            Some(switching) => return Err(fault(switching, NetworkProblem::NothingToSwitch)),
            None => Schedule::fixed(reader.edges(edges)?),
        },
        (None, Some(phases)) => {
            let switching = document.switching(kinds)?;
            let schedule = reader.schedule(phases, switching.as_deref().unwrap_or(&RepeatFile), notices)?;
            document.checked(schedule.check(end_s))?;
            schedule
        }
    };
    reader.link_notices(notices);
    let coupling = file.coupling.as_ref().map_or(Coupling::Linear, coupling);
    Ok(Network { agents: names.len(), schedule, delays: reader.delays, weights: reader.weights, coupling })
}

fn coupling(file: &At<CouplingFile>) -> Coupling {
    match &file.value {
        CouplingFile::Saturated(limit) => Coupling::Saturated { limit: limit.value },
        CouplingFile::Tanh(scale) => Coupling::Tanh { scale: scale.value },
        CouplingFile::Rational(scale) => Coupling::Rational { scale: scale.value },
    }
}

/// What is known while a network is read.
pub struct NetworkReader<'a> {
    pub(super) names: &'a [String],
    /// How many of them are agents; a leader comes after them.
    pub(super) agents: usize,
    pub(super) index: HashMap<&'a str, usize>,
    /// The weight and the delay of edges that have none of their own.
    pub(super) weight: Weight,
    pub(super) default_delay: DelayPlan,
    /// All delays so far, and where constant ones are among them.
    pub(super) delays: Vec<Delay>,
    constants: HashMap<u64, usize>,
    /// The weights that follow a formula so far.
    pub(super) weights: Vec<BoundedFormula>,
    /// What single edges have of their own so far.
    pub(super) links: Links,
    /// The tables of kinds, as they are written.
    tables: Tables<'a, 'a>,
    kinds: &'a Kinds,
    /// Edges by rule and from tables so far.
    pub(super) edges_so_far: u64,
    pub(super) end_s: f64,
    pub(super) source: &'a SourceText,
    pub(super) folder: &'a mut InputFolder,
}

impl fmt::Debug for NetworkReader<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("NetworkReader").field("names", &self.names).field("end_s", &self.end_s).finish_non_exhaustive()
    }
}

impl NetworkReader<'_> {
    fn schedule(
        &mut self,
        phases: &At<Vec<At<PhaseFile>>>,
        switching: &dyn ScheduleKind,
        notices: &mut Vec<Notice>,
    ) -> Result<Schedule, Fault> {
        let list = filled("phases", phases)?;
        let graphs = list.iter().map(|phase| self.edges(&phase.value.edges)).collect::<Result<_, _>>()?;
        switching.schedule(graphs, &mut PhaseReader { network: self, phases, notices })
    }

    /// The end of the run, s.
    pub fn end_s(&self) -> f64 {
        self.end_s
    }

    /// The files that the scenario names.
    pub fn folder(&mut self) -> &mut InputFolder {
        self.folder
    }

    /// Equal delays share an entry, so that a message to several receivers is looked up once.
    pub(super) fn delay_index(&mut self, delay: Delay) -> usize {
        let next = self.delays.len();
        let index = match delay.downcast() {
            // A table may give every edge another.
            Some(Constant { s }) => *self.constants.entry((s + 0.0).to_bits()).or_insert(next),
            None => self.delays.iter().position(|known| *known == delay).unwrap_or(next),
        };
        if index == next {
            self.delays.push(delay);
        }
        index
    }

    /// What a delay says, with everything checked that does not depend on the edge.
    pub(super) fn plan(&mut self, delay: &At<DelayFile>) -> Result<DelayPlan, Fault> {
        let table = match delay.value {
            DelayFile::Constant(s) => {
                let constant = Delay::constant(s);
                // A table calls it by its column.
                let column = |error| QuantityError { path: "delay_s".into(), ..error };
                constant.check(self.end_s).map_err(|error| Fault::from(column(error)).at(&delay.span))?;
                return Ok(DelayPlan::Shared(constant));
            }
            DelayFile::Kind(node) => self.tables.get(&node).copied(),
        };
        let Some(value) = table else { return Err(fault(delay, ValueProblem::MissingKey { key: "delay" })) };
        let (_, kind) = self.kinds.delay(ValueDe { value, kinds: self.kinds })?;
        let end_s = self.end_s;
        let checked = |plan: DelayPlan| match &plan {
            DelayPlan::Shared(delay) => Ok(delay.check(end_s).map(|()| plan)?),
            DelayPlan::EachLink(_) => Ok(plan),
        };
        kind.plan(self).and_then(checked).map_err(|fault| fault.inside(value).at(&delay.span))
    }
}

/// The phases of a network that switches, for the kind of switching that takes them.
#[derive(Debug)]
pub struct PhaseReader<'a, 'n> {
    network: &'a mut NetworkReader<'n>,
    phases: &'a At<Vec<At<PhaseFile>>>,
    notices: &'a mut Vec<Notice>,
}

impl<'n> PhaseReader<'_, 'n> {
    /// The network that they are part of.
    pub fn network(&mut self) -> &mut NetworkReader<'n> {
        self.network
    }

    /// How many there are; never none.
    pub fn count(&self) -> usize {
        self.phases.value.len()
    }

    /// Where they stand.
    pub fn span(&self) -> &Range<usize> {
        &self.phases.span
    }

    /// How long a phase, counted from zero, lasts.
    ///
    /// # Errors
    /// That the phase does not say so.
    pub fn dwell_s(&self, phase: usize) -> Result<f64, Fault> {
        let missing = || Fault::new(NetworkProblem::NoDwell { phase: phase + 1 }).at(&self.phases.span);
        let place = self.phases.value.get(phase).ok_or_else(missing)?;
        match &place.value.dwell_s {
            Some(dwell) => Ok(dwell.value),
            None => Err(fault(place, NetworkProblem::NoDwell { phase: phase + 1 })),
        }
    }

    /// Tells the author of the file that how long this phase lasts is not used, if it says so.
    pub fn unused_dwell(&mut self, phase: usize) {
        let dwell = self.phases.value.get(phase).and_then(|phase| phase.value.dwell_s.as_ref());
        if let Some(dwell) = dwell {
            let (line, _) = self.network.source.line_column(dwell.span.start);
            self.notices.push(Notice::UnusedDwell { line });
        }
    }
}
