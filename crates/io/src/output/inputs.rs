//! Copies of the files that a scenario names, in `inputs/`: with them a folder holds all that went into its run.
//!
//! A file keeps its name where that is a name below the scenario, so that `scenario.toml` finds it there. One whose name
//! leads elsewhere (`../arm.urdf`, `/robots/arm.urdf`) gets a name below `inputs/outside`, which only `summary.json` tells.

use std::path::Path;

use toml::Table;

use super::summary::Input;
use crate::files::{ReadError, open_file};
use crate::scenario::InputFile;
use crate::scenario::inputs::{INPUTS, plain_name};
use crate::scenario::run_folder::MANIFEST;
pub(crate) use crate::scenario::run_folder::is_copy;

/// What is copied: the entry of the summary and the text.
pub(crate) fn copies(inputs: &[InputFile]) -> Vec<(Input, &str)> {
    let mut copies: Vec<(Input, &str)> = Vec::new();
    let (plain, outside): (Vec<_>, Vec<_>) = inputs.iter().partition(|input| plain_name(&input.name).is_some());
    for input in plain.into_iter().chain(outside) {
        let text = input.source.text();
        let digest_blake3 = digest(text);
        let base = input.name.rsplit(['/', '\\']).next().unwrap_or_default();
        let own = plain_name(&input.name).into_iter().map(|name| format!("{INPUTS}/{name}"));
        let others = (1_u64..).map(|k| match k {
            1 => format!("{INPUTS}/outside/{base}"),
            _ => format!("{INPUTS}/outside-{k}/{base}"),
        });
        let free = |file: &String| {
            // The same text under two spellings of one name is one file.
            let same = |other: &Input| other.file == *file && other.digest_blake3 == digest_blake3;
            copies.iter().all(|(other, _)| same(other) || !clash(&other.file, file)) && !clash(MANIFEST, file)
        };
        if let Some(file) = own.chain(others).find(free) {
            copies.push((Input { name: input.name.clone(), file, digest_blake3 }, text));
        }
    }
    copies
}

/// Whether two names cannot both be files, on some disk at least: they differ in their letters' case only, or one would have
/// to be a folder.
fn clash(one: &str, other: &str) -> bool {
    let (one, other) = (one.to_lowercase(), other.to_lowercase());
    let below = |long: &str, short: &str| long.strip_prefix(short).is_some_and(|rest| rest.starts_with('/'));
    one == other || below(&one, &other) || below(&other, &one)
}

/// The BLAKE3 digest of a text, in hexadecimal.
pub fn digest(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}

/// The BLAKE3 digest of a file, in hexadecimal.
pub(crate) fn file_digest(path: &Path) -> Result<String, ReadError> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(open_file(path)?)?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// The BLAKE3 digest, in hexadecimal, of what a scenario says apart from its title: comments and layout do not enter.
/// Nothing when the text is no TOML.
pub(crate) fn content_digest(text: &str) -> Option<String> {
    let mut table: Table = text.parse().ok()?;
    table.remove("title");
    // Tables are sorted by their keys, and every number has one way to be written.
    Some(blake3::hash(table.to_string().as_bytes()).to_hex().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SourceText;

    fn files(names: &[(&str, &str)]) -> Vec<String> {
        let inputs: Vec<_> = (names.iter())
            .map(|(name, text)| InputFile { name: (*name).into(), source: SourceText::new(name, *text) })
            .collect();
        copies(&inputs).into_iter().map(|(copy, _)| copy.file).collect()
    }

    #[test]
    fn copies_keep_their_names_where_they_can() {
        assert_eq!(files(&[("arm.urdf", "1"), ("a/./b.csv", "2")]), ["inputs/arm.urdf", "inputs/a/b.csv"]);
        let outside = [("../arm.urdf", "1"), ("/robots/arm.urdf", "2"), ("a/../arm.urdf", "3")];
        assert_eq!(
            files(&outside),
            ["inputs/outside/arm.urdf", "inputs/outside-2/arm.urdf", "inputs/outside-3/arm.urdf"]
        );
    }

    #[test]
    fn no_copy_takes_the_place_of_another() {
        assert_eq!(files(&[("../a", "1"), ("outside", "2")]), ["inputs/outside", "inputs/outside-2/a"]);
        assert_eq!(files(&[("arm", "1"), ("ARM", "2")]), ["inputs/arm", "inputs/outside/ARM"]);
        assert_eq!(files(&[("manifest.json", "1")]), ["inputs/outside/manifest.json"]);
        assert_eq!(files(&[("arm", "1"), ("./arm", "1")]), ["inputs/arm", "inputs/arm"]);
    }

    #[test]
    fn a_summary_cannot_lead_out_of_its_folder() {
        assert!(is_copy("inputs/arm.urdf") && is_copy("inputs/outside/arm.urdf"));
        for file in ["arm.urdf", "inputs", "inputs/../arm.urdf", "/inputs/arm.urdf", "../inputs/arm.urdf", "inputs//a"]
        {
            assert!(!is_copy(file), "{file}");
        }
    }
    #[test]
    fn title_comments_and_layout_do_not_enter_the_content() {
        let digest = |text: &str| content_digest(text).unwrap_or_else(|| panic!("{text}"));
        let one = digest("title = \"one\"\nformat = 1 # a comment\n[time]\nend_s = 20");
        assert_eq!(one, digest("# another\ntime = { end_s = 20 }\nformat = 1\ntitle = \"two\""));
        assert_ne!(one, digest("format = 2\n[time]\nend_s = 21"));
        assert_eq!(content_digest("format ="), None);
    }
}
