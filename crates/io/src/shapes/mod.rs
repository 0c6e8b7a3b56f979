//! What robots look like: the shapes of their links, for the picture in space. They are read beside the model and change nothing in it.
//!
//! A shape that is not found, not read or not drawn is left out with a word why; its link is drawn as a capsule then.

mod coarse;
mod collada;
mod place;
mod triangles;
mod visual;

use std::collections::HashMap;
use std::path::PathBuf;

use forwardstep_core::robot::tree::Placement;
use serde::{Deserialize, Serialize};

use crate::one_line;
use crate::scenario::Model;
use place::Folders;
use triangles::{MOST_TRIANGLES, Triangles};
use visual::{Form, Visual};

/// The shapes of all robots.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shapes {
    /// Each once.
    pub solids: Vec<Solid>,
    /// The parts of robots that look different.
    pub robots: Vec<Vec<Part>>,
    /// Which of them each agent is.
    pub agents: Vec<Option<usize>>,
}

/// Triangles, in numbers of two bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solid {
    /// The least coordinates, m.
    pub low: [f64; 3],
    /// What a step of a number is, m.
    pub step: [f64; 3],
    /// Three numbers for each point, little-endian in base64.
    pub points: String,
    /// Three numbers of points for each triangle.
    pub faces: String,
}

impl Solid {
    /// Bytes of its numbers as they stand on a page.
    pub fn bytes(&self) -> usize {
        self.points.len() + self.faces.len()
    }
}

/// A solid on a robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// The moving body that carries it, from zero; the base otherwise.
    pub body: Option<usize>,
    /// Its frame in that of the body: rotation row by row, then translation in m.
    pub place: ([[f64; 3]; 3], [f64; 3]),
    /// Its number among the solids.
    pub solid: usize,
}

impl Shapes {
    /// The parts of an agent.
    pub fn of(&self, agent: usize) -> &[Part] {
        let robot = self.agents.get(agent).copied().flatten().and_then(|robot| self.robots.get(robot));
        robot.map_or(&[], Vec::as_slice)
    }

    /// Whether every number that it holds leads somewhere.
    pub fn is_sound(&self) -> bool {
        self.agents.iter().flatten().all(|robot| *robot < self.robots.len())
            && self.robots.iter().flatten().all(|part| part.solid < self.solids.len())
    }

    /// The shapes of all agents, agent by agent, and what was left out.
    pub fn read(models: &[Option<Model>]) -> (Shapes, Vec<String>) {
        let mut reading = Reading::default();
        let mut known: Vec<&Model> = Vec::new();
        let mut shapes = Shapes::default();
        for model in models {
            let robot = model.as_ref().map(|model| {
                known.iter().position(|other| same(other, model)).unwrap_or_else(|| {
                    known.push(model);
                    shapes.robots.push(reading.robot(model));
                    known.len() - 1
                })
            });
            shapes.agents.push(robot);
        }
        if known.is_empty() {
            reading.left_out.push("no robot here is from a URDF".to_owned());
        }
        let mut times = vec![0; reading.solids.len()];
        for robot in shapes.agents.iter().flatten() {
            shapes.robots[*robot].iter().for_each(|part| times[part.solid] += 1);
        }
        shapes.solids = coarse::coarse(&reading.solids, &times);
        // What became too small to be seen is a capsule.
        let is_seen = |part: &Part| shapes.solids.get(part.solid).is_some_and(|solid| !solid.faces.is_empty());
        shapes.robots.iter_mut().for_each(|parts| parts.retain(is_seen));
        // They quote the files.
        (shapes, reading.left_out.iter().map(one_line).collect())
    }
}

/// Members of a population share their text.
fn same(a: &Model, b: &Model) -> bool {
    let texts = [a.urdf.text(), b.urdf.text()];
    (std::ptr::eq(texts[0], texts[1]) || texts[0] == texts[1]) && a.urdf.name() == b.urdf.name() && a.links == b.links
}

/// Solids by where they are from, each once.
#[derive(Default)]
struct Reading {
    solids: Vec<Triangles>,
    /// The solids of meshes, by their files and the bits of what they are scaled by: many parts may be of one file, and it is read once.
    meshes: HashMap<(PathBuf, [u64; 3]), Result<usize, String>>,
    triangles: usize,
    left_out: Vec<String>,
}

