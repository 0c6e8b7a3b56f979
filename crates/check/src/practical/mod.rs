//! Practical verdicts: what can be said of the loop as it is deployed, sampled, noisy and limited.
//!
//! None of this is from the paper: it is derived for this software, at the head of each file. Practical verdicts stand beside the
//! hypotheses of a theorem, not among them. They speak of a state or of one run, with a model that leaves something out, so that none of
//! them can make a theorem hold or fail; the exit status of `check` does not depend on them unless it is asked to.
//!
//! - `held`: how fast a mode may be under a command that is held, late, or taken from filtered differences.
//! - `resonance`: by how much such a mode swings up.
//! - `rates`: how fast the modes of a robot under (6)–(7) are, and what a sample does to V.
//! - `margin`: the sampling margin σ before a run.
//! - `led`: states that references lead robots through, at which it looks.
//! - `looped`: agents of any kind as a whole, with their references and what neighbours tell, by differences.
//! - `loads`: static torques against limits.
//! - `clipped`: commands that limits change in a trial.
//! - `postures`: those that both look at.
//! - `power`: how large s stays when something acts for ever.
//! - `injected`: what changed V along a sampled run, cause by cause.
//! - `gains`: what the reference dynamics make of s.
//! - `agreement`: what s adds to the disagreement, and how fast it moves the posture.
//! - `along`: all of it at the postures that a run reached.

mod agreement;
mod along;
mod clipped;
mod gains;
mod held;
mod injected;
mod led;
mod loads;
mod looped;
mod margin;
mod postures;
mod power;
pub(crate) mod rates;
mod resonance;
mod words;

use forwardstep_sim::{Adaptive, Setup, check_setup};

use self::led::Pace;
use self::loads::limits;
use crate::hypothesis::Named;
use crate::instance::designed;

pub use agreement::{AgreementBound, AxisBound};
pub use along::{Along, LoadReached, MarginReached, PowerReached, along};
pub use clipped::ClippedCommands;
pub use gains::{NoReferenceGains, Over, ReferenceGains};
pub use held::Hold;
pub use injected::{Injection, InjectionBalance, InjectionCourse, InjectionWatch, NAMED_SHARE};
pub use loads::StaticLoad;
pub use looped::{LoopAlong, LoopAt, LoopRate, Trial, WholeLoop};
pub(crate) use margin::fastest_reference_per_s;
pub use margin::{MarginAt, RECOMMENDED_MARGIN, SamplingMargin};
pub use power::{PowerBound, mean_power_w};
pub(crate) use power::{is_fed, start_energy_j};
pub use rates::{FastestDamping, fastest_damping};
pub(crate) use rates::{Gains, fastest_damping_of};
pub use resonance::Swing;

/// What a practical verdict says, from best to worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PracticalAnswer {
    /// A bound, of which nothing is required.
    Bound,
    /// There is enough of it.
    Adequate,
    /// There is enough of it, and less than recommended.
    Marginal,
    /// It cannot be told.
    NotShown,
    /// There is not enough of it.
    Inadequate,
}

impl PracticalAnswer {
    /// `bound`, `adequate`, `marginal`, `not shown` or `inadequate`.
    pub fn words(self) -> &'static str {
        match self {
            PracticalAnswer::Bound => "bound",
            PracticalAnswer::Adequate => "adequate",
            PracticalAnswer::Marginal => "marginal",
            PracticalAnswer::NotShown => "not shown",
            PracticalAnswer::Inadequate => "inadequate",
        }
    }
}

/// One practical verdict.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// How much of the longest useful period is used.
    SamplingMargin(SamplingMargin),
    /// Whether agents decay with all that is around s, and those under other laws than (6)–(7) at all.
    WholeLoop(WholeLoop),
    /// Whether the limits of torques suffice to stand still.
    StaticLoad(StaticLoad),
    /// Whether limits change commands.
    ClippedCommands(ClippedCommands),
    /// How large s stays.
    TrackingPower(PowerBound),
    /// What s does to agreement.
    TrackingDisagreement(AgreementBound),
}

