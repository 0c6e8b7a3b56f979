//! Where something should be at every time: a leader's motion, a desired trajectory, an offset.
//!
//! A [`Trajectory`] has one [`Path`] per axis. Its value and its derivatives are closed forms, with the same bits on every
//! machine, and can be bounded on a horizon or for ever: Theorems 8 and 9 ask for a gain above such a bound.
//!
//! - a formula in t: derivatives by Taylor coefficients, bounds by interval arithmetic;
//! - sums of sinusoids: the bounds for ever are exact sums of amplitudes;
//! - points of a table, joined by the smoothest curve through them: bounds of polynomials, which are exact for ever. It has four
//!   derivatives, the others as many as are asked for.

mod norm;
mod pieces;
mod spline;
mod waves;

use forwardstep_core::controller::{Jet, JetsBuffer};
use forwardstep_core::expression::{Expression, Interval, KinkError, MOST_DERIVATIVES, search, weighted};
use forwardstep_core::sampled::Motion;
use forwardstep_core::sine_and_cosine;
use thiserror::Error;

use crate::formula::{Witness, times_s};

use self::waves::narrowed;
pub use norm::LeastNorm;
pub(crate) use pieces::Pieces;
pub use spline::{Spline, SplineError};

/// Bounds this close to values that are taken are close enough, as a part of the range: the fine end of what a gain is
/// compared with.
const CLOSE: f64 = 1e-6;
/// Room for the roundings of a few operations.
const ROUNDING: f64 = 1e-12;
/// So many times a bound is clearly beyond it.
const CLEARLY: f64 = 1.001;

/// amplitude · sin(rate · t + phase).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sinusoid {
    /// rad or m.
    pub amplitude: f64,
    /// ω, rad/s.
    pub rad_per_s: f64,
    /// rad.
    pub phase_rad: f64,
}

/// The motion of one axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// A formula in t, the only variable.
    Formula(Expression),
    /// A constant and sinusoids.
    Sinusoids {
        /// rad or m.
        offset: f64,
        /// What swings about it.
        waves: Vec<Sinusoid>,
    },
    /// The smoothest curve through points.
    Spline(Spline),
}

/// A motion in ℝᵐ.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    paths: Vec<Path>,
}

/// Why paths make no trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum TrajectoryError {
    /// There is no axis.
    #[error("a trajectory needs at least one axis")]
    Empty,
    /// A number that is not finite.
    #[error("axis {axis} of the trajectory has a number that is not finite: {value}")]
    NotFinite {
        /// The axis, from zero.
        axis: usize,
        /// The number.
        value: f64,
    },
    /// A formula whose kinks cannot be found.
    #[error("axis {axis} of the trajectory is a formula with kinks: {error}")]
    Kinks {
        /// The axis, from zero.
        axis: usize,
        /// Why not.
        error: KinkError,
    },
}

impl Path {
    /// How many derivatives it has.
    pub fn known_derivatives(&self) -> usize {
        match self {
            Path::Formula(_) | Path::Sinusoids { .. } => MOST_DERIVATIVES,
            Path::Spline(_) => Spline::DERIVATIVES,
        }
    }

    /// Value and four derivatives.
    pub fn jet(&self, t_s: f64) -> Jet {
        let mut jet = Jet::default();
        self.derivatives(t_s, &mut jet);
        jet
    }

    /// The value and as many derivatives as `out` has room for; not-a-number beyond those that it has.
    pub fn derivatives(&self, t_s: f64, out: &mut [f64]) {
        match self {
            Path::Formula(formula) => formula.derivatives(t_s, out),
            Path::Sinusoids { offset, waves } => {
                out.fill(0.0);
                out.iter_mut().take(1).for_each(|value| *value = *offset);
                for wave in waves {
                    let (sin, cos) = sine_and_cosine(wave.angle(t_s));
                    let mut size = wave.amplitude;
                    for (value, turn) in out.iter_mut().zip([sin, cos, -sin, -cos].into_iter().cycle()) {
                        *value += size * turn;
                        size *= wave.rad_per_s;
                    }
                }
            }
            Path::Spline(spline) => {
                out.fill(f64::NAN);
                out.iter_mut().zip(spline.jet(t_s)).for_each(|(value, known)| *value = known);
            }
        }
    }

    /// Intervals that hold the value and the first four derivatives at every time in `t_s`; everything where nothing could be shown.
    pub(crate) fn enclose_jet(&self, t_s: Interval) -> [Interval; 5] {
        match self {
            Path::Formula(formula) => formula.enclose_jet(t_s),
            Path::Spline(spline) => spline.enclose_jet(t_s),
            Path::Sinusoids { offset, waves } => std::array::from_fn(|k| {
                let size = |wave: &Sinusoid| (0..k).fold(wave.amplitude.abs(), |size, _| size * wave.rad_per_s.abs());
                let most: f64 = waves.iter().map(size).sum();
                Interval::point(if k == 0 { *offset } else { 0.0 }) + Interval { low: -most, high: most }
            }),
        }
    }

