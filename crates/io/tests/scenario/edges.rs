//! Edges by rule and from tables are the edges one would write by hand.

use std::path::Path;

use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Scenario, ScenarioError, read_scenario};
use forwardstep_sim::Network;
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::graph::{SpanningTree, neighbours, spanning_tree};
use miette::Diagnostic;
use tempfile::TempDir;

use super::{as_stated, changed, read};

/// Every rule once, but for tables, which need a folder.
pub(super) const RULES: &str = r#"format = 2
time = { end_s = 2 }
[[agents]]
name = "cart"
count = 5
parameter_variation = { seed = 2, relative = 0.3 }
robot.point_mass = { dimension = 1, mass_kg = 2 }
start.position = { random = { seed = 1, within = [-1, 1] } }
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position"
[network]
delay.constant_s = 0.1
switching = "repeat"
[[network.phases]]
dwell_s = 0.5
edges.ring = { direction = "both", among = ["cart-1", "cart-3", "cart-5"], weight = 0.5 }
[[network.phases]]
dwell_s = 0.5
edges.path.delay.saw_tooth = { min_s = 0.1, max_s = 0.2, period_s = 0.3 }
[[network.phases]]
dwell_s = 0.5
edges.star = { centre = "cart-2", direction = "both" }
[[network.phases]]
dwell_s = 0.5
edges.random = { in_degree = 2, seed = 3 }
[[network.phases]]
dwell_s = 0.5
edges.complete = {}
[[network.phases]]
dwell_s = 0.5
edges = [["cart-1", "cart-2"]]
"#;

/// The sound scenario with other edges in its first phase.
fn network(edges: &str) -> Network {
    let text = changed("edges = [[\"arm-1\", \"arm-2\"]]", edges);
    read(&text).unwrap_or_else(|error| panic!("{edges}: {error}")).setup.network
}

