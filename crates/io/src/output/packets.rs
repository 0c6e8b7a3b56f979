//! `packets.csv`: every packet of every link, to be replayed by `delay.log`; and links in a few numbers.

use std::io::Write;

use forwardstep_sim::delay::{Delay, Trace};
use forwardstep_sim::network::Network;
use forwardstep_sim::recording::Ending;
use forwardstep_sim::setup::Setup;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::csv::io_error;
use super::names::agent_name;

/// The links that carry packets, as (sender, receiver, packets), in that order.
pub(crate) fn links(network: &Network) -> Vec<(usize, usize, &Trace)> {
    let mut links: Vec<(usize, usize, &Trace)> = Vec::new();
    for edge in network.schedule.graphs.iter().flatten() {
        if let Some(trace) = network.delays.get(edge.delay).and_then(Delay::packets) {
            links.push((edge.from, edge.to, trace));
        }
    }
    links.sort_by_key(|(from, to, _)| (*from, *to));
    links.dedup_by_key(|(from, to, _)| (*from, *to));
    links
}

/// Writes header and rows, edge by edge and then by send time, of what was sent until a run ended; a lost packet has an empty delay.
/// Numbers have all digits needed to read the same numbers back.
pub(crate) fn write(out: &mut impl Write, setup: &Setup, ending: &Ending) -> std::io::Result<()> {
    let until_s = ending.before_horizon_s().unwrap_or(f64::INFINITY);
    let mut table = ::csv::Writer::from_writer(out);
    table.write_record(["from", "to", "send_s", "delay_s"]).map_err(io_error)?;
    for (from, to, trace) in links(&setup.network) {
        let (from, to) = (agent_name(setup, from), agent_name(setup, to));
        for packet in trace.packets().iter().take_while(|packet| packet.send_s <= until_s) {
            let delay_s = packet.delay_s.map_or_else(String::new, |delay_s| delay_s.to_string());
            table.write_record([&from, &to, &packet.send_s.to_string(), &delay_s]).map_err(io_error)?;
        }
    }
    table.flush()
}

/// A link that carried packets, until the run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Link {
    /// The sender, by the order of the agents.
    pub from: usize,
    /// The receiver.
    pub to: usize,
    /// Packets sent.
    pub sent: usize,
    /// Packets that never arrived.
    pub lost: usize,
    /// Packets that arrived after a newer one and were dropped.
    pub late: usize,
    /// The largest age of what was heard, s; until the first packet arrives the initial message ages from t = 0.
    pub largest_age_s: f64,
}

impl Link {
    /// All links of a network, over a run that ended so.
    pub(crate) fn all(network: &Network, ending: &Ending) -> Vec<Link> {
        let link = |(from, to, trace): (usize, usize, &Trace)| {
            let statistics = match ending.before_horizon_s() {
                Some(t_s) => trace.statistics_until(t_s),
                None => trace.statistics(),
            };
            Link {
                from,
                to,
                sent: statistics.sent,
                lost: statistics.lost,
                late: statistics.late,
                largest_age_s: statistics.largest_age_s,
            }
        };
        links(network).into_iter().map(link).collect()
    }
}
