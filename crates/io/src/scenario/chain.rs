//! `robot.chain`, `robot.strict_feedback`, `robot.pure_feedback` and the laws for them.

use std::sync::Arc;

use forwardstep_core::controller::Immersion;
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{CascadeError, CascadeTerms, Formulas};
use forwardstep_sim::{AxisUnit, Law, RobotSetup};
use forwardstep_sim::{ChainLaw, ChainModel, ChainStep, Estimate};

use super::at::At;
use super::chain_file::{
    AdaptiveBacksteppingFile, ChainFile, ImmersionFile, LinearAdaptiveFile, LinearisingFile, PureFeedbackFile,
    StrictFeedbackFile,
};
use super::fault::{Fault, count, fault, filled, length, positive, positive_or, values};
use super::file::EstimateStartFile;
use super::formula::formula_in;
use super::law::{estimate, of_another};
use super::robots::axis;
use super::system_problem::SystemProblem;
use super::value_problem::ValueProblem;
use super::values::AxisValues;

/// Orders that are accepted: of derivatives, and of chains that are differentiated.
const MOST_DERIVATIVES: u32 = 8;
const MOST_EQUATIONS: usize = 6;
/// Where the factor of the input counts as zero.
const FLOOR: f64 = 1e-3;
/// k, c and Γ.
const GAIN: f64 = 1.0;

/// x, dx, d2x, ….
fn derivatives(order: usize) -> Vec<String> {
    let name = |r: usize| match r {
        0 => "x".to_owned(),
        1 => "dx".to_owned(),
        r => format!("d{r}x"),
    };
    (0..order).map(name).collect()
}

/// x1, x2, ….
fn states(order: usize) -> Vec<String> {
    (1..=order).map(|i| format!("x{i}")).collect()
}

fn optional(text: Option<&At<String>>, names: &[String], otherwise: f64) -> Result<Expression, Fault> {
    text.map_or(Ok(Expression::number(otherwise)), |text| formula_in(text, names))
}

fn list(texts: &[At<String>], names: &[String]) -> Result<Vec<Expression>, Fault> {
    texts.iter().map(|text| formula_in(text, names)).collect()
}

fn robot(model: ChainModel, parameters: &At<Vec<At<f64>>>) -> Result<RobotSetup, Fault> {
    let need = model.parameters();
    length("parameters", &parameters.span, parameters.value.len(), need, "regressor")?;
    Ok(RobotSetup {
        kind: Arc::new(model),
        theta: values(&parameters.value),
        theta_names: (1..=need).map(|k| format!("theta{k}")).collect(),
        axes: vec![axis("x", AxisUnit::Metre)],
    })
}

/// A plant of derivatives.
pub(super) fn chain(file: &ChainFile) -> Result<RobotSetup, Fault> {
    let order = count("order", &file.order, MOST_DERIVATIVES)?;
    let names = derivatives(order);
    let chi = optional(file.chi.as_ref(), &names, 0.0)?;
    let psi = optional(file.psi.as_ref(), &names, 1.0)?;
    let phi = list(&file.regressor.value, &names)?;
    let terms = Formulas::new(order, &chi, phi, &psi)
        .map_err(|error| fault(&file.order, SystemProblem::Chain(CascadeError::Expression(error))))?;
    robot(ChainModel::Derivatives(Arc::new(terms)), &file.parameters)
}

/// A chain in strict-feedback form.
pub(super) fn strict(file: &StrictFeedbackFile) -> Result<RobotSetup, Fault> {
    let regressors = equations(&file.regressors)?;
    let terms = CascadeTerms::strict(regressors);
    cascade(terms, &file.regressors, &file.parameters)
}

/// A chain in pure-feedback form.
pub(super) fn pure(file: &PureFeedbackFile) -> Result<RobotSetup, Fault> {
    let regressors = equations(&file.regressors)?;
    let names = states(regressors.len());
    length("known", &file.known.span, file.known.value.len(), names.len(), "regressors")?;
    let known = list(&file.known.value, &names)?;
    let psi = optional(file.psi.as_ref(), &names, 1.0)?;
    cascade(CascadeTerms::new(known, regressors, psi), &file.regressors, &file.parameters)
}

fn cascade(
    terms: Result<CascadeTerms, CascadeError>,
    regressors: &At<Vec<At<Vec<At<String>>>>>,
    parameters: &At<Vec<At<f64>>>,
) -> Result<RobotSetup, Fault> {
    let terms = terms.map_err(|error| {
        let row = match error {
            CascadeError::Above { equation, .. } => regressors.value.get(equation.saturating_sub(1)),
            _ => None,
        };
        let place = row.map_or(&regressors.span, |row| &row.span).clone();
        Fault::new(SystemProblem::Chain(error)).at(&place)
    })?;
    robot(ChainModel::Cascade(Arc::new(terms)), parameters)
}

fn equations(file: &At<Vec<At<Vec<At<String>>>>>) -> Result<Vec<Vec<Expression>>, Fault> {
    let rows = filled("regressors", file)?;
    if rows.len() > MOST_EQUATIONS {
        return Err(fault(file, ValueProblem::Order { key: "regressors", found: rows.len(), most: MOST_EQUATIONS }));
    }
    let need = rows.first().map_or(0, |row| row.value.len());
    for (k, row) in rows.iter().enumerate() {
        length("regressors", &row.span, row.value.len(), need, &format!("equation {}", k + 1))?;
    }
    let names = states(rows.len());
    rows.iter().map(|row| list(&row.value, &names)).collect()
}

