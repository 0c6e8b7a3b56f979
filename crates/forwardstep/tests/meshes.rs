//! `forwardstep run --meshes`: robots as their URDFs describe them, on the page of a run.

use std::fs;

use crate::support::{folder, forwardstep, names, stderr};
use forwardstep::io::shapes::Shapes;
use tempfile::TempDir;

const URDF: &str = r#"<robot name="arm">
  <link name="base"><visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
  <link name="upper"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <visual><geometry><mesh filename="link.obj"/></geometry></visual>
    <visual><geometry><mesh filename="../outside.obj"/></geometry></visual>
    <visual><geometry><mesh filename="&lt;img src=x&gt;.stl"/></geometry></visual></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
</robot>"#;
const SCENARIO: &str = r#"format = 2
title = "Two arms"
time = { end_s = 1, record_every_s = 0.1 }
[[agents]]
name = "arm"
count = 2
robot.urdf.file = "arm.urdf"
[reference.consensus]
roots_per_s = [1]
exchange = "position_velocity"
[law.known]
[network]
edges.ring = {}
"#;

/// Two arms in a folder beside which lies what must not be read.
fn arms() -> TempDir {
    let folder = folder();
    let inner = folder.path().join("arms");
    fs::create_dir(&inner).unwrap();
    fs::write(inner.join("arm.urdf"), URDF).unwrap();
    fs::write(inner.join("two.toml"), SCENARIO).unwrap();
    fs::write(inner.join("link.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    fs::write(folder.path().join("outside.obj"), "v 0 0 0\nv 7 0 0\nv 0 7 0\nf 1 2 3\n").unwrap();
    folder
}

#[test]
fn shapes_of_a_urdf_are_on_the_page_and_nothing_from_outside() {
    let folder = arms();
    let said = stderr(&forwardstep(&folder, &["run", "arms/two.toml", "--out", "shaped", "--meshes"]).success());
    assert!(said.contains("the mesh `../outside.obj`: it lies outside of the URDF's folder and package"), "{said}");
    assert!(said.contains("there is no such file") && said.matches("Not drawn: ").count() == 2, "{said}");
    let text = fs::read_to_string(folder.path().join("shaped/shapes.json")).unwrap();
    let shapes: Shapes = serde_json::from_str(&text).unwrap();
    assert_eq!((shapes.solids.len(), shapes.robots.len(), shapes.agents.len()), (2, 1, 2));
    let page = fs::read_to_string(folder.path().join("shaped/report.html")).unwrap();
    assert!(shapes.solids.iter().all(|solid| page.contains(&solid.points) && page.contains(&solid.faces)));
    assert!(!page.contains("<img src=x"));

    forwardstep(&folder, &["run", "arms/two.toml", "--out", "plain"]).success();
    assert!(!names(&folder.path().join("plain")).contains(&"shapes.json".to_owned()));
    let plain = fs::read_to_string(folder.path().join("plain/report.html")).unwrap();
    assert!(!plain.contains(&shapes.solids[0].points));
}

/// The files that the shapes are from may be gone.
#[test]
fn a_report_that_is_built_anew_keeps_its_shapes() {
    let folder = arms();
    forwardstep(&folder, &["run", "arms/two.toml", "--out", "shaped", "--meshes"]).success();
    let page = || fs::read_to_string(folder.path().join("shaped/report.html")).unwrap();
    let before = page();
    fs::remove_dir_all(folder.path().join("arms")).unwrap();
    forwardstep(&folder, &["report", "shaped"]).success();
    assert!(page() == before);

    for damaged in ["{", "{\"solids\":[],\"robots\":[],\"agents\":[0]}"] {
        fs::write(folder.path().join("shaped/shapes.json"), damaged).unwrap();
        let said = stderr(&forwardstep(&folder, &["report", "shaped"]).success());
        assert!(said.contains("shapes.json") && said.contains("capsules"), "{said}");
        assert!(page().contains("\"solids\":[]"));
    }
}

#[test]
fn without_shapes_the_run_says_so_and_goes_on() {
    let folder = folder();
    let said = stderr(&forwardstep(&folder, &["run", "task-space-ur5e", "--meshes", "--out", "run"]).success());
    assert!(said.contains("Not drawn: ur5e.urdf: it says nothing of shapes"), "{said}");
}
