//! Links as they are: what is read, what every mistake gets, and a run replayed from its own log.

use std::ops::ControlFlow;
use std::path::Path;

use forwardstep_check::{Report, check};
use forwardstep_io::SourceText;
use forwardstep_io::output::{Options, RunFolder, write_run};
use forwardstep_io::scenario::{Notice, Scenario, ScenarioError, open_scenario, read_scenario};
use forwardstep_sim::delay::{Delay, Loss, Packet, PacketLink, RandomHold, Trace};
use forwardstep_sim::graph::Weight;
use forwardstep_sim::{Outcome, Progress, simulate};

use super::{as_stated, changed, read};

use crate::support::plain_record;

/// Every way to say how late a message is once, but for logs, which need a folder.
pub(super) const LINKS: &str = r#"format = 2
time = { end_s = 3, record_every_s = 0.01 }
[[agents]]
name = "cart"
count = 4
robot.point_mass = { dimension = 2, mass_kg = 2 }
start.position = { random = { seed = 1, within = [-1, 1] } }
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position_velocity"
[network]
weight = "1 + 0.5*sin(t)"
delay.packets = { period_s = 0.05, first_s = 0.01, latency_s = 0.03, jitter_s = 0.2, seed = 5, loss.random = { probability = 0.2 } }
[[network.phases]]
dwell_s = 0.5
edges = [["cart-1", "cart-2"], ["cart-3", "cart-4"], { from = "cart-2", to = "cart-1", weight = "exp(-t) + 1", delay.formula_s = "0.2 + 0.1*sin(2*pi*t/3)" }]
[[network.phases]]
dwell_s = 0.7
edges = [["cart-1", "cart-2"], ["cart-2", "cart-3"], { from = "cart-4", to = "cart-1", delay.random_hold = { seed = 3, value_s = [0.05, 0.4], hold_s = [0.1, 0.8] } }, { from = "cart-4", to = "cart-2", delay.packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.bursts = { enter = 0.1, leave = 0.5, most_consecutive = 3 } } }]
[goal]
disagreement_below = 10
"#;

fn network(text: &str) -> forwardstep_sim::Network {
    read(text).unwrap_or_else(|error| panic!("{error}")).setup.network
}

#[test]
fn links_are_what_they_say() {
    let network = network(LINKS);
    let [first, second] = &network.schedule.graphs[..] else { panic!() };
    // One link, whatever the graph; every other edge has its own.
    assert_eq!(first[0].delay, second[0].delay);
    let radio = PacketLink {
        every_s: 0.05,
        first_s: 0.01,
        latency_s: 0.03,
        jitter_s: 0.2,
        loss: Loss::Random { probability: 0.2 },
        most_in_a_row: None,
        seed: 5,
    };
    for edge in [first[0], first[1], second[1]] {
        let trace = radio.trace((edge.from, edge.to), 3.0).unwrap();
        assert_eq!(network.delays[edge.delay], Delay::new(trace));
    }
    let trace = network.delays[second[3].delay].packets().unwrap();
    assert_eq!(trace.link().unwrap().most_in_a_row, Some(3));
    assert_eq!(trace.link().unwrap().loss, Loss::Bursts { enter: 0.1, leave: 0.5 });
    let hold: &RandomHold = network.delays[second[2].delay].downcast().unwrap();
    assert_eq!((hold.value_s(), hold.hold_s()), ([0.05, 0.4], [0.1, 0.8]));
    let swing = &network.delays[first[2].delay];
    for t in [0.0, 0.4, 2.9] {
        let wanted = 0.2 + 0.1 * (2.0 * std::f64::consts::PI * t / 3.0_f64).sin();
        assert!((swing.value(t) - wanted).abs() < 1e-15);
    }
    assert_eq!((first[0].weight, first[2].weight), (Weight::Formula(0), Weight::Formula(1)));
    assert_eq!(network.weight_at(first[2].weight, 0.0), 2.0);
    // A formula without t is a number.
    let number = super::links::network(&changed("weight = 1.0", "weight = \"2*pi\""));
    assert_eq!(number.schedule.graphs[0][0].weight, Weight::Constant(2.0 * std::f64::consts::PI));
}

