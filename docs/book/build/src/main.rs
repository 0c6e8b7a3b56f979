//! Turns the book into pages, in a folder that is given or in `target/book`, and follows every link on them: each has to lead to a
//! page, a picture or a heading. Links to other places are not followed; the book has none.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;

use mdbook_driver::MDBook;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = match std::env::args_os().nth(1) {
        Some(folder) => std::path::absolute(folder)?,
        None => book.join("../../target/book"),
    };
    let mut pages = MDBook::load(&book)?;
    pages.config.build.build_dir.clone_from(&folder);
    pages.build()?;

    let lost = links_to_nothing(&folder)?;
    for (page, link) in &lost {
        eprintln!("{page}: nothing is at {link}");
    }
    if !lost.is_empty() {
        return Ok(ExitCode::FAILURE);
    }
    println!("{}", fs::canonicalize(folder)?.join("index.html").display());
    Ok(ExitCode::SUCCESS)
}

/// Links of all pages in `folder` that lead nowhere, each with the page that has it.
fn links_to_nothing(folder: &Path) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let mut pages = BTreeMap::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "html") {
            pages.insert(path.clone(), fs::read_to_string(&path)?);
        }
    }
    let headings: BTreeMap<&PathBuf, BTreeSet<&str>> =
        pages.iter().map(|(path, page)| (path, values(page, " id=\"").collect())).collect();

    let mut lost = Vec::new();
    for (path, page) in &pages {
        // Sites put it at addresses of their own, so its links begin at the root of the site.
        if path.ends_with("404.html") {
            continue;
        }
        for link in values(page, " href=\"").chain(values(page, " src=\"")) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { path.clone() } else { within(folder, file) };
            let found = match headings.get(&target) {
                Some(headings) => heading.is_empty() || headings.contains(heading),
                None => heading.is_empty() && target.is_file(),
            };
            if !found {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                lost.push((name, link.to_owned()));
            }
        }
    }
    Ok(lost)
}

/// What stands between `start` and the next quotation mark, wherever it does.
fn values<'a>(page: &'a str, start: &'a str) -> impl Iterator<Item = &'a str> {
    page.split(start).skip(1).filter_map(|rest| rest.split('"').next())
}

/// The path of `link`, with steps upwards taken.
fn within(folder: &Path, link: &str) -> PathBuf {
    let mut path = folder.to_owned();
    for part in Path::new(link).components() {
        match part {
            Component::ParentDir => drop(path.pop()),
            Component::Normal(name) => path.push(name),
            _ => {}
        }
    }
    path
}
