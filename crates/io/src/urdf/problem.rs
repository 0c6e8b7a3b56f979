//! Why a URDF file is refused.

use forwardstep_core::LengthError;
use forwardstep_core::robot::tree::TreeError;
use thiserror::Error;

use super::subject::{AttributeOf, End, Named, NamedLine, Owner, Size};
use crate::wording::{did_you_mean, enumerate, more_mistakes, number, rounded};
use crate::{Meant, Problem, shown};

/// Why a URDF file, or what was asked of it, has no meaning here.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UrdfProblem {
    /// The text is not well-formed XML.
    #[error("not well-formed XML: {}", xml_detail(.error))]
    Xml {
        /// What the XML parser says.
        error: Box<roxmltree::Error>,
    },
    /// A text that is clearly something else.
    #[error("this is {meant}, and no robot")]
    Meant {
        /// What it is.
        meant: Meant,
        /// The file.
        file: String,
    },
    /// A document type declaration, through which entities could be defined.
    #[error("a document type declaration (<!DOCTYPE …>) is not accepted")]
    Doctype,
    /// The file is a template, not a robot.
    #[error("`{found}` is xacro, not URDF")]
    Xacro {
        /// The element or expression that shows it.
        found: String,
    },
    /// The outermost element is not `<robot>`.
    #[error("the outermost element is <{found}>, not <robot>")]
    NotARobot {
        /// Its name.
        found: String,
    },
    /// A file beyond any real robot.
    #[error("more than {most} {size}")]
    TooLarge {
        /// What there is too much of.
        size: Size,
        /// How many are accepted.
        most: usize,
    },
    /// A required attribute is missing.
    #[error("{attribute} is missing")]
    MissingAttribute {
        /// Which.
        attribute: Box<AttributeOf>,
    },
    /// A name that is too long, or holds more than letters.
    #[error("{attribute} is {found:?}, which does not fit into a line")]
    Name {
        /// Which.
        attribute: Box<AttributeOf>,
        /// How it begins.
        found: String,
        /// How many bytes it may have.
        most: usize,
    },
    /// A required element is missing.
    #[error("{}{owner} has no <{element}>", within(.parent))]
    MissingElement {
        /// Of whom.
        owner: Owner,
        /// The element of the owner that lacks it; `None` for the owner itself.
        parent: Option<&'static str>,
        /// Which.
        element: &'static str,
    },
    /// An element that may occur once occurs twice.
    #[error("{owner} has a second <{element}>; the first is on line {first_line}")]
    RepeatedElement {
        /// Of whom.
        owner: Owner,
        /// Which.
        element: &'static str,
        /// Where the first is.
        first_line: usize,
    },
    /// A name, reference or number is the empty string.
    #[error("{attribute} is empty")]
    Empty {
        /// Which.
        attribute: Box<AttributeOf>,
    },
    /// An attribute should be a number.
    #[error("{attribute} is `{text}`, which is not a number")]
    NotANumber {
        /// Which.
        attribute: Box<AttributeOf>,
        /// What was written.
        text: String,
    },
    /// An attribute is infinite, or not a number by name, or beyond the range of double precision.
    #[error("{attribute} is `{text}`, which is not finite")]
    NotFinite {
        /// Which.
        attribute: Box<AttributeOf>,
        /// What was written.
        text: String,
    },
    /// A vector with the wrong number of entries.
    #[error("{attribute} has {got} numbers where {need} are needed")]
    WrongCount {
        /// Which.
        attribute: Box<AttributeOf>,
        /// How many are needed.
        need: usize,
        /// How many there are.
        got: usize,
    },
    /// A quantity that cannot be negative is.
    #[error("{attribute} is {}, but must not be negative", number(*.value))]
    Negative {
        /// Which.
        attribute: Box<AttributeOf>,
        /// Its value.
        value: f64,
    },
    /// A rotation written in a way that is not read.
    #[error("<origin> of {owner} states its rotation as `quat_xyzw`")]
    Quaternion {
        /// Of whom.
        owner: Owner,
    },
    /// Two links or two joints of one name.
    #[error("a second {what} is named `{name}`; the first is on line {first_line}")]
    DuplicateName {
        /// Links or joints.
        what: Named,
        /// The name.
        name: String,
        /// Where the first is.
        first_line: usize,
    },
    /// There is no link at all.
    #[error("the robot has no links")]
    NoLinks,
    /// A joint holds, or is held by, a link that does not exist.
    #[error("joint `{joint}` names the {end} link `{link}`, which does not exist")]
    UnknownLink {
        /// The joint.
        joint: String,
        /// Which of its two.
        end: End,
        /// The missing link.
        link: String,
        /// A link of nearly that name.
        nearest: Option<String>,
    },
    /// A link is the child of two joints.
    #[error("link `{link}` is the child of joint `{joint}` and of joint {first}")]
    TwoParents {
        /// The link.
        link: String,
        /// The later joint.
        joint: String,
        /// The earlier joint.
        first: NamedLine,
    },
    /// Links that hold each other in a circle.
    #[error("the {} a loop", closing(.joints))]
    Loop {
        /// The joints on the circle.
        joints: Vec<NamedLine>,
    },
    /// More than one link is held by nothing.
    #[error("link `{link}` is held by no joint, nor is link {first}; only one link can be the base")]
    SeveralBases {
        /// The later link.
        link: String,
        /// The first link without a parent.
        first: NamedLine,
    },
    /// A joint type that URDF does not have.
    #[error("joint `{joint}` has the unknown type `{given}`")]
    UnknownJointType {
        /// The joint.
        joint: String,
        /// What was written.
        given: String,
        /// The nearest type there is.
        nearest: Option<String>,
    },
    /// A joint type with more than one degree of freedom.
    #[error("joint `{joint}` is {given}; only revolute, continuous, prismatic and fixed joints are modelled")]
    UnsupportedJointType {
        /// The joint.
        joint: String,
        /// Its type.
        given: String,
    },
    /// An axis without direction.
    #[error("the axis of joint `{joint}` is zero")]
    ZeroAxis {
        /// The joint.
        joint: String,
    },
    /// Lower limit above the upper.
    #[error("joint `{joint}` has its lower limit {} above its upper limit {}", number(*.lower), number(*.upper))]
    InvertedLimits {
        /// The joint.
        joint: String,
        /// Lower.
        lower: f64,
        /// Upper.
        upper: f64,
    },
    /// Coulomb friction, of which nothing says how to model it.
    #[error("joint `{joint}` has Coulomb friction {}, and nothing says how to model it", number(*.friction))]
    Friction {
        /// The joint.
        joint: String,
        /// In N m or N.
        friction: f64,
    },
    /// The numbers of a link are each finite but overflow when combined.
    #[error("the inertia of link `{link}` exceeds the range of double precision")]
    Overflow {
        /// The link.
        link: String,
    },
    /// The mass matrix is not positive definite.
    #[error(
        "the mass matrix is not positive definite: joint `{joint}` feels the inertia {} {unit} of `{body}` and what it \
         carries, at q = {}",
        number(rounded(*.pivot)), enumerate(.q.iter().map(|q| number(rounded(*q)).to_string()))
    )]
    NotPositiveDefinite {
        /// The outermost joint to blame.
        joint: String,
        /// The body it carries.
        body: String,
        /// The inertia it feels while the joints further out hang free, which should be positive.
        pivot: f64,
        /// The unit of `pivot`: kg m² or kg.
        unit: &'static str,
        /// Where, in rad or m.
        q: Box<[f64]>,
    },
    /// No joint moves.
    #[error("no joint moves (fixed: {fixed}, locked: {locked})")]
    NothingMoves {
        /// Fixed joints.
        fixed: usize,
        /// Locked joints.
        locked: usize,
    },
    /// A joint to be locked does not exist.
    #[error("cannot lock `{joint}`: there is no such joint")]
    LockUnknown {
        /// The name given.
        joint: String,
        /// The nearest joint that could be locked.
        nearest: Option<String>,
    },
    /// A fixed joint is to be locked.
    #[error("cannot lock `{joint}`: it is a fixed joint")]
    LockFixed {
        /// The joint.
        joint: String,
    },
    /// A joint is to be locked at two values.
    #[error("`{joint}` is locked twice, at {} and at {}", number(*.first), number(*.second))]
    LockTwice {
        /// The joint.
        joint: String,
        /// One value.
        first: f64,
        /// The other.
        second: f64,
    },
    /// A joint is to be locked at infinity or nowhere.
    #[error("cannot lock `{joint}` at {value}: a position must be finite")]
    LockNotFinite {
        /// The joint.
        joint: String,
        /// The value.
        value: f64,
    },
    /// Numbers that are each in order are not when combined, for example a lock so far out that a pose overflows.
    #[error("{}the robot cannot be built: {error}", link.as_ref().map_or_else(String::new, |link| format!("at link `{link}` ")))]
    Tree {
        /// The link that the error is about.
        link: Option<String>,
        /// What the kernels say; they number the links depth first from the base, which is 0.
        error: TreeError,
    },
    /// So many mistakes that only their number is told.
    #[error("{}", more_mistakes(*.count))]
    Further {
        /// How many more there are.
        count: usize,
    },
    /// Sizes that do not fit together: a defect of this reader.
    #[error(transparent)]
    Length(#[from] LengthError),
}

