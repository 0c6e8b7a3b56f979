//! The smoothest curve through points of a table, at rest before the first and after the last.
//!
//! Of all curves through the points that start and end at rest the spline of degree five makes ∫ (d³q/dt³)² dt least. It is
//! four times continuously differentiable between its ends. There its velocity and acceleration are zero, so that it joins
//! the constants outside with two continuous derivatives and a bounded third one, which jumps: what (119) asks of a leader.
//!
//! On a piece of length h, in σ = (t − tᵢ)/h, the five coefficients that are free follow from values, velocities and
//! accelerations at both ends (a Hermite interpolant), and ∫ (d³q)² is a quadratic form in them. Its minimum over the
//! velocities and accelerations at inner points is a block tridiagonal system with positive definite 2 × 2 blocks, solved by
//! elimination without pivots. Setting the gradient to zero is the same as asking for continuous third and fourth derivatives.

use forwardstep_core::controller::Jet;
use thiserror::Error;

use super::ROUNDING;
use forwardstep_core::expression::Interval;

/// Coefficients of a polynomial of degree five, lowest first.
type Quintic = [f64; 6];

/// Times must be as far apart as this part of what is usual.
const NEAREST: f64 = 1e-6;

/// Halvings of a piece in the search for its bounds.
const HALVINGS: u32 = 40;

/// A curve through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    t_s: Vec<f64>,
    values: Vec<f64>,
    /// In powers of t − tᵢ, for every piece.
    pieces: Vec<Quintic>,
}

/// Why points make no curve.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SplineError {
    /// There are no points.
    #[error("a table of points needs at least one row")]
    Empty,
    /// As many times as values are needed.
    #[error("there are {times} times, but {values} values")]
    Lengths {
        /// Times given.
        times: usize,
        /// Values given.
        values: usize,
    },
    /// A number that is not finite.
    #[error("row {row} of the points has {value}, which is not a finite number")]
    NotFinite {
        /// From one.
        row: usize,
        /// The number.
        value: f64,
    },
    /// Times must rise.
    #[error("row {row} of the points is at {t_s} s, not after the row before it at {before_s} s")]
    Order {
        /// From one.
        row: usize,
        /// Its time, s.
        t_s: f64,
        /// The time before it, s.
        before_s: f64,
    },
    /// Points so close or so far that the curve has no finite coefficients.
    #[error("the points around row {row} are too close in time, or too far apart in value, for a smooth curve")]
    TooSteep {
        /// From one.
        row: usize,
    },
}

impl Spline {
    /// How many derivatives it has: the fourth has corners at the points, where the fifth jumps.
    pub const DERIVATIVES: usize = 4;

    /// The derivative that jumps at the first and the last point, where it joins rest; beyond it none is bounded there.
    pub const JUMPS: usize = 3;

    /// The curve through (`t_s`, `values`).
    ///
    /// # Errors
    /// [`SplineError`] when there are no points, times do not rise, or a number is not finite.
    pub fn new(t_s: Vec<f64>, values: Vec<f64>) -> Result<Self, SplineError> {
        if t_s.len() != values.len() {
            return Err(SplineError::Lengths { times: t_s.len(), values: values.len() });
        }
        if t_s.is_empty() {
            return Err(SplineError::Empty);
        }
        for (row, (t, value)) in t_s.iter().zip(&values).enumerate() {
            if let Some(value) = [t, value].into_iter().find(|value| !value.is_finite()) {
                return Err(SplineError::NotFinite { row: row + 1, value: *value });
            }
        }
        for (row, pair) in t_s.windows(2).enumerate() {
            if pair[1] <= pair[0] {
                return Err(SplineError::Order { row: row + 2, t_s: pair[1], before_s: pair[0] });
            }
        }
        // Two rows that are one, written twice, would ask for a motion within a billionth of a second, which no run ever gets past.
        let usual_s = (t_s[t_s.len() - 1] - t_s[0]) / (t_s.len() - 1).max(1) as f64;
        if let Some(row) = t_s.windows(2).position(|pair| pair[1] - pair[0] < NEAREST * usual_s) {
            return Err(SplineError::TooSteep { row: row + 1 });
        }
        let slopes = slopes(&t_s, &values);
        let mut pieces = Vec::with_capacity(t_s.len());
        for (i, (t, q)) in t_s.windows(2).zip(values.windows(2)).enumerate() {
            let piece = hermite(t[1] - t[0], [q[0], q[1]], slopes[i], slopes[i + 1]);
            if piece.iter().any(|c| !c.is_finite()) {
                return Err(SplineError::TooSteep { row: i + 1 });
            }
            pieces.push(piece);
        }
        Ok(Spline { t_s, values, pieces })
    }

