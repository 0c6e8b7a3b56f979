//! A tree as a Lagrangian robot.

use alloc::vec;
use alloc::vec::Vec;

use super::model::{Tree, TreeScratch};
use super::motion::Motion;
use crate::robot::{Lagrangian, TwoVelocity};
use crate::{Kernel, LengthError, Scalar, dispatch};

impl<S: Scalar> Lagrangian<S> for Tree {
    type Scratch = TreeScratch<S>;

    fn dof(&self) -> usize {
        self.joint_count()
    }

    fn parameter_count(&self) -> usize {
        self.theta_len()
    }

    fn scratch(&self) -> TreeScratch<S> {
        Tree::scratch(self)
    }

    #[inline(always)]
    fn regressor_products(
        &self,
        scratch: &mut TreeScratch<S>,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        s: &[S],
        y_theta: &mut [S],
        yt_s: &mut [S],
    ) -> Result<(), LengthError> {
        self.fused(scratch, motion, theta, s, y_theta, yt_s)
    }

    #[inline(always)]
    fn forward_dynamics(
        &self,
        scratch: &mut TreeScratch<S>,
        q: &[S],
        dq: &[S],
        theta: &[S],
        tau: &[S],
        ddq: &mut [S],
    ) -> Result<(), LengthError> {
        self.articulated(scratch, q, dq, theta, tau, ddq)
    }

    fn mass_matrix(&self, scratch: &mut TreeScratch<S>, q: &[S], theta: &[S], m: &mut [S]) -> Result<(), LengthError> {
        dispatch(MassMatrix { tree: self, scratch, q, theta, m })
    }

    fn coriolis_matrix(
        &self,
        scratch: &mut TreeScratch<S>,
        q: &[S],
        dq: &[S],
        theta: &[S],
        c: &mut [S],
    ) -> Result<(), LengthError> {
        dispatch(CoriolisMatrix { tree: self, scratch, q, dq, theta, c })
    }

    #[inline(always)]
    fn add_damping(
        &self,
        _: &mut TreeScratch<S>,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        out: &mut [S],
    ) -> Result<(), LengthError> {
        let n = self.joint_count();
        motion.check(n)?;
        LengthError::check("theta", self.theta_len(), theta.len())?;
        LengthError::check("damping torque", n, out.len())?;
        self.drives.add_losses(motion, &theta[self.body_parameters()..], out);
        Ok(())
    }

    fn gravity(&self, scratch: &mut TreeScratch<S>, q: &[S], theta: &[S], g: &mut [S]) -> Result<(), LengthError> {
        dispatch(Gravity { tree: self, scratch, q, theta, g })
    }

    fn regressor(
        &self,
        scratch: &mut TreeScratch<S>,
        motion: TwoVelocity<'_, S>,
        y: &mut [S],
    ) -> Result<(), LengthError> {
        dispatch(Regressor { tree: self, scratch, motion, y })
    }

    fn adaptation_scale(&self, q: &[f64], theta: &[f64]) -> Vec<f64> {
        self.parameter_scale(q, theta)
    }
}

impl Tree {
    /// See [`Lagrangian::adaptation_scale`]. r² = tr I / 2m is the mean squared distance from the joint; a body without
    /// mass or extent takes the mean over the others, and where there is none 1 kg and 0.1 m. The scale of a damping is
    /// M_jj(q), that of an armature r² M_jj(q)/g₀².
    fn parameter_scale(&self, q: &[f64], theta: &[f64]) -> Vec<f64> {
        const STANDARD_GRAVITY: f64 = 9.81;
        let (bodies, _) = theta.as_chunks::<10>();
        let bodies = bodies.get(..self.joint_count()).unwrap_or(bodies);
        let usable = |x: f64| (x > 0.0 && x.is_finite()).then_some(x);
        let mass = |pi: &[f64; 10]| usable(pi[0]);
        let spread = |pi: &[f64; 10]| usable(pi[0]).and_then(|m| usable(0.5 * (pi[4] + pi[6] + pi[9]) / m));
        let mean_mass = mean(bodies.iter().filter_map(mass)).unwrap_or(1.0);
        let mean_spread = mean(bodies.iter().filter_map(spread)).unwrap_or(0.01);

        let mut scale = Vec::with_capacity(self.theta_len());
        for body in 0..self.joint_count() {
            let m = bodies.get(body).and_then(mass).unwrap_or(mean_mass);
            let r2 = bodies.get(body).and_then(spread).unwrap_or(mean_spread);
            let unit = m / (STANDARD_GRAVITY * STANDARD_GRAVITY);
            scale.push(unit);
            scale.extend([unit * r2; 3]);
            scale.extend([unit * r2 * r2; 6]);
        }
        if self.theta_len() > 10 * self.joint_count() {
            let n = self.joint_count();
            let mut m = vec![0.0; n * n];
            // A wrong length leaves zeros, which take the fallback below.
            let _ = Lagrangian::<f64>::mass_matrix(self, &mut Tree::scratch(self), q, theta, &mut m);
            let diagonal = |joint: &usize| m.get(joint * (n + 1)).copied().and_then(usable);
            let fallback = mean((0..n).filter_map(|joint| diagonal(&joint))).unwrap_or(mean_mass * mean_spread);
            let inertia = |joint: usize| diagonal(&joint).unwrap_or(fallback);
            let spread = |joint: usize| bodies.get(joint).and_then(spread).unwrap_or(mean_spread);
            let armature = |joint: usize| spread(joint) * inertia(joint) / (STANDARD_GRAVITY * STANDARD_GRAVITY);
            let own = theta.get(self.body_parameters()..).unwrap_or_default();
            scale.extend(self.drives.scales(own, inertia, armature, fallback));
        }
        scale
    }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), x| (count + 1.0, sum + x));
    (count > 0.0).then_some(sum / count)
}

