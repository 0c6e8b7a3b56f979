//! `<link>`: a name and an inertia.

use std::ops::Range;

use super::ignored::IgnoreReason;
use super::problem::UrdfProblem;
use super::subject::Owner;
use super::xml::{Element, Located, Reading, UrdfError};

/// A link as the file states it.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub(super) name: String,
    /// Bytes of the name.
    pub(super) span: Range<usize>,
    pub(super) inertial: Option<Inertial>,
}

/// Mass, centre of mass and rotational inertia as the file states them.
#[derive(Clone, Debug)]
pub(super) struct Inertial {
    pub(super) span: Range<usize>,
    /// Centre of mass, and the axes of `inertia`, in the link frame.
    pub(super) origin: Origin,
    pub(super) mass: f64,
    /// `[Ixx, Ixy, Iyy, Ixz, Iyz, Izz]` about the centre of mass.
    pub(super) inertia: [f64; 6],
}

/// `<origin>`: a translation, and a rotation as roll, pitch and yaw.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Origin {
    pub(super) xyz: [f64; 3],
    pub(super) rpy: [f64; 3],
}

/// Reads a `<link>`.
pub(super) fn read_link(reading: &mut Reading<'_>, element: Element<'_>) -> Result<Link, UrdfError> {
    let Located { value: name, span } = element.own_name(reading, "link");
    element.only_attributes(reading, &["name"]);
    let element = element.owned_by(Owner::Link(name.clone()));
    let [inertial] = element.children_once(reading, ["inertial"], |name| match name {
        "visual" | "collision" | "material" | "geometry" => Some(IgnoreReason::Shape),
        "sensor" => Some(IgnoreReason::Sensor),
        "contact" | "gazebo" => Some(IgnoreReason::Simulator),
        _ => None,
    })?;
    let inertial = inertial.map(|inertial| read_inertial(reading, &inertial)).transpose()?;
    Ok(Link { name, span, inertial })
}

fn read_inertial(reading: &mut Reading<'_>, element: &Element<'_>) -> Result<Inertial, UrdfError> {
    element.only_attributes(reading, &[]);
    let [origin, mass, inertia] = element.children_once(reading, ["origin", "mass", "inertia"], |_| None)?;
    let origin = read_origin(reading, origin)?;
    let missing = |reading: &Reading<'_>, what| {
        let owner = element.owner.clone().unwrap_or(Owner::Robot);
        reading.error(element.span(), UrdfProblem::MissingElement { owner, parent: Some("inertial"), element: what })
    };

    let mut value = 0.0;
    match mass {
        None => {
            reading.noted::<()>(Err(missing(reading, "mass")));
        }
        Some(mass) => {
            mass.only_attributes(reading, &["value"]);
            if reading.noted(mass.required_number(reading, "value", "mass")).is_some() {
                let read = mass.non_negative(reading, "value", "mass");
                value = reading.noted(read).flatten().map_or(0.0, |located| located.value);
            }
        }
    }
    let mut entries = [0.0; 6];
    match inertia {
        None => {
            reading.noted::<()>(Err(missing(reading, "inertia")));
        }
        Some(inertia) => {
            let names = ["ixx", "ixy", "iyy", "ixz", "iyz", "izz"];
            inertia.only_attributes(reading, &names);
            for (entry, name) in entries.iter_mut().zip(names) {
                let read = inertia.required_number(reading, name, "inertia");
                *entry = reading.noted(read).map_or(0.0, |located| located.value);
            }
        }
    }
    Ok(Inertial { span: element.span(), origin, mass: value, inertia: entries })
}

/// Reads an `<origin>`; none, or a missing attribute, means zeros.
pub(super) fn read_origin(reading: &mut Reading<'_>, element: Option<Element<'_>>) -> Result<Origin, UrdfError> {
    let Some(element) = element else { return Ok(Origin::default()) };
    let quaternion = element.text(reading, "quat_xyzw");
    if let Some(quaternion) = reading.noted(quaternion).flatten() {
        let owner = element.owner.clone().unwrap_or(Owner::Robot);
        reading.noted::<()>(Err(reading.error(quaternion.span, UrdfProblem::Quaternion { owner })));
    } else {
        element.only_attributes(reading, &["xyz", "rpy"]);
    }
    let [xyz, rpy] = ["xyz", "rpy"].map(|name| {
        let read = element.numbers::<3>(reading, name, "origin");
        reading.noted(read).flatten().map_or([0.0; 3], |located| located.value)
    });
    Ok(Origin { xyz, rpy })
}
