//! How large s stays, as power: what the mean of sᵀKs cannot exceed when something acts on the loop for ever.
//!
//! Not from the paper, derived for this software. Under (6)–(7) with a disturbance d of the torque, and E whatever else feeds V,
//!
//! ```text
//! V̇ ≤ −sᵀKs + sᵀd + E
//! ```
//!
//! Over a span T from t₀, let x² be the mean of sᵀKs and D² that of dᵀK⁻¹d. The mean of sᵀd = (K^½ s)ᵀ(K^−½ d) is at most x D, and V is
//! never negative, so that x² ≤ x D + E + V(t₀)/T, and
//!
//! ```text
//! x ≤ ½ D + √(¼ D² + E + V(t₀)/T)
//! ```
//!
//! For several agents all of it adds up. Sampled, V loses (1 − σ) sᵀKs in place of sᵀKs (`rates`), which is to be put for K throughout:
//! then x² ≤ (½ D + √(¼ D² + (1 − σ)(E + V(t₀)/T)))² / (1 − σ)². Where commands are late or velocities filtered, V may gain for a while though σ < 1: a
//! mode swings up by factors that `resonance` works out, for forces, what is left of V(t₀), and noise: the larger of both bounds is taken.
//!
//! A torque that is held is that of its sample, δ h late, while the motion asks for w = M ż + C z + g as it is now: over a period
//! d is off by ẇ times the time since the sample, whose mean square is h² (⅓ + δ + δ²). And a filter gives the velocity of
//! ℓ = h (½ + 1/(e^(ωh) − 1)) ago, n = −ℓ q̈. Both are worked out along the references with s ≡ 0, q̈ = ż, and vanish at rest; ẇ
//! is that of a moment at each of the states that are looked at, which may be farther from each other than a motion takes to swing. A filter begins with
//! zero, so that at sample k it still lacks e^(−ωh k) q̇(0): over the span T the mean of nᵀKn is h q̇(0)ᵀK q̇(0)/((1 − e^(−2ωh)) T). Until the
//! first torque comes, δ h after the start, all of w is missing: d = −w, whose mean square is δ h wᵀK⁻¹w/T.
//!
//! All of this is s at the samples. Between them z is held and q̇ moves on, so that s gains ż times the time since the sample: a saw tooth whose
//! mean square is ⅓ h² żᵀKż, and which adds at most its root to that of the mean of sᵀKs.
//!
//! A velocity that is measured with an error n makes d = −K n, so that D² is the mean of nᵀKn: tr K times the mean square of an entry. That
//! of a step Δ of rounding is Δ²/4, since a robot that hardly moves stays within one step; of positions, whose differences count, Δ²/12. Filtered differences of positions, a = e^(−ωh), with an error e of variance e² at every sample,
//! have n = (1 − a) Σ_j aʲ (e_{k−j} − e_{k−j−1})/h, whose mean square is 2 e² (1 − a)²/(h² (1 + a)). n enters the adaptation too, as −nᵀYΔϑ,
//! whose mean is zero since Y is one sample older. With noise the bound is thus one to be
//! expected, not one for certain.
//!
//! An error ν of positions enters M, C and g: d = w(q + ν) − w(q), to first order ∂w/∂q_j times the error of axis j, independent of the others for noise, and
//! all of half a step for rounding. What references hear of it makes ż uncertain: by at most f² |ν| and f times the error of a velocity, of both
//! ends of a link, with f how fast they answer ([`fastest_reference_per_s`](super::margin::fastest_reference_per_s)), which M(q + ν) − M(q) bears, and
//! between samples the saw tooth does.
//!
//! Dry friction F σ, σ ∈ Sgn q̇, which the law takes for F tanh(z/ε), feeds V by κ ε F at every joint at most, κ = max x (1 − tanh x)
//! ([`SMOOTHING_LOSS`](forwardstep_core::robot::SMOOTHING_LOSS)): E is the sum of these. That of a run holds σ over short periods, and what
//! that adds vanishes with them.