    /// The first and the last time, s.
    pub fn ends_s(&self) -> [f64; 2] {
        [self.t_s.first(), self.t_s.last()].map(|end| end.copied().unwrap_or(0.0))
    }

    /// Whether it never leaves its first point.
    pub fn is_still(&self) -> bool {
        self.pieces.iter().all(|piece| piece[1..].iter().all(|coefficient| *coefficient == 0.0))
    }

    /// The times of the points, s.
    pub fn times_s(&self) -> &[f64] {
        &self.t_s
    }

    /// The values at the points.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Value and four derivatives; at an end from the right.
    pub fn jet(&self, t_s: f64) -> Jet {
        let after = self.t_s.partition_point(|knot| *knot <= t_s);
        let held = |value: Option<&f64>| [value.copied().unwrap_or(0.0), 0.0, 0.0, 0.0, 0.0];
        if t_s.is_nan() {
            return [f64::NAN; 5];
        }
        match after.checked_sub(1) {
            None => held(self.values.first()),
            Some(i) => match (self.pieces.get(i), self.t_s.get(i)) {
                (Some(piece), Some(from_s)) => evaluate(piece, t_s - from_s),
                _ => held(self.values.last()),
            },
        }
    }

    /// What the value and four derivatives keep within while time does within `t_s`, by one set of Bernstein coefficients for every
    /// piece that it meets. At a point both sides count.
    pub fn enclose_jet(&self, t_s: Interval) -> [Interval; 5] {
        let mut hulls: [Option<Interval>; 5] = [None; 5];
        let mut take = |k: usize, found: Interval| hulls[k] = Some(hulls[k].map_or(found, |hull| hull.hull(found)));
        let [first_s, last_s] = self.ends_s();
        let held = [(t_s.low <= first_s, self.values.first()), (t_s.high >= last_s, self.values.last())];
        for value in held.into_iter().filter(|(meets, _)| *meets).filter_map(|(_, value)| value) {
            (0..5).for_each(|k| take(k, Interval::point(if k == 0 { *value } else { 0.0 })));
        }
        let met = self.t_s.windows(2).zip(&self.pieces).filter(|(t, _)| t[0] <= t_s.high && t_s.low <= t[1]);
        for (t, piece) in met {
            let (from, to) = ((t_s.low - t[0]).max(0.0), t_s.high.min(t[1]) - t[0]);
            for k in 0..5 {
                let mut weights = [0.0; 5];
                weights[k] = 1.0;
                let b = bernstein(&combined(piece, &weights), from, to);
                let (low, high) = b.iter().fold((b[0], b[0]), |(low, high), b| (low.min(*b), high.max(*b)));
                take(k, Interval { low, high }.with_room(ROUNDING * low.abs().max(high.abs())));
            }
        }
        hulls.map(|hull| hull.unwrap_or(Interval::WHOLE))
    }

    /// See [`super::Path::bounds`].
    pub fn bounds(&self, weights: &[f64], end_s: Option<f64>) -> Interval {
        let end_s = end_s.unwrap_or(f64::INFINITY);
        let [first_s, last_s] = self.ends_s();
        let mut hull = Hull::new();
        let value = weights.first().copied().unwrap_or(0.0);
        if let (Some(first), Some(last)) = (self.values.first(), self.values.last()) {
            if first_s > 0.0 || end_s <= first_s {
                hull.take(value * first);
            }
            if end_s >= last_s {
                hull.take(value * last);
            }
        }
        let inside = || self.t_s.windows(2).zip(&self.pieces).filter(|(t, _)| t[1] > 0.0 && t[0] <= end_s);
        let cut = |t: &[f64], piece: &Quintic| {
            let (from, to) = ((-t[0]).max(0.0), (end_s - t[0]).min(t[1] - t[0]));
            bernstein(&combined(piece, weights), from, to)
        };
        // All ends first: the more values are known, the less has to be cut.
        for (t, piece) in inside() {
            let b = cut(t, piece);
            hull.take(b[0]);
            hull.take(b[5]);
        }
        for (t, piece) in inside() {
            hull.cover(cut(t, piece), HALVINGS);
        }
        let size = hull.low.abs().max(hull.high.abs());
        Interval { low: hull.low, high: hull.high }.with_room(ROUNDING * size + 2.0 * hull.open)
    }
}

