//! The robots of a population with their tracking laws, worked on in packs.
//!
//! A pack is as many neighbouring members as the scalar `S` has lanes; the bits do not depend on how many that is. Which
//! reference the robots follow is not known here.

use std::ops::Range;

use forwardstep_core::law::{ParameterBounds, SlotineLi, SlotineLiOutput};
use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_core::sampled::Recipe;
use forwardstep_core::{InverseQuadratic, Kernel, LengthError, Packed, ResolvedGain};

use super::gain_rates::gain_rates;
use crate::recording::GainRates;
use crate::reference::Dynamics;

/// One agent of a population.
#[derive(Debug)]
pub(crate) struct Member {
    /// Index among all agents.
    pub(crate) agent: usize,
    /// m.
    pub(crate) axes: usize,
    /// The true ϑ.
    pub(crate) theta: Vec<f64>,
    /// Its law.
    pub(crate) law: SlotineLi,
    /// xᵀ Γ⁻¹ x, when ϑ is adapted.
    pub(crate) estimate_cost: Option<InverseQuadratic>,
    /// Torque limits to be enforced, one entry per axis.
    pub(crate) effort_limits: Option<Vec<f64>>,
}

/// Where the parts of a block begin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    /// Agents, axes, parameters.
    pub(crate) n: usize,
    pub(crate) m: usize,
    pub(crate) p: usize,
    /// First entries.
    pub(crate) dq: usize,
    pub(crate) reference: usize,
    pub(crate) theta_hat: usize,
    pub(crate) balance: usize,
    pub(crate) len: usize,
    pub(crate) adaptive: bool,
    pub(crate) balances: bool,
}

impl Layout {
    /// For `vectors` blocks of reference state.
    pub(crate) fn new([n, m, p, vectors]: [usize; 4], adaptive: bool, balances: bool) -> Self {
        let (dq, reference) = (m * n, 2 * m * n);
        let theta_hat = reference + vectors * m * n;
        let balance = theta_hat + if adaptive { p * n } else { 0 };
        let len = balance + if balances { n } else { 0 };
        Layout { n, m, p, dq, reference, theta_hat, balance, len, adaptive, balances }
    }

    /// Numbers of one vector of every member.
    pub(crate) fn block(&self) -> usize {
        self.m * self.n
    }
}

