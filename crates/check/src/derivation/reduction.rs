//! Degree reduction: the upper subsystem in variables that absorb derivatives of s.
//!
//! A variable is V = f(p) q − g(p) s. With variables of every degree below N that occurs, anything in q and s is a combination of
//! them and of s, found by dividing out the highest power first. p V is one too, once p^N q is replaced by the right side of the upper
//! subsystem. So the new equations are computed, not written down.

use super::cascade::{Upper, degree};
use super::form::{Combination, Form, Letter, Quantity, Vertex};
use super::polynomial::Polynomial;

/// What a variable is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// pʳ of a letter.
    Derivative(Letter, usize),
    /// ξ = q̇ + α q.
    Xi,
    /// ξ̇ − ṡ: y of (11) and (a2).
    Y,
    /// ψ_r, an entry of the vector ψ of (a6) and (30).
    Psi(usize),
    /// ψ_r less what it holds of s.
    Reduced(usize),
    /// Δξ = ξ − ξ₀ of (114).
    DeltaXi,
    /// Δξ − s of (115).
    RelativeXi,
    /// Δξ* − ṡ.
    RelativeXiStar,
    /// x − y/λ_f.
    Shifted,
}

/// f(p) q − g(p) s.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// What it is called.
    pub name: Name,
    /// f.
    pub state: Polynomial,
    /// g.
    pub input: Polynomial,
    /// Whether it is one of the neighbours' variables too. What is heard is expressed in those, and stays as it is where they do not
    /// reach.
    pub common: bool,
}

impl Variable {
    /// pʳ q.
    pub fn derivative(letter: Letter, r: usize) -> Self {
        let (name, state) = (Name::Derivative(letter, r), Polynomial::power(r));
        Variable { name, state, input: Polynomial::default(), common: true }
    }

    /// z^(r), or that of z less the derivative of a target: p^(r+k−1) q − pʳ s, with s = a(p) y where there is a filter.
    pub fn reference(letter: Letter, [plant, r]: [usize; 2], filter: &Polynomial, common: bool) -> Self {
        Variable {
            name: Name::Derivative(letter, r),
            state: Polynomial::power((r + plant).saturating_sub(1)),
            input: filter * &Polynomial::power(r),
            common,
        }
    }

    /// f(p) q with z in the place of pʳ q for r ≥ `kept` (at least k − 1): what it holds of s is gone.
    pub fn constructed(name: Name, state: Polynomial, [kept, plant]: [usize; 2], common: bool) -> Self {
        let high = state.divided_by(&Polynomial::power(kept)).map_or_else(Polynomial::default, |(high, _)| high);
        let input = &high * &Polynomial::power((kept + 1).saturating_sub(plant));
        Variable { name, state, input, common }
    }
}

/// The upper subsystem in new variables: p V_m = the m-th form, in which the variables are letters.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// The variables, by rising degree.
    pub variables: Vec<Variable>,
    /// Their rates.
    pub rates: Vec<Form>,
    /// The highest derivative of s in them.
    pub derivatives: usize,
}

impl Reduced {
    /// The degree of the cascade with this as its upper subsystem.
    pub fn degree(&self, lower_order: usize) -> usize {
        degree(self.derivatives, lower_order)
    }
}

impl Upper {
    /// The same system in these variables; `None` where they do not reach, because something in it has a degree that none of them has.
    pub fn reduced(&self, variables: Vec<Variable>) -> Option<Reduced> {
        let rates: Option<Vec<Form>> =
            variables.iter().map(|variable| self.expressed(&self.rate(variable), &variables)).collect();
        let rates = rates?;
        let derivatives = rates.iter().filter_map(|rate| rate.highest(self.input)).max().unwrap_or(0);
        Some(Reduced { variables, rates, derivatives })
    }

