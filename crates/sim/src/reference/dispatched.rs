//! Reference dynamics, compiled for every instruction set.

use forwardstep_core::reference::{Heard, Measured, Reference, ReferenceOut, Sliding};
use forwardstep_core::{Kernel, LengthError, dispatch};

/// Reference dynamics whose right-hand side is compiled for every instruction set. They stand behind a pointer, and nothing can be
/// inlined through one: the choice has to be made on this side of it, where the compiler knows what is called.
pub(super) struct Dispatched<F>(pub(super) F);

impl<F: Reference> Reference for Dispatched<F> {
    type Exchange = F::Exchange;

    fn agents(&self) -> usize {
        self.0.agents()
    }

    fn vectors(&self) -> usize {
        self.0.vectors()
    }

    fn derivatives(&self) -> usize {
        self.0.derivatives()
    }

    fn sliding(&self) -> Option<&Sliding> {
        self.0.sliding()
    }

    fn is_affine(&self) -> bool {
        self.0.is_affine()
    }

    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        heard: Heard<'_, F::Exchange>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        dispatch(Evaluate { reference: &self.0, axes, measured, state, heard, out })
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        heard: Heard<'_, F::Exchange>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        self.0.start(axes, measured, given, heard, state)
    }

    fn initial_message(&self, wanted: &[Vec<f64>], message: &mut [f64]) {
        self.0.initial_message(wanted, message)
    }
}

struct Evaluate<'a, 'h, F: Reference> {
    reference: &'a F,
    axes: usize,
    measured: Measured<'a>,
    state: &'a [f64],
    heard: Heard<'h, F::Exchange>,
    out: ReferenceOut<'a>,
}

impl<F: Reference> Kernel for Evaluate<'_, '_, F> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        self.reference.evaluate(self.axes, self.measured, self.state, self.heard, self.out)
    }
}