use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::{Adaptive, AgentSetup, Control, ReferenceFamily, Setup, VelocitySensor};
use nalgebra::{DMatrix, DVector};

use super::held::Hold;
use super::led::Led;
use super::margin::{SamplingMargin, fastest_reference_per_s};
use super::rates::{Gains, dynamics};
use super::resonance::Swing;
use crate::kinds::is_lagrangian;
use crate::late_leader::sign_lags;
use crate::surroundings::dry_loss_w;

/// Mean square of what rounding to multiples of one does to what moves over many of them.
const ROUNDING: f64 = 1.0 / 12.0;
/// Its largest square, which is that of a velocity that stays within one step: a robot that hardly moves.
const WITHIN: f64 = 0.25;

/// States of an agent at which errors of positions are tried.
const POSITIONS: usize = 64;

/// What feeds Σ V of all agents under (6)–(7), and what Σ sᵀKs is at most on the average over a span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerBound {
    /// Agents that are counted.
    pub agents: usize,
    /// T, s.
    pub span_s: f64,
    /// V(t₀)/T, W.
    pub start_w: f64,
    /// D² of what pushes, W.
    pub push_w: f64,
    /// D² of measurement errors, W: expected, not certain.
    pub noise_w: f64,
    /// D² of M, C and g at positions that are measured with errors, W: expected, not certain.
    pub positions_w: f64,
    /// D² of torques that come in steps, W.
    pub steps_w: f64,
    /// D² of torques that are held and velocities that are filtered while robots move as their references ask, W.
    pub held_w: f64,
    /// The mean of sᵀKs of what s gains from one sample to the next while references move, W.
    pub between_w: f64,
    /// E, which dry friction feeds at most, W.
    pub friction_w: f64,
    /// σ; zero in continuous time.
    pub sigma: f64,
    /// What commands that are late or velocities that are filtered multiply all this by.
    pub swing: Swing,
    /// Whether noise is independent from sample to sample, which rounding is not.
    pub is_white: bool,
    /// The bound on the mean of Σ sᵀKs, W.
    pub mean_w: f64,
}

/// x² for D² = `drive_w`, E = `supply_w` and V(t₀)/T = `start_w`, all in W, where V loses (1 − σ) sᵀKs; infinite from σ = 1 on.
pub fn mean_power_w(drive_w: f64, supply_w: f64, start_w: f64, sigma: f64) -> f64 {
    let kept = 1.0 - sigma;
    if kept <= 0.0 {
        return f64::INFINITY;
    }
    let x = 0.5 * drive_w.sqrt() + (0.25 * drive_w + kept * (supply_w + start_w)).sqrt();
    x * x / (kept * kept)
}

impl PowerBound {
    /// Over the whole run of a setup with its sampling margin and states on the way of its agents; `None` where there is nothing that feeds V but its start, or where V(0), a
    /// push, what a sign that lags does, or σ is not known before the run.
    pub(super) fn on(
        setup: &Setup,
        margin: Option<&SamplingMargin>,
        way: impl FnOnce() -> Vec<Led>,
    ) -> Option<PowerBound> {
        // A sign that lags drives references with more than they ask for by themselves.
        let lags = setup.following().is_some_and(|following| sign_lags(setup, following));
        if lags || !is_fed(setup) {
            return None;
        }
        let way = way();
        let (mut start_j, mut push_w) = (0.0, 0.0);
        let span_s = setup.time.end_s;
        let grown = match setup.control {
            Some(_) => (margin?.worst.sigma, margin?.swing()),
            None => (0.0, Swing::NONE),
        };
        let mut parts = PowerBound::of_none(setup, span_s, grown);
        for (index, agent) in setup.agents.iter().enumerate().filter(|(_, agent)| is_lagrangian(agent)) {
            let gains = Gains::of(agent)?;
            start_j += start_energy_j(setup, index, &gains)?;
            push_w += pushed_w(agent, &gains, [0.0, span_s])?;
            let own: Vec<&Led> = way.iter().filter(|state| state.agent == index).collect();
            parts.add(setup, index, &gains, &own)?;
            parts.between_w += heard_between_w_of(setup, index, &gains);
        }
        PowerBound { start_w: start_j / span_s, push_w, ..parts }.worked_out()
    }

