//! The steps of adaptive backstepping, computed in truncated power series instead of expressions.
//!
//! The recursion is that of `steps`. Its sums are put together such that few products of whole series are left. Write
//! V_i = ½ Σ_{k≤i} e_k², and L_g for the derivative along a field g in x. Then
//!
//! ```text
//! τ_i = Σ_{k≤i} w_k e_k = L_φ V_i,     Σ_{1<k<i} e_k ∂e_k/∂θ̂ = ∂V_{i−1}/∂θ̂
//! e_{i+1} = c_i e_i + e_{i−1} + L_f e_i + w_iᵀθ̂ + ∂e_i/∂t + ∂e_i/∂θ̂ Γ L_φ V_i + ∂V_{i−1}/∂θ̂ Γ w_i,     w_i = L_φ e_i
//! ```
//!
//! since w_k = L_φ e_k, and since e_1 has no θ̂. In place of y, ẏ, …, y^(n) there is one variable t with y(t + δ) = Σ y^(j) δʲ/j!,
//! and Σ_j ∂e_i/∂y^(j) y^(j+1) is ∂e_i/∂t.
//!
//! e_i is differentiated n + 1 − i times more until u is known, so it is a series of that degree in x_1 … x_i, θ̂ and t. With x_i
//! entering linearly, as in a strict-feedback chain, a product of two such series takes at most
//! C(2 (i + p) + 1 + n − i, n − i) multiplications: 5 10⁴ where it is most, for n = 10 and two parameters.
//!
//! The law, its proof and its value are those of `steps`; only roundings differ.

use alloc::vec;
use alloc::vec::Vec;

use super::interior::Metric;
use crate::LengthError;
use crate::expression::{ExpressionError, Program, Register, Series, Term};
use crate::plant::CascadeTerms;

/// The steps as a list of operations on coefficients. Given, as in `steps`: x_1 … x_n, θ̂, y, ẏ, …, y^(n).
#[derive(Clone, Debug)]
pub(super) struct SeriesSteps {
    program: Program,
    /// What one evaluation takes, in multiplications.
    products: u64,
}

/// The variables, in their order.
struct Layout {
    n: usize,
    p: usize,
}

impl Layout {
    fn theta(&self, j: usize) -> usize {
        self.n + j
    }

    fn time(&self) -> usize {
        self.n + self.p
    }
}

/// f_i and φ_i as series of the degree n − i to which they are differentiated.
struct Fields {
    known: Vec<Register>,
    regressors: Vec<Vec<Register>>,
}

impl Fields {
    fn new(series: &mut Series, terms: &CascadeTerms) -> Result<Self, ExpressionError> {
        let (mut known, mut regressors) = (Vec::new(), Vec::new());
        for (i, (f, phi)) in terms.known().iter().zip(terms.regressors()).enumerate() {
            let degree = terms.order() - 1 - i;
            known.push(series.import(f, degree)?);
            regressors.push(phi.iter().map(|phi| series.import(phi, degree)).collect::<Result<_, _>>()?);
        }
        Ok(Fields { known, regressors })
    }

    /// L_f of what has these slopes by x_1, x_2, ….
    fn along_known<'a>(&'a self, slopes: &'a [Register]) -> impl Iterator<Item = Term> + 'a {
        self.known.iter().zip(slopes).map(|(f, slope)| Term::Product(1.0, *f, *slope))
    }

    /// L_φ of it, for one parameter.
    fn along_regressor(&self, j: usize, slopes: &[Register]) -> Vec<Term> {
        self.regressors.iter().zip(slopes).map(|(phi, slope)| Term::Product(1.0, phi[j], *slope)).collect()
    }
}

