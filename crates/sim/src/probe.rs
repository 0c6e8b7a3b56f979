//! What the author of a robot, of a law or of reference dynamics says of it, tried at random states: it can be refuted, and is never shown.
//!
//! The draws are always the same, so a report can be repeated. Derivatives in time are central differences, and what is held
//! against them is a hundred times coarser than their error.

use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_core::{Kernel, Lanes, LengthError, Scalar, Vectors};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::closed_loop;
use crate::setup::{Axis, AxisUnit, RobotSetup};

pub use closed_loop::{probe_balance, probe_reference, singular_start};

/// States at which everything is tried.
pub const STATES: usize = 32;
/// How far apart, relative to their size, two sides of an identity may be.
const APART: f64 = 1e-6;
/// By how much a state is moved for a derivative in time, relative to its size.
pub(crate) const MOVE: f64 = 1e-5;
const SEED: u64 = 0x0f0e_57e9;

/// What was tried, and whether it failed anywhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Probe {
    /// States at which all numbers were finite.
    pub states: usize,
    /// The first state at which something is not as it is said to be.
    pub found: Option<Counterexample>,
}

/// A state at which an identity does not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Counterexample {
    /// Which.
    pub identity: Identity,
    /// When, s; zero where time does not matter.
    pub t_s: f64,
    /// The state: q and q̇ of a robot, all states of a plant and its controller.
    pub state: Vec<f64>,
    /// The side of the identity that its author says something of.
    pub value: f64,
    /// What it should be; for what must be positive, zero.
    pub expected: f64,
}

/// What is said of a robot, of a law, or of reference dynamics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Identity {
    /// M = Mᵀ.
    Symmetric,
    /// M ≻ 0, Property 1.
    Positive,
    /// xᵀ(Ṁ − 2C)x = 0, Property 2.
    Skew,
    /// Y ϑ = M ż + C z + g + D z for every ϑ, Property 3.
    Linear,
    /// The products Yϑ and Yᵀs that the law uses are those of Y.
    Products,
    /// xᵀD x ≥ 0.
    Damping,
    /// M q̈ + C q̇ + g + D q̇ = τ.
    Acceleration,
    /// What is computed for eight robots at once is what is computed for one.
    Lanes,
    /// V̇ = −D, what the law says that V loses.
    Balance,
    /// The first states of reference dynamics are z, ż, …, each the rate of the one before.
    Derivatives,
    /// ẋ = A x + b of reference dynamics, with an A that depends on Σ_j w_ij alone.
    Affine,
    /// This A is the same for each axis.
    Axes,
    /// z(0) is what was asked for.
    Start,
    /// z^(ℓ) is the linear form that the author says it is.
    LinearForm,
    /// ℓ of that form is the order of the dynamics: z^(ℓ) is a rate of a state, or the derivative of one.
    LinearOrder,
}

impl Identity {
    /// It, in letters.
    pub fn words(self) -> &'static str {
        match self {
            Identity::Symmetric => "M = Mᵀ",
            Identity::Positive => "M ≻ 0",
            Identity::Skew => "xᵀ(Ṁ − 2C)x = 0",
            Identity::Linear => "Y ϑ = M ż + C z + g + D z",
            Identity::Products => "the products with Y are those of Y",
            Identity::Damping => "xᵀD x ≥ 0",
            Identity::Acceleration => "M q̈ + C q̇ + g + D q̇ = τ",
            Identity::Lanes => "eight robots at once move as one by one",
            Identity::Balance => "V̇ is what the law says",
            Identity::Derivatives => "the state is z, ż, …, each the rate of the one before",
            Identity::Affine => "ẋ = A x + b, with A whatever is heard and measured",
            Identity::Axes => "each axis has the same A",
            Identity::Start => "z(0) is what was asked for",
            Identity::LinearForm => "z^(ℓ) is the linear form that `linear` says it is",
            Identity::LinearOrder => "ℓ of the form that `linear` gives is that of the dynamics",
        }
    }
}

/// Random numbers, the same in every run.
pub(crate) struct Draws(ChaCha8Rng);

impl Draws {
    pub(crate) fn new() -> Self {
        Draws(ChaCha8Rng::seed_from_u64(SEED))
    }

    /// Between −1 and 1.
    pub(crate) fn unit(&mut self) -> f64 {
        2.0 * self.0.random::<f64>() - 1.0
    }

    fn units<const K: usize>(&mut self, length: usize) -> [Vec<f64>; K] {
        std::array::from_fn(|_| (0..length).map(|_| self.unit()).collect())
    }
}

