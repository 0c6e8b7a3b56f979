//! Groups of characteristic roots, what the start puts into each, and how the disagreement goes by the slowest of them.
//!
//! Around a group of m roots the integrals (1/2πi)∮ (p−c)^k Δ⁻¹b dp = R_k give its part of the solution, e^(ct) Σ_k R_k t^k/k!,
//! whether the roots are distinct, semisimple or defective; (1/2πi)∮ tr(Δ⁻¹Δ′) dp is m. The trapezoidal rule on a circle that keeps
//! away from all roots converges geometrically.
//!
//! The power sums s_k = Σ (p_i − c)^k = (1/2πi)∮ (p−c)^k tr(Δ⁻¹Δ′) dp tell the roots of a group apart: Newton's identities make their polynomial of them. Where s₂ is
//! no more than rounding they stand in one place, which is then their mean.

use nalgebra::DMatrix;

use super::characteristic::{C, Characteristic, exp, size};

/// Points on a circle: for how many roots are in it and their part of the solution, and to tell them apart, for which high powers of what is
/// outside count.
const POINTS: usize = 16;
const MANY_POINTS: usize = 64;
/// The radius of the circle, as a part of the distance to the nearest root outside.
const REACH: f64 = 0.3;
/// How near roots stand to each other in a group, as a part of the same distance.
const CLOSE: f64 = 0.03;

/// Roots of a group are told apart where they spread by more than this part of the circle's radius.
const APART: f64 = 1e-5;
/// How many are told apart, and of how many agents.
const MOST_APART: usize = 12;
const MOST_AGENTS: usize = 30;
/// With few points on a circle roots seem to spread by this part of its radius.
const UNSEEN: f64 = 1e-3;
/// Steps for that: roots that come in pairs converge by halves.
const STEPS_APART: usize = 200;

/// Some roots that lie close together, and their part of the solution.
pub(super) struct Mode {
    /// Their mean, 1/s.
    pub(super) root: C,
    /// How many there are.
    pub(super) members: usize,
    /// The rightmost of them, 1/s, and how many stand there.
    pub(super) rightmost: C,
    pub(super) multiplicity: usize,
    /// R₀, R₁, …: a row per agent, a column per axis.
    pub(super) parts: Vec<DMatrix<C>>,
    /// The size of the last step of Newton's method, 1/s.
    pub(super) correction: f64,
}

/// A group of candidates.
struct Group {
    centre: C,
    members: usize,
    radius: f64,
}

/// Groups of candidates, the rightmost first, without those below the real axis; none is left out but behind the last.
fn groups(candidates: &[C], most: usize) -> Vec<Group> {
    let mut left: Vec<C> = candidates.to_vec();
    left.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    let mut found: Vec<Group> = Vec::new();
    while found.len() < most && !left.is_empty() {
        let mut members = vec![left.remove(0)];
        loop {
            let centre = members.iter().sum::<C>() / members.len() as f64;
            let own = members.iter().map(|p| size(p - centre)).fold(0.0, f64::max);
            let nearest =
                left.iter().enumerate().map(|(k, p)| (k, size(p - centre))).min_by(|a, b| a.1.total_cmp(&b.1));
            let others = found.iter().map(|group| size(group.centre - centre)).fold(f64::INFINITY, f64::min);
            let away = nearest.map_or(f64::INFINITY, |(_, away)| away).min(others);
            match nearest {
                Some((k, distance)) if own > CLOSE * distance || distance < CLOSE * size(centre) => {
                    members.push(left.remove(k));
                }
                _ => {
                    let radius = REACH * if away.is_finite() { away } else { 1.0 + size(centre) };
                    found.push(Group { centre, members: members.len(), radius });
                    break;
                }
            }
        }
    }
    found
}

/// The rightmost modes, the one at zero among them, as far as every group is what its candidates say: far from the origin
/// candidates are poor.
pub(super) fn modes(system: &Characteristic, candidates: &[C], most: usize) -> Vec<Mode> {
    let mut modes = Vec::new();
    for group in groups(candidates, 2 * most + 1) {
        // The conjugate has the conjugate part.
        if group.centre.im < -0.5 * group.radius {
            continue;
        }
        if modes.len() > most {
            break;
        }
        let Some(mode) = mode(system, &group) else { break };
        modes.push(mode);
    }
    modes
}

