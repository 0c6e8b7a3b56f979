//! What can be told of an agent at one instant: the signals that states, inputs, tables and reports share, as one table.

use alloc::format;
use alloc::string::String;
use core::fmt;

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
    /// v_{k+1}, k ≥ 1, which is integrated in the place of z^(k) where desired dynamics are written in x alone.
    ReferenceIntegral(u8),
    /// ς, the value of a set-valued sign, within [−1, 1].
    Selection,
    /// x̂, where an agent that observes its leader believes it to be.
    LeaderPosition,
    /// v̂, how fast it believes it to move.
    LeaderVelocity,
    /// y = ż + β z + α q, which agents that follow a leader by one vector tell.
    Composite,
    /// s = q̇ − z, or d^(k−1)x/dt^(k−1) − z for a plant of order k; under backstepping the errors of all its steps.
    TrackingError,
    /// τ, or any other input u, after any limit.
    Torque,
    /// ϑ̂, an entry per parameter; absent when ϑ is known.
    Estimate,
    /// The Lyapunov-like function of the proof that covers the agent; ½ sᵀ M s + ½ Δϑᵀ Γ⁻¹ Δϑ under (6)–(7). One entry.
    Lyapunov,
    /// The integral of what the Lyapunov-like function loses by its proof; present when the balance is on. One entry.
    Dissipation,
    /// τ_ext, a torque or force on every axis; only of agents that are pushed.
    External,
    /// A torque from outside about the axes of a body; only of agents that are pushed.
    ExternalTorque,
    /// What is added to the equations of a chain from outside; only of agents that are pushed.
    Disturbance,
    /// What is to vanish: x − x_d, Δq_v, q − q₀, …; only of agents with a target or a leader.
    Error,
    /// d, the offset of an agent from where all agree; only of agents that have one.
    Offset,
    /// y, the output of a filter that stands in for a velocity that is not measured.
    Filter,
    /// What the law divides by, which must stay away from zero; of a matrix that it inverts, the smallest singular value. One entry.
    Divisor,
    /// The attitude as a quaternion (q_v, q_o), four entries.
    Attitude,
    /// ω in the body's axes.
    AngularVelocity,
    /// The ω that an outer law wants, where torques have to bring it about.
    AngularVelocityWanted,
    /// σ, the thrust. One entry.
    Thrust,
    /// σ̇, the rate of the thrust where that is an input. One entry.
    ThrustRate,
    /// ẍ as it is measured; only of laws that measure it.
    Acceleration,
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
    /// ẋ, the measured velocity of a tip; only of laws that measure it.
    TaskVelocity,
    /// θ̂, the estimate of kinematic parameters, an entry each.
    KinematicEstimate,
    /// det Ĵ of the estimated Jacobian. One entry.
    Determinant,
    /// The smallest singular value of the estimated Jacobian, of tips with poses or redundant joints. One entry.
    SingularValue,
    /// Δq_o beside Δq_v, of the same sign along the whole run as at its start. One entry.
    ErrorScalar,
    /// A signal that a kind of one's own brings.
    Own(&'static OwnSignal),
}

/// A signal that a kind of one's own brings: it is recorded, named, drawn and read back like the others.
///
/// ```
/// use forwardstep_core::signal::{Entries, OwnSignal, Signal, Unit};
///
/// static LEVEL: OwnSignal = OwnSignal {
///     symbol: "level",
///     title: "Level of the tank",
///     letters: "h",
///     unit: Unit::Fixed("m"),
///     entries: Entries::One,
///     may_jump: true,
/// };
/// let row = Signal::Own(&LEVEL).row();
/// assert_eq!((row.symbol.as_str(), row.unit, row.entries, row.may_jump), ("level", LEVEL.unit, LEVEL.entries, true));
/// ```
#[derive(Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct OwnSignal {
    /// In column headers: letters, digits and `_`, and none of the symbols that the other signals have.
    pub symbol: &'static str,
    /// The title of its card in reports.
    pub title: &'static str,
    /// Its letters there.
    pub letters: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// What its entries are.
    pub entries: Entries,
    /// Whether it may jump, as what follows messages at once does.
    pub may_jump: bool,
}

/// The unit of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unit {
    /// This one.
    Fixed(&'static str),
    /// That of the axis by s to this power: rad, m/s, ….
    Axis(u8),
    /// That of what follows a target.
    Target,
    /// That of a force or torque on the axis: N or N m.
    Effort,
    /// The same, unless the robot has its torques about the axes of its body.
    Torque,
    /// m to the power of the number of axes.
    Volume,
}

/// What the entries of a signal are called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Entries {
    /// There is one, without a name.
    One,
    /// An entry for every axis, called like it.
    Axes,
    /// An entry for every coordinate that follows a target; those are the axes unless the law has others.
    Coordinates,
    /// An entry for every parameter of the robot.
    Parameters,
    /// An entry for every uncertain parameter of the coordinates that follow a target.
    CoordinateParameters,
    /// They have numbers, from one; each is a `wheel`, for example.
    Numbered(&'static str),
    /// They have these names.
    Named(&'static [&'static str]),
}

