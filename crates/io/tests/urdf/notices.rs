//! Every notice about a file that is accepted.

use forwardstep_io::UrdfOptions;
use forwardstep_io::urdf::FrictionPolicy;

use super::{ARM, BASE, LIMIT, inertial, joint, locked, notices, read_with, robot};

fn noted() -> Vec<(String, UrdfOptions, &'static [&'static str])> {
    let default = UrdfOptions::default;
    let z = r#"<axis xyz="0 0 1"/>"#;
    let turning = joint("revolute", &format!("{z}{LIMIT}"));
    let with_joint = |kind: &str, inside: &str| robot(&[BASE, ARM, &joint(kind, inside)]);
    let with_arm = |inertial: &str| robot(&[BASE, &format!(r#"<link name="arm">{inertial}</link>"#), &turning]);
    let ignore_friction = || UrdfOptions { friction: FrictionPolicy::Ignore, ..default() };
    vec![
        (robot(&[BASE, ARM, &turning]), default(), &[]),
        (with_joint("continuous", z), default(), &[]),
        // what looks like degrees
        (
            with_joint("revolute", &format!("{z}<limit lower=\"-180\" upper=\"90\" effort=\"9\" velocity=\"9\"/>")),
            default(),
            &[
                "r.urdf:4:95: the limits of joint `turn`, -180 to 90 rad, look like degrees; in rad those are -3.14159 to 1.5708",
            ],
        ),
        (
            with_joint("revolute", &format!("{z}<limit lower=\"-6\" upper=\"12\" effort=\"9\" velocity=\"9\"/>")),
            default(),
            &[],
        ),
        // what does not enter
        (
            robot(&[
                r#"<material name="grey"><color rgba="1 1 1 1"/></material>"#,
                r#"<link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual><inertail/></link>"#,
                &ARM.replace("</link>", "<visual/><collision/></link>"),
                &turning.replace("</joint>", r#"<safety_controller k_velocity="1"/><calibration rising="0"/></joint>"#),
                r#"<transmission name="t"><joint name="turn"/></transmission>"#,
                r#"<gazebo reference="arm"><link name="x"/></gazebo>"#,
                r#"<sensor name="s"/><lnik name="y"/>"#,
                "stray text",
            ]),
            default(),
            &[
                "r.urdf: ignored: material on line 2, visual 2 times from line 3, collision on line 4 (shape and colour do not enter the dynamics); inertail on line 3 (unknown to URDF; did you mean `inertial`?); safety_controller on line 5, calibration on line 5 (for the controller of the real robot); transmission on line 6 (gears and rotors are not modelled); gazebo on line 7 (for another simulator); sensor on line 8 (sensors are not modelled); lnik on line 8 (unknown to URDF; did you mean `link`?); text in robot on line 9 (unknown to URDF)",
            ],
        ),
        (
            with_joint("revolute", &format!(r#"{z}{LIMIT}<dynamics dampnig="1"/>"#)),
            default(),
            &["r.urdf: ignored: dynamics@dampnig on line 4 (unknown to URDF; did you mean `damping`?)"],
        ),
        (
            with_joint("continuous", &format!("{z}{LIMIT}")),
            default(),
            &["r.urdf: ignored: limit@lower on line 4, limit@upper on line 4 (without meaning on a continuous joint)"],
        ),
        (
            robot(&[
                BASE,
                ARM,
                &turning,
                r#"<link name="tool"/>"#,
                r#"<joint name="grip" type="fixed"><parent link="arm"/><child link="tool"/><axis xyz="0 0 0"/><limit effort="x"/></joint>"#,
            ]),
            default(),
            &["r.urdf: ignored: axis on line 6, limit on line 6 (without meaning on a fixed joint)"],
        ),
        (
            robot(&[&ARM.replace("arm", "base"), ARM, &turning]),
            default(),
            &[
                "r.urdf:2:19: the base does not move, so the inertia of what is rigid with it (2 kg: `base`) does not enter",
            ],
        ),
        // axes
        (
            with_joint("revolute", LIMIT),
            default(),
            &["r.urdf:4:14: joint `turn` states no axis; x is taken, as URDF says"],
        ),
        (
            with_joint("revolute", &format!("<axis/>{LIMIT}")),
            default(),
            &["r.urdf:4:76: joint `turn` states no axis; x is taken, as URDF says"],
        ),
        (
            with_joint("revolute", &format!(r#"<axis xyz="0 3 4"/>{LIMIT}"#)),
            default(),
            &["r.urdf:4:87: the axis of joint `turn` is 0 3 4; 0 0.6 0.8 of unit length is used"],
        ),
        (with_joint("revolute", &format!(r#"<axis xyz="0 0.707107 0.707107"/>{LIMIT}"#)), default(), &[]),
        (
            with_joint("revolute", &format!(r#"<axis xyz="0 0 1e-300"/>{LIMIT}"#)),
            default(),
            &["r.urdf:4:87: the axis of joint `turn` is 0 0 1e-300; 0 0 1 of unit length is used"],
        ),
        // limits
        (
            with_joint("revolute", z),
            default(),
            &["r.urdf:4:14: joint `turn` has no <limit>, which URDF requires; it is taken to be unlimited"],
        ),
        (
            with_joint("revolute", &format!("{z}<limit/>")),
            default(),
            &[
                "r.urdf:4:95: <limit> of joint `turn` has no `effort`; it is taken to be unlimited",
                "r.urdf:4:95: <limit> of joint `turn` has no `velocity`; it is taken to be unlimited",
                "r.urdf:4:95: <limit> of joint `turn` has neither `lower` nor `upper`; any position is taken to be allowed",
            ],
        ),
        (
            with_joint("revolute", &format!(r#"{z}<limit upper="1" effort="0" velocity="0"/>"#)),
            default(),
            &[
                "r.urdf:4:95: <limit> of joint `turn` has no `lower`; 0 is taken, as URDF says",
                "r.urdf:4:120: joint `turn` has the effort limit 0; it could not move where limits are enforced",
                "r.urdf:4:133: joint `turn` has the velocity limit 0; it could not move where limits are enforced",
            ],
        ),
        (
            with_joint("prismatic", &format!(r#"{z}<limit lower="1" upper="1" effort="1" velocity="1"/>"#)),
            default(),
            &["r.urdf:4:96: the limits of joint `turn` allow the position 1 only"],
        ),
        // inertia
        (
            with_arm(&inertial("0.5 0 0", 2.0, [0.01, 0.01, 0.1])),
            default(),
            &[
                "r.urdf:3:18: the inertia of link `arm` is implausible: the largest principal moment of inertia, 0.1 kg m², exceeds the sum of the two others, 0.01 + 0.01; no body has that, at most 0.02 kg m² would be plausible",
            ],
        ),
        (
            with_arm(&inertial("0.5 0 0", 2.0, [-0.01, 0.02, 0.02])),
            default(),
            &[
                "r.urdf:3:18: the inertia of link `arm` is implausible: the principal moments of inertia are -0.01, 0.02 and 0.02 kg m², but none may be negative; 0.002 kg m² each would be plausible",
            ],
        ),
        (
            with_arm(&inertial("0.5 0 0", 2.0, [0.0; 3])),
            default(),
            &[
                "r.urdf:3:18: the inertia of link `arm` is implausible: the inertia about the centre of mass is zero for a mass of 2 kg; 0.002 kg m² would be plausible",
            ],
        ),
        (
            with_arm(&inertial("20 0 0", 2.0, [0.01; 3])),
            default(),
            &[
                "r.urdf:3:18: the inertia of link `arm` is implausible: the centre of mass is 20 m from the joint, but the body measures about 0.1 m; 0.05 m would be plausible",
            ],
        ),
        (
            with_arm(&inertial("0 0 0", 0.0, [0.01; 3])),
            default(),
            &[
                "r.urdf:3:13: the body of link `arm` has no mass, although a joint moves it",
                "r.urdf:3:18: the inertia of link `arm` is implausible: the mass is zero, but the body has first moment 0 kg m and inertia 0.01 kg m²",
            ],
        ),
        (
            robot(&[
                BASE,
                r#"<link name="arm"/>"#,
                &turning,
                &ARM.replace("arm", "tool"),
                r#"<joint name="tilt" type="continuous"><parent link="arm"/><child link="tool"/><axis xyz="0 1 0"/></joint>"#,
            ]),
            default(),
            &["r.urdf:3:13: the body of link `arm` has no mass, although a joint moves it"],
        ),
        // mimicry, friction, locks
        (
            with_joint("revolute", &format!(r#"{z}{LIMIT}<mimic joint="other"/>"#)),
            default(),
            &[
                "r.urdf:4:148: joint `turn` should follow `other` (<mimic>), but moves freely; lock it, or drive it alike",
            ],
        ),
        (
            with_joint("revolute", &format!("{z}{LIMIT}<mimic/>")),
            default(),
            &[
                "r.urdf:4:148: joint `turn` should follow another (<mimic>), but moves freely; lock it, or drive it alike",
            ],
        ),
        (
            with_joint("revolute", &format!(r#"{z}{LIMIT}<dynamics friction="0.25"/>"#)),
            ignore_friction(),
            &["r.urdf:4:168: Coulomb friction is left out, as asked: 0.25 of `turn`"],
        ),
        (
            robot(&[
                BASE,
                ARM,
                &turning,
                &ARM.replace("arm", "tool"),
                r#"<joint name="grip" type="revolute"><parent link="arm"/><child link="tool"/><limit lower="0" upper="1"/><dynamics friction="1"/><mimic joint="turn"/></joint>"#,
            ]),
            locked(&[("grip", -0.5)]),
            &["r.urdf:6:14: joint `grip` is locked at -0.5, outside its limits 0 to 1"],
        ),
    ]
}

#[test]
fn accepted_with_notices() {
    for (text, options, expected) in noted() {
        let said = notices(&read_with(&text, &options).unwrap());
        assert_eq!(said, expected, "{text}");
    }
}
