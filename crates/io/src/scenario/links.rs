//! What belongs to one edge alone: packets, logs and random holds; and weights that follow a formula.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::sync::Arc;

use forwardstep_core::expression::{Expression, Interval};
use forwardstep_sim::delay::{Delay, Loss, Packet, PacketLink, RandomHold, Trace};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::quantity::few;

use super::at::At;
use super::fault::{Fault, between, fault, not_negative, not_negative_or, positive, seed};
use super::formula::formula;
use super::links_file::{BurstsFile, LogFile, LossFile, PacketsFile, RandomHoldFile, RandomLossFile, WeightFile};
use super::network::NetworkReader;
use super::network_problem::NetworkProblem;
use super::notice::Notice;
use super::table::{Cell, Column, TableProblem, cell_number, read_table, table_text};
use super::value_problem::ValueProblem;

/// Packets and values of random holds on all edges together; forty bytes each.
const MOST_PACKETS: f64 = 5e6;
/// Formulas for weights, and for delays, that are told apart; each is searched for its bounds.
const MOST_FORMULAS: usize = 1000;
/// Packets lost one after another that a bound may allow.
const MOST_IN_A_ROW: u32 = 1_000_000;

/// The delay of some edges, before it is known which.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum DelayPlan {
    /// One delay for all of them.
    Shared(Delay),
    /// Every edge draws its own.
    RandomHold { seed: u64, value_s: [f64; 2], hold_s: [f64; 2] },
    /// Every edge draws its own.
    Packets(PacketLink),
    /// Every edge has its own rows in this file.
    Log(String),
}

/// A log that has been read.
pub(super) struct Log {
    /// The packets of each edge, by the names of its agents, and whether the edge is there.
    links: BTreeMap<(String, String), (Vec<Packet>, bool)>,
}

/// What has been drawn or read for single edges so far.
#[derive(Default)]
pub(super) struct Links {
    /// The delay of each edge (from, to), by the kind of plan.
    drawn: HashMap<(usize, usize, bool), (DelayPlan, usize)>,
    logs: BTreeMap<String, Log>,
    weights: HashMap<String, Weight>,
    /// The delays that are written as formulas, by their texts.
    formulas: HashMap<String, Delay>,
    packets: f64,
}

