//! `robot.chain`, a plant of derivatives, and the laws for it: `linearising`, `linear_adaptive`, `immersion`.

use std::sync::Arc;

use forwardstep_core::controller::Immersion;
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{CascadeError, Formulas, Terms};
use forwardstep_sim::{AxisUnit, ChainLaw, ChainModel, ChainStep, Estimate, Law, RobotSetup, Start};
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use super::bounds::{EstimateBoundsFile, started};
use super::{
    At, AxisValues, EstimateStartFile, Fault, InputFolder, LawKind, LawReader, LawTable, LawTemplate, Mistake,
    RobotKind, RobotRead, RobotTable, RobotTemplate, Spread, StartReader, Stop, TaskTemplate, axis, count, fault,
    length, number_or, values,
};
use crate::scenario::formula::formula_in;
use crate::scenario::formula_text::FormulaText;
use crate::scenario::values::Positive;

/// The states of a chain are numbered in the columns of a run, from 1 to 255. What an order costs, and how many digits its roots leave,
/// is checked where the law is made.
pub(super) const MOST_STATES: usize = u8::MAX as usize;
/// Where the factor of the input counts as zero.
pub(super) const FLOOR: f64 = 1e-3;
/// k, c and Γ.
const GAIN: f64 = 1.0;

/// What is wrong with a chain.
#[derive(Debug, Error)]
pub(super) enum ChainProblem {
    /// A chain without meaning.
    #[error("{0}")]
    Unsound(CascadeError),
    /// Antiderivatives that have to be given.
    #[error("agent `{agent}`: a regressor holds the highest derivative of x, so its antiderivative must be given")]
    Antiderivatives {
        /// The agent.
        agent: String,
    },
}

impl Mistake for ChainProblem {
    fn help(&self) -> Option<String> {
        None
    }
}

/// A plant whose derivative of some order is χ + ψ u; formulas are in x, dx, d2x, d3x, ….
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChainFile {
    /// The order k.
    #[schemars(range(min = 1, max = 255))]
    pub order: At<i64>,
    /// What is known of χ. Default: 0.
    pub chi: Option<At<FormulaText>>,
    /// ψ, which must stay away from zero. Default: 1.
    pub psi: Option<At<FormulaText>>,
    /// What the parameters are multiplied by in χ, a formula for each.
    #[serde(default)]
    pub regressor: At<Vec<At<FormulaText>>>,
    /// The true parameters.
    #[serde(default)]
    pub parameters: At<Vec<At<f64>>>,
}

impl RobotKind for ChainFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "chain",
            description: "A plant of any order with formulas for χ and ψ: Section IV of the paper.",
            usual_law: "linear_adaptive",
            template: Some(RobotTemplate {
                name: "plant",
                line: "robot.chain = { order = 2, chi = \"-x^3 - dx*abs(dx)\", psi = \"1 + x^2\" }".into(),
                says: "the second derivative of x is chi + psi u",
                starts: vec![[-1.0, 1.0]],
                law: LawTemplate::Lines(
                    "# The input that makes the plant linear.\n[law.linearising]\ngain_per_s = 2\n",
                ),
                dry_friction: None,
                task: TaskTemplate::of_orders(2, u32::MAX),
            }),
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        let order = count("order", &self.order, u8::MAX.into())?;
        let names = derivatives(order, "x");
        let chi = optional(self.chi.as_ref(), &names, 0.0)?;
        let psi = optional(self.psi.as_ref(), &names, 1.0)?;
        let phi = list(&self.regressor.value, &names)?;
        let terms = Formulas::new(order, &chi, phi, &psi)
            .map_err(|error| fault(&self.order, ChainProblem::Unsound(CascadeError::Expression(error))))?;
        Ok(RobotRead::new(chain_robot(ChainModel::Derivatives(Arc::new(terms)), &self.parameters)?))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        spread.scale_each(&mut read.robot.theta);
        Ok(())
    }

    fn start(&self, robot: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        chain_start(robot, given)
    }
}

