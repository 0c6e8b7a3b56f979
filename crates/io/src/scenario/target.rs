//! `target` → [`Trajectory`].

use forwardstep_sim::trajectory::{Path, Sinusoid, Spline, Trajectory};

use super::at::At;
use super::fault::{Fault, fault, filled, values};
use super::formula::formula;
use super::problem::ScenarioProblem;
use super::push_file::FunctionFile;
use super::systems_file::{SwingFile, TargetFile, WaveFile};

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
        TargetFile::Sinusoids(list) => {
            let entries = &list.value;
            if entries.len() != axes {
                let (found, agent) = (entries.len(), agent.to_owned());
                return Err(fault(list, ScenarioProblem::VectorLength { key: "sinusoids", found, need: axes, agent }));
            }
            let zero = |number: &Option<At<f64>>| number.as_ref().map_or(0.0, |number| number.value);
            let wave = |wave: &WaveFile| Sinusoid {
                amplitude: wave.amplitude.value,
                rad_per_s: wave.rad_per_s.value,
                phase_rad: zero(&wave.phase_rad),
            };
            let path = |swing: &SwingFile| Path::Sinusoids {
                offset: zero(&swing.offset),
                waves: swing.waves.iter().map(wave).collect(),
            };
            Trajectory::new(entries.iter().map(path).collect())
                .map_err(|error| fault(list, ScenarioProblem::Trajectory(error)))
        }
        TargetFile::Points(points) => {
            let (times, rows) = (values(filled("times_s", &points.times_s)?), &points.positions);
            if rows.value.len() != times.len() {
                let (found, need, agent) = (rows.value.len(), times.len(), agent.to_owned());
                return Err(fault(rows, ScenarioProblem::VectorLength { key: "positions", found, need, agent }));
            }
            if let Some(row) = rows.value.iter().find(|row| row.value.len() != axes) {
                let (found, agent) = (row.value.len(), agent.to_owned());
                return Err(fault(row, ScenarioProblem::VectorLength { key: "positions", found, need: axes, agent }));
            }
            let mut paths = Vec::with_capacity(axes);
            for axis in 0..axes {
                let column = rows.value.iter().filter_map(|row| row.value.get(axis)).map(|entry| entry.value).collect();
                let spline = Spline::new(times.clone(), column);
                paths.push(Path::Spline(spline.map_err(|error| fault(rows, ScenarioProblem::Points(error)))?));
            }
            Trajectory::new(paths).map_err(|error| fault(rows, ScenarioProblem::Trajectory(error)))
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
