//! From a setup to an outcome.

use std::ops::ControlFlow;

use forwardstep_core::controller::Singularity;

use crate::closed_loop::{ClosedLoop, SetupError};
use crate::engine::{Failure, FailureCause, Integrator, Refuted, Step};
use crate::forcing::forcing;
use crate::inside::{Watch, show};
use crate::jumps::{JumpWatch, NetworkJump};
use crate::limit_watch::LimitWatch;
use crate::moment::{Moment, Moments};
use crate::network::Network;
use crate::recording::{
    Breakdown, BreakdownCause, Column, Ending, Outcome, Progress, Recording, SampleTaken, Signal, Stiffness,
};
use crate::rows::RowSink;
use crate::setup::{RecordAt, Setup, TimeSpan};

/// Rows are made room for in chunks of this many.
const ROWS_PER_CHUNK: usize = 4096;

/// Between two samples a robot needs one step, or a few, unless a period is long: at least so many are granted.
const STEPS_PER_SAMPLE: f64 = 1000.0;

/// No robot whose motion is of any use needs shorter steps than this for a whole period, s.
const SHORTEST_USEFUL_STEP_S: f64 = 1e-5;

/// Simulates `setup` until its horizon, a breakdown, or until `observer`, which is called after every step, says stop.
///
/// Rows of the recording at a break-point hold the values just after it; the last row those just before the horizon.
/// The same setup gives the same bits every time.
///
/// # Errors
/// [`SetupError`] when the setup has no meaning; nothing was computed then. A run that breaks down is not an error: see
/// [`Ending::BrokeDown`].
pub fn simulate(setup: &Setup, observer: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<Outcome, SetupError> {
    simulate_with(setup, observer, Observers::default())
}

/// Who looks at a run besides the recording. The run has the same bits, whoever does.
#[derive(Default)]
pub struct Observers<'a> {
    /// Is handed every sample of every controller once all agents have taken theirs, in no particular order of agents; nothing when control is
    /// continuous.
    pub samples: Option<&'a mut dyn FnMut(SampleTaken<'_>)>,
    /// Looks at every step from inside under digital control; nothing is shown when control is continuous.
    pub inside: Option<&'a mut dyn Watch>,
    /// Is shown every agent at every instant at which the network jumps; nothing when control is digital, since nothing is heard between samples
    /// then.
    pub jumps: Option<&'a mut dyn FnMut(NetworkJump<'_>)>,
    /// Is handed every agent with its rates at every row, before the row is recorded; nothing when control is digital, where reference dynamics
    /// have no rates.
    pub moments: Option<&'a mut dyn FnMut(Moment<'_>)>,
    /// Is handed every row when it is recorded.
    pub rows: Option<&'a mut dyn RowSink>,
    /// What agents told before t = 0, where that is not what they tell then: the messages of all, position and velocity each. The one entry that
    /// changes a run.
    pub told_before: Option<&'a [Vec<f64>]>,
}

