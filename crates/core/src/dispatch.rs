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

/// The vector instructions of this processor, asked for once. For kernels that work in [`Lanes`](crate::Lanes).
///
/// Without vector instructions a lane costs what a robot by itself costs, and a copy of the kernel for such processors would
/// be the longest of all: none is made.
#[derive(Clone, Copy, Debug)]
pub struct Vectors(Set);

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[derive(Clone, Copy, Debug)]
enum Set {
    V3(pulp::x86::V3),
    V4(pulp::x86::V4),
}

/// What every processor of this kind has, or what the compiler was told.
#[cfg(not(all(feature = "std", target_arch = "x86_64")))]
#[derive(Clone, Copy, Debug)]
struct Set;

impl Vectors {
    /// The widest that this processor has; `None` when it has none.
    pub fn of_this_processor() -> Option<Self> {
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        match pulp::Arch::new() {
            pulp::Arch::V4(simd) => Some(Vectors(Set::V4(simd))),
            pulp::Arch::V3(simd) => Some(Vectors(Set::V3(simd))),
            _ => None,
        }
        #[cfg(not(all(feature = "std", target_arch = "x86_64")))]
        {
            Some(Vectors(Set))
        }
    }

    /// Runs `kernel` compiled for these instructions. The bits are those of [`dispatch`].
    #[inline(never)]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        match self.0 {
            Set::V4(simd) => pulp::Simd::vectorize(simd, OnSimd(kernel)),
            Set::V3(simd) => pulp::Simd::vectorize(simd, OnSimd(kernel)),
        }
        #[cfg(not(all(feature = "std", target_arch = "x86_64")))]
        {
            dispatch(kernel)
        }
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
