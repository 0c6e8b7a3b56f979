//! What is known of the dynamics of robots for all postures: Property 1 by a bound, and whether C and g are bounded.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use forwardstep_core::robot::tree::JointKind;
use forwardstep_core::robot::{Definiteness, InertiaBound};
use forwardstep_sim::{AgentSetup, Attachments, AxisUnit, Robot, RobotSetup, Setup};

use crate::hypothesis::{Hypothesis, Id, InertiaUnit, Named, RobotEvidence};
use crate::practical::{FastestDamping, fastest_damping_of};

/// Whether M(q) is uniformly positive definite, of robots that many agents may share.
#[derive(Default)]
pub(crate) struct Inertias {
    models: Vec<Arc<dyn Robot>>,
    /// By the number of the model and by the bits of ϑ.
    known: BTreeMap<(usize, Vec<u64>), Rc<Definiteness>>,
}

impl Inertias {
    /// That of a robot; `None` for one of which nothing is known here.
    pub(crate) fn of(&mut self, robot: &RobotSetup) -> Option<Rc<Definiteness>> {
        let own = robot.kind.lagrangian()?;
        let model = self.models.iter().position(|model| own.same_model(&**model)).unwrap_or_else(|| {
            self.models.push(Arc::clone(&robot.kind));
            self.models.len() - 1
        });
        let key = (model, robot.theta.iter().map(|entry| entry.to_bits()).collect::<Vec<_>>());
        if let Some(found) = self.known.get(&key) {
            return Some(Rc::clone(found));
        }
        let found = Rc::new(own.definiteness(&robot.theta)?);
        self.known.insert(key, Rc::clone(&found));
        Some(found)
    }

    /// The bound, where there is one.
    pub(crate) fn bound<T>(&mut self, robot: &RobotSetup, with: impl FnOnce(&InertiaBound) -> Option<T>) -> Option<T> {
        match &*self.of(robot)? {
            Definiteness::Uniform(bound) => with(bound),
            Definiteness::Not { .. } | Definiteness::Unknown { .. } => None,
        }
    }
}

fn unit(robot: &RobotSetup) -> InertiaUnit {
    let slides: Vec<bool> = match robot.interface().attachments {
        Attachments::Links(tree) => tree.joint_kinds().map(|kind| kind == JointKind::Prismatic).collect(),
        Attachments::Axes
        | Attachments::PlanarTip
        | Attachments::AxesAndBody
        | Attachments::Body
        | Attachments::Equations(_) => robot.axes.iter().map(|axis| axis.unit == AxisUnit::Metre).collect(),
    };
    match (slides.contains(&true), slides.contains(&false)) {
        (false, _) => InertiaUnit::Turning,
        (true, false) => InertiaUnit::Sliding,
        (true, true) => InertiaUnit::Mixed,
    }
}

/// Property 1 of the robots of these agents: one line for all whose inertias have the same unit, with the smallest bound; those
/// that have none each have their own reason.
pub(crate) fn uniform_inertia(setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
    let mut inertias = Inertias::default();
    let mut least: BTreeMap<InertiaUnit, (usize, f64, usize)> = BTreeMap::new();
    let (mut unknown, mut hypotheses) = (Vec::new(), Vec::new());
    for &agent in agents {
        let robot = &setup.agents[agent].robot;
        let Some(found) = inertias.of(robot) else { continue };
        match &*found {
            Definiteness::Uniform(bound) => {
                let (whose, smallest, count) = least.entry(unit(robot)).or_insert((agent, f64::INFINITY, 0));
                *count += 1;
                if bound.least() < *smallest {
                    (*whose, *smallest) = (agent, bound.least());
                }
            }
            Definiteness::Unknown { q, least } => unknown.push((agent, q.clone(), *least)),
            Definiteness::Not { q, direction } => {
                let agent = Named::of(setup, agent);
                let evidence = RobotEvidence::SingularInertia { agent, q: q.clone(), direction: direction.clone() };
                hypotheses.push(Hypothesis::new(Id::UniformInertia, evidence));
            }
        }
    }
    let fastest = fastest_damping_of(setup, agents, &mut inertias);
    for (unit, (agent, least, agents)) in least {
        let damping = fastest.filter(|found| self::unit(&setup.agents[found.agent].robot) == unit);
        let evidence = RobotEvidence::UniformInertia {
            least,
            unit,
            agent: Named::of(setup, agent),
            agents,
            damping: damping.map(|found: FastestDamping| (Named::of(setup, found.agent), found)),
        };
        hypotheses.push(Hypothesis::new(Id::UniformInertia, evidence));
    }
    let first = unknown.first().cloned();
    hypotheses.extend(first.map(|(_, q, least)| {
        let agents: Vec<usize> = unknown.iter().map(|(agent, ..)| *agent).collect();
        let evidence = RobotEvidence::UnknownInertia { agents: Named::all(setup, &agents), q, least };
        Hypothesis::new(Id::UniformInertia, evidence)
    }));
    hypotheses
}

