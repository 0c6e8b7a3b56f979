//! Building trees: what is refused, what is named, and which bodies cannot exist.

use forwardstep_core::robot::tree::{
    InertiaDefect, JointKind, LinkJoint, LinkSpec, MassMatrixError, Placement, Tree, TreeError, inertia_about_frame,
    inertia_defects,
};
use forwardstep_core::robot::{DriveError, Drives, Friction, Lagrangian, Stick};

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// A ball of 2 kg, 0.5 m from a revolute z axis.
fn ball(parent: Option<usize>) -> LinkSpec {
    LinkSpec {
        parent,
        x_parent_joint: Placement { translation: [1.0, 0.0, 0.0], ..Placement::IDENTITY },
        joint: LinkJoint::Moving { kind: JointKind::Revolute, axis: [0.0, 0.0, 1.0], damping: 0.0 },
        inertia: inertia_about_frame(2.0, [0.5, 0.0, 0.0], [0.01, 0.0, 0.01, 0.0, 0.0, 0.01]),
    }
}

fn moving(axis: [f64; 3], damping: f64) -> LinkSpec {
    LinkSpec { joint: LinkJoint::Moving { kind: JointKind::Revolute, axis, damping }, ..ball(None) }
}

fn refusal(links: &[LinkSpec]) -> TreeError {
    Tree::assemble(links, GRAVITY).unwrap_err()
}

#[test]
fn drives_need_joints_in_order_and_positive_widths() {
    let tree = || Tree::assemble(&[moving([0.0, 0.0, 1.0], 0.3), moving([0.0, 0.0, 1.0], 0.0)], [0.0; 3]).unwrap().tree;
    let geared = |geared: Vec<usize>| tree().with_drives(Drives { geared, ..Drives::default() });
    let rubbing = |friction: Vec<Friction>| tree().with_drives(Drives { friction, ..Drives::default() });
    assert_eq!(geared(vec![2]).unwrap_err(), DriveError::NoJoint { joint: 2, joints: 2 });
    assert_eq!(geared(vec![1, 0]).unwrap_err(), DriveError::Order { joint: 0 });
    assert_eq!(geared(vec![1, 1]).unwrap_err(), DriveError::Order { joint: 1 });
    for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = rubbing(vec![Friction { joint: 1, width }]).unwrap_err();
        assert!(matches!(error, DriveError::Width { joint: 1, .. }), "{error}");
    }
    for period_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = tree().with_drives(Drives { dry_s: Some(period_s), ..Drives::default() }).unwrap_err();
        assert!(matches!(error, DriveError::Period { .. }), "{error}");
    }
    let friction = vec![Friction { joint: 0, width: 0.1 }];
    let driven = Drives { damped: vec![0], geared: vec![1], friction, dry_s: Some(1e-3) };
    let driven = tree().with_drives(driven).unwrap();
    assert_eq!(driven.theta_len(), 23);
    assert_eq!(driven.drives().ranges_in(23), Some([20..21, 21..22, 22..23]));
    assert_eq!(driven.drives().ranges_in(2), None);
    let names = driven.theta_names(&["a", "b"]).unwrap();
    assert_eq!(names[20..], ["a.damping_n_m_s", "b.armature_kg_m2", "a.friction_n_m"]);
    let damped = tree().with_drives(Drives { damped: vec![1, 1], ..Drives::default() });
    assert_eq!(damped.unwrap_err(), DriveError::Order { joint: 1 });
    // What it had is replaced, damping too.
    assert_eq!(tree().theta_len(), 21);
    assert_eq!(driven.with_drives(Drives::default()).unwrap().theta_len(), 20);
}