/// The robots of a population, whatever they are and however many are worked on at a time.
pub(crate) trait Robots {
    /// Number of packs.
    fn packs(&self) -> usize;
    /// The members of a pack.
    fn members(&self, pack: usize) -> Range<usize>;
    /// The rates of q̇, ϑ̂ and the balance of everybody.
    fn rates(&mut self, x: &[f64], drive: Drive<'_>, dx: &mut [f64]) -> Result<(), LengthError>;
    /// What acts in one pack at one instant, for [`Robots::see`].
    fn act(&mut self, pack: usize, x: &[f64], drive: Drive<'_>) -> Result<(), LengthError>;
    /// What the last act left of the member in one lane of its pack.
    fn see(&self, lane: usize, seen: &mut Seen);
    /// M(q) with these parameters, row by row.
    fn mass_matrix(&mut self, q: &[f64], theta: &[f64], mass: &mut [f64]) -> Result<(), LengthError>;
    /// How fast its gains make a member.
    fn gain_rates(&mut self, member: &Member, motion: TwoVelocity<'_, f64>) -> Result<Option<GainRates>, LengthError>;
    /// The sampled controller of one of them.
    fn recipe(&self, reference: Dynamics, law: SlotineLi, theta_hat: Vec<f64>) -> Recipe;
}

/// One member at one instant.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    pub(crate) q: Vec<f64>,
    pub(crate) dq: Vec<f64>,
    pub(crate) z: Vec<f64>,
    pub(crate) dz: Vec<f64>,
    pub(crate) s: Vec<f64>,
    pub(crate) applied: Vec<f64>,
    pub(crate) theta_hat: Vec<f64>,
}

/// Robots `R` with their laws, worked on in lanes of `S`.
pub(crate) struct RobotBatch<R: Lagrangian<f64> + Lagrangian<S>, S: Packed> {
    robot: R,
    layout: Layout,
    processor: S::Processor,
    packs: Vec<Pack<S>>,
    work: Work<S, <R as Lagrangian<S>>::Scratch>,
    /// For one member at a time.
    alone: <R as Lagrangian<f64>>::Scratch,
}

impl<R: Lagrangian<f64> + Lagrangian<S>, S: Packed> RobotBatch<R, S> {
    /// `members` share the robot and the order; all adapt or none.
    pub(crate) fn new(robot: R, processor: S::Processor, members: &[Member], layout: Layout) -> Self {
        let packs = (0..members.len()).step_by(S::WIDTH).map(|first| Pack::new(first, members)).collect();
        let (vector, parameters) = (|| vec![S::ZERO; layout.m], || vec![S::ZERO; layout.p]);
        let work = Work {
            scratch: Lagrangian::<S>::scratch(&robot),
            q: vector(),
            dq: vector(),
            z: vector(),
            dz: vector(),
            s: vector(),
            tau: vector(),
            applied: vector(),
            external: vector(),
            net: vector(),
            ddq: vector(),
            damped: vector(),
            theta_hat: parameters(),
            yt_s: parameters(),
            d_theta_hat: parameters(),
        };
        let alone = Lagrangian::<f64>::scratch(&robot);
        RobotBatch { robot, layout, processor, packs, work, alone }
    }

    /// s, τ, q̈ (and Yᵀs, unless the torque is held) of one pack into the working memory and, if there is a `dx`, the rates
    /// of q̇, ϑ̂ and the balance into it.
    fn run(&mut self, pack: usize, x: &[f64], drive: Drive<'_>, dx: Option<&mut [f64]>) -> Result<(), LengthError> {
        S::run(self.processor, Act { robots: self, pack, x, drive, dx })
    }
}

impl<R, S> Robots for RobotBatch<R, S>
where
    R: Lagrangian<f64> + Lagrangian<S> + Clone + Send + Sync + 'static,
    S: Packed,
{
    fn packs(&self) -> usize {
        self.packs.len()
    }

    fn members(&self, pack: usize) -> Range<usize> {
        let first = self.packs[pack].first;
        first..(first + S::WIDTH).min(self.layout.n)
    }

    fn rates(&mut self, x: &[f64], drive: Drive<'_>, dx: &mut [f64]) -> Result<(), LengthError> {
        (0..self.packs.len()).try_for_each(|pack| self.run(pack, x, drive, Some(&mut *dx)))
    }

    fn act(&mut self, pack: usize, x: &[f64], drive: Drive<'_>) -> Result<(), LengthError> {
        self.run(pack, x, drive, None)
    }

    fn see(&self, lane: usize, seen: &mut Seen) {
        let w = &self.work;
        for (packs, seen) in [
            (&w.q, &mut seen.q),
            (&w.dq, &mut seen.dq),
            (&w.z, &mut seen.z),
            (&w.dz, &mut seen.dz),
            (&w.s, &mut seen.s),
            (&w.applied, &mut seen.applied),
            (&w.theta_hat, &mut seen.theta_hat),
        ] {
            seen.clear();
            seen.extend(packs.iter().map(|pack| pack.lane(lane)));
        }
    }

    fn mass_matrix(&mut self, q: &[f64], theta: &[f64], mass: &mut [f64]) -> Result<(), LengthError> {
        Lagrangian::<f64>::mass_matrix(&self.robot, &mut self.alone, q, theta, mass)
    }

    fn gain_rates(&mut self, member: &Member, motion: TwoVelocity<'_, f64>) -> Result<Option<GainRates>, LengthError> {
        gain_rates(&self.robot, &mut self.alone, member, motion)
    }

    fn recipe(&self, reference: Dynamics, law: SlotineLi, theta_hat: Vec<f64>) -> Recipe {
        recipe(self.robot.clone(), reference, law, theta_hat)
    }
}

/// The same for any number of lanes, so that it is compiled once for a robot.
fn recipe<R>(robot: R, reference: Dynamics, law: SlotineLi, theta_hat: Vec<f64>) -> Recipe
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
{
    match reference {
        Dynamics::Position(reference) => Recipe::lagrangian(robot, reference, law, theta_hat),
        Dynamics::PositionVelocity(reference) => Recipe::lagrangian(robot, reference, law, theta_hat),
        Dynamics::Estimates(reference) => Recipe::lagrangian(robot, reference, law, theta_hat),
        Dynamics::Composite(reference) => Recipe::lagrangian(robot, reference, law, theta_hat),
    }
}

/// What moves robots at one instant, as blocks of columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive<'a> {
    /// z and ż, which are states for some references and not for others.
    pub(crate) z: &'a [f64],
    pub(crate) dz: &'a [f64],
    /// The torque that sampled controllers hold; without one the law gives the torque of this instant.
    pub(crate) held: Option<&'a [f64]>,
    /// What acts from outside, if anything does.
    pub(crate) external: Option<&'a [f64]>,
}

struct Act<'a, R: Lagrangian<f64> + Lagrangian<S>, S: Packed> {
    robots: &'a mut RobotBatch<R, S>,
    pack: usize,
    x: &'a [f64],
    drive: Drive<'a>,
    dx: Option<&'a mut [f64]>,
}

