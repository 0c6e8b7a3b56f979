//! A case as the text of a scenario.

use std::fmt::{self, Display, Formatter};

use super::case::{Case, Course, Design, Switching, System, Thrust};

impl Display for Case {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let number = self.number;
        writeln!(f, "format = 2\ntitle = \"Drawn case {number}\"\n")?;
        writeln!(f, "[time]\nend_s = {}\nrecord_every_s = 0.05\n", self.end_s)?;
        if self.is_led() {
            let motion = if self.course.moves() { LEADER } else { "{ waves = [] }" };
            writeln!(f, "[leader]\nmotion.sinusoids = [{}]\n", repeated(self.axes(), motion))?;
        }
        for (agent, start) in self.starts.iter().enumerate() {
            writeln!(f, "[[agents]]\nname = \"a{}\"\n{}\n{}", agent + 1, self.robot(), self.start(start))?;
            if let Course::Agree { .. } = self.course {
                writeln!(f, "reference.consensus = {{ roots_per_s = {} }}", self.roots_of(agent))?;
            }
            if let Course::Track { rate } = self.course {
                writeln!(f, "{}", self.target(rate))?;
            }
            writeln!(f)?;
        }
        writeln!(f, "{}", self.reference())?;
        writeln!(f, "{}", self.law())?;
        match self.course {
            Course::Track { .. } => Ok(()),
            Course::Agree { .. } | Course::Integral { .. } | Course::Follow { .. } => self.network(f),
        }
    }
}

/// |α q̇ + β q̈ + d³q| of it stays below 0.4 α + 0.32 β + 0.256, and so on.
const LEADER: &str = "{ waves = [{ amplitude = 0.5, rad_per_s = 0.8 }] }";

fn repeated(count: usize, text: &str) -> String {
    vec![text; count].join(", ")
}

impl Case {
    fn axes(&self) -> usize {
        match self.system {
            System::Mass(axes) => axes,
            System::Arm | System::Tip { .. } | System::PositionOnly | System::ByModel => 2,
            System::Ship | System::Vehicle(_) => 3,
            System::Chain(_) => 1,
            System::Spacecraft { .. } => 4,
        }
    }

    /// The list of roots of an agent.
    fn roots_of(&self, agent: usize) -> String {
        let real = self.roots.get(agent).into_iter().flatten().map(|root| format!("{root:?}"));
        let pair = self.pair.map(|[real, imaginary]| format!("{{ real = {real:?}, imaginary = {imaginary:?} }}"));
        format!("[{}]", real.chain(pair).collect::<Vec<_>>().join(", "))
    }

    fn robot(&self) -> String {
        const ARM: &str = "robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }";
        match self.system {
            System::Mass(axes) => format!("robot.point_mass = {{ mass_kg = 2, dimension = {axes} }}"),
            System::PositionOnly | System::ByModel => "robot.point_mass = { mass_kg = 2, dimension = 2 }".into(),
            System::Arm | System::Tip { .. } => ARM.into(),
            System::Ship => "robot.ship = { inertia = { surge_kg = 20, sway_kg = 25, yaw_kg_m2 = 3 } }".into(),
            System::Vehicle(_) => "robot.vehicle = { mass_kg = 1.5 }".into(),
            System::Chain(order) => {
                let chi = ["sin(3*x)", "-x^3 - dx*abs(dx)", "-dx*d2x + tanh(x)"][(order - 1).min(2)];
                format!("robot.chain = {{ order = {order}, chi = \"{chi}\", psi = \"2 + cos(x)\" }}")
            }
            System::Spacecraft { .. } => {
                "robot.spacecraft = { inertia_kg_m2 = [[10, 0.5, -0.3], [0.5, 8, 0.2], [-0.3, 0.2, 6]] }".into()
            }
        }
    }

    fn start(&self, at: &[f64; 3]) -> String {
        let entries = &at[..self.axes().min(3)];
        match self.system {
            System::Mass(_) | System::PositionOnly | System::ByModel | System::Chain(_) => {
                format!("start.position_m = {entries:?}")
            }
            System::Vehicle(_) => format!("start.position_m = [{}, {}, {}]", 2.0 * at[0], 2.0 * at[1], at[2] - 2.0),
            System::Arm => format!("start.position_rad = {entries:?}"),
            // Away from where it is stretched.
            System::Tip { .. } => format!("start.position_rad = [{}, {}]", 0.3 * at[0], 1.4 + 0.3 * at[1]),
            System::Ship => format!("start.position = {entries:?}"),
            System::Spacecraft { .. } => format!(
                "start.spacecraft = {{ axis = [1, 0, 1], angle_rad = {}, rate_rad_s = [0.05, 0.03, {}] }}",
                1.0 + at[0],
                0.05 * at[1]
            ),
        }
    }

    fn target(&self, rate: f64) -> String {
        // The filter is shown for targets that keep still.
        let still = self.system == (System::Spacecraft { filtered: true }) && rate < 0.8;
        let rate = if still { 0.0 } else { rate };
        let wave = |k: usize| format!("\"0.3*sin({}*t + {k})\"", rate * (1.0 + 0.3 * k as f64));
        let entries: Vec<String> = match self.system {
            System::Tip { .. } => vec![format!("\"0.8 + 0.3*cos({rate}*t)\""), format!("\"0.6 + 0.3*sin({rate}*t)\"")],
            System::Spacecraft { .. } => {
                (0..3).map(|k| format!("\"0.2*sin({rate}*t + {k})\"")).chain(["1".into()]).collect()
            }
            System::Mass(_)
            | System::Arm
            | System::Ship
            | System::PositionOnly
            | System::ByModel
            | System::Vehicle(_)
            | System::Chain(_) => (0..self.axes()).map(wave).collect(),
        };
        format!("target.formulas = [{}]", entries.join(", "))
    }

