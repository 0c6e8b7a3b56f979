//! Triangles of a COLLADA file: the geometries of its scene, where its nodes put them, in metres.
//!
//! Read are `triangles`, `polylist` and `polygons`, cut into fans. Which axis the file calls upright is not looked at, as in other viewers of
//! URDFs: a mesh stands in the frame of its link as its numbers say.

use std::collections::HashMap;

use forwardstep_core::robot::tree::Placement;
use roxmltree::{Document, Node, NodeId, ParsingOptions};

use super::triangles::{MOST_TRIANGLES, Triangles};

const MOST_NODES: u32 = 1 << 21;
/// Nodes inside each other.
const DEEPEST: usize = 64;
/// Parts may be used again and again, by nodes that name others: all that is read is so many times as long as the file at most,
const MOST_TIMES: usize = 8;
/// or so many bytes, where the file is small. Without a bound a few lines would be read for years.
const MOST_ANEW: usize = 16 << 20;

/// A linear map and a translation, row by row.
type Map = [[f64; 4]; 3];
const SAME: Map = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// What it shows; colours, lights and what moves are left out.
pub(super) fn triangles(bytes: &[u8]) -> Result<Triangles, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not UTF-8")?;
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document =
        Document::parse_with_options(text, options).map_err(|error| format!("it cannot be read: {error}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err("it is no COLLADA file".to_owned());
    }
    let ids = root.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
    let left = bytes.len().saturating_mul(MOST_TIMES).max(MOST_ANEW);
    let mut file = File { ids, left, known: HashMap::new(), all: Triangles::default() };
    let metre = named(root, "asset").and_then(|asset| named(asset, "unit")?.attribute("meter")?.trim().parse().ok());
    let metre: f64 = metre.filter(|metre: &f64| metre.is_finite() && *metre > 0.0).unwrap_or(1.0);
    let unit = SAME.map(|row| row.map(|x| metre * x));
    let scene = named(root, "scene").and_then(|scene| named(scene, "instance_visual_scene"));
    match scene.and_then(|instance| file.target(instance.attribute("url")?)) {
        Some(scene) => file.node(scene, &unit, 0)?,
        None => {
            for geometry in root.descendants().filter(|node| node.has_tag_name("geometry")) {
                file.geometry(geometry, &unit)?;
            }
        }
    }
    Ok(file.all)
}

/// A file while it is read.
struct File<'a, 'i> {
    ids: HashMap<&'a str, Node<'a, 'i>>,
    /// Bytes of elements that may still be looked at.
    left: usize,
    /// Geometries that were read.
    known: HashMap<NodeId, Triangles>,
    all: Triangles,
}

impl<'a, 'i> File<'a, 'i> {
    fn target(&self, url: &str) -> Option<Node<'a, 'i>> {
        self.ids.get(url.strip_prefix('#')?).copied()
    }

    /// Counts an element that is about to be read.
    fn look(&mut self, at: Node<'a, 'i>) -> Result<(), String> {
        self.left = self.left.checked_sub(at.range().len()).ok_or("it uses its own parts too many times")?;
        Ok(())
    }

