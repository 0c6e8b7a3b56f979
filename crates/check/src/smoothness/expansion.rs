//! The torque of one agent around an instant, as a truncated Taylor series.

use forwardstep_core::reference::{Exchange, Heard, Measured, Reference, ReferenceOut};
use forwardstep_core::robot::TwoVelocity;
use forwardstep_core::{LengthError, ResolvedGain, Scalar};
use forwardstep_sim::recording::Signal;
use forwardstep_sim::reference::Dynamics;
use forwardstep_sim::{HeardAt, NetworkJump, Series, SeriesEvaluator, Setup};
use nalgebra::DMatrix;

use super::covered::{MOST, expandable};
use crate::practical::rates::Gains;

/// What is left of an affine function, relative to its parts, is rounding.
const AFFINE: f64 = 1e-9;

/// What is needed to expand the torque of one agent.
pub(super) struct Expansion {
    reference: Affine,
    robot: Box<dyn SeriesEvaluator>,
    damping: ResolvedGain<Series>,
    /// `None` where the parameters are known.
    adaptation: Option<ResolvedGain<Series>>,
    theta: Vec<Series>,
    effort_limits: Option<Vec<Series>>,
    /// Coefficients of the torque that do not need derivatives of what is heard.
    derivatives: usize,
}

impl Expansion {
    /// Of an agent, by its number; `None` where no derivative beyond the value of its torque can be expanded.
    ///
    /// # Errors
    /// [`LengthError`] when its reference dynamics do not have the shape that they state.
    pub(super) fn new(setup: &Setup, agent: usize) -> Result<Option<Self>, LengthError> {
        let own = &setup.agents[agent];
        let parts = own.robot.kind.lagrangian().zip(Gains::of(own)).zip(expandable(setup, agent));
        let Some(((robot, gains), dynamics)) = parts else { return Ok(None) };
        let reference = Affine { dynamics, axes: own.robot.axes.len() };
        let derivatives = reference.determined()?;
        // A value alone is computed, whatever they are; those that say they are not affine may hold the time, which is not known here.
        if !reference.says_affine() || derivatives > 1 && !reference.is_affine()? {
            return Ok(None);
        }
        let limits = own.robot.axes.iter().map(|axis| axis.effort_limit.map(Series::splat)).collect();
        Ok(Some(Expansion {
            derivatives,
            reference,
            robot: robot.series_evaluator(),
            damping: constant(&gains.damping),
            adaptation: gains.adaptation.as_ref().map(constant),
            theta: own.robot.theta.iter().copied().map(Series::splat).collect(),
            effort_limits: if own.enforce_limits { limits } else { None },
        }))
    }

    /// Derivatives of the torque, the torque itself counted, that do not need derivatives of what is heard.
    pub(super) fn derivatives(&self) -> usize {
        self.derivatives
    }

    /// τ of every axis in the state of `jump` with what is `heard` on one of its sides; coefficients from
    /// [`Expansion::derivatives`] on are not-a-number.
    pub(super) fn torque(&mut self, jump: &NetworkJump<'_>, heard: HeardAt<'_>) -> Result<Vec<Series>, LengthError> {
        let State { mut q, mut dq, mut reference, estimate } = State::of(jump);
        let mut theta_hat = if self.adaptation.is_some() { estimate } else { self.theta.clone() };
        let (m, p) = (q.len(), theta_hat.len());
        let vector = |n: usize| vec![Series::value(f64::NAN); n];
        let (mut z, mut dz, mut s, mut tau, mut net, mut ddq) =
            (vector(m), vector(m), vector(m), vector(m), vector(m), vector(m));
        let (mut yt_s, mut d_theta_hat) = (vector(p), vector(p));
        for k in 0..self.derivatives {
            self.reference.coefficient(k, [&q, &dq], &mut reference, heard, [&mut z, &mut dz])?;
            for (s, (dq, z)) in s.iter_mut().zip(dq.iter().zip(&z)) {
                *s = *dq - *z;
            }
            let motion = TwoVelocity { q: &q, dq: &dq, z: &z, dz: &dz };
            self.robot.products(&theta_hat, motion, &s, &mut tau, &mut yt_s)?;
            self.damping.subtract_from(&s, &mut tau);
            net.copy_from_slice(&tau);
            if let Some(limits) = &self.effort_limits {
                net.iter_mut().zip(limits).for_each(|(tau, limit)| *tau = tau.saturate(*limit));
            }
            for (net, external) in net.iter_mut().zip(jump.external) {
                *net = *net + Series::splat(*external);
            }
            self.robot.acceleration(&self.theta, [&q, &dq], &net, &mut ddq)?;
            integrate(&mut q, &dq, k);
            integrate(&mut dq, &ddq, k);
            if let Some(gamma) = &self.adaptation {
                d_theta_hat.fill(Series::ZERO);
                gamma.subtract_from(&yt_s, &mut d_theta_hat);
                integrate(&mut theta_hat, &d_theta_hat, k);
            }
        }
        Ok(tau)
    }
}

