//! The left null vector by iteration, enclosed component by component.
//!
//! uᵀL = 0 with L = D − W on a strongly connected graph. A vertex ℓ is kept at û_ℓ; A is L without its row and column,
//! and bᵀ = û_ℓ (w_ℓj). Then uᵀA = bᵀ has a positive solution with u_ℓ = û_ℓ. A has no positive entry off its diagonal.
//!
//! **Enclosure.** Let ρᵀ = ûᵀA − bᵀ, and let t > 0 have tᵀA > 0 in all components. Then A is a nonsingular M-matrix, so A⁻¹ ≥ 0, and if
//! |ρ| ≤ ε (tᵀA) component by component,
//!
//! ```text
//! |û − u|ᵀ = |ρᵀA⁻¹| ≤ |ρ|ᵀA⁻¹ ≤ ε tᵀAA⁻¹ = ε tᵀ.
//! ```
//!
//! How û and t were found plays no part: both inequalities are verified, with bounds on the rounding of what is compared.
//!
//! **A good t.** tᵀA = (û_j S_j) makes tⱼ/ûⱼ the mean number of steps, backwards along the chain, until ℓ is met. To iterate for t would take as many
//! sweeps. But t = x − (x_ℓ/û_ℓ) û for any solution of xᵀL = fᵀ with f_j = û_j S_j, and f_ℓ such that Σf = 0: that iteration is as fast as
//! that for û.

/// Entries that may be visited.
const MOST_VISITS: f64 = 1e9;
/// A sweep goes so far towards the values it finds; at 1 a cycle could go round for ever.
const SHARE: f64 = 0.95;
/// What tᵀA must be at least, of what it should be.
const GOOD: f64 = 0.25;
/// Sweeps between two looks.
const SWEEPS: usize = 10;

/// A graph by receivers' columns: whom a vertex is heard by.
pub(super) struct Block {
    /// S_i.
    out: Vec<f64>,
    /// For each vertex j where its senders to the sum Σᵢ uᵢ w_ij begin.
    first: Vec<usize>,
    into: Vec<(u32, f64)>,
}

/// An approximate left null vector.
pub(super) struct Enclosed {
    pub(super) u: Vec<f64>,
    /// |ûᵢ − uᵢ| ≤ error · ûᵢ, for one u; infinite where nothing was shown.
    pub(super) error: f64,
}

impl Block {
    /// Of the weights `(i, j, w_ij)` and their row sums S_i.
    pub(super) fn new(out: Vec<f64>, edges: &[(usize, usize, f64)]) -> Block {
        let n = out.len();
        let mut first = vec![0; n + 1];
        for (_, j, _) in edges {
            first[j + 1] += 1;
        }
        for j in 0..n {
            first[j + 1] += first[j];
        }
        let (mut next, mut into) = (first.clone(), vec![(0, 0.0); edges.len()]);
        for (i, j, weight) in edges {
            into[next[*j]] = (*i as u32, *weight);
            next[*j] += 1;
        }
        Block { out, first, into }
    }

    fn sources(&self, j: usize) -> &[(u32, f64)] {
        &self.into[self.first[j]..self.first[j + 1]]
    }

    /// One step of x_j ← (f_j + Σᵢ xᵢ w_ij)/S_j for every j, there and back; the largest change beside `scale`.
    fn sweep(&self, x: &mut [f64], f: &[f64], scale: impl Fn(usize, f64) -> f64) -> f64 {
        let n = x.len();
        let mut largest: f64 = 0.0;
        for j in (0..n).chain((0..n).rev()) {
            let inflow: f64 = self.sources(j).iter().map(|(i, weight)| x[*i as usize] * weight).sum();
            let change = SHARE * ((f[j] + inflow) / self.out[j] - x[j]);
            x[j] += change;
            largest = largest.max(change.abs() / scale(j, x[j]));
        }
        largest
    }

    /// Iterates, and encloses what is found.
    pub(super) fn solve(&self) -> Enclosed {
        let n = self.out.len();
        let mut visits = MOST_VISITS;
        let per_sweep = 2.0 * (self.into.len() + n) as f64;
        let mut u: Vec<f64> = self.out.iter().map(|out| 1.0 / out).collect();
        let zero = vec![0.0; n];
        let mut before = f64::INFINITY;
        while visits > 0.5 * MOST_VISITS {
            let change = (0..SWEEPS).map(|_| self.sweep(&mut u, &zero, |_, x| x)).fold(0.0, |_, last| last);
            visits -= per_sweep * SWEEPS as f64;
            // Rounding keeps it from becoming smaller for ever.
            if change < 1e-13 && change >= 0.5 * before {
                break;
            }
            before = change;
        }
        let mass = |j: &usize| u[*j] * self.out[*j];
        let kept = (0..n).max_by(|a, b| mass(a).total_cmp(&mass(b))).unwrap_or(0);
        let mut f: Vec<f64> = (0..n).map(|j| mass(&j)).collect();
        f[kept] -= f.iter().sum::<f64>();
        let mut x = vec![0.0; n];
        let mut error = f64::INFINITY;
        while visits > 0.0 && error.is_infinite() {
            for _ in 0..SWEEPS {
                self.sweep(&mut x, &f, |_, _| 1.0);
            }
            visits -= per_sweep * SWEEPS as f64;
            error = self.enclose(&u, &x, kept);
        }
        Enclosed { u, error }
    }

