//! `delay.hold_log`: held values replayed from a file.

use std::collections::BTreeMap;
use std::sync::Arc;

use forwardstep_sim::delay::{Delay, HoldLog};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, Faults, count, fault, not_negative};
use super::super::super::network::NetworkReader;
use super::super::super::network_problem::NetworkProblem;
use super::super::super::table::{Column, TableProblem, cell_number, read_table, rising, table_text};
use super::super::KindTable;
use super::{DelayKind, DelayPlan, Link, LinkDelays};

/// Holds that one link may have in its phases.
const MOST_HOLDS: u32 = 1_000_000;

/// Held values that were drawn or recorded.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoldLogFile {
    /// The CSV file, beside the scenario file or in `inputs` beside it. Its first line names its columns: `from`, `to`, `hold`, `t_s`,
    /// rising from 0 for every link and hold, and `delay_s`, the delay that begins there. It is empty in the last line of a hold, which
    /// says when that ends. A run with random holds writes such a file, `holds.csv`.
    pub file: At<String>,
    /// Which hold of the link: a link may have others in other phases. Default: 1.
    pub hold: Option<At<i64>>,
}

impl DelayKind for HoldLogFile {
    fn table() -> KindTable {
        KindTable { key: "hold_log", description: "Held values replayed from a CSV file." }
    }

    fn plan(&self, network: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let hold = self.hold.as_ref().map_or(Ok(1), |hold| count("hold", hold, MOST_HOLDS))?;
        let name = &self.file.value;
        let table = match network.links.held.get(name) {
            Some(known) => known.clone(),
            None => {
                let source = table_text(&self.file, network.folder)?;
                let end_s = network.end_s;
                let table =
                    Arc::new(table_of(source.text(), end_s).map_err(|fault| fault.within_table(&source, &self.file))?);
                network.links.held.insert(name.clone(), table.clone());
                table
            }
        };
        Ok(DelayPlan::each_link(Held { file: name.clone(), hold, table }))
    }
}

/// The holds of a table by the names of sender and receiver, and number.
pub(in crate::scenario) type Holds = BTreeMap<(String, String, usize), HoldLog>;

/// One number of hold for all links.
#[derive(Clone, Debug, PartialEq)]
struct Held {
    file: String,
    hold: usize,
    table: Arc<Holds>,
}

impl LinkDelays for Held {
    fn stays_with_link(&self) -> bool {
        false
    }

    fn draw(&self, link: &mut Link<'_>) -> Result<Delay, Fault> {
        let [from, to] = link.names.map(str::to_owned);
        let Some(held) = self.table.get(&(from.clone(), to.clone(), self.hold)) else {
            return Err(Fault::new(NetworkProblem::NotHeld { file: self.file.clone(), hold: self.hold, from, to }));
        };
        link.few("jumps of the delay", held.times_s.len() as f64)?;
        Ok(Delay::new(held.clone()))
    }
}

/// When a value begins, and the value; none at the end.
type Row = (At<f64>, Option<f64>);

/// The holds of a table.
fn table_of(text: &str, end_s: f64) -> Result<Holds, Fault> {
    let columns = [("from", true), ("to", true), ("hold", true), ("t_s", true), ("delay_s", false)]
        .map(|(name, required)| Column { name, required });
    let mut rows: BTreeMap<(String, String, usize), Vec<Row>> = BTreeMap::new();
    let mut faults = Faults::default();
    for At { value: [from, to, hold, t_s, delay], span } in read_table(text, columns, &mut faults)? {
        if delay.span == span {
            let columns = columns.map(|column| column.name.to_owned()).to_vec();
            return Err(Fault::new(TableProblem::MissingColumn { name: "delay_s".into(), columns }));
        }
        let number = cell_number(&hold).and_then(|hold| hold.as_ref().map(number_of).transpose());
        let delay_s = cell_number(&delay).and_then(|delay| delay.map(|it| not_negative("delay_s", &it)).transpose());
        let read = (faults.noted(number), faults.noted(cell_number(&t_s)), faults.noted(delay_s));
        let (Some(Some(number)), Some(Some(t_s)), Some(delay_s)) = read else { continue };
        rows.entry((from.value.into_owned(), to.value.into_owned(), number)).or_default().push((t_s, delay_s));
    }
    // Whether times rise and a hold ends is asked of rows that are all there.
    faults.end()?;
    let mut faults = Faults::default();
    let holds = rows.into_iter().filter_map(|(link, rows)| Some((link, faults.noted(hold_of(rows, end_s))?))).collect();
    faults.end().map(|()| holds)
}

/// The number of a hold.
fn number_of(hold: &At<f64>) -> Result<usize, Fault> {
    let whole = At { value: hold.value as i64, span: hold.span.clone() };
    let number = count("hold", &whole, MOST_HOLDS)?;
    if whole.value as f64 != hold.value {
        return Err(fault(hold, NetworkProblem::NotANumber { found: hold.value }));
    }
    Ok(number)
}

/// One hold; the last of its rows is its end.
fn hold_of(rows: Vec<Row>, end_s: f64) -> Result<HoldLog, Fault> {
    let times: Vec<At<f64>> = rows.iter().map(|(t_s, _)| t_s.clone()).collect();
    rising("t_s", &times)?;
    let starts = |first: &At<f64>| fault(first, NetworkProblem::StartsLate);
    if let Some(first) = times.first().filter(|first| first.value != 0.0) {
        return Err(starts(first));
    }
    let mut held = HoldLog { times_s: Vec::new(), values_s: Vec::new(), until_s: 0.0 };
    let mut ended = false;
    for (t_s, delay_s) in rows {
        match delay_s {
            _ if ended => return Err(fault(&t_s, NetworkProblem::AfterTheEnd)),
            None if held.times_s.is_empty() => return Err(starts(&t_s)),
            None if t_s.value < end_s => {
                return Err(fault(&t_s, NetworkProblem::LogEndsEarly { until_s: t_s.value, end_s }));
            }
            None => (held.until_s, ended) = (t_s.value, true),
            Some(delay_s) => {
                held.times_s.push(t_s.value + 0.0);
                held.values_s.push(delay_s + 0.0);
            }
        }
    }
    if ended { Ok(held) } else { Err(Fault::new(NetworkProblem::NoEnd)) }
}
