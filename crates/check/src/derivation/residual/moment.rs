//! The values of letters at one instant of one agent.

use std::ops::Range;

use forwardstep_core::controller::{Jet, JetsBuffer};
use forwardstep_sim::leader::FollowingDesign;
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{Column, Moment, Signal, StateRate};

use super::super::case::{Case, Led, Step};
use super::super::form::{Combination, Form, Letter, Operator, Quantity, Term, Vertex, number};
use super::super::formula::At as AtTime;
use super::Missing;
use super::robot::Model;
use crate::surroundings::dry_loss_w;

/// Entries of a vector, each with the size of what it is made of, which is what it is exact to.
pub(super) type Vector = Vec<[f64; 2]>;

/// Where the signals of every agent stand in its row.
pub(super) struct Columns(Vec<Vec<(Signal, Range<usize>)>>);

impl Columns {
    pub(super) fn new(agents: usize, columns: &[Column]) -> Columns {
        let mut all: Vec<Vec<(Signal, Range<usize>)>> = vec![Vec::new(); agents];
        for column in columns {
            let Some(own) = all.get_mut(column.agent) else { continue };
            let at = own.last().map_or(0, |(_, range)| range.end);
            match own.last_mut() {
                Some((signal, range)) if *signal == column.signal => range.end += 1,
                _ => own.push((column.signal, at..at + 1)),
            }
        }
        Columns(all)
    }
}

/// The instant, and what the agent is made of.
pub(super) struct At<'c, 'a> {
    pub(super) case: &'c Case<'a>,
    columns: &'c [(Signal, Range<usize>)],
    model: Option<&'c mut Model<'a>>,
    pub(super) moment: Moment<'c>,
    /// What reference dynamics from outside add that does not depend on the state, once it is known.
    pub(super) constant: Option<Vec<f64>>,
}

/// How near to a kink, relative to the time, an instant is taken to be at it.
const KINK: f64 = 1e-9;

fn jets(trajectory: &Trajectory, t_s: f64) -> Vec<Jet> {
    let mut jets = vec![[0.0; 5]; trajectory.axes()];
    trajectory.jets(t_s, &mut jets);
    jets
}

/// The motion of a leader that is no agent.
fn leader<'a>(case: &Case<'a>) -> Option<&'a Trajectory> {
    Some(&case.setup.following()?.motion()?.trajectory)
}

/// Entries as exact as they are.
pub(super) fn exact(values: impl IntoIterator<Item = f64>) -> Vector {
    values.into_iter().map(|value| [value, value.abs()]).collect()
}

/// `to` with so many times a vector more.
fn add(to: &mut Vector, factor: f64, vector: &[[f64; 2]]) {
    if to.is_empty() {
        to.resize(vector.len(), [0.0; 2]);
    }
    for (to, [value, size]) in to.iter_mut().zip(vector) {
        *to = [to[0] + factor * value, to[1] + (factor * size).abs()];
    }
}

/// A block of states, or the rates of one.
fn block(states: &[StateRate], wanted: Signal, rates: bool) -> Option<Vec<f64>> {
    let states = states.iter().filter(|state| state.signal == wanted);
    let values: Vec<f64> = states.map(|state| if rates { state.rate } else { state.value }).collect();
    (!values.is_empty()).then_some(values)
}

/// One vector less another.
fn less(mut one: Vector, other: &[[f64; 2]]) -> Vector {
    add(&mut one, -1.0, other);
    one
}

impl<'c, 'a> At<'c, 'a> {
    pub(super) fn new(
        case: &'c Case<'a>,
        columns: &'c Columns,
        mut model: Option<&'c mut Model<'a>>,
        moment: Moment<'c>,
    ) -> Self {
        if let Some(model) = &mut model {
            model.forget();
        }
        let columns = columns.0.get(moment.agent).map_or(&[][..], Vec::as_slice);
        At { case, columns, model, moment, constant: None }
    }

