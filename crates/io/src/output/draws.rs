//! `phases.csv` and `holds.csv`: what was drawn for a network, to be replayed by `switching.log` and `delay.hold_log`.

use std::collections::BTreeSet;
use std::io::Write;

use forwardstep_sim::delay::{Delay, RandomHold};
use forwardstep_sim::network::Network;
use forwardstep_sim::schedule::{RandomSwitching, Segment};
use forwardstep_sim::setup::Setup;

use super::csv::io_error;
use super::names::agent_name;

/// Whether phases were drawn.
pub(crate) fn draws_phases(network: &Network) -> bool {
    network.schedule.downcast::<RandomSwitching>().is_some()
}

/// The random holds as (sender, receiver, hold), by sender and receiver, and then in the order of the graphs that have them first.
pub(crate) fn holds(network: &Network) -> Vec<(usize, usize, &RandomHold)> {
    let (mut seen, mut holds) = (BTreeSet::new(), Vec::new());
    for edge in network.schedule.graphs.iter().flatten() {
        if let Some(hold) = network.delays.get(edge.delay).and_then(Delay::downcast)
            && seen.insert((edge.from, edge.to, edge.delay))
        {
            holds.push((edge.from, edge.to, hold));
        }
    }
    holds.sort_by_key(|(from, to, _)| (*from, *to));
    holds
}

/// Writes header and rows: when each phase begins and its number from one; and when the last one ends. Numbers have all digits needed
/// to read the same numbers back.
pub(crate) fn write_phases(out: &mut impl Write, setup: &Setup) -> std::io::Result<()> {
    let mut table = ::csv::Writer::from_writer(out);
    table.write_record(["t_s", "phase"]).map_err(io_error)?;
    let mut until_s = 0.0;
    for Segment { start_s, end_s, graph } in setup.network.schedule.segments() {
        table.write_record([start_s.to_string(), (graph + 1).to_string()]).map_err(io_error)?;
        until_s = end_s;
        if end_s > setup.time.end_s {
            break;
        }
    }
    table.write_record([until_s.to_string(), String::new()]).map_err(io_error)?;
    table.flush()
}

/// Writes header and rows: link by link and hold by hold when each value begins, and when the last one ends.
pub(crate) fn write_holds(out: &mut impl Write, setup: &Setup) -> std::io::Result<()> {
    let mut table = ::csv::Writer::from_writer(out);
    table.write_record(["from", "to", "hold", "t_s", "delay_s"]).map_err(io_error)?;
    let (mut before, mut number) = (None, 0);
    for (from, to, hold) in holds(&setup.network) {
        number = if before == Some((from, to)) { number + 1 } else { 1 };
        before = Some((from, to));
        let (from, to, number) = (agent_name(setup, from), agent_name(setup, to), number.to_string());
        let values = hold.times_s().iter().zip(hold.values_s().iter().map(f64::to_string));
        // The end of what was drawn, which is that of the run or later.
        let end_s = hold.times_s().last().map_or(0.0, |last_s| hold.until_s().max(last_s.next_up()));
        for (t_s, delay_s) in values.chain([(&end_s, String::new())]) {
            table.write_record([&from, &to, &number, &t_s.to_string(), &delay_s]).map_err(io_error)?;
        }
    }
    table.flush()
}
