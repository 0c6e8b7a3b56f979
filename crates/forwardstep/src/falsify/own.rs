//! Searches what a scenario of the user's own leaves open for the delays and schedules under which it does worst.
//!
//! The common delay of its edges takes any values between zero and the longest that is stated, piece by piece; graphs that take turns do so in any
//! order, each staying as long as the shortest or the longest that is stated or in between. Robots, laws, weights and starts stay. References
//! are simulated alone, s ≡ 0: where a theorem speaks, the interval of the cascaded variables never grows, and the search is for the least that it
//! shrinks; where none does, for a network over which the disagreement grows.

use std::time::{Duration, Instant};

use forwardstep::check::prediction::{CascadeSpread, NoIdeal};
use forwardstep::check::{Id, ideal};
use forwardstep::io::diagnostic::SourceText;
use forwardstep::io::output::{Disagreement, Metrics};
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::scenario::{Inputs, Rewired, Scenario, StatedNetwork, rewired, stated_network};
use forwardstep::sim::Setup;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use thiserror::Error;

use super::attack::broken;
use super::case::hundredths;
use super::judge::{grown, run_unless};

/// The disagreement grows where more than this many times that of the start is left.
pub(crate) const GROWS: f64 = 10.0;
/// Changes in a row that bring nothing, after which a new draw is made.
const PATIENCE: u32 = 25;
/// What is made smaller keeps this part of what was left.
const KEEPS: f64 = 0.999;
/// One run of the references as they are stated may take as long, whatever the search may.
const STATED: Duration = Duration::from_secs(5);

/// A scenario under attack.
pub(crate) struct OwnAttack<'a> {
    pub(crate) scenario: &'a Scenario,
    pub(crate) kinds: &'a Kinds,
    /// Pieces of the delay, and phases, at most; phases that the scenario has are never left out.
    pub(crate) pieces: usize,
    pub(crate) seed: u64,
    pub(crate) limit: Duration,
}

/// What was found.
#[derive(Clone, Debug)]
pub(crate) struct OwnFound {
    /// The scenario with its worst network.
    pub(crate) text: String,
    /// The files that it names.
    pub(crate) files: Vec<String>,
    pub(crate) worst: Left,
    /// The same of the scenario as it is stated.
    pub(crate) stated: Left,
    /// The hypotheses that do not hold for it.
    pub(crate) broken: Vec<Id>,
    /// Networks that were tried.
    pub(crate) tried: u64,
}

/// What is left at the end of a run, as a part of what there was at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Left {
    pub(crate) part: f64,
    /// Of the interval of all cascaded variables, which never grows; otherwise of the disagreement.
    pub(crate) of_interval: bool,
    /// Whether that interval grew all the same.
    pub(crate) grew: bool,
}

/// Why a scenario cannot be attacked.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum NoAttack {
    /// What is heard is not all that moves its references.
    #[error("the search is for references that are moved by what they hear of each other alone, but {0}")]
    Ideal(#[from] NoIdeal),
    /// There is nothing to search.
    #[error(
        "it leaves nothing open: its edges do not all share one delay above zero, and no graphs of it take turns again and again, each as long \
         as the scenario says"
    )]
    Nothing,
    /// A delay without bound has no worst.
    #[error("no bound of its delays is known, within which others could be tried; state one")]
    Unbounded,
    /// There is nothing to compare.
    #[error(
        "nothing of a disagreement can be measured: agents start together, or a run of their references does not complete"
    )]
    Silent,
    /// There is no time for a single run.
    #[error("one run of its references takes longer than `--seconds`; give more, or let `time.end_s` be shorter")]
    TakesLonger,
    /// Somebody stopped it.
    #[error("it was stopped before its references had run once")]
    Stopped,
}

/// What can be varied, and how far.
struct Bounds {
    /// The longest delay, s; zero where delays stay as they are.
    delay_s: f64,
    stated: StatedNetwork,
}