struct MassMatrix<'a, S> {
    tree: &'a Tree,
    scratch: &'a mut TreeScratch<S>,
    q: &'a [S],
    theta: &'a [S],
    m: &'a mut [S],
}

impl<S: Scalar> Kernel for MassMatrix<'_, S> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        self.tree.composite(self.scratch, self.q, self.theta, self.m)
    }
}

struct CoriolisMatrix<'a, S> {
    tree: &'a Tree,
    scratch: &'a mut TreeScratch<S>,
    q: &'a [S],
    dq: &'a [S],
    theta: &'a [S],
    c: &'a mut [S],
}

impl<S: Scalar> Kernel for CoriolisMatrix<'_, S> {
    type Output = Result<(), LengthError>;

    /// Column j is the torque for z = e_j, ż = 0, without gravity.
    #[inline(always)]
    fn run(self) -> Self::Output {
        let CoriolisMatrix { tree, scratch, q, dq, theta, c } = self;
        let n = tree.joint_count();
        LengthError::check("q", n, q.len())?;
        LengthError::check("dq", n, dq.len())?;
        LengthError::check("theta", tree.theta_len(), theta.len())?;
        LengthError::check("Coriolis matrix", n * n, c.len())?;
        LengthError::check("scratch", n, scratch.unit.len())?;
        tree.seat(scratch, q);
        let mut j = 0;
        while j < n {
            scratch.point_at(j);
            let TreeScratch { slots, unit, column, row, .. } = &mut *scratch;
            row.fill(S::ZERO);
            let motion = TwoVelocity { q, dq, z: unit, dz: &row[..n] };
            tree.wrenches(slots, Motion::STILL, motion, theta);
            tree.fold_back(slots, column);
            let mut i = 0;
            while i < n {
                c[i * n + j] = column[i];
                i += 1;
            }
            j += 1;
        }
        Ok(())
    }
}

struct Gravity<'a, S> {
    tree: &'a Tree,
    scratch: &'a mut TreeScratch<S>,
    q: &'a [S],
    theta: &'a [S],
    g: &'a mut [S],
}

impl<S: Scalar> Kernel for Gravity<'_, S> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Gravity { tree, scratch, q, theta, g } = self;
        let n = tree.joint_count();
        LengthError::check("q", n, q.len())?;
        LengthError::check("theta", tree.theta_len(), theta.len())?;
        LengthError::check("gravity", n, g.len())?;
        LengthError::check("scratch", n, scratch.unit.len())?;
        tree.seat(scratch, q);
        let TreeScratch { slots, unit: still, .. } = scratch;
        still.fill(S::ZERO);
        tree.wrenches(slots, tree.base(), TwoVelocity { q, dq: still, z: still, dz: still }, theta);
        tree.fold_back(slots, g);
        Ok(())
    }
}

struct Regressor<'a, 'm, S> {
    tree: &'a Tree,
    scratch: &'a mut TreeScratch<S>,
    motion: TwoVelocity<'m, S>,
    y: &'a mut [S],
}

impl<S: Scalar> Kernel for Regressor<'_, '_, S> {
    type Output = Result<(), LengthError>;

    /// Row i is Yᵀe_i.
    #[inline(always)]
    fn run(self) -> Self::Output {
        let Regressor { tree, scratch, motion, y } = self;
        let (n, width) = (tree.joint_count(), tree.theta_len());
        motion.check(n)?;
        LengthError::check("regressor", n * width, y.len())?;
        LengthError::check("scratch", n, scratch.unit.len())?;
        tree.seat(scratch, motion.q);
        let mut i = 0;
        while i < n {
            scratch.point_at(i);
            let TreeScratch { slots, unit, .. } = &mut *scratch;
            tree.pairing(slots, motion, unit, &mut y[i * width..(i + 1) * width]);
            i += 1;
        }
        Ok(())
    }
}
