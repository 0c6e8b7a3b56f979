//! Loops over columns, compiled for the widest vectors of the processor.

use forwardstep_core::{Kernel, Scalar, dispatch};

use super::tableau::{basis, slope};

/// out = x + Σ cᵢ · kᵢ, terms added in order.
pub(crate) fn combine(x: &[f64], weights: &[f64], k: &[Vec<f64>], out: &mut [f64]) {
    dispatch(Combine { x, weights, k, out });
}

struct Combine<'a> {
    x: &'a [f64],
    weights: &'a [f64],
    k: &'a [Vec<f64>],
    out: &'a mut [f64],
}

impl Kernel for Combine<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let n = self.x.len();
        match (self.weights, self.k) {
            ([w0], [k0, ..]) => terms([*w0], [k0], self.x, self.out, n),
            ([w0, w1], [k0, k1, ..]) => terms([*w0, *w1], [k0, k1], self.x, self.out, n),
            ([w0, w1, w2], [k0, k1, k2, ..]) => terms([*w0, *w1, *w2], [k0, k1, k2], self.x, self.out, n),
            ([w0, w1, w2, w3], [k0, k1, k2, k3, ..]) => {
                terms([*w0, *w1, *w2, *w3], [k0, k1, k2, k3], self.x, self.out, n)
            }
            ([w0, w1, w2, w3, w4], [k0, k1, k2, k3, k4, ..]) => {
                terms([*w0, *w1, *w2, *w3, *w4], [k0, k1, k2, k3, k4], self.x, self.out, n)
            }
            ([w0, w1, w2, w3, w4, w5], [k0, k1, k2, k3, k4, k5, ..]) => {
                terms([*w0, *w1, *w2, *w3, *w4, *w5], [k0, k1, k2, k3, k4, k5], self.x, self.out, n)
            }
            (weights, k) => {
                self.out.copy_from_slice(self.x);
                for (w, k) in weights.iter().zip(k) {
                    for (out, k) in self.out.iter_mut().zip(k) {
                        *out = w.mul_add(*k, *out);
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn terms<const N: usize>(w: [f64; N], k: [&Vec<f64>; N], x: &[f64], out: &mut [f64], n: usize) {
    let k = k.map(|column| &column[..n]);
    let (x, out) = (&x[..n], &mut out[..n]);
    for i in 0..n {
        let mut sum = x[i];
        let mut j = 0;
        while j < N {
            sum = w[j].mul_add(k[j][i], sum);
            j += 1;
        }
        out[i] = sum;
    }
}

/// The largest |h Σ eᵢ kᵢ| / (atol + rtol max(|x₀|, |x₁|)) over all states, and whether all of `x1` and that are finite.
pub(crate) fn error_norm(
    x0: &[f64],
    x1: &[f64],
    weights: &[f64; 7],
    k: &[Vec<f64>; 7],
    atol: f64,
    rtol: f64,
) -> (f64, bool) {
    dispatch(ErrorNorm { x0, x1, weights, k, atol, rtol })
}

struct ErrorNorm<'a> {
    x0: &'a [f64],
    x1: &'a [f64],
    weights: &'a [f64; 7],
    k: &'a [Vec<f64>; 7],
    atol: f64,
    rtol: f64,
}

impl Kernel for ErrorNorm<'_> {
    type Output = (f64, bool);

    #[inline(always)]
    fn run(self) -> (f64, bool) {
        let n = self.x0.len();
        let [k0, k1, k2, k3, k4, k5, k6] = self.k;
        let k = [&k0[..n], &k1[..n], &k2[..n], &k3[..n], &k4[..n], &k5[..n], &k6[..n]];
        let (x0, x1) = (&self.x0[..n], &self.x1[..n]);
        let w = self.weights;
        // The maximum drops not-a-number, so finiteness is asked apart: 0 · x is zero only for finite x.
        let (mut worst, mut defect) = (0.0_f64, 0.0_f64);
        for i in 0..n {
            let mut e = w[0] * k[0][i];
            let mut j = 1;
            while j < 7 {
                e = w[j].mul_add(k[j][i], e);
                j += 1;
            }
            let scale = self.rtol.mul_add(x0[i].abs().max(x1[i].abs()), self.atol);
            let ratio = e.abs() / scale;
            worst = if ratio > worst { ratio } else { worst };
            defect = (x1[i] + e).mul_add(0.0, defect);
        }
        (worst, defect == 0.0)
    }
}

/// The step that a piece of history describes.
#[derive(Clone, Copy)]
pub(crate) struct PieceSource<'a> {
    /// State at the start of the step.
    pub(crate) x0: &'a [f64],
    /// State at its end.
    pub(crate) x1: &'a [f64],
    /// Derivatives at the stages.
    pub(crate) k: &'a [Vec<f64>],
    /// h · dᵢ.
    pub(crate) dense: [f64; 7],
    /// Step, s.
    pub(crate) h: f64,
}

/// Writes r₁ … r₅ of the states that are sent, one column of `width` numbers per coefficient; `blocks` says which states
/// stand next to each other: (first state, first entry, how many).
pub(crate) fn make_piece(source: PieceSource<'_>, blocks: &[(usize, usize, usize)], width: usize, piece: &mut [f64]) {
    dispatch(MakePiece { source, blocks, width, piece });
}

struct MakePiece<'a> {
    source: PieceSource<'a>,
    blocks: &'a [(usize, usize, usize)],
    width: usize,
    piece: &'a mut [f64],
}

