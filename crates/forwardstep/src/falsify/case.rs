//! A random scenario as data: what is drawn, and how it becomes smaller.

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// A scenario that was drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Case {
    /// Which of its seed.
    pub(crate) number: u64,
    /// Whether its references are simulated alone, s ≡ 0, or whole closed loops.
    pub(crate) alone: bool,
    pub(crate) system: System,
    /// Where each agent starts: numbers from −1 to 1, of which each kind takes as many as it has axes.
    pub(crate) starts: Vec<[f64; 3]>,
    /// κ₀, κ₁, … of each agent.
    pub(crate) roots: Vec<Vec<f64>>,
    /// a and b of a pair of complex roots −a ± b i that all agents have besides.
    pub(crate) pair: Option<[f64; 2]>,
    pub(crate) course: Course,
    /// Whether the law knows its robot.
    pub(crate) known: bool,
    pub(crate) phases: Vec<Phase>,
    pub(crate) switching: Switching,
    /// A number or a formula.
    pub(crate) weight: String,
    /// The table of the delay.
    pub(crate) delay: String,
    pub(crate) end_s: f64,
}

/// What the agents are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum System {
    /// Point masses with this many axes.
    Mass(usize),
    Arm,
    Ship,
    /// Point masses whose velocity is not measured.
    PositionOnly,
    /// The same by a model and a high gain.
    ByModel,
    /// A vehicle with one thrust, under one of its designs.
    Vehicle(Thrust),
    /// Derivatives of one number, of this order.
    Chain(usize),
    /// A spacecraft without velocities, under (74) or a filter of its error.
    Spacecraft {
        filtered: bool,
    },
    /// A planar arm whose tip follows a target, whose velocity is measured or not.
    Tip {
        measured: bool,
    },
}

/// Laws of vehicles with one thrust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Thrust {
    Continuous,
    Differentiable,
    Adaptive,
    ByAcceleration,
}

/// What the agents do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Course {
    /// They agree, by (aa10), (a1), (a5) or (24).
    Agree { velocities: bool },
    /// They agree by (3) or (23).
    Integral { velocities: bool },
    /// They follow a leader by this design, with γ this many times a bound of what drives it when it moves; it may rest.
    Follow { design: Design, margin: f64, moves: bool },
    /// Each follows a target, at this rate, rad/s.
    Track { rate: f64 },
}

impl Course {
    /// Whether there is a leader that moves.
    pub(super) fn moves(self) -> bool {
        matches!(self, Course::Follow { moves: true, .. })
    }
}

/// Designs that follow a leader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Design {
    Continuous,
    Differentiable,
    WithoutAcceleration,
    Swarm,
    Composite,
    Observer,
}

/// A graph and how long it lasts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Phase {
    pub(crate) dwell_s: f64,
    /// From, to; agent 0 is the leader where there is one, and the others follow.
    pub(crate) edges: Vec<(usize, usize)>,
    /// The weight of its edges, if it is not that of all.
    pub(crate) weight: Option<f64>,
}

/// How graphs take turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Switching {
    Repeat,
    Once,
    Random,
}

const WEIGHTS: [&str; 8] = ["1", "1", "1", "0.3", "2.0", "\"1+0.5*sin(t)\"", "\"1+t/(1+t)\"", "\"0.5+abs(sin(t))\""];
const DELAYS: [&str; 9] = [
    "constant_s = 0",
    "constant_s = 0.2",
    "constant_s = 1.5",
    "sinusoid = { mean_s = 0.3, amplitude_s = 0.3, period_s = 0.7 }",
    "saw_tooth = { min_s = 0.05, max_s = 0.6, period_s = 0.7 }",
    "piecewise_constant = { times_s = [0, 0.4, 1.1], values_s = [0.1, 0.5, 0.0], period_s = 1.5 }",
    "formula_s = \"0.3*exp(-t)+0.1*abs(sin(t))\"",
    "random_hold = { seed = 3, hold_s = [0.3, 0.6], value_s = [0.0, 0.5] }",
    "packets = { seed = 2, period_s = 0.05, latency_s = 0.02, jitter_s = 0.03, loss.random = { probability = 0.2, most_consecutive = 4 } }",
];
/// Agents at most.
const MOST_AGENTS: usize = 6;
/// Roots at most.
const MOST_ROOTS: usize = 5;

