//! The closed loop as a differential cascade, and its degree.

use super::dynamics::Dynamics;
use super::form::{Combination, Form, Letter, Quantity, Vertex};
use super::polynomial::Polynomial;

/// The upper subsystem: p^N q = …, in q and s alone. The lower one is s.
#[derive(Clone, Debug, PartialEq)]
pub struct Upper {
    /// N.
    pub order: usize,
    /// ℓ.
    pub reference_order: usize,
    /// k: z = p^(k−1) q − s.
    pub plant: usize,
    /// What stands for q: q itself, or how far it is from what it follows.
    pub state: Letter,
    /// What stands for s: s itself, or the output of the filter that takes its place.
    pub input: Letter,
    /// a(p) with s = a(p) y where y is the output of a filter; one where s stands for itself.
    pub filter: Polynomial,
    /// Whether neighbours have plants of the same order and the same roots, so that their variables are these too.
    pub alike: bool,
    /// The right side.
    pub right: Form,
}

impl Dynamics {
    /// z as it is defined by s: p^(k−1) q − s.
    pub fn virtual_control(&self) -> [(Letter, Polynomial); 2] {
        let s = -&Polynomial::one();
        [(Letter::Position, Polynomial::power(self.plant.saturating_sub(1))), (Letter::Error, s)]
    }

    /// s = p^(k−1) q − z.
    pub fn definition_of_error(&self) -> Form {
        let followed = Polynomial::power(self.plant.saturating_sub(1));
        let own = Combination::of(Quantity::own(Letter::Position), followed);
        Form::own(own.plus(Quantity::own(Letter::Reference), &-&Polynomial::one()))
    }

    /// The right side with p^(k−1) q = z + s in what an agent has by itself: p^ℓ z as a filter that what is left of the right side drives.
    /// `None` where q itself is left there.
    pub fn filter(&self) -> Option<Form> {
        let one = Polynomial::one();
        let divisor = Polynomial::power(self.plant.saturating_sub(1));
        let in_z = [(Letter::Reference, one.clone()), (Letter::Error, one)];
        let own = Form::own(self.right.own.clone()).with(Letter::Position, &divisor, &in_z).own;
        own.highest(Letter::Position).is_none().then(|| Form { own, network: self.right.network.clone() })
    }

    /// p^N q = p^ℓ z + p^ℓ s, with z still in it: (9), (26), (46), (112) as they are printed.
    pub fn loop_with_reference(&self) -> Form {
        let s = Combination::of(Quantity::own(Letter::Error), Polynomial::power(self.order));
        self.right.sum(&Form::own(s))
    }

    /// The same with z eliminated.
    pub fn upper(&self) -> Upper {
        Upper {
            order: self.total_order(),
            reference_order: self.order,
            plant: self.plant,
            state: Letter::Position,
            input: Letter::Error,
            filter: Polynomial::one(),
            alike: true,
            right: self.loop_with_reference().with(Letter::Reference, &Polynomial::one(), &self.virtual_control()),
        }
    }
}

impl Upper {
    /// The highest derivative of s in it.
    pub fn derivatives_of_input(&self) -> usize {
        self.right.highest(self.input).unwrap_or(0)
    }

    /// The degree: how many derivatives of the *state* of the lower subsystem stand in it. The state of a lower subsystem of order m is
    /// s, ṡ, …, s^(m−1).
    pub fn degree(&self, lower_order: usize) -> usize {
        degree(self.derivatives_of_input(), lower_order)
    }

    /// The same for the distance from a leader or from a target, as it is now and as it was when what is heard was told.
    pub fn relative_to(&self, [followed, then]: [Quantity; 2]) -> Upper {
        let one = Polynomial::one();
        let by = |quantity: Quantity| {
            let followed = if quantity.vertex == Vertex::Neighbour { then } else { followed };
            (quantity.letter == self.state).then(|| {
                Combination::of(Quantity { letter: Letter::Deviation, ..quantity }, one.clone()).plus(followed, &one)
            })
        };
        // p^N (q − q₀) = p^N q − p^N q₀.
        let own = Combination::of(followed, -&Polynomial::power(self.order));
        let right = self.right.replaced(&one, by).sum(&Form::own(own));
        Upper { state: Letter::Deviation, right, ..self.clone() }
    }

    /// Among neighbours whose plants or roots are others.
    pub fn among_others(self) -> Upper {
        Upper { alike: false, ..self }
    }

    /// With s = a(p) y, where a filter has the output y.
    pub fn filtered(&self, a: &Polynomial) -> Upper {
        let right = self.right.with(self.input, &Polynomial::one(), &[(Letter::Filter, a.clone())]);
        Upper { input: Letter::Filter, filter: a.clone(), right, ..self.clone() }
    }

    /// With s gone.
    pub fn undisturbed(&self) -> Upper {
        Upper { right: self.right.without(self.input), ..self.clone() }
    }

    /// Whether a quantity is q of some agent.
    pub(super) fn is_state(&self, quantity: Quantity) -> bool {
        quantity.letter == self.state && !quantity.vertex.is_leader()
    }
}

/// The degree of a cascade that holds s up to this derivative.
pub fn degree(derivatives: usize, lower_order: usize) -> usize {
    (derivatives + 1).saturating_sub(lower_order.max(1))
}