/// What to put in the place of the saw-tooth, the first line of the error, and a part of the help.
type Case = (&'static str, &'static str, &'static str);

#[rustfmt::skip]
const CASES: &[Case] = &[
    // Formulas.
    ("formula_s = 0.2", "test.toml:29:19: found 0.2 where a text in quotes should stand", ""),
    ("formula_s = \"\"", "test.toml:29:20: the formula is empty", "a formula in t is for example"),
    ("formula_s = \"0.2 + sine(t)\"", "test.toml:29:26: there is no function `sine`", "did you mean `sin`?"),
    ("formula_s = \"0.2 + 0.1*sin(2*pi*time/3)\"", "test.toml:29:39: there is no `time` in a formula", "there are `t`, `pi`"),
    ("formula_s = \"0.2 + 2t\"", "test.toml:29:27: found \"t\" in a formula where an operator (+ - * / ^) or the end should stand", "products are written with a star"),
    ("formula_s = \"0.2*(t + 1\"", "test.toml:29:24: this parenthesis is not closed", ""),
    ("formula_s = \"floor(t)\"", "test.toml:29:20: `floor` jumps, but formulas are continuous", "`delay.piecewise_constant`"),
    ("formula_s = \"t > 2\"", "test.toml:29:22: `>` jumps, but formulas are continuous", "`delay.piecewise_constant`"),
    ("formula_s = \"2^t\"", "test.toml:29:22: the exponent changes with t", "exponents are constant"),
    ("formula_s = \"0.1*sin(t)\"", "test.toml:29:19: `formula_s` is -0.000840725 at t = 3.15 s, but must not be negative", "`max(0, …)`"),
    ("formula_s = \"1/(t - 3.333)\"", "test.toml:29:19: `formula_s` is -0.30003 at t = 0 s, but must not be negative", "`max(0, …)`"),
    ("formula_s = \"sqrt(t - 1)\"", "test.toml:29:19: `formula_s` has no finite value at t = 0 s", "a formula that is finite at all times"),
    ("formula_s = \"1/abs(t - 3.3331)\"", "test.toml:29:19: `formula_s` must not be negative, but could only be shown to lie between -inf and inf until the end of the run at 10 s", "`max(0, …)`"),
    ("formula_s = \"1 - 2\"", "test.toml:29:19: `formula_s` is -1, but must not be negative", ""),
    ("formula_s = \"1/0\"", "test.toml:29:19: `formula_s` is NaN, but must have a finite value", ""),
    // Random holds.
    ("random_hold = { value_s = [0.1, 0.2], hold_s = [1, 2] }", "test.toml:29:21: the key `seed` is missing", ""),
    ("random_hold = { seed = 1, value_s = [0.3, 0.2], hold_s = [1, 2] }", "test.toml:29:44: `value_s` is 0.3, but must not exceed the largest, which is 0.2", ""),
    ("random_hold = { seed = 1, value_s = [-0.1, 0.2], hold_s = [1, 2] }", "test.toml:29:44: `value_s` is -0.1, but must not be negative", ""),
    ("random_hold = { seed = 1, value_s = [0.1, 0.2], hold_s = [0, 2] }", "test.toml:29:65: `hold_s` is 0, but must be positive", ""),
    ("random_hold = { seed = 1, value_s = [0.1, 0.2], hold_s = [1, 2, 3] }", "test.toml:29:64: found a list of 3 where 2 are needed", ""),
    ("random_hold = { seed = 1, value_s = [0.1, 0.2], hold_s = [1e-9, 1e-9] }", "test.toml:32:10: about 1e10 jumps of the delay until the end of the run, but at most 5000000 are accepted", "is a unit of time mistaken?"),
    // Packets.
    ("packets = { latency_s = 0.1, seed = 1 }", "test.toml:29:17: the key `period_s` is missing", ""),
    ("packets = { period_s = 0.1, seed = 1 }", "test.toml:29:17: the key `latency_s` is missing", ""),
    ("packets = { period_s = 0.1, latency_s = 0.1 }", "test.toml:29:17: the key `seed` is missing", ""),
    ("packets = { period_s = 0, latency_s = 0.1, seed = 1 }", "test.toml:29:30: `period_s` is 0, but must be positive", ""),
    ("packets = { period_s = 1e-7, latency_s = 0.1, seed = 1 }", "test.toml:32:10: about 1e8 packets until the end of the run, but at most 5000000 are accepted", "is a unit of time mistaken?"),
    ("packets = { period_s = 0.1, first_s = 0.2, latency_s = 0.1, seed = 1 }", "test.toml:29:45: `first_s` is 0.2, but must be from 0 to 0.1", ""),
    ("packets = { period_s = 0.1, latency_s = -0.1, seed = 1 }", "test.toml:29:47: `latency_s` is -0.1, but must not be negative", ""),
    ("packets = { period_s = 0.1, latency_s = 0, jitter_s = -1, seed = 1 }", "test.toml:29:61: `jitter_s` is -1, but must not be negative", ""),
    ("packets = { period_s = 0.1, latency_s = 0, seed = -1 }", "test.toml:29:57: `seed` is -1, but must not be negative", ""),
    ("packets = { period_s = 0.1, latency_s = 0, seed = 1, lost = 0.1 }", "test.toml:29:60: unknown key `lost`", "did you mean `loss`?"),
    ("packets = { period_s = 0.1, latency_s = 0, seed = 1, loss = 0.1 }", "test.toml:29:67: found 0.1 where a choice of random, bursts should stand", "say which it is, behind the key and a dot, such as `.random = …`"),
    ("packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.burst = {} }", "test.toml:29:65: unknown choice `burst`", "did you mean `bursts`?"),
    ("packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.random = { probability = 1.1 } }", "test.toml:29:90: `probability` is 1.1, but must be from 0 to 1", ""),
    ("packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.random = { probability = 0.1, most_consecutive = 0 } }", "test.toml:29:114: `most_consecutive` is 0, but must be from 1 to 1000000", ""),
    ("packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.bursts = { enter = -0.1, leave = 0.1 } }", "test.toml:29:84: `enter` is -0.1, but must be from 0 to 1", ""),
    ("packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.bursts = { enter = 0.1, leave = 0 } }", "test.toml:29:97: `leave` is 0, but must be positive", ""),
    ("packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.bursts = { enter = 0.1 } }", "test.toml:29:74: the key `leave` is missing", ""),
    // Logs, without a folder to look in.
    ("log = \"packets.csv\"", "test.toml:29:13: found \"packets.csv\" where a table of file should stand", ""),
    ("log = {}", "test.toml:29:13: the key `file` is missing", ""),
    ("log.file = \"packets.csv\"", "test.toml:29:18: cannot read the table `packets.csv`: there is no such file", ""),
    ("log.file = \"radio-log.csv\"", "test.toml:35:10: the log `radio-log.csv` has no packet from `arm-2` to `cart`", "every edge of the network needs at least one row"),
];

/// What to put in the place of the weight, and the same.
#[rustfmt::skip]
const WEIGHTS: &[Case] = &[
    ("\"1 + sin(t)*2\"", "test.toml:28:10: `weight` is -0.0083171 at t = 3.67 s, but must be positive", "`max(0.1, …)`"),
    ("\"sin(t)\"", "test.toml:28:10: `weight` is 0, or rounds to it, at t = 0 s, but must be positive", "`max(0.1, …)`"),
    ("\"heavy\"", "test.toml:28:11: there is no `heavy` in a formula", "there are `t`"),
    ("\"0\"", "test.toml:28:10: `weight` is 0, but must be positive", ""),
    ("\"0.1 + 0.2 - 0.3\"", "test.toml:28:10: `weight` is 0, but must be positive", ""),
    ("\"log(0)\"", "test.toml:28:10: `weight` is NaN, but must have a finite value", ""),
    ("\"\\u0031 + q\"", "test.toml:28:10: there is no `q` in a formula", "there are `t`"),
    ("[1]", "test.toml:28:10: found a list where a number or a formula in t in quotes should stand", ""),
    ("true", "test.toml:28:10: found true where a number or a formula in t in quotes should stand", ""),
];

#[test]
fn every_mistake_in_a_link_is_reported_at_its_place() {
    const SAW_TOOTH: &str = "delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }";
    let links = CASES.iter().map(|case| (changed(SAW_TOOTH, &format!("delay.{}", case.0)), case));
    let weights = WEIGHTS.iter().map(|case| (changed("weight = 1.0", &format!("weight = {}", case.0)), case));
    as_stated(links.chain(weights).map(|(text, (to, line, help))| ((*to).to_owned(), read(&text), *line, *help)));
}

#[test]
fn one_edge_is_one_link() {
    let other = "edges = [[\"cart-1\", \"cart-2\"], [\"cart-2\", \"cart-3\"]";
    let differs = LINKS.replace(
        other,
        "edges = [{ from = \"cart-1\", to = \"cart-2\", delay.packets = { period_s = 1, latency_s = 0, seed = 1 } }",
    );
    assert_ne!(differs, LINKS);
    let error = read(&differs).unwrap_err();
    assert_eq!(
        error.to_string(),
        "test.toml:19:44: the edge from `cart-1` to `cart-2` has other packets in another graph, but it is one link"
    );
}

/// [`LINKS`] with a log beside it for the edges that hear packets.
fn logged(log: &str) -> Result<Scenario, ScenarioError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("radio.csv"), log).unwrap();
    crate::seeds::keep("csv", log);
    let text =
        replayed("radio.csv").replace(", { from = \"cart-4\", to = \"cart-2\", delay.log.file = \"radio.csv\" }", "");
    beside(&text, folder.path())
}

