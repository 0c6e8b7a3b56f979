//! The `<visual>` elements of a URDF. They do not enter the model: one without a meaning is left out with a word why, and no run fails for it.

use forwardstep_core::robot::tree::Placement;
use roxmltree::{Document, Node, ParsingOptions};

/// XML nodes accepted, as of the model.
const MOST_NODES: u32 = 1 << 21;

/// What a link looks like, or a part of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Visual {
    pub(super) link: String,
    /// Its frame in that of the link.
    pub(super) place: Placement,
    pub(super) form: Form,
}

/// Its geometry; lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Form {
    /// A file by the name that the URDF gives it, and what its coordinates are multiplied by.
    Mesh {
        file: String,
        scale: [f64; 3],
    },
    /// The lengths of the edges.
    Box([f64; 3]),
    /// Along z.
    Cylinder {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
}

/// All of a file, and why some are none.
pub(super) fn visuals(text: &str) -> (Vec<Visual>, Vec<String>) {
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let Ok(document) = Document::parse_with_options(text, options) else { return (Vec::new(), Vec::new()) };
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    for link in document.root_element().children().filter(|node| node.has_tag_name("link")) {
        let name = link.attribute("name").unwrap_or_default();
        for node in link.children().filter(|node| node.has_tag_name("visual")) {
            match visual(name, node) {
                Ok(visual) => found.push(visual),
                Err(why) => left_out.push(format!("a shape of `{name}`: {why}")),
            }
        }
    }
    (found, left_out)
}

fn visual(link: &str, node: Node<'_, '_>) -> Result<Visual, String> {
    let place = match child(node, "origin") {
        Some(origin) => Placement::from_xyz_rpy(
            numbers(origin, "xyz")?.unwrap_or_default(),
            numbers(origin, "rpy")?.unwrap_or_default(),
        ),
        None => Placement::IDENTITY,
    };
    let geometry = child(node, "geometry").ok_or("it has no `geometry`")?;
    let form = geometry.children().find(Node::is_element).ok_or("its `geometry` is empty")?;
    let form = match form.tag_name().name() {
        "mesh" => Form::Mesh {
            file: form.attribute("filename").ok_or("its `mesh` names no file")?.to_owned(),
            scale: numbers(form, "scale")?.unwrap_or([1.0; 3]),
        },
        "box" => Form::Box(numbers(form, "size")?.ok_or("its `box` has no `size`")?),
        "cylinder" => Form::Cylinder { radius: length(form, "radius")?, length: length(form, "length")? },
        "sphere" => Form::Sphere { radius: length(form, "radius")? },
        other => return Err(format!("`{other}` is not drawn")),
    };
    Ok(Visual { link: link.to_owned(), place, form })
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn length(node: Node<'_, '_>, name: &str) -> Result<f64, String> {
    let [length] = numbers(node, name)?.ok_or_else(|| format!("it has no `{name}`"))?;
    Ok(length)
}

/// So many finite numbers, if the attribute is there.
fn numbers<const N: usize>(node: Node<'_, '_>, name: &str) -> Result<Option<[f64; N]>, String> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let read: Option<Vec<f64>> =
        text.split_whitespace().map(|word| word.parse().ok().filter(|x: &f64| x.is_finite())).collect();
    let found = read.and_then(|read| read.try_into().ok());
    found.map(Some).ok_or_else(|| format!("`{name}` is not {N} finite number{}", if N == 1 { "" } else { "s" }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_read_and_what_has_no_meaning_is_named() {
        let text = r#"<robot name="r">
  <link name="a">
    <visual><origin xyz="0 0 1" rpy="0 0 0"/><geometry><box size="1 2 3"/></geometry></visual>
    <visual><geometry><mesh filename="package://r/a.stl" scale="0.001 0.001 0.001"/></geometry></visual>
    <visual><geometry><cylinder radius="1"/></geometry></visual>
    <visual><geometry><sphere radius="inf"/></geometry></visual>
    <visual><geometry><capsule radius="1"/></geometry></visual>
    <visual><geometry/></visual>
    <visual/>
    <collision><geometry><sphere radius="9"/></geometry></collision>
  </link>
  <link name="b"><visual><origin xyz="0 0"/><geometry><sphere radius="0.5"/></geometry></visual></link>
</robot>"#;
        let (found, left_out) = visuals(text);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].form.clone(), found[0].place.translation), (Form::Box([1.0, 2.0, 3.0]), [0.0, 0.0, 1.0]));
        assert_eq!(found[1].form, Form::Mesh { file: "package://r/a.stl".into(), scale: [0.001; 3] });
        assert_eq!(
            left_out,
            [
                "a shape of `a`: it has no `length`",
                "a shape of `a`: `radius` is not 1 finite number",
                "a shape of `a`: `capsule` is not drawn",
                "a shape of `a`: its `geometry` is empty",
                "a shape of `a`: it has no `geometry`",
                "a shape of `b`: `xyz` is not 3 finite numbers",
            ]
        );
        assert_eq!(visuals("<robot"), (Vec::new(), Vec::new()));
    }
}
