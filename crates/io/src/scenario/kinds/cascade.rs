//! `robot.strict_feedback` and `robot.pure_feedback`, chains in feedback form, and `law.adaptive_backstepping`.

use std::sync::Arc;

use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{CascadeError, CascadeTerms};
use forwardstep_sim::{ChainLaw, ChainModel, ChainStep, Law, RobotSetup, Start};
use schemars::JsonSchema;
use serde::Deserialize;

use super::bounds::EstimateBoundsFile;
use super::chain::{ChainProblem, FLOOR, MOST_STATES, adapted, chain_robot, each, list, optional};
use super::{
    At, AxisValues, EstimateStartFile, Fault, InputFolder, LawKind, LawReader, LawTable, LawTemplate, RobotKind,
    RobotRead, RobotTable, RobotTemplate, Spread, StartReader, Stop, TaskTemplate, fault, filled, length, number_or,
};
use crate::scenario::formula_text::FormulaText;
use crate::scenario::value_problem::ValueProblem;
use crate::scenario::values::Positive;

/// A chain in strict-feedback form: the rate of x1 is x2 and parameters times functions of x1, the rate of x2 is x3 and
/// parameters times functions of x1 and x2, and so on; the last rate has the input in place of the next state.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StrictFeedbackFile {
    /// For each equation what the parameters are multiplied by: a formula in x1, x2, … for each parameter.
    #[schemars(length(min = 1, max = 255))]
    pub regressors: At<Vec<At<Vec<At<FormulaText>>>>>,
    /// The true parameters.
    #[serde(default)]
    pub parameters: At<Vec<At<f64>>>,
}

impl RobotKind for StrictFeedbackFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "strict_feedback",
            description: "A parametric chain in strict-feedback form.",
            usual_law: "adaptive_backstepping",
            template: Some(RobotTemplate {
                name: "chain",
                line: "robot.strict_feedback = { regressors = [[\"x1^2\", \"0\"], [\"x1*x2\", \"sin(x2)\"]], parameters = [0.5, -0.8] }".into(),
                says: "each list is a row of regressors",
                starts: vec![[-1.0, 1.0]],
                law: LawTemplate::Lines(
                    "# Backstepping with tuning functions; nothing is known of the parameters.\n\
                     [law.adaptive_backstepping]\ngains_per_s = 1\nadaptation_gain = 1\n",
                ),
                dry_friction: None,
                task: TaskTemplate::of_orders(2, u32::MAX),
            }),
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        let regressors = equations(&self.regressors)?;
        let robot = cascade(CascadeTerms::strict(regressors), &self.regressors, &self.parameters)?;
        Ok(RobotRead::new(robot))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        spread.scale_each(&mut read.robot.theta);
        Ok(())
    }

    fn start(&self, robot: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        start(robot, given)
    }
}

/// A chain in pure-feedback form: the next state may enter the rate of each in any way.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PureFeedbackFile {
    /// For each equation what is known: a formula in the states up to the next one.
    #[schemars(length(min = 1, max = 255))]
    pub known: At<Vec<At<FormulaText>>>,
    /// For each equation what the parameters are multiplied by.
    #[schemars(length(min = 1, max = 255))]
    pub regressors: At<Vec<At<Vec<At<FormulaText>>>>>,
    /// What the input is multiplied by in the last equation. Default: 1.
    pub psi: Option<At<FormulaText>>,
    /// The true parameters.
    #[serde(default)]
    pub parameters: At<Vec<At<f64>>>,
}

impl RobotKind for PureFeedbackFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "pure_feedback",
            description: "A parametric chain in pure-feedback form.",
            usual_law: "adaptive_backstepping",
            template: Some(RobotTemplate {
                name: "chain",
                line: "robot.pure_feedback = { known = [\"x2 + 0.2*x2^3\", \"0\"], regressors = [[\"x1^2 + 0.3*tanh(x2)\", \"0\"], [\"tanh(x2)\", \"x1*x2\"]], parameters = [0.4, -0.3] }".into(),
                says: "each list is a row of regressors",
                starts: vec![[-0.6, 0.6]],
                law: LawTemplate::Lines(
                    "# Backstepping with tuning functions; nothing is known of the parameters.\n\
                     [law.adaptive_backstepping]\ngains_per_s = 1\nadaptation_gain = 1\n",
                ),
                dry_friction: None,
                task: TaskTemplate::of_orders(2, u32::MAX),
            }),
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        let regressors = equations(&self.regressors)?;
        let names = states(regressors.len());
        length("known", &self.known.span, self.known.value.len(), names.len(), "regressors")?;
        let known = list(&self.known.value, &names)?;
        let psi = optional(self.psi.as_ref(), &names, 1.0)?;
        let terms = CascadeTerms::new(known, regressors, psi);
        Ok(RobotRead::new(cascade(terms, &self.regressors, &self.parameters)?))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        spread.scale_each(&mut read.robot.theta);
        Ok(())
    }

    fn start(&self, robot: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        start(robot, given)
    }
}

