//! What belongs to one edge alone: delays of its own; and weights that follow a formula.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

use forwardstep_core::expression::{Expression, Interval};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;

use super::at::At;
use super::fault::{Fault, fault, not_negative, positive};
use super::formula::formula;
use super::kinds::delays::log::Log;
use super::kinds::delays::{DelayPlan, Link, LinkDelays};
use super::links_file::WeightFile;
use super::network::NetworkReader;
use super::network_problem::NetworkProblem;
use super::notice::Notice;
use super::table::{Cell, cell_number};

/// Formulas for weights, and for delays, that are told apart; each is searched for its bounds.
const MOST_FORMULAS: usize = 1000;

/// Where the delay of one link comes from, and its index.
type Drawn = (Arc<dyn LinkDelays>, usize);

/// What has been drawn or read for single edges so far.
#[derive(Default)]
pub(super) struct Links {
    /// The delay of each edge (from, to), and whether it stays with the link.
    drawn: HashMap<(usize, usize, bool), Drawn>,
    pub(super) logs: BTreeMap<String, Arc<Log>>,
    weights: HashMap<String, Weight>,
    /// The delays that are written as formulas, by their texts.
    formulas: HashMap<String, Delay>,
    events: f64,
}

impl NetworkReader<'_> {
    /// A delay that is written as a formula; equal texts are one delay.
    pub(super) fn formula_delay(&mut self, text: &At<String>) -> Result<Delay, Fault> {
        if let Some(known) = self.links.formulas.get(&text.value) {
            return Ok(known.clone());
        }
        let formula = formula(text)?;
        let delay = if formula.is_constant() {
            let value = At { value: constant(&formula), span: text.span.clone() };
            Delay::constant(finite("formula_s", &value).and_then(|value| not_negative("formula_s", &value))?)
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
            Delay::new(bounded)
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
        let delays = match plan {
            DelayPlan::Shared(delay) => return Ok(self.delay_index(delay.clone())),
            DelayPlan::EachLink(delays) => delays,
        };
        let stays = delays.stays_with_link();
        match self.links.drawn.get(&(from, to, stays)) {
            Some((known, index)) if known.same(&**delays) => return Ok(*index),
            Some(_) if stays => {
                let (from, to) = (self.names[from].clone(), self.names[to].clone());
                return Err(Fault::new(NetworkProblem::LinkDiffers { from, to }).at(span));
            }
            _ => {}
        }
        let names = [&self.names[from][..], &self.names[to]];
        let mut link = Link { agents: (from, to), names, end_s: self.end_s, events: &mut self.links.events };
        let delay = delays.draw(&mut link).map_err(|fault| fault.at(span))?;
        self.delays.push(delay);
        let index = self.delays.len() - 1;
        self.links.drawn.insert((from, to, stays), (delays.clone(), index));
        Ok(index)
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
            let drawn = self.links.drawn.iter().filter(|(_, (delays, _))| delays.same(&**log));
            let used: HashSet<[&str; 2]> =
                drawn.map(|((from, to, _), _)| [&self.names[*from][..], &self.names[*to]]).collect();
            let unused = log.links.keys().filter(|(from, to)| !used.contains(&[&from[..], to]));
            let unused: Vec<(String, String)> = unused.cloned().collect();
            if !unused.is_empty() {
                notices.push(Notice::UnusedInLog { file: file.clone(), links: unused });
            }
        }
        let mut silent: Vec<(usize, usize)> = Vec::new();
        for (&(from, to, _), (_, index)) in &self.links.drawn {
            if let Some(trace) = self.delays.get(*index).and_then(Delay::packets)
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

/// The weight in a cell of a table: a number, else a formula; none in an empty cell.
pub(super) fn cell_weight(cell: &Cell<'_>) -> Result<Option<At<WeightFile>>, Fault> {
    if !cell.value.is_empty() && cell.value.parse::<f64>().is_err() {
        let value = WeightFile::Formula(cell.value.to_string());
        return Ok(Some(At { value, span: cell.span.clone() }));
    }
    Ok(cell_number(cell)?.map(|number| At { value: WeightFile::Number(number.value), span: number.span }))
}
