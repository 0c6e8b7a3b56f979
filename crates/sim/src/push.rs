//! What acts on robots from outside: forces, torques, springs and disturbances, as plain data.
//!
//! A push adds to what [`Attachments::blocks`] lists of one agent between two instants and nothing outside them. Where it begins and ends, and
//! where a table has a row, steps of the integrator end; between such instants a push is evaluated by the piece in force, so
//! that no step ever sees both sides of a jump.

use forwardstep_core::expression::Expression;
use forwardstep_core::plant::total;
use forwardstep_core::robot::PlanarTip;
use forwardstep_core::robot::tree::{Axes, LinkPoint};
use thiserror::Error;

use crate::formula::kinks_s;
use crate::setup::RobotSetup;
use crate::system::Attachments;

/// Something that acts on an agent for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Push {
    /// What it does.
    pub effect: Effect,
    /// When it begins, s.
    pub from_s: f64,
    /// When it ends, s; infinite for never.
    pub until_s: f64,
}

/// What a push does.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// τ_ext itself, N m or N, or disturbances: a component for every entry of [`Attachments::blocks`].
    Torque(Course),
    /// A force and a moment at a point: τ_ext = Jᵀw. The components are those of [`AttachmentPoint::wrench_components`].
    Wrench {
        /// Where it acts, and in which axes.
        at: AttachmentPoint,
        /// Components in N, then N m.
        wrench: Course,
    },
    /// Springs and dampers on some axes: τ_ext = k (q_h(t) − q) − d q̇ on each of them.
    SpringOnAxes {
        /// The axes held, from zero.
        axes: Vec<usize>,
        /// k of each, N m/rad or N/m.
        stiffness: Vec<f64>,
        /// d of each, N m s/rad or N s/m.
        damping: Vec<f64>,
        /// q_h of each, rad or m.
        target: Course,
    },
    /// A spring and a damper on a point: τ_ext = Jᵀf with f = k (x_h(t) − x) − d ẋ in base axes.
    SpringOnPoint {
        /// Where it is attached.
        at: AttachmentPoint,
        /// k, N/m.
        stiffness: f64,
        /// d, N s/m.
        damping: f64,
        /// x_h, m; components as in [`AttachmentPoint::point_components`].
        target: Course,
    },
}

/// A place on a robot where something can hold or push it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AttachmentPoint {
    /// A point of a link of a tree.
    Link {
        /// The point.
        point: LinkPoint,
        /// What the components of a force refer to.
        axes: Axes,
    },
    /// The tip of a planar arm.
    Tip(PlanarTip),
}

impl AttachmentPoint {
    /// How many components a force with its moment has: f_x, f_y, f_z, n_x, n_y, n_z on a link; f_x, f_y, n on a planar arm.
    pub fn wrench_components(&self) -> usize {
        match self {
            AttachmentPoint::Link { .. } => 6,
            AttachmentPoint::Tip(_) => 3,
        }
    }

    /// How many components a position has.
    pub fn point_components(&self) -> usize {
        match self {
            AttachmentPoint::Link { .. } => 3,
            AttachmentPoint::Tip(_) => 2,
        }
    }
}

/// Several numbers as functions of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// Each by itself.
    Each(Vec<Function>),
    /// All of them from a table. It says something from its first row to its last; outside, the push does not act.
    Table(Table),
}

/// One number as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Function {
    /// Always the same.
    Constant(f64),
    /// A formula in t, the only variable.
    Formula(Expression),
}

/// Numbers at given times.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The times of the rows, s, rising; at least two.
    pub times_s: Vec<f64>,
    /// The rows, one after the other.
    pub values: Vec<f64>,
    /// What holds between two rows.
    pub between: Between,
}

/// What a table says between two rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// The straight line from row to row.
    Linear,
    /// The earlier row. The last row only says when the one before it ends.
    Hold,
}

impl Table {
    /// How many numbers a row has.
    pub fn components(&self) -> usize {
        self.values.len() / self.times_s.len().max(1)
    }

