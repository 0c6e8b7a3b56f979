//! What the layers below refuse: where in the scenario it stands, and what to do.

use forwardstep_core::controller::ChainError;
use forwardstep_core::expression::MOST_DERIVATIVES;
use forwardstep_core::reference::RootsError;
use forwardstep_sim::quantity::{QuantityError, Requirement, Sign, about};
use forwardstep_sim::{LimitError, Setup, SetupError};

use super::document::Document;
use super::fault::Fault;
use super::problem::ScenarioProblem;
use super::value_problem::ValueProblem;

impl Document<'_> {
    /// The error at its place in the file; `entries` has the entry of `[[agents]]` that stands for each agent.
    pub(super) fn refused(&self, setup: &Setup, entries: &[usize], error: SetupError) -> Fault {
        let place = self.place(&error.path(setup), entries);
        let fault = Fault::new(match error {
            SetupError::Quantity(error) => ValueProblem::Quantity(error).into(),
            error => ScenarioProblem::Setup(error),
        });
        place.iter().fold(fault, Fault::at)
    }

    /// What was checked, at its place in the file if it is about no single agent.
    pub(super) fn checked<T>(&self, checked: Result<T, QuantityError>) -> Result<T, Fault> {
        checked.map_err(|error| {
            let place = self.place(&error.path, &[]);
            place.iter().fold(Fault::new(ValueProblem::Quantity(error)), Fault::at)
        })
    }
}

/// What the user can do about a quantity out of its range.
pub(super) fn advice_on_quantity(error: &QuantityError) -> Option<String> {
    let text = match error.requirement {
        Requirement::Few { what: "samples", .. } => "sample more slowly, or let the run end sooner",
        Requirement::Few { what: "packets", .. } => {
            "take fewer links, a longer period or a shorter run; or is a unit of time mistaken? All of them are seconds"
        }
        Requirement::Few { .. } => "is a unit of time mistaken? All of them are seconds",
        Requirement::Within { high, .. } if error.path.name() == "computation_delay_s" && error.value > high => {
            "a computation must be done before the next begins; sample more slowly, or compute faster"
        }
        Requirement::Throughout { seen_s, .. } if seen_s.is_some() && !error.value.is_finite() => {
            "write a formula that is finite at all times"
        }
        Requirement::Throughout { must: Sign::NotNegative, .. } => {
            "write `max(0, …)` or `abs(…)` around it, or in a simpler way: bounds are best where t appears once"
        }
        Requirement::Throughout { must: Sign::Positive, .. } => {
            "write `max(0.1, …)` around it; an edge that is not there for a while is left out of a phase"
        }
        Requirement::AtMost { .. } if error.path.name() == "amplitude_s" => "a delay is never negative",
        _ => return None,
    };
    Some(text.into())
}

/// What the user can do about it.
pub(super) fn advice(error: &SetupError) -> Option<String> {
    Some(match error {
        SetupError::Coupling => {
            "write `exchange = \"position\"` in `reference.consensus`, or leave `coupling` out".to_owned()
        }
        SetupError::SendsPositionOnly { .. } => {
            "write `exchange = \"position\"`, or in `reference.desired` a single number in `heard`".to_owned()
        }
        SetupError::ReferenceOfLaw { .. } => "write `reference.consensus` with `exchange = \"position\"`".to_owned(),
        SetupError::NotTracking { .. } => {
            "write `reference.consensus`; laws that track are `adaptive`, `known`, `position_only`, `model_reference`, `task_space`, `attitude`, `passivity_filter` and those of chains".to_owned()
        }
        SetupError::OnlyTracks { .. } => "write `reference.tracking`, and give it a `target`".to_owned(),
        SetupError::StartOfReference { error, .. } => match error.need {
            0 => "leave it out: this law has no reference velocity of its own".to_owned(),
            1 => "leave `derivatives` out: z is all that this law integrates".to_owned(),
            need => format!("give `z` and at most {} of its derivatives", need - 1),
        },
        SetupError::TipVelocity { .. } => "leave `tip_velocity` out: Theorem 6 needs none".to_owned(),
        SetupError::UnusedEdges { .. } => "leave `network` out, or write `reference.consensus`".to_owned(),
        SetupError::VelocityUnused { filtered: true, .. } => {
            "delete it, or let `velocity` be \"measured\"; noise and steps of positions count".to_owned()
        }
        SetupError::VelocityUnused { .. } => "leave it out".to_owned(),
        SetupError::RootCount { error, .. } if error.need == 0 => {
            "leave `roots_per_s` out: this law has reference dynamics of its own".to_owned()
        }
        SetupError::Roots { error: RootsError::NoRealRoot, .. } => {
            "add a real root, or write `exchange = \"position\"`".to_owned()
        }
        SetupError::OrderTooLow { least, .. } => format!("give it {least} roots or more"),
        SetupError::RootCount { error, .. } => {
            format!("give it {} roots; an agent may have `reference` with roots of its own", error.need)
        }
        SetupError::Limit { error: LimitError::Torques(error) | LimitError::Rates(error), .. } => match error.need {
            0 => "leave it out: what this robot does is not asked of it as torques of its axes".to_owned(),
            _ => "a single number stands for all axes".to_owned(),
        },
        SetupError::TargetDerivatives { known, .. } if *known < MOST_DERIVATIVES => format!(
            "give at most {known} roots, or the target as a formula: a curve through points has {known} derivatives, a formula as many \
             as are asked for"
        ),
        SetupError::TargetDerivatives { known, .. } => format!("give at most {known} roots"),
        SetupError::Chain { error: ChainError::ReferenceModel(_), .. } => {
            "an agent may have `reference` with roots of its own".to_owned()
        }
        SetupError::Chain { error: ChainError::Antiderivative { .. }, .. } => {
            "leave `antiderivatives` out for regressors without the highest derivative".to_owned()
        }
        SetupError::Chain { error: ChainError::AntiderivativeNotShown { .. }, .. } => {
            "write it with the functions that stand in the regressor, of the same arguments: (sin(x))^2 is not known to be 1 - (cos(x))^2".to_owned()
        }
        SetupError::Memory { need_bytes, .. } => {
            format!("write `memory_budget_bytes = {need_bytes}` or more in `[solver]`, sample more slowly, or shorten the longest delay")
        }
        SetupError::RecordingTooLarge { least_s: None, .. } => "record at fewer times, or write `record_every_s`".to_owned(),
        SetupError::RecordingTooLarge { least_s: Some(least_s), .. } => {
            format!("for this `end_s` let `record_every_s` be at least {}", about(1.05 * least_s).typed())
        }
        SetupError::UnitsDiffer { .. } => {
            "point masses, vehicles and robots with three prismatic joints have a position in space".to_owned()
        }
        SetupError::NotPushed { agent, .. } => format!("leave `{agent}` out of `on`"),
        SetupError::NoTarget { .. } => "give it a `target`".to_owned(),
        SetupError::NoOffsets { .. } => {
            "leave its `target` out; only vehicles and rotorcraft agree up to offsets".to_owned()
        }
        SetupError::NoManipulability { .. } => {
            "leave `manipulability_gain` out".to_owned()
        }
        _ => return None,
    })
}