impl<R: Lagrangian<f64> + Lagrangian<S>, S: Packed> Kernel for Act<'_, R, S> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let RobotBatch { robot, layout: l, packs, work, .. } = self.robots;
        let pack = &packs[self.pack];
        work.read(*l, pack.first, self.x, self.drive);
        match self.drive.held {
            None => pack.track(*l, robot, work)?,
            Some(torque) => work.hold(*l, pack.first, torque),
        }
        pack.accelerate(robot, work, self.drive.external.is_some())?;
        if let Some(dx) = self.dx {
            give(*l, pack.first, &work.ddq, &mut dx[l.dq..]);
            if self.drive.held.is_none() {
                work.learn(*l, pack, dx);
                if l.balances {
                    let dissipation = pack.dissipation(*l, robot, work)?;
                    dissipation.store(&mut dx[l.balance + pack.first..l.balance + l.n]);
                }
            }
        }
        Ok(())
    }
}

/// The constants of as many neighbouring members as `S` has lanes. Lanes beyond the last member repeat it.
struct Pack<S> {
    /// Index of the first member.
    first: usize,
    law: SlotineLi<S>,
    theta: Vec<S>,
    effort_limits: Option<Vec<S>>,
}

/// Working memory of one pack.
struct Work<S, T> {
    scratch: T,
    q: Vec<S>,
    dq: Vec<S>,
    z: Vec<S>,
    dz: Vec<S>,
    s: Vec<S>,
    tau: Vec<S>,
    applied: Vec<S>,
    /// What acts from outside, when anything does.
    external: Vec<S>,
    net: Vec<S>,
    ddq: Vec<S>,
    damped: Vec<S>,
    theta_hat: Vec<S>,
    yt_s: Vec<S>,
    d_theta_hat: Vec<S>,
}

impl<S: Packed> Pack<S> {
    fn new(first: usize, members: &[Member]) -> Self {
        let member = |lane: usize| &members[(first + lane).min(members.len() - 1)];
        let pack = |entries: fn(&Member) -> &[f64]| -> Vec<S> {
            (0..entries(member(0)).len()).map(|k| S::from_lanes(|lane| entries(member(lane))[k])).collect()
        };
        let adaptation = member(0)
            .law
            .adaptation
            .as_ref()
            .map(|own| ResolvedGain::pack(|lane| member(lane).law.adaptation.as_ref().unwrap_or(own)));
        let damping = ResolvedGain::pack(|lane| &member(lane).law.damping);
        // A member without bounds beside one with bounds has bounds that are never reached.
        let bounded = (0..S::WIDTH).any(|lane| member(lane).law.bounds.is_some());
        let anywhere = ParameterBounds::anywhere(member(0).theta.len());
        let bounds =
            bounded.then(|| ParameterBounds::pack(|lane| member(lane).law.bounds.as_ref().unwrap_or(&anywhere)));
        // A member without limits beside one with limits has limits that are never reached.
        let limit = |lane: usize, k: usize| member(lane).effort_limits.as_ref().map_or(f64::INFINITY, |l| l[k]);
        let limited = (0..S::WIDTH).any(|lane| member(lane).effort_limits.is_some());
        let axes = member(0).axes;
        Pack {
            first,
            law: SlotineLi { damping, adaptation, bounds },
            theta: pack(|member| &member.theta),
            effort_limits: limited.then(|| (0..axes).map(|k| S::from_lanes(|lane| limit(lane, k))).collect()),
        }
    }

