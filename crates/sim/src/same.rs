//! Whether two trait objects are the same value.

use std::any::Any;

/// Equality behind a trait object: whatever has `==` has it.
pub trait Same: Any {
    /// Whether `other` is of the same type, and equal.
    fn same(&self, other: &dyn Any) -> bool;
}

impl<T: PartialEq + Any> Same for T {
    fn same(&self, other: &dyn Any) -> bool {
        other.downcast_ref() == Some(self)
    }
}
