//! Pictures of the network: its edges over time, its graphs, its delays.

use std::f64::consts::TAU;

use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::Extent;
use forwardstep_sim::setup::Setup;
use maud::{Markup, html};
use serde::Serialize;

use super::super::packets::Link;
use super::super::record::RunRecord;
use super::super::text;
use super::super::timeline::Timeline;

/// With more edges, a row stands for everything that one agent hears.
const MOST_EDGE_ROWS: usize = 40;
/// More bars would make the page large.
const MOST_BARS: usize = 20_000;
/// More graphs are not drawn one by one.
const MOST_GRAPHS: usize = 12;
/// More arrows hide each other.
const MOST_ARROWS: usize = 2000;
/// More links make a long table.
const MOST_LINKS: usize = 40;
/// More delays cannot be told apart.
const MOST_DELAYS: usize = 24;

/// Which edges are active when.
#[derive(Serialize)]
pub(crate) struct Gantt {
    /// A label and the agent whose colour the row has.
    rows: Vec<(String, usize)>,
    /// Start, end, row, and how many edges it stands for.
    bars: Vec<(f64, f64, usize, usize)>,
    /// Start, end and number from zero of the graph in force.
    spans: Vec<(f64, f64, usize)>,
    /// Until when they go, where there are too many to draw all.
    drawn_until_s: Option<f64>,
    /// How many spans come again and again, where all of them are drawn.
    turn_of: Option<usize>,
    by_receiver: bool,
}

impl Gantt {
    pub(crate) fn of(setup: &Setup, timeline: &Timeline<'_>, notes: &mut Vec<String>) -> Gantt {
        let spans = &timeline.spans;
        let mut edges: Vec<(usize, usize)> =
            timeline.graphs.iter().flat_map(|graph| graph.iter().map(|e| (e.from, e.to))).collect();
        edges.sort_unstable();
        edges.dedup();
        let by_receiver = edges.len() > MOST_EDGE_ROWS;
        let rows: Vec<(String, usize)> = if by_receiver {
            (0..setup.agents.len()).map(|i| (vertex_name(setup, i), i)).collect()
        } else {
            let label =
                |&(j, i): &(usize, usize)| (format!("{} → {}", vertex_name(setup, j), vertex_name(setup, i)), j);
            edges.iter().map(label).collect()
        };
        let row_of = |edge: &Edge| {
            if by_receiver { Some(edge.to) } else { edges.binary_search(&(edge.from, edge.to)).ok() }
        };
        let mut gantt =
            Gantt { rows, bars: Vec::new(), spans: Vec::new(), drawn_until_s: None, turn_of: None, by_receiver };
        // The bar of a row that goes on as long as nothing changes.
        let mut open: Vec<Option<usize>> = vec![None; gantt.rows.len()];
        for span in spans {
            if gantt.bars.len() > MOST_BARS {
                break;
            }
            gantt.spans.push((span.start_s, span.end_s, span.graph));
            let mut active = vec![0_usize; gantt.rows.len()];
            for row in timeline.graphs[span.graph].iter().filter_map(row_of) {
                if let Some(active) = active.get_mut(row) {
                    *active += 1;
                }
            }
            for (row, &edges) in active.iter().enumerate() {
                match open[row].and_then(|bar| gantt.bars.get_mut(bar)) {
                    Some(bar) if bar.3 == edges && bar.1 == span.start_s => bar.1 = span.end_s,
                    _ if edges > 0 => {
                        open[row] = Some(gantt.bars.len());
                        gantt.bars.push((span.start_s, span.end_s, row, edges));
                    }
                    _ => open[row] = None,
                }
            }
        }
        if timeline.drawn_until_s.is_some() || gantt.spans.len() < spans.len() {
            let drawn_s = gantt.spans.last().map_or(0.0, |span| span.1);
            gantt.drawn_until_s = Some(drawn_s);
            if let Extent::Period(count) = setup.network.schedule.known().extent {
                gantt.turn_of = Some(count).filter(|count| (1..=gantt.spans.len()).contains(count));
            }
            let after = if gantt.turn_of.is_some() { "; after that the graphs take turns as before" } else { "" };
            notes.push(format!(
                "The graph changes very often; which graph is in force, and who hears whom, is drawn until t = {} s{after}.",
                text::number(drawn_s)
            ));
        }
        gantt
    }
}