fn constant(gain: &DMatrix<f64>) -> ResolvedGain<Series> {
    ResolvedGain::Matrix { size: gain.nrows(), entries: gain.iter().copied().map(Series::splat).collect() }
}

fn integrate(of: &mut [Series], rate: &[Series], k: usize) {
    of.iter_mut().zip(rate).for_each(|(of, rate)| of.integrate(rate, k));
}

/// The state of an agent by its parts.
struct State {
    q: Vec<Series>,
    dq: Vec<Series>,
    reference: Vec<Series>,
    estimate: Vec<Series>,
}

impl State {
    fn of(jump: &NetworkJump<'_>) -> Self {
        let part = |is: fn(&Signal) -> bool| -> Vec<Series> {
            let of_part = jump.signals.iter().zip(jump.state).filter(|((signal, _), _)| is(signal));
            of_part.map(|(_, value)| Series::value(*value)).collect()
        };
        State {
            q: part(|signal| *signal == Signal::Position),
            dq: part(|signal| *signal == Signal::Velocity),
            reference: part(|signal| matches!(signal, Signal::Reference(_))),
            estimate: part(|signal| *signal == Signal::Estimate),
        }
    }
}

/// Reference dynamics of one agent, whose outputs are affine in what goes in: coefficient by coefficient they are the same function.
struct Affine {
    dynamics: Dynamics,
    axes: usize,
}

impl Affine {
    /// Coefficient `k` of z and ż, and with it coefficient `k` + 1 of the `state`, from coefficients `k` of q, q̇ and the state. What is heard has a value;
    /// its derivatives are not known.
    fn coefficient(
        &self,
        k: usize,
        [q, dq]: [&[Series]; 2],
        state: &mut [Series],
        heard: HeardAt<'_>,
        [z, dz]: [&mut [Series]; 2],
    ) -> Result<(), LengthError> {
        let at = |of: &[Series]| of.iter().map(|series| series.0[k]).collect::<Vec<f64>>();
        let (unknown, none) = (vec![f64::NAN; heard.sums.len()], vec![0.0; heard.sums.len()]);
        let sums = if k == 0 { heard.sums } else { &unknown };
        let out = self.evaluate([&at(q), &at(dq), &at(state)], heard.degree, sums)?;
        // The derivative of what is constant in them is zero.
        let rest = if k == 0 {
            Output::zero(self.axes, state.len())
        } else {
            let zero = |of: &[f64]| vec![0.0; of.len()];
            self.evaluate([&zero(&at(q)), &zero(&at(dq)), &zero(&at(state))], heard.degree, &none)?
        };
        for axis in 0..self.axes {
            z[axis].0[k] = out.z[axis] - rest.z[axis];
            dz[axis].0[k] = out.dz[axis] - rest.dz[axis];
        }
        for (state, (rate, rest)) in state.iter_mut().zip(out.rate.iter().zip(&rest.rate)) {
            let mut of_rate = Series::value(f64::NAN);
            of_rate.0[k] = rate - rest;
            state.integrate(&of_rate, k);
        }
        Ok(())
    }

    fn evaluate(&self, own: [&[f64]; 3], degree: f64, sums: &[f64]) -> Result<Output, LengthError> {
        match &self.dynamics {
            Dynamics::Position(reference) => evaluate(&**reference, self.axes, own, degree, sums),
            Dynamics::PositionVelocity(reference) => evaluate(&**reference, self.axes, own, degree, sums),
            Dynamics::Estimates(reference) => evaluate(&**reference, self.axes, own, degree, sums),
            Dynamics::Composite(reference) => evaluate(&**reference, self.axes, own, degree, sums),
        }
    }