/// Tries the three properties of Section II-B, and what kernels compute from them, with the parameters of `robot`.
///
/// # Errors
/// [`LengthError`] when the axes or the parameters of `robot` are not as many as those of `kernel`.
pub(crate) fn properties<K>(kernel: &K, robot: &RobotSetup) -> Result<Probe, LengthError>
where
    K: Lagrangian<f64> + Lagrangian<Lanes<8>>,
{
    let (mut draws, mut probe) = (Draws::new(), Probe::default());
    let m = Lagrangian::<f64>::dof(kernel);
    LengthError::check("axes", m, robot.axes.len())?;
    for _ in 0..STATES {
        let [mut q, dq] = draws.units(m);
        for (q, axis) in q.iter_mut().zip(&robot.axes) {
            let [low, high] = ends(axis);
            *q = 0.5 * (low + high) + 0.5 * (high - low) * *q;
        }
        let here = Here { kernel, theta: &robot.theta, q, dq };
        match here.first(&mut draws)? {
            Tried::Not => {}
            Tried::Holds => probe.states += 1,
            Tried::Fails(identity, value, expected) => {
                let state = [here.q, here.dq].concat();
                probe.states += 1;
                probe.found = Some(Counterexample { identity, t_s: 0.0, state, value, expected });
                return Ok(probe);
            }
        }
    }
    Ok(probe)
}

/// Between what positions an axis is tried: within its limits, and not so far from zero that a position has too few digits for differences.
fn ends(axis: &Axis) -> [f64; 2] {
    let free = if axis.unit == AxisUnit::Radian { std::f64::consts::PI } else { 2.0 };
    let Some([low, high]) = axis.position_limits else { return [-free, free] };
    let (near, far) = (0.0_f64.max(low).min(high), 10.0 * free);
    [low.max(near - far), high.min(near + far)]
}

/// What became of a state.
enum Tried {
    /// Some number is not finite there.
    Not,
    Holds,
    Fails(Identity, f64, f64),
}

/// One state of a robot.
struct Here<'a, K> {
    kernel: &'a K,
    theta: &'a [f64],
    q: Vec<f64>,
    dq: Vec<f64>,
}

// Kernels are inlined wherever they are called: here they are called often, and once for every robot is enough.
impl<K: Lagrangian<f64> + Lagrangian<Lanes<8>>> Here<'_, K> {
    fn axes(&self) -> usize {
        Lagrangian::<f64>::dof(self.kernel)
    }

    fn scratch(&self) -> <K as Lagrangian<f64>>::Scratch {
        Lagrangian::<f64>::scratch(self.kernel)
    }

    #[inline(never)]
    fn mass(&self, q: &[f64], theta: &[f64]) -> Result<Vec<f64>, LengthError> {
        let mut out = vec![0.0; self.axes() * self.axes()];
        self.kernel.mass_matrix(&mut self.scratch(), q, theta, &mut out).map(|()| out)
    }

    #[inline(never)]
    fn damping(&self, theta: &[f64], v: &[f64]) -> Result<Vec<f64>, LengthError> {
        let (mut out, still) = (vec![0.0; self.axes()], vec![0.0; self.axes()]);
        let motion = TwoVelocity { q: &self.q[..], dq: v, z: &still[..], dz: &still[..] };
        self.kernel.add_damping(&mut self.scratch(), motion, theta, &mut out).map(|()| out)
    }

    #[inline(never)]
    fn coriolis(&self, theta: &[f64]) -> Result<Vec<f64>, LengthError> {
        let mut out = vec![0.0; self.axes() * self.axes()];
        self.kernel.coriolis_matrix(&mut self.scratch(), &self.q, &self.dq, theta, &mut out).map(|()| out)
    }

    /// M a + C v + g + D v by its parts.
    #[inline(never)]
    fn torque(&self, theta: &[f64], a: &[f64], v: &[f64]) -> Result<Vec<f64>, LengthError> {
        let mut out = self.damping(theta, v)?;
        let mut gravity = vec![0.0; self.axes()];
        self.kernel.gravity(&mut self.scratch(), &self.q, theta, &mut gravity)?;
        let (inertial, turning) = (times(&self.mass(&self.q, theta)?, a), times(&self.coriolis(theta)?, v));
        let parts = inertial.into_iter().zip(turning).zip(gravity);
        out.iter_mut().zip(parts).for_each(|(out, ((ma, cv), g))| *out += ma + cv + g);
        Ok(out)
    }

    /// The first identity that fails here.
    fn first(&self, draws: &mut Draws) -> Result<Tried, LengthError> {
        let Here { kernel, theta, q, dq } = self;
        let kernel: &K = kernel;
        let (m, p) = (self.axes(), Lagrangian::<f64>::parameter_count(kernel));
        let [x, z, dz, tau] = draws.units::<4>(m);
        let mut scratch = self.scratch();
        let matrix = self.mass(q, theta)?;
        if matrix.iter().any(|entry| !entry.is_finite()) {
            return Ok(Tried::Not);
        }
        let size = matrix.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
        for (row, column) in (0..m).flat_map(|row| (0..row).map(move |column| (row, column))) {
            let (below, above) = (matrix[row * m + column], matrix[column * m + row]);
            if apart(below, above, size) {
                return Ok(Tried::Fails(Identity::Symmetric, below, above));
            }
        }
        if let Some(pivot) = first_pivot_not_positive(&matrix, m) {
            return Ok(Tried::Fails(Identity::Positive, pivot, 0.0));
        }
        let moved = |sign: f64| -> Vec<f64> { q.iter().zip(dq).map(|(q, dq)| q + sign * MOVE * dq).collect() };
        let (after, before) = (self.mass(&moved(1.0), theta)?, self.mass(&moved(-1.0), theta)?);
        let rate: Vec<f64> = after.iter().zip(&before).map(|(after, before)| (after - before) / (2.0 * MOVE)).collect();
        let (turning, coriolis) = (dot(&x, &times(&rate, &x)), 2.0 * dot(&x, &times(&self.coriolis(theta)?, &x)));
        if apart(turning, coriolis, size) {
            return Ok(Tried::Fails(Identity::Skew, coriolis, turning));
        }
        let lost = dot(&x, &self.damping(theta, &x)?);
        if lost < 0.0 {
            return Ok(Tried::Fails(Identity::Damping, lost, 0.0));
        }
        // The true parameters, and others: the estimate may be anything.
        let other: Vec<f64> = theta.iter().map(|entry| draws.unit() * (1.0 + entry.abs())).collect();
        for theta in [theta.to_vec(), other] {
            let motion = TwoVelocity { q: &q[..], dq: &dq[..], z: &z[..], dz: &dz[..] };
            let mut y = vec![0.0; m * p];
            kernel.regressor(&mut scratch, motion, &mut y)?;
            let (of_y, of_parts) = (times(&y, &theta), self.torque(&theta, &dz, &z)?);
            if let Some((value, expected)) = first_apart(&of_y, &of_parts) {
                return Ok(Tried::Fails(Identity::Linear, value, expected));
            }
            let (mut y_theta, mut yt_s) = (vec![0.0; m], vec![0.0; p]);
            kernel.regressor_products(&mut scratch, motion, &theta, &x, &mut y_theta, &mut yt_s)?;
            let yt: Vec<f64> = (0..p).map(|k| (0..m).map(|row| y[row * p + k] * x[row]).sum()).collect();
            if let Some((value, expected)) = first_apart(&y_theta, &of_y).or_else(|| first_apart(&yt_s, &yt)) {
                return Ok(Tried::Fails(Identity::Products, value, expected));
            }
        }
        let mut ddq = vec![0.0; m];
        kernel.forward_dynamics(&mut scratch, q, dq, theta, &tau, &mut ddq)?;
        if let Some((value, expected)) = first_apart(&self.torque(theta, &ddq, dq)?, &tau) {
            return Ok(Tried::Fails(Identity::Acceleration, value, expected));
        }
        let Some(vectors) = Vectors::of_this_processor() else { return Ok(Tried::Holds) };
        let [q, dq, theta, tau] =
            [q, dq, *theta, &tau[..]].map(|values| values.iter().map(|value| Lanes::splat(*value)).collect::<Vec<_>>());
        let mut in_lanes = vec![Lanes::ZERO; m];
        vectors.run(InLanes { kernel, q: &q, dq: &dq, theta: &theta, tau: &tau, ddq: &mut in_lanes })?;
        let in_lanes: Vec<f64> = in_lanes.iter().map(|lanes| lanes.0[7]).collect();
        Ok(match first_apart(&in_lanes, &ddq) {
            Some((value, expected)) => Tried::Fails(Identity::Lanes, value, expected),
            None => Tried::Holds,
        })
    }
}

