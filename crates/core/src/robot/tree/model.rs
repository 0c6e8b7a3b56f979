//! The immutable model of a tree.

/// A fixed-base tree of rigid bodies, ready for the kernels.
#[derive(Clone, Debug)]
pub struct Tree {}
