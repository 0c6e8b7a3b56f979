//! Texts that tests read are where fuzzers begin.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

/// Longer texts make fuzzers slow.
const LONGEST: usize = 16_384;

/// Keeps `text` in the folder `kind` of the one that `FORWARDSTEP_SEEDS` names, if it names one; see `fuzz/README.md`.
pub(crate) fn keep(kind: &str, text: &str) {
    let Some(folder) = std::env::var_os("FORWARDSTEP_SEEDS") else { return };
    if text.len() > LONGEST {
        return;
    }
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    std::fs::write(Path::new(&folder).join(kind).join(format!("{:016x}", hasher.finish())), text).unwrap();
}
