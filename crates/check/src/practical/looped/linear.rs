//! The matrices of one period of an agent, and what its multipliers say.

use forwardstep_sim::{Periods, Setup, sampled_loop};
use nalgebra::{Complex, DMatrix};

use crate::prediction::roots::eigenvalues::eigenvalues;

/// Angles at which G is looked at, from the smallest on.
const ANGLES: (f64, u32) = (1e-3, 40);
/// How much two agents differ that are alike, as a part of what a period does.
const ALIKE: f64 = 0.01;

/// x⁺ = J x + B₁ m̄ + B₂ m̄⁺, m = C x.
#[derive(Clone)]
pub(super) struct Linear {
    pub(super) period_s: f64,
    /// J.
    pub(super) own: DMatrix<f64>,
    /// C.
    pub(super) tells: DMatrix<f64>,
    /// B₁ and B₂.
    pub(super) hears: [DMatrix<f64>; 2],
}

impl Linear {
    /// Of these periods of an agent by itself, where it hears others with weights that sum to `degree`; `None` where nothing finite is
    /// found.
    pub(super) fn of(setup: &Setup, agent: usize, degree: f64, periods: Periods) -> Option<Linear> {
        let found = sampled_loop(setup, agent, degree, periods).ok()??;
        let (n, m) = (found.size, found.message);
        let hears = found.hears.map(|entries| DMatrix::from_row_slice(n, m, &entries));
        let period_s = f64::from(periods.over) / setup.control.as_ref()?.sample_hz;
        let own = DMatrix::from_row_slice(n, n, &found.own);
        Some(Linear { period_s, own, tells: DMatrix::from_row_slice(m, n, &found.tells), hears })
    }

    /// Numbers of state.
    pub(super) fn size(&self) -> usize {
        self.own.nrows()
    }

    /// Whether one period is nearly the same map: what differs is small beside what a period does.
    pub(super) fn is_like(&self, other: &Linear) -> bool {
        let n = self.size();
        let done = (&self.own - DMatrix::identity(n, n)).amax();
        let near = |a: &DMatrix<f64>, b: &DMatrix<f64>| a.shape() == b.shape() && (a - b).amax() <= ALIKE * done;
        let hears = self.hears.iter().zip(&other.hears).all(|(a, b)| near(a, b));
        near(&self.own, &other.own) && self.tells.shape() == other.tells.shape() && hears
    }

    /// All μ by itself.
    pub(super) fn multipliers(&self) -> Option<Vec<Complex<f64>>> {
        let n = self.size();
        Some(eigenvalues(&(&self.own - DMatrix::identity(n, n)))?.into_iter().map(|mu| mu + 1.0).collect())
    }

    /// The largest ln|μ|/h where m̄ is this share of m.
    pub(super) fn rate_with(&self, share: Complex<f64>) -> Option<f64> {
        let n = self.size();
        let [begin, end] = self.hears.each_ref().map(|hears| complex(&(hears * &self.tells)) * share);
        let one = DMatrix::<Complex<f64>>::identity(n, n);
        let period = (&one - end).lu().solve(&(complex(&self.own) + begin))? - one;
        rate(&in_reals(&period), self.period_s)
    }

    /// The largest spectral radius of G on the unit circle.
    pub(super) fn passed_on(&self) -> f64 {
        let n = self.size();
        let (own, tells) = (complex(&self.own), complex(&self.tells));
        let (first, count) = ANGLES;
        let step = libm::pow(core::f64::consts::PI / first, 1.0 / f64::from(count));
        let radius = |k: u32| {
            let mu = Complex::from_polar(1.0, first * libm::pow(step, f64::from(k)));
            let heard = complex(&self.hears[0]) + complex(&self.hears[1]) * mu;
            let state = (DMatrix::identity(n, n) * mu - &own).lu().solve(&heard)?;
            Some(eigenvalues(&in_reals(&(&tells * state)))?.into_iter().map(|it| it.norm()).fold(0.0, f64::max))
        };
        (0..=count).filter_map(radius).fold(0.0, f64::max)
    }
}

/// The largest ln|μ|/h of a map, of which `away` is what it adds to its state: it is close to 1 when a period is short, and the QR
/// algorithm then stalls on it, but not on what is left.
pub(super) fn rate(away: &DMatrix<f64>, period_s: f64) -> Option<f64> {
    Some(fastest(&eigenvalues(away)?.into_iter().map(|mu| mu + 1.0).collect::<Vec<_>>(), period_s))
}

/// The largest ln|μ|/h.
pub(super) fn fastest(multipliers: &[Complex<f64>], period_s: f64) -> f64 {
    libm::log(multipliers.iter().map(|mu| mu.norm()).fold(0.0, f64::max)) / period_s
}

fn complex(matrix: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
    matrix.map(|entry| Complex::new(entry, 0.0))
}

/// Of real and imaginary parts together: the eigenvalues of a matrix and their conjugates.
fn in_reals(matrix: &DMatrix<Complex<f64>>) -> DMatrix<f64> {
    let n = matrix.nrows();
    DMatrix::from_fn(2 * n, 2 * n, |k, l| {
        let entry = matrix[(k % n, l % n)];
        match (k < n, l < n) {
            (true, true) | (false, false) => entry.re,
            (true, false) => -entry.im,
            (false, true) => entry.im,
        }
    })
}
