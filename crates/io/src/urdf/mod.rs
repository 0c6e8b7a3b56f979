//! URDF in, a robot out.
//!
//! Read are robots on a fixed base: trees of any number of revolute, continuous, prismatic and fixed joints. What is
//! rigid together is one body with ten parameters; every moving joint adds its viscous damping to ϑ.
//!
//! **Order.** Degrees of freedom are numbered as Pinocchio does: depth first from the base, the joints of one link in
//! the bytewise order of their names. For an arm this is the order from base to tool, whatever the order in the file.
//!
//! **Angles** are real numbers that are never wrapped; a continuous joint is a revolute one without position limits.
//!
//! **Nothing is dropped without notice.** What has no meaning is refused with its line and column ([`UrdfProblem`]); what
//! was accepted but is odd, assumed or left out is listed in the robot's [`Notice`]s.

mod dynamics;
mod ignored;
mod joint;
mod link;
mod lock;
mod notice;
mod problem;
mod shipped;
mod subject;
mod tree;
mod xml;

use forwardstep_core::robot::tree::Anchor;
use forwardstep_sim::setup::RobotSetup;

pub use ignored::{IgnoreReason, IgnoredItem};
pub use joint::MotionKind;
pub use notice::{Notice, NoticeKind};
pub use problem::UrdfProblem;
pub use shipped::{SHIPPED_ROBOTS, shipped_robot};
pub use subject::{AttributeOf, End, Named, NamedLine, Owner, Size};

use crate::{InputError, SourceText};
use dynamics::Moving;
use ignored::IgnoreReason as Reason;
use link::Link;
use xml::{Element, Reading, UrdfError};

/// What to make of a URDF file.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfOptions {
    /// Joints that are held at a value, in rad or m, and so lose their degree of freedom.
    pub locked: Vec<(String, f64)>,
    /// The armatures that the joints get behind it, in kg m² or kg, which may be all that resists a joint: one for each joint that moves,
    /// one for all of them, or none.
    pub armature: Vec<f64>,
    /// What to do about Coulomb friction.
    pub friction: FrictionPolicy,
    /// Acceleration of free fall in the frame of the base, in m/s².
    pub gravity: [f64; 3],
}

impl Default for UrdfOptions {
    fn default() -> Self {
        UrdfOptions {
            locked: Vec::new(),
            armature: Vec::new(),
            friction: FrictionPolicy::Refuse,
            gravity: [0.0, 0.0, -9.81],
        }
    }
}

/// What to do about Coulomb friction in the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrictionPolicy {
    /// Refuse the file.
    #[default]
    Refuse,
    /// Leave it out, with a notice.
    Ignore,
    /// Read it, for [`RobotSetup::with_drives`].
    Read,
}

/// A robot read from a URDF file.
#[derive(Clone, Debug)]
pub struct UrdfRobot {
    /// The name the file gives it.
    pub name: String,
    /// The robot, with the parameters of the file as its true ϑ.
    pub robot: RobotSetup,
    /// The link that is fixed to the world.
    pub base: String,
    /// What each degree of freedom does.
    pub kinds: Vec<MotionKind>,
    /// Coulomb friction of each, N m or N, as the file states it; no part of `robot` yet.
    pub coulomb: Vec<f64>,
    /// The moving bodies in the order of the degrees of freedom, each by the link that its joint carries.
    pub bodies: Vec<String>,
    /// The mass that is rigid with the base and so does not enter, in kg.
    pub held_mass_kg: f64,
    /// All links, depth first from the base.
    pub links: Vec<String>,
    /// Where each of them is held, by a moving body or by the base.
    pub anchors: Vec<Anchor>,
    /// What the user should know, in the order of the file.
    pub notices: Vec<Notice>,
}

