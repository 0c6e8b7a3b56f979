//! The steps of adaptive backstepping with tuning functions, for pure-feedback and strict-feedback chains.
//!
//! ```text
//! ẋ_i = f_i(x_1 … x_{i+1}) + φ_i(x_1 … x_{i+1})ᵀθ,  i < n,      ẋ_n = f_n(x) + φ_n(x)ᵀθ + ψ(x) u
//! ```
//!
//! x_1 is to follow y, of which n derivatives are known. Every error is defined from the one before, without solving for a
//! virtual control, so that x_{i+1} may enter e_{i+1} nonlinearly, as it must in a pure-feedback chain:
//!
//! ```text
//! e_1 = x_1 − y,   e_0 = 0,   τ_0 = 0
//! w_i = Σ_{k≤i} ∂e_i/∂x_k φ_k,   τ_i = τ_{i−1} + w_i e_i
//! e_{i+1} = c_i e_i + e_{i−1} + Σ_{k≤i} ∂e_i/∂x_k (f_k + φ_kᵀθ̂) + Σ_j ∂e_i/∂y^(j) y^(j+1)
//!           + ∂e_i/∂θ̂ Γ τ_i + Σ_{1<k<i} e_k ∂e_k/∂θ̂ Γ w_i
//! ```
//!
//! For i = n the right-hand side gets ∂e_n/∂x_n ψ u in addition, and u makes it zero; θ̂' = Γ τ_n. Then, with e_{n+1} = 0 and
//! Δθ = θ̂ − θ,
//!
//! ```text
//! ė_i = −c_i e_i − e_{i−1} + e_{i+1} − w_iᵀΔθ + Σ_{k>i} ∂e_i/∂θ̂ Γ w_k e_k − Σ_{1<k<i} e_k ∂e_k/∂θ̂ Γ w_i
//! ```
//!
//! In Σ e_i ė_i the neighbours e_{i−1}, e_{i+1} cancel, and so do the two last sums, which are one another's mirror image. With
//! V = ½ Σ e_i² + ½ Δθᵀ Γ⁻¹ Δθ what is left is
//!
//! ```text
//! V̇ = −Σ c_i e_i²
//! ```
//!
//! For a strict-feedback chain e_{i+1} = x_{i+1} − y^(i) − (the virtual control of the i-th step), which is the usual design.
//! There ∂e_n/∂x_n = 1. Otherwise it is a product of ∂(f_i + φ_iᵀθ̂)/∂x_{i+1} and small corrections, and the law holds where
//! it is not zero.

use alloc::vec;
use alloc::vec::Vec;

use super::interior::Metric;
use crate::expression::{ExpressionError, Graph, Node};
use crate::plant::CascadeTerms;

/// All values of the design as nodes of one graph. Variables: x_1 … x_n, θ̂, y, ẏ, …, y^(n).
#[derive(Clone, Debug)]
pub(super) struct Steps {
    pub(super) graph: Graph,
    /// u.
    pub(super) input: Node,
    /// ∂e_n/∂x_n ψ.
    pub(super) divisor: Node,
    /// e_1 … e_n.
    pub(super) errors: Vec<Node>,
    /// Γ τ_n: θ̂', or ξ' of `interior`.
    pub(super) d_theta_hat: Vec<Node>,
}

