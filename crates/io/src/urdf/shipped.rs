//! Robots that come with forwardstep.

/// The robots that [`shipped_robot`] knows, with their files.
pub const SHIPPED_ROBOTS: [(&str, &str); 3] = [
    ("ur5e", include_str!("../../robots/ur5e.urdf")),
    ("panda", include_str!("../../robots/panda.urdf")),
    ("gantry", include_str!("../../robots/gantry.urdf")),
];

/// The URDF text of a shipped robot: `ur5e` or `panda`, written from published numbers, or `gantry`, made up; `None` for any
/// other name.
/// The suffix `.urdf` may be given.
pub fn shipped_robot(name: &str) -> Option<&'static str> {
    let stem = name.strip_suffix(".urdf").unwrap_or(name);
    SHIPPED_ROBOTS.iter().find(|(known, _)| *known == stem).map(|(_, text)| *text)
}
