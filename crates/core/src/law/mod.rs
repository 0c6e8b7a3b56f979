//! Tracking laws.
