//! What is derived holds along real runs, to rounding: reference dynamics, upper subsystem, and every reduction of it.
//!
//! At a row of a recording all that a run knows is known: positions, velocities, z with the derivatives that are states, what was
//! heard, and the acceleration, from the torque. z^(ℓ) is what the reference dynamics of the core give there. Derivatives of s beyond the
//! first depend on derivatives of the torque; they cancel, so any numbers stand for them.

mod families;
mod moment;
mod plants;
mod residuals;
