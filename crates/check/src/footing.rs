//! What a derivation rests on in a scenario: the hypotheses that it lacks, and what would break the others.

use forwardstep_sim::Setup;
use forwardstep_sim::graph::needed_edges;

use crate::hypothesis::Id;
use crate::report::Report;
use crate::theorem::Theorem;

/// Of dynamics that do not average what agents receive, as the designs of the paper do, it is not known how long a delay they tolerate.
const OWN_DELAYS: &str = "a delay that grows for ever, such as T = t, or a link that loses every packet; with dynamics of your own a bounded delay \
                          can break agreement too, and nothing here says how long it may be";
/// Nor how fast graphs may take turns.
const OWN_SWITCHES: &str = "switches that follow each other ever faster, without a shortest phase; with dynamics of your own graphs that take turns \
                            can break agreement too, and nothing here says how long each has to stay";

/// What is said of one hypothesis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ground {
    /// Which.
    pub id: Id,
    /// In a sentence.
    pub words: String,
}

/// What a derivation rests on, hypothesis by hypothesis in the order of a report.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Footing {
    /// What does not hold, and why: what is derived by it does not follow.
    pub lacks: Vec<Ground>,
    /// What would break what holds, and what follows then, several of one kind once; for graphs, the links each of which is needed.
    pub breaks: Vec<Ground>,
}

impl Footing {
    /// By what `report` says of `setup`.
    pub fn of(setup: &Setup, report: &Report) -> Footing {
        let mut footing = Footing::default();
        let is_own = matches!(report.theorem, Theorem::Desired | Theorem::Declared(_));
        for hypothesis in &report.hypotheses {
            let (id, answer) = (hypothesis.id, hypothesis.answer());
            if !answer.is_fine() {
                let words = format!("{}: {}; {}", answer.words(), hypothesis.requires(), hypothesis.because());
                footing.lacks.push(Ground { id, words });
            } else if footing.breaks.iter().all(|one| one.id != id) {
                let words = match id {
                    Id::SpanningTree | Id::LeaderReachesAll => format!("{}; {}", id.broken_by(), links(setup)),
                    Id::BoundedDelays if is_own => OWN_DELAYS.to_owned(),
                    Id::DwellTime if is_own => OWN_SWITCHES.to_owned(),
                    _ => id.broken_by().to_owned(),
                };
                footing.breaks.push(Ground { id, words });
            }
        }
        footing
    }
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
        0 => "no single link is indispensable".to_owned(),
        1 => format!("losing one link breaks it: {}", shown.concat()),
        _ => format!("losing any one of these links breaks it: {}{more}", shown.join(", ")),
    }
}
