//! By how much a mode of s swings up when its command comes late, or from a filter that lags.
//!
//! Not from the paper, derived for this software. With the letters of `held`, a disturbance d that is constant over a period, as ε = K⁻¹d of a
//! mode, and adaptation of the rate p = h² P/M with Y frozen, a mode is
//!
//! ```text
//! v⁺ = v + (1 − δ) u + δ u⁻ + k ε      u = w − k f      w⁺ = w − p f⁺
//! f⁺ = a f + (1 − a) (v + ½ (1 − δ)² u + (δ − ½ δ²) u⁻ + ½ k ε)      or f = v with measured velocities
//! ```
//!
//! In terms of μ = e^(iϑ), with g = k + p μ/(μ − 1), L₁ = 1 − δ + δ/μ, L₂ = ½ (1 − δ)² + (δ − ½ δ²)/μ and D = μ − a + (1 − a) L₂ g,
//!
//! ```text
//! v/ε = k (1 − ½ (1 − a) L₁ g/D)/(μ − 1 + (1 − a) L₁ g/D)      or k/(μ − 1 + L₁ g)
//! ```
//!
//! In continuous time without a filter |v/ε| ≤ 1: a force pushes s by K⁻¹ d at most. A filter of 2 Hz under a damping of 80/s lets it swing up to
//! seven times as far at 5 Hz, though every mode decays. The mean of sᵀKs is thus up to max|v/ε|² times what it would be, and what
//! is left of V(0) = ½ M v² + ½ M w²/p (per axis) up to G times, G the largest eigenvalue of 2 k Σ [v₁ v₁, v₁ v₂; v₂ v₁, v₂ v₂]
//! over the samples of two runs, one that begins with v = 1 and one with w = √p. Noise is of all frequencies: per D² of its n, independent from sample to
//! sample, it makes Σ v² of a run that begins at rest and has one such error; of a filter, which takes differences of positions, D² is
//! 2 (1 − a)²/(1 + a) times the square of the error of one position, and that error comes into f as (1 − a) and, a sample later, as its negative.
//!
//! M and Y are those of one state, as with σ: it says what is to be expected.

use nalgebra::Complex;

use super::held::Hold;

/// Frequencies that are looked at, and the lowest of them in radians per sample.
const FREQUENCIES: (u32, f64) = (500, 1e-6);
/// Parts of an interval that is searched for a peak, and how often it is.
const REFINED: u32 = 40;
/// Samples until a transient is taken for over, and what of it may be left.
const TRANSIENT: (u32, f64) = (20_000, 1e-9);

/// What commands that are late or velocities that are filtered multiply powers by, at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// What forces make of s: max|v/ε|².
    pub forced: f64,
    /// What is left of a start: G.
    pub started: f64,
    /// What noise makes of s, beside its D².
    pub noise: f64,
}

/// A mode under a hold.
struct Mode {
    late: f64,
    /// 1 − a; one where velocities are measured.
    quick: f64,
    is_filtered: bool,
    k: f64,
    p: f64,
}

impl Swing {
    /// Of commands that act at once with measured velocities, where σ tells all there is.
    pub const NONE: Swing = Swing { forced: 1.0, started: 1.0, noise: 1.0 };

    /// The larger of both, one by one.
    pub(super) fn max(self, other: Swing) -> Swing {
        Swing {
            forced: self.forced.max(other.forced),
            started: self.started.max(other.started),
            noise: self.noise.max(other.noise),
        }
    }
}

impl Hold {
    /// That at a state whose fastest mode and σ are known.
    pub(super) fn swing_at(self, period_s: f64, fastest_per_s: f64, sigma: f64) -> Swing {
        let k = period_s * fastest_per_s;
        // What of σ is not the damping's is h (½ + ℓ) P relative to K.
        let learnt = (sigma - k / self.largest_gain(period_s)).max(0.0) / (0.5 + self.lag(period_s));
        self.swing(period_s, k, learnt * k)
    }