#[test]
fn regress_malformed_links_are_refused_with_their_values() {
    assert_eq!(refusal(&[]), TreeError::NothingMoves { links: 0 });
    assert_eq!(refusal(&[LinkSpec { joint: LinkJoint::Fixed, ..ball(None) }]), TreeError::NothingMoves { links: 1 });
    assert_eq!(refusal(&[ball(None), ball(Some(1))]), TreeError::ParentOrder { link: 1, parent: 1 });
    assert_eq!(refusal(&[ball(Some(7))]), TreeError::ParentOrder { link: 0, parent: 7 });
    assert_eq!(refusal(&[moving([0.0; 3], 0.0)]), TreeError::ZeroAxis { link: 0 });
    assert_eq!(refusal(&[ball(None), moving([0.0, 3.0, 4.0], 0.0)]), TreeError::AxisLength { link: 1, length: 5.0 });
    assert_eq!(refusal(&[moving([1.0, 0.0, 0.0], -0.1)]), TreeError::NegativeDamping { link: 0, damping: -0.1 });
    let infinite = TreeError::NotFinite { link: 0, what: "damping", value: f64::INFINITY };
    assert_eq!(refusal(&[moving([1.0, 0.0, 0.0], f64::INFINITY)]), infinite);

    let mut nan = ball(None);
    nan.inertia[3] = f64::NAN;
    assert!(matches!(refusal(&[nan]), TreeError::NotFinite { link: 0, what: "inertia", value } if value.is_nan()));
    let mut mirrored = ball(None);
    mirrored.x_parent_joint.rotation[2][2] = -1.0;
    assert_eq!(refusal(&[mirrored]), TreeError::NotRotation { link: 0, error: 0.0, mirrored: true });
    let mut sheared = ball(None);
    sheared.x_parent_joint.rotation[0][1] = 0.1;
    assert!(matches!(refusal(&[sheared]), TreeError::NotRotation { link: 0, error, mirrored: false } if error > 0.05));
    let weightless = Tree::assemble(&[ball(None)], [0.0, f64::NAN, 0.0]).unwrap_err();
    assert!(matches!(weightless, TreeError::Gravity { .. }));
    assert_eq!(
        refusal(&[ball(None), moving([0.0, 3.0, 4.0], 0.0)]).to_string(),
        "the joint axis of link 1 has length 5, but must be a unit vector"
    );
}

#[test]
fn regress_bodies_anchors_names_and_damping() {
    let links = [
        LinkSpec { joint: LinkJoint::Fixed, ..ball(None) },
        LinkSpec { parent: Some(0), ..moving([0.0, 0.0, 1.0], 0.3) },
        LinkSpec { joint: LinkJoint::Fixed, ..ball(Some(1)) },
        LinkSpec {
            joint: LinkJoint::Moving { kind: JointKind::Prismatic, axis: [1.0, 0.0, 0.0], damping: 4.0 },
            ..ball(Some(2))
        },
        ball(Some(1)),
    ];
    let assembled = Tree::assemble(&links, GRAVITY).unwrap();
    let tree = &assembled.tree;
    assert_eq!(assembled.moving, [1, 3, 4]);
    assert_eq!(tree.parents().collect::<Vec<_>>(), [None, Some(0), Some(0)]);
    assert_eq!(tree.joint_kinds().nth(1), Some(JointKind::Prismatic));
    assert_eq!(tree.drives().damped, [0, 1]);
    assert_eq!(tree.gravity_m_s2(), GRAVITY);
    assert_eq!(assembled.theta[30..], [0.3, 4.0]);
    // The second ball is lumped into the first body: masses 2 + 2, at 0.5 and 1.5.
    assert_eq!(assembled.theta[..2], [4.0, 4.0]);
    assert_eq!(assembled.anchors[0].body, None);
    assert_eq!(assembled.anchors[2].body, Some(0));
    assert_eq!(assembled.anchors[2].x_body_link.translation, [1.0, 0.0, 0.0]);
    assert_eq!(tree.body_sizes(), [2.0, 0.0, 0.0]);

    let names = tree.theta_names(&["arm", "slide", "elbow"]).unwrap();
    assert_eq!(names.len(), tree.theta_len());
    assert_eq!(names[0], "arm.mass_kg");
    assert_eq!(names[11], "slide.mass_com_x_kg_m");
    assert_eq!(names[25], "elbow.inertia_xy_kg_m2");
    assert_eq!(names[30..], ["arm.damping_n_m_s", "slide.damping_n_s_m"]);
    assert!(tree.theta_names(&["arm"]).is_err());
}

#[test]
fn regress_adaptation_scale() {
    let mut links = [moving([0.0, 0.0, 1.0], 0.3), ball(Some(0)), ball(Some(1))];
    links[2].inertia = [0.0; 10];
    let assembled = Tree::assemble(&links, GRAVITY).unwrap();
    let tree = &assembled.tree;
    let q = [0.3, 0.4, 0.5];
    let scale = Lagrangian::<f64>::adaptation_scale(tree, &q, &assembled.theta);
    assert_eq!(scale.len(), assembled.theta.len());
    let (m, r2, g2) = (2.0, 0.5 * (0.01 + 0.51 + 0.51) / 2.0, 9.81 * 9.81);
    // The body without mass takes the mean of the others, which is the same.
    for body in scale[..30].chunks(10) {
        for (k, entry) in body.iter().enumerate() {
            let want = m / g2 * [1.0, r2, r2, r2, r2 * r2][k.min(4)];
            assert!((entry / want - 1.0).abs() < 1e-12, "{k}: {entry} {want}");
        }
    }
    let mut mass = [0.0; 9];
    tree.mass_matrix(&mut tree.scratch(), &q, &assembled.theta, &mut mass).unwrap();
    assert_eq!(scale[30], mass[0]);
    // Nothing to go by: still positive.
    assert!(Lagrangian::<f64>::adaptation_scale(tree, &q, &[0.0; 31]).iter().all(|x| *x > 0.0));
    assert!(Lagrangian::<f64>::adaptation_scale(tree, &[], &[]).iter().all(|x| *x > 0.0));
}

