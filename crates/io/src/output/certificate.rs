//! A certificate as JSON: what `forwardstep check --certificate` writes and `checker/forwardstep_checker.py` reads.
//!
//! Numbers are whole, or stand in quotes as decimals or as p/q, so that no reader rounds them. Agents go by their names; phases
//! and axes count from one.

use std::io::Read;

use forwardstep_check::certificate::{Certificate, Enclosure, Matrix, Proof, Range, Statement, TreeWindow, decimal};
use forwardstep_sim::Setup;
use forwardstep_sim::graph::Edge;
use num_rational::BigRational;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};

use crate::scenario::Scenario;

/// The format of certificates; it grows when fields change their meaning or vanish.
pub const CERTIFICATE_FORMAT: u32 = 1;

/// Whether this is a certificate, of whatever format.
pub fn is_certificate(document: impl Read) -> bool {
    #[derive(Deserialize)]
    struct Told {
        #[serde(rename = "hypotheses")]
        _hypotheses: IgnoredAny,
        producer: String,
    }
    serde_json::from_reader(document).is_ok_and(|told: Told| told.producer.starts_with("forwardstep "))
}

/// The document of `certificate`, which is that of `scenario`, made by `version` of forwardstep.
pub fn certificate_document(scenario: &Scenario, version: &str, certificate: &Certificate) -> Value {
    let names = Names(&scenario.setup);
    let inputs =
        scenario.inputs.iter().map(|input| json!({ "file": input.name, "sha256": sha256(input.source.text()) }));
    let mut document = json!({
        "format": CERTIFICATE_FORMAT,
        "producer": format!("forwardstep {version}"),
        "scenario": {
            "name": scenario.name,
            "sha256": sha256(scenario.source.text()),
            "inputs": inputs.collect::<Vec<_>>(),
        },
        "theorem": certificate.theorem,
        "hypotheses": certificate.statements.iter().map(|statement| names.statement(statement)).collect::<Vec<_>>(),
    });
    let drawn = drawn_edges(scenario, &names);
    if let (false, Value::Object(fields)) = (drawn.is_empty(), &mut document) {
        fields.insert("given_edges".into(), drawn.into());
    }
    if let (Some(shares), Value::Object(fields)) = (&certificate.influence, &mut document) {
        let shares = shares.iter().enumerate().map(|(agent, share)| json!([names.of(agent), decimal(share)]));
        fields.insert("agreement".into(), json!({ "influence": shares.collect::<Vec<_>>() }));
    }
    document
}

/// The edges of every graph that was drawn, in the order of the scenario.
fn drawn_edges(scenario: &Scenario, names: &Names<'_>) -> Vec<Value> {
    let text: toml::Table = scenario.source.text().parse().unwrap_or_default();
    let network = text.get("network");
    let listed = network.and_then(|network| network.get("phases")).and_then(toml::Value::as_array);
    let graphs: Vec<&toml::Value> =
        listed.map_or_else(|| network.into_iter().collect(), |phases| phases.iter().collect());
    let random = |graph: &toml::Value| graph.get("edges").is_some_and(|edges| edges.get("random").is_some());
    let pairs = |edges: &[Edge]| edges.iter().map(|edge| json!([names.of(edge.from), names.of(edge.to)])).collect();
    let each = graphs.into_iter().zip(&scenario.setup.network.schedule.graphs);
    each.filter(|(graph, _)| random(graph)).map(|(_, edges)| pairs(edges)).map(Value::Array).collect()
}

/// In hexadecimal.
fn sha256(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Names of vertices.
struct Names<'a>(&'a Setup);