    /// A signal as it is recorded.
    pub(super) fn recorded(&self, wanted: Signal) -> Option<&'c [f64]> {
        let (_, range) = self.columns.iter().find(|(signal, _)| *signal == wanted)?;
        self.moment.values.get(range.clone())
    }

    /// A block of states, or the rates of one.
    pub(super) fn state(&self, wanted: Signal, rates: bool) -> Option<Vec<f64>> {
        block(self.moment.states, wanted, rates)
    }

    /// The k-th derivative in a chain of states, the last of which has a rate.
    fn chained(&self, chain: impl Iterator<Item = Signal>, k: usize) -> Result<Vec<f64>, Missing> {
        let known: Vec<Signal> = chain.take_while(|signal| self.state(*signal, false).is_some()).collect();
        let found = match (known.get(k), known.last()) {
            (Some(signal), _) => self.state(*signal, false),
            (None, Some(last)) if k == known.len() => self.state(*last, true),
            _ => None,
        };
        found.ok_or(Missing::Derivative)
    }

    /// q, q̇, …; ω of a spacecraft.
    pub(super) fn position(&self, k: usize) -> Result<Vec<f64>, Missing> {
        let higher = (2..).map(Signal::Derivative);
        match self.case.step {
            Step::Attitude(_) | Step::PassivityFilter(_) => self.chained([Signal::Velocity].into_iter(), k),
            _ => self.chained([Signal::Position, Signal::Velocity].into_iter().chain(higher), k),
        }
    }

    /// The same with the third derivative of the position of a vehicle, whose thrust and weight cancel when it hovers, as do the
    /// torques of a spacecraft's wheels that turn about nearly the same plane.
    ///
    /// What moves with an offset is as exact as that is.
    pub(super) fn moved(&mut self, k: usize) -> Result<Vector, Missing> {
        let mut moved = self.moved_less_offset(k)?;
        let offset = self.target().filter(|_| !self.case.is_led_to_target()).unwrap_or_default();
        let sizes = offset.iter().filter_map(|jet| jet.get(k));
        moved.iter_mut().zip(sizes).for_each(|(entry, size)| entry[1] += size.abs());
        Ok(moved)
    }

    fn moved_less_offset(&mut self, k: usize) -> Result<Vector, Missing> {
        match self.case.step {
            Step::Thrust(..) if k == 3 => self.jerk(),
            Step::Thrust(..) if k == 2 => {
                let weighed = self.position(2)?.into_iter().zip(self.weight().unwrap_or_default());
                Ok(weighed.map(|(ddx, weight)| [ddx, ddx.abs() + weight]).collect())
            }
            Step::Attitude(_) | Step::PassivityFilter(_) if k == 1 => self.turned_by_wheels(),
            _ => self.position(k).map(exact),
        }
    }

    /// z, ż, ….
    pub(super) fn reference(&self, k: usize) -> Result<Vec<f64>, Missing> {
        // The second state of (3), (119) and (122) is no derivative of z.
        let integrated = matches!(self.case.led, Led::PureIntegral(_)) || self.case.smooth().is_some();
        let most = if integrated { 1 } else { u8::MAX };
        let found = self.chained((0..most).map(Signal::Reference), k);
        // z that is no state is recorded.
        match (&self.case.led, &self.case.step, k) {
            (Led::Backstepping | Led::Leader(FollowingDesign::Observer { .. }, _), _, 0 | 1)
            | (_, Step::TipVelocity(_), 0 | 1) => {
                self.recorded(Signal::Reference(k as u8)).map(<[f64]>::to_vec).ok_or(Missing::Derivative)
            }
            _ => found,
        }
    }

    /// s, as the law has it where it shows it, and ṡ.
    fn error(&mut self, k: usize) -> Result<Vector, Missing> {
        let order = self.case.step.plant().saturating_sub(1);
        let mut s = less(self.moved(order + k)?, &exact(self.reference(k)?));
        // The highest derivative of a chain is a sum that may be much smaller than its parts.
        if let (1, Step::Chain(..)) = (k, &self.case.step) {
            for part in [Term::Drift, Term::Actuation] {
                let parts = self.chain_term(part).unwrap_or_default();
                s.iter_mut().zip(parts).for_each(|(s, part)| s[1] += part[1]);
            }
        }
        if let (0, Some(shown)) = (k, self.recorded(Signal::TrackingError)) {
            s.iter_mut().zip(shown).for_each(|(s, shown)| s[0] = *shown);
        }
        Ok(s)
    }

    /// y, and ẏ = λ_f (ẋ − ṗ) where y is λ_f (x − p).
    fn filter(&self, k: usize) -> Result<Vector, Missing> {
        let missing = Missing::Derivative;
        match (&self.case.step, k) {
            (Step::PositionOnly(_), 0) => Ok(exact(self.recorded(Signal::Filter).ok_or(missing)?.to_vec())),
            (Step::PositionOnly([_, rate]), 1) => {
                let mut rates = Vector::new();
                add(&mut rates, number(rate), &exact(self.position(1)?));
                add(&mut rates, -number(rate), &exact(self.state(Signal::Filter, true).ok_or(missing)?));
                Ok(rates)
            }
            (_, 0 | 1) => Ok(exact(self.state(Signal::Filter, k == 1).ok_or(missing)?)),
            _ => Err(missing),
        }
    }

    /// The k-th derivative of what is followed, unless it jumps at this instant.
    pub(super) fn jet(&self, trajectory: Option<&Trajectory>, k: usize) -> Result<Vector, Missing> {
        let (trajectory, t_s) = (trajectory.ok_or(Missing::Neighbour)?, self.moment.t_s);
        let near_s = KINK * t_s.abs().max(1.0);
        if k > trajectory.known_derivatives() {
            return Err(Missing::Derivative);
        }
        let at = |t_s: f64| -> Vec<f64> {
            let mut jets = JetsBuffer::new(trajectory.axes(), k);
            trajectory.jets_into(t_s, &mut jets);
            jets.jets().iter().map(|jet| jet[k]).collect()
        };
        let [now, before, after] = [t_s, t_s - near_s, t_s + near_s].map(at);
        let mut found = Vec::new();
        for ((now, before), after) in now.iter().zip(&before).zip(&after) {
            if (after - before).abs() > KINK.sqrt() * now.abs().max(1.0) {
                return Err(Missing::Kink);
            }
            found.push(*now);
        }
        Ok(exact(found))
    }

    /// The trajectory that the agent follows, or its offset.
    pub(super) fn target(&self) -> Option<Vec<Jet>> {
        let trajectory = self.case.setup.agents.get(self.moment.agent)?.target.as_ref()?;
        Some(jets(trajectory, self.moment.t_s))
    }

    /// The k-th derivative of an agent's own letter, or of the leader's.
    fn own(&mut self, quantity: Quantity, k: usize) -> Result<Vector, Missing> {
        match (quantity.letter, quantity.vertex) {
            (Letter::Position, Vertex::Leader) => self.jet(leader(self.case), k),
            (_, Vertex::Leader | Vertex::LateLeader | Vertex::Neighbour) => Err(Missing::Neighbour),
            (Letter::Position, Vertex::Own) => self.moved(k),
            (Letter::Reference, Vertex::Own) => self.reference(k).map(exact),
            (Letter::Error, Vertex::Own) => self.error(k),
            (Letter::Filter, Vertex::Own) => self.filter(k),
            (Letter::Target, Vertex::Own) => self.jet(self.case.setup.agents[self.moment.agent].target.as_ref(), k),
            (Letter::Observed, Vertex::Own) => {
                self.chained([Signal::LeaderPosition, Signal::LeaderVelocity].into_iter(), k).map(exact)
            }
            (Letter::Composite, Vertex::Own) => self.chained([Signal::Composite].into_iter(), k).map(exact),
            (Letter::Integral, Vertex::Own) if k < 2 => {
                self.state(Signal::Reference(1), k == 1).map(exact).ok_or(Missing::Derivative)
            }
            (Letter::Deviation, Vertex::Own) => self.spacecraft_error(k),
            (Letter::Term(term), Vertex::Own) => self.term(term, k),
            (Letter::Integral | Letter::ReferenceDeviation | Letter::Coupled | Letter::Variable(_), Vertex::Own) => {
                Err(Missing::Derivative)
            }
        }
    }

    /// Σ_j w_ij of the k-th derivative of a letter.
    fn in_network(&mut self, quantity: Quantity, k: usize) -> Result<Vector, Missing> {
        let (degree, axes) = (self.moment.degree, self.case.setup.agents[self.moment.agent].robot.axes.len());
        let heard = |k: usize| {
            let sums = self.moment.sums.get(k * axes..(k + 1) * axes);
            sums.map(|sums| exact(sums.to_vec())).ok_or(Missing::Neighbour)
        };
        match (quantity.letter, quantity.vertex, k) {
            (Letter::Position, Vertex::Neighbour, k) => heard(k).or_else(|_| self.at_once(k)),
            (Letter::Observed | Letter::Composite, Vertex::Neighbour, k) => heard(k),
            (Letter::Coupled, _, 0) => {
                let mut sum = Vector::new();
                add(&mut sum, degree, &exact(self.position(0)?));
                Ok(less(sum, &heard(0)?))
            }
            (_, Vertex::Neighbour | Vertex::LateLeader, _) => Err(Missing::Neighbour),
            (_, Vertex::Own | Vertex::Leader, k) => {
                let mut sum = Vector::new();
                add(&mut sum, degree, &self.own(quantity, k)?);
                Ok(sum)
            }
        }
    }

    /// Σ_j w_ij of the k-th derivative of q_j beyond what is transmitted, on a fixed graph on which no message is late: from the states of the others
    /// and their rates.
    fn at_once(&self, k: usize) -> Result<Vector, Missing> {
        let setup = self.case.setup;
        let network = &setup.network;
        let edges = network.schedule.constant_graph().ok_or(Missing::Neighbour)?;
        if self.case.heard() != AtTime::Now || !network.coupling.is_linear() {
            return Err(Missing::Neighbour);
        }
        let axes = setup.agents[self.moment.agent].robot.axes.len();
        let mut sum = exact(vec![0.0; axes]);
        for edge in edges.iter().filter(|edge| edge.to == self.moment.agent) {
            let weight = edge.weight.constant().ok_or(Missing::Neighbour)?;
            let moved = match self.moment.agents.get(edge.from) {
                Some(states) => {
                    let (signal, rates) = if k == 0 { (Signal::Position, false) } else { (Signal::Velocity, k == 2) };
                    let found = block(states, signal, rates).filter(|_| k <= 2);
                    exact(found.ok_or(Missing::Neighbour)?)
                }
                None => self.jet(leader(self.case), k)?,
            };
            add(&mut sum, weight, &moved);
        }
        Ok(sum)
    }

    /// A form that is to be zero.
    pub(super) fn form(&mut self, form: &Form) -> Result<Vector, Missing> {
        let mut sum = Vector::new();
        self.combination(&form.own, At::operated, &mut sum)?;
        self.combination(&form.network, At::in_network, &mut sum)?;
        if sum.is_empty() { Err(Missing::Definition) } else { Ok(sum) }
    }

    fn combination(
        &mut self,
        all: &Combination,
        value: fn(&mut Self, Quantity, usize) -> Result<Vector, Missing>,
        sum: &mut Vector,
    ) -> Result<(), Missing> {
        for (quantity, a) in all.terms() {
            for (k, c) in a.coefficients().iter().enumerate() {
                let c = number(c);
                if c != 0.0 {
                    add(sum, c, &value(self, quantity, k)?);
                }
            }
        }
        Ok(())
    }

    fn operated(&mut self, quantity: Quantity, k: usize) -> Result<Vector, Missing> {
        let Quantity { operator, letter, .. } = quantity;
        match operator {
            Operator::Identity => self.own(quantity, k),
            Operator::Momentum => self.turned(letter, k),
            _ => {
                let vector = self.own(quantity, k)?;
                self.under(operator, &vector)
            }
        }
    }

    /// An agent's model, with the states that it is asked at.
    pub(super) fn model(&mut self) -> Result<&mut Model<'a>, Missing> {
        self.model.as_deref_mut().ok_or(Missing::Term)
    }

    fn term(&mut self, term: Term, k: usize) -> Result<Vector, Missing> {
        let recorded = |signal| self.recorded(signal).map(|values| exact(values.to_vec())).ok_or(Missing::Term);
        match (term, k) {
            (Term::Constant, 0) => self.constant.clone().map(exact).ok_or(Missing::Term),
            (Term::Sign, 0) => recorded(Signal::Selection),
            (Term::Protocol, 0) => self.protocol(),
            (Term::Torque, 0) => recorded(Signal::Torque),
            (Term::Input, 0) if matches!(self.case.step, Step::PositionOnly(_)) => recorded(Signal::Torque),
            (Term::External | Term::Disturbance, 1..) if self.is_pushed() => Err(Missing::Pushed),
            (Term::External | Term::Disturbance, 1..) => Ok(exact(self.position(0)?.iter().map(|_| 0.0))),
            (Term::External | Term::Disturbance, 0) => match (recorded(self.acting()), self.is_pushed()) {
                (Err(_), true) => Err(Missing::Pushed),
                (Err(_), false) => Ok(exact(self.position(0)?.iter().map(|_| 0.0))),
                (found, _) => found,
            },
            (Term::Input | Term::Weight | Term::MassEstimate | Term::MassError, 0) => self.vehicle_term(term),
            (Term::Drift | Term::Actuation | Term::ChainRegressorError | Term::ImmersionError, 0) => {
                self.chain_term(term)
            }
            (Term::MassEstimateRate | Term::MassErrorRate, 0) => self.mass_times_rate(term),
            (Term::Gravity | Term::Regressor | Term::RegressorError | Term::Friction | Term::ReferenceFriction, 0) => {
                self.robot_term(term)
            }
            (Term::TaskForce | Term::JointReference, _) => self.task_term(term, k),
            (
                Term::DesiredRate
                | Term::DesiredAcceleration
                | Term::AttitudeError
                | Term::AttitudeDifference
                | Term::AttitudeDamping
                | Term::AttitudeErrorRate
                | Term::GyroscopicPull,
                _,
            ) => self.spacecraft_term(term, k),
            (
                Term::Sign
                | Term::Torque
                | Term::Input
                | Term::MassEstimateRate
                | Term::MassErrorRate
                | Term::Gravity
                | Term::Friction
                | Term::ReferenceFriction
                | Term::Regressor
                | Term::RegressorError
                | Term::Weight
                | Term::MassEstimate
                | Term::MassError
                | Term::Drift
                | Term::Actuation
                | Term::ChainRegressorError
                | Term::ImmersionError
                | Term::Constant
                | Term::Protocol,
                _,
            ) => Err(Missing::Term),
        }
    }

    /// What acts on the equations of motion.
    fn acting(&self) -> Signal {
        match self.case.step {
            Step::Attitude(_) | Step::PassivityFilter(_) => Signal::ExternalTorque,
            Step::Chain(..) => Signal::Disturbance,
            Step::Robot { .. }
            | Step::PositionOnly(_)
            | Step::ModelReference(_)
            | Step::Thrust(..)
            | Step::TaskSpace(_)
            | Step::TipVelocity(_)
            | Step::Outside(_) => Signal::External,
        }
    }

    pub(super) fn is_pushed(&self) -> bool {
        let agent = &self.case.setup.agents[self.moment.agent];
        !agent.pushes.is_empty() || dry_loss_w(agent).is_some()
    }

    /// m̂ ż, or Δm ż.
    fn mass_times_rate(&self, term: Term) -> Result<Vector, Missing> {
        let estimate = self.recorded(Signal::Estimate).and_then(<[f64]>::first).ok_or(Missing::Term)?;
        let mass = self.case.setup.agents[self.moment.agent].robot.theta.first().ok_or(Missing::Term)?;
        let dz = self.reference(1)?;
        let [factor, size] = match term {
            Term::MassErrorRate => [estimate - mass, estimate.abs() + mass.abs()],
            _ => [*estimate, estimate.abs()],
        };
        Ok(dz.iter().map(|dz| [factor * dz, (size * dz).abs()]).collect())
    }

    /// The rate of an estimate less what its law makes it.
    pub(super) fn estimate(&mut self) -> Result<Vector, Missing> {
        match self.case.step {
            Step::PositionOnly(_) => return self.mass_estimate(),
            Step::Thrust(..) => return self.vehicle_estimate(),
            Step::Robot { .. }
            | Step::Attitude(_)
            | Step::PassivityFilter(_)
            | Step::ModelReference(_)
            | Step::TaskSpace(_)
            | Step::TipVelocity(_)
            | Step::Chain(..)
            | Step::Outside(_) => {}
        }
        let rate = exact(self.state(Signal::Estimate, true).ok_or(Missing::Term)?);
        Ok(less(rate, &self.adapted()?))
    }

    /// m̂' + γ* żᵀs, with m̂ = m̂(0) + I − γ* (żᵀx − ½ zᵀz) from the rate of I; with bounds that is μ, which comes back.
    fn mass_estimate(&self) -> Result<Vector, Missing> {
        let own = &self.case.setup.agents[self.moment.agent];
        let law = own.law.downcast::<forwardstep_sim::PositionOnlyLaw>().ok_or(Missing::Term)?;
        let integral = self.state(Signal::Estimate, true).ok_or(Missing::Term)?;
        let (x, dx) = (self.position(0)?, self.position(1)?);
        let (z, dz, ddz) = (self.reference(0)?, self.reference(1)?, self.reference(2)?);
        let mut sum = exact(integral);
        for k in 0..x.len() {
            // m̂' = İ − γ* (z̈ᵀx + żᵀẋ − żᵀz), and γ* żᵀ(ẋ − z) more.
            for term in [-ddz[k] * x[k], -dz[k] * dx[k], dz[k] * z[k], dz[k] * dx[k], -dz[k] * z[k]] {
                add(&mut sum, law.adaptation, &[[term, term.abs()]]);
            }
        }
        if let Some(range) = law.bounds {
            let integral =
                self.state(Signal::Estimate, false).and_then(|own| own.first().copied()).ok_or(Missing::Term)?;
            let by_parts: f64 = (0..x.len()).map(|k| dz[k] * x[k] - 0.5 * z[k] * z[k]).sum();
            let back = law.filter_per_s * range.beyond(law.estimate_start + integral - law.adaptation * by_parts);
            add(&mut sum, 1.0, &[[back, back.abs()]]);
        }
        Ok(sum)
    }
}
