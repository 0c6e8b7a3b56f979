//! The parts of a step, each compiled for every instruction set.

use alloc::vec::Vec;

use super::hold::{Hold, Since};
use super::{Applied, Held, Inbox, Out};
use crate::law::{SlotineLi, SlotineLiOutput};
use crate::reference::{Derived, Exchange, Heard, Measured, Reference, ReferenceOut, SlidingInputs};
use crate::robot::{Lagrangian, TwoVelocity};
use crate::{Kernel, LengthError};

/// The reference dynamics: from the last sample to this one, then z and ż.
pub(super) struct Refer<'a, F> {
    pub(super) reference: &'a F,
    pub(super) hold: &'a mut Hold,
    /// At the first sample, what z(0), ż(0), … shall be.
    pub(super) wanted: Option<&'a [Vec<f64>]>,
    pub(super) passed_s: Option<f64>,
    pub(super) now_s: f64,
    pub(super) measured: Measured<'a>,
    pub(super) inbox: Inbox<'a>,
    pub(super) state: &'a mut [f64],
    pub(super) held: &'a mut Held,
    pub(super) out: &'a mut Out,
}

impl<F: Reference> Kernel for Refer<'_, F> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Refer { reference, hold, wanted, passed_s, now_s, measured, inbox, state, held, out } = self;
        let m = held.q.len();
        if let Some(h) = passed_s {
            let heard = Heard::new(&held.degree, &held.sums, m)?.at(held.time_s);
            let since = Since { measured: Measured { q: &held.q, dq: &held.dq }, heard, rate: &out.d_state };
            hold.advance(reference, since, h, state)?;
        }
        // With ṡ held q̈ is ż + ṡ, and over the last period ṡ was what the velocity gained less what ż asked for.
        let accelerates = reference.sliding().is_some_and(|sliding| sliding.derived == Derived::Acceleration);
        for (k, transmitted) in out.transmitted.iter_mut().enumerate() {
            *transmitted = match passed_s {
                Some(h) if accelerates => (measured.dq[k] - held.dq[k]) / h - out.dz[k],
                _ => 0.0,
            };
        }
        held.q.copy_from_slice(measured.q);
        held.dq.copy_from_slice(measured.dq);
        held.degree = [inbox.degree];
        held.sums.copy_from_slice(inbox.sums);
        held.time_s = now_s;
        let measured = Measured { q: &held.q, dq: &held.dq };
        let heard = Heard::new(&held.degree, &held.sums, m)?.at(now_s);
        if let Some(wanted) = wanted {
            out.d_state.fill(0.0);
            out.d_state[..m].copy_from_slice(&held.dq);
            for (block, wanted) in out.d_state.chunks_exact_mut(m).zip(wanted) {
                block.copy_from_slice(wanted);
            }
            reference.start(m, measured, &out.d_state, heard, state)?;
        }
        let reference_out = ReferenceOut { z: &mut out.z, dz: &mut out.dz, d_state: &mut out.d_state };
        reference.evaluate(m, measured, state, heard, reference_out)?;
        let Some(sliding) = reference.sliding() else { return Ok(()) };
        // ż does not depend on the sign where it is told.
        for (transmitted, dz) in out.transmitted.iter_mut().zip(&out.dz) {
            *transmitted += dz;
        }
        let Some(h) = passed_s else { return Ok(()) };
        let channel = |c: usize| held.sums.get(c * m..(c + 1) * m).unwrap_or_default();
        let [first, second] = match <F::Exchange as Exchange>::HELD {
            None => [&held.q[..], &held.dq[..]],
            Some(held) => [held, held + 1].map(|block| state.get(block * m..(block + 1) * m).unwrap_or_default()),
        };
        let own = [first, second, &out.transmitted[..]];
        let inputs = SlidingInputs { own, degree: &held.degree, sums: [channel(0), channel(1), channel(2)] };
        sliding.argument(m, inputs, &mut out.e)?;
        let selection = state.len() - m;
        for (selection, e) in state[selection..].iter_mut().zip(&out.e) {
            *selection = sliding.alone(*e, held.degree[0], h);
        }
        let reference_out = ReferenceOut { z: &mut out.z, dz: &mut out.dz, d_state: &mut out.d_state };
        reference.evaluate(m, measured, state, heard, reference_out)
    }
}

/// (7) over the last period: the Y that was applied, with the s that came of it.
pub(super) struct Learn<'a, R: Lagrangian<f64>> {
    pub(super) robot: &'a R,
    pub(super) scratch: &'a mut R::Scratch,
    pub(super) law: &'a SlotineLi,
    pub(super) h: f64,
    pub(super) applied: &'a Applied,
    pub(super) theta_hat: &'a mut [f64],
    pub(super) held: &'a Held,
    pub(super) out: &'a mut Out,
}

impl<R: Lagrangian<f64>> Kernel for Learn<'_, R> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Learn { robot, scratch, law, h, applied: Applied { q, dq, z, dz }, theta_hat, held, out } = self;
        for (s, (dq, z)) in out.s.iter_mut().zip(held.dq.iter().zip(&out.z)) {
            *s = dq - z;
        }
        let motion = TwoVelocity { q, dq, z, dz };
        robot.regressor_products(scratch, motion, theta_hat, &out.s, &mut out.tau, &mut out.yt_s)?;
        law.free_rate(&out.yt_s, &mut out.d_theta_hat);
        for (estimate, rate) in theta_hat.iter_mut().zip(&out.d_theta_hat) {
            *estimate += h * rate;
        }
        if let Some(bounds) = &law.bounds {
            bounds.project(theta_hat);
        }
        Ok(())
    }
}

/// (5), (6) at this sample.
pub(super) struct Track<'a, R: Lagrangian<f64>> {
    pub(super) robot: &'a R,
    pub(super) scratch: &'a mut R::Scratch,
    pub(super) law: &'a SlotineLi,
    pub(super) theta_hat: &'a [f64],
    pub(super) held: &'a Held,
    pub(super) out: &'a mut Out,
}

impl<R: Lagrangian<f64>> Kernel for Track<'_, R> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Track { robot, scratch, law, theta_hat, held, out } = self;
        let motion = TwoVelocity { q: &held.q, dq: &held.dq, z: &out.z, dz: &out.dz };
        let law_out = SlotineLiOutput { s: &mut out.s, tau: &mut out.tau, yt_s: &mut out.yt_s };
        law.output(robot, scratch, motion, theta_hat, law_out)
    }
}
