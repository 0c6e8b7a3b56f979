//! One period of one agent under digital control, or some after each other, as a map, and its Jacobian by central differences.
//!
//! The state of the map is that of the plant and of the controller at a sample, as the sampled controller carries it on, and the
//! command before where commands come late. Everything else that a controller remembers of its last sample follows from these: built
//! anew from its recipe with that state, it takes the sample again. The map is that of the run itself, with exact measurements, no
//! limits and no pushes; the agent is by itself, and what it hears is put in. Where a filter stands for the velocities, what it gives
//! is state of the map: it goes a part of 1 − e^(−ωh) to the difference of positions over a period.

use super::assembly::Assembly;
use super::columns::{Columns, Inputs};
use super::error::SetupError;
use super::probe::alone;
use super::recipes::built;
use super::valid::message_len;
use crate::Signal;
use crate::setup::{Actuators, Control, Failures, Sensors, Setup, Solver, VelocitySensor};

/// Steps of the classical Runge–Kutta method before a late command, and after it: the first that agree with the next ones, else the
/// most. A plant that is fast in itself needs more.
const STEPS: [u32; 5] = [2, 6, 24, 96, 384];
/// How far a state is moved to try them, and how near they have to be, relative to its size: what they miss of the movement is a millionth of it
/// where nothing else moves.
const TRIED: f64 = 1e-3;
const AGREED: f64 = 1e-9;
/// After how many periods they are tried again: on its way an agent comes to where it is faster.
const STEADY: u32 = 32;
/// How far a state is moved to both sides, relative to its size.
const APART: f64 = 1e-6;

/// One period of an agent in its network, as matrices, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledLoop {
    /// Numbers of state.
    pub size: usize,
    /// How the state at a sample depends on that at the sample before, of an agent whose neighbours stay where they are.
    pub own: Vec<f64>,
    /// Numbers in a message.
    pub message: usize,
    /// How its message depends on its state: `message` rows.
    pub tells: Vec<f64>,
    /// How the state at a sample depends on the mean of what is heard at the sample before and at the same: `message` columns.
    pub hears: [Vec<f64>; 2],
}

/// Periods of an agent by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periods {
    /// When the first begins, s: targets are those of then.
    pub begin_s: f64,
    /// How many pass before it is looked at.
    pub after: u32,
    /// Over how many it is looked at: one at least.
    pub over: u32,
}

impl Periods {
    /// The first.
    pub const FIRST: Periods = Periods { begin_s: 0.0, after: 0, over: 1 };
}

/// These periods of agent `index` of `setup`, where it hears others with weights that sum to `degree` and that agree with it as it starts: what is
/// heard is that of the first of them. Behind the state of plant and controller stand what a filter gives for the velocities, where
/// they are filtered, and the command before, where it comes late. `None` when control is continuous, and where something is not finite.
///
/// # Errors
/// [`SetupError`] when the law cannot build the agent.
pub fn sampled_loop(
    setup: &Setup,
    index: usize,
    degree: f64,
    periods: Periods,
) -> Result<Option<SampledLoop>, SetupError> {
    let (Some(control), Some(own)) = (&setup.control, alone(setup, index)) else { return Ok(None) };
    let quick = match control.sensors.velocity {
        VelocitySensor::Measured => None,
        VelocitySensor::Filtered { cut_off_hz } => {
            Some(-libm::expm1(-core::f64::consts::TAU * cut_off_hz / control.sample_hz))
        }
    };
    let exact = Control {
        sensors: Sensors::default(),
        actuators: Actuators::default(),
        failures: Failures::default(),
        ..control.clone()
    };
    let alone = Setup { solver: Solver { balance: false, ..own.solver }, control: Some(exact.clone()), ..own };
    let law = alone.agents[0].law.clone();
    let block = law.block(&Assembly::new(&alone, &[0]))?;
    let heard = [(); 2].map(|()| vec![0.0; message_len(&alone)]);
    let moving = |k: &usize| block.0.locate(*k).1 == Signal::Velocity;
    let filtered = if quick.is_some() { (0..block.0.state_len()).filter(moving).collect() } else { Vec::new() };
    Period {
        columns: block.0,
        setup: &alone,
        control: exact,
        degree,
        heard,
        quick,
        filtered,
        begin_s: periods.begin_s,
        steps: STEPS[0],
    }
    .linearised(periods)
}

/// What makes a period pass.
struct Period<'a> {
    columns: Box<dyn Columns>,
    setup: &'a Setup,
    control: Control,
    /// Σ_j w_ij.
    degree: f64,
    /// Σ_j w_ij m_j of what neighbours tell, at the beginning and at the end.
    heard: [Vec<f64>; 2],
    /// 1 − e^(−ωh) of the filter.
    quick: Option<f64>,
    /// The velocities in the state that a filter stands for.
    filtered: Vec<usize>,
    /// When it begins.
    begin_s: f64,
    /// Steps before a late command, and after it.
    steps: u32,
}