/// Where a report draws a signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// Among those that every system has.
    WithAll,
    /// On a card of its own.
    Card {
        /// The title of the card.
        title: &'static str,
        /// The letters.
        letters: String,
        /// Drawn dashed beside it.
        beside: Option<Signal>,
    },
    /// Dashed on the card of another.
    Beside,
}

/// A row of the table of signals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// In column headers.
    pub symbol: String,
    /// Its unit.
    pub unit: Unit,
    /// What its entries are.
    pub entries: Entries,
    /// Whether it may jump: it follows what is heard, or a limit, at once.
    pub may_jump: bool,
    /// Where it is drawn.
    pub drawn: Drawn,
}

impl Row {
    fn new(symbol: impl Into<String>, unit: Unit, entries: Entries, drawn: Drawn) -> Self {
        Row { symbol: symbol.into(), unit, entries, may_jump: false, drawn }
    }

    fn jumps(self) -> Self {
        Row { may_jump: true, ..self }
    }
}

fn card(title: &'static str, letters: impl Into<String>) -> Drawn {
    Drawn::Card { title, letters: letters.into(), beside: None }
}

fn card_with(title: &'static str, letters: &str, beside: Signal) -> Drawn {
    Drawn::Card { title, letters: letters.into(), beside: Some(beside) }
}

impl Signal {
    /// Its row in the table of signals, which is this.
    #[rustfmt::skip]
    pub fn row(self) -> Row {
        use Drawn::{Beside, WithAll};
        use Entries::{Axes, CoordinateParameters, Coordinates, Named, Numbered, One, Parameters};
        use Unit::{Axis, Effort, Fixed, Target, Torque, Volume};
        match self {
            Signal::Position => Row::new("q", Axis(0), Axes, WithAll),
            Signal::Velocity => Row::new("dq", Axis(1), Axes, WithAll),
            Signal::Derivative(k) => Row::new(format!("d{k}q"), Axis(k), Axes, card("Higher derivatives", format!("q⁽{}⁾", superscript(k)))),
            Signal::Coordinate(k) => Row::new(format!("x{k}"), Fixed("SI"), Axes, card("States of the chain", format!("x{k}"))),
            Signal::Reference(0) => Row::new("z", Axis(1), Axes, WithAll),
            Signal::Reference(1) => Row::new("dz", Axis(2), Axes, WithAll).jumps(),
            Signal::Reference(k) => Row::new(format!("d{k}z"), Axis(k.saturating_add(1)), Axes, WithAll).jumps(),
            Signal::ReferenceIntegral(k) => Row::new(format!("v{}", k.saturating_add(1)), Axis(k.saturating_add(1)), Axes, card("Integrals of the reference", "v, in the place of derivatives of z")).jumps(),
            Signal::Selection => Row::new("selection", Fixed("1"), Axes, card("Set-valued sign", "ς, within [−1, 1]")).jumps(),
            Signal::LeaderPosition => Row::new("leader_q", Axis(0), Axes, card("Where the leader is thought to be", "x̂, as estimated")),
            Signal::LeaderVelocity => Row::new("leader_dq", Axis(1), Axes, card("How fast the leader is thought to move", "v̂, as estimated")),
            Signal::Composite => Row::new("composite", Axis(2), Axes, card("What agents tell of the leader", "y = ż + β z + α q")),
            Signal::TrackingError => Row::new("s", Axis(1), Axes, WithAll),
            Signal::Torque => Row::new("tau", Torque, Axes, WithAll).jumps(),
            Signal::Estimate => Row::new("theta_hat", Fixed("SI"), Parameters, WithAll),
            Signal::Lyapunov => Row::new("lyapunov", Fixed("J"), One, WithAll),
            Signal::Dissipation => Row::new("dissipation", Fixed("J"), One, WithAll),
            Signal::External => Row::new("tau_ext", Effort, Axes, WithAll).jumps(),
            Signal::ExternalTorque => Row::new("tau_ext_body", Fixed("N m"), Named(&["x", "y", "z"]), card("External torques on the body", "about its axes, by pushes")).jumps(),
            Signal::Disturbance => Row::new("w", Fixed("SI"), Numbered("equation"), card("Disturbances", "w, added to the equations")).jumps(),
            Signal::Error => Row::new("error", Target, Coordinates, card("Distance from the target", "what is to vanish")),
            Signal::Offset => Row::new("offset", Axis(0), Axes, card("Offset in the formation", "d")),
            Signal::Filter => Row::new("y", Axis(1), Axes, card("Filter in place of the velocity", "y")),
            Signal::FilterRate => Row::new("dy", Fixed("J^0.5"), Axes, card("Rate of the filter", "ẏ")),
            Signal::Divisor => Row::new("divisor", Fixed("SI"), One, card("What the law divides by", "must stay away from zero")),
            Signal::Attitude => Row::new("attitude", Fixed("1"), Named(&["x", "y", "z", "o"]), card_with("Attitude", "quaternion (q_v, q_o)", Signal::ReferenceAttitude)),
            Signal::ReferenceAttitude => Row::new("q_z", Fixed("1"), Axes, Beside),
            Signal::AngularVelocity => Row::new("omega", Fixed("rad/s"), Axes, card_with("Angular velocity", "ω in the body’s axes", Signal::AngularVelocityWanted)).jumps(),
            Signal::AngularVelocityWanted => Row::new("omega_commanded", Fixed("rad/s"), Axes, Beside).jumps(),
            Signal::Thrust => Row::new("sigma", Fixed("N"), One, card("Thrust", "σ")),
            Signal::ThrustRate => Row::new("d_sigma", Fixed("N/s"), One, card("Rate of the thrust", "σ̇, as asked for")).jumps(),
            Signal::Acceleration => Row::new("ddx", Axis(2), Axes, card("Measured acceleration", "ẍ")),
            Signal::Heading => Row::new("heading", Fixed("rad"), One, card("Heading", "about the vertical")),
            Signal::Angle => Row::new("angle", Fixed("rad"), One, card("Angle to the target’s attitude", "from 0 to π")),
            Signal::WheelTorque => Row::new("wheel_torque", Fixed("N m"), Numbered("wheel"), card("Torques of the wheels", "u, after any limit")).jumps(),
            Signal::WheelMomentum => Row::new("wheel_momentum", Fixed("N m s"), Numbered("wheel"), card("Momenta of the wheels", "h_w")),
            Signal::TaskPosition => Row::new("x", Fixed("m"), Coordinates, card("Position of the end-effector", "x")),
            Signal::TaskVelocity => Row::new("dx", Fixed("m/s"), Coordinates, card("Measured velocity of the end-effector", "ẋ")).jumps(),
            Signal::KinematicEstimate => Row::new("kinematic_hat", Fixed("m"), CoordinateParameters, card("Estimated lengths", "θ̂")),
            Signal::Determinant => Row::new("det_jacobian", Volume, One, card("Regularity of the estimated Jacobian", "det Ĵ")),
            Signal::SingularValue => Row::new("sigma_min_jacobian", Fixed("SI"), One, card("Regularity of the estimated Jacobian", "smallest singular value of Ĵ")),
            Signal::ErrorScalar => Row::new("error_scalar", Fixed("1"), One, card("Scalar part of the attitude error", "Δq_o; 1 and −1 are the target’s attitude")),
            Signal::Own(own) => Row { may_jump: own.may_jump, ..Row::new(own.symbol, own.unit, own.entries, card(own.title, own.letters)) },
        }
    }

