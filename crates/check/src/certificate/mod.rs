//! Certificates: what somebody who does not trust this program needs in order to check its answers.
//!
//! An answer alone says nothing that can be checked. A certificate adds to each of them a proof that is easy to follow and was hard
//! to find: windows with their trees, bounds, pivots, subdivisions, shares; or a witness. All numbers are exact. The producers
//! use the setup alone, not how the answer was found: a slip in one does not hide in the other.
//!
//! A hypothesis for which there is no producer, or whose producer finds nothing, has no proof; the checker then says that it
//! could not check it.

mod courses;
mod delays;
mod enclosure;
mod exact;
mod fading;
mod gains;
mod late;
mod limit;
mod motions;
mod numbers;
mod producers;
mod proof;
mod ratio;
mod resolved;
mod routh;
mod shares;
mod slopes;
mod windows;
mod zeros;

use forwardstep_sim::{Setup, check_setup};
use num_rational::BigRational;

pub(crate) use delays::largest;
pub use exact::decimal;
pub(crate) use fading::fades;
pub(crate) use limit::refutes;
pub(crate) use motions::{at_start, closer_drive_bound};
pub use proof::{DrawnPhase, Enclosure, GivenAge, Matrix, Proof, Range, TreeWindow};

pub(crate) use zeros::vanishing;

use crate::hypothesis::Subject;
use crate::instance::designed;
use crate::{Answer, Hypothesis, Id, Report};

/// What a report says, with proofs.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// The stable name of the theorem.
    pub theorem: &'static str,
    /// Its hypotheses, in the order of the report.
    pub statements: Vec<Statement>,
    /// What each agent's start counts in the value agreed upon, where the network never changes: a left null vector of its
    /// Laplacian that sums to one.
    pub influence: Option<Vec<BigRational>>,
}

/// What is claimed of one hypothesis, and why it is so.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// Which.
    pub id: Id,
    /// The agents that it is about, by their vertices; none for the whole.
    pub agents: Vec<usize>,
    /// What was found.
    pub answer: Answer,
    /// Why; `None` where nothing is claimed, or no proof was found.
    pub proof: Option<Proof>,
}

/// The certificate of `report`, which is that of `setup`; empty for one that has no meaning.
///
/// ```
/// # use forwardstep_check::{certify, check};
/// # fn of(setup: &forwardstep_sim::Setup) {
/// let certificate = certify(setup, &check(setup));
/// assert_eq!(certificate.statements.len(), check(setup).hypotheses.len());
/// # }
/// ```
pub fn certify(setup: &Setup, report: &Report) -> Certificate {
    // Desired dynamics that are a design of the paper are certified as that design.
    if check_setup(setup).is_err() {
        return Certificate { theorem: report.theorem.name(), statements: Vec::new(), influence: None };
    }
    let designed = designed(setup);
    let setup = designed.as_ref().unwrap_or(setup);
    Certificate {
        theorem: report.theorem.name(),
        statements: report.hypotheses.iter().map(|hypothesis| statement(setup, hypothesis)).collect(),
        influence: shares::influence(setup),
    }
}

impl Statement {
    /// Whether something is claimed of it, and no proof was found: then its answer rests on this program alone.
    pub fn is_unproven(&self) -> bool {
        claims(self.answer) && self.proof.is_none()
    }
}

fn claims(answer: Answer) -> bool {
    match answer {
        Answer::Holds | Answer::HoldsOnHorizon | Answer::Violated => true,
        Answer::Watched | Answer::NotShown | Answer::NotCovered => false,
    }
}

fn statement(setup: &Setup, hypothesis: &Hypothesis) -> Statement {
    let agents = match &hypothesis.subject {
        Subject::Setup | Subject::Reference | Subject::Drive(_) => Vec::new(),
        Subject::Agent(agent) => vec![agent.index],
        Subject::Targets { agents, .. } | Subject::Offsets { agents, .. } => {
            agents.iter().map(|agent| agent.index).collect()
        }
    };
    let answer = hypothesis.answer();
    let proof = if claims(answer) { producers::proof(setup, hypothesis.id, &agents, answer) } else { None };
    Statement { id: hypothesis.id, agents, answer, proof }
}
