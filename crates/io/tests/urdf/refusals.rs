//! Every refusal, with its place and its help.

use forwardstep_io::{InputError, SourceText, UrdfOptions, read_urdf};

use super::{ARM, BASE, LIMIT, inertial, joint, locked, read_with, robot};

fn refusals() -> Vec<(String, UrdfOptions, &'static str)> {
    let default = UrdfOptions::default;
    let turning = joint("revolute", &format!(r#"<axis xyz="0 0 1"/>{LIMIT}"#));
    let z = r#"<axis xyz="0 0 1"/>"#;
    let with_joint = |kind: &str, inside: &str| robot(&[BASE, ARM, &joint(kind, inside)]);
    let with_arm = |inertial: &str| robot(&[BASE, &format!(r#"<link name="arm">{inertial}</link>"#), &turning]);
    vec![
        // XML
        ("".to_owned(), default(), "r.urdf:1:1: not well-formed XML: the document does not have a root node"),
        (
            "<robot name='r'>\n  <link name='a'>\n</robot>".to_owned(),
            default(),
            "r.urdf:3:1: not well-formed XML: expected 'link' tag, not 'robot'",
        ),
        (
            "<robot name='r'>\n  <link name='a'".to_owned(),
            default(),
            "r.urdf:2:17: not well-formed XML: the root node was opened but never closed",
        ),
        (
            "<robot name='r'>\n  <link name='a' name='b'/>\n</robot>".to_owned(),
            default(),
            "r.urdf:2:18: not well-formed XML: attribute 'name' is already defined",
        ),
        (
            "<!DOCTYPE lolz [<!ENTITY lol \"lol\">]>\n<robot name='r'/>".to_owned(),
            default(),
            "r.urdf:1:1: a document type declaration (<!DOCTYPE …>) is not accepted\n  help: delete it; a robot needs no entities",
        ),
        (
            "<sdf version='1.7'/>".to_owned(),
            default(),
            "r.urdf:1:1: the outermost element is <sdf>, not <robot>\n  help: only URDF is read; convert SDF, MJCF or COLLADA to URDF first",
        ),
        (
            "<robot xmlns:xacro='http://www.ros.org/wiki/xacro' name='r'>\n  <xacro:include filename='a'/>\n</robot>"
                .to_owned(),
            default(),
            "r.urdf:2:3: `<xacro:include>` is xacro, not URDF\n  help: expand with xacro first: `xacro robot.urdf.xacro > robot.urdf`",
        ),
        (
            "<robot name='r'>\n  <xacro:include filename='a'/>\n</robot>".to_owned(),
            default(),
            "r.urdf:2:4: `xacro:include` is xacro, not URDF\n  help: expand with xacro first: `xacro robot.urdf.xacro > robot.urdf`",
        ),
        (
            with_joint("revolute", r#"<origin xyz="0 0 ${length}"/>"#),
            default(),
            "r.urdf:4:89: `0 0 ${length}` is xacro, not URDF\n  help: expand with xacro first: `xacro robot.urdf.xacro > robot.urdf`",
        ),
        // attributes and elements
        ("<robot/>".to_owned(), default(), "r.urdf:1:1: `name` of <robot> is missing"),
        (robot(&["<link/>"]), default(), "r.urdf:2:1: `name` of <link> is missing"),
        (robot(&[r#"<link name=" "/>"#]), default(), "r.urdf:2:13: `name` of <link> is empty"),
        (
            robot(&[r#"<link name="a&#10;b"/>"#]),
            default(),
            "r.urdf:2:13: `name` of <link> is \"a\\nb\", which does not fit into a line\n  help: names are one line of at most 200 bytes without control characters",
        ),
        (
            robot(&["<link name='a' b\u{8}='c'/>"]),
            default(),
            "r.urdf:2:17: not well-formed XML: expected '=' not '\\u{8}'",
        ),
        (robot(&[BASE, ARM, r#"<joint name="turn"/>"#]), default(), "r.urdf:4:1: `type` of joint `turn` is missing"),
        (
            robot(&[BASE, ARM, r#"<joint name="turn" type="fixed"><child link="arm"/></joint>"#]),
            default(),
            "r.urdf:4:1: joint `turn` has no <parent>",
        ),
        (
            robot(&[BASE, ARM, r#"<joint name="turn" type="fixed"><parent/><child link="arm"/></joint>"#]),
            default(),
            "r.urdf:4:33: `link` of <parent> of joint `turn` is missing",
        ),
        (with_arm("<inertial/>"), default(), "r.urdf:3:18: <inertial> of link `arm` has no <mass>"),
        (
            with_arm(r#"<inertial><mass value="1"/></inertial>"#),
            default(),
            "r.urdf:3:18: <inertial> of link `arm` has no <inertia>\n  help: a mass needs its rotational inertia about the centre of mass; for a point mass write zeros",
        ),
        (
            with_arm(r#"<inertial><mass/></inertial>"#),
            default(),
            "r.urdf:3:28: `value` of <mass> of link `arm` is missing",
        ),
        (
            with_arm(r#"<inertial><mass value="1"/><inertia ixx="1"/></inertial>"#),
            default(),
            "r.urdf:3:45: `ixy` of <inertia> of link `arm` is missing",
        ),
        (
            with_arm(r#"<inertial><mass value="1"/><mass value="2"/></inertial>"#),
            default(),
            "r.urdf:3:45: link `arm` has a second <mass>; the first is on line 3",
        ),
        (
            with_joint("revolute", &format!("{z}\n{z}")),
            default(),
            "r.urdf:5:1: joint `turn` has a second <axis>; the first is on line 4",
        ),
        // numbers
        (
            with_arm(r#"<inertial><mass value="one"/></inertial>"#),
            default(),
            "r.urdf:3:41: `value` of <mass> of link `arm` is `one`, which is not a number",
        ),
        (
            with_arm(r#"<inertial><mass value=""/></inertial>"#),
            default(),
            "r.urdf:3:41: `value` of <mass> of link `arm` is empty",
        ),
        (
            with_arm(r#"<inertial><mass value="1 2"/></inertial>"#),
            default(),
            "r.urdf:3:41: `value` of <mass> of link `arm` has 2 numbers where 1 are needed",
        ),
        (
            with_arm(r#"<inertial><mass value="nan"/></inertial>"#),
            default(),
            "r.urdf:3:41: `value` of <mass> of link `arm` is `nan`, which is not finite",
        ),
        (
            with_arm(r#"<inertial><mass value="-1.5"/></inertial>"#),
            default(),
            "r.urdf:3:41: `value` of <mass> of link `arm` is -1.5, but must not be negative",
        ),
        (
            with_joint("revolute", r#"<origin xyz="0 0,1 0"/>"#),
            default(),
            "r.urdf:4:91: `xyz` of <origin> of joint `turn` is `0,1`, which is not a number",
        ),
        (
            with_joint("revolute", r#"<origin xyz="0 0"/>"#),
            default(),
            "r.urdf:4:89: `xyz` of <origin> of joint `turn` has 2 numbers where 3 are needed",
        ),
        (
            with_joint("revolute", r#"<origin rpy="0 0 1e999"/>"#),
            default(),
            "r.urdf:4:93: `rpy` of <origin> of joint `turn` is `1e999`, which is not finite",
        ),
        (
            with_joint("revolute", r#"<origin quat_xyzw="0 0 0 1"/>"#),
            default(),
            "r.urdf:4:95: <origin> of joint `turn` states its rotation as `quat_xyzw`\n  help: state it as `rpy`, roll, pitch and yaw in rad",
        ),
        (with_joint("revolute", r#"<axis xyz="0 0 0"/>"#), default(), "r.urdf:4:87: the axis of joint `turn` is zero"),
        (
            with_joint("revolute", r#"<limit lower="2" upper="-2" effort="1" velocity="1"/>"#),
            default(),
            "r.urdf:4:76: joint `turn` has its lower limit 2 above its upper limit -2",
        ),
        (
            with_joint("revolute", r#"<limit lower="-2" upper="2" effort="inf" velocity="1"/>"#),
            default(),
            "r.urdf:4:112: `effort` of <limit> of joint `turn` is `inf`, which is not finite\n  help: leave `effort` out when there is no limit",
        ),
        (
            with_joint("revolute", r#"<limit lower="-2" upper="2" effort="-1" velocity="1"/>"#),
            default(),
            "r.urdf:4:112: `effort` of <limit> of joint `turn` is -1, but must not be negative",
        ),
        (
            with_joint("revolute", r#"<dynamics damping="-0.1"/>"#),
            default(),
            "r.urdf:4:95: `damping` of <dynamics> of joint `turn` is -0.1, but must not be negative",
        ),
        (
            with_joint("revolute", r#"<dynamics damping="0.1" friction="0.2"/>"#),
            default(),
            r#"r.urdf:4:110: joint `turn` has Coulomb friction 0.2, and nothing says how to model it
  help: in the scenario set `friction.dry = {}` or `friction.smooth = {}` to have it in robot and law, or `friction = "ignore"` to leave it out"#,
        ),
        (
            with_arm(
                r#"<inertial><origin xyz="1e200 0 0"/><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"#,
            ),
            default(),
            "r.urdf:3:18: the inertia of link `arm` exceeds the range of double precision",
        ),
        // the tree
        (
            robot(&[]),
            default(),
            "r.urdf: the robot has no links\n  help: a robot is a tree of links, the outermost elements <link name=\"…\">, that joints hold together",
        ),
        (
            robot(&[BASE]),
            default(),
            "r.urdf: no joint moves (fixed: 0, locked: 0)\n  help: give a joint the type `revolute`, `continuous` or `prismatic`; what never moves has nothing to control",
        ),
        (
            robot(&[BASE, ARM, &joint("fixed", "")]),
            default(),
            "r.urdf: no joint moves (fixed: 1, locked: 0)\n  help: give a joint the type `revolute`, `continuous` or `prismatic`; what never moves has nothing to control",
        ),
        (
            robot(&[BASE, ARM, ARM, &turning]),
            default(),
            "r.urdf:4:13: a second link is named `arm`; the first is on line 3",
        ),
        (
            robot(&[BASE, ARM, r#"<link name="tool"/>"#, &turning, &turning.replace("\"arm\"", "\"tool\"")]),
            default(),
            "r.urdf:6:14: a second joint is named `turn`; the first is on line 5",
        ),
        (
            robot(&[BASE, ARM, &turning.replace("\"arm\"", "\"amr\"")]),
            default(),
            "r.urdf:4:70: joint `turn` names the child link `amr`, which does not exist\n  help: did you mean `arm`?",
        ),
        (
            robot(&[BASE, ARM, &turning.replace("\"base\"", "\"world\"")]),
            default(),
            "r.urdf:4:50: joint `turn` names the parent link `world`, which does not exist",
        ),
        (
            robot(&[BASE, ARM, &turning, &turning.replace("turn", "twist")]),
            default(),
            "r.urdf:5:71: link `arm` is the child of joint `twist` and of joint `turn` (line 4)\n  help: closed loops are not modelled; cut the loop by removing one joint",
        ),
        (
            robot(&[BASE, ARM]),
            default(),
            "r.urdf:3:13: link `arm` is held by no joint, nor is link `base` (line 2); only one link can be the base\n  help: hold the other one by a fixed joint",
        ),
        (
            robot(&[
                r#"<link name="base"/>"#,
                ARM,
                &turning,
                r#"<joint name="back" type="fixed"><parent link="arm"/><child link="base"/></joint>"#,
            ]),
            default(),
            "r.urdf:4:14: the joints `turn` (line 4) and `back` (line 5) close a loop\n  help: closed loops are not modelled; cut the loop by removing one joint",
        ),
        (
            robot(&[BASE, ARM, &turning.replace("\"base\"", "\"arm\"")]),
            default(),
            "r.urdf:4:14: the joint `turn` (line 4) closes a loop\n  help: closed loops are not modelled; cut the loop by removing one joint",
        ),
        // joint types
        (
            with_joint("floating", ""),
            default(),
            "r.urdf:4:26: joint `turn` is floating; only revolute, continuous, prismatic and fixed joints are modelled\n  help: only robots on a fixed base are modelled; make the joint fixed, or take a kind that moves freely: `robot.vehicle`, `robot.rotorcraft`, `robot.spacecraft` or `robot.ship`",
        ),
        (
            with_joint("planar", ""),
            default(),
            "r.urdf:4:26: joint `turn` is planar; only revolute, continuous, prismatic and fixed joints are modelled\n  help: write it as two prismatic joints and a revolute one, through light links",
        ),
        (
            with_joint("spherical", ""),
            default(),
            "r.urdf:4:26: joint `turn` is spherical; only revolute, continuous, prismatic and fixed joints are modelled\n  help: write it as three revolute joints whose axes meet, through light links",
        ),
        (
            with_joint("revolut", ""),
            default(),
            "r.urdf:4:26: joint `turn` has the unknown type `revolut`\n  help: did you mean `revolute`?",
        ),
        // inertia that resists no motion
        (
            with_arm(""),
            default(),
            "r.urdf:4:14: the mass matrix is not positive definite: joint `turn` feels the inertia 0 kg m² of `arm` and what it carries, at q = 0\n  help: give the body mass and inertia that resist its joint, state the `armature` of the joints in the scenario, or lock the joint",
        ),
        (
            with_arm(&inertial("0 0 1", 1.0, [0.0; 3])),
            default(),
            "r.urdf:4:14: the mass matrix is not positive definite: joint `turn` feels the inertia 0 kg m² of `arm` and what it carries, at q = 0\n  help: give the body mass and inertia that resist its joint, state the `armature` of the joints in the scenario, or lock the joint",
        ),
        (
            with_arm(&inertial("0.5 0 0", 1.0, [0.1, 0.1, -0.3])),
            default(),
            "r.urdf:4:14: the mass matrix is not positive definite: joint `turn` feels the inertia -0.05 kg m² of `arm` and what it carries, at q = 0\n  help: give the body mass and inertia that resist its joint, state the `armature` of the joints in the scenario, or lock the joint",
        ),
        (
            robot(&[BASE, r#"<link name="arm"/>"#, &joint("prismatic", &format!("{z}{LIMIT}"))]),
            default(),
            "r.urdf:4:14: the mass matrix is not positive definite: joint `turn` feels the inertia 0 kg of `arm` and what it carries, at q = 0\n  help: give the body mass and inertia that resist its joint, state the `armature` of the joints in the scenario, or lock the joint",
        ),
        // locks
        (
            robot(&[BASE, ARM, &turning]),
            locked(&[("tunr", 0.0)]),
            "r.urdf: cannot lock `tunr`: there is no such joint\n  help: did you mean `turn`?",
        ),
        (
            robot(&[BASE, ARM, &turning]),
            locked(&[("turn", f64::INFINITY)]),
            "r.urdf:4:14: cannot lock `turn` at inf: a position must be finite",
        ),
        (
            robot(&[BASE, ARM, &turning]),
            locked(&[("turn", 0.0), ("turn", 1.0)]),
            "r.urdf:4:14: `turn` is locked twice, at 0 and at 1",
        ),
        (
            robot(&[BASE, ARM, &turning]),
            locked(&[("turn", 0.0)]),
            "r.urdf: no joint moves (fixed: 0, locked: 1)\n  help: leave a joint unlocked; what never moves has nothing to control",
        ),
        (
            robot(&[
                BASE,
                ARM,
                &turning,
                r#"<link name="tool"/>"#,
                r#"<joint name="grip" type="fixed"><parent link="arm"/><child link="tool"/></joint>"#,
            ]),
            locked(&[("grip", 0.0)]),
            "r.urdf:6:14: cannot lock `grip`: it is a fixed joint\n  help: leave it out: it does not move anyway",
        ),
    ]
}

#[test]
fn refused_with_place_and_help() {
    for (text, options, expected) in refusals() {
        let said = read_with(&text, &options).map(|_| ()).expect_err(&text);
        assert_eq!(said, expected, "{text}");
    }
}

/// All that is said of a robot.
fn all(text: &str) -> Vec<String> {
    let error = read_urdf(&SourceText::new("r.urdf", text), &UrdfOptions::default()).unwrap_err();
    let said = |error: &InputError<_>| error.to_string().trim_start_matches("r.urdf:").to_owned();
    std::iter::once(said(&error)).chain(error.others.iter().map(said)).collect()
}

#[test]
fn all_mistakes_are_told_at_once() {
    let bad_arm = r#"<link name="arm"><inertial><mass value="-1"/><inertia ixx="1" iyy="x" izz="1" ixy="0" ixz="0" iyz="nan"/></inertial></link>"#;
    let bad_turn = r#"<axis xyz="0 0 0"/><limit lower="2" upper="1" effort="-3" velocity="2"/><dynamics damping="y" friction="4"/>"#;
    let elbow = r#"<joint name="elbow" type="revolut"><parent link="arn"/><child link="hand"/><origin xyz="1 2" rpy="z 0 0"/></joint>"#;
    assert_eq!(
        all(&robot(&[BASE, bad_arm, &joint("revolute", bad_turn), elbow])),
        [
            "3:41: `value` of <mass> of link `arm` is -1, but must not be negative",
            "3:68: `iyy` of <inertia> of link `arm` is `x`, which is not a number",
            "3:100: `iyz` of <inertia> of link `arm` is `nan`, which is not finite",
            "4:87: the axis of joint `turn` is zero",
            "4:95: joint `turn` has its lower limit 2 above its upper limit 1",
            "4:130: `effort` of <limit> of joint `turn` is -3, but must not be negative",
            "4:167: `damping` of <dynamics> of joint `turn` is `y`, which is not a number",
            "4:180: joint `turn` has Coulomb friction 4, and nothing says how to model it",
            "5:27: joint `elbow` has the unknown type `revolut`",
            "5:50: joint `elbow` names the parent link `arn`, which does not exist",
            "5:69: joint `elbow` names the child link `hand`, which does not exist",
            "5:89: `xyz` of <origin> of joint `elbow` has 2 numbers where 3 are needed",
            "5:99: `rpy` of <origin> of joint `elbow` is `z`, which is not a number",
        ]
    );
    // Who has no name cannot be missed, and of a joint without its links nothing follows.
    let nameless = r#"<link><inertial><mass value="1"/></inertial></link>"#;
    let loose = r#"<joint name="loose" type="fixed"><parent link="nowhere"/></joint>"#;
    assert_eq!(
        all(&robot(&[
            BASE,
            nameless,
            loose,
            r#"<joint name="bent" type="fixed"><parent link="base"/><child link="no"/></joint>"#
        ])),
        [
            "3:1: `name` of <link> is missing",
            "3:7: <inertial> of link `(without a name)` has no <inertia>",
            "4:1: joint `loose` has no <child>",
        ]
    );
    // Two of a name, and two that hold a link; that others are held by nobody may follow from that.
    let twice = [BASE, BASE, ARM, &joint("fixed", ""), &joint("fixed", ""), r#"<link name="far"/>"#];
    assert_eq!(
        all(&robot(&twice)),
        [
            "3:13: a second link is named `base`; the first is on line 2",
            "6:14: a second joint is named `turn`; the first is on line 5",
            "6:67: link `arm` is the child of joint `turn` and of joint `turn` (line 5)",
        ]
    );
    let apart = [BASE, r#"<link name="a"/>"#, r#"<link name="b"/>"#];
    assert_eq!(all(&robot(&apart)).len(), 2);
}

#[test]
fn many_mistakes_are_counted_and_of_a_template_one_is_told() {
    let bad = r#"<link name="arm"><inertial><mass value="x"/><inertia/></inertial></link>"#;
    let said = all(&robot(&[bad; 10]));
    assert_eq!(said.len(), 25, "{said:?}");
    assert_eq!(said[24], "r.urdf: 55 more mistakes are reported once these are mended".trim_start_matches("r.urdf:"));
    let template = robot(&[bad, r#"<link name="${prefix}base"/>"#, bad]);
    assert_eq!(all(&template), ["3:13: `${prefix}base` is xacro, not URDF"]);
}