impl Case {
    /// Case `number` of a seed.
    pub(crate) fn draw(seed: u64, number: u64) -> Case {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ number);
        // Half of them are robots that agree, of which the references are looked at alone.
        let alone = number.is_multiple_of(2);
        let (system, course) = if alone { (robot(rng), agree(rng)) } else { any(rng) };
        let order = least_order(system, course);
        let more = if exact_order(system, course) { 0 } else { rng.random_range(0..3) };
        let order = (order + more).min(MOST_ROOTS);
        let agents = match course {
            Course::Track { .. } => 1,
            Course::Agree { .. } | Course::Integral { .. } | Course::Follow { .. } => rng.random_range(2..=MOST_AGENTS),
        };
        let own_roots = matches!(course, Course::Agree { .. }) && rng.random_bool(0.2);
        let common = roots(rng, order);
        let each = |rng: &mut ChaCha8Rng| if own_roots { roots(rng, order) } else { common.clone() };
        let leads = usize::from(matches!(course, Course::Follow { .. }));
        let fixed = leads > 0 || matches!(course, Course::Integral { .. });
        // Of a network that never changes the value agreed upon is known beforehand.
        let still = !alone && rng.random_bool(0.2);
        let (delays, weights) = if still { (&DELAYS[..3], &WEIGHTS[..5]) } else { (&DELAYS[..], &WEIGHTS[..]) };
        let count = if fixed || still { 1 } else { rng.random_range(1..=3) };
        let density = rng.random_range(0.2..0.7);
        Case {
            number,
            alone,
            system,
            starts: (0..agents).map(|_| [(); 3].map(|()| hundredths(rng, -1.0, 1.0))).collect(),
            roots: (0..agents).map(|_| each(rng)).collect(),
            pair: None,
            course,
            known: rng.random_bool(0.3),
            phases: (0..count).map(|_| phase(rng, agents + leads, leads > 0, density)).collect(),
            switching: [Switching::Repeat, Switching::Once, Switching::Random][rng.random_range(0..3)],
            weight: if leads > 0 { "1" } else { pick(rng, weights) }.into(),
            delay: if leads > 0 { DELAYS[0] } else { pick(rng, delays) }.into(),
            end_s: 30.0,
        }
    }

    /// Whether a leader moves before them.
    pub(crate) fn is_led(&self) -> bool {
        matches!(self.course, Course::Follow { .. })
    }

    /// Cases that are a little smaller, the smallest first.
    pub(crate) fn smaller(&self) -> Vec<Case> {
        let mut found = Vec::new();
        let leads = usize::from(self.is_led());
        if self.starts.len() > 2 {
            found.extend((0..self.starts.len()).map(|gone| self.without(gone, leads)));
        }
        if self.phases.len() > 1 {
            found.extend((0..self.phases.len()).map(|gone| {
                let mut case = self.clone();
                case.phases.remove(gone);
                case
            }));
        }
        for (k, phase) in self.phases.iter().enumerate() {
            found.extend((0..phase.edges.len()).map(|gone| {
                let mut case = self.clone();
                case.phases[k].edges.remove(gone);
                case
            }));
            // Where links lead both ways, the two of them.
            found.extend(phase.edges.iter().filter(|(from, to)| from < to && phase.edges.contains(&(*to, *from))).map(
                |&(from, to)| {
                    let mut case = self.clone();
                    case.phases[k].edges.retain(|edge| *edge != (from, to) && *edge != (to, from));
                    case
                },
            ));
        }
        let mut simpler = |change: &dyn Fn(&mut Case)| {
            let mut case = self.clone();
            change(&mut case);
            if case != *self {
                found.push(case);
            }
        };
        simpler(&|case| case.delay = DELAYS[0].into());
        simpler(&|case| {
            if case.delay != DELAYS[0] {
                case.delay = DELAYS[1].into();
            }
        });
        simpler(&|case| case.weight = WEIGHTS[0].into());
        simpler(&|case| case.phases.iter_mut().for_each(|phase| phase.weight = None));
        simpler(&|case| case.switching = Switching::Repeat);
        simpler(&|case| case.known = true);
        simpler(&|case| case.end_s = (0.5 * case.end_s).max(1.0));
        simpler(&|case| case.starts.iter_mut().flatten().for_each(|x| *x = (2.0 * *x).round() / 2.0));
        found
    }

    fn without(&self, gone: usize, leads: usize) -> Case {
        let mut case = self.clone();
        case.starts.remove(gone);
        case.roots.remove(gone);
        let vertex = gone + leads;
        let moved = |at: usize| if at > vertex { at - 1 } else { at };
        for phase in &mut case.phases {
            phase.edges.retain(|(from, to)| *from != vertex && *to != vertex);
            phase.edges.iter_mut().for_each(|(from, to)| (*from, *to) = (moved(*from), moved(*to)));
        }
        case
    }
}