/// The delays to draw, by index, with the edges that have them.
pub(crate) fn shown_delays(setup: &Setup, timeline: &Timeline<'_>) -> Vec<(usize, String)> {
    let mut edges: Vec<(usize, usize, usize)> =
        timeline.graphs.iter().flat_map(|graph| graph.iter().map(|e| (e.delay, e.from, e.to))).collect();
    edges.sort_unstable();
    edges.dedup();
    let used: Vec<usize> = (0..setup.network.delays.len()).filter(|k| edges.iter().any(|e| e.0 == *k)).collect();
    let label = |k: usize| {
        let mine: Vec<_> = edges.iter().filter(|e| e.0 == k).collect();
        match mine.as_slice() {
            _ if used.len() == 1 => "all edges".to_owned(),
            [(_, from, to)] => format!("{} → {}", vertex_name(setup, *from), vertex_name(setup, *to)),
            more => format!("delay {}, {}", k + 1, text::count(more.len(), "edge")),
        }
    };
    used.iter().take(MOST_DELAYS).map(|k| (*k, label(*k))).collect()
}

/// What happened to packets, link by link; nothing where no link carries any.
pub(crate) fn links(record: &RunRecord<'_>) -> Markup {
    let setup = record.setup;
    let mut links = Link::all(&setup.network, &record.outcome.ending);
    let all = links.len();
    if all > MOST_LINKS {
        links.sort_by(|a, b| b.largest_age_s.total_cmp(&a.largest_age_s));
        links.truncate(MOST_LINKS);
    }
    let share = |part: usize, link: &Link| text::number(100.0 * part as f64 / link.sent.max(1) as f64);
    html! {
        @if all > 0 {
            div.card {
                h3 { "Packets" }
                div.scroll {
                    table.numbers #packets {
                        thead {
                            tr { th scope="col" { "link" } th scope="col" { "sent" } th scope="col" { "lost" } th scope="col" { "late, dropped" } th scope="col" { "largest age heard" } }
                        }
                        tbody {
                            @for link in &links {
                                tr {
                                    td { (vertex_name(setup, link.from)) " → " (vertex_name(setup, link.to)) }
                                    td { (link.sent) }
                                    td { (link.lost) " (" (share(link.lost, link)) " %)" }
                                    td { (link.late) " (" (share(link.late, link)) " %)" }
                                    td { (text::number(link.largest_age_s)) " s" }
                                }
                            }
                        }
                    }
                }
                @if all > MOST_LINKS {
                    p.note { "The " (MOST_LINKS) " of " (all) " links on which messages grew oldest; " code { "summary.json" } " has all." }
                }
                p.note {
                    "The newest message that has arrived is heard; one that comes after a newer one is dropped. Until the first \
                     arrives the initial message ages from t = 0. " code { "packets.csv" } " has every packet, and "
                    code { "delay.log" } " replays them."
                }
            }
        }
    }
}

/// One small picture per graph.
pub(crate) fn graphs(setup: &Setup, timeline: &Timeline<'_>) -> Markup {
    let agents = setup.agents.len();
    html! {
        div.graphs {
            @for (k, graph) in timeline.graphs.iter().take(MOST_GRAPHS).enumerate() {
                figure {
                    (circle(setup, graph))
                    figcaption {
                        strong { @if timeline.graphs.len() == 1 { "The graph" } @else { "Graph " (k + 1) } }
                        " " @if graph.is_empty() { "no edge: no agent hears another" } @else { (text::count(graph.len(), "edge")) }
                        @if graph.len() > MOST_ARROWS { ", " (MOST_ARROWS) " of them drawn" }
                        @if timeline.graphs.len() > 1 {
                            ", in force " (text::number(timeline.in_force_s[k])) " s"
                            @if let Some(counted_s) = timeline.counted_until_s { " of the first " (text::number(counted_s)) " s" }
                        }
                    }
                }
            }
        }
        @if timeline.graphs.len() > MOST_GRAPHS {
            p.note { "The first " (MOST_GRAPHS) " of " (timeline.graphs.len()) " graphs." }
        }
        @if agents > 0 { p.note { "An arrow from j to i: i hears j." @if setup.leader().is_some() { " L leads." } } }
    }
}