    /// s, τ and Yᵀs of the pack whose q, q̇, z, ż and ϑ̂ are in the working memory.
    #[inline(always)]
    fn track<R: Lagrangian<S>>(&self, l: Layout, robot: &R, w: &mut Work<S, R::Scratch>) -> Result<(), LengthError> {
        let estimate = if l.adaptive { &w.theta_hat } else { &self.theta };
        let motion = TwoVelocity { q: &w.q, dq: &w.dq, z: &w.z, dz: &w.dz };
        let out = SlotineLiOutput { s: &mut w.s, tau: &mut w.tau, yt_s: &mut w.yt_s };
        self.law.output(robot, &mut w.scratch, motion, estimate, out)?;
        w.applied.copy_from_slice(&w.tau);
        if let Some(limits) = &self.effort_limits {
            for (tau, limit) in w.applied.iter_mut().zip(limits) {
                *tau = tau.saturate(*limit);
            }
        }
        Ok(())
    }

    /// q̈ under the torque that is applied and what acts from outside.
    #[inline(always)]
    fn accelerate<R: Lagrangian<S>>(
        &self,
        robot: &R,
        w: &mut Work<S, R::Scratch>,
        pushed: bool,
    ) -> Result<(), LengthError> {
        w.net.copy_from_slice(&w.applied);
        if pushed {
            for (net, external) in w.net.iter_mut().zip(&w.external) {
                *net = *net + *external;
            }
        }
        robot.forward_dynamics(&mut w.scratch, &w.q, &w.dq, &self.theta, &w.net, &mut w.ddq)
    }

    /// sᵀ(K + D)s − sᵀτ_ext. What a limit takes away from the torque acts like an external one.
    #[inline(always)]
    fn dissipation<R: Lagrangian<S>>(
        &self,
        l: Layout,
        robot: &R,
        w: &mut Work<S, R::Scratch>,
    ) -> Result<S, LengthError> {
        self.law.damping.apply(&w.s, &mut w.damped);
        for k in 0..l.m {
            let external = w.net[k] - w.tau[k];
            w.damped[k] = w.damped[k] - external;
        }
        let motion = TwoVelocity { q: &w.q, dq: &w.dq, z: &w.z, dz: &w.dz };
        robot.add_damping(&mut w.scratch, motion, &self.theta, &mut w.damped)?;
        let mut dissipation = S::ZERO;
        for k in 0..l.m {
            dissipation = w.s[k].mul_add(w.damped[k], dissipation);
        }
        if let Some(bounds) = &self.law.bounds {
            dissipation = dissipation + bounds.gained(&w.theta_hat, &self.theta, &w.yt_s);
        }
        Ok(dissipation)
    }
}

impl<S: Packed, T> Work<S, T> {
    /// Loads the members from `first` on.
    #[inline(always)]
    fn read(&mut self, l: Layout, first: usize, x: &[f64], drive: Drive<'_>) {
        take(l, first, x, &mut self.q);
        take(l, first, &x[l.dq..], &mut self.dq);
        take(l, first, drive.z, &mut self.z);
        take(l, first, drive.dz, &mut self.dz);
        if l.adaptive {
            take(l, first, &x[l.theta_hat..], &mut self.theta_hat);
        }
        if let Some(external) = drive.external {
            take(l, first, external, &mut self.external);
        }
    }

    /// Takes the torque as it is held, and s as it is now.
    #[inline(always)]
    fn hold(&mut self, l: Layout, first: usize, torque: &[f64]) {
        take(l, first, torque, &mut self.applied);
        for k in 0..l.m {
            self.s[k] = self.dq[k] - self.z[k];
        }
    }

    /// Stores ϑ̂' of `pack`; needs what [`Pack::track`] left.
    #[inline(always)]
    fn learn(&mut self, l: Layout, pack: &Pack<S>, dx: &mut [f64]) {
        if l.adaptive {
            pack.law.adaptation_rate(&self.theta_hat, &self.yt_s, &mut self.d_theta_hat);
            give(l, pack.first, &self.d_theta_hat, &mut dx[l.theta_hat..]);
        }
    }
}

/// Loads the members from `first` on out of a block of columns.
#[inline(always)]
fn take<S: Packed>(l: Layout, first: usize, columns: &[f64], out: &mut [S]) {
    for (k, out) in out.iter_mut().enumerate() {
        *out = S::load(&columns[k * l.n + first..(k + 1) * l.n]);
    }
}

/// Stores the members from `first` on into a block of columns.
#[inline(always)]
fn give<S: Packed>(l: Layout, first: usize, values: &[S], columns: &mut [f64]) {
    for (k, value) in values.iter().enumerate() {
        value.store(&mut columns[k * l.n + first..(k + 1) * l.n]);
    }
}
