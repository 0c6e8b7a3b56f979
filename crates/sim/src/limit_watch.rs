//! Whether a joint leaves position limits that are enforced, wherever rows are.

use crate::closed_loop::ClosedLoop;
use crate::engine::{Integrator, Step};
use crate::recording::{Breakdown, BreakdownCause, Signal};
use crate::setup::Setup;

/// Looks within a step: a joint that leaves its limits and comes back between two of them is not seen.
const LOOKS: u32 = 4;
/// Halvings of the time between two looks.
const HALVINGS: u32 = 50;

/// The agents whose limits are enforced.
pub(crate) struct LimitWatch {
    agents: Vec<Limited>,
    started: bool,
}

struct Limited {
    agent: usize,
    limits: Vec<Option<[f64; 2]>>,
    q: Vec<f64>,
    dq: Vec<f64>,
}

impl LimitWatch {
    pub(crate) fn new(setup: &Setup) -> Self {
        let limited = setup.agents.iter().enumerate().filter(|(_, agent)| {
            agent.enforce_limits && agent.robot.axes.iter().any(|axis| axis.position_limits.is_some())
        });
        let agents = limited.map(|(agent, own)| Limited {
            agent,
            limits: own.robot.axes.iter().map(|axis| axis.position_limits).collect(),
            q: vec![0.0; own.robot.axes.len()],
            dq: vec![0.0; own.robot.velocity_len()],
        });
        LimitWatch { agents: agents.collect(), started: false }
    }

    /// When a joint first leaves its limits within a step.
    pub(crate) fn left(
        &mut self,
        integrator: &mut Integrator<'_>,
        closed_loop: &mut ClosedLoop<'_>,
        step: Step,
    ) -> Option<Breakdown> {
        if self.agents.is_empty() {
            return None;
        }
        let first = u32::from(std::mem::replace(&mut self.started, true));
        let at = |look: u32| step.start_s + (step.end_s - step.start_s) * f64::from(look) / f64::from(LOOKS);
        let outside = (first..=LOOKS).map(at).find(|t_s| self.outside(integrator, closed_loop, *t_s).is_some())?;
        let (mut inside, mut outside) = (step.start_s, outside);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if self.outside(integrator, closed_loop, middle).is_some() { outside = middle } else { inside = middle }
        }
        self.outside(integrator, closed_loop, outside)
    }

    fn outside(
        &mut self,
        integrator: &mut Integrator<'_>,
        closed_loop: &mut ClosedLoop<'_>,
        t_s: f64,
    ) -> Option<Breakdown> {
        let x = integrator.state_at(t_s);
        self.agents.iter_mut().find_map(|Limited { agent, limits, q, dq }| {
            closed_loop.motion(*agent, t_s, x, q, dq);
            limits.iter().zip(q).enumerate().find_map(|(axis, (limits, value))| {
                let limits = limits.filter(|limits| !(limits[0]..=limits[1]).contains(value))?;
                let cause = BreakdownCause::PositionLimit { value: *value, limits };
                Some(Breakdown { t_s, agent: *agent, signal: Signal::Position, axis, cause })
            })
        })
    }
}
