//! The identities of a derivation, evaluated along a run: from states, their rates and what is heard, so that nothing is left but rounding.
//!
//! - `identities`: which equations, each as one form that is to be zero.
//! - `moment`: the values of letters at one instant of one agent.
//! - `robot`, `task_space`, `spacecraft`, `plants`: nonlinear terms and matrices.
//!
//! An equation is brought to q, q̇, …, q^(k) for a plant of order k, z, …, z^(ℓ), s and ṡ by exact arithmetic, with p^(k−1) q = z + s above;
//! what the reductions absorb cancels there. Every number then comes from a state, or from the rate of one, as the closed loop
//! has it: the right-hand side that is integrated is held against what was derived from the setup, and neither knows the other.

mod identities;
mod moment;
mod plants;
mod protocol;
mod robot;
mod spacecraft;
mod task_space;

use std::fmt;

use forwardstep_sim::{Moment, Setup, SetupError, recorded_columns};

use super::case::{Case, cases};
use super::explanation::Subject;
use super::formula::Formula;
use identities::{Identity, identities};
use moment::Columns;
use robot::Model;

/// What is larger, relative to the size of the terms, is no rounding. Runs of all shipped scenarios stay a hundred times below.
pub const ROUNDING: f64 = 1e-9;

/// An equation of a derivation, and how well it holds along a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// The section of the explanation in which it stands.
    pub subject: Subject,
    /// The equation.
    pub formula: Formula,
    /// Its place in the paper; empty where it does not stand there.
    pub place: &'static str,
    /// The largest residual, or why there is none.
    pub largest: Result<Largest, Missing>,
}

impl Residual {
    /// Whether it is not larger than rounding; `None` where it was not evaluated.
    pub fn holds(&self) -> Option<bool> {
        self.largest.as_ref().ok().map(|largest| largest.relative <= ROUNDING)
    }
}

/// Where the two sides of an equation differ most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    /// The difference of the sides relative to the sum of the sizes of all terms.
    pub relative: f64,
    /// The difference.
    pub difference: f64,
    /// The agent, by its number.
    pub agent: usize,
    /// The entry: an axis, or that of a quaternion or of an estimate.
    pub entry: usize,
    /// When, s.
    pub t_s: f64,
    /// At how many instants of agents it was evaluated.
    pub moments: u64,
}

/// Why an equation is not evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    /// It holds a derivative that is no rate of a state.
    Derivative,
    /// It holds something of a neighbour that is not transmitted.
    Neighbour,
    /// It holds a nonlinear term that the law keeps to itself.
    Term,
    /// A limit may change what the law asks for.
    Limited,
    /// Something acts from outside, and the equation speaks of more than is recorded of it, or does not speak of it.
    Pushed,
    /// An inner loop stands between what is asked for and what the plant does.
    InnerLoop,
    /// Both sides are the same by what their letters stand for.
    Definition,
    /// What is followed has a kink there.
    Kink,
    /// The run made no row.
    NoRow,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Missing::Derivative => "it holds a derivative that is no rate of a state",
            Missing::Neighbour => "it holds something of a neighbour that is not transmitted",
            Missing::Term => "it holds a term that is known to the law alone",
            Missing::Limited => "limits are enforced, which may change what the law asks for",
            Missing::Pushed => "something acts from outside, of which not everything is recorded",
            Missing::InnerLoop => "an inner loop brings about what it takes to be there at once",
            Missing::Definition => "both sides are the same by definition of their letters",
            Missing::Kink => "what is followed has a kink there",
            Missing::NoRow => "the run made no row",
        })
    }
}

/// Evaluates the identities of all designs of a setup along its run; see [`forwardstep_sim::simulate_with`].
pub struct Residuals<'a> {
    designs: Vec<Design<'a>>,
    /// The design of each agent.
    of: Vec<usize>,
    columns: Columns,
    models: Vec<Option<Model<'a>>>,
    /// c of every agent, as it was at its first row.
    constants: Vec<Option<Vec<f64>>>,
}

