//! Links and joints as a tree: one base, every other link held by one joint.
//!
//! Links are numbered as Pinocchio does: depth first from the base, the joints of one link in the order of their names
//! (bytewise). The order in the file has no influence.

use std::collections::HashMap;
use std::ops::Range;

use super::joint::Joint;
use super::link::Link;
use super::problem::UrdfProblem;
use super::subject::{End, Named, NamedLine};
use super::xml::{Located, Reading, UrdfError};
use crate::wording::nearest;

/// A link with the joint that holds it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    /// Index into the links of the file.
    pub(super) link: usize,
    /// Index into the joints of the file; `None` for the base, which comes first.
    pub(super) joint: Option<usize>,
    /// Index of the parent in the arranged list, always earlier.
    pub(super) parent: Option<usize>,
}

/// Arranges links and joints from the base outwards.
pub(super) fn arrange(reading: &mut Reading<'_>, links: &[Link], joints: &[Joint]) -> Result<Vec<Held>, UrdfError> {
    let names = links.iter().map(|link| (link.name.as_str(), &link.span));
    let (link_index, mut is_sound) = index_by_name(reading, Named::Link, names);
    let names = joints.iter().map(|joint| (joint.name.as_str(), &joint.span));
    is_sound &= index_by_name(reading, Named::Joint, names).1;

    let mut holder: Vec<Option<usize>> = vec![None; links.len()];
    let mut held_by: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
    for (j, joint) in joints.iter().enumerate() {
        let mut find = |end, name: &Located<String>| {
            let found = link_index.get(name.value.as_str()).copied().ok_or_else(|| {
                let problem = UrdfProblem::UnknownLink {
                    joint: joint.name.clone(),
                    end,
                    link: name.value.clone(),
                    nearest: nearest(&name.value, links.iter().map(|link| link.name.as_str())),
                };
                reading.error(name.span.clone(), problem)
            });
            reading.noted(found)
        };
        let (Some(parent), Some(child)) = (find(End::Parent, &joint.parent), find(End::Child, &joint.child)) else {
            is_sound = false;
            continue;
        };
        if let Some(first) = holder[child] {
            let problem = UrdfProblem::TwoParents {
                link: links[child].name.clone(),
                joint: joint.name.clone(),
                first: named_line(reading, &joints[first].name, &joints[first].child.span),
            };
            reading.noted::<()>(Err(reading.error(joint.child.span.clone(), problem)));
            is_sound = false;
            continue;
        }
        holder[child] = Some(j);
        held_by[parent].push(j);
    }
    // Links without a parent, and loops, may only follow from what was found.
    if !is_sound {
        return Ok(Vec::new());
    }
    for joints_of_link in &mut held_by {
        joints_of_link.sort_by(|a, b| joints[*a].name.cmp(&joints[*b].name));
    }

    let mut bases = (0..links.len()).filter(|link| holder[*link].is_none());
    let Some(base) = bases.next() else {
        return Err(match links.first() {
            Some(_) => loop_error(reading, links, joints, &holder, 0, &link_index),
            None => reading.error_overall(UrdfProblem::NoLinks),
        });
    };
    for another in bases {
        let problem = UrdfProblem::SeveralBases {
            link: links[another].name.clone(),
            first: named_line(reading, &links[base].name, &links[base].span),
        };
        reading.noted::<()>(Err(reading.error(links[another].span.clone(), problem)));
        is_sound = false;
    }
    if !is_sound {
        return Ok(Vec::new());
    }

    let mut arranged = Vec::with_capacity(links.len());
    let mut pending = vec![Held { link: base, joint: None, parent: None }];
    let mut reached = vec![false; links.len()];
    while let Some(held) = pending.pop() {
        let here = arranged.len();
        reached[held.link] = true;
        arranged.push(held);
        // The last pushed is visited first, hence the reverse order.
        pending.extend(held_by[held.link].iter().rev().map(|&j| Held {
            link: link_index[joints[j].child.value.as_str()],
            joint: Some(j),
            parent: Some(here),
        }));
    }
    match reached.iter().position(|reached| !reached) {
        Some(link) => Err(loop_error(reading, links, joints, &holder, link, &link_index)),
        None => Ok(arranged),
    }
}

/// Numbers by name, which must not occur twice; whether none does.
fn index_by_name<'n>(
    reading: &mut Reading<'_>,
    what: Named,
    names: impl Iterator<Item = (&'n str, &'n Range<usize>)>,
) -> (HashMap<&'n str, usize>, bool) {
    let mut index: HashMap<&str, (usize, usize)> = HashMap::new();
    let mut is_sound = true;
    for (k, (name, span)) in names.enumerate() {
        match index.get(name) {
            Some((_, first)) => {
                let first_line = reading.line(*first);
                let problem = UrdfProblem::DuplicateName { what, name: name.to_owned(), first_line };
                reading.noted::<()>(Err(reading.error(span.clone(), problem)));
                is_sound = false;
            }
            None => {
                index.insert(name, (k, span.start));
            }
        }
    }
    (index.into_iter().map(|(name, (k, _))| (name, k)).collect(), is_sound)
}

/// The loop that is met when going from `link` towards the base without ever reaching one.
fn loop_error(
    reading: &Reading<'_>,
    links: &[Link],
    joints: &[Joint],
    holder: &[Option<usize>],
    link: usize,
    link_index: &HashMap<&str, usize>,
) -> UrdfError {
    let mut seen_at: Vec<Option<usize>> = vec![None; links.len()];
    let mut path = Vec::new();
    let mut here = link;
    while seen_at[here].is_none() {
        let Some(joint) = holder[here] else { break };
        seen_at[here] = Some(path.len());
        path.push(joint);
        here = link_index[joints[joint].parent.value.as_str()];
    }
    let mut on_loop = path.split_off(seen_at[here].unwrap_or(0));
    on_loop.sort_by_key(|j| joints[*j].span.start);
    let span = on_loop.first().map_or(0..0, |j| joints[*j].span.clone());
    let joints = on_loop.iter().map(|j| named_line(reading, &joints[*j].name, &joints[*j].span)).collect();
    reading.error(span, UrdfProblem::Loop { joints })
}

fn named_line(reading: &Reading<'_>, name: &str, span: &Range<usize>) -> NamedLine {
    NamedLine { name: name.to_owned(), line: reading.line(span.start) }
}