fn beside(text: &str, folder: &Path) -> Result<Scenario, ScenarioError> {
    read_scenario("test", &SourceText::new("test.toml", text), Some(folder))
}

/// [`LINKS`] with a log in the place of its packets.
fn replayed(file: &str) -> String {
    let log = format!("log.file = \"{file}\"");
    let network = "packets = { period_s = 0.05, first_s = 0.01, latency_s = 0.03, jitter_s = 0.2, seed = 5, loss.random = { probability = 0.2 } }";
    let edge = "packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.bursts = { enter = 0.1, leave = 0.5, most_consecutive = 3 } }";
    assert!(LINKS.contains(network) && LINKS.contains(edge));
    LINKS.replace(network, &log).replace(edge, &log)
}

const LOG: &str =
    "from,to,send_s,delay_s\ncart-1,cart-2,0.5,0.1\ncart-2,cart-3,1,\ncart-3,cart-4,2,0.25\ncart-1,cart-2,0.25,1e-2\n";

#[test]
fn a_log_is_read_in_any_order() {
    let scenario = logged(LOG).unwrap_or_else(|error| panic!("{error}"));
    let network = &scenario.setup.network;
    let edge = network.schedule.graphs[0][0];
    let packet = |send_s, delay_s| Packet { send_s, delay_s: Some(delay_s) };
    let trace = Trace::new(vec![packet(0.25, 0.01), packet(0.5, 0.1)], 3.0).unwrap();
    assert_eq!(network.delays[edge.delay], Delay::new(trace));
    // Nothing arrives on one of them.
    let said: Vec<String> = scenario.notices.iter().map(Notice::to_string).collect();
    assert_eq!(said, ["no packet of cart-2 → cart-3 arrives before the end of the run: the initial message is heard"]);
    let more = format!("{LOG}cart-4,cart-3,0,0\nsensor-9,cart-1,0,0\ncart-4,cart-3,1,0\n");
    let said: Vec<String> = logged(&more).unwrap().notices.iter().map(Notice::to_string).collect();
    assert_eq!(said.len(), 2);
    let unused = "the packets of cart-4 → cart-3 and sensor-9 → cart-1 in `radio.csv` are not used: the network has no such edge";
    assert_eq!(said[0], unused);
}