impl OwnAttack<'_> {
    /// The worst that is found in time, made small.
    ///
    /// # Errors
    /// [`NoAttack`] says why the scenario cannot be attacked.
    pub(crate) fn search(&self, stopped: &dyn Fn() -> bool) -> Result<OwnFound, NoAttack> {
        let bounds = self.bounds()?;
        let (started, most) = (Instant::now(), self.limit.max(STATED));
        let stated = left(&self.scenario.setup, &|| stopped() || started.elapsed() >= most).ok_or_else(|| {
            match (stopped(), started.elapsed() >= most) {
                (true, _) => NoAttack::Stopped,
                (false, true) => NoAttack::TakesLonger,
                (false, false) => NoAttack::Silent,
            }
        })?;
        let started = Instant::now();
        let goes_on = || started.elapsed() < self.limit && !stopped();
        let ends = || !goes_on();
        // What was found late is made small for half as long again.
        let latest = self.limit.saturating_add(self.limit / 2);
        let is_late = || stopped() || started.elapsed() >= latest;
        let rng = &mut ChaCha8Rng::seed_from_u64(self.seed);
        let (mut worst, mut tried) = ((Rewired::default(), stated), 0);
        let fails = |left: &Left| left.grew || (!left.of_interval && left.part > GROWS);
        while goes_on() && !fails(&worst.1) {
            let mut best = (self.draw(&bounds, rng), None::<Left>);
            best.1 = self.left(&best.0, &ends);
            let mut idle = 0;
            while idle < PATIENCE && goes_on() {
                let other = self.changed(&bounds, &best.0, rng);
                tried += 1;
                match (self.left(&other, &ends), best.1) {
                    (Some(found), Some(known)) if found.part <= known.part => idle += 1,
                    (Some(found), _) => (best, idle) = ((other, Some(found)), 0),
                    (None, _) => idle += 1,
                }
                if best.1.as_ref().is_some_and(fails) {
                    break;
                }
            }
            if let (plan, Some(found)) = best
                && found.part > worst.1.part
            {
                worst = (plan, found);
            }
        }
        let (plan, worst) = self.smallest(worst, &is_late);
        let text = rewired(&self.scenario.source, &plan).ok_or(NoAttack::Nothing)?;
        let scenario = self.read(&plan).ok_or(NoAttack::Silent)?;
        let files = scenario.inputs.iter().map(|file| file.name.clone()).collect();
        Ok(OwnFound { text, files, worst, stated, broken: broken(&scenario.setup), tried })
    }

    fn bounds(&self) -> Result<Bounds, NoAttack> {
        let setup = &self.scenario.setup;
        ideal(setup)?;
        let stated = stated_network(&self.scenario.source).ok_or(NoAttack::Nothing)?;
        let delay_s = if stated.common_delay { setup.network.max_delay_s() } else { 0.0 };
        if !delay_s.is_finite() {
            return Err(NoAttack::Unbounded);
        }
        if delay_s <= 0.0 && stated.phases == 0 {
            return Err(NoAttack::Nothing);
        }
        Ok(Bounds { delay_s, stated })
    }

    fn draw(&self, bounds: &Bounds, rng: &mut ChaCha8Rng) -> Rewired {
        Rewired { delay: self.delay(bounds, rng), phases: self.phases(bounds, rng) }
    }

    /// Pieces of a delay between zero and the longest.
    fn delay(&self, bounds: &Bounds, rng: &mut ChaCha8Rng) -> Vec<[f64; 2]> {
        if bounds.delay_s <= 0.0 {
            return Vec::new();
        }
        let value = |rng: &mut ChaCha8Rng| match rng.random_range(0..4) {
            0 => 0.0,
            1 => bounds.delay_s,
            _ => short(bounds.delay_s * rng.random_range(0.0..1.0)).min(bounds.delay_s),
        };
        (0..rng.random_range(1..=self.pieces.max(1))).map(|_| [hundredths(rng, 0.1, 1.5), value(rng)]).collect()
    }

    /// All graphs in some order, and more of them up to the number of pieces.
    fn phases(&self, bounds: &Bounds, rng: &mut ChaCha8Rng) -> Vec<(usize, f64)> {
        let count = bounds.stated.phases;
        let mut order: Vec<usize> = (0..count).collect();
        let more = if count == 0 { 0 } else { rng.random_range(0..=self.pieces.saturating_sub(count)) };
        order.extend((0..more).map(|_| rng.random_range(0..count)));
        for last in (1..order.len()).rev() {
            order.swap(last, rng.random_range(0..=last));
        }
        order.into_iter().map(|graph| (graph, dwell(bounds, rng))).collect()
    }

    fn changed(&self, bounds: &Bounds, plan: &Rewired, rng: &mut ChaCha8Rng) -> Rewired {
        let mut other = plan.clone();
        match rng.random_range(0..4) {
            0 => other.phases = self.phases(bounds, rng),
            1 | 2 if !other.phases.is_empty() => {
                let at = rng.random_range(0..other.phases.len());
                other.phases[at].1 = dwell(bounds, rng);
            }
            _ => other.delay = self.delay(bounds, rng),
        }
        other
    }

    /// Drops pieces and phases, or takes what is stated again, as long as about as much is left.
    fn smallest(&self, worst: (Rewired, Left), stopped: &dyn Fn() -> bool) -> (Rewired, Left) {
        let (mut plan, mut found) = worst;
        let least = if found.of_interval || found.part <= GROWS { KEEPS * found.part } else { GROWS };
        loop {
            let smaller = smaller(&plan).into_iter().take_while(|_| !stopped()).find_map(|plan| {
                let left = self.left(&plan, stopped)?;
                (left.part >= least && left.grew == found.grew).then_some((plan, left))
            });
            match smaller {
                Some(smaller) => (plan, found) = smaller,
                None => return (plan, found),
            }
        }
    }

    fn left(&self, plan: &Rewired, stopped: &dyn Fn() -> bool) -> Option<Left> {
        left(&self.read(plan)?.setup, stopped)
    }

    /// The scenario with another network, its other files as they were read.
    fn read(&self, plan: &Rewired) -> Option<Scenario> {
        let Scenario { name, source, inputs, .. } = self.scenario;
        let source = SourceText::new(source.name(), rewired(source, plan)?);
        let inputs: Inputs = inputs.iter().map(|file| (&file.name, file.source.text())).collect();
        self.kinds.read_scenario(name, &source, inputs).ok()
    }
}