impl SeriesSteps {
    /// For a chain, with c_1 … c_n and the diagonal of Γ, or Γ(θ̂).
    ///
    /// # Errors
    /// [`ExpressionError`] when a term that must be differentiated has no derivative, or it takes too many multiplications.
    pub(super) fn new<'a>(
        terms: &CascadeTerms,
        gains: &[f64],
        gamma: impl Into<Metric<'a>>,
    ) -> Result<Self, ExpressionError> {
        let (n, p, Metric { gamma, slopes }) = (terms.order(), terms.parameters(), gamma.into());
        let layout = Layout { n, p };
        let mut series = Series::new(n + p + 1);
        let fields = Fields::new(&mut series, terms)?;
        let psi = series.import(terms.input(), 0)?;
        let slopes = slopes.iter().map(|slope| series.import(slope, n)).collect::<Result<Vec<_>, _>>()?;
        let theta_hat = (0..p).map(|j| series.variable(layout.theta(j))).collect::<Result<Vec<_>, _>>()?;
        let (x_1, y) = (series.variable(0)?, series.jet(layout.time(), n + p, n));
        let mut errors = vec![series.sum(&[Term::Scaled(1.0, x_1), Term::Scaled(-1.0, y)], n)?];
        // V_{i−1}.
        let mut value = series.zero();
        loop {
            let i = errors.len() - 1;
            let (e, degree) = (errors[i], n - 1 - i);
            let by_x: Vec<Register> = (0..=i).map(|k| series.slope(e, k)).collect();
            let before = value;
            let mut next = vec![Term::Scaled(gains[i], e)];
            next.extend(i.checked_sub(1).map(|before| Term::Scaled(1.0, errors[before])));
            next.extend(fields.along_known(&by_x));
            next.push(Term::Scaled(1.0, series.slope(e, layout.time())));
            let mut tau = Vec::with_capacity(p);
            if p > 0 {
                value = series.sum(&[Term::Scaled(1.0, before), Term::HalfSquare(e)], degree + 1)?;
                let value_by_x: Vec<Register> = (0..=i).map(|k| series.slope(value, k)).collect();
                for j in 0..p {
                    let w = series.sum(&fields.along_regressor(j, &by_x), degree)?;
                    tau.push(series.sum(&fields.along_regressor(j, &value_by_x), degree)?);
                    let [e_by, value_by] = [e, before].map(|of| series.slope(of, layout.theta(j)));
                    next.push(Term::Product(1.0, theta_hat[j], w));
                    let [mut tuned, mut mirrored] = [tau[j], w];
                    if let Some(slope) = slopes.get(j) {
                        tuned = series.sum(&[Term::Product(1.0, *slope, tuned)], degree)?;
                        mirrored = series.sum(&[Term::Product(1.0, *slope, mirrored)], degree)?;
                    }
                    next.push(Term::Product(gamma[j], e_by, tuned));
                    next.push(Term::Product(gamma[j], value_by, mirrored));
                }
            }
            let next = series.sum(&next, degree)?;
            if i + 1 == n {
                let divisor = series.sum(&[Term::Product(1.0, by_x[i], psi)], 0)?;
                let products = series.products();
                let mut outputs = vec![next, divisor];
                outputs.extend(&errors);
                for (gamma, tau) in gamma.iter().zip(tau) {
                    outputs.push(series.sum(&[Term::Scaled(*gamma, tau)], 0)?);
                }
                for variable in 0..=layout.time() {
                    let slopes = errors.iter().map(|e| Term::Product(1.0, series.slope(*e, variable), *e));
                    let slopes: Vec<Term> = slopes.collect();
                    outputs.push(series.sum(&slopes, 0)?);
                }
                return Ok(SeriesSteps { program: series.program(&outputs), products });
            }
            errors.push(next);
        }
    }

    /// What one evaluation takes, in multiplications.
    pub(super) fn products(&self) -> u64 {
        self.products
    }

    /// Working memory for one evaluation.
    pub(super) fn workspace(&self) -> Vec<f64> {
        self.program.workspace()
    }

    /// u, its factor, e_1 … e_n, Γ τ_n, and then Σ_j e_j ∂e_j/∂v for v = x_1 … x_n, θ̂, t.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub(super) fn evaluate(&self, given: &[f64], workspace: &mut [f64], out: &mut [f64]) -> Result<(), LengthError> {
        self.program.evaluate(given, workspace, out)?;
        if let [input, divisor, ..] = out {
            *input = -(*input / *divisor);
        }
        Ok(())
    }

    /// How many results there are.
    pub(super) fn outputs(&self) -> usize {
        self.program.outputs()
    }
}