struct Design<'a> {
    case: Case<'a>,
    identities: Vec<(Identity, Result<Option<Largest>, Missing>)>,
}

impl<'a> Residuals<'a> {
    /// Those of a setup, whose control is continuous.
    ///
    /// # Errors
    /// [`SetupError`] when the setup has no meaning.
    pub fn of(setup: &'a Setup) -> Result<Self, SetupError> {
        let columns = Columns::new(setup.agents.len(), &recorded_columns(setup)?);
        let design = |case: Case<'a>| {
            let identities = identities(&case).into_iter().map(|identity| (identity, Ok(None))).collect();
            Design { case, identities }
        };
        let designs: Vec<Design<'a>> = cases(setup).into_iter().map(design).collect();
        let mut of = vec![0; setup.agents.len()];
        for (number, design) in designs.iter().enumerate() {
            design.case.agents.iter().for_each(|agent| of[*agent] = number);
        }
        let models = setup.agents.iter().map(Model::of).collect();
        let constants = vec![None; setup.agents.len()];
        Ok(Residuals { designs, of, columns, models, constants })
    }

    /// Evaluates all identities of one agent at one instant.
    pub fn look(&mut self, moment: Moment<'_>) {
        let Some(design) = self.of.get(moment.agent).and_then(|number| self.designs.get_mut(*number)) else { return };
        let model = self.models.get_mut(moment.agent).and_then(Option::as_mut);
        let mut at = moment::At::new(&design.case, &self.columns, model, moment);
        // What does not depend on the state is what it is at the first row.
        let constant = &mut self.constants[moment.agent];
        if constant.is_none() && design.case.has_constant() {
            at.constant = Some(vec![0.0; design.case.setup.agents[moment.agent].robot.axes.len()]);
            let mut first = design.identities.iter().filter(|(one, _)| one.subject == Subject::ReferenceDynamics);
            let rest = first.next().and_then(|(reference, _)| reference.residual(&mut at).ok());
            *constant = rest.map(|rest| rest.iter().map(|[value, _]| *value).collect());
        }
        at.constant = constant.clone();
        for (identity, largest) in &mut design.identities {
            let Ok(before) = largest else { continue };
            match identity.residual(&mut at) {
                Ok(entries) => {
                    let moments = before.map_or(0, |before| before.moments) + 1;
                    *before = larger(*before, &entries, moment).map(|largest| Largest { moments, ..largest });
                }
                // Another instant will do.
                Err(Missing::Kink) => {}
                Err(missing) => *largest = Err(missing),
            }
        }
    }

    /// What was found: for every design its agents, by their numbers, and its equations.
    pub fn found(&self) -> Vec<(Vec<usize>, Vec<Residual>)> {
        let residual = |(identity, largest): &(Identity, Result<Option<Largest>, Missing>)| Residual {
            subject: identity.subject,
            formula: identity.formula.clone(),
            place: identity.place,
            largest: largest.and_then(|largest| largest.ok_or(Missing::NoRow)),
        };
        let design =
            |design: &Design<'_>| (design.case.agents.clone(), design.identities.iter().map(residual).collect());
        self.designs.iter().map(design).collect()
    }
}

/// The larger of what was found before and these entries, each a difference with the size of its terms. What is not a number is larger
/// than any.
fn larger(before: Option<Largest>, entries: &[[f64; 2]], moment: Moment<'_>) -> Option<Largest> {
    // One equation of a vector is as exact as its largest entry: matrices mix them.
    let size = entries.iter().fold(f64::MIN_POSITIVE, |size, [_, entry]| size.max(*entry));
    let rank = |relative: f64| if relative.is_nan() { f64::INFINITY } else { relative };
    let each = entries.iter().enumerate().map(|(entry, [difference, _])| Largest {
        relative: rank(difference.abs() / size),
        difference: *difference,
        agent: moment.agent,
        entry,
        t_s: moment.t_s,
        moments: 0,
    });
    before.into_iter().chain(each).reduce(|a, b| if b.relative > a.relative { b } else { a })
}
