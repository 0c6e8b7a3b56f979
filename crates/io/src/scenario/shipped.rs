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
pub const SHIPPED_SCENARIOS: &[ShippedScenario] = &shipped![
    "six-arms",
    "first-order",
    "theorem-1",
    "remark-3",
    "remark-4",
    "remark-4-on-a-table",
    "teleoperation",
    "theorem-2",
    "theorem-3-a5-order-3",
    "theorem-3-24-order-4",
    "ten-different-robots",
    "backstepping",
    "from-a-log",
    "replayed-draws",
    "six-arms-over-radio",
    "six-arms-with-friction",
    "planar-arms-with-friction",
    "without-velocity",
    "double-integrators",
    "thrust-continuous",
    "theorem-4",
    "theorem-5",
    "formation",
    "gusts",
    "mixed-network",
    "through-waypoints",
    "theorem-6",
    "task-space-ur5e",
    "pose-ur5e",
    "redundant-panda",
    "theorem-7",
    "the-long-way-round",
    "tumbling-target",
    "rest-to-rest",
    "sinusoidal-attitude",
    "attitude-from-a-table",
    "theorem-8",
    "leader-over-turns",
    "leader-over-late-links",
    "vehicles-behind-a-leader",
    "theorem-9",
    "remark-12",
    "leader-by-one-vector",
    "swarm-tracking",
    "framework",
    "vector-plants",
    "desired-dynamics",
    "desired-in-z",
    "desired-in-x",
    "desired-nonlinear",
    "desired-nonlinear-arms",
    "desired-together",
    "strict-feedback",
    "strict-feedback-order-10",
    "pure-feedback",
    "immersion-and-invariance",
    "estimates-within-bounds",
    "saturated-coupling",
    "five-ships",
    "pilot-ship",
];

/// The shipped scenario of this name.
pub fn shipped_scenario(name: &str) -> Option<ShippedScenario> {
    SHIPPED_SCENARIOS.iter().find(|scenario| scenario.name == name).copied()
}

/// A table embedded in the program, which shipped scenarios name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShippedTable {
    /// Its name in scenarios.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// All of them. A file of the same name beside a scenario is read in its place.
pub const SHIPPED_TABLES: [ShippedTable; 4] = [
    ShippedTable { name: "radio-log.csv", text: include_str!("../../scenarios/radio-log.csv") },
    ShippedTable { name: "replayed-phases.csv", text: include_str!("../../scenarios/replayed-phases.csv") },
    ShippedTable { name: "replayed-holds.csv", text: include_str!("../../scenarios/replayed-holds.csv") },
    ShippedTable { name: "overflight.csv", text: include_str!("../../scenarios/overflight.csv") },
];

/// The shipped table of this name.
pub(super) fn shipped_table(name: &str) -> Option<ShippedTable> {
    SHIPPED_TABLES.into_iter().find(|table| table.name == name)
}
