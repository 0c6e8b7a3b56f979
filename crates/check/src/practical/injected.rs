//! What changed V along a run under digital control, cause by cause: what the proof takes away, and what everything that it does not
//! speak of put in.
//!
//! Not from the paper, derived for this software. Between two events z, ż and ϑ̂ stand still, and with s = q̇ − z the plant gives
//!
//! ```text
//! V̇ = sᵀ(τ_applied + τ_ext − Yϑ) + sᵀMż − sᵀDs
//! ```
//!
//! with Y at the q, q̇ of the instant and the z, ż that stand. Let τ_ideal = −Ks + Yϑ̂ at that instant, τ_held the same law at the
//! exact q, q̇ of the sample whose command is in force, τ_reconstructed that with q̇ as the filter makes it of exact positions, and τ_computed
//! that with what was measured. Then, with the jumps [·] at samples,
//!
//! ```text
//! dissipated      −∫ sᵀ(K + D)s
//! held             ∫ sᵀ(τ_held − τ_ideal) + ∫ sᵀMż + Σ [½ sᵀMs]
//! reconstructed    ∫ sᵀ(τ_reconstructed − τ_held)
//! measured         ∫ sᵀ(τ_computed − τ_reconstructed)
//! limited          ∫ sᵀ(τ_applied − τ_computed)
//! rubbed           ∫ sᵀ(F tanh(z/ε) − F σ)
//! pushed           ∫ sᵀτ_ext
//! adaptation       ∫ sᵀYΔϑ + Σ [½ ΔϑᵀΓ⁻¹Δϑ]
//! ```
//!
//! add up to the change of V. Had z moved with ż and ϑ̂ with (7), sᵀMż and sᵀYΔϑ would cancel against the jumps; what is left of them is what
//! holding z and stepping ϑ̂ do. Dry friction F σ stands here, less what Y has in its place; what is recorded as external has both. Agents with a target of their own, chains, vehicles, spacecraft and all others that are by themselves have these terms
//! from their plant, their controller and the balance of its proof, [`Energy`](forwardstep_sim::Energy), where what stepping estimates does counts as held.
//! Where z reads positions itself, as under (3) and (aa6), their noise jumps with z and counts as held.

mod account;
mod course;
mod state;
mod tally;

use forwardstep_core::agent::VelocityFilter;
use forwardstep_sim::recording::{SampleTaken, Signal};
use forwardstep_sim::system::Known;
use forwardstep_sim::{Inside, Place, Setup, VelocitySensor, Watch, recorded_columns};

use self::account::Account;
pub use self::course::InjectionCourse;
use self::course::Taken;
use self::state::{Law, Places};
use self::tally::Tally;
use super::rates::Gains;
use crate::kinds::is_lagrangian;

/// A cause is named once it has put in this part of the largest V so far.
pub const NAMED_SHARE: f64 = 0.01;

/// That V is not taken to be smaller than this, J.
const FLOOR_J: f64 = 1e-6;

/// What changes V.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Injection {
    /// sᵀ(K + D)s, as the proof says.
    Dissipated,
    /// Command and reference stand still between samples, and commands come late.
    Held,
    /// Velocities are filtered differences of positions.
    Reconstructed,
    /// Measurements have noise and are rounded.
    Measured,
    /// Torques are limited and rounded.
    Limited,
    /// Friction is dry where the law takes it for smooth.
    Rubbed,
    /// Something acts from outside.
    Pushed,
    /// Estimates are stepped at samples.
    Adaptation,
}

impl Injection {
    /// All, in the order in which commands are traced from the ideal law to the plant.
    pub const ALL: [Injection; 8] = [
        Injection::Dissipated,
        Injection::Held,
        Injection::Reconstructed,
        Injection::Measured,
        Injection::Limited,
        Injection::Rubbed,
        Injection::Pushed,
        Injection::Adaptation,
    ];

    /// Its stable name.
    pub fn name(self) -> &'static str {
        match self {
            Injection::Dissipated => "dissipated",
            Injection::Held => "held",
            Injection::Reconstructed => "reconstructed",
            Injection::Measured => "measured",
            Injection::Limited => "limited",
            Injection::Rubbed => "rubbed",
            Injection::Pushed => "pushed",
            Injection::Adaptation => "adaptation",
        }
    }

    /// Its cause in words.
    pub fn words(self) -> &'static str {
        match self {
            Injection::Dissipated => "the damping of the law and of the robot",
            Injection::Held => "commands held between samples, and late",
            Injection::Reconstructed => "velocities from filtered differences",
            Injection::Measured => "noise and rounding of measurements",
            Injection::Limited => "limits and rounding of torques",
            Injection::Rubbed => "dry friction",
            Injection::Pushed => "external torques",
            Injection::Adaptation => "estimates stepped at samples",
        }
    }
}

/// V of one agent from the first sample to the end of its run, and what changed it.
#[derive(Clone, Debug, PartialEq)]
pub struct InjectionBalance {
    /// Index of the agent.
    pub agent: usize,
    /// V after the first sample, J.
    pub start_j: f64,
    /// V at the end, J.
    pub end_j: f64,
    /// The largest V at the end of a step, J.
    pub largest_j: f64,
    /// What each of [`Injection::ALL`] put in, J.
    pub terms_j: [f64; 8],
    /// The first that the proof does not allow and that put in more than [`NAMED_SHARE`] of the largest V so far, with its time, s.
    /// The proof allows what is dissipated, and pushes that end.
    pub first: Option<(Injection, f64)>,
}