    /// p V in q and s, below p^N q.
    fn rate(&self, variable: &Variable) -> Form {
        let p = Polynomial::power(1);
        let state = &variable.state * &p;
        let top = state.coefficient(self.order);
        let below = &state - &Polynomial::power(self.order).scaled(&top);
        let own = Combination::of(Quantity::own(self.state), below)
            .plus(Quantity::own(self.input), &-&(&variable.input * &p));
        Form::own(own).sum(&self.right.scaled(&top))
    }

    /// A form in q and s as one in the variables and s.
    pub fn expressed(&self, form: &Form, variables: &[Variable]) -> Option<Form> {
        let side = |all: &Combination| {
            all.terms().try_fold(Combination::default(), |sum, (quantity, a)| {
                let found = self.is_state(quantity).then(|| self.divided_out(quantity.vertex, a.clone(), variables));
                match (found, quantity.vertex) {
                    (Some(Some(found)), _) => Some(sum.sum(&found)),
                    (Some(None), Vertex::Own | Vertex::Leader | Vertex::LateLeader) => None,
                    (Some(None), Vertex::Neighbour) | (None, _) => Some(sum.plus(quantity, a)),
                }
            })
        };
        Some(Form { own: side(&form.own)?, network: side(&form.network)? })
    }

    /// a(p) q as a combination of variables and s of one agent.
    fn divided_out(&self, vertex: Vertex, mut a: Polynomial, variables: &[Variable]) -> Option<Combination> {
        let of = |letter| Quantity { vertex, ..Quantity::own(letter) };
        let mut sum = Combination::default();
        while let Some(high) = a.degree() {
            let index = variables.iter().position(|variable| {
                variable.state.degree() == Some(high) && (variable.common || vertex == Vertex::Own)
            })?;
            let variable = &variables[index];
            let share = a.coefficient(high) / variable.state.coefficient(high);
            a = &a - &variable.state.scaled(&share);
            sum = sum
                .plus(of(Letter::Variable(index)), &Polynomial::number(share.clone()))
                .plus(of(self.input), &variable.input.scaled(&share));
        }
        Some(sum)
    }

    /// The variables of a chain of pure derivatives of q, of which those from p^(N−absorbed) q on are derivatives of z.
    pub fn derivatives(&self, absorbed: usize) -> Vec<Variable> {
        let first = self.order.saturating_sub(absorbed);
        let letter = if self.state == Letter::Deviation { Letter::ReferenceDeviation } else { Letter::Reference };
        let each = |r: usize| {
            if r < first {
                Variable::derivative(self.state, r)
            } else {
                Variable::reference(letter, [self.plant, (r + 1).saturating_sub(self.plant)], &self.filter, self.alike)
            }
        };
        (0..self.order).map(each).collect()
    }

    /// The reduction step by step, each absorbing one derivative of s into z^(ℓ−1), z^(ℓ−2), …, until no higher derivative of it
    /// is left than this, or a step leaves as many as there were: of dynamics in x the coefficients bring them back.
    pub fn steps(&self, aim: usize) -> Vec<Reduced> {
        let mut steps: Vec<Reduced> = Vec::new();
        for absorbed in 0..=self.reference_order {
            let Some(reduced) = self.reduced(self.derivatives(absorbed)) else { break };
            if steps.last().is_some_and(|last| reduced.derivatives >= last.derivatives) {
                break;
            }
            let done = reduced.derivatives <= aim;
            steps.push(reduced);
            if done {
                break;
            }
        }
        steps
    }

    /// With x less a part of y in the place of x, where a filter stands in for s: no derivative of y is left.
    pub fn shifted(&self) -> Option<Reduced> {
        (self.input == Letter::Filter).then_some(())?;
        let mut variables = self.derivatives(self.reference_order);
        let first = variables.first_mut()?;
        let input = Polynomial::number(self.filter.coefficient(1));
        *first = Variable { name: Name::Shifted, state: first.state.clone(), input, common: self.alike };
        self.reduced(variables)
    }
}