    /// That of modes up to k = h λ, which learn at p: slower ones, which learn as much more slowly, swing less, as a test shows.
    fn swing(self, period_s: f64, k: f64, p: f64) -> Swing {
        if self.is_ideal() {
            return Swing::NONE;
        }
        let mode = self.mode(period_s, k, p);
        let peak = mode.peak();
        // However slow a mode is, a force that lasts and a start make one.
        Swing { forced: (peak * peak).max(1.0), started: mode.transient().max(1.0), noise: mode.noise() }
    }

    fn mode(self, period_s: f64, k: f64, p: f64) -> Mode {
        let quick = self.cut_off_rad_s.map_or(1.0, |cut_off_rad_s| -libm::expm1(-cut_off_rad_s * period_s));
        Mode { late: self.delay_s / period_s, quick, is_filtered: self.cut_off_rad_s.is_some(), k, p }
    }
}

impl Mode {
    /// |v/ε| at so many radians per sample.
    fn swing(&self, angle: f64) -> f64 {
        let one = Complex::new(1.0, 0.0);
        let mu = Complex::new(libm::cos(angle), libm::sin(angle));
        // e^(iϑ) − 1 without cancellation.
        let step = Complex::new(0.0, 2.0 * libm::sin(0.5 * angle))
            * Complex::new(libm::cos(0.5 * angle), libm::sin(0.5 * angle));
        let (early, late) = (1.0 - self.late, self.late);
        let g = one * self.k + mu * self.p / step;
        let acts = (one * early + one * late / mu) * g;
        let found = if self.is_filtered {
            let moves = one * (0.5 * early * early) + one * (late - 0.5 * late * late) / mu;
            let filter = step + (one + moves * g) * self.quick;
            let seen = acts * self.quick / filter;
            (one - seen * 0.5) * self.k / (step + seen)
        } else {
            one * self.k / (step + acts)
        };
        found.norm()
    }

    /// The largest of it over all frequencies.
    fn peak(&self) -> f64 {
        let (steps, lowest) = FREQUENCIES;
        let at = |step: f64| lowest * libm::pow(core::f64::consts::PI / lowest, step / f64::from(steps));
        let swing = |step: f64| self.swing(at(step));
        let (best, _) = (0..=steps)
            .map(|step| (step, swing(f64::from(step))))
            .fold((0, 0.0), |best, it| if it.1 > best.1 { it } else { best });
        let (mut low, mut high) = (f64::from(best.saturating_sub(1)), f64::from((best + 1).min(steps)));
        for _ in 0..REFINED {
            let third = (high - low) / 3.0;
            if swing(low + third) < swing(high - third) { low += third } else { high -= third }
        }
        swing(f64::from(best)).max(swing(0.5 * (low + high)))
    }

    /// G.
    fn transient(&self) -> f64 {
        let (most, left) = TRANSIENT;
        // v, f, w, u⁻ of both runs.
        let mut runs = [[1.0, if self.is_filtered { 0.0 } else { 1.0 }, 0.0, 0.0], [0.0, 0.0, self.p.sqrt(), 0.0]];
        let [mut a, mut b, mut c] = [0.0; 3];
        for _ in 0..most {
            let [[v, ..], [of_w, ..]] = runs;
            (a, b, c) = (a + v * v, b + v * of_w, c + of_w * of_w);
            runs = runs.map(|run| self.next(run));
            if runs.iter().flatten().all(|state| state.abs() < left) {
                break;
            }
        }
        let half = 0.5 * (a - c);
        2.0 * self.k * (0.5 * (a + c) + libm::hypot(half, b))
    }

    /// Σ v² of one error of what is measured, per D² of such errors at every sample.
    fn noise(&self) -> f64 {
        let (most, left) = TRANSIENT;
        let mut state = [0.0, self.quick, -self.p * self.quick, 0.0];
        let mut sum = 0.0;
        for sample in 0..most {
            state = self.next(state);
            if sample == 0 {
                // The error of the next difference; of a measured velocity there is none, and f is v.
                let error = if self.is_filtered { -self.quick } else { 0.0 };
                state[1] += error;
                state[2] -= self.p * error;
            }
            sum += state[0] * state[0];
            if state.iter().all(|state| state.abs() < left) {
                break;
            }
        }
        let square = if self.is_filtered { 2.0 * self.quick * self.quick / (2.0 - self.quick) } else { 1.0 };
        sum / square
    }