/// Agents on a circle, an arrow for every edge from the sender to the receiver.
fn circle(setup: &Setup, edges: &[Edge]) -> Markup {
    const RADIUS: f64 = 62.0;
    let count = vertices(setup);
    let dot = if count <= 12 { 9.0 } else { (0.3 * RADIUS * TAU / count as f64).min(5.0) };
    let place = |agent: usize| {
        let angle = TAU * (agent as f64 / count.max(1) as f64 - 0.25);
        let radius = if count == 1 { 0.0 } else { RADIUS };
        (radius * angle.cos(), radius * angle.sin())
    };
    let pairs: std::collections::HashSet<(usize, usize)> = edges.iter().map(|e| (e.from, e.to)).collect();
    let two_way = |e: &Edge| pairs.contains(&(e.to, e.from));
    let arrow = |e: &Edge| {
        let ((x0, y0), (x1, y1)) = (place(e.from), place(e.to));
        let length = (x1 - x0).hypot(y1 - y0).max(1e-9);
        let (ux, uy) = ((x1 - x0) / length, (y1 - y0) / length);
        // Arrows in both directions keep to their sides.
        let aside = if two_way(e) { dot * 0.32 } else { 0.0 };
        let (sx, sy) = (-uy * aside, ux * aside);
        let head = if count <= 12 { 6.0 } else { (dot * 1.2).min(4.0) };
        let tip = (x1 - ux * (dot + 0.15 * dot) + sx, y1 - uy * (dot + 0.15 * dot) + sy);
        let neck = (tip.0 - ux * head, tip.1 - uy * head);
        let half = head * 0.45;
        html! {
            g class={ "a" (e.from) } {
                line x1=(short(x0 + ux * dot + sx)) y1=(short(y0 + uy * dot + sy)) x2=(short(neck.0)) y2=(short(neck.1)) {}
                polygon points={
                    (short(tip.0)) "," (short(tip.1)) " "
                    (short(neck.0 - uy * half)) "," (short(neck.1 + ux * half)) " "
                    (short(neck.0 + uy * half)) "," (short(neck.1 - ux * half))
                } {}
            }
        }
    };
    html! {
        svg.graph viewBox="-80 -80 160 160" role="img" aria-label="graph" {
            @for (edge, _) in edges.iter().zip(drawn(edges.len())).filter(|(e, drawn)| *drawn && e.from < count && e.to < count) { (arrow(edge)) }
            @for agent in 0..count {
                @let (x, y) = place(agent);
                @let leads = setup.leader() == Some(agent);
                g class={ "node a" (agent) } {
                    title { (vertex_name(setup, agent)) @if leads { ", which leads" } }
                    circle cx=(short(x)) cy=(short(y)) r=(dot) {}
                    @if leads { circle.lead cx=(short(x)) cy=(short(y)) r=(dot + 2.5) {} }
                    @if count <= 12 { text x=(short(x)) y=(short(y + 3.4)) { @if leads { "L" } @else { (agent + 1) } } }
                }
            }
        }
    }
}

/// Which of so many edges are drawn: all, or as many as there may be. Multiples of the golden ratio spread them evenly, in whatever order edges
/// come; every so many would leave out the same senders in the list of every receiver.
fn drawn(edges: usize) -> Vec<bool> {
    let part = |edge: usize| (edge as f64 * 0.618_033_988_749_894_9).fract();
    let mut order: Vec<usize> = (0..edges).collect();
    order.sort_by(|a, b| part(*a).total_cmp(&part(*b)));
    let mut drawn = vec![false; edges];
    order.into_iter().take(MOST_ARROWS).for_each(|edge| drawn[edge] = true);
    drawn
}

/// The name of a vertex: of an agent, or of a leader that is none.
fn vertex_name(setup: &Setup, vertex: usize) -> String {
    setup.vertex_name(vertex).to_owned()
}

/// Agents, and a leader that is none.
pub(super) fn vertices(setup: &Setup) -> usize {
    setup.agents.len() + usize::from(setup.leader() == Some(setup.agents.len()))
}

fn short(x: f64) -> String {
    format!("{x:.1}")
}
