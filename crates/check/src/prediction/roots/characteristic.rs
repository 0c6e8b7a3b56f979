//! The characteristic matrix of agreement over a fixed graph with constant delays, s ≡ 0, and what the start puts into it.
//!
//! With P_i(p) = ∏_r (1 + p/κ_{i,r}) = Σ_r a_r pʳ, d_i = Σⱼ w_ij and v = 1 when velocities are sent, else 0, the Laplace transform of
//! (24) and (a5) for ψ_ℓ = X/α₀ (see `cascade`) is Δ(p) q̂(p) = b(p) with
//!
//! ```text
//! Δ_ii = (p + d_i) P_i(p)        Δ_ij = −w_ij (1 + v p/κ₀ᵢ) e^(−p T_ij)
//! c_i = Σ_r a_r Σ_{m<r} p^(r−1−m) x_m(0)                                 x_m the m-th derivative of q
//! b_i = (p + d_i) c_i + Σ_r a_r x_r(0)
//!       + Σⱼ w_ij { (1 − e^(−p T_ij))/p · (q_j + v q̇_j/κ₀ᵢ)(0) − v e^(−p T_ij) q_j(0)/κ₀ᵢ }
//! ```
//!
//! where messages from before the start hold q_j(0) and q̇_j(0). The residue of Δ⁻¹b at p = 0 is the value agreed upon.

use forwardstep_core::reference::polynomial;
use forwardstep_sim::{AgentSetup, Setup};
use nalgebra::{Complex, DMatrix};

use crate::fixed::Link;

/// A complex number.
pub(crate) type C = Complex<f64>;

/// Network, roots and start, agent by agent.
#[derive(Debug)]
pub(crate) struct Characteristic {
    /// a₀ … a_ℓ of every agent.
    pub(crate) coefficients: Vec<Vec<f64>>,
    /// κ₀ of every agent.
    pub(super) first_root: Vec<f64>,
    /// d of every agent.
    pub(crate) degree: Vec<f64>,
    pub(super) links: Vec<Link>,
    /// Whether velocities are sent.
    pub(super) velocities: bool,
    /// x₀(0) … x_ℓ(0) of every agent, axis by axis.
    pub(super) start: Vec<Vec<Vec<f64>>>,
}

impl Characteristic {
    /// Of a setup in which everybody follows exactly, and its links; `None` when it has no meaning.
    pub(super) fn of(ideal: &Setup, links: Vec<Link>) -> Option<Characteristic> {
        let mut degree = vec![0.0; ideal.agents.len()];
        for link in &links {
            *degree.get_mut(link.to)? += link.weight;
        }
        let velocities = ideal.exchange.has_velocities();
        // Of positions alone nothing is heard of it, so that any number will do.
        let first_root = |agent: &AgentSetup| agent.roots_per_s.first_real().or((!velocities).then_some(1.0));
        let scaled = |agent: &AgentSetup| {
            let alpha = polynomial(&agent.roots_per_s).ok()?;
            Some(alpha.iter().map(|a| a / alpha[0]).collect::<Vec<_>>())
        };
        Some(Characteristic {
            coefficients: ideal.agents.iter().map(scaled).collect::<Option<_>>()?,
            first_root: ideal.agents.iter().map(first_root).collect::<Option<_>>()?,
            degree,
            links,
            velocities,
            start: ideal.agents.iter().map(derivatives).collect(),
        })
    }

    pub(super) fn agents(&self) -> usize {
        self.degree.len()
    }

    /// Axes of the first agent, which are those of all.
    pub(super) fn axes(&self) -> usize {
        self.start.first().map_or(0, Vec::len)
    }

    /// Δ and dΔ/dp.
    pub(crate) fn matrix(&self, p: C) -> [DMatrix<C>; 2] {
        let n = self.agents();
        let (mut delta, mut slope) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        for (i, a) in self.coefficients.iter().enumerate() {
            let [value, derivative] = horner(a, p);
            let decay = p + self.degree[i];
            delta[(i, i)] = decay * value;
            slope[(i, i)] = value + decay * derivative;
        }
        for link in &self.links {
            let late = exp(-p * link.delay_s) * link.weight;
            let ratio = self.ratio(link.to);
            let factor = p * ratio + 1.0;
            delta[(link.to, link.from)] -= late * factor;
            slope[(link.to, link.from)] -= late * (-factor * link.delay_s + ratio);
        }
        [delta, slope]
    }

    /// Row by row the sum of the sizes of the terms of Δ, before they cancel.
    pub(super) fn sizes(&self, p: C) -> Vec<f64> {
        let own = |(a, d): (&Vec<f64>, &f64)| (size(p) + d) * horner(a, C::from(size(p)))[0].re;
        let mut sizes: Vec<f64> = self.coefficients.iter().zip(&self.degree).map(own).collect();
        for link in &self.links {
            sizes[link.to] +=
                link.weight.abs() * libm::exp(-p.re * link.delay_s) * (1.0 + size(p) * self.ratio(link.to));
        }
        sizes
    }

    /// v/κ₀ᵢ.
    pub(super) fn ratio(&self, agent: usize) -> f64 {
        if self.velocities { 1.0 / self.first_root[agent] } else { 0.0 }
    }

    /// b, a column for every axis; p is not zero.
    pub(super) fn start(&self, p: C) -> DMatrix<C> {
        let mut b = DMatrix::zeros(self.agents(), self.axes());
        for axis in 0..self.axes() {
            for (i, a) in self.coefficients.iter().enumerate() {
                let x = &self.start[i][axis];
                // c = Σ_m x_m Σ_{r>m} a_r p^(r−1−m), and the inner sums come by Horner's rule from the last one.
                let (mut inner, mut c, mut now) = (C::from(0.0), C::from(0.0), 0.0);
                for (m, a) in a.iter().enumerate().rev() {
                    c += inner * x[m];
                    inner = inner * p + a;
                    now += a * x[m];
                }
                b[(i, axis)] += (p + self.degree[i]) * c + now;
            }
            for link in &self.links {
                let (x, ratio) = (&self.start[link.from][axis], self.ratio(link.to));
                let late = exp(-p * link.delay_s);
                let before = (-late + 1.0) / p * (x[0] + ratio * x[1]);
                b[(link.to, axis)] += (before - late * (ratio * x[0])) * link.weight;
            }
        }
        b
    }
}

/// x₀(0) … x_ℓ(0), axis by axis; what is not given is zero.
fn derivatives(agent: &AgentSetup) -> Vec<Vec<f64>> {
    let (start, order) = (&agent.start, agent.roots_per_s.len());
    let entry = |axis: usize, r: usize| match r {
        0 => start.q.get(axis),
        1 => start.dq.get(axis),
        _ => start.reference.get(r - 1).and_then(|reference| reference.get(axis)),
    };
    (0..start.q.len()).map(|axis| (0..=order).map(|r| entry(axis, r).copied().unwrap_or(0.0)).collect()).collect()
}

/// A polynomial and its derivative.
fn horner(a: &[f64], p: C) -> [C; 2] {
    a.iter().rev().fold([C::from(0.0); 2], |[value, slope], a| [value * p + a, slope * p + value])
}

/// e^p, with the same bits on every machine.
pub(super) fn exp(p: C) -> C {
    C::new(libm::cos(p.im), libm::sin(p.im)) * libm::exp(p.re)
}

/// |p|.
pub(super) fn size(p: C) -> f64 {
    libm::hypot(p.re, p.im)
}
