//! Searches delays that jump and graphs that take turns for those under which a design does worst.
//!
//! Inside the class of a theorem that is a network over which agreement is slow: with s ≡ 0 the interval of the cascaded variables never
//! grows, and the search says how little it shrinks. With one hypothesis broken it is a network over which the design fails: the
//! nearest is that with the fewest agents, then with the fewest phases. Drawn first, then changed bit by bit as long as that helps.

use std::time::{Duration, Instant};

use clap::ValueEnum;
use forwardstep::check::{Id, check, ideal};
use forwardstep::io::output::{Disagreement, Metrics};
use forwardstep::sim::Setup;
use forwardstep::sim::graph::{Edge, SpanningTree, spanning_tree};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::case::{Case, Course, Design, Phase, Switching, System, hundredths, pick};
use super::judge::{late, read, run_unless};

/// What `attack` attacks, by the names that it has on the command line: two designs inside their theorems, and some with a hypothesis broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Target {
    /// (a5) of order two, which is (a1), positions and velocities exchanged: how slow can agreement be?
    #[value(name = "a1")]
    Velocities,
    /// (24) of order two, positions exchanged: how slow can agreement be?
    #[value(name = "24")]
    Positions,
    /// (a1) with first roots κ₀ that differ from agent to agent: does it diverge?
    #[value(name = "a1-first-roots")]
    FirstRoots,
    /// (24) with a pair of complex roots, over graphs that switch: does it diverge?
    #[value(name = "24-complex-roots")]
    ComplexRoots,
    /// (119) with weights that change with time: does it fail to follow?
    #[value(name = "119-weights")]
    Weights,
    /// (110) over graphs in each of which the leader reaches some only: does an error stay?
    #[value(name = "110-windows")]
    Windows,
    /// (110) over graphs that take turns, with delays besides: does an error stay?
    #[value(name = "110-late-turns")]
    LateTurns,
    /// (122) over graphs that take turns, each with weights of its own: does the error grow?
    #[value(name = "122-turns")]
    Integrals,
    /// Swarm tracking over graphs that take turns, all with the same weight: does the error grow?
    #[value(name = "swarm-turns")]
    Swarm,
}

/// How long, and with how many pieces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attack {
    pub(crate) target: Target,
    /// Pieces of the delay, and phases, at most.
    pub(crate) pieces: usize,
    pub(crate) seed: u64,
    pub(crate) limit: Duration,
}

/// What was found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// The worst scenario.
    pub(crate) case: Case,
    /// What is left at its end, as a part of what there was at the start: of the disagreement, or of the error.
    pub(crate) left: f64,
    /// The hypotheses that do not hold for it.
    pub(crate) broken: Vec<Id>,
    /// Scenarios that were tried.
    pub(crate) tried: u64,
}

/// More than this is left where a design fails.
const FAILS: f64 = 10.0;
/// An error that does not fall below this part fails to follow: signs that are held leave less.
const STAYS: f64 = 0.05;
/// Changes in a row that bring nothing, after which a new draw is made.
const PATIENCE: u32 = 25;
/// Agents at most.
const MOST_AGENTS: usize = 4;
/// Agents of swarms: of two and three none is known that fails over two graphs with the same weight.
const SWARM_AGENTS: [usize; 3] = [4, 5, 6];
/// Weights of all links of a swarm, by which k = 60 is multiplied.
const SWARM_WEIGHTS: [&str; 3] = ["0.2", "0.5", "1"];

impl Target {
    /// Whether it lies inside the class of a theorem, so that nothing may grow.
    pub(crate) fn is_inside(self) -> bool {
        match self {
            Target::Velocities | Target::Positions => true,
            Target::FirstRoots
            | Target::ComplexRoots
            | Target::Weights
            | Target::Windows
            | Target::LateTurns
            | Target::Integrals
            | Target::Swarm => false,
        }
    }