impl Problem for UrdfProblem {
    fn help(&self) -> Option<String> {
        let text = match self {
            UrdfProblem::Meant { meant, file } => meant.given_as_robot(&shown(file).to_string()),
            UrdfProblem::Xml { error } => match &**error {
                roxmltree::Error::UnknownNamespace(prefix, _) => format!(
                    "nothing with this prefix is read: take it out, or declare it as in `<robot name=\"…\" xmlns:{prefix}=\"urn:{prefix}\">`"
                ),
                _ => return None,
            },
            UrdfProblem::Doctype => "delete it; a robot needs no entities".to_owned(),
            UrdfProblem::TooLarge { size: Size::MovingJoints, .. } => {
                "make those fixed that need not move: every one costs time at every step".to_owned()
            }
            UrdfProblem::TooLarge { .. } => "no robot has so many: look whether this is the file that you mean".to_owned(),
            UrdfProblem::Xacro { .. } => "expand with xacro first: `xacro robot.urdf.xacro > robot.urdf`".to_owned(),
            UrdfProblem::NotARobot { .. } => "only URDF is read; convert SDF, MJCF or COLLADA to URDF first".to_owned(),
            UrdfProblem::Name { most, .. } => {
                format!("names are one line of at most {most} bytes without control characters")
            }
            UrdfProblem::MissingElement { element: "inertia", .. } => {
                "a mass needs its rotational inertia about the centre of mass; for a point mass write zeros".to_owned()
            }
            UrdfProblem::NotFinite { attribute, .. } if attribute.element == "limit" => {
                format!("leave `{}` out when there is no limit", attribute.attribute)
            }
            UrdfProblem::Quaternion { .. } => "state it as `rpy`, roll, pitch and yaw in rad".to_owned(),
            UrdfProblem::UnknownLink { nearest, .. }
            | UrdfProblem::UnknownJointType { nearest, .. }
            | UrdfProblem::LockUnknown { nearest, .. } => return did_you_mean(nearest.as_deref()),
            UrdfProblem::TwoParents { .. } | UrdfProblem::Loop { .. } => {
                "closed loops are not modelled; cut the loop by removing one joint".to_owned()
            }
            UrdfProblem::SeveralBases { .. } => "hold the other one by a fixed joint".to_owned(),
            UrdfProblem::UnsupportedJointType { given, .. } => match given.as_str() {
                "floating" => "only robots on a fixed base are modelled; make the joint fixed, or take a kind that moves freely: `robot.vehicle`, \
                               `robot.rotorcraft`, `robot.spacecraft` or `robot.ship`"
                    .to_owned(),
                "planar" => "write it as two prismatic joints and a revolute one, through light links".to_owned(),
                _ => "write it as three revolute joints whose axes meet, through light links".to_owned(),
            },
            UrdfProblem::Friction { .. } => {
                "in the scenario set `friction.dry = {}` or `friction.smooth = {}` to have it in robot and law, or `friction = \"ignore\"` to leave it out"
                    .to_owned()
            }
            UrdfProblem::NotPositiveDefinite { .. } => {
                "give the body mass and inertia that resist its joint, state the `armature` of the joints in the scenario, or lock the joint".to_owned()
            }
            UrdfProblem::NoLinks => "a robot is a tree of links, the outermost elements <link name=\"…\">, that joints hold together".to_owned(),
            UrdfProblem::NothingMoves { locked: 0, .. } => {
                "give a joint the type `revolute`, `continuous` or `prismatic`; what never moves has nothing to control".to_owned()
            }
            UrdfProblem::NothingMoves { .. } => "leave a joint unlocked; what never moves has nothing to control".to_owned(),
            UrdfProblem::LockFixed { .. } => "leave it out: it does not move anyway".to_owned(),
            _ => return None,
        };
        Some(text)
    }
}

/// The parser's message without its position, which the error states already.
fn xml_detail(error: &roxmltree::Error) -> String {
    let text = error.to_string();
    let place = format!(" at {}", error.pos());
    text.replacen(&place, "", 1)
}

/// "<inertial> of ", or nothing.
fn within(parent: &Option<&'static str>) -> String {
    parent.map_or_else(String::new, |parent| format!("<{parent}> of "))
}

/// "joints `a` and `b` close", "joint `a` closes".
fn closing(joints: &[NamedLine]) -> String {
    let list = enumerate(joints.iter().map(ToString::to_string));
    if joints.len() == 1 { format!("joint {list} closes") } else { format!("joints {list} close") }
}