fn dwell(bounds: &Bounds, rng: &mut ChaCha8Rng) -> f64 {
    let [low, high] = bounds.stated.dwell_s;
    match rng.random_range(0..4) {
        0 => low,
        1 => high,
        _ => short(low + (high - low) * rng.random_range(0.0..1.0)).clamp(low, high),
    }
}

/// To a millisecond.
fn short(t_s: f64) -> f64 {
    (1e3 * t_s).round() / 1e3
}

/// Networks with less in them: as stated, without a piece, without a phase whose graph comes again.
fn smaller(plan: &Rewired) -> Vec<Rewired> {
    let stated = Rewired::default();
    let mut found =
        vec![Rewired { delay: stated.delay, ..plan.clone() }, Rewired { phases: stated.phases, ..plan.clone() }];
    if plan.delay.len() > 1 {
        found.extend((0..plan.delay.len()).map(|gone| Rewired { delay: without(&plan.delay, gone), ..plan.clone() }));
    }
    let again = |graph: usize| plan.phases.iter().filter(|(other, _)| *other == graph).count() > 1;
    let spare = (0..plan.phases.len()).filter(|at| again(plan.phases[*at].0));
    found.extend(spare.map(|gone| Rewired { phases: without(&plan.phases, gone), ..plan.clone() }));
    found.retain(|other| other != plan);
    found
}

fn without<T: Copy>(all: &[T], gone: usize) -> Vec<T> {
    all.iter().enumerate().filter(|(at, _)| *at != gone).map(|(_, one)| *one).collect()
}

/// What is left of the references of a setup at its end; nothing where that cannot be measured.
fn left(setup: &Setup, stopped: &dyn Fn() -> bool) -> Option<Left> {
    let ideal = ideal(setup).ok()?;
    let outcome = run_unless(&ideal, stopped).ok()?;
    if let Ok(spread) = CascadeSpread::of(&ideal, &outcome.recording) {
        let widths = spread.widths();
        let part = widths.last()? / widths.first()?;
        let grew = grown(&spread, &outcome.recording.t_s).is_some();
        return part.is_finite().then_some(Left { part, of_interval: true, grew });
    }
    match Metrics::of(&ideal, &outcome.recording, None, None).disagreement {
        Disagreement::Measured { initial, last, .. } => {
            let part = last / initial;
            part.is_finite().then_some(Left { part, of_interval: false, grew: false })
        }
        Disagreement::Absent(_) => None,
    }
}