/// Where a chain starts: z leads its first state.
fn start(robot: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
    let q = given.position()?;
    let rest = given.higher_states(robot.interface().rest_len)?;
    Ok(Start { reference: given.reference(&q)?, q, dq: Vec::new(), rest })
}

/// x1, x2, ….
fn states(order: usize) -> Vec<String> {
    (1..=order).map(|i| format!("x{i}")).collect()
}

fn cascade(
    terms: Result<CascadeTerms, CascadeError>,
    regressors: &At<Vec<At<Vec<At<FormulaText>>>>>,
    parameters: &At<Vec<At<f64>>>,
) -> Result<RobotSetup, Fault> {
    let terms = terms.map_err(|error| {
        let row = match error {
            CascadeError::Above { equation, .. } => regressors.value.get(equation.saturating_sub(1)),
            _ => None,
        };
        let place = row.map_or(&regressors.span, |row| &row.span).clone();
        Fault::new(ChainProblem::Unsound(error)).at(&place)
    })?;
    chain_robot(ChainModel::Cascade(Arc::new(terms)), parameters)
}

fn equations(file: &At<Vec<At<Vec<At<FormulaText>>>>>) -> Result<Vec<Vec<Expression>>, Fault> {
    let rows = filled("regressors", file)?;
    if rows.len() > MOST_STATES {
        return Err(fault(file, ValueProblem::Order { key: "regressors", found: rows.len(), most: MOST_STATES }));
    }
    let need = rows.first().map_or(0, |row| row.value.len());
    for (k, row) in rows.iter().enumerate() {
        length("regressors", &row.span, row.value.len(), need, &format!("equation {}", k + 1))?;
    }
    let names = states(rows.len());
    rows.iter().map(|row| list(&row.value, &names)).collect()
}

/// Adaptive backstepping for a chain in strict-feedback or pure-feedback form.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdaptiveBacksteppingFile {
    /// The gains of the steps in 1/s, one for all or one for each. Default: 1.
    pub gains_per_s: Option<At<AxisValues>>,
    /// The gain Γ, one for all parameters or one for each. Default: 1.
    pub adaptation_gain: Option<At<AxisValues>>,
    /// The estimate at the start. Default: zero; between bounds that zero is not between, their middle.
    pub estimate_start: Option<EstimateStartFile>,
    /// Bounds that the estimate stays strictly between: it adapts more slowly near them, and cannot start there. Default: none.
    pub bounds: Option<EstimateBoundsFile>,
    /// The run ends where the factor of the input in the last step comes closer to zero. Default: 1e-3.
    #[schemars(with = "Option<Positive>")]
    pub floor: Option<At<f64>>,
}

/// The order of a chain in feedback form.
fn order(robot: &RobotSetup) -> Option<usize> {
    match robot.kind.downcast() {
        Some(model @ ChainModel::Cascade(_)) => Some(model.order()),
        Some(ChainModel::Derivatives(_) | ChainModel::Vector(_)) | None => None,
    }
}

impl LawKind for AdaptiveBacksteppingFile {
    fn table() -> LawTable {
        LawTable {
            key: "adaptive_backstepping",
            description: "A chain in strict-feedback or pure-feedback form with unknown parameters.",
            made_for: "`strict_feedback` and `pure_feedback`, chains with unknown parameters in every equation",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        order(robot).is_some()
    }

    fn law(&self, agent: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        let order = order(agent.robot).unwrap_or_default();
        let gains_per_s = each(self.gains_per_s.as_ref(), order);
        let (gain, start, bounds) = (self.adaptation_gain.as_ref(), self.estimate_start.as_ref(), self.bounds.as_ref());
        let mut estimate = adapted(gain, start, bounds, agent)?;
        if let (None, Some(bounds)) = (start, &estimate.bounds) {
            for (start, (low, high)) in estimate.start.iter_mut().zip(bounds.lower.iter().zip(&bounds.upper)) {
                *start = if *low < 0.0 && 0.0 < *high { 0.0 } else { 0.5 * (low + high) };
            }
        }
        let floor = number_or(&self.floor, FLOOR);
        Ok(Arc::new(ChainLaw { step: ChainStep::Backstepping { gains_per_s, estimate }, floor }))
    }
}