    /// Of no agent yet, over a span, with σ and the swing of the worst of them.
    pub(super) fn of_none(setup: &Setup, span_s: f64, (sigma, swing): (f64, Swing)) -> PowerBound {
        PowerBound {
            agents: 0,
            span_s,
            start_w: 0.0,
            push_w: 0.0,
            noise_w: 0.0,
            positions_w: 0.0,
            steps_w: 0.0,
            held_w: 0.0,
            between_w: 0.0,
            friction_w: 0.0,
            sigma,
            swing,
            is_white: is_white(setup),
            mean_w: f64::NAN,
        }
    }

    /// Adds what an agent and the loop around it feed along these of its states, in the order of time; `None` where that cannot be told.
    pub(super) fn add(&mut self, setup: &Setup, index: usize, gains: &Gains, way: &[&Led]) -> Option<()> {
        let agent = &setup.agents[index];
        self.agents += 1;
        self.friction_w += dry_loss_w(agent).unwrap_or(0.0);
        if let Some(control) = &setup.control {
            self.noise_w += noise_w_of(control, gains);
            self.positions_w += positions_w_of(setup, control, index, gains, way)?;
            self.steps_w += steps_w_of(control, gains)?;
            self.held_w += held_w_of(control, agent, gains, way, self.span_s)?;
            self.between_w += between_w_of(control, gains, way, self.span_s);
        }
        Some(())
    }

    /// Whether it is one to be expected, not one for certain: with noise, and between samples.
    pub(super) fn is_expected(&self) -> bool {
        self.noise_w > 0.0 || self.sigma > 0.0
    }

    /// x² without σ, of modes that swing up; `others` is D without that of noise.
    fn swung_w(&self, others: f64) -> f64 {
        let Swing { forced, started, noise } = self.swing;
        let noise = if self.is_white { noise } else { forced };
        let drive = forced.sqrt() * others + (noise * self.noise_w).sqrt();
        mean_power_w(drive * drive, forced.max(started) * self.friction_w, started * self.start_w, 0.0)
    }

    /// The same with [`PowerBound::mean_w`]: the D of pushes, of noise and of steps add up, at worst. `None` where it is not finite, and where it
    /// is zero: then what is left out is all there is.
    pub(super) fn worked_out(self) -> Option<PowerBound> {
        let others = [self.push_w, self.positions_w, self.steps_w, self.held_w].into_iter().map(f64::sqrt).sum::<f64>();
        let drive = others + self.noise_w.sqrt();
        let swung = self.swung_w(others);
        let sampled_w = mean_power_w(drive * drive, self.friction_w, self.start_w, self.sigma).max(swung);
        let root = sampled_w.sqrt() + self.between_w.sqrt();
        let mean_w = root * root;
        (mean_w > 0.0 && mean_w.is_finite()).then_some(PowerBound { mean_w, ..self })
    }
}

/// Whether what is measured has independent errors alone.
fn is_white(setup: &Setup) -> bool {
    setup.control.as_ref().is_none_or(|control| {
        let quantum = match control.sensors.velocity {
            VelocitySensor::Measured => control.sensors.velocity_quantum,
            VelocitySensor::Filtered { .. } => control.sensors.position_quantum,
        };
        quantum == 0.0
    })
}

/// Whether something besides the start feeds V: noise and samples, pushes, or dry friction.
pub(crate) fn is_fed(setup: &Setup) -> bool {
    let fed = |agent: &AgentSetup| is_lagrangian(agent) && (!agent.pushes.is_empty() || dry_loss_w(agent).is_some());
    setup.control.is_some() || setup.agents.iter().any(fed)
}