/// What a period brings.
struct Passed {
    /// The state at its end.
    state: Vec<f64>,
    /// What was told at its beginning.
    transmitted: Vec<f64>,
}

impl Period<'_> {
    fn linearised(mut self, Periods { after, over, .. }: Periods) -> Result<Option<SampledLoop>, SetupError> {
        let mut x = Vec::new();
        self.columns.append_start(&self.setup.agents, &mut x);
        let agent = &self.setup.agents[0].name;
        let error = |error| SetupError::Length { agent: agent.clone(), error };
        let (degree, none) = ([self.degree], self.heard[0].clone());
        self.columns.start(&self.setup.agents, &mut x, &degree, &none).map_err(error)?;
        x.extend(self.filtered.iter().map(|k| x[*k]).collect::<Vec<_>>());
        // All agree with the agent as it starts.
        let Passed { transmitted, .. } = self.passes(&x, false, 1)?;
        let agreed: Vec<f64> = transmitted.iter().map(|entry| self.degree * entry).collect();
        self.heard = [agreed.clone(), agreed];
        let is_late = self.control.computation_delay_s > 0.0;
        if is_late {
            let Passed { state, .. } = self.passes(&x, false, 1)?;
            x.extend(state.get(x.len()..).unwrap_or_default().to_vec());
        }
        self.choose_steps(&x, is_late)?;
        let mut left = after;
        while left > 0 {
            let some = left.min(STEADY);
            x = self.passes(&x, is_late, some)?.state;
            self.begin_s += f64::from(some) / self.control.sample_hz;
            left -= some;
            self.choose_steps(&x, is_late)?;
        }
        let (n, m) = (x.len(), transmitted.len());
        let [mut own, mut tells] = [vec![0.0; n * n], vec![0.0; m * n]];
        let mut hears = [vec![0.0; n * m], vec![0.0; n * m]];
        for column in 0..n {
            let apart = APART * (1.0 + x[column].abs());
            let mut moved = |by: f64| {
                let mut x = x.clone();
                x[column] += by;
                self.passes(&x, is_late, over)
            };
            let (above, below) = (moved(apart)?, moved(-apart)?);
            let slope = |(above, below): (&f64, &f64)| (above - below) / (2.0 * apart);
            for (row, pair) in above.state.iter().zip(&below.state).enumerate() {
                own[row * n + column] = slope(pair);
            }
            for (row, pair) in above.transmitted.iter().zip(&below.transmitted).enumerate() {
                tells[row * n + column] = slope(pair);
            }
        }
        let is_heard = self.degree > 0.0;
        for (when, hears) in hears.iter_mut().enumerate().filter(|_| is_heard) {
            for column in 0..m {
                let apart = APART * (1.0 + self.heard[when][column].abs());
                let mut moved = |by: f64| {
                    self.heard[when][column] += by;
                    let passed = self.passes(&x, is_late, over);
                    self.heard[when][column] -= by;
                    passed
                };
                let (above, below) = (moved(apart)?, moved(-apart)?);
                for (row, (above, below)) in above.state.iter().zip(&below.state).enumerate() {
                    hears[row * m + column] = self.degree * (above - below) / (2.0 * apart);
                }
            }
        }
        let all = || own.iter().chain(&tells).chain(hears.iter().flatten());
        let is_finite = all().all(|entry| entry.is_finite());
        Ok(is_finite.then_some(SampledLoop { size: n, own, message: m, tells, hears }))
    }

    /// As many steps as it takes near `x`.
    fn choose_steps(&mut self, x: &[f64], is_late: bool) -> Result<(), SetupError> {
        let moved: Vec<f64> = x.iter().map(|x| x + TRIED * (1.0 + x.abs())).collect();
        let mut with = |steps: u32| {
            self.steps = steps;
            self.passes(&moved, is_late, 1).map(|passed| passed.state)
        };
        let mut passed: Vec<f64> = with(STEPS[0])?;
        for [steps, more] in STEPS.array_windows() {
            let finer = with(*more)?;
            // What is no number is near to nothing.
            let near = |(a, b): (&f64, &f64)| (a - b).abs() <= AGREED * (1.0 + b.abs());
            if passed.iter().zip(&finer).all(near) {
                self.steps = *steps;
                return Ok(());
            }
            passed = finer;
        }
        Ok(())
    }

    /// The state so many periods after `x`, one at least, and what is told at the beginning of the first. Where commands are late, `x` ends
    /// with what the actuators held until then, and so does what comes after it; without that it is as if they had held what is commanded now.
    fn passes(&mut self, x: &[f64], is_late: bool, periods: u32) -> Result<Passed, SetupError> {
        let (begin_s, period_s) = (self.begin_s, 1.0 / self.control.sample_hz);
        let mut passed = Passed { state: x.to_vec(), transmitted: self.heard[0].clone() };
        let is_as_before = self.heard[0] == self.heard[1];
        for period in 0..periods {
            // What has run away stays away.
            if period > 0 && passed.state.iter().any(|x| !x.is_finite()) {
                break;
            }
            // The sample at the end of a period is that at the beginning of the next one, unless they hear different things.
            if period == 0 {
                self.begin(&mut passed.state, &mut passed.transmitted)?;
            } else if !is_as_before {
                self.begin(&mut passed.state, &mut self.heard[0].clone())?;
            }
            self.go_on(&mut passed.state, is_late);
            self.begin_s += period_s;
        }
        self.begin_s = begin_s;
        Ok(passed)
    }

    /// Takes the sample at `x` with controllers that are built anew; `transmitted` is what is told.
    fn begin(&mut self, x: &mut [f64], transmitted: &mut [f64]) -> Result<(), SetupError> {
        let (x, rest) = x.split_at_mut(self.columns.state_len());
        let recipes = self.columns.recipes(self.setup, x)?;
        let agent = &self.setup.agents[0].name;
        let controllers: Result<Vec<_>, _> = recipes.iter().map(|(_, recipe)| built(recipe, agent)).collect();
        self.columns.sample(&self.control, controllers?);
        self.take(self.begin_s, x, &rest[..self.filtered.len()], 0, transmitted);
        Ok(())
    }

    /// From a sample that was taken to the next one, which is taken.
    fn go_on(&mut self, state: &mut Vec<f64>, is_late: bool) {
        let period_s = 1.0 / self.control.sample_hz;
        let late_s = self.control.computation_delay_s;
        let (x, rest) = state.split_at_mut(self.columns.state_len());
        let (filter, before) = rest.split_at_mut(self.filtered.len());
        let mut command = Vec::new();
        self.columns.taken(&mut |digital| command.extend_from_slice(digital.taken(0, 0.0).command));
        let begun = self.positions(x);
        if is_late {
            self.columns.hold(before);
            self.flow(x, [self.begin_s, self.begin_s + late_s]);
        }
        self.columns.apply();
        self.flow(x, [self.begin_s + if is_late { late_s } else { 0.0 }, self.begin_s + period_s]);
        if let Some(quick) = self.quick {
            let ended = self.positions(x);
            for (f, (end, begin)) in filter.iter_mut().zip(ended.iter().zip(&begun)) {
                *f += quick * ((end - begin) / period_s - *f);
            }
        }
        let mut ignored = self.heard[1].clone();
        self.take(self.begin_s + period_s, x, filter, 1, &mut ignored);
        if late_s > 0.0 {
            state.truncate(self.columns.state_len() + self.filtered.len());
            state.extend(command);
        }
    }

    /// Those whose velocities are filtered.
    fn positions(&self, x: &[f64]) -> Vec<f64> {
        let all = (0..x.len()).filter(|k| self.columns.locate(*k).1 == Signal::Position);
        all.take(self.filtered.len()).map(|k| x[k]).collect()
    }

    /// A sample; `transmitted` is what it transmits.
    fn take(&mut self, now_s: f64, x: &mut [f64], filter: &[f64], when: usize, transmitted: &mut [f64]) {
        let mut seen = x.to_vec();
        self.filtered.iter().zip(filter).for_each(|(k, f)| seen[*k] = *f);
        self.columns.sense(now_s, &seen, transmitted);
        let degree = [self.degree];
        let inputs = Inputs { degree: &degree, sums: &self.heard[when], external: None };
        self.columns.command(now_s, inputs, x);
    }

    /// The plant moves under what the actuators hold.
    fn flow(&mut self, x: &mut [f64], [from_s, until_s]: [f64; 2]) {
        let h = (until_s - from_s) / f64::from(self.steps);
        let degree = [self.degree];
        let inputs = Inputs { degree: &degree, sums: &self.heard[0], external: None };
        let n = x.len();
        let (mut k, mut stage, mut sum) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for step in 0..self.steps {
            let t_s = from_s + h * f64::from(step);
            sum.fill(0.0);
            stage.copy_from_slice(x);
            for (when, weight, next) in [(0.0, 1.0, 0.5), (0.5, 2.0, 0.5), (0.5, 2.0, 1.0), (1.0, 1.0, 0.0)] {
                self.columns.rates(t_s + when * h, &stage, inputs, &mut k);
                for i in 0..n {
                    sum[i] += weight * k[i];
                    stage[i] = x[i] + next * h * k[i];
                }
            }
            x.iter_mut().zip(&sum).for_each(|(x, sum)| *x += h / 6.0 * sum);
            self.columns.settle(x);
        }
    }
}