impl InjectionBalance {
    /// What one of them put in, J.
    pub fn term_j(&self, injection: Injection) -> f64 {
        self.terms_j[injection as usize]
    }

    /// The change of V less all that was put in, J: the error of the quadrature.
    pub fn residual_j(&self) -> f64 {
        self.end_j - self.start_j - self.terms_j.iter().sum::<f64>()
    }
}

/// Names what the proof does not allow, the largest where several come at once: what has put in more than [`NAMED_SHARE`] of the largest V.
fn name_first(terms: &[f64; 8], largest: f64, pushes_end: bool, t_s: f64) -> Option<(Injection, f64)> {
    let allowed = |injection: Injection| match injection {
        Injection::Dissipated => true,
        Injection::Pushed => pushes_end,
        Injection::Held
        | Injection::Reconstructed
        | Injection::Measured
        | Injection::Limited
        | Injection::Rubbed
        | Injection::Adaptation => false,
    };
    let put_in = Injection::ALL.into_iter().filter(|injection| !allowed(*injection));
    let most = put_in.max_by(|a, b| terms[*a as usize].total_cmp(&terms[*b as usize]));
    most.filter(|injection| terms[*injection as usize] > NAMED_SHARE * largest).map(|injection| (injection, t_s))
}

/// Looks at the agents of a run: at robots under (6)–(7) in a network from their rows, at all others through the balance of their own law.
pub struct InjectionWatch<'a> {
    agents: Vec<Option<Looked<'a>>>,
    /// `None` once an agent is no longer looked at, which was a part of all sums until then.
    taken: Option<Taken>,
    /// The end of the last step.
    now_s: f64,
}

/// How an agent is looked at.
enum Looked<'a> {
    Robot(Box<Account<'a>>),
    ByItself(Tally),
}

impl<'a> InjectionWatch<'a> {
    /// `None` where control is continuous, or nothing is known of V of any agent.
    pub fn of(setup: &'a Setup) -> Option<Self> {
        let control = setup.control.as_ref()?;
        let columns = recorded_columns(setup).ok()?;
        let account = |index: usize| {
            let agent = &setup.agents[index];
            let pushes_end = agent.pushes.iter().all(|push| push.span_s()[1] < setup.time.end_s);
            if !is_lagrangian(agent) || setup.tracks(index) {
                // A law from outside may state no V.
                return matches!(agent.law.known(), Known::Checked).then(|| Looked::ByItself(Tally::new(pushes_end)));
            }
            let own: Vec<Signal> = columns.iter().filter(|c| c.agent == index).map(|c| c.signal).collect();
            let filter = match control.sensors.velocity {
                VelocitySensor::Measured => None,
                VelocitySensor::Filtered { cut_off_hz } => {
                    Some(VelocityFilter::new(core::f64::consts::TAU * cut_off_hz, agent.robot.axes.len()).ok()?)
                }
            };
            let (gains, places) = (Gains::of(agent)?, Places::of(&own)?);
            let law = Law { agent, gains, places, evaluator: agent.robot.kind.lagrangian()?.evaluator() };
            let clock = [1.0 / control.sample_hz, control.computation_delay_s];
            Account::new(law, filter, clock, pushes_end).map(|account| Looked::Robot(Box::new(account)))
        };
        let agents: Vec<_> = (0..setup.agents.len()).map(account).collect();
        let taken = Some(Taken::new(setup.time.end_s));
        agents.iter().any(Option::is_some).then_some(InjectionWatch { agents, taken, now_s: 0.0 })
    }

    /// The balance of every agent that was looked at.
    pub fn balances(&self) -> Vec<InjectionBalance> {
        let balance = |(agent, looked): (usize, &Option<Looked<'_>>)| match looked.as_ref()? {
            Looked::Robot(account) => account.balance(agent),
            Looked::ByItself(tally) => tally.balance(agent),
        };
        self.agents.iter().enumerate().filter_map(balance).collect()
    }

    /// V of all of them together over time, and what changed it.
    pub fn course(&self) -> InjectionCourse {
        self.taken.as_ref().map_or_else(InjectionCourse::default, |taken| taken.until(self.now_s, &self.balances()))
    }
}

impl Watch for InjectionWatch<'_> {
    fn sampled(&mut self, taken: SampleTaken<'_>) {
        if let Some(Some(Looked::Robot(account))) = self.agents.get_mut(taken.agent) {
            account.sample = Some((taken.now_s, taken.measured.to_vec()));
        }
    }

    fn inside(&mut self, at: Inside<'_>) {
        // When the first agent begins a step all have ended the one before.
        if at.place == Place::Start && self.taken.as_ref().is_some_and(|taken| taken.is_due(self.now_s)) {
            let balances = self.balances();
            self.taken.iter_mut().for_each(|taken| taken.point(self.now_s, &balances));
        }
        if at.place == Place::End {
            self.now_s = at.t_s;
        }
        let Some(slot) = self.agents.get_mut(at.agent) else { return };
        // Better nothing than a sum that leaves something out.
        let looked = match slot {
            None => return,
            Some(Looked::Robot(account)) => account.look(at),
            Some(Looked::ByItself(tally)) => tally.look(at),
        };
        if looked.is_none() {
            *slot = None;
            self.taken = None;
        }
    }
}