    /// What is left where it fails.
    pub(crate) fn fails(self) -> f64 {
        match self {
            Target::Velocities | Target::Positions => 1.0 + 1e-6,
            Target::FirstRoots | Target::ComplexRoots | Target::Integrals | Target::Swarm => FAILS,
            Target::Weights | Target::Windows | Target::LateTurns => STAYS,
        }
    }

    /// The design by which a leader is followed, if there is one, and whether the leader moves. Where it rests, every graph by itself, and all of
    /// them without delay, lead everybody to it, as is shown: what stays away stays for the hypothesis that is broken.
    fn leading(self) -> Option<(Design, bool)> {
        match self {
            Target::Velocities | Target::Positions | Target::FirstRoots | Target::ComplexRoots => None,
            Target::Weights => Some((Design::Differentiable, true)),
            Target::Windows | Target::LateTurns => Some((Design::Continuous, false)),
            Target::Integrals => Some((Design::WithoutAcceleration, false)),
            Target::Swarm => Some((Design::Swarm, false)),
        }
    }

    /// How far from a leader agents start. Far from it the sign of (119), (122) and of swarms, which is bounded, does not cover up what is left over.
    fn away(self) -> f64 {
        match self {
            Target::Weights | Target::Integrals | Target::Swarm => 50.0,
            Target::Velocities
            | Target::Positions
            | Target::FirstRoots
            | Target::ComplexRoots
            | Target::Windows
            | Target::LateTurns => 1.0,
        }
    }

    /// Whether the delays are part of what is searched.
    fn delays(self) -> bool {
        match self {
            Target::Velocities | Target::Positions | Target::FirstRoots | Target::ComplexRoots | Target::LateTurns => {
                true
            }
            Target::Weights | Target::Windows | Target::Integrals | Target::Swarm => false,
        }
    }
}

impl Attack {
    /// The worst that is found in time; outside of a class the first that fails, made small. Nothing if no scenario could be tried.
    pub(crate) fn search(&self, stopped: &dyn Fn() -> bool) -> Option<Found> {
        let started = Instant::now();
        let ends = || started.elapsed() >= self.limit || stopped();
        let rng = &mut ChaCha8Rng::seed_from_u64(self.seed);
        let mut worst: Option<(Case, f64)> = None;
        let (mut tried, mut round) = (0, 0_u64);
        while !ends() {
            // The fewest agents first, again and again with more.
            let agents = match self.target {
                Target::Swarm => SWARM_AGENTS[(round % SWARM_AGENTS.len() as u64) as usize],
                _ => 2 + (round % (MOST_AGENTS as u64 - 1)) as usize,
            };
            round += 1;
            let mut best = self.draw(rng, agents);
            let mut left = self.left(&best, &ends).unwrap_or(0.0);
            let mut idle = 0;
            while idle < PATIENCE && !ends() {
                let other = self.changed(&best, rng);
                tried += 1;
                match self.left(&other, &ends) {
                    Some(more) if more > left => (best, left, idle) = (other, more, 0),
                    Some(_) | None => idle += 1,
                }
                if !self.target.is_inside() && left > self.target.fails() {
                    break;
                }
            }
            if worst.as_ref().is_none_or(|(_, most)| left > *most) {
                worst = Some((best, left));
            }
            if worst.as_ref().is_some_and(|(_, most)| *most > self.target.fails()) {
                break;
            }
        }
        let (mut case, mut left) = worst?;
        if left > self.target.fails() {
            (case, left) = self.smallest(case, left, stopped);
        }
        let broken = broken_by(&case);
        Some(Found { broken, case, left, tried })
    }