    /// Component `k` at `t_s` by the formula of the piece between the rows `piece` and `piece + 1`.
    pub(crate) fn value_on(&self, piece: usize, k: usize, t_s: f64) -> f64 {
        let width = self.components();
        let here = self.values[piece * width + k];
        match self.between {
            Between::Hold => here,
            Between::Linear => {
                let (start_s, end_s) = (self.times_s[piece], self.times_s[piece + 1]);
                here + (self.values[(piece + 1) * width + k] - here) * ((t_s - start_s) / (end_s - start_s))
            }
        }
    }
}

impl Course {
    /// How many numbers.
    pub fn components(&self) -> usize {
        match self {
            Course::Each(functions) => functions.len(),
            Course::Table(table) => table.components(),
        }
    }

    /// Where its formulas have kinks within a span, s, rising. Those that cannot be told apart are left to the error control:
    /// the value is continuous.
    pub(crate) fn kinks_s(&self, [from_s, until_s]: [f64; 2]) -> Vec<f64> {
        let Course::Each(functions) = self else { return Vec::new() };
        let found = functions.iter().filter(|_| from_s < until_s).flat_map(|function| match function {
            Function::Constant(_) => Vec::new(),
            Function::Formula(formula) => kinks_s(formula, from_s, until_s).unwrap_or_default(),
        });
        let mut all: Vec<f64> = found.collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// Component `k` at `t_s` by the formula of the piece in force.
    pub(crate) fn value_on(&self, piece: usize, k: usize, t_s: f64) -> f64 {
        match self {
            Course::Each(functions) => match &functions[k] {
                Function::Constant(value) => *value,
                Function::Formula(formula) => formula.eval(t_s),
            },
            Course::Table(table) => table.value_on(piece, k, t_s),
        }
    }
}

impl Push {
    /// From when until when it acts, s: its own times and those of its table. The end is infinite when it never ends.
    pub fn span_s(&self) -> [f64; 2] {
        match self.course() {
            Course::Table(Table { times_s, .. }) => match times_s.as_slice() {
                [first, .., last] => [self.from_s.max(*first), self.until_s.min(*last)],
                _ => [self.from_s, self.from_s],
            },
            Course::Each(_) => [self.from_s, self.until_s],
        }
    }

    /// The functions of time in it.
    pub fn course(&self) -> &Course {
        match &self.effect {
            Effect::Torque(course)
            | Effect::Wrench { wrench: course, .. }
            | Effect::SpringOnAxes { target: course, .. }
            | Effect::SpringOnPoint { target: course, .. } => course,
        }
    }

    /// Whether it depends on how the robot moves.
    pub fn is_spring(&self) -> bool {
        matches!(self.effect, Effect::SpringOnAxes { .. } | Effect::SpringOnPoint { .. })
    }

