//! Attitudes as unit quaternions (Euler parameters), vector part first: q = (q_v, q_o).
//!
//! q stands for the rotation R that takes coordinates in the body to coordinates in the inertial frame. With × for the cross
//! product and ω the angular velocity in coordinates of the body, ω^I = R ω that in inertial ones,
//!
//! ```text
//! R v = v + 2 [q_o q_v × v + q_v × (q_v × v)] / qᵀq
//! q̇_v = ½ (q_o ω + q_v × ω)         q̇_o = −½ q_vᵀω
//! q̇_v = ½ (q_o ω^I − q_v × ω^I)      q̇_o = −½ q_vᵀω^I
//! ```
//!
//! The division by qᵀq makes R orthogonal for every q that is not zero, so a norm that is a little off does no harm.
//!
//! **A desired attitude** is a path p(t) in ℝ⁴ that avoids zero; what is meant is p / |p|. Of ṗ p⁻¹, which is
//! (½ ω^I, d/dt ln |p|), the norm is only in the scalar part. So, with n = pᵀp,
//!
//! ```text
//! ω_d^I  = 2 (p_o ṗ_v − ṗ_o p_v + p_v × ṗ_v) / n
//! ω̇_d^I = 2 (p_o p̈_v − p̈_o p_v + p_v × p̈_v) / n − ω_d^I (2 pᵀṗ) / n
//! ```
//!
//! The terms with ṗ alone cancel in the second line.

use crate::controller::Jet;

/// (q_v, q_o).
pub type Quaternion = [f64; 4];

/// No turn at all.
pub const IDENTITY: Quaternion = [0.0, 0.0, 0.0, 1.0];

/// a × b, S(a) b in the paper.
#[inline]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// aᵀb.
#[inline]
pub fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    let mut sum = 0.0;
    for k in 0..N {
        sum += a[k] * b[k];
    }
    sum
}

/// A v for a 3 × 3 matrix by rows.
#[inline]
pub fn times(a: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    a.map(|row| dot(row, v))
}

/// q_v and q_o.
#[inline]
fn parts([x, y, z, o]: Quaternion) -> ([f64; 3], f64) {
    ([x, y, z], o)
}

/// q / |q|; the identity where |q| is zero or not finite.
#[inline]
pub fn normalized(q: Quaternion) -> Quaternion {
    let norm = libm::sqrt(dot(q, q));
    if norm > 0.0 && norm.is_finite() { q.map(|x| x / norm) } else { IDENTITY }
}

/// The product a b: the rotation b first, then a.
#[inline]
pub fn product(a: Quaternion, b: Quaternion) -> Quaternion {
    let ((a_v, a_o), (b_v, b_o)) = (parts(a), parts(b));
    let turn = cross(a_v, b_v);
    let v = |k: usize| a_o * b_v[k] + b_o * a_v[k] + turn[k];
    [v(0), v(1), v(2), a_o * b_o - dot(a_v, b_v)]
}

/// The quaternion of R_bᵀ R_a: where a is, seen from b. For b = q_z it is Δq* of the paper, for b = q_d it is Δq.
#[inline]
pub fn difference(a: Quaternion, b: Quaternion) -> Quaternion {
    product([-b[0], -b[1], -b[2], b[3]], a)
}

/// R v.
#[inline]
pub fn rotate(q: Quaternion, v: [f64; 3]) -> [f64; 3] {
    let (q_v, q_o) = parts(q);
    turned(q_v, q_o, dot(q, q), v)
}

/// Rᵀ v.
#[inline]
pub fn rotate_back(q: Quaternion, v: [f64; 3]) -> [f64; 3] {
    let (q_v, q_o) = parts(q);
    turned(q_v, -q_o, dot(q, q), v)
}

#[inline]
fn turned(q_v: [f64; 3], q_o: f64, n: f64, v: [f64; 3]) -> [f64; 3] {
    let once = cross(q_v, v);
    let twice = cross(q_v, once);
    core::array::from_fn(|k| v[k] + 2.0 * (q_o * once[k] + twice[k]) / n)
}

/// q̇ for the angular velocity `omega` in coordinates of the body.
#[inline]
pub fn rate(q: Quaternion, omega: [f64; 3]) -> Quaternion {
    product(q, [0.5 * omega[0], 0.5 * omega[1], 0.5 * omega[2], 0.0])
}

/// q̇ for the angular velocity `omega` in inertial coordinates.
#[inline]
pub fn rate_inertial(q: Quaternion, omega: [f64; 3]) -> Quaternion {
    product([0.5 * omega[0], 0.5 * omega[1], 0.5 * omega[2], 0.0], q)
}

/// The angle of the rotation, in [0, π].
pub fn angle(q: Quaternion) -> f64 {
    let (q_v, q_o) = parts(q);
    2.0 * libm::atan2(libm::sqrt(dot(q_v, q_v)), q_o.abs())
}

/// The quaternion of a rotation matrix, by rows, whose largest entry is positive: of the four ways to write it the one that divides
/// by the largest number.
pub fn from_matrix(r: &[[f64; 3]; 3]) -> Quaternion {
    let (x, y, z) = (r[0][0], r[1][1], r[2][2]);
    // Four times the squares of the entries, less than one each.
    let squares = [x - y - z, y - x - z, z - x - y, x + y + z];
    let mut most = 3;
    for k in 0..3 {
        if squares[k] > squares[most] {
            most = k;
        }
    }
    let head = 1.0 + squares[most];
    let (apart, sum) = (|i: usize, k: usize| r[i][k] - r[k][i], |i: usize, k: usize| r[i][k] + r[k][i]);
    normalized(match most {
        0 => [head, sum(0, 1), sum(0, 2), apart(2, 1)],
        1 => [sum(0, 1), head, sum(1, 2), apart(0, 2)],
        2 => [sum(0, 2), sum(1, 2), head, apart(1, 0)],
        _ => [apart(2, 1), apart(0, 2), apart(1, 0), head],
    })
}

/// A desired attitude at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Desired {
    /// q_d, of norm one.
    pub q: Quaternion,
    /// ω_d^I, rad/s.
    pub omega: [f64; 3],
    /// ω̇_d^I, rad/s².
    pub d_omega: [f64; 3],
}

impl Desired {
    /// From a path p of any norm but zero; its first two derivatives are used.
    pub fn from_path(p: &[Jet; 4]) -> Self {
        let at = |k: usize| p.map(|jet| jet[k]);
        let (p0, p1, p2) = (at(0), at(1), at(2));
        let n = dot(p0, p0);
        // 2 vec(a p*) / n
        let swing = |a: Quaternion| -> [f64; 3] {
            let ((p_v, p_o), (a_v, a_o)) = (parts(p0), parts(a));
            let turn = cross(p_v, a_v);
            core::array::from_fn(|k| 2.0 * (p_o * a_v[k] - a_o * p_v[k] + turn[k]) / n)
        };
        let (omega, bent, stretch) = (swing(p1), swing(p2), 2.0 * dot(p0, p1) / n);
        Desired { q: normalized(p0), omega, d_omega: core::array::from_fn(|k| bent[k] - omega[k] * stretch) }
    }
}
