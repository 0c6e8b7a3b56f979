//! Tracking laws: what makes q̇ follow the reference velocity z.

mod bounds;
mod slotine_li;

pub use bounds::ParameterBounds;
pub use slotine_li::{SlotineLi, SlotineLiOutput};
