//! Every quantity of the schema that has a range is refused out of it, at its very place.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use forwardstep_io::SourceText;
use forwardstep_io::scenario::schema;
use serde_json::Value;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::blind::BY_MODEL;
use super::chains::{CASCADES, DERIVATIVES};
use super::mutated::texts;
use super::read;
use super::spacecraft::{LAW, SPACECRAFT};
use super::tips::TIP;
use super::vehicles::VEHICLES;

/// Two arms in every respect that other texts leave out.
const ARMS: &str = r#"format = 2
time.end_s = 1
[[agents]]
name = "arm"
count = 2
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8], gravity_m_s2 = 9.81 }
[reference.consensus]
roots_per_s = [1.0, { real = 1.5, imaginary = 0.5 }]
exchange = "position"
[network]
coupling.tanh = 0.3
edges = [["arm-1", "arm-2"], { from = "arm-2", to = "arm-1", delay.packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.random = { probability = 0.1, most_consecutive = 3 } } }]
[control]
sample_hz = 100
message_timeout_s = 5
torque_limit = 50
torque_rate_limit_per_s = [500, 500]
noise = { seed = 1, velocity = 1e-3 }
quantisation = { velocity = 1e-4, torque = 0.1 }
[solver]
method.adaptive = { rtol = 1e-5, atol = 1e-7 }
max_step_s = 0.1
min_step_s = 1e-10
memory_budget_bytes = 100_000_000
[[external_wrenches]]
on = ["arm-1"]
by.virtual_spring_on_axes = { stiffness = 40, damping = 3, target_rad = [0, 1] }
"#;

/// Two masses that follow a leader.
const FOLLOWERS: &str = r#"format = 2
time.end_s = 1
[leader]
motion.formulas = ["sin(t)"]
[[agents]]
name = "cart"
count = 2
robot.point_mass = { dimension = 1, mass_kg = 2 }
[reference.leader]
design = "continuous"
roots_per_s = [1.5]
gain = 3
sign.boundary_layer.width = 0.1
[network]
edges = [["leader", "cart-1"], ["cart-1", "cart-2"]]
"#;

/// Another law for the plants of order three.
fn of_order_three(law: &str) -> String {
    let (start, rest) = DERIVATIVES.split_once("[law.immersion]").unwrap();
    format!("{start}[law.{law}\n\n{}", &rest[rest.find("[network]").unwrap()..])
}

/// What no other text has.
fn rest() -> Vec<String> {
    let arms = [
        ("coupling.tanh", "coupling.rational"),
        ("torque_limit = 50", "torque_limit = [50, 50]"),
        ("method.adaptive = { rtol = 1e-5, atol = 1e-7 }", "method.fixed.step_s = 1e-2"),
    ];
    let two = [
        (VEHICLES, "floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor.stops_n = 1"),
        (VEHICLES, "inertia_kg_m2 = [0.012, 0.013, 0.022]", "inertia_kg_m2 = 0.01\ngravity_m_s2 = 9.8"),
        (SPACECRAFT, "[[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]", "8"),
        (SPACECRAFT, "damping = 3", "damping = [3, 3, 3, 2]"),
        (SPACECRAFT, LAW, "[law.passivity_filter]\nerror_gain_n_m = 4\nfilter_gain_per_s = [1, 1, 1, 2]\ndamping = 3"),
        (SPACECRAFT, LAW, "[law.passivity_filter]\nfilter_gain_per_s = 1\ndamping = [3, 3, 3, 2]"),
        (CASCADES, "adaptation_gain = 1", "adaptation_gain = [1, 2]"),
        (TIP, "adaptation_gain.bandwidth_per_s = 10", &format!("adaptation_gain = [{}]", ["1"; 30].join(", "))),
        (TIP, "task_gain = 200", "task_gain = [200, 200, 100]"),
    ];
    let watched = "tip_velocity = \"measured\"\ntask_gain = 200";
    let noisy = "[control]\nsample_hz = 500\nnoise = { seed = 1, tip_velocity = 0.05 }\n\n[goal]";
    let mut all: Vec<String> = two.iter().map(|(text, from, to)| text.replace(from, to)).collect();
    all.push(arms.iter().fold(ARMS.to_owned(), |text, (from, to)| text.replace(from, to)));
    all.push(of_order_three("immersion]\nadaptation_gain = 2\nantiderivatives = [\"d2x*sin(x)\", \"d2x*dx\"]"));
    all.push(of_order_three("linear_adaptive]\nadaptation_gain = [2, 1]\nfloor = 1e-2"));
    all.push(of_order_three("linearising]\nfloor = 1e-2"));
    let stated = [("\"continuous\"", "\"differentiable\""), ("roots_per_s = [1.5]", "alpha = 2\nbeta = 3")];
    all.push(stated.iter().fold(FOLLOWERS.to_owned(), |text, (from, to)| text.replace(from, to)));
    all.push(TIP.replace("task_gain = 200", watched).replace("[goal]", noisy));
    // Without the rotorcraft, which the law is not made for.
    let (vehicles, rest) = VEHICLES.split_once("[[agents]]\nname = \"rotor\"").unwrap();
    let rest = rest.split_once("[reference.consensus]").unwrap().1.replace("rate_bandwidth_per_s = 30\n", "");
    let by_acceleration = "design.by_acceleration = { damping_per_s = 3, adaptation_gain = 0.2, estimate_start_kg = 1.2, bias_m_s2 = [0, 0, 0.1] }";
    let rest = rest.replace("design.differentiable = { damping_per_s = 3, stiffness = 4 }", by_acceleration);
    all.push(format!("{vehicles}[reference.consensus]{}", rest.replace("[1.0, 1.5, 2.0]", "[1.0, 1.5]")));
    all.extend([ARMS, FOLLOWERS, BY_MODEL].map(str::to_owned));
    all
}

