//! What a command that is held, late, or taken from filtered differences does to one mode of s: how fast the mode may be.
//!
//! Not from the paper, derived for this software. M is frozen and nothing adapts. Along a mode with the rate λ, and k = h λ, let the
//! command act δ h after its sample, δ ≤ 1. With measured velocities
//!
//! ```text
//! v⁺ = v − k [(1 − δ) v + δ v⁻]          μ² − (1 − k (1 − δ)) μ + k δ = 0
//! ```
//!
//! whose roots are within the unit circle exactly for k < 2/(1 − 2δ), where δ < ½, and k < 1/δ.
//!
//! With filtered differences of positions, a = e^(−ωh), the controller sees f in place of v. Over a period v falls in two pieces,
//! so that its mean is v − k [½ (1 − δ)² f + (δ − ½ δ²) f⁻], and
//!
//! ```text
//! v⁺ = v − k [(1 − δ) f + δ f⁻]
//! f⁺ = a f + (1 − a) (v − k [½ (1 − δ)² f + (δ − ½ δ²) f⁻])
//! ```
//!
//! With κ = (1 − a) k and b = ½ (1 − δ)² the multipliers are the roots of
//!
//! ```text
//! μ³ + (κ b − 1 − a) μ² + (a + κ (½ + δ − δ²)) μ + ½ κ δ² = 0
//! ```
//!
//! By the criterion of Jury they are within the unit circle exactly where, besides κ > 0,
//!
//! ```text
//! ½ κ δ² < 1
//! 1 − a − κ (½ + δ − ½ δ² + ½ a δ²) + ¼ κ² δ² (1 − 2δ) > 0
//! 1 + a + κ (½ + δ − ½ δ² + ½ a δ²) − ¼ κ² δ² (δ² + (1 − δ)²) > 0
//! ```
//!
//! (that at μ = −1 holds for every δ in [0, 1]). The first κ at which one of them fails bounds every mode: the whole spectrum below it
//! decays. Without a delay it is k = 2 whatever the cut-off.
//!
//! With the adaptation besides, Y frozen, u = w − K f and P = Y Γ Yᵀ, it is, with all axes,
//!
//! ```text
//! s⁺ = s + h M⁻¹ [(1 − δ) u + δ u⁻]      f⁺ = a f + (1 − a) (s + h M⁻¹ [½ (1 − δ)² u + (δ − ½ δ²) u⁻])      w⁺ = w − h P f⁺
//! ```
//!
//! where f is s with measured velocities. What is learnt comes ℓ periods later than with a command that acts at once: δ, and besides
//! ½ + a/(1 − a) = ½ + 1/(e^(ωh) − 1) for the difference and its filter. Since ẇ = −P s, that is w + ℓ h P s to first order, so that ℓ h P
//! is taken from K.

use forwardstep_sim::{Control, VelocitySensor};
use nalgebra::DMatrix;

use crate::prediction::roots::eigenvalues::eigenvalues;

/// How a command reaches its robot, besides being held for a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// How long after its sample it acts, s; at most a period.
    pub delay_s: f64,
    /// The cut-off ω of the filter, rad/s, where velocities are filtered differences of positions.
    pub cut_off_rad_s: Option<f64>,
}

/// Halvings of an interval, enough for all digits of an `f64`.
const HALVINGS: u32 = 60;
/// Factor from one period to the next while a stable one is looked for, and how many are looked at.
const SCAN: (f64, u32) = (0.9, 400);

impl Hold {
    /// Measured velocities, and a command that acts at once.
    pub const IDEAL: Hold = Hold { delay_s: 0.0, cut_off_rad_s: None };

    /// That of a setup under digital control.
    pub fn of(control: &Control) -> Hold {
        let cut_off_rad_s = match control.sensors.velocity {
            VelocitySensor::Measured => None,
            VelocitySensor::Filtered { cut_off_hz } => Some(core::f64::consts::TAU * cut_off_hz),
        };
        Hold { delay_s: control.computation_delay_s, cut_off_rad_s }
    }

    /// Whether it is [`Hold::IDEAL`].
    pub fn is_ideal(self) -> bool {
        self.delay_s == 0.0 && self.cut_off_rad_s.is_none()
    }

    /// Every mode with h λ below this decays when sampled with the period h = `period_s`; infinity where every mode does.
    pub fn largest_gain(self, period_s: f64) -> f64 {
        let late = self.delay_s / period_s;
        match self.cut_off_rad_s {
            None => measured(late),
            Some(cut_off_rad_s) => filtered(late, -libm::expm1(-cut_off_rad_s * period_s)),
        }
    }