#[rustfmt::skip]
const LOGS: &[Case] = &[
    ("", "radio.csv: the table is empty", "they are `from`, `to`, `send_s`, `delay_s`"),
    ("from,to,send_s\ncart-1,cart-2,0\n", "radio.csv: the column `delay_s` is missing", "they are `from`, `to`, `send_s`, `delay_s`"),
    ("from,to,delay_s\ncart-1,cart-2,0\n", "radio.csv:1:1: the column `send_s` is missing", "they are `from`, `to`, `send_s`, `delay_s`"),
    ("from,to,sent_s,delay_s\n", "radio.csv:1:9: unknown column `sent_s`", "did you mean `send_s`?"),
    ("from,to,send_s,delay_s\ncart-1,cart-2,,0.1\n", "radio.csv:2:15: `send_s` is empty", ""),
    ("from,to,send_s,delay_s\ncart-1,cart-2,0.1,-0.1\n", "radio.csv:2:19: `delay_s` is -0.1, but must not be negative", ""),
    ("from,to,send_s,delay_s\ncart-1,cart-2,-1,0.1\n", "radio.csv:2:15: `send_s` is -1, but must not be negative", ""),
    ("from,to,send_s,delay_s\ncart-1,cart-2,0.1,nan\n", "radio.csv:2:19: nan is not a finite number", ""),
    ("from,to,send_s,delay_s\ncart-1,cart-2,inf,0\n", "radio.csv:2:15: inf is not a finite number", ""),
    ("from,to,send_s,delay_s\ncart-1,cart-2,0.1,1e40\n", "radio.csv:2:19: 1e40 is too large a number", "numbers may be up to 1e30"),
    ("from,to,send_s,delay_s\ncart-1,cart-2,soon,0\n", "radio.csv:2:15: found \"soon\" where a number should stand", ""),
    ("from,to,send_s,delay_s\ncart-1,cart-2,1,0\ncart-2,cart-3,1,0\n cart-1,cart-2,1.0,\n", "radio.csv:4:16: a second packet from `cart-1` to `cart-2` sent at 1 s; the first is on line 2", ""),
    ("from,to,send_s,delay_s\ncart-1,cart-2,1,0\ncart-2,cart-3,1,0\n", "test.toml:16:32: the log `radio.csv` has no packet from `cart-3` to `cart-4`", "every edge of the network needs at least one row"),
];