/// Whether C(q, q̇) and g(q) of the robots of these agents are bounded independent of q; nothing where none is known here.
pub(crate) fn bounded_dynamics(setup: &Setup, agents: &[usize]) -> Option<Hypothesis> {
    let known: Vec<usize> = agents.iter().copied().filter(|agent| is_known(&setup.agents[*agent])).collect();
    let swung = known.iter().map(|agent| (*agent, swung(&setup.agents[*agent])));
    let swung: Vec<(usize, Vec<usize>)> = swung.filter(|(_, joints)| !joints.is_empty()).collect();
    // Those whose limits end no run come first.
    let kept = |agent: usize, joint: usize| {
        let own = &setup.agents[agent];
        let limits = own.robot.axes.get(joint).and_then(|axis| axis.position_limits);
        limits.filter(|limits| own.enforce_limits && limits.iter().all(|limit| limit.is_finite()))
    };
    let all = || swung.iter().flat_map(|(agent, joints)| joints.iter().map(|joint| (*agent, *joint)));
    let worst = all().find(|(agent, joint)| kept(*agent, *joint).is_none()).or_else(|| all().next());
    let evidence = match worst {
        None => {
            let sliding = known.iter().any(|agent| slides_behind_turns(&setup.agents[*agent]));
            RobotEvidence::BoundedDynamics { sliding }
        }
        Some((agent, joint)) => RobotEvidence::Swung {
            agents: Named::all(setup, &swung.iter().map(|(agent, _)| *agent).collect::<Vec<_>>()),
            joint: setup.agents[agent].robot.axes.get(joint).map_or_else(String::new, |axis| axis.name.clone()),
            limits: kept(agent, joint),
        },
    };
    (!known.is_empty()).then(|| Hypothesis::new(Id::BoundedDynamics, evidence))
}

/// Whether the robot of an agent is one of which tests here show the three properties of Section II-B.
pub(crate) fn is_known(agent: &AgentSetup) -> bool {
    agent.robot.kind.lagrangian().is_some_and(|robot| robot.swung_axes().is_some())
}

/// Whether M, C and g of such a robot are bounded for all q.
pub(crate) fn bounded_anywhere(agent: &AgentSetup) -> bool {
    is_known(agent) && swung(agent).is_empty()
}

fn swung(agent: &AgentSetup) -> Vec<usize> {
    agent.robot.kind.lagrangian().and_then(|robot| robot.swung_axes()).unwrap_or_default()
}

/// Whether directions had to be compared to know that no joint is swung: those of a tree.
fn slides_behind_turns(agent: &AgentSetup) -> bool {
    let robot = agent.robot.interface();
    let of_links = matches!(robot.attachments, Attachments::Links(_));
    of_links && unit(&agent.robot) == InertiaUnit::Mixed && swung(agent).is_empty()
}