/// D² of the measurement errors of an agent, W.
fn noise_w_of(control: &Control, gains: &Gains) -> f64 {
    let sensors = &control.sensors;
    let square = |noise: f64, quantum: f64, share: f64| noise * noise + share * quantum * quantum;
    let mean_square = match sensors.velocity {
        VelocitySensor::Measured => square(sensors.velocity_noise, sensors.velocity_quantum, WITHIN),
        VelocitySensor::Filtered { .. } => {
            let omega_h = Hold::of(control).cut_off_rad_s.unwrap_or(f64::INFINITY) / control.sample_hz;
            let quick = -libm::expm1(-omega_h);
            let rate = quick * control.sample_hz;
            square(sensors.position_noise, sensors.position_quantum, ROUNDING) * 2.0 * rate * rate / (2.0 - quick)
        }
    };
    mean_square * gains.damping.trace()
}

/// The standard deviation of a measured position, or the most that rounding makes of one that stays within a step, in its unit.
fn position_error(control: &Control) -> (f64, f64) {
    (control.sensors.position_noise, 0.5 * control.sensors.position_quantum)
}

/// The root of the mean square of what errors of what is heard make of ż on one axis, at most, about; `gains` give the error of a velocity.
fn heard_acceleration(setup: &Setup, agent: usize, gains: &Gains) -> f64 {
    let Some(control) = &setup.control else { return 0.0 };
    if setup.tracks(agent) {
        return 0.0;
    }
    let (noise, rounding) = position_error(control);
    let answers = fastest_reference_per_s(setup);
    let velocity = (noise_w_of(control, gains) / gains.damping.trace()).sqrt();
    core::f64::consts::SQRT_2 * answers * (answers * libm::hypot(noise, rounding) + velocity)
}

/// The mean of sᵀKs of what s gains from one sample to the next since what is heard has errors, W.
fn heard_between_w_of(setup: &Setup, agent: usize, gains: &Gains) -> f64 {
    let heard = heard_acceleration(setup, agent, gains);
    let Some(control) = &setup.control else { return 0.0 };
    let period_s = 1.0 / control.sample_hz;
    // Until a torque that is δ h late acts, s gains all that ż has changed by.
    let late = control.computation_delay_s / period_s;
    heard * heard * gains.damping.trace() * period_s * period_s * (1.0 / 3.0 + late + late * late)
}

/// D² of M, C and g at positions with errors, the largest of some of these states of an agent, W; `None` where K cannot be inverted, or nothing can be worked
/// out.
fn positions_w_of(setup: &Setup, control: &Control, index: usize, gains: &Gains, way: &[&Led]) -> Option<f64> {
    let (noise, rounding) = position_error(control);
    if noise == 0.0 && rounding == 0.0 {
        return Some(0.0);
    }
    let agent = &setup.agents[index];
    let compliance = gains.damping.clone().cholesky()?.inverse();
    let heard = heard_acceleration(setup, index, gains);
    let theta = DVector::from_column_slice(&agent.robot.theta);
    let n = agent.start.q.len();
    let at = |q: &[f64], dq: &[f64], dz: &[f64]| {
        let found = dynamics(agent, q, dq, dz)?;
        let asked = DMatrix::from_row_slice(n, theta.len(), &found.regressor) * &theta;
        Some((asked, DMatrix::from_row_slice(n, n, &found.mass)))
    };
    let of = |q: &[f64], dq: &[f64], dz: &[f64]| {
        let (asked, mass) = at(q, dq, dz)?;
        let (mut square, mut sum) = (0.0, DVector::zeros(n));
        for axis in 0..n {
            let error = libm::hypot(noise, rounding);
            let mut there = q.to_vec();
            there[axis] += error;
            let (moved, heavier) = at(&there, dq, dz)?;
            let (change, slope) = ((moved - &asked) / error, (heavier - &mass) / error);
            let heard = heard * heard * (slope.transpose() * &compliance * slope).trace();
            square += change.dot(&(&compliance * &change)) + heard;
            sum += change.abs().add_scalar(heard.sqrt());
        }
        Some(noise * noise * square + rounding * rounding * sum.dot(&(compliance.abs() * &sum)))
    };
    let start = &agent.start;
    let rest = vec![0.0; n];
    let every = way.len().div_ceil(POSITIONS).max(1);
    let led = way.iter().step_by(every).filter_map(|state| of(&state.q, &state.dq, &state.dz));
    of(&start.q, &start.dq, &rest).into_iter().chain(led).reduce(f64::max)
}