pub(super) fn pick<T: Copy>(rng: &mut ChaCha8Rng, among: &[T]) -> T {
    among[rng.random_range(0..among.len())]
}

pub(super) fn hundredths(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    (100.0 * rng.random_range(low..high)).round() / 100.0
}

pub(super) fn roots(rng: &mut ChaCha8Rng, order: usize) -> Vec<f64> {
    (0..order).map(|_| hundredths(rng, 0.5, 3.0)).collect()
}

fn robot(rng: &mut ChaCha8Rng) -> System {
    let axes = rng.random_range(1..=3);
    pick(rng, &[System::Mass(axes), System::Arm, System::Ship])
}

fn agree(rng: &mut ChaCha8Rng) -> Course {
    let velocities = rng.random_bool(0.5);
    pick(rng, &[Course::Agree { velocities }, Course::Agree { velocities }, Course::Integral { velocities }])
}

/// Any kind under any course that is made for it.
fn any(rng: &mut ChaCha8Rng) -> (System, Course) {
    let track = Course::Track { rate: hundredths(rng, 0.2, 1.5) };
    let designs = [
        Design::Continuous,
        Design::Differentiable,
        Design::WithoutAcceleration,
        Design::Swarm,
        Design::Composite,
        Design::Observer,
    ];
    let follow = Course::Follow { design: pick(rng, &designs), margin: hundredths(rng, 1.05, 2.0), moves: true };
    let positions = Course::Agree { velocities: false };
    let thrust = pick(rng, &[Thrust::Continuous, Thrust::Differentiable, Thrust::Adaptive, Thrust::ByAcceleration]);
    let order = rng.random_range(1..=3);
    let (one, other) = (robot(rng), robot(rng));
    let kinds = [
        (one, agree(rng)),
        (other, track),
        (one, follow),
        (other, follow),
        (System::PositionOnly, positions),
        (System::PositionOnly, track),
        (System::ByModel, track),
        (System::Vehicle(thrust), positions),
        (System::Chain(order), positions),
        (System::Chain(order), track),
        (System::Spacecraft { filtered: rng.random_bool(0.4) }, track),
        (System::Tip { measured: rng.random_bool(0.4) }, track),
    ];
    pick(rng, &kinds)
}

/// Whether the design has as many roots as it has, no more.
fn exact_order(system: System, course: Course) -> bool {
    match course {
        Course::Integral { .. } | Course::Follow { .. } => true,
        Course::Track { .. } => {
            matches!(system, System::Spacecraft { .. } | System::Tip { .. } | System::PositionOnly | System::ByModel)
        }
        Course::Agree { .. } => matches!(system, System::Vehicle(_) | System::PositionOnly),
    }
}

fn least_order(system: System, course: Course) -> usize {
    match (course, system) {
        (Course::Integral { .. }, _) => 2,
        (Course::Follow { design: Design::Continuous, .. }, _) => 1,
        (Course::Follow { .. }, _) => 2,
        (_, System::Vehicle(Thrust::Continuous | Thrust::ByAcceleration)) => 2,
        (_, System::Vehicle(_)) => 3,
        (_, System::PositionOnly) => 3,
        (_, System::Chain(order)) => order,
        (Course::Agree { velocities: true }, System::Mass(_) | System::Arm | System::Ship) => 1,
        (Course::Track { .. }, System::Spacecraft { .. } | System::Tip { .. }) => 0,
        (Course::Agree { velocities: false } | Course::Track { .. } | Course::Agree { velocities: true }, _) => 2,
    }
}

fn phase(rng: &mut ChaCha8Rng, vertices: usize, leads: bool, density: f64) -> Phase {
    let mut edges = Vec::new();
    for from in 0..vertices {
        for to in usize::from(leads)..vertices {
            if from != to && rng.random_bool(density) {
                edges.push((from, to));
            }
        }
    }
    Phase { dwell_s: pick(rng, &[0.4, 1.0, 2.5]), edges, weight: None }
}
