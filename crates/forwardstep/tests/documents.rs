//! The documents say what is true: links lead somewhere, names exist, the table of the paper is complete.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use pulldown_cmark::{Options, Parser};

/// The labels of the paper's equations without `eq:`, in the order of the paper.
const LABELS: [&str; 77] = [
    "1", "aa2", "aa3", "aa6", "aa10", "4", "aa12", "aa13", "3", "5", "6", "7", "9", "11", "12", "14", "17", "19", "23",
    "a1", "a2", "a3", "a4", "a5", "24", "25", "26", "27", "28", "a6", "30", "31", "33", "43", "a7", "a8", "a9", "44",
    "45", "46", "47", "49", "50", "52", "54", "57", "58", "71", "72", "73", "74", "75", "76", "77", "78", "79", "80",
    "81", "82", "a10", "94", "97", "99", "100", "104", "105", "106", "107", "108", "110", "112", "113", "114", "115",
    "118", "119", "122",
];
/// How many of each the paper has, numbered from one.
const NUMBERED: [(&str, usize); 3] = [("Property", 7), ("Theorem", 9), ("Remark", 12)];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// All files below `folder` with this extension, but for what is built or downloaded.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() {
            if !name.starts_with('.') && !["target", "venv", "forwardstep-runs"].contains(&name) {
                found.extend(files(&path, extension));
            }
        } else if path.extension().is_some_and(|own| own == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// A Markdown file.
struct Document {
    path: PathBuf,
    /// Its lines, without fenced blocks.
    prose: Vec<String>,
    /// Fenced blocks: what they are written in, and their text.
    blocks: Vec<(String, String)>,
}

/// Words and where they lead.
#[derive(Clone)]
struct Link {
    text: String,
    target: String,
}

impl Document {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut document = Document { path: path.to_owned(), prose: Vec::new(), blocks: Vec::new() };
        let mut fence: Option<(String, String)> = None;
        for line in text.lines() {
            match (line.trim_start().strip_prefix("```"), &mut fence) {
                (Some(language), None) => fence = Some((language.to_owned(), String::new())),
                (Some(_), Some(_)) => document.blocks.extend(fence.take()),
                (None, Some((_, block))) => *block += &format!("{line}\n"),
                (None, None) => document.prose.push(line.to_owned()),
            }
        }
        assert!(fence.is_none(), "{}: a fence is left open", path.display());
        document
    }

    fn named(name: &str) -> Self {
        Self::read(&root().join(name))
    }

    fn all() -> Vec<Self> {
        files(&root(), "md").iter().map(|path| Self::read(path)).collect()
    }

    /// `[text]: target` lines.
    fn definitions(&self) -> Vec<Link> {
        let definition = |line: &String| {
            let (text, target) = line.strip_prefix('[')?.split_once("]: ")?;
            Some(Link { text: text.to_owned(), target: target.trim().to_owned() })
        };
        self.prose.iter().filter_map(definition).collect()
    }

    /// `[text](target)` and `[text]` with a definition, in a line.
    fn links_in(&self, line: &str, definitions: &[Link]) -> Vec<Link> {
        let mut found = Vec::new();
        for (open, _) in line.match_indices('[') {
            let Some(length) = line[open..].find(']') else { continue };
            let (text, rest) = (&line[open + 1..open + length], &line[open + length + 1..]);
            if let Some((target, _)) = rest.strip_prefix('(').and_then(|rest| rest.split_once(')')) {
                found.push(Link { text: text.to_owned(), target: target.to_owned() });
            } else if rest.starts_with(": ") && open == 0 {
                continue;
            } else if let Some(known) = definitions.iter().find(|known| known.text == text) {
                found.push(known.clone());
            } else {
                let is_code = text.len() > 2 && text.starts_with('`') && text.ends_with('`');
                assert!(!is_code, "{}: [{text}] leads nowhere", self.path.display());
            }
        }
        found
    }

    fn links(&self) -> Vec<Link> {
        let definitions = self.definitions();
        self.prose.iter().flat_map(|line| self.links_in(line, &definitions)).collect()
    }

    /// Names of its headings as links spell them.
    fn anchors(&self) -> BTreeSet<String> {
        let headings = self.prose.iter().filter(|line| line.starts_with('#'));
        let spelt = |heading: &String| {
            let kept = heading.trim_start_matches('#').trim().to_lowercase();
            let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
            kept.map(|c| if c == ' ' { '-' } else { c }).collect()
        };
        headings.map(spelt).collect()
    }

    /// The cells of the rows of its tables, without heads.
    fn rows(&self) -> Vec<Vec<String>> {
        let mut rows = Vec::new();
        for pair in self.prose.windows(2) {
            let is_rule = |line: &str| line.starts_with("|--");
            if pair[0].starts_with('|') && !is_rule(&pair[0]) && !is_rule(&pair[1]) {
                rows.push(pair[0].trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect());
            }
        }
        rows
    }
}

