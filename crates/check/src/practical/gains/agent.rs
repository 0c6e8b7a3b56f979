//! One agent's reference on one axis, with s and what is heard as inputs.

use forwardstep_core::reference::polynomial;
use forwardstep_sim::Setup;
use forwardstep_sim::reference::PureIntegral;
use nalgebra::DMatrix;

/// ẋ = A x + b_s s + b_u u + b_b b with x = (q, z, ż, …), or (q, z, η) under (3) and (23), and u = Σ_j w_ij [a₀ q_j + a₁ q̇_j](t − T_ij).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Agent {
    /// A and b_s without neighbours, and what a unit of Σ w_ij adds to each, row by row: A, then b_s.
    own: DMatrix<f64>,
    coupled: DMatrix<f64>,
    /// Coefficients of its characteristic polynomial from p⁰ on, below the highest: without neighbours, and what a unit of Σ w_ij adds.
    characteristic: Vec<[f64; 2]>,
    /// a₀ and a₁.
    pub(super) heard: [f64; 2],
}

/// What a step does: x ← E x + f_s s + f_u u + f_b b, s, u and b held.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Step {
    /// E, row by row.
    pub(super) state: Vec<f64>,
    pub(super) error: Vec<f64>,
    pub(super) heard: Vec<f64>,
    pub(super) bias: Vec<f64>,
}

/// Entries of A times a step are no larger; they are of size one.
const MOST_ENTRY: f64 = 1e6;

impl Agent {
    /// `None` where the reference has no linear form in q, q̇ and z, ż, ….
    pub(super) fn of(setup: &Setup, index: usize) -> Option<Agent> {
        let agent = &setup.agents[index];
        let linear = setup.reference.linear(agent, setup.exchange)?;
        // What is heard counts positively.
        let heard = linear.heard.map(|a| -a);
        if setup.reference.is::<PureIntegral>() {
            let alpha = polynomial(&agent.roots_per_s).ok()?;
            let [a0, a1, ..] = alpha[..] else { return None };
            let lambda = agent.manipulability;
            // Columns q, z, η, s.
            let own = DMatrix::from_row_slice(3, 4, &[0., 1., 0., 1., -a0, -a1, 1., -a1, 0., 0., 0., lambda]);
            let coupled = DMatrix::from_row_slice(3, 4, &[0., 0., 0., 0., -a1, -1., 0., -1., -a0, 0., 0., 0.]);
            return Some(Agent { own, coupled, characteristic: vec![[0.0, a0], [a0, a1], [a1, 1.0]], heard });
        }
        let size = linear.order + 1;
        let (mut own, mut coupled) = (DMatrix::zeros(size, size + 1), DMatrix::zeros(size, size + 1));
        // q̇ = z + s, and z^(r) leads to z^(r+1).
        own[(0, size)] = 1.0;
        for r in 0..size - 1 {
            own[(r, r + 1)] = 1.0;
        }
        for (matrix, terms) in [(&mut own, &linear.own), (&mut coupled, &linear.coupled)] {
            if terms.q.len() > 2 || terms.z.len() >= size {
                return None;
            }
            if let Some(q) = terms.q.first() {
                matrix[(size - 1, 0)] += q;
            }
            if let Some(dq) = terms.q.get(1) {
                matrix[(size - 1, 1)] += dq;
                matrix[(size - 1, size)] += dq;
            }
            for (k, z) in terms.z.iter().enumerate() {
                matrix[(size - 1, k + 1)] += z;
            }
        }
        let last = (0..size).map(|k| [-own[(size - 1, k)], -coupled[(size - 1, k)]]).collect();
        Some(Agent { own, coupled, characteristic: last, heard })
    }

    /// Entries of x.
    pub(super) fn size(&self) -> usize {
        self.own.nrows()
    }

    /// The fastest rate of its own, to a factor: the largest root of a polynomial by the sizes of its coefficients, where Σ w_ij = `degree`, 1/s.
    pub(super) fn fastest_per_s(&self, degree: f64) -> f64 {
        let coefficients = self.characteristic.iter().map(|[own, coupled]| (own + degree * coupled).abs());
        let sizes = coefficients.rev().zip(1_u8..).map(|(a, k)| libm::pow(a, 1.0 / f64::from(k)));
        sizes.fold(degree, f64::max)
    }

    /// A step of `step_s` while Σ w_ij is `degree`.
    ///
    /// An error b of every measured velocity that the law does not see leads q̇ to z − b, while the reference sees z; what is heard has
    /// q̇_j + b in it, a₁ b more for every unit of weight.
    pub(super) fn step(&self, degree: f64, step_s: f64) -> Option<Step> {
        let m = self.size();
        let together = &self.own + degree * &self.coupled;
        let mut block = DMatrix::zeros(m + 3, m + 3);
        block.view_mut((0, 0), (m, m + 1)).copy_from(&together);
        block[(m - 1, m + 1)] = 1.0;
        block[(0, m + 2)] = -1.0;
        block[(m - 1, m + 2)] = self.heard[1] * degree;
        block *= step_s;
        if !block.iter().all(|entry| entry.abs() < MOST_ENTRY) {
            return None;
        }
        let step = exponential(&block);
        let column = |k: usize| (0..m).map(|r| step[(r, k)]).collect::<Vec<f64>>();
        let state = (0..m).flat_map(|r| (0..m).map(move |k| (r, k))).map(|at| step[at]).collect();
        let found = Step { state, error: column(m), heard: column(m + 1), bias: column(m + 2) };
        let all = found.state.iter().chain(&found.error).chain(&found.heard);
        all.chain(&found.bias).all(|entry| entry.is_finite()).then_some(found)
    }
}

/// e^A by the series of A/2ᵏ, which is below one half in size, squared k times.
fn exponential(a: &DMatrix<f64>) -> DMatrix<f64> {
    const TERMS: u8 = 16;
    let largest = a.row_iter().map(|row| row.iter().map(|entry| entry.abs()).sum::<f64>()).fold(0.0, f64::max);
    let halvings = libm::log2((2.0 * largest).max(1.0)).ceil() as i32;
    let small = a * libm::exp2(-f64::from(halvings));
    let one = DMatrix::identity(a.nrows(), a.ncols());
    // From the last term on: 1 + A/1 (1 + A/2 (1 + …)).
    let series = (1..=TERMS).rev().fold(one.clone(), |sum, k| &one + (&small * sum) / f64::from(k));
    (0..halvings).fold(series, |power, _| &power * &power)
}