/// What many robots of one kind do where the processor has vector instructions, and only there.
struct InLanes<'a, K> {
    kernel: &'a K,
    q: &'a [Lanes<8>],
    dq: &'a [Lanes<8>],
    theta: &'a [Lanes<8>],
    tau: &'a [Lanes<8>],
    ddq: &'a mut [Lanes<8>],
}

impl<K: Lagrangian<Lanes<8>>> Kernel for InLanes<'_, K> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let InLanes { kernel, q, dq, theta, tau, ddq } = self;
        kernel.forward_dynamics(&mut kernel.scratch(), q, dq, theta, tau, ddq)
    }
}

/// Whether two sides are further apart than differences explain, beside numbers of `size`.
pub(crate) fn apart(value: f64, expected: f64, size: f64) -> bool {
    let difference = (value - expected).abs();
    difference.is_nan() || difference > APART * (size + value.abs() + expected.abs())
}

fn first_apart(values: &[f64], expected: &[f64]) -> Option<(f64, f64)> {
    let size = expected.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
    values
        .iter()
        .zip(expected)
        .map(|(value, expected)| (*value, *expected))
        .find(|(value, expected)| apart(*value, *expected, size))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A matrix, row by row, times a vector as long as its rows.
fn times(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    matrix.chunks(vector.len().max(1)).map(|row| dot(row, vector)).collect()
}

/// Eliminates by Cholesky; the first pivot that is not positive.
fn first_pivot_not_positive(matrix: &[f64], m: usize) -> Option<f64> {
    let mut l = vec![0.0; m * m];
    for row in 0..m {
        for column in 0..=row {
            let rest =
                matrix[row * m + column] - dot(&l[row * m..row * m + column], &l[column * m..column * m + column]);
            if row != column {
                l[row * m + column] = rest / l[column * m + column];
            } else if rest > 0.0 {
                l[row * m + row] = rest.sqrt();
            } else {
                return Some(rest);
            }
        }
    }
    None
}