    /// Σₖ `weights[k]` · (k-th derivative).
    fn weighted(&self, weights: &[f64], t_s: f64) -> f64 {
        match self {
            Path::Formula(formula) => formula.weighted(weights, t_s),
            Path::Sinusoids { .. } | Path::Spline(_) => {
                let mut jet = vec![0.0; weights.len()];
                self.derivatives(t_s, &mut jet);
                weighted(weights, &jet)
            }
        }
    }

    /// An interval that holds Σₖ `weights[k]` · (k-th derivative) at every time from 0 to `end_s`, or for ever; unbounded
    /// where nothing could be shown.
    pub fn bounds(&self, weights: &[f64], end_s: Option<f64>) -> Interval {
        match self {
            Path::Formula(formula) => match end_s {
                Some(end_s) => formula.bounds_of_derivatives(weights, 0.0, end_s),
                None => narrowed(formula.combination_for_ever(weights).within, formula, weights),
            },
            Path::Sinusoids { offset, waves } => sinusoids(*offset, waves, weights, end_s),
            Path::Spline(spline) => spline.bounds(weights, end_s),
        }
    }
}

impl Path {
    /// From when on it is seen to stay where it is, s: a curve after its last point, and what never moves; `None` for others.
    pub fn rests_s(&self) -> Option<f64> {
        match self {
            Path::Spline(spline) => Some(spline.ends_s()[1]),
            Path::Formula(_) | Path::Sinusoids { .. } => (self.bounds(&[0.0, 1.0], None).size() == 0.0).then_some(0.0),
        }
    }

    /// When |Σₖ `weights[k]` · (k-th derivative)| is seen to reach `size`, and its value then: at the first of many times looked
    /// at, also far beyond `end_s`, at which that is certain. Of formulas it is enclosed; otherwise it exceeds what rounding
    /// does.
    fn seen_to_reach(&self, weights: &[f64], size: f64, end_s: f64) -> Option<Witness> {
        let range = Interval { low: -size, high: size };
        let value = |t_s: f64| match self {
            Path::Formula(formula) => formula.enclose_combination(weights, t_s),
            Path::Sinusoids { .. } | Path::Spline(_) => {
                let mut jet = vec![0.0; weights.len()];
                self.derivatives(t_s, &mut jet);
                let parts = weights.iter().zip(&jet).map(|(weight, c)| (weight * c).abs());
                let room = ROUNDING * parts.sum::<f64>();
                let value = weighted(weights, &jet);
                Interval { low: value - room, high: value + room }
            }
        };
        let last_s = match self {
            Path::Formula(_) => f64::INFINITY,
            // The phase of a wave is known to less than the room so long.
            Path::Sinusoids { waves, .. } => {
                waves.iter().fold(1e6, |last_s: f64, wave| last_s.min(1e3 / wave.rad_per_s.abs()))
            }
            Path::Spline(spline) => spline.ends_s()[1],
        };
        let times_s = times_s(end_s).filter(|t_s| *t_s <= last_s.max(end_s));
        // Bounds are open: what is equal to `size` reaches it.
        let reaches = |t_s: f64| {
            Witness::outside(t_s, value(t_s), range).or_else(|| {
                let point = value(t_s);
                (point.low == point.high && point.size() == size).then_some(Witness { t_s, value: point.low })
            })
        };
        // The first that says so clearly, or else one that does so by a hair.
        let mut first = None;
        for witness in times_s.into_iter().filter_map(reaches) {
            if witness.value.abs() >= CLEARLY * size {
                return Some(witness);
            }
            first.get_or_insert(witness);
        }
        first
    }

    /// Whether |Σₖ `weights[k]` · (k-th derivative)| is bounded for ever; `None` where neither is shown.
    fn is_bounded(&self, weights: &[f64]) -> Option<bool> {
        match self {
            // One look tells most.
            Path::Formula(formula) if formula.bounds_of_derivatives(weights, 0.0, f64::INFINITY).is_finite() => {
                Some(true)
            }
            Path::Formula(formula) => {
                let found = formula.combination_for_ever(weights);
                (found.within.is_finite() || found.is_unbounded()).then(|| found.within.is_finite())
            }
            Path::Sinusoids { .. } => Some(true),
            // Where it joins rest the third derivative jumps.
            Path::Spline(spline) => {
                let beyond = weights.iter().skip(Spline::JUMPS + 1).any(|weight| *weight != 0.0);
                (!beyond || spline.is_still()).then_some(true)
            }
        }
    }

