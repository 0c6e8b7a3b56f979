//! The sampling margin σ of agents under (6)–(7): how much of the longest useful period is used.
//!
//! Not from the paper, derived for this software; `rates` derives λ and `held` the largest k. σ = h λ / k, which is ½ h λ where
//! velocities are measured and commands act at once. All of it is local: M and Y are those of one state.

use forwardstep_sim::{Adaptive, DynamicsAt, Setup};

use super::PracticalAnswer;
use super::held::Hold;
use super::postures::each_posture;
use super::rates::{Gains, Rates, dynamics, fastest_damping};
use crate::hypothesis::Named;

/// σ should not exceed this: the held damping then does not overshoot where commands act at once, and there is as much room for what
/// is not in the model.
pub const RECOMMENDED_MARGIN: f64 = 0.5;

/// σ of the agent and the posture for which sampling is worst, at the start and between the starts of all.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingMargin {
    /// The worst at the start.
    pub start: MarginAt,
    /// The worst of all postures that were looked at, those of the start included.
    pub worst: MarginAt,
    /// Postures that were looked at.
    pub postures: usize,
    /// h, s.
    pub period_s: f64,
    /// How commands reach the robot.
    pub hold: Hold,
    /// The period at which σ is 1 in the worst of them, s; `None` where the delay is too long for any.
    pub longest_s: Option<f64>,
    /// The period at which it is [`RECOMMENDED_MARGIN`], s.
    pub recommended_s: Option<f64>,
    /// σ of the damping alone does not exceed this at any position of any agent, by certified bounds of M; `None` without those.
    pub anywhere: Option<f64>,
    /// How many adaptive agents follow targets of their own. They adapt with the s of the sample that gave Y, for which no margin is
    /// known: their σ is that of the damping alone.
    pub adaptation_left_out: usize,
}

/// σ at one posture.
#[derive(Clone, Debug, PartialEq)]
pub struct MarginAt {
    /// The agent.
    pub agent: Named,
    /// σ.
    pub sigma: f64,
    /// The same for the damping alone.
    pub damping_sigma: f64,
    /// ½ h λ_max(M⁻¹ (K + ½ h P)), where that says something: nothing is late or filtered, and the agent adapts.
    pub frozen_sigma: Option<f64>,
    /// λ_max(M⁻¹ K), the fastest mode, 1/s.
    pub fastest_per_s: f64,
    /// λ, 1/s: the same where nothing adapts.
    pub sampled_per_s: f64,
}

impl SamplingMargin {
    /// Of the agents of a setup under (6)–(7); `None` when control is continuous, there are none, or no mass matrix can be factored.
    pub fn of(setup: &Setup) -> Option<SamplingMargin> {
        let control = setup.control.as_ref()?;
        let (hold, period_s) = (Hold::of(control), 1.0 / control.sample_hz);
        let gains: Vec<Option<Gains>> = (0..setup.agents.len()).map(|agent| gains(setup, agent)).collect();
        let those: Vec<usize> = (0..gains.len()).filter(|agent| gains[*agent].is_some()).collect();
        let (mut start, mut worst): (Option<MarginAt>, Option<MarginAt>) = (None, None);
        let mut postures = 0;
        each_posture(setup, &those, |agent, q, at_start| {
            postures += 1;
            let rates = gains[agent].as_ref().and_then(|gains| gains.rates(&resting(setup, agent, q, at_start)?));
            let Some(rates) = rates else { return };
            let found = || MarginAt::of(Named::of(setup, agent), &rates, hold, period_s);
            for worst in [Some(&mut worst), at_start.then_some(&mut start)].into_iter().flatten() {
                if worst.as_ref().is_none_or(|worst| rates.sampled_per_s > worst.sampled_per_s) {
                    *worst = Some(found());
                }
            }
        });
        let (start, worst) = (start?, worst?);
        let anywhere_per_s = fastest_damping(setup).and_then(|found| found.anywhere_per_s);
        let learners = (0..setup.agents.len()).filter(|agent| setup.tracks(*agent));
        Some(SamplingMargin {
            postures,
            period_s,
            hold,
            longest_s: hold.longest_period_s(worst.sampled_per_s, period_s),
            recommended_s: hold.longest_period_s(worst.sampled_per_s / RECOMMENDED_MARGIN, period_s),
            anywhere: anywhere_per_s.map(|rate| period_s * rate / hold.largest_gain(period_s)),
            adaptation_left_out: learners.filter(|agent| setup.agents[*agent].law.is::<Adaptive>()).count(),
            start,
            worst,
        })
    }

    /// Inadequate only where a mode is unstable at the start of an agent; not shown where one is at a posture between the starts, or
    /// where V may grow from sample to sample though none is.
    pub fn answer(&self) -> PracticalAnswer {
        if self.start.is_unstable() {
            PracticalAnswer::Inadequate
        } else if self.worst.sigma >= 1.0 {
            PracticalAnswer::NotShown
        } else if self.worst.sigma > RECOMMENDED_MARGIN {
            PracticalAnswer::Marginal
        } else {
            PracticalAnswer::Adequate
        }
    }
}

impl MarginAt {
    fn of(agent: Named, rates: &Rates, hold: Hold, period_s: f64) -> MarginAt {
        let k = hold.largest_gain(period_s);
        let [fastest_per_s, sampled_per_s] = [rates.damping_per_s, rates.sampled_per_s];
        MarginAt {
            agent,
            sigma: period_s * sampled_per_s / k,
            damping_sigma: period_s * fastest_per_s / k,
            frozen_sigma: if hold.is_ideal() { rates.frozen(period_s) } else { None },
            fastest_per_s,
            sampled_per_s,
        }
    }

    /// Whether a mode grows there, by the damping alone or, with Y frozen, by damping and adaptation together.
    pub fn is_unstable(&self) -> bool {
        self.damping_sigma >= 1.0 || self.frozen_sigma.is_some_and(|sigma| sigma >= 1.0)
    }
}

/// M and Y of an agent at `q`: with z = q̇, which is zero but at the start, and ż as large as the sign makes it where a leader is followed.
fn resting(setup: &Setup, agent: usize, q: &[f64], at_start: bool) -> Option<DynamicsAt> {
    let own = &setup.agents[agent];
    let dz = setup.following().filter(|_| !setup.tracks(agent)).map_or(0.0, |following| following.gain);
    let rest = vec![0.0; q.len()];
    let dq = if at_start { &own.start.dq } else { &rest };
    dynamics(own, q, dq, dz)
}

/// K and Γ of an agent as far as a margin counts them.
pub(super) fn gains(setup: &Setup, agent: usize) -> Option<Gains> {
    let gains = Gains::of(&setup.agents[agent])?;
    Some(if setup.tracks(agent) { gains.damping_alone() } else { gains })
}