    /// ℓ, by how many periods what is learnt acts later than with measured velocities and commands that act at once.
    pub(super) fn lag(self, period_s: f64) -> f64 {
        self.delay_s / period_s + self.filter_lag(period_s)
    }

    /// How many periods ago the velocity was that a filter gives; zero where it is measured.
    pub(super) fn filter_lag(self, period_s: f64) -> f64 {
        self.cut_off_rad_s.map_or(0.0, |cut_off_rad_s| 0.5 + 1.0 / libm::expm1(cut_off_rad_s * period_s))
    }

    /// The largest multiplier of a period by its size, with Y frozen: of M⁻¹ K and of M⁻¹ P; `None` where it is not found.
    pub(super) fn radius(self, period_s: f64, damping: &DMatrix<f64>, learning: &DMatrix<f64>) -> Option<f64> {
        let (late, h, m) = (self.delay_s / period_s, period_s, damping.nrows());
        let early = 1.0 - late;
        // A row of the state (s, f, w, u⁻) for every quantity; h M⁻¹ is taken into w and u.
        let part = |at: usize| DMatrix::from_fn(m, 4 * m, |i, j| f64::from(u8::from(j == at * m + i)));
        let [s, filtered, w, before] = [0, 1, 2, 3].map(part);
        let f = if self.cut_off_rad_s.is_some() { &filtered } else { &s };
        let u = &w - h * damping * f;
        let next = &s + early * &u + late * &before;
        let next_f = match self.cut_off_rad_s {
            None => next.clone(),
            Some(cut_off_rad_s) => {
                let quick = -libm::expm1(-cut_off_rad_s * h);
                let moved = &s + 0.5 * early * early * &u + (late - 0.5 * late * late) * &before;
                (1.0 - quick) * f + quick * moved
            }
        };
        let next_w = &w - h * h * learning * &next_f;
        let mut all = DMatrix::zeros(4 * m, 4 * m);
        for (at, rows) in [&next, &next_f, &next_w, &u].into_iter().enumerate() {
            all.rows_mut(at * m, m).copy_from(rows);
        }
        Some(eigenvalues(&all)?.iter().map(|root| root.norm()).fold(0.0, f64::max))
    }
}

/// The longest period, s, at which `decays`, where a period is held as `hold` says: the end of the interval of such periods that holds
/// `near_s`, or of the next one below it. `None` where there is none: the delay is too long, however fast the samples.
pub(super) fn longest_period_s(near_s: f64, hold: &impl Fn(f64) -> Hold, decays: impl Fn(f64) -> bool) -> Option<f64> {
    // No command may come later than the next sample.
    let at_least = |period_s: f64| period_s.max(hold(period_s).delay_s);
    let (step, most) = SCAN;
    let (mut low, mut high) = (at_least(near_s), at_least(near_s));
    let mut left = most;
    while !decays(low) {
        let shorter = at_least(step * low);
        if left == 0 || shorter >= low {
            return None;
        }
        left -= 1;
        (high, low) = (low, shorter);
    }
    while decays(high) {
        if left == 0 {
            return Some(f64::INFINITY);
        }
        left -= 1;
        (low, high) = (high, high / step);
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if decays(middle) { low = middle } else { high = middle }
    }
    Some(low)
}

/// k for measured velocities; `late` is δ.
fn measured(late: f64) -> f64 {
    let slow = if late < 0.5 { 2.0 / (1.0 - 2.0 * late) } else { f64::INFINITY };
    slow.min(1.0 / late)
}

/// k for filtered differences; `quick` is 1 − a.
fn filtered(late: f64, quick: f64) -> f64 {
    let squared = late * late;
    let middle = 0.5 + late - 0.5 * squared + 0.5 * (1.0 - quick) * squared;
    let product = 2.0 / squared;
    let turning = first_root(quick, -middle, 0.25 * squared * (1.0 - 2.0 * late));
    let early = 1.0 - late;
    let real = first_root(2.0 - quick, middle, -0.25 * squared * (squared + early * early));
    product.min(turning).min(real) / quick
}

