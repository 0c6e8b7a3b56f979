//! Tracking laws: what makes q̇ follow the reference velocity z.

mod slotine_li;

pub use slotine_li::{SlotineLi, SlotineLiOutput};
