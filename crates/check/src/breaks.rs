//! What would break what holds: the other side of every hypothesis on which a promise rests.

use forwardstep_sim::Setup;
use forwardstep_sim::graph::needed_edges;

use crate::hypothesis::Id;
use crate::report::Report;

/// What would break one of the hypotheses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Break {
    /// Which.
    pub id: Id,
    /// What would break it, and what follows then; for graphs, the links each of which is needed.
    pub words: String,
}

/// What would break each of the hypotheses of `report` that speak for the design, in their order; several of one kind once. What does not
/// hold is broken already, and says so itself.
pub fn breaks(setup: &Setup, report: &Report) -> Vec<Break> {
    let mut found: Vec<Break> = Vec::new();
    for hypothesis in report.hypotheses.iter().filter(|hypothesis| hypothesis.answer().is_fine()) {
        let id = hypothesis.id;
        if found.iter().all(|one| one.id != id) {
            let words = match id {
                Id::SpanningTree | Id::LeaderReachesAll => format!("{}; {}", id.broken_by(), links(setup)),
                _ => id.broken_by().to_owned(),
            };
            found.push(Break { id, words });
        }
    }
    found
}

/// Which links the network cannot do without, each by itself.
fn links(setup: &Setup) -> String {
    const SHOWN: usize = 6;
    let network = &setup.network;
    let needed = needed_edges(network.agents, network.schedule.recurring_graphs().iter().flatten());
    let name = |&(from, to): &(usize, usize)| format!("{} → {}", setup.vertex_name(from), setup.vertex_name(to));
    let shown: Vec<String> = needed.iter().take(SHOWN).map(name).collect();
    let more = match needed.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    match needed.len() {
        0 => "no link is needed by itself".to_owned(),
        1 => format!("one link is needed by itself: {}", shown.concat()),
        _ => format!("each of these links is needed by itself: {}{more}", shown.join(", ")),
    }
}
