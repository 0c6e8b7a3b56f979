//! One choice, at run time, of the widest instruction set the processor has.
//!
//! A kernel is compiled once per instruction set and only gains from it where every function on the way down is
//! `#[inline(always)]` and no closure stands in between: hence a named struct with [`Kernel::run`] and not a closure.

/// A computation to be compiled for several instruction sets.
///
/// [`Kernel::run`] and everything it calls should be `#[inline(always)]`.
pub trait Kernel {
    /// What the computation returns.
    type Output;
    /// The computation.
    fn run(self) -> Self::Output;
}

/// Runs `kernel` compiled for the best instruction set of this processor. The bits do not depend on the choice.
///
/// Never inlined: the copy for processors without vector instructions is the longest of all, and would otherwise stand in
/// every caller.
#[inline(never)]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(feature = "std")]
    {
        pulp::Arch::new().dispatch(OnSimd(kernel))
    }
    #[cfg(not(feature = "std"))]
    {
        kernel.run()
    }
}

#[cfg(feature = "std")]
struct OnSimd<K>(K);

#[cfg(feature = "std")]
impl<K: Kernel> pulp::WithSimd for OnSimd<K> {
    type Output = K::Output;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        self.0.run()
    }
}