/// D² of a torque that is off by half a step of its actuator at most on every axis, as it can be for ever where nothing moves, W; `None` where K
/// cannot be inverted.
fn steps_w_of(control: &Control, gains: &Gains) -> Option<f64> {
    let half = 0.5 * control.actuators.torque_quantum;
    Some(half * half * gains.damping.clone().cholesky()?.inverse().abs().sum())
}

/// D² of torques that are held and velocities that are filtered along these states of an agent, in the order of time, as the mean over a
/// span, W; `None` where K cannot be inverted.
fn held_w_of(control: &Control, agent: &AgentSetup, gains: &Gains, way: &[&Led], span_s: f64) -> Option<f64> {
    let (hold, period_s) = (Hold::of(control), 1.0 / control.sample_hz);
    let late = hold.delay_s / period_s;
    let since = period_s * period_s * (1.0 / 3.0 + late + late * late);
    let lag_s = hold.filter_lag(period_s) * period_s;
    let compliance = gains.damping.clone().cholesky()?.inverse();
    let asked = |state: &Led| {
        let found = dynamics(agent, &state.q, &state.dq, &state.dz)?;
        let theta = DVector::from_column_slice(&agent.robot.theta);
        Some(DMatrix::from_row_slice(state.q.len(), theta.len(), &found.regressor) * theta)
    };
    // ẇᵀK⁻¹ẇ, for the mean of ẇ from one state to a later one.
    let changes = |(one_s, from): &(f64, DVector<f64>), (later_s, to): &(f64, DVector<f64>)| {
        let rate = (to - from) / (later_s - one_s);
        (later_s > one_s).then(|| rate.dot(&(&compliance * &rate)))
    };
    let worked_out = |state: &Led| Some((state.t_s, asked(state)?));
    let (mut held, mut before) = (0.0, None);
    for state in way {
        let Some(here) = worked_out(state) else { continue };
        let now = state.soon.as_ref().and_then(|soon| changes(&here, &worked_out(soon)?));
        if let Some((last, then)) = &before {
            // A motion may have swung several times from one state to the next.
            let largest = [*then, now, changes(last, &here)].into_iter().flatten().fold(0.0, f64::max);
            held += (here.0 - last.0).max(0.0) * since * largest;
        }
        before = Some((here, now));
    }
    let lagging = lag_s * lag_s * mean_acceleration_w_s2(gains, way, span_s);
    let begun = way.first().map_or(0.0, |first| begun_w_of(control, &first.dq, gains, span_s));
    // Until the first torque comes there is none.
    let fallen =
        way.first().and_then(|first| asked(first)).map_or(0.0, |w| hold.delay_s * w.dot(&(&compliance * &w)) / span_s);
    let drive = [held / span_s, lagging, begun, fallen].into_iter().map(f64::sqrt).sum::<f64>();
    Some(drive * drive)
}

/// D² of a filter that takes a robot for at rest when a run begins, as the mean over a span, W.
fn begun_w_of(control: &Control, dq: &[f64], gains: &Gains, span_s: f64) -> f64 {
    let Some(cut_off_rad_s) = Hold::of(control).cut_off_rad_s else { return 0.0 };
    let (dq, period_s) = (DVector::from_column_slice(dq), 1.0 / control.sample_hz);
    let forgotten = -libm::expm1(-2.0 * cut_off_rad_s * period_s);
    period_s * dq.dot(&(&gains.damping * &dq)) / (forgotten * span_s)
}

/// The mean of sᵀKs of what s gains from one sample to the next along these states of an agent, W.
fn between_w_of(control: &Control, gains: &Gains, way: &[&Led], span_s: f64) -> f64 {
    mean_acceleration_w_s2(gains, way, span_s) / (3.0 * control.sample_hz * control.sample_hz)
}