/// Values that are taken, and how far beyond them the curve might still go.
struct Hull {
    low: f64,
    high: f64,
    open: f64,
}

impl Hull {
    fn new() -> Self {
        Hull { low: f64::INFINITY, high: f64::NEG_INFINITY, open: 0.0 }
    }

    fn take(&mut self, value: f64) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    /// A polynomial keeps within the smallest and the largest of its Bernstein coefficients; it is halved while they say too
    /// little.
    fn cover(&mut self, b: Quintic, halvings: u32) {
        self.take(b[0]);
        self.take(b[5]);
        let (low, high) = b.iter().fold((b[0], b[0]), |(low, high), b| (low.min(*b), high.max(*b)));
        let beyond = (high - self.high).max(self.low - low).max(0.0);
        if beyond <= super::CLOSE * 0.1 * (self.high - self.low) || halvings == 0 {
            self.open = self.open.max(beyond);
            return;
        }
        let (left, right) = halved(&b);
        self.cover(left, halvings - 1);
        self.cover(right, halvings - 1);
    }
}

/// Velocity and acceleration at every point.
fn slopes(t_s: &[f64], values: &[f64]) -> Vec<[f64; 2]> {
    let n = t_s.len();
    let mut slopes = vec![[0.0; 2]; n];
    if n < 3 {
        return slopes;
    }
    // Gradient and Hessian of the energy with respect to what is free at inner points, gathered piece by piece.
    let mut diagonal = vec![[[0.0; 2]; 2]; n];
    let mut above = vec![[[0.0; 2]; 2]; n];
    let mut right = vec![[0.0; 2]; n];
    let energy = energy();
    for i in 0..n - 1 {
        let h = t_s[i + 1] - t_s[i];
        // (h v, h² a) per end; the energy of a piece is h⁻⁵ times that of the unit piece.
        let scale = [h, h * h];
        let density = 1.0 / (h * h * h * h * h);
        let rise = values[i + 1] - values[i];
        for a in 0..2 {
            right[i][a] -= density * scale[a] * energy[1 + a][0] * rise;
            right[i + 1][a] -= density * scale[a] * energy[3 + a][0] * rise;
            for b in 0..2 {
                let weight = density * scale[a] * scale[b];
                diagonal[i][a][b] += weight * energy[1 + a][1 + b];
                diagonal[i + 1][a][b] += weight * energy[3 + a][3 + b];
                above[i][a][b] = weight * energy[1 + a][3 + b];
            }
        }
    }
    // Forward elimination over the inner points, then back.
    for i in 1..n - 1 {
        if i > 1 {
            let factor = transposed_times_inverse(&above[i - 1], &diagonal[i - 1]);
            for a in 0..2 {
                for b in 0..2 {
                    diagonal[i][a][b] -= factor[a][0] * above[i - 1][0][b] + factor[a][1] * above[i - 1][1][b];
                }
                right[i][a] -= factor[a][0] * right[i - 1][0] + factor[a][1] * right[i - 1][1];
            }
        }
    }
    for i in (1..n - 1).rev() {
        let next = slopes[i + 1];
        let mut r = right[i];
        for a in 0..2 {
            r[a] -= above[i][a][0] * next[0] + above[i][a][1] * next[1];
        }
        slopes[i] = solved(&diagonal[i], r);
    }
    slopes
}

/// Uᵀ D⁻¹.
fn transposed_times_inverse(u: &[[f64; 2]; 2], d: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    // D is symmetric: row a of Uᵀ D⁻¹ solves D x = column a of U.
    [solved(d, [u[0][0], u[1][0]]), solved(d, [u[0][1], u[1][1]])]
}