impl Names<'_> {
    fn of(&self, vertex: usize) -> &str {
        self.0.vertex_name(vertex)
    }

    fn all(&self, vertices: &[usize]) -> Vec<&str> {
        vertices.iter().map(|vertex| self.of(*vertex)).collect()
    }

    fn statement(&self, Statement { id, agents, answer, proof }: &Statement) -> Value {
        let mut entry = json!({ "id": id.name(), "agents": self.all(agents), "answer": answer.words() });
        if let (Some(proof), Value::Object(fields)) = (proof, &mut entry) {
            fields.insert("proof".into(), self.proof(proof));
        }
        entry
    }

    fn proof(&self, proof: &Proof) -> Value {
        match proof {
            Proof::Windows(windows) => json!({ "kind": "windows", "windows": self.windows(windows) }),
            Proof::EveryPhase(windows) => json!({ "kind": "every-phase", "windows": self.windows(windows) }),
            Proof::Drawn { given, windows, longest_s } => {
                let given = given.iter().map(|one| json!({ "phase": one.phase + 1, "until_s": decimal(&one.until_s) }));
                json!({
                    "kind": "drawn",
                    "given": given.collect::<Vec<_>>(),
                    "windows": self.windows(windows),
                    "longest_s": decimal(longest_s),
                })
            }
            Proof::Logged { windows, longest_s } => {
                json!({ "kind": "logged", "windows": self.windows(windows), "longest_s": decimal(longest_s) })
            }
            Proof::Cut(groups) => {
                json!({ "kind": "cut", "groups": groups.iter().map(|group| self.all(group)).collect::<Vec<_>>() })
            }
            Proof::Unheard { phase, group } => {
                json!({ "kind": "unheard", "phase": phase + 1, "group": self.all(group) })
            }
            Proof::NeverSwitches => json!({ "kind": "never-switches" }),
            Proof::ShortestPhase(shortest_s) => json!({ "kind": "shortest-phase", "shortest_s": decimal(shortest_s) }),
            Proof::OneGraph => json!({ "kind": "one-graph" }),
            Proof::Text => json!({ "kind": "text" }),
            Proof::Delays { bound_s, formulas, given } => {
                let given = given.iter().map(
                    |age| json!({ "from": self.of(age.from), "to": self.of(age.to), "worst_s": decimal(&age.worst_s) }),
                );
                json!({
                    "kind": "delays",
                    "bound_s": decimal(bound_s),
                    "enclosures": self.enclosures(formulas),
                    "given": given.collect::<Vec<_>>(),
                })
            }
            Proof::Ages(bound_s) => json!({ "kind": "ages", "bound_s": decimal(bound_s) }),
            Proof::Weights(formulas) => json!({ "kind": "weights", "enclosures": self.enclosures(formulas) }),
            Proof::Form(form, size) => json!({ "kind": "form", "form": form, "size": decimal(size) }),
            Proof::Number(value) => json!({ "kind": "number", "value": decimal(value) }),
            Proof::Routh(column) => json!({ "kind": "routh", "column": numbers(column) }),
            Proof::NoRouth(column) => json!({ "kind": "no-routh", "column": numbers(column) }),
            Proof::Classes(classes) => {
                json!({ "kind": "classes", "classes": classes.iter().map(|class| self.all(class)).collect::<Vec<_>>() })
            }
            Proof::Constant => json!({ "kind": "constant" }),
            Proof::Definite(matrices) => {
                let matrix = |Matrix { agent, gain, pivots }: &Matrix| json!({ "agent": self.of(*agent), "gain": gain, "pivots": numbers(pivots) });
                json!({ "kind": "definite", "matrices": matrices.iter().map(matrix).collect::<Vec<_>>() })
            }
            Proof::Laplacian { least, pivots } => {
                json!({ "kind": "definite", "least": decimal(least), "pivots": numbers(pivots) })
            }
            Proof::Derivatives(order, range) => {
                json!({ "kind": "derivatives", "order": order, "stretch": Value::Object(stretch(*range)) })
            }
            Proof::Drive(bounds) => json!({ "kind": "bounds", "bounds": self.enclosures(bounds) }),
            Proof::Reached(t_s, axis) => json!({ "kind": "instant", "t_s": decimal(t_s), "axis": axis + 1 }),
            Proof::SmallFactor(agent, None) => json!({ "kind": "factor", "agent": self.of(*agent) }),
            Proof::SmallFactor(agent, Some(state)) => {
                json!({ "kind": "factor", "agent": self.of(*agent), "state": numbers(state) })
            }
            Proof::Unmoved(agent, equation) => {
                json!({ "kind": "unmoved", "agent": self.of(*agent), "equation": equation + 1 })
            }
            Proof::NullVector(agent, vector, None) => {
                json!({ "kind": "null-vector", "agent": self.of(*agent), "vector": numbers(vector) })
            }
            Proof::NullVector(agent, vector, Some(state)) => {
                let (vector, state) = (numbers(vector), numbers(state));
                json!({ "kind": "null-vector", "agent": self.of(*agent), "vector": vector, "state": state })
            }
            Proof::Apart(least) => json!({ "kind": "apart", "least": decimal(least) }),
            Proof::HalfTurn => json!({ "kind": "half-turn" }),
            Proof::StartsBelow => json!({ "kind": "starts-below" }),
            Proof::LeftNull(vector) => json!({ "kind": "left-null", "vector": numbers(vector) }),
            Proof::Fades => json!({ "kind": "fades" }),
            Proof::Vanishes { at_s } => json!({ "kind": "vanishes", "at_s": decimal(at_s) }),
            Proof::ChangesSign { entry, from_s, to_s } => {
                json!({ "kind": "changes-sign", "entry": entry + 1, "from_s": decimal(from_s), "to_s": decimal(to_s) })
            }
            Proof::Outside => json!({ "kind": "outside" }),
            Proof::FactorAway => json!({ "kind": "factor-away" }),
            Proof::Below(t_s, edge) => json!({ "kind": "below", "t_s": decimal(t_s), "edge": self.edge(*edge) }),
            Proof::Limit(edge) => json!({ "kind": "limit", "edge": self.edge(*edge) }),
            Proof::LosesAll(edge) => json!({ "kind": "loses-all", "edge": self.edge(*edge) }),
            Proof::Older(edge) => json!({ "kind": "older", "edge": self.edge(*edge) }),
            Proof::NoValue(agent, state) => {
                json!({ "kind": "no-value", "agent": self.of(*agent), "state": numbers(state) })
            }
            Proof::Distance(bound) => json!({ "kind": "distance", "bound": self.enclosure(bound) }),
            Proof::OutOfReach(t_s) => json!({ "kind": "out-of-reach", "t_s": decimal(t_s) }),
            Proof::Diverges { motion, axis, order } => {
                json!({ "kind": "diverges", "motion": motion + 1, "axis": axis + 1, "order": order })
            }
            Proof::EntryAway(entry, bound) => {
                json!({ "kind": "entry-away", "entry": entry + 1, "bound": self.enclosure(bound) })
            }
            Proof::Norm(bound) => json!({ "kind": "norm", "bound": self.enclosure(bound) }),
        }
    }

    fn windows(&self, windows: &[TreeWindow]) -> Vec<Value> {
        let window = |TreeWindow { phases, root, arborescence }: &TreeWindow| {
            let steps = arborescence.iter().map(|step| self.edge(*step));
            json!({
                "phases": phases.iter().map(|phase| phase + 1).collect::<Vec<_>>(),
                "root": self.of(*root),
                "arborescence": steps.collect::<Vec<_>>(),
            })
        };
        windows.iter().map(window).collect()
    }

    fn edge(&self, (from, to, phase): (usize, usize, usize)) -> Value {
        json!([self.of(from), self.of(to), phase + 1])
    }

    fn enclosures(&self, enclosures: &[Enclosure]) -> Vec<Value> {
        enclosures.iter().map(|enclosure| self.enclosure(enclosure)).collect()
    }

    fn enclosure(&self, Enclosure { edge, range, within }: &Enclosure) -> Value {
        let mut fields = stretch(*range);
        fields.extend(edge.map(|edge| ("edge".to_owned(), self.edge(edge))));
        fields.insert("within".into(), numbers(within).into());
        Value::Object(fields)
    }
}

fn numbers(numbers: &[BigRational]) -> Vec<String> {
    numbers.iter().map(decimal).collect()
}

/// A stretch of time and its pieces.
fn stretch(range: Range) -> Map<String, Value> {
    let fields = match range {
        Range::ForEver => json!({ "range": "for-ever" }),
        Range::Period { cells } => json!({ "range": "period", "cells": cells }),
        Range::Tail { cells, until_s } => json!({ "range": "tail", "cells": cells, "until_s": until_s }),
        Range::Run { cells } => json!({ "range": "run", "cells": cells }),
    };
    fields.as_object().cloned().unwrap_or_default()
}
