//! `target` → [`Trajectory`].

use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

use forwardstep_core::attitude::{IDENTITY, dot, product};
use forwardstep_sim::trajectory::{Path, Sinusoid, Spline, SplineError, Trajectory};

use super::at::At;
use super::attitude::{attitude, direction};
use super::fault::{Fault, fault, filled, length, values};
use super::formula::formula;
use super::inputs::InputFolder;
use super::push_file::FunctionFile;
use super::system_problem::SystemProblem;
use super::systems_file::{PoseTargetFile, SwingFile, TargetFile, WaveFile};
use super::table::{over_time, rising, table_text};

/// Whose trajectory it is.
pub(super) struct Owner<'a> {
    pub(super) name: &'a str,
    /// What the entries are called in a table.
    pub(super) axes: &'a [String],
    /// Where a quaternion begins among them, if there is one.
    pub(super) quaternion: Option<usize>,
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
            one_sign(&mut numbers, owner);
            through(times, &numbers, need)
        }
        TargetFile::Pose(pose) => {
            let Some(first @ 3) = owner.quaternion else { return Err(fault(file, SystemProblem::NotAPose)) };
            let entries = filled("position", &pose.position)?;
            super::fault::length("position", &pose.position.span, entries.len(), first, owner.name)?;
            let mut paths: Vec<Path> = entries.iter().map(|entry| component(entry, end_s)).collect::<Result<_, _>>()?;
            paths.extend(attitude_path(pose)?);
            Trajectory::new(paths).map_err(|error| fault(file, SystemProblem::Trajectory(error)))
        }
        TargetFile::Csv(csv) => {
            let source = table_text(&csv.file, folder)?;
            let names: Vec<&str> = owner.axes.iter().map(String::as_str).collect();
            let (times, mut numbers) = over_time(&source, &names)?;
            one_sign(&mut numbers, owner);
            if times.is_empty() {
                return Err(fault(&csv.file, SystemProblem::Points(SplineError::Empty)));
            }
            through(&times, &numbers, need).map_err(|fault| fault.within(&source))
        }
    }
}

/// q and −q are one attitude, and the law for a pose takes the nearer: of the quaternions of two rows in turn, takes the second with the sign that is nearer to the first, so
/// that a curve through them does not pass close to zero.
fn one_sign(numbers: &mut [f64], owner: &Owner<'_>) {
    // Of a spacecraft the table is taken as it is written: its law goes the way round that the signs say.
    let Some(first @ 1..) = owner.quaternion else { return };
    let mut before: Option<[f64; 4]> = None;
    for row in numbers.chunks_exact_mut(owner.axes.len().max(1)) {
        let Some(q) = row.get_mut(first..).and_then(|rest| rest.first_chunk_mut::<4>()) else { return };
        if before.is_some_and(|before| dot(before, *q) < 0.0) {
            *q = q.map(|entry| -entry);
        }
        before = Some(*q);
    }
}

/// The quaternion of an attitude that turns about an axis at a constant rate: T(t) q₀ with T = (a sin(ωt/2), cos(ωt/2)), entry by
/// entry a sum of two sinusoids.
fn attitude_path(file: &PoseTargetFile) -> Result<[Path; 4], Fault> {
    let start = file.attitude.as_ref().map_or(Ok(IDENTITY), attitude)?;
    let Some(turning) = &file.turning else {
        return Ok(start.map(|offset| Path::Sinusoids { offset, waves: Vec::new() }));
    };
    let about = product(direction(&turning.axis)?, start);
    let rad_per_s = 0.5 * turning.rad_per_s.value;
    let wave = |amplitude, phase_rad| Sinusoid { amplitude, rad_per_s, phase_rad };
    Ok(core::array::from_fn(|k| Path::Sinusoids {
        offset: 0.0,
        waves: vec![wave(about[k], 0.0), wave(start[k], FRAC_PI_2)],
    }))
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
