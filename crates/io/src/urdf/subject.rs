//! What a message is about: a link, a joint, an attribute of one of their elements.

use std::fmt;

/// What an element belongs to, for messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Owner {
    /// The robot itself.
    Robot,
    /// A link, by its name.
    Link(String),
    /// A joint, by its name.
    Joint(String),
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Owner::Robot => write!(f, "the robot"),
            Owner::Link(name) => write!(f, "link `{name}`"),
            Owner::Joint(name) => write!(f, "joint `{name}`"),
        }
    }
}

/// An attribute of an element of a link or joint, for messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AttributeOf {
    /// The attribute's name.
    pub attribute: &'static str,
    /// The element's name.
    pub element: &'static str,
    /// Whose element it is.
    pub owner: Option<Owner>,
}

impl fmt::Display for AttributeOf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` of ", self.attribute)?;
        match (&self.owner, self.element) {
            (Some(Owner::Robot) | None, element) => write!(f, "<{element}>"),
            (Some(owner @ Owner::Link(_)), "link") | (Some(owner @ Owner::Joint(_)), "joint") => write!(f, "{owner}"),
            (Some(owner), element) => write!(f, "<{element}> of {owner}"),
        }
    }
}

/// What two things of one name are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    /// Links.
    Link,
    /// Joints.
    Joint,
}

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Named::Link => "link",
            Named::Joint => "joint",
        })
    }
}

/// The two links that a joint connects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The link that holds the joint.
    Parent,
    /// The link that the joint moves.
    Child,
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            End::Parent => "parent",
            End::Child => "child",
        })
    }
}

/// Something with a name, and the line of the file it stands on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedLine {
    /// Its name.
    pub name: String,
    /// Its line, from one.
    pub line: usize,
}

impl fmt::Display for NamedLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` (line {})", self.name, self.line)
    }
}

/// Which bound on the size of a file is exceeded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Bytes of text.
    Bytes,
    /// XML nodes.
    Nodes,
    /// Namespace declarations.
    Namespaces,
    /// Attributes of one element.
    Attributes,
    /// Joints that move.
    MovingJoints,
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Size::Bytes => "bytes",
            Size::Nodes => "XML nodes",
            Size::Namespaces => "namespace declarations",
            Size::Attributes => "attributes of one element",
            Size::MovingJoints => "moving joints",
        })
    }
}