/// As [`simulate`], and lets `observers` look at the run.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_with(
    setup: &Setup,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    observers: Observers<'_>,
) -> Result<Outcome, SetupError> {
    let mut shown = 0;
    let Observers { samples, mut inside, jumps, moments, rows, told_before } = observers;
    let mut closed_loop = assembled(setup)?;
    setup.network.lasts_until(setup.time.end_s)?;
    if let Some(samples) = samples {
        closed_loop.watch(samples);
    }
    if let (Some(control), true) = (&setup.control, inside.is_some()) {
        closed_loop.trace(control);
    }
    let (ports, entries) = closed_loop.ports();
    let end_s = setup.time.end_s;
    // Messages of sampled controllers do not flow: nothing of the network enters the motion between two samples.
    let silent = Network::silent(setup.network.agents);
    let network = if setup.control.is_some() { &silent } else { &setup.network };
    let mut integrator =
        Integrator::new(network, &setup.solver, end_s, closed_loop.start(), ports, entries, forcing(setup));
    if let Some(before) = told_before {
        integrator.told_before(before);
    }
    let mut recorder = Recorder::new(setup, &closed_loop, rows);
    let mut jumps = jumps.map(|jump| JumpWatch::new(&mut closed_loop, setup.agents.len(), jump));
    let mut limits = LimitWatch::new(setup);
    let mut pace = Pace::new(setup);
    let mut moments = moments.map(|each| (Moments::new(setup, &closed_loop), each));

    let ending = loop {
        match integrator.advance(&mut closed_loop) {
            Ok(None) => break Ending::Completed,
            Ok(Some(step)) => {
                closed_loop.reached(step.end_s);
                if let Some(inside) = &mut inside {
                    show(&mut integrator, &mut closed_loop, step, &mut shown, *inside);
                }
                if let Some((moments, each)) = &mut moments {
                    moments.show(&mut integrator, &mut closed_loop, step, *each);
                }
                if let Some(jumps) = &mut jumps {
                    jumps.look(&mut integrator, &mut closed_loop, step);
                }
                let left = limits.left(&mut integrator, &mut closed_loop, step);
                // What a joint does beyond its limits is not recorded.
                let until_s = left.as_ref().map_or(step.end_s, |left| left.t_s.next_up().min(step.end_s));
                recorder.record(&mut integrator, &mut closed_loop, Step { end_s: until_s, ..step });
                if let Some(breakdown) = left {
                    break Ending::BrokeDown(breakdown);
                }
                if let Some(breakdown) = vanished(&mut closed_loop, &integrator, step.end_s) {
                    break Ending::BrokeDown(breakdown);
                }
                if let Some(breakdown) = pace.ran_away(&integrator, &closed_loop, step.end_s) {
                    break Ending::BrokeDown(breakdown);
                }
                let progress = Progress { t_s: step.end_s, end_s };
                let stops = recorder.step_ends().is_break();
                if (observer(progress).is_break() || stops) && step.end_s < end_s {
                    break Ending::Interrupted { t_s: step.end_s };
                }
            }
            Err(failure) => {
                break Ending::BrokeDown(broken(&mut closed_loop, &integrator, failure));
            }
        }
    };
    let mut statistics = integrator.statistics();
    statistics.sign_residual = closed_loop.sign_residual();
    statistics.drive = closed_loop.drive();
    statistics.failed_steps = closed_loop.failed_steps();
    statistics.clipped = setup.control.is_some().then(|| closed_loop.clipped());
    Ok(Outcome { recording: recorder.recording, ending, statistics })
}

/// What a law divides by, where it comes too close to zero in the state that was evaluated last.
fn vanished(closed_loop: &mut ClosedLoop<'_>, integrator: &Integrator<'_>, t_s: f64) -> Option<Breakdown> {
    let (agent, Singularity::Vanishes { signal, axis, value, floor }) = closed_loop.trouble(integrator.state())?;
    Some(Breakdown { t_s, agent, signal, axis, cause: BreakdownCause::Vanished { value, floor } })
}

/// Who broke a run, in which signal, and why.
fn broken(closed_loop: &mut ClosedLoop<'_>, integrator: &Integrator<'_>, failure: Failure) -> Breakdown {
    // Before the first step the start is what was evaluated: where a law divides by zero there, that is why no number is finite.
    if matches!(failure.cause, FailureCause::NotFinite)
        && integrator.statistics().steps == 0
        && let Some(breakdown) = vanished(closed_loop, integrator, failure.t_s)
    {
        return breakdown;
    }
    let (agent, signal, axis) = closed_loop.locate(failure.state);
    let mut stiffness = |rate_per_s: Option<f64>| {
        let gains = closed_loop.gain_rates(agent, integrator.failed_in());
        rate_per_s.map(|rate_per_s| Stiffness { rate_per_s, gains })
    };
    let cause = match failure.cause {
        FailureCause::NotFinite => match integrator.refuted().or(closed_loop.refuted()) {
            Some(Refuted { delay, t_s }) => BreakdownCause::Delay { delay, at_s: t_s },
            None => BreakdownCause::NotFinite,
        },
        FailureCause::StepUnderFloor { step_s, rate_per_s } => {
            BreakdownCause::StepUnderFloor { step_s, stiffness: stiffness(rate_per_s) }
        }
        FailureCause::HistoryFull { step_s, need_bytes, rate_per_s } => {
            BreakdownCause::MemoryFull { step_s, need_bytes, stiffness: stiffness(rate_per_s) }
        }
    };
    Breakdown { t_s: failure.t_s, agent, signal, axis, cause }
}