    /// Whether it has a meaning for `robot`.
    ///
    /// # Errors
    /// [`PushError`] for the first thing that has none.
    pub fn check(&self, robot: &RobotSetup) -> Result<(), PushError> {
        let axes = robot.axes.len();
        if !(self.from_s.is_finite() && self.from_s <= self.until_s) {
            return Err(PushError::Times { from_s: self.from_s, until_s: self.until_s });
        }
        let length = |what, need, got| {
            if need == got { Ok(()) } else { Err(PushError::Length { what, need, got }) }
        };
        match &self.effect {
            Effect::Torque(course) => {
                length("the torque", total(&robot.interface().attachments.blocks(axes)), course.components())?;
            }
            Effect::Wrench { at, wrench } => {
                at.check(robot)?;
                length("the wrench", at.wrench_components(), wrench.components())?;
            }
            Effect::SpringOnAxes { axes: held, stiffness, damping, target } => {
                let springs = !matches!(robot.interface().attachments, Attachments::Equations(_));
                if !springs || robot.velocity_len() != axes {
                    return Err(PushError::NoSpring);
                }
                if let Some(axis) = held.iter().find(|axis| **axis >= axes) {
                    return Err(PushError::NoSuchAxis { axis: *axis, axes });
                }
                length("the stiffness", held.len(), stiffness.len())?;
                length("the damping", held.len(), damping.len())?;
                length("the target", held.len(), target.components())?;
                stiffness.iter().chain(damping).try_for_each(|value| not_negative(*value))?;
            }
            Effect::SpringOnPoint { at, stiffness, damping, target } => {
                at.check(robot)?;
                not_negative(*stiffness)?;
                not_negative(*damping)?;
                length("the target", at.point_components(), target.components())?;
            }
        }
        match self.course() {
            Course::Each(functions) => functions.iter().try_for_each(|function| match function {
                Function::Constant(value) => finite(*value),
                // Where a formula has no value the run breaks down and says so.
                Function::Formula(_) => Ok(()),
            }),
            Course::Table(table) => {
                table.times_s.iter().chain(&table.values).try_for_each(|value| finite(*value))?;
                let rising = table.times_s.windows(2).all(|pair| pair[0] < pair[1]);
                let whole = table.values.len() == table.components() * table.times_s.len();
                if rising && whole && table.times_s.len() >= 2 { Ok(()) } else { Err(PushError::Table) }
            }
        }
    }
}

impl AttachmentPoint {
    fn check(&self, robot: &RobotSetup) -> Result<(), PushError> {
        match (self, robot.interface().attachments) {
            (AttachmentPoint::Link { point, .. }, Attachments::Links(tree)) => {
                if let Some(body) = point.link.body.filter(|body| *body >= tree.joint_count()) {
                    return Err(PushError::NoSuchBody { body, bodies: tree.joint_count() });
                }
                point.at.iter().try_for_each(|value| finite(*value))
            }
            (AttachmentPoint::Tip(tip), Attachments::PlanarTip) => {
                tip.length_m.iter().try_for_each(|value| finite(*value))
            }
            _ => Err(PushError::AttachmentPoint),
        }
    }
}

fn finite(value: f64) -> Result<(), PushError> {
    if value.is_finite() { Ok(()) } else { Err(PushError::NotFinite { value }) }
}

fn not_negative(value: f64) -> Result<(), PushError> {
    if value.is_finite() && value >= 0.0 { Ok(()) } else { Err(PushError::Negative { value }) }
}

/// Why a push has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PushError {
    /// It ends before it begins.
    #[error("it acts from {from_s} s until {until_s} s; the first must be finite and not exceed the second")]
    Times {
        /// When it begins.
        from_s: f64,
        /// When it ends.
        until_s: f64,
    },
    /// The wrong number of components.
    #[error("{what} has {got} components, but needs {need}")]
    Length {
        /// Of what.
        what: &'static str,
        /// How many are needed.
        need: usize,
        /// How many there are.
        got: usize,
    },
    /// An axis that the robot has not.
    #[error("it holds axis {axis}, counted from 0, of a robot with {axes} axes")]
    NoSuchAxis {
        /// The axis.
        axis: usize,
        /// How many there are.
        axes: usize,
    },
    /// A spring on axes that no force moves.
    #[error("a virtual spring holds axes that forces move, and this robot has none")]
    NoSpring,
    /// A moving body that the robot has not.
    #[error("it acts on moving body {body}, counted from 0, of a robot with {bodies}")]
    NoSuchBody {
        /// The body.
        body: usize,
        /// How many there are.
        bodies: usize,
    },
    /// A place that this robot has not.
    #[error("it grips a robot of another kind: links belong to trees, end-effectors to planar arms")]
    AttachmentPoint,
    /// A stiffness or damping that is negative.
    #[error("a stiffness or damping is {value}, but must be finite and not negative")]
    Negative {
        /// The value.
        value: f64,
    },
    /// A number that is not finite.
    #[error("it holds {value}, which is not a finite number")]
    NotFinite {
        /// The value.
        value: f64,
    },
    /// An incomplete table.
    #[error("its table needs at least two complete rows, with times that rise")]
    Table,
}