    fn draw(&self, rng: &mut ChaCha8Rng, agents: usize) -> Case {
        let (first, slow) = (hundredths(rng, 0.5, 2.0), hundredths(rng, 0.3, 1.0));
        let own =
            |rng: &mut ChaCha8Rng| if self.target == Target::FirstRoots { hundredths(rng, 0.1, 5.0) } else { first };
        let velocities = self.target == Target::Velocities || self.target == Target::FirstRoots;
        let led = self.target.leading();
        let phases = if self.target == Target::Weights { 1 } else { rng.random_range(2..=self.pieces.max(2)) };
        let away = self.target.away();
        let mut case = Case {
            number: self.seed,
            alone: led.is_none(),
            system: System::Mass(1),
            starts: (0..agents).map(|k| [if k % 2 == 0 { away } else { -away }, 0.0, 0.0]).collect(),
            roots: (0..agents)
                .map(|_| match self.target {
                    Target::Weights | Target::Integrals | Target::Swarm => vec![slow, slow],
                    Target::Windows | Target::LateTurns => vec![first],
                    Target::ComplexRoots => Vec::new(),
                    Target::Velocities | Target::Positions | Target::FirstRoots => vec![own(rng), 2.0],
                })
                .collect(),
            pair: (self.target == Target::ComplexRoots).then(|| pair(rng)),
            course: match led {
                Some((design, moves)) => Course::Follow { design, margin: 2.0, moves },
                None => Course::Agree { velocities },
            },
            known: true,
            phases: (0..phases)
                .map(|_| Phase { dwell_s: hundredths(rng, 0.1, 3.0), edges: Vec::new(), weight: None })
                .collect(),
            switching: Switching::Repeat,
            weight: if self.target == Target::Swarm { pick(rng, &SWARM_WEIGHTS) } else { "1" }.into(),
            delay: "constant_s = 0".into(),
            end_s: match self.target {
                Target::Weights
                | Target::Velocities
                | Target::Positions
                | Target::Windows
                | Target::LateTurns
                | Target::Integrals
                | Target::Swarm => 60.0,
                Target::FirstRoots | Target::ComplexRoots => 240.0,
            },
        };
        if self.target == Target::Weights {
            let chain = (0..agents).map(|agent| (agent, agent + 1));
            let back = (1..agents).map(|agent| (agent + 1, agent)).filter(|_| rng.random_bool(0.5));
            let edges: Vec<(usize, usize)> = chain.chain(back).collect();
            case.phases.iter_mut().for_each(|phase| phase.edges.clone_from(&edges));
            case.weight = self.weight(rng);
        } else {
            self.rewire(&mut case, rng);
            if self.target.delays() {
                case.delay = self.delay(rng);
            }
        }
        case
    }

    /// A cycle through all agents, whose edges are spread over the phases; or trees from the leader, a new one for every phase, or one that is
    /// spread over them.
    fn rewire(&self, case: &mut Case, rng: &mut ChaCha8Rng) {
        let (agents, phases) = (case.starts.len(), case.phases.len());
        case.phases.iter_mut().for_each(|phase| phase.edges.clear());
        if self.target == Target::Windows {
            for edge in tree(rng, agents).into_iter().chain(tree(rng, agents)) {
                let phase = rng.random_range(0..phases);
                if !case.phases[phase].edges.contains(&edge) {
                    case.phases[phase].edges.push(edge);
                }
            }
            return;
        }
        if self.target.leading().is_some() {
            for phase in &mut case.phases {
                phase.edges = tree(rng, agents);
                if self.target == Target::Swarm {
                    let back: Vec<_> =
                        phase.edges.iter().filter(|edge| edge.0 > 0).map(|&(from, to)| (to, from)).collect();
                    phase.edges.extend(back);
                    add_mutual(rng, agents, &mut phase.edges);
                }
                phase.weight = (self.target == Target::Integrals).then(|| pick(rng, &[0.3, 1.0, 3.0, 10.0, 30.0]));
            }
            return;
        }
        for from in 0..agents {
            let phase = rng.random_range(0..phases);
            case.phases[phase].edges.push((from, (from + 1) % agents));
        }
    }

    fn delay(&self, rng: &mut ChaCha8Rng) -> String {
        let count = rng.random_range(1..=self.pieces.max(1));
        let lengths: Vec<f64> = (0..count).map(|_| hundredths(rng, 0.1, 1.5)).collect();
        let starts: Vec<f64> = lengths
            .iter()
            .scan(0.0, |sum, length| {
                let at = *sum;
                *sum += length;
                Some((100.0_f64 * at).round() / 100.0)
            })
            .collect();
        let values: Vec<f64> = (0..count).map(|_| hundredths(rng, 0.0, 1.5)).collect();
        let period_s = (100.0 * lengths.iter().sum::<f64>()).round() / 100.0;
        format!("piecewise_constant = {{ times_s = {starts:?}, values_s = {values:?}, period_s = {period_s} }}")
    }