#[test]
fn every_mistake_in_a_log_is_reported_at_its_place() {
    as_stated(LOGS.iter().map(|(log, line, help)| ((*log).to_owned(), logged(log), *line, *help)));
}

/// The number next to sin π is positive.
#[test]
fn regress_a_weight_that_is_zero_but_for_rounding_is_refused() {
    for zero in ["sin(pi)", "cos(pi/2)", "sqrt(2)^2 - 2"] {
        let said = read(&changed("weight = 1.0", &format!("weight = \"{zero}\""))).unwrap_err().to_string();
        assert!(
            said.starts_with("test.toml:28:10: `weight` must be positive, but could only be shown"),
            "{zero}: {said}"
        );
    }
    for positive in ["sqrt(2)", "1e-12*pi", "0.3 - 0.2"] {
        read(&changed("weight = 1.0", &format!("weight = \"{positive}\""))).unwrap_or_else(|error| panic!("{error}"));
    }
}

fn run(scenario: &Scenario, folder: &Path) -> Outcome {
    stopped_at(scenario, f64::INFINITY, folder)
}

/// A run that is stopped once it has come so far, s.
fn stopped_at(scenario: &Scenario, t_s: f64, folder: &Path) -> Outcome {
    let mut goes_on =
        |progress: Progress| if progress.t_s < t_s { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    let outcome = simulate(&scenario.setup, &mut goes_on).unwrap();
    let verdicts: Report = check(&scenario.setup);
    let record = plain_record(scenario, &outcome, &verdicts);
    let folder = RunFolder::create(folder, false).unwrap();
    write_run(&folder, &record, Options::default()).unwrap();
    outcome
}

#[test]
fn regress_a_run_replayed_from_its_own_log_has_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("first"), folder.path().join("second"));
    let scenario = beside(LINKS, folder.path()).unwrap();
    let outcome = run(&scenario, &first);
    let log = std::fs::read_to_string(first.join("packets.csv")).unwrap();
    assert!(log.starts_with("from,to,send_s,delay_s\ncart-1,cart-2,0.01,"), "{}", &log[..100]);
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(first.join("summary.json")).unwrap()).unwrap();
    let links = summary["links"].as_array().unwrap();
    assert_eq!(links.len(), 4);
    let total = |key: &str| links.iter().map(|link| link[key].as_u64().unwrap()).sum::<u64>();
    assert_eq!(total("sent"), log.lines().count() as u64 - 1);
    assert_eq!(total("lost"), log.lines().filter(|line| line.ends_with(',')).count() as u64);
    assert!(total("lost") > 5 && total("late") > 20, "{summary}");

    std::fs::copy(first.join("packets.csv"), folder.path().join("packets.csv")).unwrap();
    let again = beside(&replayed("packets.csv"), folder.path()).unwrap_or_else(|error| panic!("{error}"));
    assert!(again.notices.is_empty());
    let replay = run(&again, &second);
    assert_eq!(outcome.recording, replay.recording);
    assert_eq!(outcome.statistics.steps, replay.statistics.steps);
    assert_eq!(std::fs::read_to_string(second.join("packets.csv")).unwrap(), log);
    // Of a run that was stopped only what was sent until then is told.
    let third = folder.path().join("third");
    let stopped = stopped_at(&scenario, 0.4 * scenario.setup.time.end_s, &third).ending.before_horizon_s().unwrap();
    let short = std::fs::read_to_string(third.join("packets.csv")).unwrap();
    let times: Vec<f64> = short.lines().skip(1).map(|row| row.split(',').nth(2).unwrap().parse().unwrap()).collect();
    assert!(times.iter().all(|send_s| *send_s <= stopped) && times.iter().any(|send_s| *send_s > stopped - 0.5));
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(third.join("summary.json")).unwrap()).unwrap();
    let sent = summary["links"].as_array().unwrap().iter().map(|link| link["sent"].as_u64().unwrap()).sum::<u64>();
    assert_eq!(sent, times.len() as u64);
    // And it is the packets that make the difference.
    let other = beside(&LINKS.replace("seed = 5", "seed = 6"), folder.path()).unwrap();
    let other = simulate(&other.setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_ne!(outcome.recording, other.recording);
    // A run without packets writes no log.
    let plain = read(&changed("end_s = 10", "end_s = 0.5")).unwrap();
    run(&plain, &folder.path().join("plain"));
    assert!(!folder.path().join("plain/packets.csv").exists());
}

