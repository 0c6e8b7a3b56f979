//! Where the norm of a motion is least: a quaternion of any length is an attitude unless that is zero. How far a motion is from a point.

use forwardstep_core::expression::{Expression, Interval};

use super::{Path, ROUNDING, Trajectory};
use crate::formula::{Witness, times_s};

/// Looks at a run.
const PARTS: u32 = 2000;
/// So many times as long as a run it is looked for a norm that vanishes.
const MOST_LATER: f64 = 1e3;
/// Looks at one period of a distance that is longer than the run.
const OF_PERIOD: u32 = 4000;

/// Where a motion was seen nearest to zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastNorm {
    /// When, s.
    pub t_s: f64,
    /// Its norm there.
    pub norm: f64,
    /// The larger of its norms a look earlier and a look later.
    pub beside: f64,
    /// How far apart the looks are, s.
    pub every_s: f64,
}

impl LeastNorm {
    /// Whether it passes zero here, as far as rounded numbers tell: a thousand-millionth of what it is beside. What only comes close to
    /// zero, or is small for long, has a direction all the same. It is no proof.
    pub fn vanishes(&self) -> bool {
        self.norm <= 1e-9 * self.beside
    }
}

impl Trajectory {
    /// The norm of all axes together.
    fn norm(&self, t_s: f64) -> f64 {
        let square = |path: &Path| {
            let value = path.jet(t_s)[0];
            value * value
        };
        self.paths.iter().map(square).sum::<f64>().sqrt()
    }

    /// The norm at a time and beside it.
    fn norm_around(&self, t_s: f64, every_s: f64) -> LeastNorm {
        let beside = self.norm((t_s - every_s).max(0.0)).max(self.norm(t_s + every_s));
        LeastNorm { t_s, norm: self.norm(t_s), beside, every_s }
    }

    /// Looks at the norm of all axes together, 2001 times from 0 to `end_s`, and closer where it may pass zero between two looks: the
    /// first such time is what is found, where there is one.
    pub fn least_norm(&self, end_s: f64) -> LeastNorm {
        let every_s = end_s / f64::from(PARTS);
        let looks: Vec<[f64; 2]> =
            (0..=PARTS).map(|k| end_s * f64::from(k) / f64::from(PARTS)).map(|t_s| [t_s, self.norm(t_s)]).collect();
        let smaller = |least: [f64; 2], look: &[f64; 2]| if look[1] < least[1] { *look } else { least };
        let [least_s, _] = looks.iter().fold([0.0, f64::INFINITY], smaller);
        let mut seen = self.norm_around(least_s, every_s);
        for around in looks.windows(3) {
            let [[left, before], [_, here], [right, after]] = [around[0], around[1], around[2]];
            if seen.vanishes() && seen.t_s <= right {
                break;
            }
            // It falls on no further than it fell, or than it will rise: less would be a corner.
            let reaches = here - (before - here).max(after - here);
            if here <= before && here <= after && reaches <= 0.0 {
                let closer = self.norm_around(self.least_between(left, right), every_s);
                if closer.vanishes() {
                    return closer;
                }
                seen = if closer.norm < seen.norm { closer } else { seen };
            }
        }
        seen
    }

    /// Where the norm vanishes after `end_s`, as far as it is found by looking for its minima, without proof.
    pub fn vanishes_later(&self, end_s: f64) -> Option<LeastNorm> {
        let times_s: Vec<f64> = times_s(end_s).filter(|t_s| *t_s >= end_s && *t_s <= MOST_LATER * end_s).collect();
        times_s.windows(3).find_map(|around| {
            let [left, middle, right] = [around[0], around[1], around[2]];
            if self.norm(middle) > self.norm(left) || self.norm(middle) > self.norm(right) {
                return None;
            }
            Some(self.norm_around(self.least_between(left, right), right - left)).filter(LeastNorm::vanishes)
        })
    }

    /// What the norm of all axes together never falls below where they are u sin ωt + v cos ωt with one ω, as a quaternion that turns about an
    /// axis is: |q|² = (|u|² + |v|²)/2 + (|v|² − |u|²)/2 cos 2ωt + uᵀv sin 2ωt. `None` where they are not, or where that may come to zero.
    pub fn least_turning_norm(&self) -> Option<f64> {
        let (mut rate, mut size) = (None, 0.0);
        let [mut uu, mut vv, mut uv] = [0.0; 3];
        for path in &self.paths {
            let Path::Sinusoids { offset: 0.0, waves } = path else { return None };
            let [mut u, mut v] = [0.0; 2];
            for wave in waves {
                if *rate.get_or_insert(wave.rad_per_s) != wave.rad_per_s {
                    return None;
                }
                u += wave.amplitude * libm::cos(wave.phase_rad);
                v += wave.amplitude * libm::sin(wave.phase_rad);
                size += wave.amplitude.abs();
            }
            uu += u * u;
            vv += v * v;
            uv += u * v;
        }
        let least = 0.5 * (uu + vv) - libm::hypot(0.5 * (vv - uu), uv) - ROUNDING * size * size;
        (least > 0.0).then(|| libm::sqrt(least))
    }

    /// The square of the distance of the first axes from a point, as a formula in t; `None` where one of them is a curve through points.
    pub fn squared_distance(&self, from: &[f64]) -> Option<Expression> {
        let squares = self.paths.iter().zip(from).map(|(path, from)| {
            let formula = path.formula()?;
            let seen = if *from == 0.0 { formula } else { formula + -*from };
            Some(seen.power(2.0))
        });
        squares.reduce(|sum, square| Some(sum? + square?)).flatten()
    }

    /// When the square of the distance of the first axes from a point is certainly outside of `range` after `end_s`, and that square: the
    /// first of many times looked at. They have six decimals at most, so that they can be told as they are.
    pub fn leaves_later(&self, from: &[f64], range: Interval, end_s: f64) -> Option<Witness> {
        let square = self.squared_distance(from)?;
        let period_s = square.period().filter(|period_s| *period_s > end_s);
        let of_period = period_s.into_iter().flat_map(|period_s| {
            (0..=OF_PERIOD).map(move |k| end_s + (period_s - end_s) * f64::from(k) / f64::from(OF_PERIOD))
        });
        of_period.chain(times_s(end_s)).filter(|t_s| *t_s >= end_s).map(rounded).find_map(|t_s| {
            // Decimals are no binary numbers.
            let around = Interval { low: t_s.next_down().max(0.0), high: t_s.next_up() };
            Witness::outside(t_s, square.enclose(around), range)
        })
    }

    /// Where the norm is least between two times, if it has one minimum there.
    fn least_between(&self, mut left: f64, mut right: f64) -> f64 {
        for _ in 0..100 {
            let third = (right - left) / 3.0;
            if self.norm(left + third) < self.norm(right - third) { right -= third } else { left += third }
        }
        left
    }
}

/// To six decimals, where a number has more.
fn rounded(t_s: f64) -> f64 {
    if t_s < 1e9 { (t_s * 1e6).round() / 1e6 } else { t_s }
}