    /// Never zero, and bounded: but ẇ/w goes to ± the product of the two last numbers, against the damping of the design.
    fn weight(&self, rng: &mut ChaCha8Rng) -> String {
        let (mean, part, rate) = (hundredths(rng, 1.0, 10.0), hundredths(rng, 0.5, 4.0), hundredths(rng, 0.2, 4.0));
        format!("\"{mean}*exp({part}*sin({rate}*t))\"")
    }

    fn changed(&self, case: &Case, rng: &mut ChaCha8Rng) -> Case {
        let mut other = case.clone();
        if self.target == Target::Weights {
            match rng.random_range(0..3) {
                0 => {
                    let slow = hundredths(rng, 0.3, 1.0);
                    other.roots.iter_mut().for_each(|roots| *roots = vec![slow, slow]);
                }
                _ => other.weight = self.weight(rng),
            }
            return other;
        }
        match rng.random_range(0..5) {
            0 if self.target.delays() => other.delay = self.delay(rng),
            0 | 1 => self.rewire(&mut other, rng),
            2 => {
                let at = rng.random_range(0..other.phases.len());
                other.phases[at].dwell_s = hundredths(rng, 0.1, 3.0);
            }
            3 if self.target == Target::Swarm => other.weight = pick(rng, &SWARM_WEIGHTS).into(),
            3 => other.weight = pick(rng, &["1", "3", "10"]).into(),
            _ if self.target == Target::ComplexRoots => other.pair = Some(pair(rng)),
            _ if self.target == Target::FirstRoots => {
                let at = rng.random_range(0..other.roots.len());
                other.roots[at][0] = hundredths(rng, 0.1, 5.0);
            }
            _ => {
                let at = rng.random_range(0..other.phases.len());
                other.phases[at].dwell_s = pick(rng, &[0.1, 0.5, 1.0, 2.0, 3.0]);
            }
        }
        other
    }

    /// What is left at the end, as a part; nothing of what is no scenario or does not complete.
    fn left(&self, case: &Case, stopped: &dyn Fn() -> bool) -> Option<f64> {
        let setup = read(case).ok()?.setup;
        match self.target {
            Target::Velocities | Target::Positions | Target::FirstRoots => disagreement(&ideal(&setup).ok()?, stopped),
            Target::ComplexRoots => {
                let left = disagreement(&ideal(&setup).ok()?, stopped)?;
                // What grows over one of its graphs for ever proves nothing about those that take turns.
                let grows = |phase: &Phase| -> Option<bool> {
                    let alone = Case { phases: vec![phase.clone()], ..case.clone() };
                    Some(disagreement(&ideal(&read(&alone).ok()?.setup).ok()?, stopped)? > FAILS)
                };
                let proves = left <= FAILS || !case.phases.iter().any(|phase| grows(phase).unwrap_or(true));
                proves.then_some(left)
            }
            // Whom the leader never reaches, of windows or of graphs, cannot follow it.
            Target::Windows => {
                rooted(&setup, setup.network.schedule.graphs.iter().flatten()).then(|| error_left(&setup, stopped))?
            }
            Target::LateTurns | Target::Integrals => {
                let each = setup.network.schedule.graphs.iter().all(|graph| rooted(&setup, graph));
                each.then(|| error_left(&setup, stopped))?
            }
            Target::Swarm => {
                // Over each of its graphs by itself everybody follows, by our derivation: no paper prints it.
                let alone = |phase: &Phase| {
                    broken_by(&Case { phases: vec![phase.clone()], ..case.clone() }) == [Id::PrintedDesign]
                };
                case.phases.iter().all(alone).then(|| error_left(&setup, stopped))?
            }
            Target::Weights => {
                let left = error_left(&setup, stopped)?;
                // What is slow with constant weights too proves nothing.
                let twin = || error_left(&read(&Case { weight: "1".into(), ..case.clone() }).ok()?.setup, stopped);
                (left <= STAYS || twin()? < 0.2 * STAYS).then_some(left)
            }
        }
    }

