//! What belongs to one edge alone: delays of its own; and weights that follow a formula.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

use forwardstep_core::expression::Expression;
use forwardstep_sim::delay::{self, Delay};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::quantity::Sign;

use super::at::At;
use super::fault::{Fault, fault};
use super::formula::formula;
use super::formula_text::FormulaText;
use super::kinds::delays::hold_log::Holds;
use super::kinds::delays::log::Log;
use super::kinds::delays::{DelayPlan, Link, LinkDelays};
use super::links_file::{LinkDelayFile, WeightFile};
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
    /// Held values that were read, by their files.
    pub(super) held: HashMap<String, Arc<Holds>>,
    weights: HashMap<FormulaText, Weight>,
    /// The delays that are written as formulas, by their texts.
    formulas: HashMap<FormulaText, Delay>,
    counted: delay::Drawn,
    /// What `link_delays` states.
    stated: HashMap<(usize, usize), Stated>,
}

/// The delay of one link for all graphs.
struct Stated {
    plan: DelayPlan,
    /// Its line in the scenario.
    line: usize,
    /// Whether some graph has the edge.
    used: bool,
}

impl NetworkReader<'_> {
    /// A delay that is written as a formula; equal texts are one delay.
    pub(super) fn formula_delay(&mut self, text: &At<FormulaText>) -> Result<Delay, Fault> {
        if let Some(known) = self.links.formulas.get(&text.value) {
            return Ok(known.clone());
        }
        let formula = formula(text)?;
        self.few_formulas(self.links.formulas.len(), &formula, text)?;
        let bounded = BoundedFormula::new(formula, self.end_s);
        bounded.stays("formula_s", Sign::NotNegative)?;
        let delay = bounded.constant().map_or_else(|| Delay::new(bounded), Delay::constant);
        self.links.formulas.insert(text.value.clone(), delay.clone());
        Ok(delay)
    }

    /// Reads the delays that links have in all graphs.
    pub(super) fn link_delays(&mut self, delays: &[At<LinkDelayFile>]) -> Result<(), Fault> {
        for place in delays {
            let LinkDelayFile { from, to, delay } = &place.value;
            let ends = self.ends((from, to), place)?;
            if let Some(first) = self.links.stated.get(&ends) {
                return Err(self.stated_twice(ends, first.line).at(&place.span));
            }
            let (line, _) = self.source.line_column(place.span.start);
            let plan = self.plan(delay)?;
            self.links.stated.insert(ends, Stated { plan, line, used: false });
        }
        Ok(())
    }

    /// What the delay of an edge is drawn from: its own, which is written at a place, else that of its link, else the network's.
    pub(super) fn plan_of(
        &mut self,
        own: Option<(&DelayPlan, &Range<usize>)>,
        ends: (usize, usize),
    ) -> Result<DelayPlan, Fault> {
        match (own, self.links.stated.get_mut(&ends)) {
            (None, None) => Ok(self.default_delay.clone()),
            (Some((plan, _)), None) => Ok(plan.clone()),
            (None, Some(stated)) => {
                stated.used = true;
                Ok(stated.plan.clone())
            }
            (Some((_, span)), Some(stated)) => {
                let line = stated.line;
                Err(self.stated_twice(ends, line).at(span))
            }
        }
    }

    fn stated_twice(&self, (from, to): (usize, usize), first_line: usize) -> Fault {
        let (from, to) = (self.names[from].clone(), self.names[to].clone());
        Fault::new(NetworkProblem::LinkDelayTwice { from, to, first_line })
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
        let mut link = Link { agents: (from, to), names, end_s: self.end_s, drawn: &mut self.links.counted };
        let delay = delays.draw(&mut link).map_err(|fault| fault.at(span))?;
        self.delays.push(delay);
        let index = self.delays.len() - 1;
        self.links.drawn.insert((from, to, stays), (delays.clone(), index));
        Ok(index)
    }

    /// A weight as it is written.
    pub(super) fn weight(&mut self, weight: &At<WeightFile>) -> Result<Weight, Fault> {
        match &weight.value {
            WeightFile::Number(value) => {
                let constant = Weight::Constant(*value);
                let checked = constant.check(&self.weights).map(|()| constant);
                checked.map_err(|error| Fault::from(error).at(&weight.span))
            }
            WeightFile::Formula(text) => match self.links.weights.get(text) {
                Some(known) => Ok(*known),
                None => self.formula_weight(&At { value: text.clone(), span: weight.span.clone() }),
            },
        }
    }

    fn formula_weight(&mut self, text: &At<FormulaText>) -> Result<Weight, Fault> {
        let formula = formula(text)?;
        self.few_formulas(self.weights.len(), &formula, text)?;
        let bounded = BoundedFormula::new(formula, self.end_s);
        bounded.stays("weight", Sign::Positive).map_err(|error| Fault::from(error).at(&text.span))?;
        let weight = bounded.constant().map(Weight::Constant);
        let weight = weight.unwrap_or_else(|| {
            self.weights.push(bounded);
            Weight::Formula(self.weights.len() - 1)
        });
        self.links.weights.insert(text.value.clone(), weight);
        Ok(weight)
    }

    /// One formula more than `known` that change with t.
    fn few_formulas(&self, known: usize, formula: &Expression, text: &At<FormulaText>) -> Result<(), Fault> {
        if known < MOST_FORMULAS || formula.is_constant() {
            return Ok(());
        }
        Err(fault(text, NetworkProblem::TooManyFormulas { most: MOST_FORMULAS }))
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
        let unused = self.links.stated.iter().filter(|(_, stated)| !stated.used);
        let mut unused: Vec<_> = unused.map(|(&(from, to), stated)| (stated.line, from, to)).collect();
        unused.sort_unstable();
        if !unused.is_empty() {
            let names = |(_, from, to): (usize, usize, usize)| (self.names[from].clone(), self.names[to].clone());
            notices.push(Notice::UnusedLinkDelay { links: unused.into_iter().map(names).collect() });
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

/// The weight in a cell of a table: a number, else a formula; none in an empty cell.
pub(super) fn cell_weight(cell: &Cell<'_>) -> Result<Option<At<WeightFile>>, Fault> {
    if !cell.value.is_empty() && cell.value.parse::<f64>().is_err() {
        let value = WeightFile::Formula(FormulaText(cell.value.to_string()));
        return Ok(Some(At { value, span: cell.span.clone() }));
    }
    Ok(cell_number(cell)?.map(|number| At { value: WeightFile::Number(number.value), span: number.span }))
}