#[cfg(test)]
mod tests {
    use alloc::{format, vec};

    use super::super::interior::Interior;
    use super::super::steps::Steps;
    use super::*;
    use crate::expression::{Expression, Tape};
    use crate::law::ParameterBounds;

    const GAMMA: [f64; 3] = [0.7, 1.9, 1.1];
    const THETA: [f64; 3] = [0.8, -1.3, 0.4];

    fn x(index: usize) -> Expression {
        Expression::variable(index - 1)
    }

    /// Numbers within ±1, always the same.
    fn numbers(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            2.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
        };
        (0..count).map(|_| next()).collect()
    }

    fn gains(n: usize) -> Vec<f64> {
        (0..n).map(|i| 0.9 + 0.1 * i as f64).collect()
    }

    /// A chain of any order in strict-feedback form, with every kind of function in it.
    fn strict(n: usize, p: usize) -> CascadeTerms {
        let function = |i: usize, j: usize| match (i + 2 * j) % 8 {
            0 => x(i).sin_of(),
            1 => x(1) * x(i) * 0.3,
            2 => x(i).tanh_of() * 0.5,
            3 => Expression::number(0.0),
            4 => (x(i).power(2.0) + 2.0).sqrt_of() - x(1).cos_of(),
            5 => -x(i).atan_of() / (x(1).power(2.0) + 2.0),
            6 => (-x(i).power(2.0)).exp_of(),
            _ => (x(1).power(2.0) + 1.5).log_of() * (x(i) + 4.0).power(0.5),
        };
        CascadeTerms::strict((1..=n).map(|i| (0..p).map(|j| function(i, j)).collect()).collect()).unwrap()
    }

    fn pure(n: usize) -> CascadeTerms {
        let above = |i: usize| x((i + 1).min(n));
        let known = (1..=n).map(|i| above(i) * 1.5 + above(i).sin_of() * 0.3 + x(i).power(3.0) * 0.1).collect();
        let regressors = (1..=n).map(|i| vec![above(i).tanh_of() * 0.3, x(1) * x(i)]).collect();
        CascadeTerms::new(known, regressors, x(1).cos_of() + 2.0).unwrap()
    }

    fn run(series: &SeriesSteps, given: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; series.outputs()];
        series.evaluate(given, &mut series.workspace(), &mut out).unwrap();
        out
    }

    #[test]
    fn eq_series_and_expressions_are_one_law() {
        let chains = (1..=5).flat_map(|n| [strict(n, 0), strict(n, 1), strict(n, 3)]).chain((1..=4).map(pure));
        for terms in chains {
            let (n, p) = (terms.order(), terms.parameters());
            // Every other chain has bounds.
            let bounds = ParameterBounds::new(vec![-1.3; p], vec![1.6; p], 1.0);
            let slopes = if n % 2 == 0 { Interior::new(&bounds).slopes(n) } else { Vec::new() };
            let metric = Metric { gamma: &GAMMA[..p], slopes: &slopes };
            let Steps { mut graph, input, divisor, errors, d_theta_hat } =
                Steps::new(&terms, &gains(n), metric).unwrap();
            let mut outputs = vec![input, divisor];
            outputs.extend(&errors);
            outputs.extend(&d_theta_hat);
            for variable in 0..n + p {
                let slopes: Vec<_> = errors.iter().map(|e| graph.derivative(*e, variable).unwrap()).collect();
                outputs.push(graph.dot(&slopes, &errors));
            }
            let tape = Tape::new(&graph, &outputs).unwrap();
            let (mut workspace, mut expected) = (tape.workspace(), vec![0.0; outputs.len()]);
            let series = SeriesSteps::new(&terms, &gains(n), metric).unwrap();
            for seed in 1..20 {
                let given = numbers(seed, 2 * n + p + 1);
                tape.evaluate(&given, &mut workspace, &mut expected).unwrap();
                let found = run(&series, &given);
                for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                    assert!(
                        (found - expected).abs() < 1e-12 * (1.0 + expected.abs()),
                        "{n} {p} {k}: {found} {expected}"
                    );
                }
            }
        }
    }

    /// |V̇ + Σ c e²| over the size of its terms, with the true parameters.
    fn worst(terms: &CascadeTerms) -> f64 {
        let (n, p) = (terms.order(), terms.parameters());
        let series = SeriesSteps::new(terms, &gains(n), &GAMMA[..p]).unwrap();
        let mut worst = 0.0_f64;
        for seed in 1..6 {
            let given = numbers(seed, 2 * n + p + 1);
            let out = run(&series, &given);
            let (x, slopes) = (&given[..n], &out[2 + n + p..]);
            let mut parts = Vec::new();
            for i in 0..n {
                let phi = terms.regressors()[i].iter().zip(THETA).map(|(phi, theta)| theta * phi.value(x));
                let driven = if i + 1 == n { terms.input().value(x) * out[0] } else { 0.0 };
                parts.push(slopes[i] * (terms.known()[i].value(x) + phi.sum::<f64>() + driven));
                parts.push(gains(n)[i] * out[2 + i] * out[2 + i]);
            }
            for j in 0..p {
                let d_theta_hat = out[2 + n + j];
                parts.push(slopes[n + j] * d_theta_hat);
                parts.push((given[n + j] - THETA[j]) * d_theta_hat / GAMMA[j]);
            }
            parts.push(slopes[n + p]);
            let size: f64 = parts.iter().map(|part| part.abs()).sum();
            worst = worst.max(parts.iter().sum::<f64>().abs() / size);
        }
        worst
    }

    #[test]
    fn eq_lyapunov_of_order_ten_loses_the_squares_of_the_errors() {
        for terms in [strict(10, 2), strict(9, 1), strict(7, 3), pure(7), strict(20, 0)] {
            let worst = worst(&terms);
            assert!(worst < 1e-12, "order {} with {} parameters: {worst:e}", terms.order(), terms.parameters());
        }
    }

    #[test]
    fn what_would_take_too_long_is_refused_before_it_is_laid_out() {
        let refused =
            |terms: &CascadeTerms, p: usize| SeriesSteps::new(terms, &gains(terms.order()), &GAMMA[..p]).unwrap_err();
        let error = refused(&strict(30, 3), 3);
        assert_eq!(error, ExpressionError::TooCostly);
        assert!(format!("{error}").contains("5 million multiplications, about 5 ms, and 20 MB"), "{error}");
    }

    #[test]
    fn terms_that_are_never_differentiated_need_no_derivative() {
        let rough = |first: Expression, last: Expression| {
            let terms = CascadeTerms::strict(vec![vec![first], vec![last]]).unwrap();
            SeriesSteps::new(&terms, &gains(2), &GAMMA[..1])
        };
        for (function, rough_one) in
            [("abs", x(1).abs_of()), ("min", x(1).smaller(0.5)), ("max", Expression::number(0.5).larger(x(1)))]
        {
            assert_eq!(rough(rough_one.clone(), x(1)).unwrap_err(), ExpressionError::NotSmooth { function });
            let given = numbers(3, 6);
            let (series, value) = (rough(x(1), rough_one.clone()).unwrap(), rough_one.value(&given));
            let plain = rough(x(1), Expression::number(value)).unwrap();
            let (found, expected) = (run(&series, &given), run(&plain, &given));
            assert!((found[0] - expected[0]).abs() < 1e-14 && found[0] != 0.0, "{found:?} {expected:?}");
        }
        // Of a constant they are constants.
        assert!(rough(Expression::number(2.0).smaller(-3.0).abs_of() * x(1), x(1)).is_ok());
    }

    #[test]
    fn what_is_not_a_number_is_not_hidden() {
        let series = SeriesSteps::new(&strict(6, 2), &gains(6), &GAMMA[..2]).unwrap();
        let mut given = numbers(1, 15);
        for place in [0, 5, 6, 8, 14] {
            let before = core::mem::replace(&mut given[place], f64::NAN);
            assert!(run(&series, &given)[0].is_nan(), "{place}");
            given[place] = before;
        }
        assert!(run(&series, &given)[0].is_finite());
        let mut out = vec![0.0; series.outputs()];
        assert!(series.evaluate(&given, &mut [0.0; 3], &mut out).is_err());
    }
}
