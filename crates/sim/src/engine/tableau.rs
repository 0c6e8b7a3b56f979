//! Runge–Kutta methods as numbers.
//!
//! Both methods evaluate the right-hand side once more at the end of the step ("first same as last"): the last stage is
//! the new state. The continuous extension is
//!
//! ```text
//! x(t + θh) = r₁ + θ (r₂ + (1−θ) (r₃ + θ (r₄ + (1−θ) r₅)))
//! r₁ = x₀   r₂ = x₁ − x₀   r₃ = h k₁ − r₂   r₄ = r₂ − h k_last − r₃   r₅ = h Σ dᵢ kᵢ
//! ```
//!
//! the cubic Hermite polynomial plus, for the Dormand–Prince pair, a quartic term that makes it of order four.

/// One explicit method.
#[derive(Debug)]
pub(crate) struct Tableau {
    /// Stage times as fractions of the step, the first is 0 and the last 1.
    pub(crate) c: &'static [f64],
    /// Row s holds the weights of k₀ … k_{s−1} for the state of stage s; the last row makes the new state.
    pub(crate) a: &'static [&'static [f64]],
    /// Weights of the error estimate; empty when there is none.
    pub(crate) error: &'static [f64],
    /// dᵢ.
    pub(crate) dense: &'static [f64],
}

/// Dormand and Prince, *A family of embedded Runge–Kutta formulae*, 1980; continuous extension of order four after Shampine,
/// *Some practical Runge–Kutta formulas*, 1986, in the form of Hairer, Nørsett and Wanner, *Solving ODEs I*, II.6.
pub(crate) static DORMAND_PRINCE: Tableau = Tableau {
    c: &[0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0],
    a: &[
        &[],
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
        &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
        &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
    ],
    error: &[71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0],
    dense: &[
        -12715105075.0 / 11282082432.0,
        0.0,
        87487479700.0 / 32700410799.0,
        -10690763975.0 / 1880347072.0,
        701980252875.0 / 199316789632.0,
        -1453857185.0 / 822651844.0,
        69997945.0 / 29380423.0,
    ],
};

/// The classical method of order four, with cubic Hermite interpolation.
pub(crate) static CLASSICAL: Tableau = Tableau {
    c: &[0.0, 0.5, 0.5, 1.0, 1.0],
    a: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0], &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0]],
    error: &[],
    dense: &[0.0; 5],
};

/// The factors of r₂ … r₅ at θ; that of r₁ is one.
#[inline(always)]
pub(crate) fn basis(theta: f64) -> [f64; 4] {
    let rest = 1.0 - theta;
    let b3 = theta * rest;
    let b4 = b3 * theta;
    [theta, b3, b4, b4 * rest]
}

/// The derivatives of [`basis`].
pub(crate) fn slope(theta: f64) -> [f64; 4] {
    let rest = 1.0 - theta;
    [1.0, rest - theta, theta * (2.0 - 3.0 * theta), 2.0 * theta * rest * (rest - theta)]
}

impl Tableau {
    /// The weights of h kᵢ in x(t + θh) − x₀, at most seven.
    pub(crate) fn dense_weights(&self, theta: f64) -> [f64; 7] {
        let [b2, b3, b4, b5] = basis(theta);
        let mut weights = [0.0; 7];
        let last = self.c.len() - 1;
        let Some(new) = self.a.last() else { return weights };
        // r₂ stands in r₂, −r₃ and 2 r₄; h k₁ in r₃ and −r₄; h k_last in −r₄.
        for (w, b) in weights.iter_mut().zip(*new) {
            *w = (b2 - b3 + 2.0 * b4) * b;
        }
        for (w, d) in weights.iter_mut().zip(self.dense) {
            *w += b5 * d;
        }
        weights[0] += b3 - b4;
        weights[last] -= b4;
        weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Order conditions up to the stated order for the trees that a quadrature sees: Σ bᵢ cᵢᵏ = θᵏ⁺¹/(k+1).
    fn quadrature_defect(tableau: &Tableau, theta: f64, k: i32) -> f64 {
        let weights = tableau.dense_weights(theta);
        let sum: f64 = tableau.c.iter().zip(weights).map(|(c, w)| w * c.powi(k)).sum();
        (sum - theta.powi(k + 1) / f64::from(k + 1)).abs()
    }

    #[test]
    fn continuous_extensions_have_their_order() {
        for theta in [0.1, 0.37, 0.5, 0.9, 1.0] {
            for k in 0..4 {
                assert!(quadrature_defect(&DORMAND_PRINCE, theta, k) < 1e-14);
            }
            for k in 0..3 {
                assert!(quadrature_defect(&CLASSICAL, theta, k) < 1e-14);
            }
        }
        assert!(quadrature_defect(&DORMAND_PRINCE, 1.0, 4) < 1e-14);
    }

    #[test]
    fn rows_sum_to_their_stage_times_and_the_error_to_zero() {
        for tableau in [&DORMAND_PRINCE, &CLASSICAL] {
            for (row, c) in tableau.a.iter().zip(tableau.c) {
                assert!((row.iter().sum::<f64>() - c).abs() < 1e-14);
            }
            assert!(tableau.error.iter().sum::<f64>().abs() < 1e-14);
        }
    }
}
