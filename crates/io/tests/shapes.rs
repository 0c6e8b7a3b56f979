//! Shapes of the links that a robot description names.

use std::fs;

use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Inputs, read_scenario};
use forwardstep_io::shapes::Shapes;

const ARM: &str = r#"<robot name="arm">
  <link name="base"><visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
  <link name="upper"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <visual><origin xyz="0 0 0.2"/><geometry><mesh filename="meshes/link.obj" scale="2 2 2"/></geometry></visual>
    <visual><geometry><mesh filename="meshes/gone.stl"/></geometry></visual>
    <visual><geometry><mesh filename="meshes/link.obj" scale="1e300 1 1"/></geometry></visual>
    <visual><geometry><sphere radius="0"/></geometry></visual></link>
  <link name="tool"><visual><origin xyz="0 0 0.1"/><geometry><sphere radius="0.05"/></geometry></visual></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
  <joint name="fixed" type="fixed"><parent link="upper"/><child link="tool"/><origin xyz="0 0 0.5"/></joint>
</robot>"#;
const TWO: &str = r#"format = 2
time.end_s = 1
[[agents]]
name = "arm"
count = 2
robot.urdf.file = "arm.urdf"
[reference.consensus]
roots_per_s = [1]
exchange = "position_velocity"
[network]
edges.ring = {}
"#;

#[test]
fn shapes_stand_on_the_bodies_that_carry_their_links_and_each_is_kept_once() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("meshes")).unwrap();
    fs::write(folder.path().join("arm.urdf"), ARM).unwrap();
    fs::write(folder.path().join("meshes/link.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let source = SourceText::new("two.toml", TWO);
    let scenario = read_scenario("two", &source, Inputs::from(Some(folder.path()))).unwrap();
    let (shapes, left_out) = Shapes::read(&scenario.models);
    assert_eq!((shapes.agents.as_slice(), shapes.robots.len(), shapes.solids.len()), (&[Some(0), Some(0)][..], 1, 3));
    let [base, upper, tool] = shapes.of(1) else { panic!("{shapes:?}") };
    assert_eq!((base.body, upper.body, tool.body), (None, Some(0), Some(0)));
    assert_eq!((upper.place.1, tool.place.1), ([0.0, 0.0, 0.2], [0.0, 0.0, 0.6]));
    assert_eq!(shapes.solids[upper.solid].step[0], 2.0 / 65535.0);
    assert!(
        left_out.len() == 3 && left_out[0].ends_with("the mesh `meshes/gone.stl`: there is no such file"),
        "{left_out:?}"
    );
    assert!(left_out[1..].iter().all(|why| why.ends_with("a shape without an area")), "{left_out:?}");
    assert!(shapes.is_sound() && shapes.of(2).is_empty());
    let text = serde_json::to_string(&shapes).unwrap();
    assert_eq!(serde_json::from_str::<Shapes>(&text).unwrap(), shapes);
    let broken = Shapes { agents: vec![Some(1)], ..shapes };
    assert!(!broken.is_sound());
}

#[test]
fn shipped_robots_say_that_they_have_none() {
    let source = SourceText::new("two.toml", TWO.replace("arm.urdf", "ur5e.urdf"));
    let scenario = read_scenario("two", &source, None).unwrap();
    let (shapes, left_out) = Shapes::read(&scenario.models);
    assert!(shapes.of(0).is_empty());
    assert_eq!(left_out, ["ur5e.urdf: it says nothing of shapes"]);
}