#[test]
fn regress_mass_matrix_names_the_body_to_blame() {
    let all = [[f64::NEG_INFINITY, f64::INFINITY]; 3];
    let check = |edit: &dyn Fn(&mut [LinkSpec; 3])| {
        let mut links = [ball(None), ball(Some(0)), ball(Some(1))];
        edit(&mut links);
        let assembled = Tree::assemble(&links, GRAVITY).unwrap();
        assembled.tree.check_mass_matrix(&assembled.theta, &all, 10)
    };
    assert_eq!(check(&|_| ()), Ok(()));
    // A wrist without inertia makes M singular.
    let empty = check(&|links| links[2].inertia = [0.0; 10]);
    let Err(MassMatrixError::NotPositiveDefinite { body: 2, order: 1, pivot, q }) = empty else { panic!("{empty:?}") };
    assert_eq!((pivot, q.len()), (0.0, 3));
    // A negative mass in the middle is blamed on the middle body, although the leading minors of M fail elsewhere.
    let negative = check(&|links| links[1].inertia = ball(None).inertia.map(|x| -3.0 * x));
    assert!(matches!(negative, Err(MassMatrixError::NotPositiveDefinite { body: 1, order: 2, .. })), "{negative:?}");
    let assembled = Tree::assemble(&[ball(None)], GRAVITY).unwrap();
    assert!(matches!(assembled.tree.check_mass_matrix(&assembled.theta, &all, 1), Err(MassMatrixError::Length(_))));
    let range = [[0.0, 1.0]];
    assert!(assembled.tree.check_mass_matrix(&[1.0], &range, 1).is_err());
}

#[test]
fn regress_inertia_defects() {
    let about = |mass, com, diagonal: [f64; 3]| {
        inertia_about_frame(mass, com, [diagonal[0], 0.0, diagonal[1], 0.0, 0.0, diagonal[2]])
    };
    let none: [InertiaDefect; 0] = [];
    // A frame, a ball, a rod and a plate are in order.
    assert_eq!(inertia_defects(&[0.0; 10], 0.4), none);
    assert_eq!(inertia_defects(&about(2.0, [0.3, 0.2, 0.1], [0.01; 3]), 0.4), none);
    assert_eq!(inertia_defects(&about(2.0, [0.3, 0.2, 0.1], [0.0, 0.1, 0.1]), 0.4), none);
    assert_eq!(inertia_defects(&about(2.0, [0.3, 0.2, 0.1], [0.1, 0.2, 0.3]), 0.4), none);

    assert_eq!(inertia_defects(&about(-1.0, [0.0; 3], [0.1; 3]), 0.4), [InertiaDefect::NegativeMass { mass_kg: -1.0 }]);
    let mut massless = [0.0; 10];
    (massless[1], massless[9]) = (3.0, -2.0);
    let defect = InertiaDefect::WithoutMass { first_moment_kg_m: 3.0, inertia_kg_m2: 2.0 };
    assert_eq!(inertia_defects(&massless, 0.4), [defect]);

    // A solid sphere of 5 kg and 0.4 m across: 2/5 m r² = 0.08 kg m².
    let point = inertia_defects(&about(5.0, [0.3, 0.2, 0.1], [0.0; 3]), 0.4);
    let [InertiaDefect::ZeroInertia { mass_kg: 5.0, plausible_kg_m2 }] = point[..] else { panic!("{point:?}") };
    assert!((plausible_kg_m2 - 0.08).abs() < 1e-15);
    assert_eq!(
        inertia_defects(&about(5.0, [0.0; 3], [0.0; 3]), f64::NAN)[0].to_string(),
        "the inertia about the centre of mass is zero for a mass of 5 kg; 0.005000000000000001 kg m² would be plausible"
    );

    let negative = inertia_defects(&about(5.0, [0.0; 3], [0.1, -0.2, 0.1]), 0.4);
    let [InertiaDefect::NegativeMoment { moments_kg_m2, .. }] = negative[..] else { panic!("{negative:?}") };
    assert_eq!(moments_kg_m2, [-0.2, 0.1, 0.1]);

    let broken = inertia_defects(&about(5.0, [0.0; 3], [0.1, 0.5, 0.1]), 0.4);
    let defect = InertiaDefect::TriangleInequality { moments_kg_m2: [0.1, 0.1, 0.5], plausible_kg_m2: 0.2 };
    assert_eq!(broken, [defect]);

    // A file in mm where m was meant.
    let far = inertia_defects(&about(5.0, [300.0, 0.0, 0.0], [0.1; 3]), 0.4);
    let [InertiaDefect::FarCentre { distance_m: 300.0, size_m: 0.4, plausible_m: 0.2 }, ..] = far[..] else {
        panic!("{far:?}")
    };
}