    /// The smallest that still fails, with no hypothesis broken that was not before.
    fn smallest(&self, mut case: Case, mut left: f64, stopped: &dyn Fn() -> bool) -> (Case, f64) {
        let (fails, before) = (self.target.fails(), broken_by(&case));
        loop {
            // What is shorter fails less, and is no nearer.
            let smaller = case.smaller().into_iter().filter(|smaller| {
                smaller.end_s >= case.end_s && broken_by(smaller).iter().all(|id| before.contains(id))
            });
            let found = smaller
                .take_while(|_| !stopped())
                .filter_map(|smaller| Some((self.left(&smaller, stopped)?, smaller)))
                .find(|(left, _)| *left > fails);
            match found {
                Some((less, smaller)) => (case, left) = (smaller, less),
                None => return (case, left),
            }
        }
    }
}

/// Whether these edges lead from one vertex to all; where there is a leader, which hears no other, that is the leader.
fn rooted<'a>(setup: &Setup, edges: impl IntoIterator<Item = &'a Edge>) -> bool {
    matches!(spanning_tree(setup.network.agents, edges), SpanningTree::Rooted { .. })
}

/// A tree from the leader, vertex 0, to all agents.
fn tree(rng: &mut ChaCha8Rng, agents: usize) -> Vec<(usize, usize)> {
    let mut order: Vec<usize> = (1..=agents).collect();
    for last in (1..agents).rev() {
        order.swap(last, rng.random_range(0..=last));
    }
    let parent = |rng: &mut ChaCha8Rng, at: usize| rng.random_range(0..=at).checked_sub(1);
    (0..agents).map(|at| (parent(rng, at).map_or(0, |before| order[before]), order[at])).collect()
}

/// Some links more that lead both ways, or from the leader.
fn add_mutual(rng: &mut ChaCha8Rng, agents: usize, edges: &mut Vec<(usize, usize)>) {
    for to in 1..=agents {
        for from in 0..to {
            if !edges.contains(&(from, to)) && rng.random_bool(0.3) {
                edges.push((from, to));
                edges.extend((from > 0).then_some((to, from)));
            }
        }
    }
}

/// A pair of complex roots with little damping.
fn pair(rng: &mut ChaCha8Rng) -> [f64; 2] {
    [hundredths(rng, 0.05, 1.0), hundredths(rng, 0.5, 5.0)]
}

/// The largest error of the last quarter as a part of that at the start.
fn error_left(setup: &Setup, stopped: &dyn Fn() -> bool) -> Option<f64> {
    let outcome = run_unless(setup, stopped).ok()?;
    let initial = match Metrics::of(setup, &outcome.recording, None, None).disagreement {
        Disagreement::Measured { initial, .. } => initial,
        Disagreement::Absent(_) => return None,
    };
    Some(late(setup, outcome)? / initial)
}

/// The disagreement at the end as a part of that at the start.
fn disagreement(setup: &Setup, stopped: &dyn Fn() -> bool) -> Option<f64> {
    let outcome = run_unless(setup, stopped).ok()?;
    match Metrics::of(setup, &outcome.recording, None, None).disagreement {
        Disagreement::Measured { initial, last, .. } => Some(last / initial).filter(|left| left.is_finite()),
        Disagreement::Absent(_) => None,
    }
}

fn broken_by(case: &Case) -> Vec<Id> {
    read(case).map_or_else(|_| Vec::new(), |scenario| broken(&scenario.setup))
}

/// The hypotheses that do not hold. What a run watches does, until a run stops at it.
pub(super) fn broken(setup: &Setup) -> Vec<Id> {
    let report = check(setup);
    report.hypotheses.iter().filter(|one| !one.answer().is_fine()).map(|one| one.id).collect()
}
