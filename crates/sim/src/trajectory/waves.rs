//! A formula that is a constant and sines of multiples of t, seen as such: each with one amplitude, whatever its derivatives are weighted by.
//!
//! Interval arithmetic adds the sizes of the terms of sin t + sin′ t; as one wave they come to √2. Where frequencies have no common period,
//! nothing else is tight for all time.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Intervals, Number, Unary};

use super::{Path, ROUNDING, Sinusoid, Trajectory, sinusoids};

/// Coefficients are known to this part: what sums of them are given as room covers it many times.
const EXACT: f64 = 1e-13;
/// Waves of a sum.
const MOST: usize = 64;

/// `found`, which bounds Σₖ `weights[k]` · (k-th derivative) of a formula for all time, with what it is known to keep within as a sum of waves.
pub(super) fn narrowed(found: Interval, formula: &Expression, weights: &[f64]) -> Interval {
    let Some([apart, joined]) = waves(formula) else { return found };
    let size = sinusoids(apart.offset, &apart.waves, weights, None).size();
    let by_waves = sinusoids(joined.offset, &joined.waves, weights, None).with_room(ROUNDING * size);
    let both = Interval { low: found.low.max(by_waves.low), high: found.high.min(by_waves.high) };
    // Of what is no number nothing is known by this either.
    if both.low <= both.high { both } else { found }
}

impl Trajectory {
    /// Whether its derivatives come back again and again, for ever, as closely as one likes to what they are at any time: those of waves, whose
    /// sums are almost periodic, of what has a period, and of a drift. `false` where that is not seen.
    pub fn derivatives_recur(&self) -> bool {
        self.paths().iter().all(|path| match path {
            Path::Sinusoids { .. } => true,
            Path::Formula(formula) => formula.period().is_some() || formula.fold(&mut Waves).is_some(),
            Path::Spline(_) => false,
        })
    }
}

/// A constant and waves.
struct Swing {
    offset: f64,
    waves: Vec<Sinusoid>,
}

/// The constant and the waves of a formula in t, as they stand in it, and with each frequency once.
fn waves(formula: &Expression) -> Option<[Swing; 2]> {
    let Sum { constant, slope, waves } = formula.fold(&mut Waves)?;
    if slope != Interval::point(0.0) {
        return None;
    }
    let offset = exact(constant, constant.size())?;
    let (mut apart, mut joined) = (Vec::new(), Vec::<Sinusoid>::new());
    for [amplitude, rate, phase] in waves {
        let (amplitude, rad_per_s) = (exact(amplitude, amplitude.size())?, exact(rate, rate.size())?);
        let phase_rad = exact(phase, phase.size().max(1.0))?;
        apart.push(Sinusoid { amplitude, rad_per_s, phase_rad });
        match joined.iter_mut().find(|wave| wave.rad_per_s == rad_per_s) {
            Some(wave) => {
                let along = |f: fn(f64) -> f64| wave.amplitude * f(wave.phase_rad) + amplitude * f(phase_rad);
                let (x, y) = (along(libm::cos), along(libm::sin));
                (wave.amplitude, wave.phase_rad) = (libm::hypot(x, y), libm::atan2(y, x));
            }
            None => joined.push(Sinusoid { amplitude, rad_per_s, phase_rad }),
        }
    }
    Some([apart, joined].map(|waves| Swing { offset, waves }))
}

/// The middle of what is known to be a number, but for rounding.
fn exact(within: Interval, size: f64) -> Option<f64> {
    let known = within.is_finite() && within.high - within.low <= EXACT * size;
    known.then_some(within.low + 0.5 * (within.high - within.low))
}

/// A constant, a multiple of t, and waves by amplitude, rate and phase.
#[derive(Clone, Debug)]
struct Sum {
    constant: Interval,
    slope: Interval,
    waves: Vec<[Interval; 3]>,
}

impl Sum {
    fn constant(constant: Interval) -> Sum {
        Sum { constant, slope: Interval::point(0.0), waves: Vec::new() }
    }

    fn is_constant(&self) -> bool {
        self.slope == Interval::point(0.0) && self.waves.is_empty()
    }

    fn scaled(mut self, factor: impl Fn(Interval) -> Interval) -> Sum {
        self.waves.iter_mut().for_each(|wave| wave[0] = factor(wave[0]));
        Sum { constant: factor(self.constant), slope: factor(self.slope), waves: self.waves }
    }
}

/// The algebra of such sums; nothing where a formula is none.
struct Waves;

impl Algebra for Waves {
    type Value = Option<Sum>;

    fn number(&mut self, number: &Number) -> Option<Sum> {
        Some(Sum::constant(number.within()))
    }

    fn variable(&mut self, _: usize) -> Option<Sum> {
        Some(Sum { slope: Interval::point(1.0), ..Sum::constant(Interval::point(0.0)) })
    }

    fn unary(&mut self, function: Unary, a: Option<Sum>) -> Option<Sum> {
        let a = a?;
        if a.is_constant() {
            return Some(Sum::constant(Intervals(&[]).unary(function, a.constant)));
        }
        match function {
            Unary::Negate => Some(a.scaled(|x| -x)),
            Unary::Sin | Unary::Cos if a.waves.is_empty() => {
                let quarter = Number::PI.within() * Interval::point(0.5);
                let phase = if function == Unary::Sin { a.constant } else { a.constant + quarter };
                let wave = [Interval::point(1.0), a.slope, phase];
                Some(Sum { waves: vec![wave], ..Sum::constant(Interval::point(0.0)) })
            }
            _ => None,
        }
    }

    fn binary(&mut self, function: Binary, a: Option<Sum>, b: Option<Sum>) -> Option<Sum> {
        let (a, b) = (a?, b?);
        match function {
            _ if a.is_constant() && b.is_constant() => {
                Some(Sum::constant(Intervals(&[]).binary(function, a.constant, b.constant)))
            }
            Binary::Add | Binary::Subtract => {
                let b = if function == Binary::Subtract { b.scaled(|x| -x) } else { b };
                let waves: Vec<_> = a.waves.into_iter().chain(b.waves).collect();
                (waves.len() <= MOST).then(|| Sum {
                    constant: a.constant + b.constant,
                    slope: a.slope + b.slope,
                    waves,
                })
            }
            Binary::Multiply if a.is_constant() => Some(b.scaled(|x| a.constant * x)),
            Binary::Multiply if b.is_constant() => Some(a.scaled(|x| x * b.constant)),
            Binary::Divide if b.is_constant() => Some(a.scaled(|x| x / b.constant)),
            _ => None,
        }
    }

    fn power(&mut self, a: Option<Sum>, exponent: &Number) -> Option<Sum> {
        let a = a.filter(Sum::is_constant)?;
        Some(Sum::constant(Intervals(&[]).power(a.constant, exponent)))
    }
}