impl Steps {
    /// For a chain, with c_1 … c_n and the diagonal of Γ, or Γ(θ̂).
    pub(super) fn new<'a>(
        terms: &CascadeTerms,
        gains: &[f64],
        gamma: impl Into<Metric<'a>>,
    ) -> Result<Self, ExpressionError> {
        let (n, p, Metric { gamma, slopes }) = (terms.order(), terms.parameters(), gamma.into());
        let mut graph = Graph::new(n + p + n + 1);
        let theta_hat = (0..p).map(|j| graph.variable(n + j)).collect::<Result<Vec<_>, _>>()?;
        let y = (0..=n).map(|j| graph.variable(n + p + j)).collect::<Result<Vec<_>, _>>()?;
        let (mut drift, mut phi) = (Vec::new(), Vec::new());
        for (known, regressor) in terms.known().iter().zip(terms.regressors()) {
            let regressor = regressor.iter().map(|phi| graph.import(phi)).collect::<Result<Vec<_>, _>>()?;
            let (known, estimated) = (graph.import(known)?, graph.dot(&regressor, &theta_hat));
            drift.push(graph.plus(known, estimated));
            phi.push(regressor);
        }
        let psi = graph.import(terms.input())?;
        let slopes = slopes.iter().map(|slope| graph.import(slope)).collect::<Result<Vec<_>, _>>()?;

        let x_1 = graph.variable(0)?;
        let mut errors = vec![graph.minus(x_1, y[0])];
        let mut tau = vec![graph.zero(); p];
        // ∂e_i/∂θ̂ of every step.
        let mut by_theta: Vec<Vec<Node>> = Vec::new();
        loop {
            let i = errors.len() - 1;
            let e = errors[i];
            let by_x = (0..=i).map(|k| graph.derivative(e, k)).collect::<Result<Vec<_>, _>>()?;
            let theta = (0..p).map(|j| graph.derivative(e, n + j)).collect::<Result<Vec<_>, _>>()?;
            by_theta.push(theta);
            // Γ w and Γ τ.
            let (mut gamma_w, mut gamma_tau, mut driven_by) = (Vec::new(), Vec::new(), Vec::new());
            for j in 0..p {
                let column: Vec<Node> = phi[..=i].iter().map(|phi| phi[j]).collect();
                let w = graph.dot(&by_x, &column);
                let driven = graph.times(w, e);
                tau[j] = graph.plus(tau[j], driven);
                let [mut of_w, mut of_tau] = [w, tau[j]].map(|of| graph.scaled(gamma[j], of));
                driven_by.push(of_tau);
                if let Some(slope) = slopes.get(j) {
                    [of_w, of_tau] = [of_w, of_tau].map(|of| graph.times(*slope, of));
                }
                gamma_w.push(of_w);
                gamma_tau.push(of_tau);
            }
            let mut next = graph.scaled(gains[i], e);
            if let Some(before) = i.checked_sub(1) {
                next = graph.plus(next, errors[before]);
            }
            let moved = graph.dot(&by_x, &drift[..=i]);
            next = graph.plus(next, moved);
            for j in 0..=i {
                let slope = graph.derivative(e, n + p + j)?;
                let term = graph.times(slope, y[j + 1]);
                next = graph.plus(next, term);
            }
            let tuned = graph.dot(&by_theta[i], &gamma_tau);
            next = graph.plus(next, tuned);
            for k in 1..i {
                let mirrored = graph.dot(&by_theta[k], &gamma_w);
                let term = graph.times(errors[k], mirrored);
                next = graph.plus(next, term);
            }
            if i + 1 == n {
                let divisor = graph.times(by_x[i], psi);
                let ratio = graph.over(next, divisor);
                let zero = graph.zero();
                let input = graph.minus(zero, ratio);
                return Ok(Steps { graph, input, divisor, errors, d_theta_hat: driven_by });
            }
            errors.push(next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::interior::Interior;
    use super::*;
    use crate::expression::{Expression, Tape};
    use crate::law::ParameterBounds;

    const GAMMA: [f64; 2] = [0.7, 1.9];
    const THETA: [f64; 2] = [0.8, -1.3];

    fn x(index: usize) -> Expression {
        Expression::variable(index - 1)
    }

    /// Numbers within ±1.5, always the same.
    fn numbers(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            3.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 1.5
        };
        (0..count).map(|_| next()).collect()
    }

    /// |V̇ + Σ c e²| over the size of its terms, at random states, where Γ(θ̂) is Γ times these.
    fn worst(terms: &CascadeTerms, gains: &[f64], slopes: &[Expression]) -> f64 {
        let (n, p) = (terms.order(), terms.parameters());
        let metric = Metric { gamma: &GAMMA[..p], slopes };
        let Steps { mut graph, input, errors, d_theta_hat, .. } = Steps::new(terms, gains, metric).unwrap();
        // ẋ with the true parameters and this u; V̇ by the chain rule.
        let mut rates = Vec::new();
        for (known, regressor) in terms.known().iter().zip(terms.regressors()) {
            let mut rate = graph.import(known).unwrap();
            for (phi, theta) in regressor.iter().zip(THETA) {
                let phi = graph.import(phi).unwrap();
                let term = graph.scaled(theta, phi);
                rate = graph.plus(rate, term);
            }
            rates.push(rate);
        }
        let psi = graph.import(terms.input()).unwrap();
        let driven = graph.times(psi, input);
        rates[n - 1] = graph.plus(rates[n - 1], driven);
        for (j, rate) in d_theta_hat.iter().enumerate() {
            let slope = slopes.get(j).map(|slope| graph.import(slope).unwrap());
            rates.push(slope.map_or(*rate, |slope| graph.times(slope, *rate)));
        }
        let y: Vec<Node> = (1..=n).map(|j| graph.variable(n + p + j).unwrap()).collect();
        rates.extend(y);
        let mut terms = Vec::new();
        for (e, c) in errors.iter().zip(gains) {
            for variable in 0..rates.len() {
                let slope = graph.derivative(*e, variable).unwrap();
                let moved = graph.times(slope, rates[variable]);
                terms.push(graph.times(*e, moved));
            }
            let square = graph.power(*e, 2.0);
            terms.push(graph.scaled(*c, square));
        }
        for j in 0..p {
            let theta_hat = graph.variable(n + j).unwrap();
            let theta = graph.number(THETA[j]);
            let delta = graph.minus(theta_hat, theta);
            let product = graph.times(delta, d_theta_hat[j]);
            terms.push(graph.scaled(1.0 / GAMMA[j], product));
        }
        let tape = Tape::new(&graph, &terms).unwrap();
        let (mut workspace, mut out) = (tape.workspace(), vec![0.0; terms.len()]);
        let mut worst = 0.0_f64;
        for seed in 1..200 {
            tape.evaluate(&numbers(seed, 2 * n + p + 1), &mut workspace, &mut out).unwrap();
            let size: f64 = out.iter().map(|term| term.abs()).sum();
            worst = worst.max(out.iter().sum::<f64>().abs() / size);
        }
        worst
    }

    #[test]
    fn eq_lyapunov_of_strict_feedback_of_any_order_loses_the_squares_of_the_errors() {
        let zero = || Expression::number(0.0);
        let all = [
            vec![x(1).power(2.0), x(1).sin_of()],
            vec![x(1) * x(2), zero()],
            vec![zero(), x(3).sin_of() * x(1)],
            vec![x(4).power(2.0), x(2).tanh_of()],
        ];
        for n in 1..=4 {
            let terms = CascadeTerms::strict(all[..n].to_vec()).unwrap();
            assert!(terms.is_strict());
            assert!(worst(&terms, &[1.0, 1.3, 0.9, 1.1][..n], &[]) < 1e-12, "order {n}");
            // Between bounds Γ depends on θ̂.
            let bounds = ParameterBounds::new(vec![-1.7, -1.9], vec![1.8, 2.6], 1.0);
            let slopes = Interior::new(&bounds).slopes(n);
            assert!(worst(&terms, &[1.0, 1.3, 0.9, 1.1][..n], &slopes) < 1e-12, "order {n}, between bounds");
        }
    }

    #[test]
    fn eq_lyapunov_of_pure_feedback_loses_the_squares_of_the_errors() {
        let known = vec![x(2) + x(2).power(3.0) * 0.2, x(3) * 1.5 + x(3).sin_of() * 0.3, x(1) * x(3)];
        let regressors =
            vec![vec![x(1).power(2.0), x(2).tanh_of() * 0.3], vec![x(3).sin_of() * 0.2, x(1)], vec![x(3), x(2) * x(1)]];
        let terms = CascadeTerms::new(known, regressors, x(1).cos_of() + 2.0).unwrap();
        assert!(!terms.is_strict());
        assert!(worst(&terms, &[1.0, 1.3, 0.9], &[]) < 1e-11);
        let slopes = Interior::new(&ParameterBounds::new(vec![-1.7, -1.9], vec![1.8, 2.6], 1.0)).slopes(3);
        assert!(worst(&terms, &[1.0, 1.3, 0.9], &slopes) < 1e-11);
    }

    #[test]
    fn eq_strict_feedback_of_order_two_is_the_design_of_the_textbooks() {
        // ẋ_1 = x_2 + θ x_1², ẋ_2 = u.
        let terms = CascadeTerms::strict(vec![vec![x(1).power(2.0)], vec![Expression::number(0.0)]]).unwrap();
        let (c_1, c_2, gamma) = (1.0, 1.3, 0.7);
        let Steps { graph, input, errors, d_theta_hat, divisor } =
            Steps::new(&terms, &[c_1, c_2], &[gamma][..]).unwrap();
        let tape = Tape::new(&graph, &[input, errors[1], d_theta_hat[0], divisor]).unwrap();
        let (mut workspace, mut out) = (tape.workspace(), [0.0; 4]);
        let at = numbers(5, 6);
        tape.evaluate(&at, &mut workspace, &mut out).unwrap();
        let [x_1, x_2, theta_hat, y, dy, ddy] = at[..] else { panic!("six numbers") };
        let (e_1, phi) = (x_1 - y, x_1 * x_1);
        let e_2 = x_2 + theta_hat * phi + c_1 * e_1 - dy;
        let slope = c_1 + 2.0 * theta_hat * x_1;
        let tau_2 = phi * e_1 + slope * phi * e_2;
        let u = -e_1 - c_2 * e_2 - slope * (x_2 + theta_hat * phi) - phi * gamma * tau_2 + c_1 * dy + ddy;
        for (got, expected) in out.iter().zip([u, e_2, gamma * tau_2, 1.0]) {
            assert!((got - expected).abs() < 1e-13, "{got} is not {expected}");
        }
    }
}
