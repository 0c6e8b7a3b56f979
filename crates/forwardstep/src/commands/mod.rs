//! One file per command.

mod ask;
mod attack;
mod check;
mod completions;
mod dynamics;
mod explain;
mod falsify;
mod manipulability;
mod new;
mod progress;
mod promise;
mod report;
mod robot;
mod run;
mod sampling_limit;
mod scenarios;
mod schema;
mod smoothness;
mod stop;
mod summary;
mod upgrade;

pub(crate) use attack::attack;
pub(crate) use check::check;
pub(crate) use completions::completions;
pub(crate) use explain::explain;
pub(crate) use falsify::falsify;
pub(crate) use manipulability::manipulability;
pub(crate) use new::new;
pub(crate) use report::report;
pub(crate) use robot::robot;
pub(crate) use run::run;
pub(crate) use sampling_limit::sampling_limit;
pub(crate) use scenarios::scenarios;
pub(crate) use schema::schema;
pub(crate) use smoothness::smoothness;
pub(crate) use upgrade::upgrade;
