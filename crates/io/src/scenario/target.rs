//! `target` → [`Trajectory`].

use std::ops::Range;

use forwardstep_sim::trajectory::{Path, Sinusoid, Spline, SplineError, Trajectory};

use super::at::At;
use super::fault::{Fault, fault, filled, length, values};
use super::formula::formula;
use super::inputs::InputFolder;
use super::push_file::FunctionFile;
use super::system_problem::SystemProblem;
use super::systems_file::{SwingFile, TargetFile, WaveFile};
use super::table::{over_time, rising, table_text};

/// Whose trajectory it is.
pub(super) struct Owner<'a> {
    pub(super) name: &'a str,
    /// What the entries are called in a table.
    pub(super) axes: &'a [String],
    /// Until when it must have values, s.
    pub(super) end_s: f64,
}

/// Builds the trajectory of `owner`; `folder` is where tables are looked for.
pub(super) fn target(file: &At<TargetFile>, owner: &Owner<'_>, folder: &mut InputFolder) -> Result<Trajectory, Fault> {
    let (need, end_s) = (owner.axes.len(), owner.end_s);
    let length = |key, found: usize, span: &Range<usize>| length(key, span, found, need, owner.name);
    match &file.value {
        TargetFile::Formulas(list) => {
            let entries = filled("formulas", list)?;
            length("formulas", entries.len(), &list.span)?;
            let paths = entries.iter().map(|entry| component(entry, end_s)).collect::<Result<_, _>>()?;
            Trajectory::new(paths).map_err(|_| fault(list, SystemProblem::TargetValue { end_s }))
        }
        TargetFile::Sinusoids(list) => {
            length("sinusoids", list.value.len(), &list.span)?;
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
            Trajectory::new(list.value.iter().map(path).collect())
                .map_err(|error| fault(list, SystemProblem::Trajectory(error)))
        }
        TargetFile::Points(points) => {
            filled("times_s", &points.times_s)?;
            let (times, rows) = (&points.times_s.value, &points.positions);
            if rows.value.len() != times.len() {
                let problem = SystemProblem::PointsAndTimes { points: rows.value.len(), times: times.len() };
                return Err(fault(rows, problem));
            }
            let mut numbers = Vec::with_capacity(need * times.len());
            for row in &rows.value {
                length("positions", row.value.len(), &row.span)?;
                numbers.extend(values(&row.value));
            }
            rising("times_s", times)?;
            through(times, &numbers, need)
        }
        TargetFile::Csv(csv) => {
            let source = table_text(&csv.file, folder)?;
            let names: Vec<&str> = owner.axes.iter().map(String::as_str).collect();
            let (times, numbers) = over_time(&source, &names)?;
            if times.is_empty() {
                return Err(fault(&csv.file, SystemProblem::Points(SplineError::Empty)));
            }
            through(&times, &numbers, need).map_err(|fault| fault.within(&source))
        }
    }
}

/// The smoothest curve through points, the entries of each side by side.
fn through(times: &[At<f64>], numbers: &[f64], axes: usize) -> Result<Trajectory, Fault> {
    let mut paths = Vec::with_capacity(axes);
    for axis in 0..axes {
        let column = numbers.iter().skip(axis).step_by(axes.max(1)).copied().collect();
        paths.push(Path::Spline(Spline::new(values(times), column).map_err(|error| steep(times, error))?));
    }
    Trajectory::new(paths).map_err(|error| Fault::new(SystemProblem::Trajectory(error)))
}

/// The place of the point that a curve breaks down at.
fn steep(times: &[At<f64>], error: SplineError) -> Fault {
    let place = match error {
        SplineError::NotFinite { row, .. } | SplineError::Order { row, .. } | SplineError::TooSteep { row } => {
            times.get(row.saturating_sub(1))
        }
        SplineError::Empty | SplineError::Lengths { .. } => None,
    };
    let fault = Fault::new(SystemProblem::Points(error));
    match place {
        Some(time) => fault.at(&time.span),
        None => fault,
    }
}

/// One axis: a number or a formula that has values on the whole run.
fn component(entry: &At<FunctionFile>, end_s: f64) -> Result<Path, Fault> {
    let text = match &entry.value {
        FunctionFile::Number(value) => return Ok(Path::Sinusoids { offset: *value, waves: Vec::new() }),
        FunctionFile::Formula(text) => text.clone(),
    };
    let formula = formula(&At { value: text, span: entry.span.clone() })?;
    if !formula.is_bounded(0.0, end_s) {
        return Err(fault(entry, SystemProblem::TargetValue { end_s }));
    }
    formula.switches(0.0, end_s).map_err(|error| fault(entry, SystemProblem::Kinks(error)))?;
    Ok(Path::Formula(formula))
}