/// The model of an agent that a law for chains is for.
fn model<'a>(robot: &'a RobotSetup, agent: &str, law: &'static str, is_cascade: bool) -> Result<&'a ChainModel, Fault> {
    match robot.kind.downcast() {
        Some(model) if matches!(model, ChainModel::Cascade(_)) == is_cascade => Ok(model),
        _ => {
            let made_for = if is_cascade {
                "`strict_feedback` and `pure_feedback`, chains with unknown parameters in every equation"
            } else {
                "`chain`, plants of derivatives"
            };
            Err(of_another(law, made_for, agent, robot))
        }
    }
}

/// One number for all, or one for each of `need`.
fn each(key: &'static str, file: Option<&At<AxisValues>>, agent: &str, need: usize) -> Result<Vec<f64>, Fault> {
    let Some(place) = file else { return Ok(vec![GAIN; need]) };
    match &place.value {
        AxisValues::All(value) => Ok(vec![positive(key, &At { value: *value, span: place.span.clone() })?; need]),
        AxisValues::Each(list) => {
            length(key, &place.span, list.len(), need, agent)?;
            list.iter().map(|value| positive(key, value)).collect()
        }
    }
}

fn adapted(
    gain: Option<&At<AxisValues>>,
    start: Option<&EstimateStartFile>,
    agent: &str,
    robot: &RobotSetup,
) -> Result<Estimate, Fault> {
    let adaptation = each("adaptation_gain", gain, agent, robot.theta.len())?;
    Ok(Estimate { adaptation, start: estimate(start, agent, robot)? })
}

/// `linearising`.
pub(super) fn linearising(file: &LinearisingFile, agent: &str, robot: &RobotSetup) -> Result<Arc<dyn Law>, Fault> {
    model(robot, agent, "linearising", false)?;
    let gain_per_s = positive_or("gain_per_s", &file.gain_per_s, GAIN)?;
    let floor = positive_or("floor", &file.floor, FLOOR)?;
    Ok(Arc::new(ChainLaw { step: ChainStep::Linearising { gain_per_s }, floor }))
}

/// `linear_adaptive`.
pub(super) fn linear_adaptive(
    file: &LinearAdaptiveFile,
    agent: &str,
    robot: &RobotSetup,
) -> Result<Arc<dyn Law>, Fault> {
    model(robot, agent, "linear_adaptive", false)?;
    let gain_per_s = positive_or("gain_per_s", &file.gain_per_s, GAIN)?;
    let estimate = adapted(file.adaptation_gain.as_ref(), file.estimate_start.as_ref(), agent, robot)?;
    let floor = positive_or("floor", &file.floor, FLOOR)?;
    Ok(Arc::new(ChainLaw { step: ChainStep::Adaptive { gain_per_s, estimate }, floor }))
}

/// `immersion`.
pub(super) fn immersion(file: &ImmersionFile, agent: &str, robot: &RobotSetup) -> Result<Arc<dyn Law>, Fault> {
    let ChainModel::Derivatives(terms) = model(robot, agent, "immersion", false)? else {
        return Err(Fault::new(SystemProblem::Antiderivatives { agent: agent.to_owned() }));
    };
    let (order, phi) = (derivatives_of(terms), terms.regressor());
    let antiderivatives = match &file.antiderivatives {
        Some(texts) => {
            length("antiderivatives", &texts.span, texts.value.len(), phi.len(), agent)?;
            list(&texts.value, &derivatives(order))?
        }
        None => phi
            .iter()
            .map(|phi| Immersion::antiderivative(order, phi))
            .collect::<Option<_>>()
            .ok_or_else(|| Fault::new(SystemProblem::Antiderivatives { agent: agent.to_owned() }))?,
    };
    let gain_per_s = positive_or("gain_per_s", &file.gain_per_s, GAIN)?;
    let estimate = adapted(file.adaptation_gain.as_ref(), file.estimate_start.as_ref(), agent, robot)?;
    let floor = positive_or("floor", &file.floor, FLOOR)?;
    Ok(Arc::new(ChainLaw { step: ChainStep::Immersion { gain_per_s, estimate, antiderivatives }, floor }))
}

fn derivatives_of(terms: &Formulas) -> usize {
    forwardstep_core::plant::Terms::order(terms)
}

/// `adaptive_backstepping`.
pub(super) fn backstepping(
    file: &AdaptiveBacksteppingFile,
    agent: &str,
    robot: &RobotSetup,
) -> Result<Arc<dyn Law>, Fault> {
    let order = model(robot, agent, "adaptive_backstepping", true)?.order();
    let gains_per_s = each("gains_per_s", file.gains_per_s.as_ref(), agent, order)?;
    let estimate = adapted(file.adaptation_gain.as_ref(), file.estimate_start.as_ref(), agent, robot)?;
    let floor = positive_or("floor", &file.floor, FLOOR)?;
    Ok(Arc::new(ChainLaw { step: ChainStep::Backstepping { gains_per_s, estimate }, floor }))
}