/// Keywords of a range.
const BOUNDS: [&str; 3] = ["minimum", "exclusiveMinimum", "maximum"];

/// The parts of a schema that describe what is inside a node, with where they stand.
struct Walk<'s> {
    schema: &'s Value,
}

impl<'s> Walk<'s> {
    /// The node itself, or what it refers to, and its alternatives.
    fn alternatives(&self, pointer: &str, node: &'s Value) -> Vec<(String, &'s Value)> {
        let mut all = vec![(pointer.to_owned(), node)];
        if let Some(target) = node["$ref"].as_str() {
            let target = target.trim_start_matches('#');
            all.extend(self.alternatives(target, self.schema.pointer(target).unwrap()));
        }
        for key in ["anyOf", "oneOf", "allOf"] {
            for (k, inner) in node[key].as_array().into_iter().flatten().enumerate() {
                all.extend(self.alternatives(&format!("{pointer}/{key}/{k}"), inner));
            }
        }
        all
    }

    /// Every number of `value` with a range, by where the range stands in the schema.
    fn numbers(
        &self,
        pointer: &str,
        node: &'s Value,
        value: &Spanned<DeValue<'_>>,
        found: &mut Vec<(String, &'s Value, Range<usize>)>,
    ) {
        for (pointer, node) in self.alternatives(pointer, node) {
            match value.get_ref() {
                DeValue::Integer(_) | DeValue::Float(_) if BOUNDS.iter().any(|bound| node[bound].is_number()) => {
                    found.push((pointer, node, value.span()));
                }
                DeValue::Table(table) => {
                    for (key, value) in table {
                        if let Some(inner) = node["properties"].get(key.get_ref().as_ref()) {
                            self.numbers(&format!("{pointer}/properties/{}", key.get_ref()), inner, value, found);
                        }
                    }
                }
                DeValue::Array(array) => {
                    for (k, value) in array.iter().enumerate() {
                        if let Some(inner) = node["prefixItems"].get(k) {
                            self.numbers(&format!("{pointer}/prefixItems/{k}"), inner, value, found);
                        } else if node["items"].is_object() {
                            self.numbers(&format!("{pointer}/items"), &node["items"], value, found);
                        }
                    }
                }
                _ => {}
            }
        }
    }

    /// Where in the schema a range stands.
    fn ranges(&self) -> BTreeSet<String> {
        fn collect(pointer: &str, node: &Value, found: &mut BTreeSet<String>) {
            if BOUNDS.iter().any(|bound| node[bound].is_number()) {
                found.insert(pointer.to_owned());
            }
            let inner: Vec<(String, &Value)> = match node {
                Value::Object(map) => map.iter().map(|(key, inner)| (key.clone(), inner)).collect(),
                Value::Array(list) => list.iter().enumerate().map(|(k, inner)| (k.to_string(), inner)).collect(),
                _ => Vec::new(),
            };
            inner.into_iter().for_each(|(key, inner)| collect(&format!("{pointer}/{key}"), inner, found));
        }
        let mut found = BTreeSet::new();
        collect("", self.schema, &mut found);
        found
    }
}

/// Numbers out of the range of `node`.
fn outside(node: &Value) -> Vec<String> {
    let bound = |key: &str| node[key].as_f64();
    let exclusive = bound("exclusiveMinimum").into_iter().flat_map(|low| [low, low - 1.0]);
    let below = bound("minimum").into_iter().map(|low| low - 1.0);
    let above = bound("maximum").into_iter().map(|high| 2.0 * high + 1.0);
    exclusive.chain(below).chain(above).map(|value| value.to_string()).collect()
}

#[test]
fn every_quantity_with_a_range_is_refused_out_of_it_at_its_place() {
    let schema = serde_json::to_value(schema()).unwrap();
    let walk = Walk { schema: &schema };
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut wrong = Vec::new();
    for text in texts().into_iter().map(str::to_owned).chain(rest()) {
        let text = text.as_str();
        assert!(read(text).is_ok(), "{:?} of\n{text}", read(text).map_err(|error| error.to_string()).err());
        let source = SourceText::new("test.toml", text);
        let table = DeTable::parse(text).unwrap();
        let root = Spanned::new(table.span(), DeValue::Table(table.into_inner()));
        let mut numbers = Vec::new();
        walk.numbers("", &schema, &root, &mut numbers);
        for (pointer, node, span) in numbers {
            // A second place may be read in another way, a third hardly.
            let known = places.entry(pointer.clone()).or_default();
            if known.len() > 1 {
                continue;
            }
            known.push(text[span.clone()].to_owned());
            let (line, column) = source.line_column(span.start);
            for value in outside(node) {
                let changed = [&text[..span.start], &value, &text[span.end..]].concat();
                let said = read(&changed).map_or_else(|error| error.to_string(), |_| "accepted".into());
                if !said.starts_with(&format!("test.toml:{line}:{column}: ")) {
                    wrong.push(format!("{pointer} = {value} on {line}:{column}: {said}"));
                }
            }
        }
    }
    let unseen: Vec<String> = walk.ranges().into_iter().filter(|pointer| !places.contains_key(pointer)).collect();
    assert!(wrong.is_empty() && unseen.is_empty(), "wrong: {wrong:#?}\nin no scenario of the tests: {unseen:#?}");
}
