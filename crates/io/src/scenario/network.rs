//! `[network]` → [`Network`].

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::ops::Range;

use forwardstep_sim::Network;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::quantity::{MOST_EVENTS, few};
use forwardstep_sim::schedule::{Phase, Schedule};

use super::at::At;
use super::fault::{Fault, fault, filled, not_negative, positive, seed, values};
use super::inputs::InputFolder;
use super::links::{self, DelayPlan, Links};
use super::network_file::{CouplingFile, DelayFile, NetworkFile, PhaseFile, SwitchingFile};
use super::network_problem::NetworkProblem;
use super::notice::Notice;
use super::value_problem::ValueProblem;
use crate::SourceText;

/// Builds the network of the vertices `names`, of which the first `agents` hear others; `folder` is where tables are looked
/// for.
pub(super) fn network(
    file: &NetworkFile,
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
        default_delay: DelayPlan::Shared(Delay::Constant { s: 0.0 }),
        delays: Vec::new(),
        constants: HashMap::new(),
        weights: Vec::new(),
        links: Links::default(),
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
    let schedule = match (&file.edges, &file.phases) {
        (Some(_), Some(phases)) => return Err(fault(phases, NetworkProblem::EdgesAndPhases)),
        (None, None) => return Err(Fault::new(NetworkProblem::NoGraph)),
        (Some(edges), None) => match &file.switching {
            Some(switching) => return Err(fault(switching, NetworkProblem::NothingToSwitch)),
            None => Schedule::Fixed(reader.edges(edges)?),
        },
        (None, Some(phases)) => reader.schedule(phases, file.switching.as_ref(), notices)?,
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
pub(super) struct NetworkReader<'a> {
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
    /// Edges by rule and from tables so far.
    pub(super) edges_so_far: u64,
    pub(super) end_s: f64,
    pub(super) source: &'a SourceText,
    pub(super) folder: &'a mut InputFolder,
}

impl NetworkReader<'_> {
    fn schedule(
        &mut self,
        phases: &At<Vec<At<PhaseFile>>>,
        switching: Option<&At<SwitchingFile>>,
        notices: &mut Vec<Notice>,
    ) -> Result<Schedule, Fault> {
        let list = filled("phases", phases)?;
        let switching = switching.map_or(&SwitchingFile::Repeat, |switching| &switching.value);
        let mut unused = |phase: &At<PhaseFile>| {
            if let Some(dwell) = &phase.value.dwell_s {
                let (line, _) = self.source.line_column(dwell.span.start);
                notices.push(Notice::UnusedDwell { line });
            }
        };
        if let SwitchingFile::Random(random) = switching {
            list.iter().for_each(&mut unused);
            let [low, high] = &random.dwell_s.value;
            let dwell_s = [positive("dwell_s", low)?, positive("dwell_s", high)?];
            if dwell_s[0] > dwell_s[1] {
                let problem = ValueProblem::Interval { key: "dwell_s", low: dwell_s[0], high: dwell_s[1] };
                return Err(fault(&random.dwell_s, problem));
            }
            self.few("switches", 2.0 * self.end_s / (dwell_s[0] + dwell_s[1]), &random.dwell_s.span)?;
            let graphs = list.iter().map(|phase| self.edges(&phase.value.edges)).collect::<Result<_, _>>()?;
            return Ok(Schedule::Random { graphs, dwell_s, seed: seed(&random.seed)? });
        }
        let once = matches!(switching, SwitchingFile::Once);
        if let (true, Some(last)) = (once, list.last()) {
            unused(last);
        }
        let mut read = Vec::with_capacity(list.len());
        for (k, phase) in list.iter().enumerate() {
            let dwell_s = match &phase.value.dwell_s {
                Some(dwell) => positive("dwell_s", dwell)?,
                // It stays for ever; the number is not used.
                None if once && k + 1 == list.len() => self.end_s,
                None => return Err(fault(phase, NetworkProblem::NoDwell { phase: k + 1 })),
            };
            read.push(Phase { edges: self.edges(&phase.value.edges)?, dwell_s });
        }
        if once {
            return Ok(Schedule::Once(read));
        }
        let round_s: f64 = read.iter().map(|phase| phase.dwell_s).sum();
        self.few("switches", self.end_s / round_s * read.len() as f64, &phases.span)?;
        Ok(Schedule::Periodic(read))
    }

    /// Refuses events that no run could land on.
    fn few(&self, what: &'static str, events: f64, span: &Range<usize>) -> Result<(), Fault> {
        few("", what, events, (what, events, MOST_EVENTS))
            .map_err(|error| Fault::new(ValueProblem::Quantity(error)).at(span))
    }

    /// Equal delays share an entry, so that a message to several receivers is looked up once.
    pub(super) fn delay_index(&mut self, delay: Delay) -> usize {
        let next = self.delays.len();
        let index = match &delay {
            // A table may give every edge another.
            Delay::Constant { s } => *self.constants.entry((s + 0.0).to_bits()).or_insert(next),
            _ => self.delays.iter().position(|known| *known == delay).unwrap_or(next),
        };
        if index == next {
            self.delays.push(delay);
        }
        index
    }

    /// A delay that no other edge has.
    pub(super) fn new_delay(&mut self, delay: Delay) -> usize {
        self.delays.push(delay);
        self.delays.len() - 1
    }

    /// What a delay says, with everything checked that does not depend on the edge.
    pub(super) fn plan(&mut self, delay: &At<DelayFile>) -> Result<DelayPlan, Fault> {
        let shared = match &delay.value {
            DelayFile::RandomHold(file) => return links::random_hold(file),
            DelayFile::Packets(file) => return links::packets(file),
            DelayFile::Log(file) => return self.log(file),
            DelayFile::FormulaS(text) => self.formula_delay(text)?,
            DelayFile::ConstantS(s) => Delay::Constant { s: not_negative("constant_s", s)? },
            DelayFile::Sinusoid(file) => {
                let mean_s = not_negative("mean_s", &file.mean_s)?;
                let amplitude_s = not_negative("amplitude_s", &file.amplitude_s)?;
                if amplitude_s > mean_s {
                    return Err(fault(&file.amplitude_s, NetworkProblem::Amplitude { amplitude_s, mean_s }));
                }
                let period_s = positive("period_s", &file.period_s)?;
                self.few("swings of the delay", self.end_s / period_s, &file.period_s.span)?;
                Delay::Sinusoid { mean_s, amplitude_s, period_s, phase_rad: file.phase_rad.rem_euclid(TAU) }
            }
            DelayFile::PiecewiseConstant(file) => {
                let times_s = filled("times_s", &file.times_s)?;
                if let Some(first) = times_s.first()
                    && first.value != 0.0
                {
                    return Err(fault(first, NetworkProblem::TimesBegin { first_s: first.value }));
                }
                for pair in times_s.windows(2) {
                    let (before_s, after_s) = (pair[0].value, pair[1].value);
                    if before_s >= after_s {
                        return Err(fault(&pair[1], NetworkProblem::TimesRise { before_s, after_s }));
                    }
                }
                let (times, number) = (times_s.len(), file.values_s.value.len());
                if times != number {
                    return Err(fault(&file.values_s, NetworkProblem::TimesAndValues { times, values: number }));
                }
                for value in &file.values_s.value {
                    not_negative("values_s", value)?;
                }
                let period_s = file.period_s.as_ref().map(|period| positive("period_s", period)).transpose()?;
                if let (Some(place), Some(period_s), Some(last)) = (&file.period_s, period_s, times_s.last()) {
                    if period_s <= last.value {
                        let problem = NetworkProblem::PeriodTooShort { period_s, last_s: last.value };
                        return Err(fault(place, problem));
                    }
                    self.few("jumps of the delay", self.end_s / period_s * times as f64, &place.span)?;
                }
                let (times_s, values_s) = (values(times_s), values(&file.values_s.value));
                Delay::PiecewiseConstant { times_s, values_s, period_s }
            }
            DelayFile::SawTooth(file) => {
                let min_s = not_negative("min_s", &file.min_s)?;
                let max_s = not_negative("max_s", &file.max_s)?;
                if min_s > max_s {
                    return Err(fault(&file.min_s, NetworkProblem::SawTooth { min_s, max_s }));
                }
                let period_s = positive("period_s", &file.period_s)?;
                self.few("jumps of the delay", self.end_s / period_s, &file.period_s.span)?;
                // The same tooth, and no precision lost to a large offset.
                let offset_s = file.offset_s.rem_euclid(period_s);
                Delay::SawTooth { min_s, max_s, period_s, offset_s }
            }
        };
        Ok(DelayPlan::Shared(shared))
    }
}