    /// As a formula in t; `None` for a curve through points.
    fn formula(&self) -> Option<Expression> {
        match self {
            Path::Formula(formula) => Some(formula.clone()),
            Path::Sinusoids { offset, waves } => {
                let wave = |wave: &Sinusoid| {
                    (Expression::variable(0) * wave.rad_per_s + wave.phase_rad).sin_of() * wave.amplitude
                };
                Some(waves.iter().map(wave).fold(Expression::number(*offset), |sum, wave| sum + wave))
            }
            Path::Spline(_) => None,
        }
    }
}

impl Motion for Trajectory {
    fn axes(&self) -> usize {
        self.paths.len()
    }

    fn known_derivatives(&self) -> usize {
        self.known_derivatives()
    }

    fn derivatives(&self, axis: usize, at_s: f64, out: &mut [f64]) {
        match self.paths.get(axis) {
            Some(path) => path.derivatives(at_s, out),
            None => out.fill(f64::NAN),
        }
    }
}

impl Sinusoid {
    fn angle(&self, t_s: f64) -> f64 {
        libm::fma(self.rad_per_s, t_s, self.phase_rad)
    }
}

/// The weights that single out one derivative.
fn unit(derivative: usize) -> Vec<f64> {
    let mut weights = vec![0.0; derivative + 1];
    weights[derivative] = 1.0;
    weights
}

/// A combination of derivatives of a sinusoid is a sinusoid: Σ wₖ (d/dt)ᵏ a sin θ = p a sin θ + q a cos θ.
fn sinusoids(offset: f64, waves: &[Sinusoid], weights: &[f64], end_s: Option<f64>) -> Interval {
    let parts = |wave: &Sinusoid| {
        let w = wave.rad_per_s;
        let square = w * w;
        let horner =
            |first: usize| weights.iter().skip(first).step_by(2).rev().fold(0.0, |sum, weight| weight - square * sum);
        let (p, q) = (horner(0), w * horner(1));
        let size = wave.amplitude * libm::hypot(p, q);
        (size, wave.phase_rad + libm::atan2(q, p))
    };
    let middle = weights.first().map_or(0.0, |weight| weight * offset);
    let size: f64 = waves.iter().map(|wave| parts(wave).0.abs()).sum();
    let for_ever = Interval { low: middle - size, high: middle + size }.with_room(ROUNDING * (middle.abs() + size));
    let Some(end_s) = end_s else { return for_ever };
    let enclose = |from: f64, to: f64| {
        let mut sum = Interval { low: middle, high: middle };
        for wave in waves {
            let (size, phase) = parts(wave);
            let angle = |t_s: f64| libm::fma(wave.rad_per_s, t_s, phase);
            let (a, b) = (angle(from), angle(to));
            let swing = Interval { low: a.min(b), high: a.max(b) }.sine();
            let (a, b) = (size * swing.low, size * swing.high);
            sum = Interval { low: sum.low + a.min(b), high: sum.high + a.max(b) };
        }
        sum
    };
    let path = |t_s: f64| {
        waves.iter().fold(middle, |sum, wave| {
            let (size, phase) = parts(wave);
            sum + size * sine_and_cosine(libm::fma(wave.rad_per_s, t_s, phase)).0
        })
    };
    let part = search(0.0, end_s, CLOSE, enclose, path).with_room(ROUNDING * (middle.abs() + size));
    Interval { low: part.low.max(for_ever.low), high: part.high.min(for_ever.high) }
}

impl Trajectory {
    /// A trajectory with one path per axis.
    ///
    /// ```
    /// use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
    /// let wave = Sinusoid { amplitude: 0.5, rad_per_s: 2.0, phase_rad: 0.0 };
    /// let swing = Trajectory::new(vec![Path::Sinusoids { offset: 1.0, waves: vec![wave] }])?;
    /// let mut jets = [[0.0; 5]];
    /// swing.jets(0.0, &mut jets);
    /// assert_eq!(jets[0], [1.0, 1.0, 0.0, -4.0, 0.0]);
    /// assert!((swing.hull(0, 1, None).high - 1.0).abs() < 1e-9);
    /// # Ok::<(), forwardstep_sim::trajectory::TrajectoryError>(())
    /// ```
    ///
    /// # Errors
    /// [`TrajectoryError`] when there is no axis or a number is not finite.
    pub fn new(paths: Vec<Path>) -> Result<Self, TrajectoryError> {
        if paths.is_empty() {
            return Err(TrajectoryError::Empty);
        }
        for (axis, path) in paths.iter().enumerate() {
            if let Path::Sinusoids { offset, waves } = path {
                let all = waves.iter().flat_map(|wave| [wave.amplitude, wave.rad_per_s, wave.phase_rad]);
                if let Some(value) = all.chain([*offset]).find(|value| !value.is_finite()) {
                    return Err(TrajectoryError::NotFinite { axis, value });
                }
            }
        }
        Ok(Trajectory { paths })
    }

