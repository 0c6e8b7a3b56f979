//! A controller whose equations are closures.

use alloc::vec::Vec;
use core::fmt;
use core::marker::PhantomData;

use super::{Balance, Controller, ControllerInput, ControllerOutput, Jet, Jets, Singularity, Truth};
use crate::LengthError;
use crate::plant::{Plant, total};
use crate::reference::{Heard, Position};
use crate::signal::{Block, Signal};

/// u = h(y, η, x_d, χ) and χ̇ = f(y, η, x_d, χ) for a plant `P` whose whole output y is measured, where η is what is heard of
/// neighbours, x_d a target and χ the state of the controller.
///
/// **Requires** of its closures that they allocate nothing and do not panic when every slice is as long as its blocks say.
///
/// ```
/// use forwardstep_core::controller::{ControllerOutput, Balance, Controller, Feedback, FeedbackInput, ControllerInput, Jets, Truth};
/// use forwardstep_core::plant::{Plant, VectorField};
/// use forwardstep_core::reference::Heard;
/// use forwardstep_core::signal::Signal;
///
/// // A ẋ = u. x → x_d by u = A (ẋ_d − k (x − x_d)), and V = ½ A (x − x_d)² loses k A (x − x_d)².
/// let (area, k) = (2.0, 0.5);
/// let tank = VectorField::new(1, [(Signal::Position, 1)], [(Signal::Torque, 1)], move |_, u, dx| dx[0] = u[0] / area);
/// let law = move |given: FeedbackInput<'_>, asked: ControllerOutput<'_>| {
///     let [x_d, dx_d, ..] = given.target(0);
///     asked.shown[0] = given.output[0] - x_d;
///     asked.input[0] = area * (dx_d - k * asked.shown[0]);
/// };
/// let balance = move |_: Truth<'_, _>, _: FeedbackInput<'_>, shown: &[f64]| {
///     let square = area * shown[0] * shown[0];
///     Balance { value: 0.5 * square, dissipation: k * square }
/// };
/// let law = Feedback::new(&tank, [(Signal::Error, 1)], law, balance);
///
/// let (x, mut u, mut dx, mut error) = ([3.0], [0.0], [0.0], [0.0]);
/// let given = ControllerInput { measured: law.see(&x)?, heard: Heard::new(&[], &[0.0], 1)?, target: Jets::from(&[[1.0, 0.0, 0.0, 0.0, 0.0]]) };
/// law.evaluate(&mut (), given, &[], ControllerOutput { input: &mut u, d_state: &mut [], shown: &mut error })?;
/// tank.rate(&mut (), &x, &u, &[], &mut dx)?;
/// let truth = Truth { plant: &tank, state: &x, external: &[] };
/// // V̇ = A (x − x_d) ẋ here.
/// assert_eq!(law.balance(&mut (), truth, given, &[], &error)?.dissipation, -area * error[0] * dx[0]);
/// # Ok::<(), forwardstep_core::LengthError>(())
/// ```
pub struct Feedback<P, L, B> {
    axes: usize,
    outputs: usize,
    inputs: usize,
    states: Vec<Block>,
    start: Vec<f64>,
    shown: Vec<Block>,
    target_derivatives: usize,
    law: L,
    balance: B,
    plant: PhantomData<fn(&P)>,
}

/// What a [`Feedback`] goes by.
#[derive(Clone, Copy)]
pub struct FeedbackInput<'a> {
    /// y, the whole output of the plant.
    pub output: &'a [f64],
    /// What neighbours transmit.
    pub heard: Heard<'a, Position>,
    target: Jets<'a>,
    /// χ.
    pub state: &'a [f64],
}

