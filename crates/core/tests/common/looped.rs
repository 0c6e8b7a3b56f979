//! A plant under its controller, in continuous time, for tests of single systems.

use forwardstep_core::controller::{Balance, Controller, ControllerInput, ControllerOutput, Jet, Jets, Truth};
use forwardstep_core::plant::{Plant, total};
use forwardstep_core::reference::Heard;

/// Plant and controller side by side; the state is that of the plant, then that of the controller.
pub(crate) struct Looped<C: Controller, T> {
    pub(crate) plant: C::Plant,
    pub(crate) controller: C,
    /// The target at a time.
    pub(crate) target: T,
    /// What acts from outside, always.
    pub(crate) external: Vec<f64>,
    scratch: (<C::Plant as Plant>::Scratch, C::Scratch),
    pub(crate) output: Vec<f64>,
    pub(crate) input: Vec<f64>,
    pub(crate) shown: Vec<f64>,
}

impl<C: Controller, T: Fn(f64) -> Vec<Jet>> Looped<C, T> {
    pub(crate) fn new(plant: C::Plant, controller: C, target: T) -> Self {
        Looped {
            scratch: (plant.scratch(), controller.scratch()),
            output: vec![0.0; plant.output_len()],
            input: vec![0.0; total(&plant.inputs())],
            shown: vec![0.0; total(&controller.shown())],
            external: Vec::new(),
            plant,
            controller,
            target,
        }
    }

    fn split(&self) -> usize {
        total(&self.plant.states())
    }

    /// The whole state at the start, for a plant at `x`.
    pub(crate) fn start(&mut self, x: &[f64], wanted: &[Vec<f64>]) -> Vec<f64> {
        let (target, sums) = ((self.target)(0.0), vec![0.0; self.plant.axes()]);
        self.plant.output(&mut self.scratch.0, x, &mut self.output).unwrap();
        let heard = Heard::new(&[0.0], &sums, sums.len()).unwrap();
        let given = ControllerInput {
            measured: self.controller.see(&self.output).unwrap(),
            heard,
            target: Jets::from(&target[..]),
        };
        let mut state = x.to_vec();
        state.resize(x.len() + total(&self.controller.states()), 0.0);
        self.controller.start(&mut self.scratch.1, given, wanted, &mut state[x.len()..]).unwrap();
        state
    }

    /// f(t, x), with what is asked and shown left in place.
    pub(crate) fn rate(&mut self, t: f64, x: &[f64]) -> Vec<f64> {
        let (own, state) = x.split_at(self.split());
        let (target, sums) = ((self.target)(t), vec![0.0; self.plant.axes()]);
        self.plant.output(&mut self.scratch.0, own, &mut self.output).unwrap();
        let heard = Heard::new(&[0.0], &sums, sums.len()).unwrap();
        let given = ControllerInput {
            measured: self.controller.see(&self.output).unwrap(),
            heard,
            target: Jets::from(&target[..]),
        };
        let mut dx = vec![0.0; x.len()];
        let (d_own, d_state) = dx.split_at_mut(own.len());
        let asked = ControllerOutput { input: &mut self.input, d_state, shown: &mut self.shown };
        self.controller.evaluate(&mut self.scratch.1, given, state, asked).unwrap();
        self.plant.limit(own, &mut self.input);
        self.plant.rate(&mut self.scratch.0, own, &self.input, &self.external, d_own).unwrap();
        dx
    }

    pub(crate) fn balance(&mut self, t: f64, x: &[f64]) -> Balance {
        self.rate(t, x);
        let (own, state) = x.split_at(self.split());
        let (target, sums) = ((self.target)(t), vec![0.0; self.plant.axes()]);
        let heard = Heard::new(&[0.0], &sums, sums.len()).unwrap();
        let given = ControllerInput {
            measured: self.controller.see(&self.output).unwrap(),
            heard,
            target: Jets::from(&target[..]),
        };
        let truth = Truth { plant: &self.plant, state: own, external: &self.external };
        self.controller.balance(&mut self.scratch.1, truth, given, state, &self.shown).unwrap()
    }

    /// d/dt of `value` along f, by differences of order four.
    pub(crate) fn slope(&mut self, t: f64, x: &[f64], value: impl Fn(&mut Self, f64, &[f64]) -> f64) -> f64 {
        let dx = self.rate(t, x);
        let h = 1e-4;
        let mut at = |k: f64| {
            let moved: Vec<f64> = x.iter().zip(&dx).map(|(x, dx)| x + k * h * dx).collect();
            value(self, t + k * h, &moved)
        };
        (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h)
    }

    /// One step of the classical Runge–Kutta method, with the states settled.
    pub(crate) fn step(&mut self, t: f64, h: f64, x: &mut [f64]) {
        let along = |x: &[f64], k: &[f64], h: f64| x.iter().zip(k).map(|(x, k)| x + h * k).collect::<Vec<_>>();
        let k1 = self.rate(t, x);
        let k2 = self.rate(t + h / 2.0, &along(x, &k1, h / 2.0));
        let k3 = self.rate(t + h / 2.0, &along(x, &k2, h / 2.0));
        let k4 = self.rate(t + h, &along(x, &k3, h));
        for (i, x) in x.iter_mut().enumerate() {
            *x += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        let (own, state) = x.split_at_mut(self.split());
        self.plant.settle(own);
        self.controller.settle(state);
    }
}

/// A polynomial in t with the given derivatives at zero, as a jet at t.
pub(crate) fn polynomial(derivatives: &Jet, t: f64) -> Jet {
    let mut jet = [0.0; 5];
    for (k, value) in jet.iter_mut().enumerate() {
        let mut term = 1.0;
        for (j, derivative) in derivatives[k..].iter().enumerate() {
            *value += derivative * term;
            term *= t / (j + 1) as f64;
        }
    }
    jet
}
