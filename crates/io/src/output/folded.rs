//! Lines of advice that say nearly the same, as one.

/// What stands before the part in which lines may differ.
const TO_CHANGE: &str = "; to make it hold: ";

/// The same lines, each once; those that differ only in what would help are one line with all of that.
///
/// ```
/// use forwardstep_io::output::folded;
///
/// let lines = ["not shown; to make it hold: a", "run longer", "not shown; to make it hold: a", "not shown; to make it hold: b"];
/// assert_eq!(folded(lines.map(String::from)), ["not shown; to make it hold: a; or b", "run longer"]);
/// ```
pub fn folded(lines: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut all: Vec<(String, Vec<String>)> = Vec::new();
    for line in lines {
        let (head, change) = match line.split_once(TO_CHANGE) {
            Some((head, change)) => (head.to_owned(), Some(change.to_owned())),
            None => (line, None),
        };
        match all.iter_mut().find(|(known, _)| *known == head) {
            Some((_, changes)) => changes.extend(change.filter(|change| !changes.contains(change))),
            None => all.push((head, change.into_iter().collect())),
        }
    }
    all.into_iter().map(|(head, changes)| joined(head, &changes)).collect()
}

fn joined(head: String, changes: &[String]) -> String {
    if changes.is_empty() { head } else { format!("{head}{TO_CHANGE}{}", changes.join("; or ")) }
}