/// Whether `text` has the word `name`.
fn has_word(text: &str, name: &str) -> bool {
    let part_of_word = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(name).any(|(at, _)| {
        let (before, after) = (&text[..at], &text[at + name.len()..]);
        !before.ends_with(part_of_word) && !after.starts_with(part_of_word)
    })
}

/// Names of the test functions in a source text.
fn tests_in(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut lines = text.lines().map(str::trim);
    while let Some(line) = lines.next() {
        if line.ends_with("#[test]") {
            let function = lines.by_ref().find_map(|line| line.strip_prefix("fn ")).unwrap_or_default();
            found.insert(function.split(['(', ' ']).next().unwrap_or_default().to_owned());
        }
    }
    // `shipped! { name: "scenario", … }` makes a test per line.
    if found.contains("$test") {
        let made = text.lines().filter_map(|line| line.trim().split_once(": \"")).map(|(name, _)| name.to_owned());
        found.extend(made);
    }
    found
}

fn is_local(target: &str) -> bool {
    !target.contains("://") && !target.starts_with("mailto:")
}

#[test]
fn links_lead_somewhere() {
    let mut broken = Vec::new();
    for document in Document::all() {
        let name = document.path.strip_prefix(root()).unwrap().display();
        let folder = document.path.parent().unwrap();
        for Link { target, .. } in document.links().into_iter().chain(document.definitions()) {
            if !is_local(&target) {
                continue;
            }
            let (file, anchor) = target.split_once('#').unwrap_or((&target, ""));
            let path = if file.is_empty() { document.path.clone() } else { folder.join(file) };
            let found = path.exists() && (anchor.is_empty() || Document::read(&path).anchors().contains(anchor));
            if !found {
                broken.push(format!("{name}: {target}"));
            }
        }
    }
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
}

#[test]
fn every_definition_is_used() {
    let mut unused = Vec::new();
    for document in Document::all() {
        let used: BTreeSet<String> = document.links().into_iter().map(|link| link.text).collect();
        let defined = document.definitions().into_iter().map(|link| link.text);
        unused.extend(
            defined.filter(|text| !used.contains(text)).map(|text| format!("{}: {text}", document.path.display())),
        );
    }
    assert!(unused.is_empty(), "\n{}", unused.join("\n"));
}

/// A link whose text is a name in code, and whose target is a source file, says that the name is in that file.
#[test]
fn names_in_code_are_where_the_documents_say() {
    let mut missing = Vec::new();
    for document in Document::all() {
        for Link { text, target } in document.links().into_iter().chain(document.definitions()) {
            let Some(name) = text.strip_prefix('`').and_then(|text| text.strip_suffix('`')) else { continue };
            if !target.ends_with(".rs") || name.contains('.') {
                continue;
            }
            let source = fs::read_to_string(document.path.parent().unwrap().join(&target)).unwrap_or_default();
            if !name.split("::").all(|part| has_word(&source, part)) {
                missing.push(format!("{}: {name} is not in {target}", document.path.display()));
            }
        }
    }
    missing.dedup();
    assert!(missing.is_empty(), "\n{}", missing.join("\n"));
}

