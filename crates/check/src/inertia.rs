//! What is known of the dynamics of robots for all postures: Property 1 by a bound, and whether C and g are bounded.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use forwardstep_core::robot::tree::{JointKind, Tree};
use forwardstep_core::robot::{Definiteness, InertiaBound, PlanarArm, PointMass, Ship};
use forwardstep_sim::{AgentSetup, RobotSetup, Setup};

use crate::hypothesis::{Hypothesis, Id, InertiaUnit, Named, RobotEvidence};
use crate::practical::{FastestDamping, fastest_damping_of};

/// Pieces into which the turns of degenerate robots may be cut.
const PIECES: usize = 4096;

/// Whether M(q) is uniformly positive definite, of robots that many agents may share.
#[derive(Default)]
pub(crate) struct Inertias {
    /// By model and by the bits of ϑ.
    known: BTreeMap<(usize, Vec<u64>), Rc<Definiteness>>,
}

impl Inertias {
    /// That of a robot; `None` for one of which nothing is known here.
    pub(crate) fn of(&mut self, robot: &RobotSetup) -> Option<Rc<Definiteness>> {
        let kind = &robot.kind;
        // A tree by its address, which is nowhere near zero.
        let model = match kind.downcast::<Arc<Tree>>() {
            Some(tree) => Arc::as_ptr(tree) as usize,
            None if kind.is::<PlanarArm>() => 0,
            None if kind.is::<Ship>() => 1,
            None => 2,
        };
        let key = (model, robot.theta.iter().map(|entry| entry.to_bits()).collect::<Vec<_>>());
        if let Some(found) = self.known.get(&key) {
            return Some(Rc::clone(found));
        }
        let found = Rc::new(definiteness(robot)?);
        // A point mass has its dimension beside ϑ, and costs nothing.
        if model != 2 {
            self.known.insert(key, Rc::clone(&found));
        }
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

fn definiteness(robot: &RobotSetup) -> Option<Definiteness> {
    let (kind, theta) = (&robot.kind, &robot.theta[..]);
    if let Some(tree) = kind.downcast::<Arc<Tree>>() {
        tree.definiteness(theta, PIECES).ok()
    } else if let Some(arm) = kind.downcast::<PlanarArm>() {
        arm.definiteness(theta).ok()
    } else if let Some(mass) = kind.downcast::<PointMass>() {
        mass.definiteness(theta).ok()
    } else {
        kind.downcast::<Ship>()?.definiteness(theta).ok()
    }
}

fn unit(robot: &RobotSetup) -> InertiaUnit {
    let kind = &robot.kind;
    if let Some(tree) = kind.downcast::<Arc<Tree>>() {
        let slides = |kind| kind == JointKind::Prismatic;
        let (some, all) = (tree.joint_kinds().any(slides), tree.joint_kinds().all(slides));
        match (some, all) {
            (false, _) => InertiaUnit::Turning,
            (true, true) => InertiaUnit::Sliding,
            (true, false) => InertiaUnit::Mixed,
        }
    } else if kind.is::<PointMass>() {
        InertiaUnit::Sliding
    } else if kind.is::<Ship>() {
        InertiaUnit::Mixed
    } else {
        InertiaUnit::Turning
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
    let robot = &agent.robot.kind;
    robot.is::<Arc<Tree>>() || robot.is::<PlanarArm>() || robot.is::<PointMass>() || robot.is::<Ship>()
}

fn swung(agent: &AgentSetup) -> Vec<usize> {
    agent.robot.kind.downcast::<Arc<Tree>>().map_or_else(Vec::new, |tree| tree.swung_joints())
}

/// Whether directions had to be compared to know that no joint is swung.
fn slides_behind_turns(agent: &AgentSetup) -> bool {
    let tree = agent.robot.kind.downcast::<Arc<Tree>>();
    tree.is_some_and(|tree| unit(&agent.robot) == InertiaUnit::Mixed && tree.swung_joints().is_empty())
}
