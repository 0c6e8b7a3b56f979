//! What errors call the numbers of a sensor of velocities.

/// What is said of a sensor of velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VelocityQuantity {
    /// [`crate::Sensors::velocity_noise`].
    Noise,
    /// [`crate::Sensors::tip_velocity_noise`].
    TipNoise,
    /// [`crate::Sensors::velocity_quantum`].
    Step,
    /// [`crate::VelocitySensor::Filtered`].
    CutOff,
}

impl VelocityQuantity {
    pub(super) fn key(self) -> &'static str {
        match self {
            VelocityQuantity::Noise => "noise.velocity",
            VelocityQuantity::TipNoise => "noise.tip_velocity",
            VelocityQuantity::Step => "quantisation.velocity",
            VelocityQuantity::CutOff => "velocity",
        }
    }

    /// What it is called in messages.
    pub fn words(self) -> &'static str {
        match self {
            VelocityQuantity::Noise => "the noise of velocities",
            VelocityQuantity::TipNoise => "the noise of the velocities of end-effectors",
            VelocityQuantity::Step => "the step of velocities",
            VelocityQuantity::CutOff => "the cut-off of the filter of velocities",
        }
    }
}
