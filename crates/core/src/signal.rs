//! What can be told of an agent at one instant: the names that states, inputs and tables share.

use alloc::format;
use alloc::string::String;

/// A quantity of an agent, an entry per axis unless it says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Signal {
    /// q, or x for what is no robot arm.
    Position,
    /// q̇.
    Velocity,
    /// d^k q/dt^k, k ≥ 2, of a plant of higher order.
    Derivative(u8),
    /// x_k, k ≥ 2, of a chain whose states are no derivatives of each other.
    Coordinate(u8),
    /// z^(k): k = 0 the reference velocity z, k = 1 the reference acceleration ż, … up to the larger of 1 and ℓ − 1.
    Reference(u8),
    /// ς, the value of a set-valued sign, within [−1, 1].
    Selection,
    /// s = q̇ − z, or d^(k−1)x/dt^(k−1) − z for a plant of order k; under backstepping the errors of all its steps.
    TrackingError,
    /// τ, or any other input u, after any limit.
    Torque,
    /// ϑ̂, an entry per parameter; absent when ϑ is known.
    Estimate,
    /// The Lyapunov-like function of the proof that covers the agent; ½ sᵀ M s + ½ Δϑᵀ Γ⁻¹ Δϑ under (6)–(7). One entry.
    Lyapunov,
    /// The integral of what the Lyapunov-like function loses by its proof; present when the ledger is on. One entry.
    Dissipation,
    /// τ_ext; only of agents that are pushed.
    External,
    /// What is to vanish: x − x_d, Δq_v, q − q₀, …; only of agents with a target or a leader.
    Error,
    /// d, the offset of an agent from where all agree; only of agents that have one.
    Offset,
    /// y, the output of a filter that stands in for a velocity that is not measured.
    Filter,
    /// What the law divides by, which must stay away from zero. One entry.
    Divisor,
    /// The attitude as a quaternion (q_v, q_o), four entries.
    Attitude,
    /// ω in the body's axes.
    AngularVelocity,
    /// The ω that an outer law wants, where torques have to bring it about.
    AngularVelocityWanted,
    /// σ, the thrust. One entry.
    Thrust,
    /// The heading that is kept, an angle. One entry.
    Heading,
    /// ẏ of such a filter where the law uses it.
    FilterRate,
    /// q_z, the attitude that turns with the reference velocity.
    ReferenceAttitude,
    /// The angle between an attitude and the desired one, in [0, π]. One entry.
    Angle,
    /// u, the torque of the motor of each reaction wheel, after any limit.
    WheelTorque,
    /// h_w, the momentum of each reaction wheel about its axis.
    WheelMomentum,
    /// x, the position of a tip in task space.
    TaskPosition,
    /// θ̂, the estimate of kinematic parameters, an entry each.
    KinematicEstimate,
    /// det Ĵ of the estimated Jacobian. One entry.
    Determinant,
}

impl Signal {
    /// The name used in column headers: `q`, `dq`, `z`, `dz`, `d2z`, …, `sign`, `s`, `tau`, `theta_hat`, `lyapunov`,
    /// `dissipation`, `tau_ext`, `error`, `offset`, `y`, `attitude`, `omega`, `omega_wanted`, `sigma`, `heading`, `dy`, `q_z`,
    /// `angle`, `wheel_torque`, `wheel_momentum`, `x`, `kinematic_hat`, `det_jacobian`, `divisor`; `d2q`, … and
    /// `x2`, … for chains.
    pub fn name(self) -> String {
        match self {
            Signal::Position => "q".into(),
            Signal::Velocity => "dq".into(),
            Signal::Derivative(k) => format!("d{k}q"),
            Signal::Coordinate(k) => format!("x{k}"),
            Signal::Reference(0) => "z".into(),
            Signal::Reference(1) => "dz".into(),
            Signal::Reference(k) => format!("d{k}z"),
            Signal::Selection => "sign".into(),
            Signal::TrackingError => "s".into(),
            Signal::Torque => "tau".into(),
            Signal::Estimate => "theta_hat".into(),
            Signal::Lyapunov => "lyapunov".into(),
            Signal::Dissipation => "dissipation".into(),
            Signal::External => "tau_ext".into(),
            Signal::Error => "error".into(),
            Signal::Offset => "offset".into(),
            Signal::Filter => "y".into(),
            Signal::Divisor => "divisor".into(),
            Signal::Attitude => "attitude".into(),
            Signal::AngularVelocity => "omega".into(),
            Signal::AngularVelocityWanted => "omega_wanted".into(),
            Signal::Thrust => "sigma".into(),
            Signal::Heading => "heading".into(),
            Signal::FilterRate => "dy".into(),
            Signal::ReferenceAttitude => "q_z".into(),
            Signal::Angle => "angle".into(),
            Signal::WheelTorque => "wheel_torque".into(),
            Signal::WheelMomentum => "wheel_momentum".into(),
            Signal::TaskPosition => "x".into(),
            Signal::KinematicEstimate => "kinematic_hat".into(),
            Signal::Determinant => "det_jacobian".into(),
        }
    }
}

/// A block of numbers that are one signal, and how many they are.
pub type Block = (Signal, usize);
