//! The quantity that `agreement` derives, in numbers, with a bound on what rounding does to it.

use std::ops::{Add, Mul};

use forwardstep_sim::Setup;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::reference::PureIntegral;

use crate::agreement::NoPrediction;
use crate::kinds::is_its_own_reference;
use crate::manipulation::{error_integral, impulses};
use crate::null_vector::{Positive, sum_depth};

/// Of the size of what is averaged: a value that is less certain than this is none.
const USEFUL: f64 = 1e-3;
/// Half the distance from one to the next number.
const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// A sum, and the sum of the sizes of its terms, which tells what rounding can do to it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) value: f64,
    pub(crate) size: f64,
}

impl Tally {
    pub(crate) fn of(value: f64) -> Tally {
        Tally { value, size: value.abs() }
    }
}

impl Add for Tally {
    type Output = Tally;

    fn add(self, other: Tally) -> Tally {
        Tally { value: self.value + other.value, size: self.size + other.size }
    }
}

impl Mul<f64> for Tally {
    type Output = Tally;

    fn mul(self, factor: f64) -> Tally {
        Tally { value: self.value * factor, size: self.size * factor.abs() }
    }
}

/// Q of a network.
pub(crate) struct Conserved<'a> {
    pub(crate) setup: &'a Setup,
    /// For each agent x₀, x₁ = z, … at the start.
    pub(crate) starts: &'a [Vec<Vec<Tally>>],
    /// For each agent the edges along which it hears, with constant weights.
    pub(crate) heard: &'a [Vec<Edge>],
    /// For each agent the coefficients of its polynomial.
    pub(crate) alpha: &'a [Vec<f64>],
    /// The left null vector.
    pub(crate) influence: &'a [f64],
}

/// A value and how far it can be from the truth.
pub(crate) struct Bounded {
    pub(crate) value: f64,
    pub(crate) error_bound: f64,
}

/// A weighted sum over all agents, and what rounding can have done to it.
#[derive(Default)]
struct Sum {
    terms: Vec<f64>,
    errors: Vec<f64>,
    sizes: Vec<f64>,
}

impl Sum {
    fn add(&mut self, tally: Tally, weight: f64, relative: f64) {
        self.terms.push(weight * tally.value);
        self.sizes.push(weight * tally.size);
        self.errors.push(weight * tally.size * relative);
    }

    /// Value, bound on its error, size.
    fn total(&self) -> [f64; 3] {
        [&self.terms, &self.errors, &self.sizes].map(|all| f64::sum(all))
    }
}

impl Conserved<'_> {
    /// c on one axis: Q over what it is per unit of c at rest.
    ///
    /// # Errors
    /// [`NoPrediction::Manipulability`] and [`NoPrediction::Uncertain`].
    pub(crate) fn quotient(&self, axis: usize, influence_error: f64) -> Result<Bounded, NoPrediction> {
        let (mut quantity, mut at_rest) = (Sum::default(), Sum::default());
        for (i, weight) in self.influence.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            let (share, rest) = self.contribution(i, axis);
            // Coefficients, their products and sums over the edges; what the decimals of the data were rounded by.
            let roundings = 3 * self.alpha[i].len() + self.heard[i].len() + 20;
            let relative = influence_error + ROUNDING * (roundings as f64 + sum_depth(self.influence.len()));
            quantity.add(share + self.shift(i, axis)?, *weight, relative);
            at_rest.add(rest, *weight, relative);
        }
        let [quantity, quantity_error, size] = quantity.total();
        let [at_rest, at_rest_error, _] = at_rest.total();
        // Minus zero is no answer.
        let value = quantity / at_rest + 0.0;
        let error_bound = 1.001 * (quantity_error + value.abs() * at_rest_error) / (at_rest - at_rest_error);
        let known = value.is_finite() && at_rest > at_rest_error && error_bound <= USEFUL * size / at_rest;
        if known { Ok(Bounded { value, error_bound }) } else { Err(uncertain(error_bound)) }
    }

    /// Agent i's term of Q at t = 0, and what it is per unit of c at rest.
    fn contribution(&self, i: usize, axis: usize) -> (Tally, Tally) {
        let (setup, alpha) = (self.setup, &self.alpha[i]);
        let x = |r: usize| self.start(i, r, axis);
        let (b, w) = if setup.reference.is::<PureIntegral>() {
            (x(0) * alpha[0] + x(1) * alpha[1] + x(2), x(0) * alpha[1] + x(1))
        } else {
            // α₁ q̇ − α₁ s is α₁ z, as s = q̇ − z.
            let all = || alpha.iter().enumerate();
            (
                all().fold(Tally::default(), |sum, (r, a)| sum + x(r) * *a),
                all().skip(1).fold(Tally::default(), |sum, (r, a)| sum + x(r - 1) * *a),
            )
        };
        let velocity = match setup.exchange.has_velocities() {
            true => setup.agents[i].roots_per_s.first_real().map_or(0.0, f64::recip),
            false => 0.0,
        };
        let (mut degree, mut past, mut past_at_rest) = (0.0, Tally::default(), Tally::default());
        for edge in &self.heard[i] {
            let Some(weight) = edge.weight.constant() else { continue };
            let delay_s = setup.network.delays[edge.delay].max_s();
            let (q, dq) = (self.start(edge.from, 0, axis), Tally::of(setup.agents[edge.from].start.dq[axis]));
            let ramp = q + dq * -delay_s;
            degree += weight;
            past = past + (q * delay_s + ramp * -velocity) * weight;
            past_at_rest = past_at_rest + (Tally::of(delay_s) + Tally::of(-velocity)) * weight;
        }
        let per_alpha = 1.0 / alpha[0];
        let rest = Tally::of(1.0) + Tally::of(degree * alpha[1] * per_alpha) + past_at_rest;
        ((b + w * degree) * per_alpha + past, rest)
    }

    /// What Remark 4, and pushes under (46), add to agent i's term of Q in the course of time.
    fn shift(&self, i: usize, axis: usize) -> Result<Tally, NoPrediction> {
        let agent = &self.setup.agents[i];
        if is_its_own_reference(agent) && !agent.pushes.is_empty() {
            let degree: f64 = self.heard[i].iter().filter_map(|edge| edge.weight.constant()).sum();
            let by_force = (self.alpha[i][1] + degree) / self.alpha[i][0];
            let moved = impulses(agent, axis).zip(agent.robot.theta.first());
            let shift = moved.map(|(impulse, mass)| Tally::of(by_force * impulse / mass));
            return shift.ok_or(NoPrediction::Pushed { agent: i });
        }
        if agent.manipulability == 0.0 {
            return Ok(Tally::default());
        }
        let integral = error_integral(agent, axis);
        let shift = integral.map(|s| Tally::of(agent.manipulability / self.alpha[i][0] * s));
        shift.ok_or(NoPrediction::Manipulability { agent: i })
    }

    /// x_r of agent i at the start.
    fn start(&self, i: usize, r: usize, axis: usize) -> Tally {
        self.starts[i].get(r).and_then(|x| x.get(axis)).copied().unwrap_or_default()
    }
}

fn uncertain(error_bound: f64) -> NoPrediction {
    NoPrediction::Uncertain { error_bound: if error_bound >= 0.0 { error_bound } else { f64::INFINITY } }
}
