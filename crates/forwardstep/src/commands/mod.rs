//! One file per command.

mod check;
mod completions;
mod dynamics;
mod progress;
mod promise;
mod robot;
mod run;
mod scenarios;
mod schema;
mod summary;

pub(crate) use check::check;
pub(crate) use completions::completions;
pub(crate) use robot::robot;
pub(crate) use run::run;
pub(crate) use scenarios::scenarios;
pub(crate) use schema::schema;