    /// Four axes from this one on, as the quaternion of a pose; nothing where there are fewer.
    pub fn quaternion(&self, first: usize) -> Option<Trajectory> {
        Some(Trajectory { paths: self.paths.get(first..first.checked_add(4)?)?.to_vec() })
    }

    /// m.
    pub fn axes(&self) -> usize {
        self.paths.len()
    }

    /// How many derivatives every axis has.
    pub fn known_derivatives(&self) -> usize {
        self.paths.iter().map(Path::known_derivatives).min().unwrap_or(MOST_DERIVATIVES)
    }

    /// The path of every axis.
    pub fn paths(&self) -> &[Path] {
        &self.paths
    }

    /// Value and derivatives of every axis, as far as `out` has room for them.
    pub fn jets_into(&self, t_s: f64, out: &mut JetsBuffer) {
        for (jet, path) in out.iter_mut().zip(&self.paths) {
            path.derivatives(t_s, jet);
        }
    }

    /// Value and four derivatives of every axis, as many as `out` has room for. A formula that has no value gives
    /// not-a-number; at a kink the derivatives are those of one side.
    pub fn jets(&self, t_s: f64, out: &mut [Jet]) {
        for (jet, path) in out.iter_mut().zip(&self.paths) {
            *jet = path.jet(t_s);
        }
    }

    /// An interval that holds the k-th derivative of one axis from 0 to `end_s`, or for ever; unbounded where nothing
    /// could be shown.
    pub fn hull(&self, axis: usize, derivative: usize, end_s: Option<f64>) -> Interval {
        self.bounds(axis, &unit(derivative), end_s)
    }

    /// An interval that holds Σₖ `weights[k]` · (k-th derivative) of one axis from 0 to `end_s`, or for ever; tighter than
    /// what the parts would give.
    pub fn bounds(&self, axis: usize, weights: &[f64], end_s: Option<f64>) -> Interval {
        self.paths.get(axis).map_or(Interval::WHOLE, |path| path.bounds(weights, end_s))
    }

    /// When |Σₖ `weights[k]` · (k-th derivative)| of any axis is seen to reach `size`, and its value then; also far beyond
    /// `end_s`.
    pub fn seen_to_reach(&self, weights: &[f64], size: f64, end_s: f64) -> Option<Witness> {
        self.paths.iter().find_map(|path| path.seen_to_reach(weights, size, end_s))
    }

    /// Whether the k-th derivative of an axis is bounded for ever; `None` where neither is shown.
    pub fn is_bounded(&self, axis: usize, derivative: usize) -> Option<bool> {
        self.paths.get(axis)?.is_bounded(&unit(derivative))
    }

    /// Whether Σₖ `weights[k]` · (k-th derivative) of some axis is shown to exceed every bound.
    pub fn exceeds_every_bound(&self, weights: &[f64]) -> bool {
        self.paths.iter().any(|path| path.is_bounded(weights) == Some(false))
    }

    /// When the k-th derivative of an axis is seen to be twice as large as it ever is until `end_s`, and its value then.
    pub fn seen_to_grow(&self, axis: usize, derivative: usize, end_s: f64) -> Option<Witness> {
        let (path, weights) = (self.paths.get(axis)?, unit(derivative));
        let size = path.bounds(&weights, Some(end_s)).size();
        path.seen_to_reach(&weights, 2.0 * if size.is_finite() { size.max(0.5) } else { 0.5 }, end_s)
    }

    /// The square of the norm of all axes together as a formula in t; `None` where one is a curve through points.
    pub fn squared_norm(&self) -> Option<Expression> {
        self.squared_distance(&vec![0.0; self.axes()])
    }

    /// The largest |Σₖ `weights[k]` · (k-th derivative)| of any axis at `samples` + 1 times from 0 to `end_s`: no bound, but
    /// what is left where none could be shown.
    pub fn sampled_peak(&self, weights: &[f64], end_s: f64, samples: u32) -> f64 {
        let mut peak = 0.0_f64;
        for k in 0..=samples {
            let t_s = end_s * f64::from(k) / f64::from(samples.max(1));
            for path in &self.paths {
                peak = peak.max(path.weighted(weights, t_s).abs());
            }
        }
        peak
    }
}

#[cfg(test)]
mod tests;