    fn shape(&self) -> (usize, usize) {
        match &self.dynamics {
            Dynamics::Position(reference) => (reference.vectors(), 1),
            Dynamics::PositionVelocity(reference) => (reference.vectors(), 2),
            Dynamics::Estimates(reference) => (reference.vectors(), 2),
            Dynamics::Composite(reference) => (reference.vectors(), 1),
        }
    }

    fn says_affine(&self) -> bool {
        match &self.dynamics {
            Dynamics::Position(reference) => reference.is_affine(),
            Dynamics::PositionVelocity(reference) => reference.is_affine(),
            Dynamics::Estimates(reference) => reference.is_affine(),
            Dynamics::Composite(reference) => reference.is_affine(),
        }
    }

    /// Whether f(u + v) + f(0) = f(u) + f(v) at a few points.
    fn is_affine(&self) -> Result<bool, LengthError> {
        let (vectors, channels) = self.shape();
        let n = self.axes;
        let at = |u: f64, v: f64| {
            // Numbers that have nothing to do with each other.
            let entry = |k: usize| {
                let of = |seed: f64| (seed + 0.618_033_988_749_894_9 * k as f64).fract() - 0.5;
                u * of(0.1) + v * of(0.7)
            };
            let part = |first: usize, len: usize| (first..first + len).map(entry).collect::<Vec<f64>>();
            let (q, dq, state) = (part(0, n), part(n, n), part(2 * n, vectors * n));
            self.evaluate([&q, &dq, &state], 1.3, &part((2 + vectors) * n, channels * n))
        };
        for size in [0.5, 2.0, 9.0] {
            let [both, none, u, v] = [at(size, size)?, at(0.0, 0.0)?, at(size, 0.0)?, at(0.0, size)?];
            let values = |of: &Output| [&of.z[..], &of.dz, &of.rate].concat();
            let [both, none, u, v] = [&both, &none, &u, &v].map(values);
            for k in 0..both.len() {
                let scale = both[k].abs() + none[k].abs() + u[k].abs() + v[k].abs();
                let within = (both[k] + none[k] - u[k] - v[k]).abs() <= AFFINE * scale;
                if !within {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// How many coefficients of z and ż do not need derivatives of what is heard, from a state in which all else is known.
    fn determined(&self) -> Result<usize, LengthError> {
        let (vectors, channels) = self.shape();
        let at_rest = vec![Series::ZERO; self.axes];
        let sums = vec![0.0; channels * self.axes];
        let heard = HeardAt { degree: 1.0, sums: &sums };
        let mut state = vec![Series::value(0.0); vectors * self.axes];
        let (mut z, mut dz) = (at_rest.clone(), at_rest.clone());
        for k in 0..MOST {
            self.coefficient(k, [&at_rest, &at_rest], &mut state, heard, [&mut z, &mut dz])?;
            if z.iter().chain(&dz).any(|series| series.0[k].is_nan()) {
                return Ok(k);
            }
        }
        Ok(MOST)
    }
}

/// z, ż and the rate of the state.
struct Output {
    z: Vec<f64>,
    dz: Vec<f64>,
    rate: Vec<f64>,
}

impl Output {
    fn zero(axes: usize, states: usize) -> Self {
        Output { z: vec![0.0; axes], dz: vec![0.0; axes], rate: vec![0.0; states] }
    }
}

fn evaluate<X: Exchange>(
    reference: &dyn Reference<Exchange = X>,
    axes: usize,
    [q, dq, state]: [&[f64]; 3],
    degree: f64,
    sums: &[f64],
) -> Result<Output, LengthError> {
    let mut out = Output::zero(axes, state.len());
    let degree = [degree];
    let heard = Heard::new(&degree, sums, axes)?;
    let into = ReferenceOut { z: &mut out.z, dz: &mut out.dz, d_state: &mut out.rate };
    reference.evaluate(axes, Measured { q, dq }, state, heard, into)?;
    Ok(out)
}