/// The mean of żᵀKż over a span, in W/s².
fn mean_acceleration_w_s2(gains: &Gains, way: &[&Led], span_s: f64) -> f64 {
    let of = |state: &Led| {
        let dz = DVector::from_column_slice(&state.dz);
        dz.dot(&(&gains.damping * &dz))
    };
    // A transient may be shorter than what is between two states: the larger of both ends.
    let pair = |pair: &[&Led]| (pair[1].t_s - pair[0].t_s).max(0.0) * of(pair[0]).max(of(pair[1]));
    way.windows(2).map(pair).sum::<f64>() / span_s
}

/// V(0) of an agent, J; `None` where z(0) follows from what is heard.
pub(crate) fn start_energy_j(setup: &Setup, index: usize, gains: &Gains) -> Option<f64> {
    match setup.reference_of(index).interface().family {
        ReferenceFamily::Consensus | ReferenceFamily::Desired | ReferenceFamily::Leader => {}
        ReferenceFamily::PureIntegral
        | ReferenceFamily::Backstepping
        | ReferenceFamily::Target
        | ReferenceFamily::DesiredTarget
        | ReferenceFamily::Own => return None,
    }
    let agent = &setup.agents[index];
    let (q, dq) = (&agent.start.q, &agent.start.dq);
    let z = agent.start.reference.first().unwrap_or(dq);
    let s = DVector::from_iterator(dq.len(), dq.iter().zip(z).map(|(dq, z)| dq - z));
    let mass = DMatrix::from_row_slice(q.len(), q.len(), &dynamics(agent, q, dq, &vec![0.0; q.len()])?.mass);
    let kinetic = 0.5 * s.dot(&(mass * &s));
    let Some(gamma) = &gains.adaptation else { return Some(kinetic) };
    let law: &Adaptive = agent.law.downcast()?;
    let errors = law.estimate_start.iter().zip(&agent.robot.theta).map(|(estimate, theta)| estimate - theta);
    let error = DVector::from_iterator(agent.robot.theta.len(), errors);
    Some(kinetic + 0.5 * error.dot(&gamma.clone().cholesky()?.solve(&error)))
}

/// D² of the pushes of an agent from one time to another, at most, W; `None` where one depends on the motion.
pub(super) fn pushed_w(agent: &AgentSetup, gains: &Gains, [first_s, last_s]: [f64; 2]) -> Option<f64> {
    let inverse = gains.damping.clone().cholesky()?.inverse().abs();
    let mut drive = 0.0;
    for push in &agent.pushes {
        let [begins_s, ends_s] = push.span_s();
        let (begins_s, ends_s) = (begins_s.max(first_s), ends_s.min(last_s));
        if begins_s < ends_s {
            let peak = peak(push, gains.damping.nrows(), [begins_s, ends_s])?;
            drive += (peak.dot(&(&inverse * &peak)) * (ends_s - begins_s) / (last_s - first_s)).sqrt();
        }
    }
    Some(drive * drive)
}

/// The largest size of every entry of τ_ext while a push acts.
fn peak(push: &Push, axes: usize, [begins_s, ends_s]: [f64; 2]) -> Option<DVector<f64>> {
    let course = match &push.effect {
        Effect::Torque(course) => course,
        Effect::Wrench { .. } | Effect::SpringOnAxes { .. } | Effect::SpringOnPoint { .. } => return None,
    };
    let largest = |axis: usize| match course {
        Course::Each(functions) => match functions.get(axis)? {
            Function::Constant(value) => Some(value.abs()),
            Function::Formula(formula) => {
                let within = formula.bounds(begins_s, ends_s);
                Some(within.low.abs().max(within.high.abs()))
            }
        },
        Course::Table(table) => {
            let column = table.values.iter().skip(axis).step_by(table.components().max(1));
            Some(column.fold(0.0_f64, |most, value| most.max(value.abs())))
        }
    };
    let all: Option<Vec<f64>> = (0..axes).map(largest).collect();
    all.map(DVector::from_vec).filter(|peak| peak.iter().all(|peak| peak.is_finite()))
}