impl<P, L, B> Feedback<P, L, B>
where
    P: Plant,
    L: Fn(FeedbackInput<'_>, ControllerOutput<'_>),
    B: Fn(Truth<'_, P>, FeedbackInput<'_>, &[f64]) -> Balance,
{
    /// A feedback without a state of its own. `shown` says what it tells of itself, `law` fills in the input and what is shown,
    /// `balance` gives V and −V̇ from what is shown.
    pub fn new(plant: &P, shown: impl Into<Vec<Block>>, law: L, balance: B) -> Self {
        Feedback {
            axes: plant.axes(),
            outputs: plant.output_len(),
            inputs: total(&plant.inputs()),
            states: Vec::new(),
            start: Vec::new(),
            shown: shown.into(),
            target_derivatives: Jets::LEAST,
            law,
            balance,
            plant: PhantomData,
        }
    }

    /// The same with a state χ, block by block what it is and where it starts; the law also fills in χ̇.
    pub fn with_state(mut self, blocks: impl IntoIterator<Item = (Signal, Vec<f64>)>) -> Self {
        for (signal, start) in blocks {
            self.states.push((signal, start.len()));
            self.start.extend(start);
        }
        self
    }

    /// The same with a target that has `derivatives`, where the law needs more than four.
    pub fn with_target_derivatives(self, derivatives: usize) -> Self {
        Feedback { target_derivatives: derivatives.max(Jets::LEAST), ..self }
    }

    /// What the closures take, every slice as long as it should be.
    fn input<'a>(
        &self,
        output: &'a [f64],
        heard: Heard<'a, Position>,
        target: Jets<'a>,
        state: &'a [f64],
    ) -> Result<FeedbackInput<'a>, LengthError> {
        LengthError::check("state", self.start.len(), state.len())?;
        if !target.is_empty() {
            LengthError::check("the target", self.axes, target.len())?;
        }
        Ok(FeedbackInput { output, heard, target, state })
    }
}

impl FeedbackInput<'_> {
    /// Where the axis should be, with four derivatives; zero where there is no target.
    pub fn target(&self, axis: usize) -> Jet {
        self.target.jet(axis)
    }

    /// The same with all derivatives that were asked for; nothing where there is no target.
    pub fn target_in_full(&self, axis: usize) -> &[f64] {
        self.target.get(axis).unwrap_or_default()
    }
}

impl<P, L: Clone, B: Clone> Clone for Feedback<P, L, B> {
    fn clone(&self) -> Self {
        let (states, start, shown) = (self.states.clone(), self.start.clone(), self.shown.clone());
        let (law, balance) = (self.law.clone(), self.balance.clone());
        Feedback { states, start, shown, law, balance, ..*self }
    }
}

impl<P, L, B> fmt::Debug for Feedback<P, L, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Feedback { states, start, shown, .. } = self;
        f.debug_struct("Feedback")
            .field("states", states)
            .field("start", start)
            .field("shown", shown)
            .finish_non_exhaustive()
    }
}