#[test]
fn the_shipped_log_is_that_of_the_run_it_names() {
    let scenario = open_scenario("from-a-log").unwrap();
    let comment = scenario.source.text().lines().find(|line| line.contains("delay.packets")).unwrap();
    let packets = comment.trim_start_matches(['#', ' ']);
    let text = scenario.source.text().replace("delay.log = { file = \"radio-log.csv\" }", packets);
    let drawn = read(&text).unwrap_or_else(|error| panic!("{error}")).setup.network;
    let logged = &scenario.setup.network;
    assert_eq!(drawn.delays.len(), logged.delays.len());
    for (drawn, logged) in drawn.delays.iter().zip(&logged.delays) {
        assert_eq!(drawn.packets().unwrap().packets(), logged.packets().unwrap().packets());
    }
}

/// Phases that are drawn, and random holds: one of a link for all phases, and two that another link has in two phases.
const DRAWN: &str = r#"format = 2
time = { end_s = 4, record_every_s = 0.05 }
[[agents]]
name = "cart"
count = 3
robot.point_mass = { dimension = 2, mass_kg = 2 }
start.position = { random = { seed = 1, within = [-1, 1] } }
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position"
[network]
switching.random = { seed = 4, dwell_s = [0.1, 0.7] }
[[network.link_delays]]
from = "cart-1"
to = "cart-2"
delay.random_hold = { seed = 3, value_s = [0.05, 0.4], hold_s = [0.1, 0.8] }
[[network.phases]]
edges = [["cart-1", "cart-2"], { from = "cart-2", to = "cart-3", delay.random_hold = { seed = 5, value_s = [0, 0.2], hold_s = [0.3, 0.4] } }]
[[network.phases]]
edges = [["cart-1", "cart-2"], { from = "cart-2", to = "cart-3", delay.random_hold = { seed = 6, value_s = [0, 0.3], hold_s = [0.2, 0.9] } }]
[[network.phases]]
edges = [["cart-3", "cart-1"]]
"#;