impl Reading {
    fn robot(&mut self, model: &Model) -> Vec<Part> {
        let (visuals, left_out) = visual::visuals(model.urdf.text());
        let file = model.urdf.name();
        self.left_out.extend(left_out.into_iter().map(|why| format!("{file}: {why}")));
        if visuals.is_empty() {
            self.left_out.push(format!("{file}: it says nothing of shapes"));
        }
        let folders = Folders::of(file);
        let mut parts = Vec::new();
        for Visual { link, place, form } in visuals {
            let Some((_, anchor)) = model.links.iter().find(|(name, _)| *name == link) else { continue };
            match self.solid(form, folders.as_ref()) {
                Ok(solid) => {
                    let Placement { rotation, translation } = anchor.x_body_link.compose(&place);
                    parts.push(Part { body: anchor.body, place: (rotation, translation), solid });
                }
                Err(why) => self.left_out.push(format!("{file}: {why}")),
            }
        }
        parts
    }

    /// The number of a solid.
    fn solid(&mut self, form: Form, folders: Option<&Folders>) -> Result<usize, String> {
        match form {
            Form::Mesh { file, scale } => {
                self.mesh(&file, scale, folders).map_err(|why| format!("the mesh `{file}`: {why}"))
            }
            Form::Box(size) => self.kept(Triangles::cuboid(size)),
            Form::Cylinder { radius, length } => self.kept(Triangles::cylinder(radius, length)),
            Form::Sphere { radius } => self.kept(Triangles::sphere(radius)),
        }
    }

    fn mesh(&mut self, name: &str, scale: [f64; 3], folders: Option<&Folders>) -> Result<usize, String> {
        let path = folders.ok_or("a shipped robot has no folder")?.path(name)?;
        let key = (path, scale.map(f64::to_bits));
        if let Some(known) = self.meshes.get(&key) {
            return known.clone();
        }
        let read = place::read(&key.0).and_then(|bytes| Triangles::read(name, &bytes));
        let solid = read.and_then(|own| self.kept(own.scaled(scale)));
        self.meshes.insert(key, solid.clone());
        solid
    }

    /// The number of a solid with these triangles.
    fn kept(&mut self, own: Triangles) -> Result<usize, String> {
        let own = coarse::distinct(&own.sound());
        if own.faces.is_empty() {
            return Err("a shape without an area".to_owned());
        }
        if let Some(known) = self.solids.iter().position(|other| *other == own) {
            return Ok(known);
        }
        if self.triangles + own.faces.len() > MOST_TRIANGLES {
            return Err(format!("all shapes together have more than {MOST_TRIANGLES} triangles"));
        }
        self.triangles += own.faces.len();
        self.solids.push(own);
        Ok(self.solids.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::fs;

    /// A link of a chain drawn a hundred times.
    #[test]
    fn regress_a_mesh_of_many_shapes_is_read_once() {
        let folder = tempfile::tempdir().unwrap();
        let urdf = folder.path().join("chain.urdf");
        fs::write(&urdf, "<robot/>").unwrap();
        fs::write(folder.path().join("link.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let folders = Folders::of(urdf.to_str().unwrap()).unwrap();
        let mut reading = Reading::default();
        let mut solid =
            |file: &str, scale| reading.solid(Form::Mesh { file: file.to_owned(), scale: [scale; 3] }, Some(&folders));
        assert_eq!((solid("link.obj", 1.0), solid("link.obj", 2.0)), (Ok(0), Ok(1)));
        // The file changes, and what was read of it does not.
        fs::write(folder.path().join("link.obj"), "v 0 0 0\nv 1 0 0\nv 0 7 0\nf 1 2 3\n").unwrap();
        assert_eq!((solid("./link.obj", 1.0), solid("link.obj", 2.0)), (Ok(0), Ok(1)));
        // Nor is a broken one read again and again.
        fs::write(folder.path().join("broken.obj"), "f 1 2 3\n").unwrap();
        let refused = solid("broken.obj", 1.0);
        fs::write(folder.path().join("broken.obj"), "v 0 0 0\nv 1 0 0\nv 0 7 0\nf 1 2 3\n").unwrap();
        assert!(refused.is_err() && solid("broken.obj", 1.0) == refused, "{refused:?}");
    }
}