impl<P, L, B> Controller for Feedback<P, L, B>
where
    P: Plant,
    L: Fn(FeedbackInput<'_>, ControllerOutput<'_>) + Clone + Send + Sync + 'static,
    B: Fn(Truth<'_, P>, FeedbackInput<'_>, &[f64]) -> Balance + Clone + Send + Sync + 'static,
{
    type Plant = P;
    type Exchange = Position;
    type Measured<'a> = &'a [f64];
    type Scratch = ();

    const MEASURES: &'static [&'static str] = &["the output"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        self.target_derivatives
    }

    fn scratch(&self) {}

    fn states(&self) -> Vec<Block> {
        self.states.clone()
    }

    fn shown(&self) -> Vec<Block> {
        self.shown.clone()
    }

    fn reads(&self, _: Signal) -> bool {
        true
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<&'a [f64], LengthError> {
        LengthError::check("output", self.outputs, output.len())?;
        Ok(output)
    }

    fn start(
        &self,
        (): &mut (),
        _: ControllerInput<'_, Self>,
        _: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", self.start.len(), state.len())?;
        state.copy_from_slice(&self.start);
        Ok(())
    }

    fn evaluate(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        LengthError::check("input", self.inputs, asked.input.len())?;
        LengthError::check("rate", self.start.len(), asked.d_state.len())?;
        LengthError::check("shown", total(&self.shown), asked.shown.len())?;
        let heard = Heard { degree: given.heard.degree, sums: given.heard.sums, time_s: given.heard.time_s };
        (self.law)(self.input(given.measured, heard, given.target, state)?, asked);
        Ok(())
    }

    fn settle(&self, _: &mut [f64]) {}

    fn trouble(&self, _: &[f64], _: &[f64]) -> Option<Singularity> {
        None
    }

    fn balance(
        &self,
        (): &mut (),
        truth: Truth<'_, P>,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        LengthError::check("shown", total(&self.shown), shown.len())?;
        let heard = Heard { degree: given.heard.degree, sums: given.heard.sums, time_s: given.heard.time_s };
        Ok((self.balance)(truth, self.input(given.measured, heard, given.target, state)?, shown))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controller::JetsBuffer;
    use crate::plant::VectorField;

    /// ẋ = u with an integrator: χ̇ = x − x_d, u = −x − χ.
    fn with_integrator() -> impl Controller<Plant: Plant<Scratch = ()>, Scratch = (), Exchange = Position> {
        let plant = VectorField::new(1, [(Signal::Position, 1)], [(Signal::Torque, 1)], |_, u, dx| dx[0] = u[0]);
        let law = |given: FeedbackInput<'_>, asked: ControllerOutput<'_>| {
            asked.shown[0] = given.output[0] - given.target(0)[0];
            asked.d_state[0] = asked.shown[0];
            asked.input[0] = -given.output[0] - given.state[0];
        };
        let balance = |_: Truth<'_, _>, given: FeedbackInput<'_>, shown: &[f64]| Balance {
            value: 0.5 * given.state[0] * given.state[0],
            dissipation: shown[0],
        };
        Feedback::new(&plant, [(Signal::Error, 1)], law, balance).with_state([(Signal::Reference(0), vec![0.25])])
    }

    #[test]
    fn closures_are_evaluated_where_they_are_asked_for() {
        let law = with_integrator();
        let heard = Heard::new(&[], &[0.0], 1).unwrap();
        let mut state = [0.0];
        let given = |target: &'static [Jet]| ControllerInput {
            measured: law.see(&[3.0]).unwrap(),
            heard,
            target: target.into(),
        };
        law.start(&mut (), given(&[]), &[], &mut state).unwrap();
        assert_eq!(state, [0.25]);
        let (mut input, mut d_state, mut shown) = ([0.0], [0.0], [0.0]);
        for (target, error) in [(&[][..], 3.0), (&[[1.0, 0.0, 0.0, 0.0, 0.0]][..], 2.0)] {
            let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
            law.evaluate(&mut (), given(target), &state, asked).unwrap();
            assert_eq!((input, d_state, shown), ([-3.25], [error], [error]));
        }
    }

    #[test]
    fn a_law_may_ask_for_more_derivatives_of_a_target_than_four() {
        let plant = VectorField::new(1, [(Signal::Position, 1)], [(Signal::Torque, 1)], |_, u, dx| dx[0] = u[0]);
        // u = x_d⁽⁶⁾, and nothing without a target.
        let law = |given: FeedbackInput<'_>, asked: ControllerOutput<'_>| {
            asked.input[0] = given.target_in_full(0).get(6).copied().unwrap_or(-1.0);
        };
        let balance = |_: Truth<'_, _>, _: FeedbackInput<'_>, _: &[f64]| Balance { value: 0.0, dissipation: 0.0 };
        let law = Feedback::new(&plant, [], law, balance);
        assert_eq!(law.target_derivatives(), 4);
        assert_eq!(law.clone().with_target_derivatives(2).target_derivatives(), 4);
        let law = law.with_target_derivatives(6);
        assert_eq!(law.target_derivatives(), 6);
        let mut target = JetsBuffer::new(1, 6);
        target.iter_mut().for_each(|jet| jet[6] = 0.7);
        for (target, expected) in [(target.jets(), 0.7), (Jets::NONE, -1.0)] {
            let given = ControllerInput {
                measured: law.see(&[3.0]).unwrap(),
                heard: Heard::new(&[], &[0.0], 1).unwrap(),
                target,
            };
            let mut input = [0.0];
            let asked = ControllerOutput { input: &mut input, d_state: &mut [], shown: &mut [] };
            law.evaluate(&mut (), given, &[], asked).unwrap();
            assert_eq!(input, [expected]);
        }
    }

    #[test]
    fn wrong_lengths_are_errors() {
        let law = with_integrator();
        assert!(law.see(&[1.0, 2.0]).is_err());
        for [target, state, input, rate, shown] in
            [[2, 1, 1, 1, 1], [1, 2, 1, 1, 1], [1, 1, 0, 1, 1], [1, 1, 1, 0, 1], [1, 1, 1, 1, 2]]
        {
            let target = vec![[0.0; 5]; target];
            let (mut input, mut d_state, mut diagnostics) = (vec![0.0; input], vec![0.0; rate], vec![0.0; shown]);
            let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut diagnostics };
            let heard = Heard::new(&[], &[0.0], 1).unwrap();
            let given = ControllerInput { measured: law.see(&[1.0]).unwrap(), heard, target: Jets::from(&target[..]) };
            assert!(law.evaluate(&mut (), given, &vec![0.0; state], asked).is_err());
        }
    }
}
