//! `delay.log`: packets replayed from a file.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use forwardstep_sim::delay::{Delay, Packet, Trace};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, Faults, not_negative};
use super::super::super::network::NetworkReader;
use super::super::super::network_problem::NetworkProblem;
use super::super::super::table::{Cell, Column, TableProblem, cell_number, read_table, table_text};
use super::super::KindTable;
use super::{DelayKind, DelayPlan, Link, LinkDelays};

/// Packets that were recorded.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogFile {
    /// The CSV file, beside the scenario file. Its first line names its columns: `from`, `to`, `send_s` and `delay_s`, which
    /// is left empty for a packet that was lost. A run with packets writes such a file, `packets.csv`.
    pub file: At<String>,
}

impl DelayKind for LogFile {
    fn table() -> KindTable {
        KindTable { key: "log", description: "Packets replayed from a CSV file." }
    }

    fn plan(&self, network: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let name = &self.file.value;
        if let Some(log) = network.links.logs.get(name) {
            return Ok(DelayPlan::EachLink(log.clone()));
        }
        let table = table_text(&self.file, network.folder)?;
        let log = log_of(name, table.text(), |offset| table.line_column(offset).0);
        let log = Arc::new(log.map_err(|fault| fault.within_table(&table, &self.file))?);
        network.links.logs.insert(name.clone(), log.clone());
        Ok(DelayPlan::EachLink(log))
    }
}

/// A log that has been read.
#[derive(Debug)]
pub(in crate::scenario) struct Log {
    file: String,
    /// The packets of each edge, by the names of its agents.
    pub(in crate::scenario) links: BTreeMap<(String, String), Vec<Packet>>,
}

impl PartialEq for Log {
    /// A file is read once.
    fn eq(&self, other: &Self) -> bool {
        self.file == other.file
    }
}

impl LinkDelays for Log {
    fn stays_with_link(&self) -> bool {
        true
    }

    fn draw(&self, link: &mut Link<'_>) -> Result<Delay, Fault> {
        let [from, to] = link.names.map(str::to_owned);
        let Some(packets) = self.links.get(&(from.clone(), to.clone())) else {
            return Err(Fault::new(NetworkProblem::NotInLog { file: self.file.clone(), from, to }));
        };
        link.few("packets", packets.len() as f64)?;
        let trace = Trace::new(packets.clone(), link.end_s);
        Ok(Delay::new(trace.map_err(|error| Fault::new(NetworkProblem::Link(error)))?))
    }
}

/// The packets of one edge, and where each stands.
type Rows = Vec<(Packet, Range<usize>)>;

/// The packets of a log; `line_of` says on which line a byte stands.
fn log_of(file: &str, text: &str, line_of: impl Fn(usize) -> usize) -> Result<Log, Fault> {
    let columns = [("from", true), ("to", true), ("send_s", true), ("delay_s", false)]
        .map(|(name, required)| Column { name, required });
    let mut rows: BTreeMap<(String, String), Rows> = BTreeMap::new();
    let mut faults = Faults::default();
    for At { value: [from, to, send, delay], span } in read_table(text, columns, &mut faults)? {
        // The cell of a column that is not there is the line.
        if delay.span == span {
            let columns = columns.map(|column| column.name.to_owned()).to_vec();
            return Err(Fault::new(TableProblem::MissingColumn { name: "delay_s".into(), columns }));
        }
        let time = |key: &'static str, cell: &Cell<'_>| {
            // Adding zero takes the sign from a zero.
            cell_number(cell)?.map(|number| not_negative(key, &number).map(|time_s| time_s + 0.0)).transpose()
        };
        let (send_s, delay_s) = (faults.noted(time("send_s", &send)), faults.noted(time("delay_s", &delay)));
        let (Some(Some(send_s)), Some(delay_s)) = (send_s, delay_s) else { continue };
        let packet = Packet { send_s, delay_s };
        rows.entry((from.value.into_owned(), to.value.into_owned())).or_default().push((packet, send.span));
    }
    let mut links = BTreeMap::new();
    for (names, mut packets) in rows {
        packets.sort_by(|a, b| a.0.send_s.total_cmp(&b.0.send_s).then(a.1.start.cmp(&b.1.start)));
        for pair in packets.windows(2).filter(|pair| pair[0].0.send_s == pair[1].0.send_s) {
            faults.add(|| {
                let ((from, to), send_s) = (names.clone(), pair[0].0.send_s);
                let first_line = line_of(pair[0].1.start);
                Fault::new(NetworkProblem::PacketTwice { from, to, send_s, first_line }).at(&pair[1].1)
            });
        }
        links.insert(names, packets.into_iter().map(|(packet, _)| packet).collect());
    }
    faults.end()?;
    Ok(Log { file: file.to_owned(), links })
}