/// [`DRAWN`] from the tables of its run.
fn from_tables(text: &str) -> String {
    let parts = [
        ("switching.random = { seed = 4, dwell_s = [0.1, 0.7] }", "switching.log.file = \"phases.csv\""),
        ("random_hold = { seed = 3, value_s = [0.05, 0.4], hold_s = [0.1, 0.8] }", "hold_log.file = \"holds.csv\""),
        ("random_hold = { seed = 5, value_s = [0, 0.2], hold_s = [0.3, 0.4] }", "hold_log.file = \"holds.csv\""),
        (
            "random_hold = { seed = 6, value_s = [0, 0.3], hold_s = [0.2, 0.9] }",
            "hold_log = { file = \"holds.csv\", hold = 2 }",
        ),
    ];
    parts.into_iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

#[test]
fn a_run_is_repeated_from_what_was_drawn_for_it() {
    for control in ["", "[control]\nsample_hz = 50\n"] {
        let text = format!("{DRAWN}{control}");
        let folder = tempfile::tempdir().unwrap();
        let drawn = read(&text).unwrap_or_else(|error| panic!("{error}"));
        let first = run(&drawn, &folder.path().join("run"));
        let replay = beside(&from_tables(&text), &folder.path().join("run")).unwrap_or_else(|error| panic!("{error}"));
        assert!(replay.notices.is_empty());
        let again = run(&replay, &folder.path().join("again"));
        // The same break-points, so the same steps and the same bits.
        assert_eq!(first.recording, again.recording);
        assert_eq!(first.statistics.break_points, again.statistics.break_points);
        let phases = std::fs::read_to_string(folder.path().join("run/phases.csv")).unwrap();
        assert!(phases.starts_with("t_s,phase\n0,") && phases.lines().count() > 8, "{phases}");
        let holds = std::fs::read_to_string(folder.path().join("run/holds.csv")).unwrap();
        for link in ["cart-1,cart-2,1,0,", "cart-2,cart-3,1,0,", "cart-2,cart-3,2,0,"] {
            assert!(holds.contains(link), "{holds}");
        }
        // What is replayed is not drawn.
        assert!(!folder.path().join("again/phases.csv").exists() && !folder.path().join("again/holds.csv").exists());
        // What is known for this run alone is not claimed for ever.
        let tables: Vec<bool> =
            replay.setup.network.delays.iter().map(|delay| delay.known().unknown.is_some()).collect();
        assert_eq!(tables.iter().filter(|log| **log).count(), 3);
        let longer = from_tables(&text).replace("end_s = 4", "end_s = 400");
        let refused = beside(&longer, &folder.path().join("run")).unwrap_err().to_string();
        assert!(refused.contains("but the run ends at 400 s"), "{refused}");
    }
}

/// Tables of phases, and of holds, with what they get.
#[rustfmt::skip]
const TABLES: &[(&str, &str, &str)] = &[
    ("phases.csv", "t_s,phase\n0,1\n1,4\n5,\n", "phases.csv:3:3: `phase` is 4, but must be from 1 to 3"),
    ("phases.csv", "t_s,phase\n0,1.5\n5,\n", "phases.csv:2:3: 1.5 is no whole number"),
    ("phases.csv", "t_s,phase\n0.5,1\n5,\n", "phases.csv:2:1: this log does not begin at 0 s"),
    ("phases.csv", "t_s,phase\n5,\n", "phases.csv:2:1: this log does not begin at 0 s"),
    ("phases.csv", "t_s,phase\n0,1\n5,2\n", "phases.csv: this log does not say when it ends"),
    ("phases.csv", "t_s,phase\n0,1\n5,\n6,1\n", "phases.csv:4:1: this comes after the end of the log"),
    ("phases.csv", "t_s,phase\n0,1\n3,\n", "phases.csv:3:1: this log ends at 3 s, but the run ends at 4 s"),
    ("phases.csv", "t_s\n0\n", "phases.csv: the column `phase` is missing"),
    ("holds.csv", "from,to,hold,t_s,delay_s\ncart-1,cart-2,1,0,0.1\ncart-1,cart-2,1,5,\n", "test.toml:18:66: the log `holds.csv` has no hold 1 from `cart-2` to `cart-3`"),
    ("holds.csv", "from,to,hold,t_s,delay_s\ncart-1,cart-2,0,0,0.1\n", "holds.csv:2:15: `hold` is 0, but must be from 1 to 1000000"),
    ("holds.csv", "from,to,hold,t_s,delay_s\ncart-1,cart-2,1,0,-0.1\n", "holds.csv:2:19: `delay_s` is -0.1, but must not be negative"),
    ("holds.csv", "from,to,hold,t_s,delay_s\ncart-1,cart-2,1,0,0.1\n", "holds.csv: this log does not say when it ends"),
    ("holds.csv", "from,to,hold,t_s,delay_s\ncart-1,cart-2,1,0.1,0.1\n", "holds.csv:2:17: this log does not begin at 0 s"),
    ("holds.csv", "from,to,hold,t_s,delay_s\ncart-1,cart-2,1,0,0.1\ncart-1,cart-2,1,1,\n", "holds.csv:3:17: this log ends at 1 s, but the run ends at 4 s"),
];

#[test]
fn every_mistake_in_a_table_of_draws_is_reported_at_its_place() {
    let folder = tempfile::tempdir().unwrap();
    run(&read(DRAWN).unwrap(), &folder.path().join("run"));
    let mut wrong = Vec::new();
    for (file, table, line) in TABLES {
        let own = tempfile::tempdir().unwrap();
        for name in ["phases.csv", "holds.csv"] {
            std::fs::copy(folder.path().join("run").join(name), own.path().join(name)).unwrap();
        }
        std::fs::write(own.path().join(file), table).unwrap();
        crate::seeds::keep("csv", table);
        let found = beside(&from_tables(DRAWN), own.path()).err().map(|error| error.to_string()).unwrap_or_default();
        if !found.ends_with(line) {
            wrong.push(format!("{table:?}: {found:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