impl NetworkReader<'_> {
    /// Reads a log, once.
    pub(super) fn log(&mut self, file: &LogFile) -> Result<DelayPlan, Fault> {
        let name = &file.file.value;
        if !self.links.logs.contains_key(name) {
            let table = table_text(&file.file, self.folder)?;
            let log = log_of(table.text(), |offset| table.line_column(offset).0);
            self.links.logs.insert(name.clone(), log.map_err(|fault| fault.within(&table))?);
        }
        Ok(DelayPlan::Log(name.clone()))
    }

    /// A delay that is written as a formula; equal texts are one delay.
    pub(super) fn formula_delay(&mut self, text: &At<String>) -> Result<Delay, Fault> {
        if let Some(known) = self.links.formulas.get(&text.value) {
            return Ok(known.clone());
        }
        let formula = formula(text)?;
        let delay = if formula.is_constant() {
            let value = At { value: constant(&formula), span: text.span.clone() };
            Delay::Constant { s: finite("formula_s", &value).and_then(|value| not_negative("formula_s", &value))? }
        } else {
            if self.links.formulas.len() >= MOST_FORMULAS {
                return Err(fault(text, NetworkProblem::TooManyFormulas { most: MOST_FORMULAS }));
            }
            let bounded = BoundedFormula::new(formula, self.end_s);
            let Interval { low, high } = bounded.within();
            if !(low >= 0.0 && high.is_finite()) {
                let (witness, end_s) = (witness(bounded.formula(), self.end_s, |value| value >= 0.0), self.end_s);
                return Err(fault(text, NetworkProblem::DelayBounds { low, high, witness, end_s }));
            }
            Delay::Formula(bounded.into())
        };
        self.links.formulas.insert(text.value.clone(), delay.clone());
        Ok(delay)
    }

    /// Index of the delay of one edge; `span` is where the edge is written.
    pub(super) fn delay_of(
        &mut self,
        plan: &DelayPlan,
        from: usize,
        to: usize,
        span: &Range<usize>,
    ) -> Result<usize, Fault> {
        if let DelayPlan::Shared(delay) = plan {
            return Ok(self.delay_index(delay.clone()));
        }
        let packets = !matches!(plan, DelayPlan::RandomHold { .. });
        match self.links.drawn.get(&(from, to, packets)) {
            Some((known, index)) if known == plan => return Ok(*index),
            Some(_) if packets => {
                let (from, to) = (self.names[from].clone(), self.names[to].clone());
                return Err(Fault::new(NetworkProblem::LinkDiffers { from, to }).at(span));
            }
            _ => {}
        }
        let delay = self.draw(plan, from, to, span)?;
        let index = self.new_delay(delay);
        self.links.drawn.insert((from, to, packets), (plan.clone(), index));
        Ok(index)
    }

    fn draw(&mut self, plan: &DelayPlan, from: usize, to: usize, span: &Range<usize>) -> Result<Delay, Fault> {
        let refused = |error| Fault::new(NetworkProblem::Link(error)).at(span);
        Ok(match plan {
            DelayPlan::Shared(delay) => delay.clone(),
            DelayPlan::RandomHold { seed, value_s, hold_s } => {
                self.few_packets("jumps of the delay", 2.0 * self.end_s / (hold_s[0] + hold_s[1]), span)?;
                let hold = RandomHold::draw(*seed, (from, to), *value_s, *hold_s, self.end_s).map_err(refused)?;
                Delay::RandomHold(Arc::new(hold))
            }
            DelayPlan::Packets(link) => {
                self.few_packets("packets", link.packets(self.end_s), span)?;
                Delay::Packets(Arc::new(link.trace((from, to), self.end_s).map_err(refused)?))
            }
            DelayPlan::Log(file) => {
                let names = (self.names[from].clone(), self.names[to].clone());
                let link = self.links.logs.get_mut(file).and_then(|log| log.links.get_mut(&names));
                let Some((packets, used)) = link else {
                    let (from, to) = names;
                    return Err(Fault::new(NetworkProblem::NotInLog { file: file.clone(), from, to }).at(span));
                };
                *used = true;
                let packets = packets.clone();
                self.few_packets("packets", packets.len() as f64, span)?;
                Delay::Packets(Arc::new(Trace::new(packets, self.end_s).map_err(refused)?))
            }
        })
    }

    fn few_packets(&mut self, what: &'static str, packets: f64, span: &Range<usize>) -> Result<(), Fault> {
        self.links.packets += packets;
        few("", what, packets, (what, self.links.packets, MOST_PACKETS))
            .map_err(|error| Fault::new(ValueProblem::Quantity(error)).at(span))
    }

    /// A weight as it is written.
    pub(super) fn weight(&mut self, weight: &At<WeightFile>) -> Result<Weight, Fault> {
        let span = weight.span.clone();
        let text = match &weight.value {
            WeightFile::Number(value) => return Ok(positive("weight", &At { value: *value, span })?.into()),
            WeightFile::Formula(text) => text,
        };
        if let Some(known) = self.links.weights.get(text) {
            return Ok(*known);
        }
        let place = At { value: text.clone(), span: span.clone() };
        let formula = formula(&place)?;
        let weight = if formula.is_constant() {
            let value = finite("weight", &At { value: constant(&formula), span })?;
            positive("weight", &value)?.into()
        } else {
            if self.weights.len() >= MOST_FORMULAS {
                return Err(fault(&place, NetworkProblem::TooManyFormulas { most: MOST_FORMULAS }));
            }
            let bounded = BoundedFormula::new(formula, self.end_s);
            let Interval { low, high } = bounded.within();
            if !(low > 0.0 && high.is_finite()) {
                let witness = witness(bounded.formula(), self.end_s, |value| value > 0.0);
                return Err(fault(&place, NetworkProblem::WeightBounds { low, high, witness, end_s: self.end_s }));
            }
            self.weights.push(bounded);
            Weight::Formula(self.weights.len() - 1)
        };
        self.links.weights.insert(text.clone(), weight);
        Ok(weight)
    }

    /// What the author should know about links when all of them have been read.
    pub(super) fn link_notices(&self, notices: &mut Vec<Notice>) {
        for (file, log) in &self.links.logs {
            let unused = log.links.iter().filter(|(_, (_, used))| !used).map(|(names, _)| names.clone());
            let unused: Vec<(String, String)> = unused.collect();
            if !unused.is_empty() {
                notices.push(Notice::UnusedInLog { file: file.clone(), links: unused });
            }
        }
        let mut silent: Vec<(usize, usize)> = Vec::new();
        for (&(from, to, packets), (_, index)) in &self.links.drawn {
            if packets
                && let Some(Delay::Packets(trace)) = self.delays.get(*index)
                && trace.arrivals() == 0
            {
                silent.push((from, to));
            }
        }
        silent.sort_unstable();
        if !silent.is_empty() {
            let names = |(from, to): (usize, usize)| (self.names[from].clone(), self.names[to].clone());
            notices.push(Notice::NothingArrives { links: silent.into_iter().map(names).collect() });
        }
    }
}

/// The number that a formula without t is, which may be none: 0.1 + 0.2 − 0.3 is zero.
fn constant(formula: &Expression) -> f64 {
    formula.constant().map_or(f64::NAN, |number| number.value())
}

/// The value of a formula without t, which may be none.
fn finite(key: &'static str, value: &At<f64>) -> Result<At<f64>, Fault> {
    if value.value.is_finite() { Ok(value.clone()) } else { Err(fault(value, NetworkProblem::NoValue { key })) }
}

