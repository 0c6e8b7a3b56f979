//! `robot.vector_chain`, a plant of derivatives with several axes and a matrix ψ. Its laws are those of `chain`.

use std::sync::Arc;

use forwardstep_core::expression::Expression;
use forwardstep_core::plant::VectorFormulas;
use forwardstep_sim::{ChainModel, RobotSetup, Start};
use schemars::JsonSchema;
use serde::Deserialize;

use super::chain::{ChainProblem, chain_robot, chain_start, derivatives, list};
use super::{
    At, Fault, InputFolder, LawTemplate, RobotKind, RobotRead, RobotTable, RobotTemplate, Spread, StartReader, Stop,
    TaskTemplate, count, fault, filled, length,
};
use crate::scenario::formula_text::FormulaText;

/// A matrix of formulas, row by row.
type Rows = Vec<At<Vec<At<FormulaText>>>>;

/// A plant with several axes whose derivative of some order is χ + ψ u, where χ is a vector and ψ a matrix; formulas are in x1, x2, … and their
/// derivatives dx1, dx2, …, d2x1, ….
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VectorChainFile {
    /// The order k.
    #[schemars(range(min = 1, max = 255))]
    pub order: At<i64>,
    /// What is known of χ, a formula for each axis: there are as many axes as formulas.
    #[schemars(length(min = 1))]
    pub chi: At<Vec<At<FormulaText>>>,
    /// ψ row by row, which must keep an inverse. Default: each input drives its own axis, times 1.
    pub psi: Option<At<Rows>>,
    /// What the parameters are multiplied by in χ: for each axis a formula for each parameter. Default: there are none.
    pub regressor: Option<At<Rows>>,
    /// The true parameters.
    #[serde(default)]
    pub parameters: At<Vec<At<f64>>>,
}

impl RobotKind for VectorChainFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "vector_chain",
            description: "A plant of any order and several axes, with formulas for the vector χ and the matrix ψ.",
            usual_law: "linear_adaptive",
            template: Some(RobotTemplate {
                name: "plant",
                line: "robot.vector_chain = { order = 2, chi = [\"-x1 + x2\", \"-x2^3 + dx1\"], psi = [[\"2\", \"sin(x1)\"], [\"-0.5\", \"2\"]] }"
                    .into(),
                says: "the second derivatives of x1 and x2 are chi + psi u",
                starts: vec![[-1.0, 1.0]; 2],
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
        let axes = filled("chi", &self.chi)?.len();
        let names = names(order, axes);
        let chi = list(&self.chi.value, &names)?;
        let psi =
            self.psi.as_ref().map_or_else(|| Ok(identity(axes)), |rows| matrix("psi", rows, axes, axes, &names))?;
        let regressor = match &self.regressor {
            Some(rows) => {
                let parameters = rows.value.first().map_or(0, |row| row.value.len());
                matrix("regressor", rows, axes, parameters, &names)?
            }
            None => vec![Vec::new(); axes],
        };
        let terms = VectorFormulas::new(order, chi, regressor, psi)
            .map_err(|error| fault(&self.order, ChainProblem::Unsound(error)))?;
        Ok(RobotRead::new(chain_robot(ChainModel::Vector(Arc::new(terms)), &self.parameters)?))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        spread.scale_each(&mut read.robot.theta);
        Ok(())
    }

    fn start(&self, robot: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        chain_start(robot, given)
    }
}

/// x1, x2, …, dx1, dx2, …, in the order of the state.
fn names(order: usize, axes: usize) -> Vec<String> {
    let of_axis: Vec<Vec<String>> = (1..=axes).map(|axis| derivatives(order, &format!("x{axis}"))).collect();
    (0..order).flat_map(|r| of_axis.iter().map(move |names| names[r].clone())).collect()
}

fn identity(axes: usize) -> Vec<Vec<Expression>> {
    let entry = |row, column| Expression::number(if row == column { 1.0 } else { 0.0 });
    (0..axes).map(|row| (0..axes).map(|column| entry(row, column)).collect()).collect()
}

fn matrix(
    key: &'static str,
    rows: &At<Rows>,
    axes: usize,
    columns: usize,
    names: &[String],
) -> Result<Vec<Vec<Expression>>, Fault> {
    length(key, &rows.span, rows.value.len(), axes, "chi")?;
    for row in &rows.value {
        length(key, &row.span, row.value.len(), columns, if key == "psi" { "chi" } else { "the first row" })?;
    }
    rows.value.iter().map(|row| list(&row.value, names)).collect()
}