#[test]
fn the_paper_is_covered_in_its_order() {
    let rows = Document::named("PAPER.md").rows();
    let place = |name: &str| rows.iter().position(|row| row[0] == name);
    let mut missing = Vec::new();
    let mut last = 0;
    for label in LABELS {
        match place(&format!("({label})")) {
            Some(row) if row >= last => last = row,
            Some(_) => missing.push(format!("({label}) stands too early")),
            None => missing.push(format!("({label})")),
        }
    }
    for (kind, count) in NUMBERED {
        let places: Vec<_> = (1..=count).map(|k| place(&format!("{kind} {k}"))).collect();
        let absent = places.iter().enumerate().filter(|(_, place)| place.is_none());
        missing.extend(absent.map(|(k, _)| format!("{kind} {}", k + 1)));
        assert!(places.is_sorted(), "{kind} in another order than in the paper");
    }
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn every_row_about_the_paper_says_where_and_how_it_is_tested() {
    let paper = Document::named("PAPER.md");
    let definitions = paper.definitions();
    let mut wrong = Vec::new();
    for row in paper.rows() {
        let [name, says, module, scenario, test] = &row[..] else { panic!("{row:?}") };
        let blank = [name, says, module, scenario, test].into_iter().any(|cell| cell.is_empty());
        let tests = paper.links_in(test, &definitions);
        if blank || tests.is_empty() {
            wrong.push(format!("{name}: a cell is empty"));
        }
        for Link { text, target } in tests {
            let source = fs::read_to_string(root().join(&target)).unwrap_or_default();
            if !tests_in(&source).contains(text.trim_matches('`')) {
                wrong.push(format!("{name}: {text} is no test in {target}"));
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// One inside a table, or right behind a paragraph, is text to whatever shows the document.
#[test]
fn definitions_of_links_stand_where_markdown_reads_them() {
    let mut lost = Vec::new();
    for document in Document::all() {
        let text = fs::read_to_string(&document.path).unwrap();
        let parser = Parser::new_ext(&text, Options::ENABLE_TABLES);
        let is_lost = |known: &Link| parser.reference_definitions().get(&known.text).is_none();
        let name = document.path.strip_prefix(root()).unwrap().display().to_string();
        lost.extend(
            document.definitions().into_iter().filter(is_lost).map(|known| format!("{name}: [{}]", known.text)),
        );
    }
    assert!(lost.is_empty(), "\n{}", lost.join("\n"));
}

#[test]
fn every_source_file_is_on_the_map() {
    let map = Document::named("ARCHITECTURE.md");
    let linked: BTreeSet<String> = map.links().into_iter().map(|link| link.target).collect();
    let sources = files(&root().join("crates"), "rs");
    let relative = sources.iter().map(|path| path.strip_prefix(root()).unwrap().to_str().unwrap());
    let unmapped: Vec<_> = relative.filter(|path| path.contains("/src/") && !linked.contains(*path)).collect();
    assert!(unmapped.is_empty(), "not in the code map of ARCHITECTURE.md:\n{}", unmapped.join("\n"));
}

/// A public item of a source file: its name, and its documentation line by line.
fn items(source: &str) -> Vec<(String, Vec<String>)> {
    let (mut found, mut documentation) = (Vec::new(), Vec::new());
    for line in source.lines() {
        if let Some(line) = line.strip_prefix("///") {
            documentation.push(line.trim().to_owned());
        } else if !line.starts_with("#[") {
            let item =
                ["pub struct ", "pub enum ", "pub trait ", "pub fn "].iter().find_map(|kind| line.strip_prefix(kind));
            let documentation = std::mem::take(&mut documentation);
            let name = item.and_then(|item| item.split(|c: char| !c.is_alphanumeric() && c != '_').next());
            found.extend(name.map(|name| (name.to_owned(), documentation)));
        }
    }
    found
}

/// Whether a block of it is run and asserts something.
fn is_tested(documentation: &[String]) -> bool {
    let (mut runs, mut open) = (false, false);
    for line in documentation {
        match (line.strip_prefix("```"), open) {
            (Some(language), false) => (runs, open) = (language.is_empty(), true),
            (Some(_), true) => open = false,
            (None, _) if open && runs && line.starts_with("assert") => return true,
            _ => {}
        }
    }
    false
}

/// A law is what names its source, or is a controller or reference dynamics; so is what a processor runs.
#[test]
fn every_public_law_has_a_doctest() {
    let core = root().join("crates/core/src");
    let mut laws: BTreeSet<String> = ["Agent", "Stepped", "Sampled", "Recipe", "Mailbox"].map(str::to_owned).into();
    let (mut tested, mut public) = (BTreeSet::new(), BTreeSet::new());
    for path in
        ["agent", "controller", "law", "reference", "sampled"].iter().flat_map(|folder| files(&core.join(folder), "rs"))
    {
        let source = fs::read_to_string(path).unwrap();
        for kind in [" Controller for ", " Reference for "] {
            let implemented =
                source.lines().filter(|line| line.starts_with("impl")).filter_map(|line| line.split_once(kind));
            laws.extend(implemented.map(|(_, name)| name.split(['<', ' ']).next().unwrap().to_owned()));
        }
        for (name, documentation) in items(&source) {
            if documentation.iter().any(|line| line.starts_with("**Source**")) {
                laws.insert(name.clone());
            }
            if is_tested(&documentation) {
                tested.insert(name.clone());
            }
            public.insert(name);
        }
    }
    assert!(laws.len() > 15 && laws.is_subset(&public), "{:?}", laws.difference(&public));
    let missing: Vec<_> = laws.difference(&tested).collect();
    assert!(missing.is_empty(), "no test in the documentation of {missing:?}");
}

#[test]
fn the_first_program_in_the_readme_is_the_example() {
    let example = fs::read_to_string(root().join("crates/forwardstep/examples/first.rs")).unwrap();
    let readme = Document::named("README.md");
    assert!(readme.blocks.iter().any(|(language, block)| language == "rust" && *block == example));
}

#[test]
fn every_invariant_names_its_guard() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let invariants = text.split("\n\n").filter(|paragraph| paragraph.trim().starts_with("**Architecture invariant"));
    let unguarded: Vec<_> = invariants.clone().filter(|paragraph| !paragraph.contains("*Guard:*")).collect();
    assert!(unguarded.is_empty(), "\n{}", unguarded.join("\n\n"));
    assert!(invariants.count() > 5);
}

#[test]
fn the_tour_quotes_a_shipped_scenario() {
    let scenario = fs::read_to_string(root().join("crates/io/scenarios/six-arms.toml")).unwrap();
    let readme = Document::named("README.md");
    let quoted: Vec<_> = readme.blocks.iter().filter(|(language, _)| language == "toml").collect();
    assert!(!quoted.is_empty());
    for (_, block) in quoted {
        assert!(scenario.contains(block.as_str()), "not in six-arms.toml:\n{block}");
    }
}

#[test]
fn the_readme_has_the_commands_that_are_run_for_every_change() {
    let script = fs::read_to_string(root().join(".ci/run")).unwrap();
    let readme = Document::named("README.md");
    for variable in ["test_command", "run_command"] {
        let assignment = script.lines().find_map(|line| line.strip_prefix(&format!("{variable}='")));
        let command = assignment.and_then(|rest| rest.strip_suffix('\'')).unwrap();
        let shown = readme.blocks.iter().any(|(_, block)| block.lines().any(|line| line == command));
        assert!(shown, "the README does not say `{command}`");
    }
}