impl Kernel for MakePiece<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let MakePiece { source: PieceSource { x0, x1, k, dense, h }, blocks, width, piece } = self;
        let (r1, rest) = piece.split_at_mut(width);
        let (r2, rest) = rest.split_at_mut(width);
        let (r3, rest) = rest.split_at_mut(width);
        let (r4, r5) = rest.split_at_mut(width);
        let (Some(first), Some(last)) = (k.first(), k.last()) else { return };
        for &(state, entry, n) in blocks {
            let (x0, x1) = (&x0[state..state + n], &x1[state..state + n]);
            let (first, last) = (&first[state..state + n], &last[state..state + n]);
            let (r1, r2) = (&mut r1[entry..entry + n], &mut r2[entry..entry + n]);
            let (r3, r4, r5) = (&mut r3[entry..entry + n], &mut r4[entry..entry + n], &mut r5[entry..entry + n]);
            for i in 0..n {
                let difference = x1[i] - x0[i];
                let third = fma(h, first[i], -difference);
                r1[i] = x0[i];
                r2[i] = difference;
                r3[i] = third;
                r4[i] = fma(-h, last[i], difference - third);
                r5[i] = 0.0;
            }
            for (d, k) in dense.iter().zip(k) {
                let k = &k[state..state + n];
                if *d != 0.0 {
                    for i in 0..n {
                        r5[i] = fma(*d, k[i], r5[i]);
                    }
                }
            }
        }
    }
}

/// The largest difference between a piece and its draft, as a part of the tolerance; `width` numbers per coefficient.
pub(crate) fn piece_gap(piece: &[f64], draft: &[f64], width: usize, atol: f64, rtol: f64) -> f64 {
    dispatch(PieceGap { piece, draft, width, atol, rtol })
}

struct PieceGap<'a> {
    piece: &'a [f64],
    draft: &'a [f64],
    width: usize,
    atol: f64,
    rtol: f64,
}

impl Kernel for PieceGap<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let n = self.width;
        let [p1, p2, p3, p4, p5] = columns(self.piece, n);
        let [_, d2, d3, d4, d5] = columns(self.draft, n);
        let mut gap = 0.0_f64;
        for i in 0..n {
            // |Δr₂| + |Δr₃|/4 + 4|Δr₄|/27 + |Δr₅|/16 bounds the difference on [0, 1].
            let change = fma(0.25, (p3[i] - d3[i]).abs(), (p2[i] - d2[i]).abs());
            let change = fma(4.0 / 27.0, (p4[i] - d4[i]).abs(), change);
            let change = fma(0.0625, (p5[i] - d5[i]).abs(), change);
            let ratio = change / fma(self.rtol, p1[i].abs(), self.atol);
            // Written so that not-a-number stays.
            gap = if ratio <= gap { gap } else { ratio };
        }
        gap
    }
}

/// Continues a piece beyond its end: `draft` is the same quartic on [θ, θ + scale] of `last`.
///
/// A quartic is fixed by its value and slope at both ends and its value half-way.
pub(crate) fn continue_piece(last: &[f64], draft: &mut [f64], width: usize, theta: f64, scale: f64) {
    dispatch(ContinuePiece { last, draft, width, theta, scale });
}

struct ContinuePiece<'a> {
    last: &'a [f64],
    draft: &'a mut [f64],
    width: usize,
    theta: f64,
    scale: f64,
}

impl Kernel for ContinuePiece<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let n = self.width;
        let [p1, p2, p3, p4, p5] = columns(self.last, n);
        let (r1, rest) = self.draft.split_at_mut(n);
        let (r2, rest) = rest.split_at_mut(n);
        let (r3, rest) = rest.split_at_mut(n);
        let (r4, r5) = rest.split_at_mut(n);
        let r5 = &mut r5[..n];
        let end = self.theta + self.scale;
        let value = [basis(self.theta), basis(fma(0.5, self.scale, self.theta)), basis(end)];
        let slope = [slope(self.theta), slope(end)];
        for i in 0..n {
            let p = [p1[i], p2[i], p3[i], p4[i], p5[i]];
            let without_value = [0.0, p[1], p[2], p[3], p[4]];
            let (start, middle, end) = (evaluate(p, value[0]), evaluate(p, value[1]), evaluate(p, value[2]));
            let second = end - start;
            let third = fma(self.scale, evaluate(without_value, slope[0]), -second);
            let fourth = fma(-self.scale, evaluate(without_value, slope[1]), second - third);
            let cubic = fma(0.125, fourth, fma(0.25, third, fma(0.5, second, start)));
            r1[i] = start;
            r2[i] = second;
            r3[i] = third;
            r4[i] = fourth;
            r5[i] = 16.0 * (middle - cubic);
        }
    }
}

/// r₁ … r₅ of a piece, one column each.
#[inline(always)]
pub(crate) fn columns(piece: &[f64], n: usize) -> [&[f64]; 5] {
    let (r1, rest) = piece.split_at(n);
    let (r2, rest) = rest.split_at(n);
    let (r3, rest) = rest.split_at(n);
    let (r4, r5) = rest.split_at(n);
    [r1, r2, r3, r4, &r5[..n]]
}

/// Σ over the terms of one message entry: r₁ + b₂ r₂ + … + b₅ r₅.
#[inline(always)]
pub(crate) fn evaluate(r: [f64; 5], b: [f64; 4]) -> f64 {
    let tail = b[3].mul_add(r[4], r[0]);
    let tail = b[2].mul_add(r[3], tail);
    let tail = b[1].mul_add(r[2], tail);
    b[0].mul_add(r[1], tail)
}

#[inline(always)]
pub(crate) fn fma(a: f64, b: f64, c: f64) -> f64 {
    Scalar::mul_add(a, b, c)
}