/// The columns that a run of `setup` records, without any rows: what its tables are read back into.
///
/// # Errors
/// [`SetupError`] when the setup has no meaning. That its rows fit into memory is what [`check_recording`] says.
pub fn recorded_columns(setup: &Setup) -> Result<Vec<Column>, SetupError> {
    Ok(empty_columns(&ClosedLoop::new(setup)?, setup.agents.len()).0)
}

/// What each entry of the state of a run of `setup` is: agent, signal and axis. A run may break down in one that it does not record, as where a
/// controller from outside does not show all of its own.
///
/// # Errors
/// [`SetupError`] when the setup has no meaning.
pub fn state_entries(setup: &Setup) -> Result<Vec<(usize, Signal, usize)>, SetupError> {
    let closed_loop = ClosedLoop::new(setup)?;
    Ok((0..closed_loop.start().len()).map(|state| closed_loop.locate(state)).collect())
}

/// Whether a setup has a meaning: all that [`simulate`] asks of it but room for its rows ([`check_recording`]).
///
/// # Errors
/// [`SetupError`] when it has none.
pub fn check_setup(setup: &Setup) -> Result<(), SetupError> {
    ClosedLoop::new(setup)?;
    Ok(setup.network.lasts_until(setup.time.end_s)?)
}

/// Whether the rows of a run fit into memory, before anything is computed.
///
/// # Errors
/// [`SetupError::RecordingTooLarge`], or what else is wrong with the setup.
pub fn check_recording(setup: &Setup) -> Result<(), SetupError> {
    assembled(setup).map(drop)
}

/// The closed loop, once it is known that its recording fits into memory.
fn assembled(setup: &Setup) -> Result<ClosedLoop<'_>, SetupError> {
    let closed_loop = ClosedLoop::new(setup)?;
    setup.time.check_recording(closed_loop.signals(setup.agents.len()).iter().map(Vec::len).sum())?;
    Ok(closed_loop)
}

/// All columns, and the first one of every agent.
fn empty_columns(closed_loop: &ClosedLoop<'_>, agents: usize) -> (Vec<Column>, Vec<usize>) {
    let (mut columns, mut first_column) = (Vec::new(), Vec::new());
    for (agent, signals) in closed_loop.signals(agents).into_iter().enumerate() {
        first_column.push(columns.len());
        let column = |(signal, axis)| Column { agent, signal, axis, values: Vec::new() };
        columns.extend(signals.into_iter().map(column));
    }
    (columns, first_column)
}

/// Steps since the last sample. Held torques that feed an instability make robots spin ever faster, long before a number is
/// no longer finite, and every step shorter.
struct Pace {
    most_steps: u64,
    samples: u64,
    steps: u64,
}

impl Pace {
    fn new(setup: &Setup) -> Self {
        let period_s = setup.control.as_ref().map_or(0.0, |control| 1.0 / control.sample_hz);
        Pace { most_steps: (period_s / SHORTEST_USEFUL_STEP_S).max(STEPS_PER_SAMPLE) as u64, samples: 0, steps: 0 }
    }

    fn ran_away(&mut self, integrator: &Integrator<'_>, closed_loop: &ClosedLoop<'_>, t_s: f64) -> Option<Breakdown> {
        let samples = closed_loop.samples()?;
        self.steps = if samples == self.samples { self.steps + 1 } else { 1 };
        self.samples = samples;
        if self.steps < self.most_steps {
            return None;
        }
        let (agent, axis, value) = closed_loop.fastest(integrator.state())?;
        let cause = BreakdownCause::RanAway { value, steps: self.steps };
        Some(Breakdown { t_s, agent, signal: Signal::Velocity, axis, cause })
    }
}