    fn node(&mut self, node: Node<'a, 'i>, before: &Map, depth: usize) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("its nodes are nested too deeply".to_owned());
        }
        self.look(node)?;
        let mut here = *before;
        for child in node.children() {
            let own = match child.tag_name().name() {
                "matrix" => list(child)
                    .and_then(|m| <[f64; 16]>::try_from(m).ok())
                    .map(|m| [0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| m[4 * row + column]))),
                "translate" => {
                    triple(child).map(|[x, y, z]| [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]])
                }
                "scale" => triple(child).map(|[x, y, z]| [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]]),
                "rotate" => list(child).and_then(|r| <[f64; 4]>::try_from(r).ok()).map(turn),
                _ => continue,
            };
            here = product(&here, &own.ok_or("a node is moved by what are no numbers")?);
        }
        for child in node.children() {
            let to = child.attribute("url").and_then(|url| self.target(url));
            match (child.tag_name().name(), to) {
                ("node", _) => self.node(child, &here, depth + 1)?,
                ("instance_node", Some(other)) => self.node(other, &here, depth + 1)?,
                ("instance_geometry", Some(geometry)) => self.geometry(geometry, &here)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Adds a geometry where it stands.
    fn geometry(&mut self, geometry: Node<'a, 'i>, place: &Map) -> Result<(), String> {
        if !self.known.contains_key(&geometry.id()) {
            let read = self.mesh(geometry)?;
            self.known.insert(geometry.id(), read);
        }
        let Some(own) = self.known.get(&geometry.id()) else { return Ok(()) };
        let first = u32::try_from(self.all.points.len()).map_err(|_| "it has too many points")?;
        let moved = |p: &[f64; 3]| {
            [0, 1, 2].map(|k| place[k][0] * p[0] + place[k][1] * p[1] + place[k][2] * p[2] + place[k][3])
        };
        self.all.points.extend(own.points.iter().map(moved));
        self.all.faces.extend(own.faces.iter().map(|face| face.map(|k| k.saturating_add(first))));
        if self.all.faces.len().max(self.all.points.len() / 3) > MOST_TRIANGLES {
            return Err("it has too many triangles".to_owned());
        }
        Ok(())
    }

    fn mesh(&mut self, geometry: Node<'a, 'i>) -> Result<Triangles, String> {
        self.look(geometry)?;
        let mut found = Triangles::default();
        // Where the points of each `vertices` begin: its parts share them.
        let mut begins: HashMap<NodeId, u32> = HashMap::new();
        let Some(mesh) = named(geometry, "mesh") else { return Ok(found) };
        for part in mesh.children() {
            let polygons = match part.tag_name().name() {
                name @ ("triangles" | "polylist" | "polygons") => name,
                _ => continue,
            };
            let inputs = || part.children().filter(|node| node.has_tag_name("input"));
            let offset =
                |input: &Node<'_, '_>| input.attribute("offset").and_then(|k| k.parse::<usize>().ok()).unwrap_or(0);
            let stride = inputs().map(|input| offset(&input)).max().unwrap_or(0).saturating_add(1);
            let vertex = inputs().find(|input| input.attribute("semantic") == Some("VERTEX"));
            let vertex = vertex.ok_or("its polygons have no vertices")?;
            let vertices = vertex.attribute("source").and_then(|url| self.target(url));
            let vertices = vertices.ok_or("its vertices are not there")?;
            let first = match begins.get(&vertices.id()) {
                Some(first) => *first,
                None => {
                    let first = u32::try_from(found.points.len()).map_err(|_| "it has too many points")?;
                    found.points.extend(self.positions(vertices)?);
                    begins.insert(vertices.id(), first);
                    first
                }
            };
            let mut polygon = |corners: &[u32]| {
                for pair in corners.get(1..).unwrap_or_default().windows(2) {
                    found.faces.push([corners[0], pair[0], pair[1]].map(|k| k.saturating_add(first)));
                }
            };
            // All polygons of a list stand in one row, beside how many corners each has.
            let most_rows = if polygons == "polylist" { 1 } else { usize::MAX };
            let rows = part.children().filter(|node| node.has_tag_name("p")).take(most_rows);
            for row in rows {
                let numbers: Option<Vec<u32>> =
                    row.text().unwrap_or_default().split_ascii_whitespace().map(|word| word.parse().ok()).collect();
                let numbers = numbers.ok_or("a corner is no number")?;
                let corners: Vec<u32> = numbers.iter().skip(offset(&vertex)).step_by(stride).copied().collect();
                match polygons {
                    "triangles" => corners.chunks_exact(3).for_each(&mut polygon),
                    "polygons" => polygon(&corners),
                    _ => {
                        let counts = named(part, "vcount").and_then(|node| node.text()).unwrap_or_default();
                        let mut rest = &corners[..];
                        for count in counts.split_ascii_whitespace() {
                            let count = count.parse().ok().filter(|count| *count <= rest.len());
                            let (own, others) =
                                rest.split_at(count.ok_or("its polygons have more corners than there are")?);
                            polygon(own);
                            rest = others;
                        }
                    }
                }
            }
        }
        Ok(found)
    }

    /// The positions that `vertices` name.
    fn positions(&mut self, vertices: Node<'a, 'i>) -> Result<Vec<[f64; 3]>, String> {
        self.look(vertices)?;
        let mut inputs = vertices.children().filter(|node| node.has_tag_name("input"));
        let position = inputs.find(|input| input.attribute("semantic") == Some("POSITION"));
        // Some files name the positions without a `vertices` between.
        let source = match position {
            Some(input) => input.attribute("source").and_then(|url| self.target(url)),
            None => Some(vertices),
        };
        let source = source.ok_or("its positions are not there")?;
        self.look(source)?;
        let values = named(source, "float_array").and_then(list).ok_or("its positions are no numbers")?;
        let accessor = named(source, "technique_common").and_then(|node| named(node, "accessor"));
        let number = |name: &str| accessor.and_then(|accessor| accessor.attribute(name)?.parse::<usize>().ok());
        let (stride, offset) = (number("stride").unwrap_or(3).max(3), number("offset").unwrap_or(0));
        let rows = values.get(offset..).unwrap_or_default().chunks(stride);
        Ok(rows.filter(|row| row.len() >= 3).map(|row| [row[0], row[1], row[2]]).collect())
    }
}

fn named<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// The numbers in an element.
fn list(node: Node<'_, '_>) -> Option<Vec<f64>> {
    node.text().unwrap_or_default().split_ascii_whitespace().map(|word| word.parse().ok()).collect()
}

fn triple(node: Node<'_, '_>) -> Option<[f64; 3]> {
    list(node)?.try_into().ok()
}

/// About an axis, by degrees.
fn turn([x, y, z, degrees]: [f64; 4]) -> Map {
    let length = (x * x + y * y + z * z).sqrt();
    if length == 0.0 {
        return SAME;
    }
    let axis = [x / length, y / length, z / length];
    let Placement { rotation, .. } =
        Placement::of_joint(forwardstep_core::robot::tree::JointKind::Revolute, axis, degrees.to_radians());
    rotation.map(|[a, b, c]| [a, b, c, 0.0])
}

fn product(a: &Map, b: &Map) -> Map {
    a.map(|[x, y, z, at]| [0, 1, 2, 3].map(|k| x * b[0][k] + y * b[1][k] + z * b[2][k] + if k == 3 { at } else { 0.0 }))
}

#[cfg(test)]
pub(super) mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    pub(crate) const DAE: &str = r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="centimetre" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries>
    <geometry id="square"><mesh>
      <source id="places"><float_array id="numbers" count="12">0 0 0 100 0 0 100 100 0 0 100 0</float_array>
        <technique_common><accessor source="#numbers" count="4" stride="3"/></technique_common></source>
      <vertices id="corners"><input semantic="POSITION" source="#places"/></vertices>
      <polylist count="1"><input semantic="VERTEX" source="#corners" offset="1"/><input semantic="NORMAL" source="#places" offset="0"/>
        <vcount>4</vcount><p>9 0 9 1 9 2 9 3</p></polylist>
      <triangles count="1"><input semantic="VERTEX" source="#corners" offset="0"/><p>0 1 2</p></triangles>
      <polygons count="1"><input semantic="VERTEX" source="#corners" offset="0"/><p>0 1 2 3</p></polygons>
    </mesh></geometry>
  </library_geometries>
  <library_nodes><node id="kept"><instance_geometry url="#square"/></node></library_nodes>
  <library_visual_scenes><visual_scene id="all">
    <node><translate>0 0 200</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale><instance_geometry url="#square"/>
      <node><matrix>1 0 0 0 0 1 0 0 0 0 1 -200 0 0 0 1</matrix><instance_node url="#kept"/></node></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#all"/></scene>
</COLLADA>"##;

    fn near(a: [f64; 3], b: [f64; 3]) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
    }

    #[test]
    fn a_scene_stands_where_its_nodes_put_it_in_metres() {
        let read = triangles(DAE.as_bytes()).unwrap();
        assert_eq!((read.points.len(), read.faces.len()), (8, 10));
        assert_eq!(read.faces[..3], [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        // (100, 100, 0) cm: twice as wide, turned by a quarter, lifted by 2 m; the inner node takes the lift back.
        near(read.points[2], [-1.0, 2.0, 2.0]);
        near(read.points[6], [-1.0, 2.0, 0.0]);
    }

    #[test]
    fn without_a_scene_all_geometries_are_shown() {
        let read = triangles(DAE.replace("<instance_visual_scene url=\"#all\"/>", "").as_bytes()).unwrap();
        assert_eq!(read.faces.len(), 5);
        near(read.points[1], [1.0, 0.0, 0.0]);
    }

    /// A chain of nodes, each of which holds the next one twice: 2⁴⁰ nodes in four kilobytes, and none has a shape.
    #[test]
    fn regress_a_few_nodes_that_stand_for_very_many_are_refused() {
        let chain: String = (0..40)
            .map(|k| {
                let next = format!("<instance_node url=\"#n{}\"/>", k + 1);
                format!("<node id=\"n{k}\">{next}{next}</node>")
            })
            .collect();
        let scene = "<node id=\"n40\"/></library_nodes><library_visual_scenes><visual_scene id=\"all\"><instance_node url=\"#n0\"/>";
        let text = format!(
            "<COLLADA><library_nodes>{chain}{scene}</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#all\"/></scene></COLLADA>"
        );
        assert_eq!(triangles(text.as_bytes()), Err("it uses its own parts too many times".into()));
    }

    /// Thousands of parts with the same points, which were read for each of them: 20 GB of points in two megabytes.
    #[test]
    fn regress_points_that_parts_share_are_read_once() {
        let many = "0 0 0 1 0 0 1 1 0 ".repeat(40_000);
        let parts = "<triangles><input semantic=\"VERTEX\" source=\"#places\"/><p>0 1 2</p></triangles>".repeat(9000);
        let mesh = |parts: &str| {
            format!(
                "<geometry><mesh><source id=\"places\"><float_array>{many}</float_array></source>{parts}</mesh></geometry>"
            )
        };
        let read = triangles(format!("<COLLADA>{}</COLLADA>", mesh(&parts)).as_bytes()).unwrap();
        assert_eq!((read.points.len(), read.faces.len()), (120_000, 9000));
        // Geometries may share them too, but not as many as would never end.
        let others =
            "<geometry><mesh><triangles><input semantic=\"VERTEX\" source=\"#places\"/></triangles></mesh></geometry>"
                .repeat(9000);
        let text = format!("<COLLADA>{}{others}</COLLADA>", mesh(""));
        assert_eq!(triangles(text.as_bytes()), Err("it uses its own parts too many times".into()));
    }

    #[test]
    fn what_is_broken_or_endless_is_refused() {
        let refused = |from: &str, to: &str| {
            let text = DAE.replace(from, to);
            assert!(text != DAE, "{from}");
            triangles(text.as_bytes())
                .and_then(|read| if read.faces.is_empty() { Err("empty".into()) } else { Ok(read) })
                .unwrap_err()
        };
        assert!(refused("<vcount>4<", "<vcount>5<").contains("more corners"));
        assert!(
            refused(
                "<instance_geometry url=\"#square\"/></node></library_nodes>",
                "<instance_node url=\"#kept\"/></node></library_nodes>"
            )
            .contains("deeply")
        );
        assert!(refused("<translate>0 0 200<", "<translate>0 0 x<").contains("no numbers"));
        assert!(refused("<p>0 1 2</p>", "<p>0 1 -2</p>").contains("no number"));
        assert!(refused("\"#corners\"", "\"#absent\"").contains("not there"));
        assert!(
            refused("<float_array id=\"numbers\" count=\"12\">0 0", "<float_array id=\"numbers\" count=\"12\">0 a")
                .contains("no numbers")
        );
        // A document type may define what grows without end.
        assert!(refused("<COLLADA xmlns", "<!DOCTYPE a [<!ENTITY b \"c\">]><COLLADA xmlns").contains("cannot be read"));
    }
}