    /// A sample later.
    fn next(&self, [v, f, w, before]: [f64; 4]) -> [f64; 4] {
        let (early, late) = (1.0 - self.late, self.late);
        let u = w - self.k * f;
        let next = v + early * u + late * before;
        let next_f = if self.is_filtered {
            let moved = v + 0.5 * early * early * u + (late - 0.5 * late * late) * before;
            f + self.quick * (moved - f)
        } else {
            next
        };
        [next, next_f, w - self.p * next_f, u]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A filter, sampled so fast that its mode is p² τ + p + k = 0 in continuous time, k the rate and τ the lag.
    #[test]
    fn eq_a_filtered_mode_swings_up_as_in_continuous_time() {
        for (rate, lag_s) in [(81.0, 0.08), (20.0, 0.01), (5.0, 1.0)] {
            let period_s = 2e-6;
            let hold = Hold { delay_s: 0.0, cut_off_rad_s: Some(1.0 / lag_s) };
            let mode = hold.mode(period_s, rate * period_s, 0.0);
            let swing = |omega: f64| {
                let filter = Complex::new(1.0, 0.0) / Complex::new(1.0, omega * lag_s);
                (Complex::new(1.0, 0.0) / (Complex::new(0.0, omega / rate) + filter)).norm()
            };
            let peak = (1..40_000).map(|k| swing(f64::from(k) * 0.01)).fold(0.0, f64::max);
            assert!((mode.peak() / peak - 1.0).abs() < 1e-3, "{} {peak}", mode.peak());
            assert!((mode.swing(period_s * 3.0) / swing(3.0) - 1.0).abs() < 1e-3);
            let whole = hold.swing(period_s, rate * period_s, 0.0).forced;
            assert!(whole >= 0.999 * peak * peak, "{whole} {peak}");
            let started = hold.swing(period_s, rate * period_s, 0.0).started;
            assert!(started >= mode.transient(), "{started}");
        }
    }

    /// By Parseval, what is left of v(0) = 1 is (1 + k τ)/(2 k) with a filter, and cos(k d)/(2 k (1 − sin(k d))) with a delay.
    #[test]
    fn eq_what_is_left_of_a_start_is_that_of_closed_forms() {
        let (rate, lag_s, period_s) = (20.0, 0.05, 1e-3);
        let mode = Hold { delay_s: 0.0, cut_off_rad_s: Some(1.0 / lag_s) }.mode(period_s, rate * period_s, 0.0);
        assert!((mode.transient() / (1.0 + rate * lag_s) - 1.0).abs() < 0.03, "{}", mode.transient());
        let learns = Hold { delay_s: 0.0, cut_off_rad_s: Some(1.0 / lag_s) };
        let [alone, learning] = [0.4, 0.6].map(|sigma| learns.swing_at(period_s, 0.4 * 2.0 / period_s, sigma));
        assert!(learning.forced > alone.forced && learning.started > alone.started, "{alone:?} {learning:?}");
        // Held for a period and a period late, a command is a period and a half old on the mean.
        let mode = Hold { delay_s: 0.01, cut_off_rad_s: None }.mode(0.01, 0.05, 0.0);
        let old = 0.05 * 1.5;
        let closed = libm::cos(old) / (1.0 - libm::sin(old));
        assert!((mode.transient() / closed - 1.0).abs() < 0.03, "{} {closed}", mode.transient());
    }

    /// Whatever acts, the power of a run is within what is said of it.
    #[test]
    fn prop_no_disturbance_drives_a_mode_beyond_its_resonance() {
        let holds = [(0.3, None), (1.0, None), (0.0, Some(15.0)), (0.9, Some(100.0)), (0.5, Some(3.0))];
        for (late, cut_off_rad_s) in holds {
            let hold = Hold { delay_s: 0.01 * late, cut_off_rad_s };
            for (share, learns) in [(0.3, 0.0), (0.6, 0.1), (0.8, 0.0), (0.2, 0.3)] {
                let k = share * hold.largest_gain(0.01);
                let p = learns * k / (0.5 + hold.lag(0.01));
                let most = hold.swing(0.01, k, p).forced;
                let mode = hold.mode(0.01, k, p);
                for period in [2.0_f64, 3.0, 7.0, 12.0, 20.0, 33.0, 51.0, 90.0, 200.0] {
                    let (mut state, mut driven, mut followed) = ([0.0; 4], 0.0, 0.0);
                    for sample in 0..40_000 {
                        let push = libm::cos(core::f64::consts::TAU * f64::from(sample) / period);
                        let mut next = mode.next(state);
                        next[0] += k * push;
                        next[1] += if cut_off_rad_s.is_some() { 0.5 * mode.quick * k * push } else { k * push };
                        next[2] = state[2] - p * next[1];
                        state = next;
                        (driven, followed) = (driven + push * push, followed + state[0] * state[0]);
                    }
                    if followed.is_finite() && mode.next(state)[0].abs() < 1e6 {
                        assert!(followed <= 1.01 * most * driven, "{late} {cut_off_rad_s:?} {share} {learns} {period}");
                    }
                }
            }
        }
    }

    #[test]
    fn prop_slower_modes_swing_less() {
        for (late, cut_off_rad_s) in [(0.3, None), (1.0, None), (0.0, Some(15.0)), (0.9, Some(100.0)), (0.5, Some(3.0))]
        {
            let hold = Hold { delay_s: 0.01 * late, cut_off_rad_s };
            for (share, learns) in [(0.1, 0.0), (0.5, 0.0), (0.9, 0.0), (0.1, 0.5), (0.4, 0.4)] {
                let k = share * hold.largest_gain(0.01);
                let p = learns * k / (0.5 + hold.lag(0.01));
                let halved = |times: i32| hold.swing(0.01, libm::ldexp(k, -times), libm::ldexp(p, -times));
                for times in 0..6 {
                    let (fast, slow) = (halved(times), halved(times + 1));
                    let is_less = |slow: f64, fast: f64| slow <= 1.001 * fast;
                    let all = is_less(slow.forced, fast.forced) && is_less(slow.started, fast.started);
                    assert!(
                        all && is_less(slow.noise, fast.noise),
                        "{late} {cut_off_rad_s:?} {share} {learns}: {slow:?} {fast:?}"
                    );
                }
            }
        }
    }

    /// Of independent errors of positions, and of velocities that act late, against a long run of them.
    #[test]
    fn eq_noise_makes_of_a_mode_what_a_long_run_has() {
        for (late, cut_off_rad_s) in [(0.0, Some(5.0)), (0.6, Some(40.0)), (1.0, None), (0.4, None)] {
            let hold = Hold { delay_s: 0.01 * late, cut_off_rad_s };
            for (share, learns) in [(0.5, 0.0), (0.3, 0.2)] {
                let k = share * hold.largest_gain(0.01);
                let mode = hold.mode(0.01, k, learns * k / (0.5 + hold.lag(0.01)));
                let (mut state, mut before, mut sum, mut seed) = ([0.0; 4], 0.0, 0.0, 1_u64);
                let samples = 400_000;
                let mut errors = 0.0;
                for _ in 0..samples {
                    seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    let error = (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
                    state = mode.next(state);
                    let seen = if mode.is_filtered { mode.quick * (error - before) } else { error };
                    // A filter remembers its error, a sensor does not.
                    let mut next = state;
                    next[1] += seen;
                    next[2] -= mode.p * seen;
                    (before, state) = (error, next);
                    (sum, errors) = (sum + state[0] * state[0], errors + error * error);
                }
                let quick = mode.quick;
                let square = if mode.is_filtered { 2.0 * quick * quick / (2.0 - quick) } else { 1.0 };
                let found = sum / (errors * square);
                let said = mode.noise();
                assert!((said / found - 1.0).abs() < 0.05, "{said} {found} {late} {cut_off_rad_s:?} {share} {learns}");
            }
        }
    }
}
