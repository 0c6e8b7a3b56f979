//! Tracking laws: what makes q̇ follow the reference velocity z.

mod bounds;
mod clamped;
mod slotine_li;

pub use bounds::ParameterBounds;
pub use clamped::Range;
pub use slotine_li::{SlotineLi, SlotineLiOutput};
