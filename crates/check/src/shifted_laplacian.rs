//! Whether the smallest eigenvalue of a symmetric Laplacian, with edges from a leader, exceeds a number.
//!
//! A = L − σ 1 has no positive entry off its diagonal. Where some v > 0 has A v > 0 in all components, A is a nonsingular M-matrix, and being
//! symmetric it is positive definite; where it is positive definite, v = A⁻¹1 is such a vector. v is looked for by conjugate
//! gradients, in any precision; A v > 0 is verified with a bound on rounding.

/// A, row by row.
pub(crate) struct ShiftedLaplacian {
    /// Degrees, and how many terms they are sums of.
    degree: Vec<(f64, usize)>,
    first: Vec<usize>,
    heard: Vec<(u32, f64)>,
    shift: f64,
}

/// Entries that may be visited.
const MOST_VISITS: usize = 1_000_000_000;

impl ShiftedLaplacian {
    /// Of edges (to, from, weight) among followers; `from` is `None` for the leader. `None` unless all among followers lead both ways with the same
    /// weight.
    pub(crate) fn new(followers: usize, edges: &[(usize, Option<usize>, f64)], shift: f64) -> Option<Self> {
        let mut degree = vec![(0.0, 0); followers];
        let mut among = Vec::with_capacity(edges.len());
        for &(to, from, weight) in edges {
            degree[to].0 += weight;
            degree[to].1 += 1;
            among.extend(from.map(|from| (to, from, weight)));
        }
        among.sort_unstable_by_key(|&(to, from, _)| (to, from));
        let mut back: Vec<_> = among.iter().map(|&(to, from, weight)| (from, to, weight)).collect();
        back.sort_unstable_by_key(|&(to, from, _)| (to, from));
        if back != among {
            return None;
        }
        let mut first = vec![0; followers + 1];
        for (to, ..) in &among {
            first[to + 1] += 1;
        }
        for row in 0..followers {
            first[row + 1] += first[row];
        }
        let heard = among.into_iter().map(|(_, from, weight)| (from as u32, weight)).collect();
        Some(ShiftedLaplacian { degree, first, heard, shift })
    }

    fn row(&self, i: usize) -> &[(u32, f64)] {
        &self.heard[self.first[i]..self.first[i + 1]]
    }

    /// Σⱼ w_ij v_j over followers.
    fn inflow(&self, i: usize, v: &[f64]) -> f64 {
        self.row(i).iter().map(|(j, weight)| weight * v[*j as usize]).sum()
    }

    fn times(&self, v: &[f64]) -> Vec<f64> {
        (0..v.len()).map(|i| (self.degree[i].0 - self.shift) * v[i] - self.inflow(i, v)).collect()
    }

    /// Whether v > 0 and A v > 0, whatever was rounded.
    fn shows(&self, v: &[f64]) -> bool {
        (0..v.len()).all(|i| {
            let (degree, terms) = self.degree[i];
            let rounding = (terms + 6) as f64 * f64::EPSILON;
            let (own, inflow) = (degree * v[i], self.inflow(i, v));
            let lost = self.shift * v[i] + inflow;
            v[i] > 0.0 && own - lost > rounding * (own + lost)
        })
    }

    /// Whether it was shown to be positive definite.
    pub(crate) fn is_shown_definite(&self) -> bool {
        let n = self.degree.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (mut v, mut r) = (vec![0.0; n], vec![1.0; n]);
        let mut p = r.clone();
        let mut size = dot(&r, &r);
        let most = MOST_VISITS / (self.heard.len() + n).max(1);
        for _ in 0..most {
            let q = self.times(&p);
            let curvature = dot(&p, &q);
            // A direction in which it is not positive.
            if !(curvature > 0.0 && size > 0.0) {
                break;
            }
            let step = size / curvature;
            for i in 0..n {
                v[i] += step * p[i];
                r[i] -= step * q[i];
            }
            // Near a solution of A v = 1 all of A v is positive.
            if r.iter().all(|r| r.abs() < 0.5) && self.shows(&v) {
                return true;
            }
            let before = std::mem::replace(&mut size, dot(&r, &r));
            for i in 0..n {
                p[i] = r[i] + size / before * p[i];
            }
        }
        n == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A path whose first hears the leader.
    fn path(n: usize) -> Vec<(usize, Option<usize>, f64)> {
        let both = (1..n).flat_map(|k| [(k, Some(k - 1), 2.0), (k - 1, Some(k), 2.0)]);
        [(0, None, 2.0)].into_iter().chain(both).collect()
    }

    #[test]
    fn prop_eigenvalues_of_paths_are_met_from_both_sides() {
        for n in [1_usize, 2, 5, 40, 300] {
            // With a fixed end and a free one: 4 w sin²(π/(4 n + 2)).
            let least = 8.0 * (std::f64::consts::PI / (4 * n + 2) as f64).sin().powi(2);
            let shown = |shift| ShiftedLaplacian::new(n, &path(n), shift).unwrap().is_shown_definite();
            assert!(shown(0.999_999 * least) && shown(0.0), "{n}");
            assert!(!shown(1.000_001 * least) && !shown(10.0), "{n}");
        }
    }

    #[test]
    fn what_is_singular_or_one_way_is_not_shown() {
        // No agent hears the leader.
        let alone = [(0, Some(1), 1.0), (1, Some(0), 1.0)];
        assert!(!ShiftedLaplacian::new(2, &alone, 0.0).unwrap().is_shown_definite());
        assert!(ShiftedLaplacian::new(2, &[(0, None, 1.0), (1, Some(0), 1.0)], 0.0).is_none());
        let unequal = [(0, None, 1.0), (0, Some(1), 1.0), (1, Some(0), 2.0)];
        assert!(ShiftedLaplacian::new(2, &unequal, 0.0).is_none());
    }

    #[test]
    fn a_vector_shows_it_where_it_is_positive_and_is_taken_to_what_is_positive_by_more_than_rounding() {
        let shows = |shift: f64, v: f64| ShiftedLaplacian::new(1, &[(0, None, 1.0)], shift).unwrap().shows(&[v]);
        assert!(shows(0.5, 1.0) && shows(1.0 - 1e-14, 1.0));
        assert!(!shows(1.0 - 1e-16, 1.0) && !shows(1.0, 1.0) && !shows(2.0, 1.0));
        // Taken to what is positive by what is negative definite.
        assert!(!shows(2.0, -1.0) && !shows(0.5, 0.0));
    }

    #[test]
    fn a_hundred_thousand_followers_are_judged() {
        let n = 100_000;
        let ring = (0..n).flat_map(|k| [(k, Some((k + 1) % n), 1.0), ((k + 1) % n, Some(k), 1.0)]);
        let heard = (0..n).step_by(5).map(|k| (k, None, 3.0));
        let edges: Vec<_> = ring.chain(heard).collect();
        assert!(ShiftedLaplacian::new(n, &edges, 0.05).unwrap().is_shown_definite());
        assert!(!ShiftedLaplacian::new(n, &edges, 3.0).unwrap().is_shown_definite());
    }
}
