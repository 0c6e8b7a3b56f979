//! Who hears whom, and how late, in a scenario to start from.

use std::fmt::Write;

use super::commented;

/// The graphs of a [`super::Template`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemplateGraph {
    /// One way round.
    Ring,
    /// Both ways between neighbours in a row.
    Path,
    /// Both ways between the first and every other.
    Star,
    /// Everybody hears everybody.
    Complete,
    /// A ring in random order and as many random edges, the same for as many agents always.
    Random,
    /// A ring, of which every other edge is there while the rest is not.
    Switching,
}

/// The delays of a [`super::Template`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemplateDelay {
    /// Always the same.
    Constant,
    /// Growing, then dropping.
    SawTooth,
    /// Packets that are late and get lost, between controllers that sample.
    Radio,
    /// None.
    None,
}

/// Who is heard and who hears, counted from one.
type Edge = (u32, u32);

/// The lines of the network, and of the controllers where they sample.
pub(super) fn text(name: &str, agents: u32, graph: TemplateGraph, delay: TemplateDelay, leader: bool) -> String {
    let control = match delay {
        TemplateDelay::Radio => {
            let sampling = commented("sample_hz = 500", "how often each controller measures and computes");
            format!(
                "# Controllers as they are deployed; without this table they work in continuous time.\n[control]\n{sampling}\n"
            )
        }
        TemplateDelay::Constant | TemplateDelay::SawTooth | TemplateDelay::None => String::new(),
    };
    let weight = commented("weight = 1.0", "of every edge that has none of its own");
    let delay = match delay {
        TemplateDelay::Constant => commented("delay.constant_s = 0.2", "what is heard is this old, in s"),
        TemplateDelay::SawTooth => {
            let line = "delay.saw_tooth = { min_s = 0.05, max_s = 0.4, period_s = 0.6 }";
            format!("# What is heard grows older until the next message arrives.\n{line}\n")
        }
        TemplateDelay::Radio => {
            let line = "delay.packets = { period_s = 0.02, latency_s = 0.02, jitter_s = 0.06, seed = 11, loss.bursts = { enter = 0.04, leave = 0.2 } }";
            format!("# Packets overtake each other, and one in six is lost.\n{line}\n")
        }
        TemplateDelay::None => commented("# delay.constant_s = 0.2", "messages arrive at once"),
    };
    // Whom the leader is heard by, first of all.
    let list = |first: u32, edges: &[Edge]| {
        let led = leader.then(|| format!("[\"leader\", \"{name}-{first}\"]"));
        let edges = edges.iter().map(|(from, to)| format!("[\"{name}-{from}\", \"{name}-{to}\"]"));
        let mut text = commented("edges = [", "[who is heard, who hears]");
        for edge in led.into_iter().chain(edges) {
            // Writing to a string does not fail.
            let _ = writeln!(text, "    {edge},");
        }
        text + "]\n"
    };
    let edges = edges(graph, agents);
    let head = format!("[network]\n{weight}{delay}");
    match graph {
        TemplateGraph::Switching => {
            let phase = |first: u32, now: &[Edge]| {
                format!(
                    "\n[[network.phases]]\n{}{}",
                    commented("dwell_s = 1.0", "then comes the next phase, in turn"),
                    list(first, now)
                )
            };
            // A leader has to reach everybody in each phase, others over both.
            let [one, other]: [Vec<Edge>; 2] = if leader {
                [(1..agents).map(|k| (k, k + 1)).collect(), (1..agents).rev().map(|k| (k + 1, k)).collect()]
            } else {
                [1, 0].map(|odd| edges.iter().copied().filter(|(from, _)| from % 2 == odd).collect())
            };
            let phases = phase(1, &one) + &phase(agents, &other);
            format!("{control}# Who hears whom, and how late: phases in turn.\n{head}{phases}")
        }
        _ => {
            let says = "# Who hears whom, and how late; [[network.phases]] in place of edges make it switch.";
            format!("{control}{says}\n{head}{}", list(1, &edges))
        }
    }
}

fn edges(graph: TemplateGraph, agents: u32) -> Vec<Edge> {
    let all = 1..=agents;
    let others = |(from, to): &Edge| from != to;
    match graph {
        TemplateGraph::Ring | TemplateGraph::Switching => all.map(|k| (k, k % agents + 1)).filter(others).collect(),
        TemplateGraph::Path => (1..agents).flat_map(|k| [(k, k + 1), (k + 1, k)]).collect(),
        TemplateGraph::Star => (2..=agents).flat_map(|k| [(1, k), (k, 1)]).collect(),
        TemplateGraph::Complete => {
            let hears = |to| (1..=agents).map(move |from| (from, to));
            all.flat_map(hears).filter(others).collect()
        }
        TemplateGraph::Random => random(agents),
    }
}

/// A ring in random order, through which everybody hears of everybody, and as many edges more as are not there already.
fn random(agents: u32) -> Vec<Edge> {
    // Knuth's linear congruential generator, whose high bits are good enough for an example.
    let mut state = u64::from(agents);
    let mut below = |bound: u32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % u64::from(bound.max(1))) as u32
    };
    let mut order: Vec<u32> = (1..=agents).collect();
    for k in (1..agents).rev() {
        order.swap(k as usize, below(k + 1) as usize);
    }
    let next = order.iter().cycle().skip(1);
    let mut edges: Vec<Edge> = order.iter().copied().zip(next.copied()).collect();
    for _ in 0..agents {
        let edge = (1 + below(agents), 1 + below(agents));
        if edge.0 != edge.1 && !edges.contains(&edge) {
            edges.push(edge);
        }
    }
    edges
}