fn mode(system: &Characteristic, group: &Group) -> Option<Mode> {
    let integral = Integral::around(system, group.centre, group.radius, [1, 1, POINTS])?;
    let members = group.members;
    let off = size(integral.sums[0] - members as f64);
    if off.is_nan() || off > 0.1 {
        return None;
    }
    let mut root = group.centre + integral.sums[1] / members as f64;
    let mut correction = f64::INFINITY;
    if members == 1 {
        for _ in 0..20 {
            // Where the matrix is singular in `f64` nothing is left to correct.
            let step = newton(system, root).unwrap_or_default();
            if size(step) >= 0.5 * correction {
                break;
            }
            correction = size(step);
            root -= step;
        }
    } else {
        // At a root of several Newton's method ends far above rounding, and a mean does not.
        // The smaller circle is off by another rounding and another tail.
        let again = Integral::around(system, root, group.radius / 3.0, [1, 1, POINTS])?.sums[1] / members as f64;
        correction = size(again);
        root += again;
    }
    if size(root - group.centre) > group.radius {
        return None;
    }
    // What is real stays real.
    let real = |root: C| if root.im.abs() < 1e-9 * size(root) { C::from(root.re) } else { root };
    let root = real(root);
    let parts = members.min(6);
    let (mut rightmost, mut multiplicity) = (root, members);
    if members == 1 {
        let parts = Integral::around(system, root, group.radius, [parts, 1, POINTS])?.parts;
        return Some(Mode { root, members, rightmost, multiplicity, parts, correction });
    }
    // Many of them, or those of a large network, are not told apart: how far they spread is then what is not known.
    let few = members <= MOST_APART && system.agents() <= MOST_AGENTS;
    let (power, points) = if few { (members, MANY_POINTS) } else { (2, POINTS) };
    let found = Integral::around(system, root, group.radius, [parts, power, points])?;
    let spread = (size(found.sums[2]) / members as f64).sqrt();
    if !few {
        correction = if spread > UNSEEN * group.radius { correction.max(spread) } else { correction };
    } else if spread > APART * group.radius {
        let smaller = Integral::around(system, root, 0.7 * group.radius, [1, power, points])?;
        let [all, again] = [&found, &smaller].map(|integral| apart_by(&integral.sums));
        let first = |all: &[C]| all.iter().copied().reduce(|a, b| if b.re > a.re { b } else { a });
        let (first, first_again) = (first(&all)?, first(&again)?);
        correction = correction.max(size(first - first_again));
        // Several in one place come apart by a root of rounding.
        let there = |p: &&C| size(*p - first) < 1e-3 * group.radius;
        multiplicity = all.iter().filter(there).count();
        let sum: C = all.iter().filter(there).sum();
        rightmost = real(root + sum / multiplicity as f64);
    }
    Some(Mode { root, members, rightmost, multiplicity, parts: found.parts, correction })
}

/// The roots whose power sums these are, from the zeroth on, which is their number.
fn apart_by(sums: &[C]) -> Vec<C> {
    let m = sums.len() - 1;
    // Newton's identities: k e_k = Σ (−1)^(i−1) e_(k−i) s_i, and the polynomial is Σ (−1)^k e_k p^(m−k).
    let mut e = vec![C::from(1.0)];
    for k in 1..=m {
        let terms = (1..=k).map(|i| e[k - i] * sums[i] * if i % 2 == 1 { 1.0 } else { -1.0 });
        e.push(terms.sum::<C>() / k as f64);
    }
    let value = |p: C| {
        e.iter().enumerate().fold(C::from(0.0), |sum, (k, e)| sum * p + *e * if k % 2 == 0 { 1.0 } else { -1.0 })
    };
    // All at once, after Weierstrass, from a circle as wide as they are apart.
    let wide = (size(sums[2]) / m as f64).sqrt().max(f64::MIN_POSITIVE);
    let mut roots: Vec<C> =
        (0..m).map(|k| exp(C::new(0.0, 0.4 + core::f64::consts::TAU * k as f64 / m as f64)) * wide).collect();
    for _ in 0..STEPS_APART {
        for k in 0..m {
            let others: C = (0..m).filter(|j| *j != k).map(|j| roots[k] - roots[j]).product();
            let step = value(roots[k]) / others;
            if step.re.is_finite() && step.im.is_finite() {
                roots[k] -= step;
            }
        }
    }
    roots
}

/// 1 / tr(Δ⁻¹Δ′): the step of Newton's method for det Δ.
fn newton(system: &Characteristic, p: C) -> Option<C> {
    let [delta, slope] = system.matrix(p);
    let step = delta.lu().solve(&slope)?.trace().inv();
    (step.re.is_finite() && step.im.is_finite()).then_some(step)
}

