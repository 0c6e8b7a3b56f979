//! Scenarios that come with forwardstep.

/// A scenario embedded in the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShippedScenario {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        [$(ShippedScenario { name: $name, text: include_str!(concat!("../../scenarios/", $name, ".toml")) }),*]
    };
}

/// All of them; the first is the one to begin with.
pub const SHIPPED_SCENARIOS: [ShippedScenario; 11] = shipped![
    "six-arms",
    "first-order",
    "theorem-1",
    "remark-3",
    "remark-4",
    "teleoperation",
    "theorem-2",
    "theorem-3-a5-order-3",
    "theorem-3-24-order-4",
    "ten-different-robots",
    "backstepping",
];

/// The shipped scenario of this name.
pub fn shipped_scenario(name: &str) -> Option<ShippedScenario> {
    SHIPPED_SCENARIOS.into_iter().find(|scenario| scenario.name == name)
}
