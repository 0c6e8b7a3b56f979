//! Whether the loop as it is deployed lasts: a trial of all agents for as long as little work leads.
//!
//! Laws other than (6)–(7) adapt along what they regress, and that is large where agents move, which no linear map at rest knows.

use forwardstep_sim::recording::{Ending, Outcome, Signal};
use forwardstep_sim::{RecordAt, Setup, TimeSpan};

use super::place::{FASTER, STILL_FASTER, ideal};
use crate::prediction::trial;

/// Periods that are tried at most.
const PERIODS: f64 = 2048.0;
/// Work for them, in nanoseconds, roughly.
const WORK: f64 = 4e8;
/// What is larger than that beside where agents start has run away.
const AWAY: f64 = 1e9;
/// Rows of a trial, and how much longer the ideal loop has to last.
const ROWS: f64 = 64.0;
const LONGER: f64 = 1.25;

/// What a trial tells; nothing where it takes too much work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trial {
    /// When the agents have run away, s, though those of the ideal loop have not by then.
    pub lost_s: Option<f64>,
    /// For how long they have not, s.
    pub lasted_s: f64,
}

impl Trial {
    /// Of a setup that samples.
    pub(super) fn of(setup: &Setup) -> Option<Trial> {
        let period_s = 1.0 / setup.control.as_ref()?.sample_hz;
        let until = |end_s: f64| end_s.min(setup.time.end_s);
        let end_s = until(PERIODS * period_s);
        let End::Lost { t_s } = tried(setup, end_s, WORK)? else {
            return Some(Trial { lost_s: None, lasted_s: end_s });
        };
        // What breaks down in continuous time may do so a little later. What is lost with samples that are faster may last with some that are faster
        // still: the loops that sampling spoils soonest are those that need the fastest.
        let ideal = |faster: u32| tried(&ideal(setup, faster)?, until(LONGER * t_s), f64::from(FASTER) * WORK);
        let first = ideal(FASTER)?;
        let lasts = first == End::Lasts || STILL_FASTER.into_iter().map_while(ideal).any(|end| end == End::Lasts);
        Some(Trial { lost_s: lasts.then_some(t_s), lasted_s: 0.0 })
    }
}

/// How a trial ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    /// It does not before its time.
    Lasts,
    /// Agents have run away.
    Lost {
        /// When that was seen, s.
        t_s: f64,
    },
}

/// `None` where there is no run, or too much work in it.
fn tried(setup: &Setup, end_s: f64, work: f64) -> Option<End> {
    let time = TimeSpan { end_s, record_every_s: end_s / ROWS, record_at: RecordAt::Intervals };
    let Outcome { recording, ending, .. } = trial(&Setup { time, ..setup.clone() }, work)?;
    let near = setup.agents.iter().flat_map(|agent| &agent.start.q).fold(1.0_f64, |most, q| most.max(q.abs()));
    let is_away = |row: usize| {
        let mut positions = recording.columns.iter().filter(|column| column.signal == Signal::Position);
        positions.any(|column| column.values.get(row).is_none_or(|q| q.is_nan() || q.abs() > AWAY * near))
    };
    let away_s = (0..recording.t_s.len()).find(|row| is_away(*row)).map(|row| recording.t_s[row]);
    let broke_s = if let Ending::BrokeDown(breakdown) = ending { Some(breakdown.t_s) } else { None };
    Some(away_s.or(broke_s).map_or(End::Lasts, |t_s| End::Lost { t_s }))
}
