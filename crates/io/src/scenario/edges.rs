//! `edges` of a graph → [`Edge`]s.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::topology::{Along, Spokes, Topology};

use super::at::At;
use super::edges_file::{AlongDirection, AlongFile, CsvFile, EdgeFile, EdgesFile, RuleFile, StarDirection, StarFile};
use super::fault::{Fault, Faults, fault, filled, positive_count, seed};
use super::kinds::delays::DelayPlan;
use super::links::cell_weight;
use super::links_file::WeightFile;
use super::network::NetworkReader;
use super::network_file::DelayFile;
use super::network_problem::NetworkProblem;
use super::problem::ScenarioProblem;
use super::table::{Column, cell_number, read_table, table_text};
use crate::SourceText;

/// Edges by rule and from tables that are accepted in all graphs together.
const MOST_EDGES: u64 = 1_000_000;

/// A rule for some agents, and what its edges have in common.
struct Rule<'a> {
    topology: Topology,
    members: Vec<usize>,
    weight: &'a Option<At<WeightFile>>,
    delay: &'a Option<At<DelayFile>>,
}

impl NetworkReader<'_> {
    /// The edges of one graph.
    pub(super) fn edges(&mut self, edges: &At<EdgesFile>) -> Result<Vec<Edge>, Fault> {
        match &edges.value {
            EdgesFile::List(list) => self.listed(list, self.source),
            EdgesFile::Rule(rule) => self.ruled(rule, &edges.span),
        }
    }

    /// Edges that are written one by one in `source`.
    fn listed(&mut self, edges: &[At<EdgeFile>], source: &SourceText) -> Result<Vec<Edge>, Fault> {
        let mut seen: HashMap<(usize, usize), usize> = HashMap::with_capacity(edges.len());
        let mut read = Vec::with_capacity(edges.len());
        for place in edges {
            let EdgeFile { from, to, weight, delay } = &place.value;
            let (j, i) = self.ends((from, to), place)?;
            if let Some(start) = seen.insert((j, i), place.span.start) {
                let (first_line, _) = source.line_column(start);
                let (from, to) = (from.value.clone(), to.value.clone());
                return Err(fault(place, NetworkProblem::EdgeTwice { from, to, first_line }));
            }
            let (weight, own) = self.terms(weight, delay)?;
            let span = delay.as_ref().map_or(&place.span, |delay| &delay.span);
            let plan = self.plan_of(own.as_ref().map(|plan| (plan, span)), (j, i))?;
            let delay = self.delay_of(&plan, j, i, span)?;
            read.push(Edge { from: j, to: i, weight, delay });
        }
        Ok(read)
    }

    /// Edges from a table.
    fn tabled(&mut self, csv: &CsvFile, span: &Range<usize>) -> Result<Vec<Edge>, Fault> {
        let table = table_text(&csv.file, self.folder)?;
        let edges = edges_of(table.text()).map_err(|fault| fault.within_table(&table, &csv.file))?;
        self.few_edges(edges.len() as u64, span)?;
        let mut faults = Faults::default();
        for edge in &edges {
            let (from, to) = (&edge.value.from, &edge.value.to);
            match [from, to].into_iter().find(|name| !self.index.contains_key(name.value.as_str())) {
                Some(unknown) => faults.add(|| self.no_such_agent(unknown)),
                None => {
                    faults.noted(self.ends((from, to), edge));
                }
            }
        }
        faults.end().map_err(|fault| fault.within(&table))?;
        self.listed(&edges, &table).map_err(|fault| fault.within(&table))
    }

    /// Edges by a rule.
    fn ruled(&mut self, rule: &RuleFile, span: &Range<usize>) -> Result<Vec<Edge>, Fault> {
        let (rule, place) = match rule {
            RuleFile::Ring(file) => (self.along(Topology::Ring, file)?, span),
            RuleFile::Path(file) => (self.along(Topology::Path, file)?, span),
            RuleFile::Star(file) => (self.star(file)?, span),
            RuleFile::Complete(file) => {
                let (members, weight, delay) = (self.members(file.among.as_ref())?, &file.weight, &file.delay);
                (Rule { topology: Topology::Complete, members, weight, delay }, span)
            }
            RuleFile::Random(file) => {
                // Whether there are so many others is asked of the rule.
                let in_degree = positive_count("in_degree", &file.in_degree)? as usize;
                let topology = Topology::Random { in_degree, seed: seed(&file.seed)? };
                let (members, weight, delay) = (self.members(file.among.as_ref())?, &file.weight, &file.delay);
                (Rule { topology, members, weight, delay }, &file.in_degree.span)
            }
            RuleFile::Csv(file) => return self.tabled(file, span),
        };
        let Rule { topology, members, weight, delay } = rule;
        let span_of_delay = delay.as_ref().map_or(span, |delay| &delay.span);
        let (weight, own) = self.terms(weight, delay)?;
        let refused = |error| Fault::new(NetworkProblem::Topology(error)).at(place);
        self.few_edges(topology.edge_count(members.len()).map_err(refused)?, span)?;
        let pairs = topology.edges(members.len()).map_err(refused)?;
        let mut edges = Vec::with_capacity(pairs.len());
        for (j, i) in pairs {
            let (from, to) = (members[j], members[i]);
            let plan = self.plan_of(own.as_ref().map(|plan| (plan, span_of_delay)), (from, to))?;
            edges.push(Edge { from, to, weight, delay: self.delay_of(&plan, from, to, span_of_delay)? });
        }
        Ok(edges)
    }

    fn along<'a>(&self, topology: fn(Along) -> Topology, file: &'a AlongFile) -> Result<Rule<'a>, Fault> {
        let direction = match file.direction {
            AlongDirection::Forward => Along::Forward,
            AlongDirection::Both => Along::Both,
        };
        let members = self.members(file.among.as_ref())?;
        Ok(Rule { topology: topology(direction), members, weight: &file.weight, delay: &file.delay })
    }

    fn star<'a>(&self, file: &'a StarFile) -> Result<Rule<'a>, Fault> {
        let centre = self.agent(&file.centre)?;
        let mut members = self.members(file.among.as_ref())?;
        // The centre may be named among the others, but need not be.
        let known = members.iter().position(|member| *member == centre);
        let place = known.unwrap_or_else(|| {
            members.insert(0, centre);
            0
        });
        let spokes = match file.direction {
            StarDirection::Out => Spokes::Out,
            StarDirection::In => Spokes::In,
            StarDirection::Both => Spokes::Both,
        };
        let topology = Topology::Star { centre: place, spokes };
        Ok(Rule { topology, members, weight: &file.weight, delay: &file.delay })
    }

    /// The agents of these names, in this order; without any, all.
    fn members(&self, among: Option<&At<Vec<At<String>>>>) -> Result<Vec<usize>, Fault> {
        let Some(among) = among else { return Ok((0..self.agents).collect()) };
        let mut seen = HashSet::new();
        let mut members = Vec::with_capacity(among.value.len());
        for name in filled("among", among)? {
            let agent = self.agent(name)?;
            if !seen.insert(agent) {
                return Err(fault(name, NetworkProblem::AmongTwice { name: name.value.clone() }));
            }
            members.push(agent);
        }
        Ok(members)
    }

    /// The weight of an edge, its own, else the network's; and a delay of its own.
    fn terms(
        &mut self,
        weight: &Option<At<WeightFile>>,
        delay: &Option<At<DelayFile>>,
    ) -> Result<(Weight, Option<DelayPlan>), Fault> {
        let weight = weight.as_ref().map_or(Ok(self.weight), |weight| self.weight(weight))?;
        let plan = delay.as_ref().map(|delay| self.plan(delay)).transpose()?;
        Ok((weight, plan))
    }

    /// The vertices at the ends of a link that can be.
    pub(super) fn ends<T>(
        &self,
        (from, to): (&At<String>, &At<String>),
        place: &At<T>,
    ) -> Result<(usize, usize), Fault> {
        let (j, i) = (self.agent(from)?, self.agent(to)?);
        if i == j {
            return Err(fault(place, NetworkProblem::SelfLoop { name: to.value.clone() }));
        }
        if i >= self.agents {
            return Err(fault(place, NetworkProblem::LeaderHears { name: to.value.clone() }));
        }
        Ok((j, i))
    }

    /// Refuses more edges than fit into memory.
    fn few_edges(&mut self, edges: u64, span: &Range<usize>) -> Result<(), Fault> {
        self.edges_so_far = self.edges_so_far.saturating_add(edges);
        if self.edges_so_far <= MOST_EDGES {
            return Ok(());
        }
        let problem = NetworkProblem::TooManyEdges { edges: self.edges_so_far, most: MOST_EDGES };
        Err(Fault::new(problem).at(span))
    }

    fn agent(&self, name: &At<String>) -> Result<usize, Fault> {
        self.index.get(name.value.as_str()).copied().ok_or_else(|| self.no_such_agent(name))
    }

    fn no_such_agent(&self, name: &At<String>) -> Fault {
        fault(name, ScenarioProblem::NoSuchAgent { name: name.value.clone(), agents: self.names.to_vec() })
    }
}

/// The lines of a table of edges.
fn edges_of(text: &str) -> Result<Vec<At<EdgeFile>>, Fault> {
    let columns = [("from", true), ("to", true), ("weight", false), ("delay_s", false)]
        .map(|(name, required)| Column { name, required });
    let mut faults = Faults::default();
    let rows = read_table(text, columns, &mut faults)?;
    let mut edges = Vec::with_capacity(rows.len());
    for At { value: [from, to, weight, delay_s], span } in rows {
        let (weight, delay_s) = (faults.noted(cell_weight(&weight)), faults.noted(cell_number(&delay_s)));
        let (Some(weight), Some(delay_s)) = (weight, delay_s) else { continue };
        let delay = delay_s.map(|delay_s| At { value: DelayFile::Constant(delay_s.value), span: delay_s.span });
        let edge = EdgeFile {
            from: At { value: from.value.into_owned(), span: from.span },
            to: At { value: to.value.into_owned(), span: to.span },
            weight,
            delay,
        };
        edges.push(At { value: edge, span });
    }
    faults.end()?;
    Ok(edges)
}