/// D⁻¹ r for a positive definite D, by elimination, which is stable whatever the scales of its rows.
fn solved(d: &[[f64; 2]; 2], r: [f64; 2]) -> [f64; 2] {
    let factor = d[1][0] / d[0][0];
    let second = (r[1] - factor * r[0]) / (d[1][1] - factor * d[0][1]);
    [(r[0] - d[0][1] * second) / d[0][0], second]
}

/// c₃, c₄, c₅ of the unit piece from (rise, v₀, a₀, v₁, a₁).
const TOP: [[f64; 5]; 3] = [[10.0, -6.0, -1.5, -4.0, 0.5], [-15.0, 8.0, 1.5, 7.0, -1.0], [6.0, -3.0, -0.5, -3.0, 0.5]];

/// Half the Hessian of ∫₀¹ (6 c₃ + 24 c₄ σ + 60 c₅ σ²)² dσ in those five.
fn energy() -> [[f64; 5]; 5] {
    let size = [6.0, 24.0, 60.0];
    let mut energy = [[0.0; 5]; 5];
    for (i, row) in energy.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            for k in 0..3 {
                for l in 0..3 {
                    *entry += TOP[k][i] * size[k] * TOP[l][j] * size[l] / (k + l + 1) as f64;
                }
            }
        }
    }
    energy
}

/// The piece of length h with these values, velocities and accelerations at its ends, in powers of time.
fn hermite(h: f64, values: [f64; 2], [v0, a0]: [f64; 2], [v1, a1]: [f64; 2]) -> Quintic {
    let ends = [values[1] - values[0], h * v0, h * h * a0, h * v1, h * h * a1];
    let mut piece = [values[0], v0, 0.5 * a0, 0.0, 0.0, 0.0];
    let mut scale = h * h * h;
    for (c, row) in piece[3..].iter_mut().zip(&TOP) {
        *c = row.iter().zip(&ends).map(|(factor, end)| factor * end).sum::<f64>() / scale;
        scale *= h;
    }
    piece
}

fn evaluate(piece: &Quintic, x: f64) -> Jet {
    let mut jet = [0.0; 5];
    let mut factorial = 1.0;
    for (k, value) in jet.iter_mut().enumerate() {
        // (k-th derivative)/k! by Horner's rule, with binomial factors.
        for n in (k..6).rev() {
            let mut binomial = 1.0;
            for j in 0..k {
                binomial *= (n - j) as f64 / (j + 1) as f64;
            }
            *value = *value * x + binomial * piece[n];
        }
        factorial *= k.max(1) as f64;
        *value *= factorial;
    }
    jet
}

/// The polynomial Σₖ weights[k] · (k-th derivative).
fn combined(piece: &Quintic, weights: &[f64]) -> Quintic {
    let mut sum = [0.0; 6];
    let mut derivative = *piece;
    for weight in weights {
        for (sum, c) in sum.iter_mut().zip(&derivative) {
            *sum += weight * c;
        }
        for n in 0..6 {
            derivative[n] = if n < 5 { (n + 1) as f64 * derivative[n + 1] } else { 0.0 };
        }
    }
    sum
}

/// Bernstein coefficients on [from, to].
fn bernstein(c: &Quintic, from: f64, to: f64) -> Quintic {
    // Powers of σ = (x − from)/(to − from): Taylor's shift, then the scale.
    let mut shifted = *c;
    for k in 0..5 {
        for n in (k..5).rev() {
            shifted[n] += from * shifted[n + 1];
        }
    }
    let mut scale = 1.0;
    for value in &mut shifted {
        *value *= scale;
        scale *= to - from;
    }
    let choose = |n: usize, k: usize| (0..k).fold(1.0, |product, j| product * (n - j) as f64 / (j + 1) as f64);
    let mut b = [0.0; 6];
    for (j, b) in b.iter_mut().enumerate() {
        *b = (0..=j).map(|k| choose(j, k) / choose(5, k) * shifted[k]).sum();
    }
    b
}

/// The Bernstein coefficients of both halves, after de Casteljau.
fn halved(b: &Quintic) -> (Quintic, Quintic) {
    let (mut left, mut right, mut row) = (*b, *b, *b);
    for k in 0..6 {
        left[k] = row[0];
        right[5 - k] = row[5 - k];
        for j in 0..5 - k {
            row[j] = 0.5 * (row[j] + row[j + 1]);
        }
    }
    (left, right)
}
