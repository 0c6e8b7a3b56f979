//! Reference dynamics.