/// Principal moments do not depend on the axes in which the inertia is stated.
#[test]
fn prop_defects_do_not_depend_on_axes() {
    for k in 0..50 {
        let angle = f64::from(k);
        let turn = Placement::from_xyz_rpy([0.1, angle, 0.2], [angle, 2.0 * angle, 3.0 * angle]);
        let sound = turn.inertia(&inertia_about_frame(1.0, [0.1, 0.0, 0.0], [0.3, 0.0, 0.2, 0.0, 0.0, 0.15]));
        assert_eq!(inertia_defects(&sound, 50.0), []);
        let broken = turn.inertia(&inertia_about_frame(1.0, [0.1, 0.0, 0.0], [0.3, 0.0, 0.1, 0.0, 0.0, 0.15]));
        let defects = inertia_defects(&broken, 50.0);
        let [InertiaDefect::TriangleInequality { moments_kg_m2: moments, .. }] = defects[..] else {
            panic!("{defects:?}")
        };
        for (moment, want) in moments.into_iter().zip([0.1, 0.15, 0.3]) {
            assert!((moment - want).abs() < 1e-11 * (1.0 + angle * angle));
        }
    }
}

/// From one period to the next, with one joint that nothing rubs between two that rub: M⁻¹ couples all of them.
#[test]
fn eq_dry_friction_suits_the_velocity_that_a_period_ends_with() {
    let links = [moving([0.0, 0.0, 1.0], 0.3), ball(Some(0)), ball(Some(1))];
    let assembled = Tree::assemble(&links, GRAVITY).unwrap();
    let forces = [2.0, 0.5];
    let friction = [0, 2].map(|joint| Friction { joint, width: 0.1 }).to_vec();
    let drives = Drives { geared: vec![1], friction, dry_s: Some(0.1), ..assembled.tree.drives().clone() };
    let (tree, mut theta) = (assembled.tree.with_drives(drives).unwrap(), assembled.theta);
    theta.extend([0.2, forces[0], forces[1]]);
    let (mut scratch, mut stick) = (tree.scratch(), Stick::new(tree.drives(), 3));
    let mut mass = [0.0; 9];
    let mut ends = [0; 3];
    for k in 0..300 {
        let wave = |rate: f64| (rate * f64::from(k)).sin();
        let (h_s, q) = (0.02 + 0.01 * wave(0.7), [wave(1.1), 2.0 * wave(1.3), 2.0 * wave(1.7)]);
        let dq = [0.1 * wave(1.9), 0.1 * wave(2.3), 0.1 * wave(2.9)];
        let pushed = [6.0 * wave(3.1), 3.0 * wave(3.7), 1.5 * wave(4.1)];
        let mut under = |rubbed: &[f64]| {
            let tau: Vec<f64> = pushed.iter().zip(rubbed).map(|(push, rubbed)| push - rubbed).collect();
            let mut ddq = [0.0; 3];
            tree.forward_dynamics(&mut scratch, &q, &dq, &theta, &tau, &mut ddq).unwrap();
            ddq
        };
        let before = under(stick.torque());
        tree.mass_matrix(&mut tree.scratch(), &q, &theta, &mut mass).unwrap();
        stick.set(h_s, &mass, &forces, [&dq, &before]).unwrap();
        let after = under(stick.torque());
        assert_eq!(stick.torque()[1], 0.0);
        for (joint, force) in [0, 2].into_iter().zip(forces) {
            let (end, sigma) = (dq[joint] + h_s * after[joint], stick.torque()[joint] / force);
            let (suits, which) = match sigma {
                1.0 => (end > -1e-10, 0),
                -1.0 => (end < 1e-10, 1),
                inside => (inside.abs() < 1.0 && end.abs() < 1e-10, 2),
            };
            assert!(suits, "{k}, joint {joint}: σ = {sigma}, and the period ends with {end}");
            ends[which] += 1;
        }
    }
    assert!(ends.iter().all(|count| *count > 50), "it slides either way, and sticks: {ends:?}");
    let short = [0.0; 2];
    let full = [0.0; 3];
    for wrong in [[&short[..], &full], [&full, &short]] {
        assert!(stick.set(0.1, &mass, &forces, wrong).is_err());
    }
    assert!(stick.set(0.1, &mass[..4], &forces, [&full, &full]).is_err());
    assert!(stick.set(0.1, &mass, &forces[..1], [&full, &full]).is_err());
}