    fn reference(&self) -> String {
        let exchange = |velocities: bool| if velocities { "position_velocity" } else { "position" };
        let (roots, first) = (self.roots_of(0), self.roots.first().cloned().unwrap_or_default());
        match self.course {
            Course::Agree { velocities } => format!("[reference.consensus]\nexchange = \"{}\"\n", exchange(velocities)),
            Course::Integral { velocities } => {
                format!("[reference.pure_integral]\nroots_per_s = {roots}\nexchange = \"{}\"\n", exchange(velocities))
            }
            Course::Follow { design, margin, .. } => led(design, margin, &first),
            Course::Track { .. } if first.is_empty() => "[reference.tracking]\n".into(),
            Course::Track { .. } => format!("[reference.tracking]\nroots_per_s = {roots}\n"),
        }
    }

    fn law(&self) -> String {
        match self.system {
            System::Mass(_) | System::Arm | System::Ship if self.known => "[law.known]\ndamping.gain = 20\n".into(),
            System::Mass(_) | System::Arm | System::Ship => {
                "[law.adaptive]\ndamping.gain = 20\nadaptation_gain = 10\nestimate_start.scaled = 0.7\n".into()
            }
            System::PositionOnly => {
                "[law.position_only]\ndamping = 20\nfilter_per_s = 20\nadaptation_gain = 8\nestimate_start_kg = 1.5\n"
                    .into()
            }
            System::ByModel => {
                "[law.model_reference]\nfilter_per_s = 20\nadaptation_gain = 8\nestimate_start_kg = 1.5\n".into()
            }
            System::Vehicle(thrust) => {
                let design = match thrust {
                    Thrust::Continuous => "design = \"continuous\"",
                    Thrust::Differentiable => "design.differentiable = { damping_per_s = 3, stiffness = 4 }",
                    Thrust::Adaptive => {
                        "design.adaptive = { damping_per_s = 3, adaptation_gain = 0.2, estimate_start_kg = 1.2 }"
                    }
                    Thrust::ByAcceleration => {
                        "design.by_acceleration = { damping_per_s = 3, adaptation_gain = 0.2, estimate_start_kg = 1.2 }"
                    }
                };
                format!("[law.thrust]\n{design}\n")
            }
            System::Chain(_) => "[law.linearising]\ngain_per_s = 2\n".into(),
            System::Spacecraft { filtered: true } => {
                "[law.passivity_filter]\nerror_gain_n_m = 4\nfilter_gain_per_s = 1\ndamping = 3\n".into()
            }
            System::Spacecraft { filtered: false } => {
                "[law.attitude]\nerror_gain_per_s2 = 0.5\nrate_gain_per_s = 1.2\nfilter_gain_per_s = 1\ndamping = 3\n"
                    .into()
            }
            System::Tip { measured } => {
                let velocity = if measured { "tip_velocity = \"measured\"\n" } else { "" };
                format!(
                    "[law.task_space]\ndamping.gain = 20\nadaptation_gain = 100\ntask_gain = 20\ntorque_share = 5\n\
                     reference_gain_per_s = 3\nkinematic_gain = 1\nkinematic_start.scaled = 1.1\n{velocity}"
                )
            }
        }
    }

    fn network(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let leads = usize::from(self.is_led());
        let name = |vertex: usize| match vertex.checked_sub(leads) {
            None => "\"leader\"".into(),
            Some(agent) => format!("\"a{}\"", agent + 1),
        };
        writeln!(f, "[network]\nweight = {}\ndelay.{}", self.weight, self.delay)?;
        if let [_, _, ..] = self.phases[..] {
            match self.switching {
                Switching::Repeat => {}
                Switching::Once => writeln!(f, "switching = \"once\"")?,
                Switching::Random => writeln!(f, "switching.random = {{ seed = 5, dwell_s = [0.4, 2] }}")?,
            }
        }
        for phase in &self.phases {
            let edges: Vec<String> =
                phase.edges.iter().map(|(from, to)| edge(&name(*from), &name(*to), phase.weight)).collect();
            match self.phases.len() {
                1 => writeln!(f, "edges = [{}]", edges.join(", "))?,
                _ => writeln!(f, "\n[[network.phases]]\ndwell_s = {}\nedges = [{}]", phase.dwell_s, edges.join(", "))?,
            }
        }
        Ok(())
    }
}

fn edge(from: &str, to: &str, weight: Option<f64>) -> String {
    match weight {
        None => format!("[{from}, {to}]"),
        Some(weight) => format!("{{ from = {from}, to = {to}, weight = {weight:?} }}"),
    }
}

/// γ is `margin` times a bound of what drives the leader.
fn led(design: Design, margin: f64, roots: &[f64]) -> String {
    let [first, second] = [roots[0], roots.get(1).copied().unwrap_or(0.0)];
    let (alpha, beta) = (first * second, first + second);
    let (name, drive, more) = match design {
        Design::Continuous => ("continuous", 0.4 * first + 0.32, ""),
        Design::Differentiable => ("differentiable", 0.4 * alpha + 0.32 * beta + 0.256, ""),
        Design::WithoutAcceleration => ("without_acceleration", 0.4 * alpha + 0.32 * beta + 0.256, ""),
        Design::Swarm => ("swarm", 0.256, "coupling = 60\n"),
        Design::Composite => ("composite", 0.4 * alpha + 0.32 * beta + 0.256, ""),
        Design::Observer => ("observer", 0.4 * first + 0.32, ""),
    };
    let gain = margin * drive;
    format!(
        "[reference.leader]\ndesign = \"{name}\"\nroots_per_s = {roots:?}\ngain = {gain}\nsign_period_s = 0.002\n{more}"
    )
}