/// Reads a URDF file.
///
/// ```
/// use forwardstep_io::urdf::shipped_robot;
/// use forwardstep_io::{SourceText, UrdfOptions, read_urdf};
///
/// let text = shipped_robot("ur5e").ok_or("not shipped")?;
/// let options = UrdfOptions { locked: vec![("wrist_3_joint".to_owned(), 0.0)], ..UrdfOptions::default() };
/// let arm = read_urdf(&SourceText::new("ur5e.urdf", text), &options)?;
/// assert_eq!(arm.robot.axes.len(), 5);
/// assert!(arm.notices.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The first problem met, at its place in the file, with all others that do not follow from it as [`InputError::others`]: see
/// [`UrdfProblem`]. Any text gives a result; none panics.
pub fn read_urdf(source: &SourceText, options: &UrdfOptions) -> Result<UrdfRobot, InputError<UrdfProblem>> {
    let mut reading = Reading::new(source);
    let document = xml::parse(&reading)?;
    let root = Element::new(document.root_element(), Some(Owner::Robot));
    let (name, links, joints) = match read_robot(&mut reading, &root, options) {
        Ok(read) => read,
        Err(error) => {
            // Of a template the first place is told.
            reading.noted::<()>(Err(error.clone()));
            return Err(reading.end().err().unwrap_or(error));
        }
    };

    // Who holds whom is known only where everybody has a name.
    let arranged = if reading.has_gaps { Ok(Vec::new()) } else { tree::arrange(&mut reading, &links, &joints) };
    let arranged = reading.noted(arranged).unwrap_or_default();
    if reading.is_mistaken() && options.friction == FrictionPolicy::Refuse {
        let is_locked = |joint: &joint::Joint| options.locked.iter().any(|(name, _)| *name == joint.name);
        dynamics::refuse_friction(&mut reading, joints.iter().filter(|joint| !is_locked(joint)));
    }
    reading.end()?;
    let locks = lock::locks(&mut reading, &joints, &options.locked)?;
    let moving = dynamics::build(&mut reading, &links, &joints, &arranged, &locks, options)?;

    let Reading { mut notices, ignored, .. } = reading;
    let items = ignored.into_items(|offset| source.line_column(offset).0);
    if !items.is_empty() {
        notices.push(Notice { source: source.clone(), span: None, kind: NoticeKind::Ignored { items } });
    }
    // Stable, and those without a place last.
    notices.sort_by_key(|notice| notice.span.as_ref().map_or(usize::MAX, |span| span.start));
    let links: Vec<String> = arranged.iter().map(|held| links[held.link].name.clone()).collect();
    let base = links.first().cloned().unwrap_or_default();
    let Moving { robot, kinds, coulomb, bodies, held_mass_kg, anchors } = moving;
    Ok(UrdfRobot { name, robot, base, kinds, coulomb, bodies, held_mass_kg, links, anchors, notices })
}

fn read_robot(
    reading: &mut Reading<'_>,
    root: &Element<'_>,
    options: &UrdfOptions,
) -> Result<(String, Vec<Link>, Vec<joint::Joint>), UrdfError> {
    root.refuse_xacro(reading)?;
    if root.name() != "robot" {
        return Err(reading.error(root.span(), UrdfProblem::NotARobot { found: root.name().to_owned() }));
    }
    let name = root.required_text(reading, "name", "robot");
    let name = reading.noted(name).map_or_else(String::new, |name| name.value.to_owned());
    root.only_attributes(reading, &["name", "version"]);
    let (mut links, mut joints) = (Vec::new(), Vec::new());
    for element in root.children(reading)? {
        match element.name() {
            "link" => links.push(link::read_link(reading, element)?),
            "joint" => {
                let is_locked = |joint: &str| options.locked.iter().any(|(name, _)| name == joint);
                joints.push(joint::read_joint(reading, element, is_locked)?);
            }
            _ => element.ignore(reading, &["link", "joint"], |name| match name {
                "material" => Some(Reason::Shape),
                "transmission" => Some(Reason::Transmission),
                "sensor" => Some(Reason::Sensor),
                "gazebo" | "mujoco" | "ros2_control" => Some(Reason::Simulator),
                _ => None,
            }),
        }
    }
    Ok((name, links, joints))
}
