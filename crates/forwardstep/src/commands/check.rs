//! `forwardstep check`

use forwardstep::check::Answer;
use forwardstep::io::scenario::kinds::Kinds;

use super::promise::{promise, show};
use crate::console::{Console, complain};
use crate::status::Status;

/// Says which theorem speaks about a scenario and whether its hypotheses hold.
pub(crate) fn check(scenario: &str, kinds: &Kinds, console: &mut Console) -> Status {
    let scenario = match kinds.open_scenario(scenario) {
        Ok(scenario) => scenario,
        Err(error) => return complain(&error),
    };
    let promise = promise(&scenario.setup);
    show(&scenario, &promise, console);
    match promise.report.worst() {
        Answer::Holds | Answer::HoldsOnHorizon | Answer::Watched => Status::Fine,
        Answer::NotShown | Answer::NotCovered | Answer::Violated => Status::Missed,
    }
}