impl Finding {
    /// Its stable name.
    pub fn name(&self) -> &'static str {
        match self {
            Finding::SamplingMargin(_) => "sampling-margin",
            Finding::WholeLoop(_) => "whole-loop",
            Finding::StaticLoad(_) => "static-load",
            Finding::ClippedCommands(_) => "clipped-commands",
            Finding::TrackingPower(_) => "tracking-power",
            Finding::TrackingDisagreement(_) => "tracking-disagreement",
        }
    }

    /// What it says.
    pub fn answer(&self) -> PracticalAnswer {
        match self {
            Finding::SamplingMargin(margin) => margin.answer(),
            Finding::WholeLoop(found) => found.answer(),
            Finding::StaticLoad(load) => load.answer(),
            Finding::ClippedCommands(clipped) => clipped.answer(),
            Finding::TrackingPower(_) => PracticalAnswer::Bound,
            Finding::TrackingDisagreement(bound) => bound.answer(),
        }
    }

    /// What it is about, in words.
    pub fn about(&self) -> &'static str {
        words::about(self)
    }

    /// The numbers in it, by stable names that end in their units.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        match self {
            Finding::SamplingMargin(margin) => {
                let always = [
                    ("sigma", margin.worst.sigma),
                    ("start_sigma", margin.start.sigma),
                    ("start_fastest_mode_per_s", margin.start.fastest_per_s),
                    ("period_s", margin.period_s),
                ];
                let some = [("longest_period_s", margin.longest_s), ("recommended_period_s", margin.recommended_s)];
                always.into_iter().chain(some.into_iter().filter_map(|(name, value)| Some((name, value?)))).collect()
            }
            Finding::WholeLoop(found) => {
                let (start, last) = (&found.start, found.last());
                let mut all = vec![("period_s", found.period_s), ("start_rate_per_s", start.rate().per_s)];
                all.push(("rate_per_s", last.alone.per_s));
                all.extend(last.rate().ideal_per_s.map(|ideal| ("ideal_rate_per_s", ideal)));
                all.extend(last.network.map(|network| ("network_rate_per_s", network.per_s)));
                all.extend(last.passed_on.map(|[part, _]| ("passed_on", part)));
                all.extend(start.leftmost.map(|[leftmost, _]| ("leftmost", leftmost)));
                all.extend(
                    last.decay_per_s
                        .into_iter()
                        .flat_map(|[own, ideal]| [("decay_per_s", own), ("ideal_decay_per_s", ideal)]),
                );
                all.extend(found.lasting_per_s().map(|rate| ("growth_per_s", rate)));
                all.extend(found.trial.lost_s.map(|t_s| ("lost_s", t_s)));
                all
            }
            Finding::TrackingPower(bound) => vec![
                ("mean_w", bound.mean_w),
                ("start_w", bound.start_w),
                ("push_w", bound.push_w),
                ("noise_w", bound.noise_w),
                ("positions_w", bound.positions_w),
                ("steps_w", bound.steps_w),
                ("held_w", bound.held_w),
                ("between_w", bound.between_w),
                ("friction_w", bound.friction_w),
                ("forced_factor", bound.swing.forced),
                ("started_factor", bound.swing.started),
                ("noise_factor", bound.swing.noise),
                ("span_s", bound.span_s),
            ],
            Finding::TrackingDisagreement(bound) => bound.numbers(),
            Finding::StaticLoad(load) => vec![("torque", load.torque), ("limit", load.limit), ("share", load.share())],
            Finding::ClippedCommands(clipped) => vec![("share", clipped.share()), ("until_s", clipped.until_s)],
        }
    }

    /// What was found, in words.
    pub fn because(&self) -> String {
        words::because(self)
    }
}

/// The practical verdicts on a setup before it runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Practical {
    /// In the order in which they should be read.
    pub findings: Vec<Finding>,
}

impl Practical {
    /// The worst answer; `None` where nothing is said.
    pub fn worst(&self) -> Option<PracticalAnswer> {
        self.findings.iter().map(Finding::answer).max()
    }
}

/// What can be said of `setup` as it is deployed; nothing where it has no meaning ([`check_setup`]).
pub fn practical(setup: &Setup) -> Practical {
    if check_setup(setup).is_err() {
        return Practical::default();
    }
    let designed = designed(setup);
    let setup = designed.as_ref().unwrap_or(setup);
    let limited = (0..setup.agents.len()).any(|agent| limits(setup, agent).is_some());
    let way = if limited || setup.control.is_some() { led::way(setup, Pace::Even) } else { Vec::new() };
    let whole = WholeLoop::on(setup, &way);
    let mut margin = SamplingMargin::on(setup, &way);
    // Where parameters are known, so that neither freezes what adapts.
    if let (Some(margin), true) = (&mut margin, whole.as_ref().is_some_and(WholeLoop::decays)) {
        let knows = |agent: &Named| setup.agents.get(agent.index).is_some_and(|agent| !agent.law.is::<Adaptive>());
        margin.held_by_references = margin.start.is_unstable && knows(&margin.start.agent);
    }
    let load = StaticLoad::on(setup, &way).map(Finding::StaticLoad);
    let clipped = ClippedCommands::of(setup).map(Finding::ClippedCommands);
    // What may grow has no bound, and where samples slow what decays, s acts back on the references, which are taken as they are without it.
    let unbounded = whole.as_ref().is_some_and(|whole| {
        let grows = whole.answer() >= PracticalAnswer::NotShown || whole.lasting_per_s().is_some();
        grows || whole.start.slowed_per_s().is_some()
    });
    let power = PowerBound::on(setup, margin.as_ref(), || {
        if setup.control.is_some() { led::way(setup, Pace::Close) } else { Vec::new() }
    });
    let power = power.filter(|_| !unbounded);
    let margin = margin.map(Finding::SamplingMargin);
    let agreement = AgreementBound::of(setup, power.as_ref()).filter(|_| !unbounded).map(Finding::TrackingDisagreement);
    let power = power.map(Finding::TrackingPower);
    let whole = whole.map(Finding::WholeLoop);
    Practical { findings: [margin, whole, load, clipped, power, agreement].into_iter().flatten().collect() }
}
