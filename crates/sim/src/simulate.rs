//! From a setup to an outcome.
