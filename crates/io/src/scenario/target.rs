//! `target` → [`Trajectory`].

use forwardstep_sim::trajectory::{Path, Trajectory};

use super::at::At;
use super::fault::{Fault, fault, filled};
use super::formula::formula;
use super::problem::ScenarioProblem;
use super::push_file::FunctionFile;
use super::systems_file::TargetFile;

/// Builds the trajectory of `agent`, which has so many axes; it must have values until `end_s`.
pub(super) fn target(file: &At<TargetFile>, agent: &str, axes: usize, end_s: f64) -> Result<Trajectory, Fault> {
    match &file.value {
        TargetFile::Formulas(list) => {
            let entries = filled("formulas", list)?;
            if entries.len() != axes {
                let (found, agent) = (entries.len(), agent.to_owned());
                return Err(fault(list, ScenarioProblem::VectorLength { key: "formulas", found, need: axes, agent }));
            }
            let paths = entries.iter().map(|entry| component(entry, end_s)).collect::<Result<_, _>>()?;
            Trajectory::new(paths).map_err(|_| fault(list, ScenarioProblem::TargetValue { end_s }))
        }
    }
}

/// One axis: a number or a formula that has values on the whole run.
fn component(entry: &At<FunctionFile>, end_s: f64) -> Result<Path, Fault> {
    let text = match &entry.value {
        FunctionFile::Number(value) => return Ok(Path::Sinusoids { offset: *value, waves: Vec::new() }),
        FunctionFile::Formula(text) => text.clone(),
    };
    let formula = formula(&At { value: text, span: entry.span.clone() })?;
    if formula.is_bounded(0.0, end_s) {
        Ok(Path::Formula(formula))
    } else {
        Err(fault(entry, ScenarioProblem::TargetValue { end_s }))
    }
}