/// Writes rows as steps go by.
struct Recorder<'a, 'r> {
    setup: &'a Setup,
    recording: Recording,
    /// First column of every agent.
    first_column: Vec<usize>,
    /// The row that is being made.
    row: Vec<f64>,
    rows: Rows,
    /// Who else takes the rows.
    sink: Option<&'r mut dyn RowSink>,
}

/// The instants of rows: row k belongs to t = k · record_every, to t = k / hz, or to the time that is stated.
pub(crate) struct Rows {
    time: TimeSpan,
    /// Rows so far.
    count: usize,
    /// 1 where the first of the stated times is not the start, which has a row all the same.
    before: usize,
    ended: bool,
}

impl Rows {
    pub(crate) fn new(time: TimeSpan) -> Self {
        let starts = match &time.record_at {
            RecordAt::Intervals | RecordAt::Rate { .. } => true,
            RecordAt::Times(times_s) => times_s.first() == Some(&0.0),
        };
        Rows { time, count: 0, before: usize::from(!starts), ended: false }
    }

    /// When the next row is, s; not before the end where there is no more.
    fn next_s(&self) -> f64 {
        match &self.time.record_at {
            RecordAt::Intervals => self.count as f64 * self.time.record_every_s,
            RecordAt::Rate { hz } => self.count as f64 / hz,
            RecordAt::Times(times_s) => match self.count.checked_sub(self.before) {
                None => 0.0,
                Some(k) => times_s.get(k).copied().unwrap_or(self.time.end_s),
            },
        }
    }

    /// The instant of the next row, s, if it falls into `step`.
    pub(crate) fn next_in(&mut self, step: Step) -> Option<f64> {
        let end_s = self.time.end_s;
        let t_s = self.next_s();
        // A row that the horizon rounds away is the last row.
        let last = t_s >= end_s * (1.0 - 1e-12);
        let t_s = if last { end_s } else { t_s };
        let inside = t_s < step.end_s || last && step.end_s >= end_s;
        if !inside || self.ended {
            return None;
        }
        self.ended = t_s == end_s;
        self.count += 1;
        Some(t_s)
    }
}

impl<'a, 'r> Recorder<'a, 'r> {
    fn new(setup: &'a Setup, closed_loop: &ClosedLoop<'_>, sink: Option<&'r mut dyn RowSink>) -> Self {
        let (columns, first_column) = empty_columns(closed_loop, setup.agents.len());
        Recorder {
            setup,
            row: vec![f64::NAN; columns.len()],
            recording: Recording { t_s: Vec::new(), columns },
            first_column,
            rows: Rows::new(setup.time.clone()),
            sink,
        }
    }

    /// Writes the rows that fall into `step`.
    fn record(&mut self, integrator: &mut Integrator<'_>, closed_loop: &mut ClosedLoop<'_>, step: Step) {
        while let Some(t_s) = self.rows.next_in(step) {
            self.row(integrator, closed_loop, t_s);
        }
    }

    fn row(&mut self, integrator: &mut Integrator<'_>, closed_loop: &mut ClosedLoop<'_>, t_s: f64) {
        let rows = self.recording.t_s.len();
        if rows.is_multiple_of(ROWS_PER_CHUNK) {
            let left = self.setup.time.most_rows() as usize - rows.min(1);
            let chunk = ROWS_PER_CHUNK.min(left.saturating_sub(rows) + 2);
            self.recording.t_s.reserve_exact(chunk);
            for column in &mut self.recording.columns {
                column.values.reserve_exact(chunk);
            }
        }
        let (x, heard) = integrator.look_inside(t_s);
        let (row, first) = (&mut self.row, &self.first_column);
        closed_loop.record(t_s, x, heard, |agent, values| {
            for (place, value) in row[first[agent]..].iter_mut().zip(values) {
                *place = *value;
            }
        });
        self.recording.row(t_s, &self.row);
        if let Some(sink) = &mut self.sink {
            sink.row(t_s, &self.row);
        }
    }

    /// Lets whoever else takes the rows know; whether the run is to go on.
    fn step_ends(&mut self) -> ControlFlow<()> {
        self.sink.as_mut().map_or(ControlFlow::Continue(()), |sink| sink.step())
    }
}
