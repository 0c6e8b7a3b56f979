//! A robot's dynamics, each a kernel by itself.
//!
//! Kernels are inlined into what calls them, and get their instruction set from there. Where the caller is no kernel, as a law that serves
//! one robot at a time, every fused multiply-add in them would be a call.

use alloc::vec::Vec;

use super::{Lagrangian, TwoVelocity};
use crate::{Kernel, LengthError, Scalar, dispatch};

/// A robot for callers that are no kernels: what they ask for often is compiled for the best instruction set of this processor. The
/// same bits either way.
#[derive(Clone, Copy, Debug)]
pub struct Called<'a, R>(pub &'a R);

impl<S: Scalar, R: Lagrangian<S>> Lagrangian<S> for Called<'_, R> {
    type Scratch = R::Scratch;

    fn dof(&self) -> usize {
        self.0.dof()
    }

    fn parameter_count(&self) -> usize {
        self.0.parameter_count()
    }

    fn scratch(&self) -> Self::Scratch {
        self.0.scratch()
    }

    fn regressor_products(
        &self,
        scratch: &mut Self::Scratch,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        s: &[S],
        y_theta: &mut [S],
        yt_s: &mut [S],
    ) -> Result<(), LengthError> {
        dispatch(Products { robot: self.0, scratch, motion, theta, s, y_theta, yt_s })
    }

    fn forward_dynamics(
        &self,
        scratch: &mut Self::Scratch,
        q: &[S],
        dq: &[S],
        theta: &[S],
        tau: &[S],
        ddq: &mut [S],
    ) -> Result<(), LengthError> {
        dispatch(Forward { robot: self.0, scratch, q, dq, theta, tau, ddq })
    }

    fn mass_matrix(&self, scratch: &mut Self::Scratch, q: &[S], theta: &[S], m: &mut [S]) -> Result<(), LengthError> {
        dispatch(MassMatrix { robot: self.0, scratch, q, theta, m })
    }

    fn coriolis_matrix(
        &self,
        scratch: &mut Self::Scratch,
        q: &[S],
        dq: &[S],
        theta: &[S],
        c: &mut [S],
    ) -> Result<(), LengthError> {
        self.0.coriolis_matrix(scratch, q, dq, theta, c)
    }

    fn add_damping(
        &self,
        scratch: &mut Self::Scratch,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        out: &mut [S],
    ) -> Result<(), LengthError> {
        dispatch(Damping { robot: self.0, scratch, motion, theta, out })
    }

    fn gravity(&self, scratch: &mut Self::Scratch, q: &[S], theta: &[S], g: &mut [S]) -> Result<(), LengthError> {
        self.0.gravity(scratch, q, theta, g)
    }

    fn regressor(
        &self,
        scratch: &mut Self::Scratch,
        motion: TwoVelocity<'_, S>,
        y: &mut [S],
    ) -> Result<(), LengthError> {
        self.0.regressor(scratch, motion, y)
    }

    fn adaptation_scale(&self, q: &[f64], theta: &[f64]) -> Vec<f64> {
        self.0.adaptation_scale(q, theta)
    }
}

struct Products<'a, 'm, S: Scalar, R: Lagrangian<S>> {
    robot: &'a R,
    scratch: &'a mut R::Scratch,
    motion: TwoVelocity<'m, S>,
    theta: &'a [S],
    s: &'a [S],
    y_theta: &'a mut [S],
    yt_s: &'a mut [S],
}

impl<S: Scalar, R: Lagrangian<S>> Kernel for Products<'_, '_, S, R> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Products { robot, scratch, motion, theta, s, y_theta, yt_s } = self;
        robot.regressor_products(scratch, motion, theta, s, y_theta, yt_s)
    }
}

struct Forward<'a, S: Scalar, R: Lagrangian<S>> {
    robot: &'a R,
    scratch: &'a mut R::Scratch,
    q: &'a [S],
    dq: &'a [S],
    theta: &'a [S],
    tau: &'a [S],
    ddq: &'a mut [S],
}

impl<S: Scalar, R: Lagrangian<S>> Kernel for Forward<'_, S, R> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Forward { robot, scratch, q, dq, theta, tau, ddq } = self;
        robot.forward_dynamics(scratch, q, dq, theta, tau, ddq)
    }
}

struct MassMatrix<'a, S: Scalar, R: Lagrangian<S>> {
    robot: &'a R,
    scratch: &'a mut R::Scratch,
    q: &'a [S],
    theta: &'a [S],
    m: &'a mut [S],
}

impl<S: Scalar, R: Lagrangian<S>> Kernel for MassMatrix<'_, S, R> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        self.robot.mass_matrix(self.scratch, self.q, self.theta, self.m)
    }
}

struct Damping<'a, 'm, S: Scalar, R: Lagrangian<S>> {
    robot: &'a R,
    scratch: &'a mut R::Scratch,
    motion: TwoVelocity<'m, S>,
    theta: &'a [S],
    out: &'a mut [S],
}

impl<S: Scalar, R: Lagrangian<S>> Kernel for Damping<'_, '_, S, R> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        self.robot.add_damping(self.scratch, self.motion, self.theta, self.out)
    }
}
