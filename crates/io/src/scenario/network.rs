//! `[network]` → [`Network`].

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::ops::Range;

use forwardstep_sim::Network;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::{Phase, Schedule};

use super::at::At;
use super::fault::{Fault, fault, filled, not_negative, positive, seed, values};
use super::network_file::{DelayFile, EdgeFile, NetworkFile, PhaseFile, SwitchingFile};
use super::notice::Notice;
use super::problem::ScenarioProblem;
use crate::SourceText;

/// Switches or jumps until the end of the run that are accepted; each ends a step.
const MOST_EVENTS: f64 = 1e7;

/// Builds the network of the agents `names`.
pub(super) fn network(
    file: &NetworkFile,
    names: &[String],
    end_s: f64,
    source: &SourceText,
    notices: &mut Vec<Notice>,
) -> Result<Network, Fault> {
    let mut reader = NetworkReader {
        names,
        index: names.iter().enumerate().map(|(k, name)| (name.as_str(), k)).collect(),
        weight: file.weight.as_ref().map_or(Ok(1.0), |weight| positive("weight", weight))?,
        default_delay: None,
        delays: Vec::new(),
        end_s,
        source,
    };
    let default = file.delay.as_ref().map_or(Ok(Delay::Constant { s: 0.0 }), |delay| reader.delay(delay))?;
    reader.default_delay = Some(default);
    let schedule = match (&file.edges, &file.phases) {
        (Some(_), Some(phases)) => return Err(fault(phases, ScenarioProblem::EdgesAndPhases)),
        (None, None) => return Err(Fault::new(ScenarioProblem::NoGraph)),
        (Some(edges), None) => match &file.switching {
            Some(switching) => return Err(fault(switching, ScenarioProblem::NothingToSwitch)),
            None => Schedule::Fixed(reader.edges(edges)?),
        },
        (None, Some(phases)) => reader.schedule(phases, file.switching.as_ref(), notices)?,
    };
    Ok(Network { agents: names.len(), schedule, delays: reader.delays })
}

struct NetworkReader<'a> {
    names: &'a [String],
    index: HashMap<&'a str, usize>,
    weight: f64,
    default_delay: Option<Delay>,
    delays: Vec<Delay>,
    end_s: f64,
    source: &'a SourceText,
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
                let problem = ScenarioProblem::Interval { key: "dwell_s", low: dwell_s[0], high: dwell_s[1] };
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
                None => return Err(fault(phase, ScenarioProblem::NoDwell { phase: k + 1 })),
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
        if events <= MOST_EVENTS {
            return Ok(());
        }
        Err(Fault::new(ScenarioProblem::TooManyEvents { what, events: events.round(), most: MOST_EVENTS }).at(span))
    }

    fn edges(&mut self, edges: &At<Vec<At<EdgeFile>>>) -> Result<Vec<Edge>, Fault> {
        let mut seen: HashMap<(usize, usize), usize> = HashMap::with_capacity(edges.value.len());
        let mut read = Vec::with_capacity(edges.value.len());
        for place in &edges.value {
            let EdgeFile { from, to, weight, delay } = &place.value;
            let (j, i) = (self.agent(from)?, self.agent(to)?);
            if i == j {
                return Err(fault(place, ScenarioProblem::SelfLoop { name: to.value.clone() }));
            }
            if let Some(start) = seen.insert((j, i), place.span.start) {
                let (first_line, _) = self.source.line_column(start);
                let (from, to) = (from.value.clone(), to.value.clone());
                return Err(fault(place, ScenarioProblem::EdgeTwice { from, to, first_line }));
            }
            let weight = weight.as_ref().map_or(Ok(self.weight), |weight| positive("weight", weight))?;
            let delay = match (delay, &self.default_delay) {
                (Some(delay), _) => self.delay(delay)?,
                (None, Some(delay)) => delay.clone(),
                (None, None) => Delay::Constant { s: 0.0 },
            };
            read.push(Edge { from: j, to: i, weight, delay: self.delay_index(delay) });
        }
        Ok(read)
    }

    fn agent(&self, name: &At<String>) -> Result<usize, Fault> {
        self.index.get(name.value.as_str()).copied().ok_or_else(|| {
            let problem = ScenarioProblem::NoSuchAgent { name: name.value.clone(), agents: self.names.to_vec() };
            fault(name, problem)
        })
    }

    /// Equal delays share an entry, so that a message to several receivers is looked up once.
    fn delay_index(&mut self, delay: Delay) -> usize {
        let known = self.delays.iter().position(|known| *known == delay);
        known.unwrap_or_else(|| {
            self.delays.push(delay);
            self.delays.len() - 1
        })
    }

    fn delay(&self, delay: &At<DelayFile>) -> Result<Delay, Fault> {
        match &delay.value {
            DelayFile::ConstantS(s) => Ok(Delay::Constant { s: not_negative("constant_s", s)? }),
            DelayFile::Sinusoid(file) => {
                let mean_s = not_negative("mean_s", &file.mean_s)?;
                let amplitude_s = not_negative("amplitude_s", &file.amplitude_s)?;
                if amplitude_s > mean_s {
                    return Err(fault(&file.amplitude_s, ScenarioProblem::Amplitude { amplitude_s, mean_s }));
                }
                let period_s = positive("period_s", &file.period_s)?;
                self.few("swings of the delay", self.end_s / period_s, &file.period_s.span)?;
                Ok(Delay::Sinusoid { mean_s, amplitude_s, period_s, phase_rad: file.phase_rad.rem_euclid(TAU) })
            }
            DelayFile::PiecewiseConstant(file) => {
                let times_s = filled("times_s", &file.times_s)?;
                if let Some(first) = times_s.first()
                    && first.value != 0.0
                {
                    return Err(fault(first, ScenarioProblem::TimesBegin { first_s: first.value }));
                }
                for pair in times_s.windows(2) {
                    let (before_s, after_s) = (pair[0].value, pair[1].value);
                    if before_s >= after_s {
                        return Err(fault(&pair[1], ScenarioProblem::TimesRise { before_s, after_s }));
                    }
                }
                let (times, number) = (times_s.len(), file.values_s.value.len());
                if times != number {
                    return Err(fault(&file.values_s, ScenarioProblem::TimesAndValues { times, values: number }));
                }
                for value in &file.values_s.value {
                    not_negative("values_s", value)?;
                }
                let period_s = file.period_s.as_ref().map(|period| positive("period_s", period)).transpose()?;
                if let (Some(place), Some(period_s), Some(last)) = (&file.period_s, period_s, times_s.last()) {
                    if period_s <= last.value {
                        let problem = ScenarioProblem::PeriodTooShort { period_s, last_s: last.value };
                        return Err(fault(place, problem));
                    }
                    self.few("jumps of the delay", self.end_s / period_s * times as f64, &place.span)?;
                }
                let (times_s, values_s) = (values(times_s), values(&file.values_s.value));
                Ok(Delay::PiecewiseConstant { times_s, values_s, period_s })
            }
            DelayFile::SawTooth(file) => {
                let min_s = not_negative("min_s", &file.min_s)?;
                let max_s = not_negative("max_s", &file.max_s)?;
                if min_s > max_s {
                    return Err(fault(&file.min_s, ScenarioProblem::SawTooth { min_s, max_s }));
                }
                let period_s = positive("period_s", &file.period_s)?;
                self.few("jumps of the delay", self.end_s / period_s, &file.period_s.span)?;
                // The same tooth, and no precision lost to a large offset.
                let offset_s = file.offset_s.rem_euclid(period_s);
                Ok(Delay::SawTooth { min_s, max_s, period_s, offset_s })
            }
        }
    }
}
