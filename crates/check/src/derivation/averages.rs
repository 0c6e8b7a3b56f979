//! What a design does without s: the Laplacian form, in words and formulas.

use super::cascade::Upper;
use super::case::{Case, Led};
use super::dynamics::{Dynamics, Heard};
use super::explanation::{Explained, Section, Subject};
use super::form::{Letter, Quantity, Vertex};
use super::formula::Formula;
use super::laplacian::{RootsOfAll, chain};
use super::notation::Notation;
use super::places::Places;
use super::stacked;

impl Case<'_> {
    /// (46): z is what is done, so that there is no s.
    pub(super) fn without_reference(&self, dynamics: &Dynamics, notation: &Notation) -> Explained {
        // With s = 0 from the start z is ẋ.
        let upper = dynamics.upper().undisturbed();
        let equation = notation.equation(Quantity::own(Letter::Position), upper.order, &upper.right);
        let mut chosen = Section::new(Subject::ReferenceDynamics)
                .words(
                    "Dynamic feedback linearisation makes the thrust and two angular velocities an input u of the third derivative of x, and \
                     u is chosen so that x obeys (24) of order two at once. There is no s, so this is no cascade.",
                )
                .formula(equation, "(46)");
        if self.is_pushed() {
            chosen = chosen.words("Something pushes: what it adds to the third derivative is not in the equation.");
        }
        let sections = vec![chosen];
        let laplacian = self.laplacian(&upper, notation, &Places::default());
        let sections = sections.into_iter().chain(laplacian).collect();
        Explained { agents: self.agents.clone(), order: Some(upper.order), degrees: None, sections }
    }

    /// The power of the chain of averages at which it begins; `None` where there is none.
    pub(super) fn averages_from(&self) -> Option<usize> {
        self.roots.all_real()?;
        match &self.led {
            Led::Consensus(Heard::Positions) | Led::PureIntegral(Heard::Positions) => Some(0),
            Led::Consensus(Heard::Velocities) | Led::PureIntegral(Heard::Velocities) => Some(1),
            Led::Consensus(Heard::Coupled)
            | Led::PureIntegral(Heard::Coupled)
            | Led::Backstepping
            | Led::Leader(..)
            | Led::Target
            | Led::Desired(_)
            | Led::Outside(..)
            | Led::Refuted(..) => None,
        }
    }

    pub(super) fn laplacian(&self, upper: &Upper, notation: &Notation, places: &Places) -> Option<Section> {
        if let Led::Consensus(Heard::Coupled) | Led::PureIntegral(Heard::Coupled) = &self.led {
            let words = "What is heard is a nonlinear function of differences, so that there is no matrix; the argument is the same, since \
                         that function is odd and grows.";
            return Some(Section::new(Subject::Laplacian).words(words));
        }
        let section = Section::new(Subject::Laplacian);
        if let (Led::Consensus(_) | Led::PureIntegral(_), None) = (&self.led, self.roots.all_real()) {
            return Some(section.words(
                "Not all roots are real: no chain of first-order averages leads from q to what is sent, so that there is no Laplacian form.",
            ));
        }
        let (from, roots) = (self.averages_from()?, self.roots.all_real()?);
        let Some(laplacian) = upper.laplacian(chain(roots, from, self.roots_of_all)) else {
            return Some(section.words(
                "The agents hear each other with different κ₀, and what is heard is no multiple of the neighbour's ψ: there is no Laplacian \
                 form (see E1 in PAPER.md).",
            ));
        };
        let named = notation.naming(&laplacian.chain);
        let scaled = match self.roots_of_all {
            RootsOfAll::Same => "",
            RootsOfAll::SameFirst | RootsOfAll::Own => {
                " ψ is divided by the last coefficient of the polynomial, since the agents' roots differ."
            }
        };
        let mut section = section.words(format!(
            "Without s every entry of ψ moves towards an average of the next one, and the last one towards what is heard: no entry of a row is \
             negative off the diagonal, and every row sums to zero.{scaled}",
        ));
        for variable in &laplacian.chain.variables {
            let definition = notation.definition(upper, &variable.state, &variable.input);
            section = section.formula(Formula::equal(named.name(variable.name, Vertex::Own, 0), definition), "");
        }
        let section = section.system(notation.system(&laplacian.chain), places.laplacian);
        if self.roots_of_all != RootsOfAll::Same {
            return Some(section);
        }
        let section = section
            .words(
                "Stacked for all agents, and without delays, the matrix of this system is the following, each entry times I_m; D_w is the diagonal \
                 of the sums of weights and W = [w_ij].",
            )
            .formula(stacked::matrix(&laplacian.blocks), places.matrix);
        Some(section)
    }
}