/// How small a relative change of the terms of Δ(p), row by row, makes it singular: |Δx| over the sum of their sizes, for a
/// vector x with |x|∞ = 1 that it hardly maps anywhere.
pub(super) fn backward_error(system: &Characteristic, p: C) -> f64 {
    let [delta, _] = system.matrix(p);
    let n = system.agents();
    // A start that is orthogonal to nothing in particular.
    let mut x = DMatrix::from_fn(n, 1, |i, _| C::new(1.0 + 0.37 * i as f64 % 0.71, 0.53 * i as f64 % 0.29));
    let lu = delta.clone().lu();
    for _ in 0..3 {
        // Exactly singular.
        let Some(next) = lu.solve(&x) else { return 0.0 };
        let largest = next.iter().map(|entry| size(*entry)).fold(0.0, f64::max);
        if !(largest.is_finite() && largest > 0.0) {
            return 0.0;
        }
        x = next / C::from(largest);
    }
    let rest = &delta * &x;
    let sizes = system.sizes(p);
    rest.iter().zip(sizes).map(|(rest, whole)| size(*rest) / whole.max(f64::MIN_POSITIVE)).fold(0.0, f64::max)
}

/// Integrals over a circle, divided by 2πi.
struct Integral {
    /// Of (p−c)^k tr(Δ⁻¹Δ′): how many roots are inside, the sum of their distances from the centre, that of their squares, ….
    sums: Vec<C>,
    /// Of (p−c)^k Δ⁻¹b.
    parts: Vec<DMatrix<C>>,
}

impl Integral {
    /// With so many parts, sums up to this power, and points.
    fn around(system: &Characteristic, centre: C, radius: f64, [parts, power, points]: [usize; 3]) -> Option<Integral> {
        let zero = DMatrix::zeros(system.agents(), system.axes());
        let mut all = Integral { sums: vec![C::from(0.0); power + 1], parts: vec![zero; parts] };
        for k in 0..points {
            let angle = core::f64::consts::TAU * (k as f64 + 0.5) / points as f64;
            let away = exp(C::new(0.0, angle)) * radius;
            let [delta, slope] = system.matrix(centre + away);
            let lu = delta.lu();
            let share = away / points as f64;
            let mut term = share * lu.solve(&slope)?.trace();
            for sum in &mut all.sums {
                *sum += term;
                term *= away;
            }
            let solution = lu.solve(&system.start(centre + away))?;
            let mut factor = share;
            for part in &mut all.parts {
                *part += &solution * factor;
                factor *= away;
            }
        }
        Some(all)
    }
}

impl Mode {
    /// Whether a conjugate goes with it.
    pub(super) fn is_pair(&self) -> bool {
        self.root.im != 0.0
    }

    /// Its part of q at `t_s`, a row per agent, a column per axis.
    pub(super) fn at(&self, t_s: f64) -> DMatrix<f64> {
        let factor = exp(self.root * t_s) * if self.is_pair() { 2.0 } else { 1.0 };
        self.polynomial(t_s).map(|entry| (entry * factor).re)
    }

    /// The largest disagreement that it makes, whatever its phase: of several roots it need not be at the start.
    pub(super) fn excited(&self) -> f64 {
        let steps = if self.members > 1 { STEPS } else { 0 };
        let t_s = (0..=steps).map(|step| 0.1 * f64::from(step) / self.root.re.abs());
        let largest = t_s.map(|t_s| libm::exp(self.root.re * t_s) * apart(&self.polynomial(t_s))).fold(0.0, f64::max);
        if self.is_pair() { 2.0 * largest } else { largest }
    }

    /// Σ_k R_k t^k/k!.
    fn polynomial(&self, t_s: f64) -> DMatrix<C> {
        let mut sum = self.parts[0].clone();
        let mut factor = 1.0;
        for (k, part) in self.parts.iter().enumerate().skip(1) {
            factor *= t_s / k as f64;
            sum.zip_apply(part, |sum, part| *sum += part * factor);
        }
        sum
    }
}

/// Where the largest disagreement of several roots is looked for: ten time constants.
const STEPS: u32 = 100;

/// The largest difference of two rows in one column: at the phase at which it is largest, where they are complex.
fn apart(part: &DMatrix<C>) -> f64 {
    let column = |column: usize| {
        let entries = part.column(column);
        let from =
            |(k, one): (usize, &C)| entries.iter().skip(k + 1).map(|other| size(*one - *other)).fold(0.0, f64::max);
        entries.iter().enumerate().map(from).fold(0.0, f64::max)
    };
    (0..part.ncols()).map(column).fold(0.0, f64::max)
}