    /// The name used in column headers: `q`, `dq`, `z`, `dz`, `d2z`, …, `tau`, ….
    pub fn name(self) -> String {
        self.row().symbol
    }
}

/// A whole number in raised digits; what is no digit and no minus stays as it is.
pub fn superscript(number: impl fmt::Display) -> String {
    let raised = |digit: char| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => digit.to_digit(10).and_then(|digit| char::from_u32(u32::from('⁰') + digit)).unwrap_or(digit),
    };
    format!("{number}").chars().map(raised).collect()
}

/// A block of numbers that are one signal, and how many they are.
pub type Block = (Signal, usize);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_follows_messages_or_limits_at_once_may_jump() {
        let jumps = |signal: Signal| signal.row().may_jump;
        let at_once = [Signal::Torque, Signal::External, Signal::Reference(1), Signal::Reference(2), Signal::Selection];
        let wheels = [
            Signal::ExternalTorque,
            Signal::Disturbance,
            Signal::WheelTorque,
            Signal::AngularVelocity,
            Signal::AngularVelocityWanted,
        ];
        assert!(at_once.into_iter().chain(wheels).all(jumps));
        let states = [Signal::Position, Signal::Velocity, Signal::Reference(0), Signal::WheelMomentum, Signal::Thrust];
        assert!(!states.into_iter().any(jumps));
    }

    #[test]
    fn numbered_signals_say_their_number() {
        let name = |signal: Signal| signal.name();
        assert_eq!([0, 1, 2, 3].map(Signal::Reference).map(name), ["z", "dz", "d2z", "d3z"]);
        assert_eq!([Signal::Derivative(2), Signal::Coordinate(3)].map(name), ["d2q", "x3"]);
        let Drawn::Card { letters, .. } = Signal::Derivative(12).row().drawn else { panic!("no card") };
        assert_eq!(letters, "q⁽¹²⁾");
        assert_eq!((superscript(145), superscript(-12)), ("¹⁴⁵".into(), "⁻¹²".into()));
    }
}
