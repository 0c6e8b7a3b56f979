//! Taylor coefficients gⱼ = f⁽ʲ⁾(a)/j! of functions of one number.
//!
//! ```text
//! eᵃ        gⱼ = g_{j−1}/j
//! sin, cos  the same with a quarter turn each
//! aᶜ        gⱼ = C(c, j) a^{c−j}
//! ln a      g₁ = 1/a,  gⱼ = −g_{j−1} (j−1)/(j a)
//! tanh a    g' = 1 − g²
//! arctan a  (1 + a²) g' = 1
//! ```

use super::super::Unary;
use super::super::float::{apply, power, whole};

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outer {
    Function(Unary),
    /// aᶜ.
    Power(f64),
}

impl Outer {
    /// The degree, of a polynomial.
    pub(super) fn degree(self) -> Option<usize> {
        match self {
            Outer::Power(exponent) => whole(exponent).and_then(|n| usize::try_from(n).ok()),
            Outer::Function(_) => None,
        }
    }

    /// g₀, g₁, … at a.
    pub(super) fn coefficients(self, a: f64, g: &mut [f64]) {
        match self {
            Outer::Power(exponent) => powers(a, exponent, g),
            Outer::Function(function) => {
                if let Some(first) = g.first_mut() {
                    *first = apply(function, a);
                }
                self::function(function, a, g);
            }
        }
    }
}

fn powers(a: f64, exponent: f64, g: &mut [f64]) {
    let mut binomial = 1.0;
    for (j, g) in g.iter_mut().enumerate() {
        let left = exponent - j as f64;
        *g = binomial * power(a, left);
        binomial *= left / (j + 1) as f64;
    }
}

/// Fills what follows g₀.
fn function(function: Unary, a: f64, g: &mut [f64]) {
    match function {
        Unary::Negate => fill(g, |j, _| if j == 1 { -1.0 } else { 0.0 }),
        // Only its value is asked for.
        Unary::Abs => fill(g, |_, _| f64::NAN),
        Unary::Exp => fill(g, |j, g| g[j - 1] / j as f64),
        Unary::Sin | Unary::Cos => {
            let (sin, cos) = (apply(Unary::Sin, a), apply(Unary::Cos, a));
            let turns = if function == Unary::Sin { [sin, cos, -sin, -cos] } else { [cos, -sin, -cos, sin] };
            let mut factorial = 1.0;
            fill(g, |j, _| {
                factorial *= j as f64;
                turns[j % 4] / factorial
            });
        }
        Unary::Log => fill(g, |j, g| if j == 1 { 1.0 / a } else { -g[j - 1] * (j - 1) as f64 / (j as f64 * a) }),
        Unary::Sqrt => powers(a, 0.5, g),
        // j gⱼ = [j = 1] − Σ_{i<j} g_i g_{j−1−i}
        Unary::Tanh => fill(g, |j, g| {
            let square: f64 = (0..j).map(|i| g[i] * g[j - 1 - i]).sum();
            (if j == 1 { 1.0 - square } else { -square }) / j as f64
        }),
        // With h = g': (1 + a²) h_k + 2 a h_{k−1} + h_{k−2} = [k = 0].
        Unary::Atan => fill(g, |j, g| {
            let h = |k: usize| g[k + 1] * (k + 1) as f64;
            let k = j - 1;
            let (one, two) = (if k >= 1 { 2.0 * a * h(k - 1) } else { -1.0 }, if k >= 2 { h(k - 2) } else { 0.0 });
            -(one + two) / (1.0 + a * a) / j as f64
        }),
    }
}

/// Sets entries 1, 2, … from those before.
fn fill(g: &mut [f64], mut next: impl FnMut(usize, &[f64]) -> f64) {
    for j in 1..g.len() {
        g[j] = next(j, g);
    }
}