    /// ε · max tⱼ/ûⱼ with t from x, or infinity where the inequalities are not verified.
    fn enclose(&self, u: &[f64], x: &[f64], kept: usize) -> f64 {
        let factor = x[kept] / u[kept];
        let t = |j: usize| if j == kept { 0.0 } else { x[j] - factor * u[j] };
        let t: Vec<f64> = (0..u.len()).map(t).collect();
        let (mut epsilon, mut slowest): (f64, f64) = (0.0, 0.0);
        for j in (0..u.len()).filter(|j| *j != kept) {
            // S_j and sums of so many products, each rounded.
            let rounding = (self.sources(j).len() + 24) as f64 * f64::EPSILON;
            let flow = |x: &[f64]| self.sources(j).iter().map(|(i, weight)| x[*i as usize] * weight).sum::<f64>();
            let (holds, inflow) = (t[j] * self.out[j], flow(&t));
            let margin = holds - inflow - rounding * (holds + inflow);
            let sound = t[j] > 0.0 && margin >= GOOD * u[j] * self.out[j];
            if !sound {
                return f64::INFINITY;
            }
            let (holds, inflow) = (u[j] * self.out[j], flow(u));
            let residual = (holds - inflow).abs() + rounding * (holds + inflow);
            epsilon = epsilon.max(residual / margin);
            slowest = slowest.max(t[j] / u[j]);
        }
        epsilon * slowest * (1.0 + 8.0 * f64::EPSILON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pairs that hear each other faintly: what one pair has too much leaves hardly any residual.
    #[test]
    fn an_error_that_leaves_a_small_residual_is_enclosed_all_the_same() {
        let (faint, excess) = (1e-3, 1e-3);
        let edges = [(0, 1, 1.0), (1, 0, 1.0), (2, 3, 1.0), (3, 2, 1.0), (1, 2, faint), (2, 1, faint)];
        let block = Block::new(vec![1.0, 1.0 + faint, 1.0 + faint, 1.0], &edges);
        // Weights are mutual, so that the null vector is constant.
        let u = [1.0, 1.0, 1.0 + excess, 1.0 + excess];
        let kept = 0;
        let mut f: Vec<f64> = u.iter().zip(&block.out).map(|(u, out)| u * out).collect();
        f[kept] -= f.iter().sum::<f64>();
        let mut x = vec![0.0; 4];
        for _ in 0..20_000 {
            block.sweep(&mut x, &f, |_, _| 1.0);
        }
        let error = block.enclose(&u, &x, kept);
        let truth = excess / (1.0 + excess);
        assert!((truth..30.0 * truth).contains(&error), "{error}");
        // Where the inequalities cannot be verified nothing is claimed.
        assert_eq!(block.enclose(&u, &[0.0; 4], kept), f64::INFINITY);
    }

    /// Weights that are mutual have a constant null vector; what a pair has too much goes by a thousandth a sweep.
    #[test]
    fn sweeping_ends_when_nothing_but_rounding_changes() {
        for faint in [1e-3, 1.0] {
            let edges = [(0, 1, 1.0), (1, 0, 1.0), (2, 3, 3.0), (3, 2, 3.0), (1, 2, faint), (2, 1, faint)];
            let Enclosed { u, error } = Block::new(vec![1.0, 1.0 + faint, 3.0 + faint, 3.0], &edges).solve();
            let [least, most] = [f64::min, f64::max].map(|of| u.iter().copied().reduce(of).unwrap_or(f64::NAN));
            assert!(most - least <= 2.0 * error * most && error < 1e-7, "{u:?} ± {error}");
            assert!(most - least < 1e-9 * most, "{u:?}");
        }
        // One that hears itself through another alone is right at once, and stays.
        let Enclosed { u, error } = Block::new(vec![1.0, 1.0], &[(0, 1, 1.0), (1, 0, 1.0)]).solve();
        assert!(u[0] == u[1] && error < 1e-13, "{u:?} ± {error}");
    }

    #[test]
    fn what_is_enclosed_is_exact_to_the_roundings_that_are_counted() {
        // u is (1, 1), one edge each way: t = (0, 1) has a margin of 1 less 25 roundings, and the residual is 25 roundings of 2.
        let block = Block::new(vec![1.0, 1.0], &[(0, 1, 1.0), (1, 0, 1.0)]);
        let rounding = 25.0 * f64::EPSILON;
        let error = block.enclose(&[1.0, 1.0], &[0.0, 1.0], 0);
        assert!((error / (2.0 * rounding) - 1.0).abs() < 1e-12, "{error}");
        // A margin of a quarter of what it should be is enough, one of less by rounding is not, nor is an entry of t that is not positive.
        let of = |t: f64| block.enclose(&[1.0, 1.0], &[0.0, t], 0);
        assert!([0.26, 0.25, 0.0, -1.0].map(of).map(f64::is_finite) == [true, false, false, false]);
        // Twice as slow is twice as far; what x has of û does not count.
        assert!(
            (of(2.0) / error - 1.0).abs() < 1e-12
                && (block.enclose(&[1.0, 1.0], &[3.0, 4.0], 0) / error - 1.0).abs() < 1e-12
        );
        // An excess of a tenth is a residual of a tenth, by a margin of one.
        let excess = block.enclose(&[1.0, 1.1], &[0.0, 1.1], 0);
        assert!((excess - 0.1 / 1.1).abs() < 1e-12, "{excess}");
    }
}