/// x, its derivatives below the order of the plant, and z, which follows the highest of them.
pub(super) fn chain_start(robot: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
    let q = given.position()?;
    let dq = if robot.velocity_len() > 0 { given.velocity()? } else { Vec::new() };
    let rest = given.higher_states(robot.interface().rest_len)?;
    let state = [&q[..], &dq, &rest].concat();
    let led = &state[state.len().saturating_sub(q.len())..];
    Ok(Start { reference: given.reference(led)?, q, dq, rest })
}

/// x, dx, d2x, … of a letter x.
pub(super) fn derivatives(order: usize, letter: &str) -> Vec<String> {
    let name = |r: usize| match r {
        0 => letter.to_owned(),
        1 => format!("d{letter}"),
        r => format!("d{r}{letter}"),
    };
    (0..order).map(name).collect()
}

pub(super) fn optional(text: Option<&At<FormulaText>>, names: &[String], otherwise: f64) -> Result<Expression, Fault> {
    text.map_or(Ok(Expression::number(otherwise)), |text| formula_in(text, names))
}

pub(super) fn list(texts: &[At<FormulaText>], names: &[String]) -> Result<Vec<Expression>, Fault> {
    texts.iter().map(|text| formula_in(text, names)).collect()
}

pub(super) fn chain_robot(model: ChainModel, parameters: &At<Vec<At<f64>>>) -> Result<RobotSetup, Fault> {
    let need = model.parameters();
    length("parameters", &parameters.span, parameters.value.len(), need, "regressor")?;
    let axes = match model.axes() {
        1 => vec![axis("x", AxisUnit::Own)],
        axes => (1..=axes).map(|k| axis(&format!("x{k}"), AxisUnit::Own)).collect(),
    };
    Ok(RobotSetup {
        kind: Arc::new(model),
        theta: values(&parameters.value),
        theta_names: (1..=need).map(|k| format!("theta{k}")).collect(),
        axes,
    })
}

/// Whether it is a plant of derivatives, with one axis or several.
fn has_derivatives(robot: &RobotSetup) -> bool {
    matches!(robot.kind.downcast(), Some(ChainModel::Derivatives(_) | ChainModel::Vector(_)))
}

/// The terms of a plant of derivatives with one axis.
fn terms(robot: &RobotSetup) -> Option<&Formulas> {
    match robot.kind.downcast() {
        Some(ChainModel::Derivatives(terms)) => Some(terms),
        Some(ChainModel::Vector(_) | ChainModel::Cascade(_)) | None => None,
    }
}

const MADE_FOR: &str = "`chain` and `vector_chain`, plants of derivatives";

/// One number for all of `need`, or one for each.
pub(super) fn each(file: Option<&At<AxisValues>>, need: usize) -> Vec<f64> {
    file.map_or_else(|| vec![GAIN; need], |place| place.value.each(need))
}

pub(super) fn adapted(
    gain: Option<&At<AxisValues>>,
    start: Option<&EstimateStartFile>,
    bounds: Option<&EstimateBoundsFile>,
    agent: &LawReader<'_>,
) -> Result<Estimate, Fault> {
    let bounds = bounds.map(|bounds| bounds.of(agent.robot)).transpose()?;
    let start = started(start, bounds.as_ref(), agent);
    Ok(Estimate { adaptation: each(gain, agent.robot.theta.len()), start, bounds })
}

/// Feedback linearisation of a chain of derivatives, with the true parameters.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearisingFile {
    /// How fast the tracking error vanishes, in 1/s. Default: 1.
    #[schemars(with = "Option<Positive>")]
    pub gain_per_s: Option<At<f64>>,
    /// The run ends where ψ comes closer to zero; of a matrix, its smallest singular value. Default: 1e-3.
    #[schemars(with = "Option<Positive>")]
    pub floor: Option<At<f64>>,
}

impl LawKind for LinearisingFile {
    fn table() -> LawTable {
        LawTable { key: "linearising", description: "A chain of derivatives that is known.", made_for: MADE_FOR }
    }

    fn suits(robot: &RobotSetup) -> bool {
        has_derivatives(robot)
    }