/// The smallest positive root of c + b x + a x², which is positive at zero; infinity where there is none.
fn first_root(c: f64, b: f64, a: f64) -> f64 {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    // Without cancellation: one root is q/a, the other c/q.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    [q / a, c / q].into_iter().filter(|root| *root > 0.0).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    fn radius(matrix: &DMatrix<f64>) -> f64 {
        matrix.complex_eigenvalues().iter().map(|root| root.norm()).fold(0.0, f64::max)
    }

    /// The recursions as they are written at the head of the file.
    fn recursion(hold: Hold, period_s: f64, k: f64) -> DMatrix<f64> {
        let d = hold.delay_s / period_s;
        match hold.cut_off_rad_s {
            None => DMatrix::from_row_slice(2, 2, &[1.0 - k * (1.0 - d), -k * d, 1.0, 0.0]),
            Some(cut_off) => {
                let a = libm::exp(-cut_off * period_s);
                let (b, c) = (0.5 * (1.0 - d) * (1.0 - d), d - 0.5 * d * d);
                let quick = 1.0 - a;
                let rows = [1.0, -k * (1.0 - d), -k * d, quick, a - quick * k * b, -quick * k * c, 0.0, 1.0, 0.0];
                DMatrix::from_row_slice(3, 3, &rows)
            }
        }
    }

    fn holds() -> impl Iterator<Item = (Hold, f64)> {
        let filters = [None, Some(1e-3), Some(20.0), Some(377.0), Some(1e4), Some(1e7)];
        filters.into_iter().flat_map(|cut_off_rad_s| {
            let lates = [0.0, 1e-3, 0.1, 0.25, 0.3, 0.4999, 0.5, 0.6, 0.75, 0.9, 1.0];
            lates.map(move |late| (Hold { delay_s: 0.002 * late, cut_off_rad_s }, 0.002))
        })
    }

    #[test]
    fn eq_the_recursion_crosses_the_unit_circle_exactly_at_the_rule() {
        for (hold, period_s) in holds() {
            let k = hold.largest_gain(period_s);
            assert!(k > 0.0 && k.is_finite(), "{hold:?}: {k}");
            for share in [0.02, 0.3, 0.7, 0.95, 0.9999] {
                let radius = radius(&recursion(hold, period_s, share * k));
                assert!(radius < 1.0 + 1e-12, "{hold:?}: {radius} at {share} of {k}");
            }
            let beyond = radius(&recursion(hold, period_s, 1.001 * k));
            assert!(beyond > 1.0, "{hold:?}: {beyond} beyond {k}");
        }
    }

    #[test]
    fn eq_a_filter_without_delay_changes_no_limit_and_a_quarter_of_a_period_doubles_it() {
        for cut_off_rad_s in [None, Some(5.0), Some(400.0)] {
            assert!((Hold { delay_s: 0.0, cut_off_rad_s }.largest_gain(0.01) - 2.0).abs() < 1e-12);
        }
        let gain = |late: f64| Hold { delay_s: 0.01 * late, cut_off_rad_s: None }.largest_gain(0.01);
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(gain), [2.0, 4.0, 2.0, 1.0]);
    }

    /// Of modes up to a rate.
    fn longest(rate_per_s: f64, near_s: f64, hold: impl Fn(f64) -> Hold) -> Option<f64> {
        longest_period_s(near_s, &hold, |period_s| rate_per_s * period_s < hold(period_s).largest_gain(period_s))
    }

    #[test]
    fn the_longest_period_ends_where_modes_no_longer_decay() {
        for (hold, near_s) in holds() {
            for rate_per_s in [1.0, 90.0, 400.0] {
                let share = |period_s: f64| period_s * rate_per_s / hold.largest_gain(period_s);
                match longest(rate_per_s, near_s, |_| hold) {
                    Some(longest_s) => {
                        assert!(longest_s >= hold.delay_s && (share(longest_s) - 1.0).abs() < 1e-9, "{hold:?}");
                        assert!(share(1.001 * longest_s) > 1.0, "{hold:?} at {rate_per_s}");
                    }
                    None => {
                        for step in 0..200 {
                            let period_s = hold.delay_s + f64::from(step) * 1e-5;
                            assert!(share(period_s) >= 1.0, "{hold:?} at {rate_per_s}: {period_s}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn no_rate_of_samples_makes_up_for_a_delay_that_is_too_long() {
        let hold = Hold { delay_s: 0.02, cut_off_rad_s: None };
        // λ d is 0.98 and 1.02.
        let longest_s = longest(49.0, 0.5, |_| hold).unwrap_or_default();
        assert!((longest_s - (2.0 / 49.0 + 0.04)).abs() < 1e-9, "{longest_s}");
        assert_eq!(longest(51.0, 0.5, |_| hold), None);
        assert_eq!(longest(0.0, 0.5, |_| Hold::IDEAL), Some(f64::INFINITY));
        // A delay that is a part of the period shrinks with it.
        let part = |period_s: f64| Hold { delay_s: 0.9 * period_s, cut_off_rad_s: None };
        let longest_s = longest(51.0, 0.5, part).unwrap_or_default();
        assert!((longest_s - 1.0 / (0.9 * 51.0)).abs() < 1e-9, "{longest_s}");
    }
}