#[test]
fn rules_are_the_lists_one_would_write() {
    let cases = [
        ("edges.ring = {}", r#"[["arm-1", "arm-2"], ["arm-2", "cart"], ["cart", "arm-1"]]"#),
        (r#"edges.ring = { among = ["cart", "arm-1"] }"#, r#"[["cart", "arm-1"], ["arm-1", "cart"]]"#),
        (
            r#"edges.ring.direction = "both""#,
            r#"[["arm-1", "arm-2"], ["arm-2", "arm-1"], ["arm-2", "cart"], ["cart", "arm-2"], ["cart", "arm-1"], ["arm-1", "cart"]]"#,
        ),
        ("edges.path = {}", r#"[["arm-1", "arm-2"], ["arm-2", "cart"]]"#),
        (
            r#"edges.path = { direction = "both", among = ["cart", "arm-1"], weight = 3 }"#,
            r#"[{ from = "cart", to = "arm-1", weight = 3 }, { from = "arm-1", to = "cart", weight = 3 }]"#,
        ),
        (r#"edges.path.among = ["cart"]"#, "[]"),
        (r#"edges.star.centre = "arm-2""#, r#"[["arm-2", "arm-1"], ["arm-2", "cart"]]"#),
        (r#"edges.star = { centre = "cart", direction = "in" }"#, r#"[["arm-1", "cart"], ["arm-2", "cart"]]"#),
        (
            r#"edges.star = { centre = "cart", direction = "both", among = ["arm-2"] }"#,
            r#"[["cart", "arm-2"], ["arm-2", "cart"]]"#,
        ),
        (r#"edges.star = { centre = "cart", among = ["arm-2", "cart"] }"#, r#"[["cart", "arm-2"]]"#),
        (
            "edges.complete.delay.constant_s = 0.3",
            r#"[
                { from = "arm-2", to = "arm-1", delay.constant_s = 0.3 }, { from = "cart", to = "arm-1", delay.constant_s = 0.3 },
                { from = "arm-1", to = "arm-2", delay.constant_s = 0.3 }, { from = "cart", to = "arm-2", delay.constant_s = 0.3 },
                { from = "arm-1", to = "cart", delay.constant_s = 0.3 }, { from = "arm-2", to = "cart", delay.constant_s = 0.3 },
            ]"#,
        ),
        (r#"edges.complete.among = ["cart", "arm-2"]"#, r#"[["arm-2", "cart"], ["cart", "arm-2"]]"#),
        (
            "edges.random = { in_degree = 2, seed = 9 }",
            r#"[["arm-2", "arm-1"], ["cart", "arm-1"], ["arm-1", "arm-2"], ["cart", "arm-2"], ["arm-1", "cart"], ["arm-2", "cart"]]"#,
        ),
    ];
    for (rule, list) in cases {
        assert_eq!(network(rule), network(&format!("edges = {list}")), "{rule}");
    }
}

#[test]
fn random_graphs_give_everybody_as_many_neighbours() {
    let random = |in_degree: usize, seed: u64| {
        let rule = format!("edges.random = {{ in_degree = {in_degree}, seed = {seed} }}");
        fixed(&rule, 40).unwrap_or_else(|error| panic!("{error}")).setup.network
    };
    for in_degree in [1, 3, 39] {
        let network = random(in_degree, 4);
        let edges = network.schedule.graph(0);
        assert!((0..40).all(|i| neighbours(edges, i).count() == in_degree));
        assert_eq!(network.validate(10.0), Ok(()));
    }
    assert_eq!(random(3, 4), random(3, 4));
    assert_ne!(random(3, 4), random(3, 5));
}

/// Carts in a network that does not switch.
fn fixed(edges: &str, count: usize) -> Result<Scenario, ScenarioError> {
    let carts = RULES.split_once("switching").unwrap().0;
    read(&format!("{}{edges}\n", carts.replace("count = 5", &format!("count = {count}"))))
}

#[test]
fn large_rings_are_read_at_once() {
    let began = std::time::Instant::now();
    let setup = fixed("edges.ring = {}", 200).unwrap_or_else(|error| panic!("{error}")).setup;
    let took_s = began.elapsed().as_secs_f64();
    assert!(took_s < 0.5, "{took_s} s");
    let edges = setup.network.schedule.graph(0);
    assert_eq!((setup.agents.len(), edges.len()), (200, 200));
    assert_eq!(spanning_tree(200, edges), SpanningTree::Rooted { roots: (0..200).collect() });
}

#[test]
fn more_edges_than_fit_are_refused() {
    let error = fixed("edges.complete = {}", 2000).unwrap_err();
    assert_eq!(error.to_string(), "test.toml:14:1: there are 3998000 edges, but at most 1000000 are accepted");
}

/// The sound scenario with the edges of a table beside it.
fn tabled(table: &str) -> (TempDir, Result<Scenario, ScenarioError>) {
    crate::seeds::keep("csv", table);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("edges.csv"), table).unwrap();
    let scenario = beside("edges.csv", folder.path());
    (folder, scenario)
}

fn beside(name: &str, folder: &Path) -> Result<Scenario, ScenarioError> {
    let text = changed("edges = [[\"arm-1\", \"arm-2\"]]", &format!("edges.csv.file = \"{name}\""));
    read_scenario("test", &SourceText::new("test.toml", text), Some(folder))
}

#[test]
fn tables_are_the_lists_one_would_write() {
    let cases = [
        ("from,to\narm-1,arm-2\ncart,arm-1\n", r#"[["arm-1", "arm-2"], ["cart", "arm-1"]]"#),
        ("from,to\n", "[]"),
        (
            "delay_s, to, from, weight\r\n0.3,arm-2,cart,\r\n\r\n,\"arm-1\",cart,2.5\r\n",
            r#"[{ from = "cart", to = "arm-2", delay.constant_s = 0.3 }, { from = "cart", to = "arm-1", weight = 2.5 }]"#,
        ),
    ];
    for (table, list) in cases {
        let (_folder, scenario) = tabled(table);
        let network = scenario.unwrap_or_else(|error| panic!("{table}: {error}")).setup.network;
        assert_eq!(network, self::network(&format!("edges = {list}")), "{table}");
    }
}

#[test]
fn equal_delays_of_a_table_are_one() {
    let (_folder, scenario) =
        tabled("from,to,delay_s\narm-1,arm-2,0.2\narm-2,arm-1,0.20\ncart,arm-1,0\narm-1,cart,-0\n");
    let delays = scenario.unwrap_or_else(|error| panic!("{error}")).setup.network.delays;
    assert_eq!(delays[..2], [Delay::constant(0.2), Delay::constant(0.0)]);
    assert!(delays.len() == 3 && delays[2].downcast::<SawTooth>().is_some(), "that of the other phase: {delays:?}");
}

/// A table, the first line of the error after the folder, and a part of the help.
type Case = (&'static str, &'static str, &'static str);

#[rustfmt::skip]
const CASES: &[Case] = &[
    ("", "edges.csv: the table is empty", "the first line names the columns; they are `from`, `to`, `weight`, `delay_s`"),
    ("arm-1,arm-2\n", "edges.csv:1:1: unknown column `arm-1`", "the first line names the columns; they are `from`"),
    ("\0from,to\n", "edges.csv:1:1: unknown column `\\0from`", "did you mean `from`?"),
    ("from,to\n\u{1b}[31m,\u{202e}\n", "edges.csv:2:1: there is no agent `\\u{1b}[31m`", "agents are"),
    ("form,to\n", "edges.csv:1:1: unknown column `form`", "did you mean `from`?"),
    ("from,to,delay\n", "edges.csv:1:9: unknown column `delay`", "did you mean `delay_s`?"),
    ("from,weight\n", "edges.csv:1:1: the column `to` is missing", "they are `from`, `to`"),
    ("from,to,to\n", "edges.csv:1:9: a second column is named `to`", ""),
    ("from,to\narm-1\n", "edges.csv:2:1: this line has 1 entry, but there are 2 columns", ""),
    ("from,to\narm-1,arm-2,1\n", "edges.csv:2:1: this line has 3 entries, but there are 2 columns", ""),
    ("from,to\narm-1,\n", "edges.csv:2:7: `to` is empty", ""),
    ("from,to\narm-1,\"arm-2\n", "edges.csv:2:7: this quotation mark is not closed on its line", "written twice"),
    ("from,to\n\"arm-1\"x,arm-2\n", "edges.csv:2:8: found \"x,arm-2\" behind a cell in quotation marks, where a comma or the end of the line should stand", ""),
    ("from,to\narm-1,arm-2\narm-1, amr-2\n", "edges.csv:3:8: there is no agent `amr-2`", "did you mean `arm-2`?"),
    ("from,to\ncart,cart\n", "edges.csv:2:1: `cart` cannot hear itself", ""),
    ("from,to\ncart,arm-1\n\ncart,arm-1\n", "edges.csv:4:1: a second edge from `cart` to `arm-1` in one graph; the first is on line 2", ""),
    ("from,to,weight\ncart,arm-1,heavy\n", "edges.csv:2:12: there is no `heavy` in a formula", "there are `t`, `pi`, `e`, `sin`"),
    ("from,to,weight\ncart,arm-1,\"max(0, t)\"\n", "edges.csv:2:12: `weight` is 0, or rounds to it, at t = 0 s, but must be positive", "max(0.1, …)"),
    ("from,to,weight\ncart,arm-1,1 + sn(t)\n", "edges.csv:2:16: there is no function `sn`", "did you mean `sin`?"),
    ("from,to,weight\ncart,arm-1,0\n", "edges.csv:2:12: `weight` is 0, but must be positive", ""),
    ("from,to,weight\ncart,arm-1,inf\n", "edges.csv:2:12: inf is not a finite number", ""),
    ("from,to,weight\ncart,arm-1,1e31\n", "edges.csv:2:12: 1e31 is too large a number", "numbers may be up to 1e30 in size"),
    ("from,to,delay_s\ncart,arm-1,-0.1\n", "edges.csv:2:12: `delay_s` is -0.1, but must not be negative", ""),
];

#[test]
fn every_mistake_in_a_table_is_reported_at_its_place() {
    as_stated(CASES.iter().map(|(table, line, help)| {
        let (_folder, scenario) = tabled(table);
        ((*table).to_owned(), scenario, *line, *help)
    }));
}

#[test]
fn regress_a_long_cell_is_not_quoted_whole() {
    for table in [format!("{}\n", "x".repeat(10_000)), format!("from,to\n{},cart\n", "é".repeat(10_000))] {
        let (_folder, scenario) = tabled(&table);
        let message = scenario.unwrap_err().to_string();
        assert!(message.len() < 2200 && message.contains('…'), "{message}");
    }
}

#[test]
fn tables_with_other_names_are_offered() {
    let (folder, _) = tabled("from,to\n");
    let error = beside("edge.csv", folder.path()).unwrap_err();
    assert_eq!(error.to_string(), "test.toml:32:18: cannot read the table `edge.csv`: there is no such file");
    assert!(error.help().unwrap().to_string().starts_with("did you mean `edges.csv`?"));
}

/// Two phases that share an edge, which says nothing of its delay.
const SHARED: &str = r#"format = 2
time = { end_s = 10 }
[[agents]]
name = "cart"
count = 3
robot.point_mass = { dimension = 1, mass_kg = 2 }
[reference.consensus]
roots_per_s = [1]
exchange = "position_velocity"
[network]
delay.constant_s = 0.1
[[network.link_delays]]
from = "cart-1"
to = "cart-2"
delay.random_hold = { seed = 3, value_s = [0.05, 0.4], hold_s = [0.1, 0.8] }
[[network.phases]]
dwell_s = 1
edges = [["cart-1", "cart-2"], ["cart-2", "cart-3"]]
[[network.phases]]
dwell_s = 2
edges.ring = {}
[[network.phases]]
dwell_s = 2
edges = [["cart-2", "cart-1"], { from = "cart-3", to = "cart-1", delay.constant_s = 0.3 }]
"#;

/// The table of the delay in [`SHARED`].
const OF_LINK: &str = "[[network.link_delays]]\nfrom = \"cart-1\"\nto = \"cart-2\"\ndelay.random_hold = { seed = 3, value_s = [0.05, 0.4], hold_s = [0.1, 0.8] }\n";

#[test]
fn the_delay_of_a_link_holds_in_every_phase_that_has_it() {
    let network = read(SHARED).unwrap_or_else(|error| panic!("{error}")).setup.network;
    let [first, ring, last] = &network.schedule.graphs[..] else { panic!() };
    let of = |edges: &[forwardstep_sim::graph::Edge], ends| {
        let edge = edges.iter().find(|edge| (edge.from, edge.to) == ends).unwrap();
        (edge.delay, network.delays[edge.delay].clone())
    };
    // Drawn once: the same delay, not two that look alike.
    assert_eq!(of(first, (0, 1)), of(ring, (0, 1)));
    assert!(of(first, (0, 1)).1.downcast::<forwardstep_sim::delay::RandomHold>().is_some());
    // A link is directed, and all others keep the delay of the network or their own.
    for (edges, ends, s) in [(first, (1, 2), 0.1), (ring, (2, 0), 0.1), (last, (1, 0), 0.1), (last, (2, 0), 0.3)] {
        assert_eq!(of(edges, ends).1, forwardstep_sim::delay::Delay::constant(s), "{ends:?}");
    }
    // The same as if every edge had it of its own.
    let own = "{ from = \"cart-1\", to = \"cart-2\", delay.random_hold = { seed = 3, value_s = [0.05, 0.4], hold_s = [0.1, 0.8] } }";
    let spelled = SHARED.replace(OF_LINK, "").replace("[[\"cart-1\", \"cart-2\"]", &format!("[{own}"));
    let ring_spelled = format!("edges = [{own}, [\"cart-2\", \"cart-3\"], [\"cart-3\", \"cart-1\"]]");
    let spelled = spelled.replace("edges.ring = {}", &ring_spelled);
    let spelled = read(&spelled).unwrap_or_else(|error| panic!("{error}")).setup.network;
    let delays = |network: &forwardstep_sim::Network| -> Vec<_> {
        let edges = network.schedule.graphs.iter().flatten();
        edges.map(|edge| ((edge.from, edge.to), network.delays[edge.delay].clone())).collect()
    };
    let sorted = |mut all: Vec<((usize, usize), _)>| {
        all.sort_by_key(|(ends, _)| *ends);
        all
    };
    assert_eq!(sorted(delays(&network)), sorted(delays(&spelled)));
    assert_eq!(network.delays.len(), 3);
}

#[test]
fn a_delay_of_a_link_that_no_graph_has_is_a_notice() {
    let text = SHARED.replace("to = \"cart-2\"\ndelay.random", "to = \"cart-3\"\ndelay.random");
    let said: Vec<String> = read(&text).unwrap().notices.iter().map(ToString::to_string).collect();
    assert_eq!(said, ["`link_delays` states a delay for cart-1 → cart-3, but the network has no such edge"]);
    assert!(read(SHARED).unwrap().notices.is_empty());
    // A graph that never changes may have them too.
    let fixed = format!("{}edges.ring = {{}}\n{OF_LINK}", SHARED.split_once("[[network.link").unwrap().0);
    let network = read(&fixed).unwrap_or_else(|error| panic!("{error}")).setup.network;
    assert_eq!(network.delays.len(), 2);
}

#[rustfmt::skip]
const LINK_DELAYS: &[super::Case] = &[
    ("edges = [[\"cart-1\", \"cart-2\"]", "edges = [{ from = \"cart-1\", to = \"cart-2\", delay.constant_s = 0.3 }",
        "test.toml:18:44: the delay of the link from `cart-1` to `cart-2` is stated in `link_delays` on line 12 already", "leave one of the two statements out"),
    ("edges.ring = {}", "edges.ring.delay.constant_s = 0.1",
        "test.toml:21:12: the delay of the link from `cart-1` to `cart-2` is stated in `link_delays` on line 12 already", "leave one of the two statements out"),
    ("[[network.phases]]\ndwell_s = 1\n", "[[network.link_delays]]\nfrom = \"cart-1\"\nto = \"cart-2\"\ndelay.constant_s = 0.2\n[[network.phases]]\ndwell_s = 1\n",
        "test.toml:16:1: the delay of the link from `cart-1` to `cart-2` is stated in `link_delays` on line 12 already", "leave one of the two statements out"),
    ("to = \"cart-2\"\ndelay.random_hold", "to = \"cart-1\"\ndelay.random_hold",
        "test.toml:12:1: `cart-1` cannot hear itself", ""),
    ("to = \"cart-2\"\ndelay.random_hold", "to = \"cart-4\"\ndelay.random_hold",
        "test.toml:14:6: there is no agent `cart-4`", "did you mean `cart-1`?"),
    ("delay.random_hold = { seed = 3, value_s = [0.05, 0.4], hold_s = [0.1, 0.8] }", "delay.constant_s = -1",
        "test.toml:15:20: `constant_s` is -1, but must not be negative", ""),
    ("delay.random_hold = { seed = 3, value_s = [0.05, 0.4], hold_s = [0.1, 0.8] }", "",
        "test.toml:12:1: the key `delay` is missing", ""),
];

#[test]
fn a_delay_that_is_stated_twice_is_refused_with_both_places() {
    super::refused(SHARED, LINK_DELAYS);
}