    fn law(&self, _: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        let gain_per_s = number_or(&self.gain_per_s, GAIN);
        let floor = number_or(&self.floor, FLOOR);
        Ok(Arc::new(ChainLaw { step: ChainStep::Linearising { gain_per_s }, floor }))
    }
}

/// The adaptive law for a chain of derivatives.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearAdaptiveFile {
    /// How fast the tracking error vanishes, in 1/s. Default: 1.
    #[schemars(with = "Option<Positive>")]
    pub gain_per_s: Option<At<f64>>,
    /// The gain Γ, one for all parameters or one for each. Default: 1.
    pub adaptation_gain: Option<At<AxisValues>>,
    /// The estimate at the start. Default: zero, or the nearest within the bounds.
    pub estimate_start: Option<EstimateStartFile>,
    /// Bounds that the estimate is kept within, by projection. Default: none.
    pub bounds: Option<EstimateBoundsFile>,
    /// The run ends where ψ comes closer to zero; of a matrix, its smallest singular value. Default: 1e-3.
    #[schemars(with = "Option<Positive>")]
    pub floor: Option<At<f64>>,
}

impl LawKind for LinearAdaptiveFile {
    fn table() -> LawTable {
        LawTable {
            key: "linear_adaptive",
            description: "A chain of derivatives with unknown parameters.",
            made_for: MADE_FOR,
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        has_derivatives(robot)
    }

    fn law(&self, agent: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        let gain_per_s = number_or(&self.gain_per_s, GAIN);
        let (gain, start, bounds) = (self.adaptation_gain.as_ref(), self.estimate_start.as_ref(), self.bounds.as_ref());
        let estimate = adapted(gain, start, bounds, agent)?;
        let floor = number_or(&self.floor, FLOOR);
        Ok(Arc::new(ChainLaw { step: ChainStep::Adaptive { gain_per_s, estimate }, floor }))
    }
}

/// Immersion and invariance for a chain of derivatives.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ImmersionFile {
    /// How fast the tracking error vanishes, in 1/s. Default: 1.
    #[schemars(with = "Option<Positive>")]
    pub gain_per_s: Option<At<f64>>,
    /// The gain Γ, one for all parameters or one for each. Default: 1.
    pub adaptation_gain: Option<At<AxisValues>>,
    /// The estimate at the start. Default: zero, or the nearest within the bounds.
    pub estimate_start: Option<EstimateStartFile>,
    /// Bounds beyond which the estimate is not used. Default: none.
    pub bounds: Option<EstimateBoundsFile>,
    /// For each parameter a formula whose derivative by the highest derivative of x is the regressor. Default: the regressor
    /// times that derivative, for regressors without it.
    pub antiderivatives: Option<At<Vec<At<FormulaText>>>>,
    /// The run ends where ψ comes closer to zero. Default: 1e-3.
    #[schemars(with = "Option<Positive>")]
    pub floor: Option<At<f64>>,
}

impl LawKind for ImmersionFile {
    fn table() -> LawTable {
        LawTable {
            key: "immersion",
            description: "The same by immersion and invariance.",
            made_for: "`chain`, plants of derivatives",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        terms(robot).is_some()
    }

    fn law(&self, agent: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        let none = || Fault::new(ChainProblem::Antiderivatives { agent: agent.agent.to_owned() });
        let terms = terms(agent.robot).ok_or_else(none)?;
        let (order, phi) = (terms.order(), terms.regressor());
        let antiderivatives = match &self.antiderivatives {
            Some(texts) => list(&texts.value, &derivatives(order, "x"))?,
            None => {
                phi.iter().map(|phi| Immersion::antiderivative(order, phi)).collect::<Option<_>>().ok_or_else(none)?
            }
        };
        let gain_per_s = number_or(&self.gain_per_s, GAIN);
        let (gain, start, bounds) = (self.adaptation_gain.as_ref(), self.estimate_start.as_ref(), self.bounds.as_ref());
        let estimate = adapted(gain, start, bounds, agent)?;
        let floor = number_or(&self.floor, FLOOR);
        Ok(Arc::new(ChainLaw { step: ChainStep::Immersion { gain_per_s, estimate, antiderivatives }, floor }))
    }
}