/// A time at which a formula really has a value that it must not have, looked for here and there.
fn witness(formula: &Expression, end_s: f64, good: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    const LOOKS: u32 = 1000;
    let mut looks = (0..=LOOKS).map(|k| f64::from(k) / f64::from(LOOKS) * end_s);
    looks.find_map(|t_s| {
        let value = formula.eval(t_s);
        (!(good(value) && value.is_finite())).then_some((t_s, value))
    })
}

pub(super) fn random_hold(file: &RandomHoldFile) -> Result<DelayPlan, Fault> {
    let pair = |key: &'static str, pair: &At<[At<f64>; 2]>, least: fn(&'static str, &At<f64>) -> Result<f64, Fault>| {
        let [low, high] = &pair.value;
        let (low, high) = (least(key, low)?, least(key, high)?);
        if low > high { Err(fault(pair, ValueProblem::Interval { key, low, high })) } else { Ok([low, high]) }
    };
    Ok(DelayPlan::RandomHold {
        seed: seed(&file.seed)?,
        value_s: pair("value_s", &file.value_s, not_negative)?,
        hold_s: pair("hold_s", &file.hold_s, positive)?,
    })
}

pub(super) fn packets(file: &PacketsFile) -> Result<DelayPlan, Fault> {
    let every_s = positive("period_s", &file.period_s)?;
    let first_s = file.first_s.as_ref().map_or(Ok(0.0), |first| between("first_s", first, 0.0, every_s))?;
    let (loss, most_consecutive) = match file.loss.as_ref().map(|loss| &loss.value) {
        None => (Loss::Never, &None),
        Some(LossFile::Random(RandomLossFile { probability, most_consecutive })) => {
            (Loss::Random { probability: between("probability", probability, 0.0, 1.0)? }, most_consecutive)
        }
        Some(LossFile::Bursts(BurstsFile { enter, leave, most_consecutive })) => {
            let enter = between("enter", enter, 0.0, 1.0)?;
            positive("leave", leave)?;
            (Loss::Bursts { enter, leave: between("leave", leave, 0.0, 1.0)? }, most_consecutive)
        }
    };
    let most = most_consecutive.as_ref().map(|most| super::fault::count("most_consecutive", most, MOST_IN_A_ROW));
    let link = PacketLink {
        every_s,
        first_s,
        latency_s: not_negative("latency_s", &file.latency_s)?,
        jitter_s: not_negative_or("jitter_s", &file.jitter_s, 0.0)?,
        loss,
        most_in_a_row: most.transpose()?.map(|most| most as u32),
        seed: seed(&file.seed)?,
    };
    Ok(DelayPlan::Packets(link))
}

/// The packets of one edge, and where each stands.
type Rows = Vec<(Packet, Range<usize>)>;

/// The packets of a log; `line_of` says on which line a byte stands.
fn log_of(text: &str, line_of: impl Fn(usize) -> usize) -> Result<Log, Fault> {
    let columns = [("from", true), ("to", true), ("send_s", true), ("delay_s", false)]
        .map(|(name, required)| Column { name, required });
    let mut rows: BTreeMap<(String, String), Rows> = BTreeMap::new();
    for At { value: [from, to, send, delay], span } in read_table(text, columns)? {
        // The cell of a column that is not there is the line.
        if delay.span == span {
            let columns = columns.map(|column| column.name.to_owned()).to_vec();
            return Err(Fault::new(TableProblem::MissingColumn { name: "delay_s".into(), columns }));
        }
        let time = |key: &'static str, cell: &Cell<'_>| {
            // Adding zero takes the sign from a zero.
            cell_number(cell)?.map(|number| Ok(not_negative(key, &number)? + 0.0)).transpose()
        };
        let Some(send_s) = time("send_s", &send)? else { continue };
        let packet = Packet { send_s, delay_s: time("delay_s", &delay)? };
        rows.entry((from.value.into_owned(), to.value.into_owned())).or_default().push((packet, send.span));
    }
    let mut links = BTreeMap::new();
    for (names, mut packets) in rows {
        packets.sort_by(|a, b| a.0.send_s.total_cmp(&b.0.send_s).then(a.1.start.cmp(&b.1.start)));
        if let Some(pair) = packets.windows(2).find(|pair| pair[0].0.send_s == pair[1].0.send_s) {
            let (from, to) = names;
            let (send_s, first_line) = (pair[0].0.send_s, line_of(pair[0].1.start));
            return Err(Fault::new(NetworkProblem::PacketTwice { from, to, send_s, first_line }).at(&pair[1].1));
        }
        links.insert(names, (packets.into_iter().map(|(packet, _)| packet).collect(), false));
    }
    Ok(Log { links })
}

/// The weight in a cell of a table: a number, else a formula; none in an empty cell.
pub(super) fn cell_weight(cell: &Cell<'_>) -> Result<Option<At<WeightFile>>, Fault> {
    if !cell.value.is_empty() && cell.value.parse::<f64>().is_err() {
        let value = WeightFile::Formula(cell.value.to_string());
        return Ok(Some(At { value, span: cell.span.clone() }));
    }
    Ok(cell_number(cell)?.map(|number| At { value: WeightFile::Number(number.value), span: number.span }))
}
