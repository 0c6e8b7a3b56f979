//! The network in space: what each agent looks like, and the rows from which the page places it at any instant.
//!
//! Rows are taken as they were recorded, more of them where there is more motion; the page draws straight lines between them. What an arm does between
//! its joints is computed in the page from `kinematics`, once for robots that are the same.

mod kinematics;

use forwardstep_core::robot::tree::Tree;
use forwardstep_sim::busy::busy_rows;
use forwardstep_sim::leader::Leading;
use forwardstep_sim::network::Network;
use forwardstep_sim::push::{AttachmentPoint, Effect};
use forwardstep_sim::recording::Signal;
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{
    AgentSetup, Attachments, PositionKind, RotorcraftModel, Setup, SpacecraftModel, TaskSpaceLaw, TipSetup,
    VehicleModel,
};
use serde::Serialize;

use super::super::packets;
use super::super::table::Table;
use super::super::timeline::Timeline;
use super::network;
use super::single::Singles;
use crate::shapes::{Shapes, Solid};
use kinematics::{ArmScene, uniform_lengths};

/// Numbers of all rows together, four bytes each before encoding.
const ROOM: usize = 160_000;
/// Rows of each column, as far as space allows, and at least.
const MOST_ROWS: usize = 1200;
const FEWEST_ROWS: usize = 40;
/// Edges of all graphs together.
const MOST_EDGES: usize = 40_000;
/// Packets of all links together.
const MOST_PACKETS: usize = 30_000;

/// What the page draws in space.
#[derive(Serialize)]
pub(super) struct Scene {
    /// Each arm once.
    arms: Vec<ArmScene>,
    /// What links look like, each shape once.
    solids: Vec<Solid>,
    agents: Vec<AgentScene>,
    leader: Option<LeaderScene>,
    /// Of each graph the sender, the receiver and, where it is on the page, the series of the delay.
    graphs: Vec<Vec<(usize, usize, Option<usize>)>>,
    /// How many edges each has, of which not all may be on the page.
    edge_counts: Vec<usize>,
    /// What travels on links that carry packets.
    packets: Vec<Flights>,
    /// Of very many packets every so many are on the page.
    packets_every: usize,
    /// The third axis points down.
    down: bool,
}

/// What an agent looks like, and the numbers of its columns.
#[derive(Serialize)]
struct AgentScene {
    kind: Kind,
    /// Its number among the arms.
    arm: Option<usize>,
    q: Vec<usize>,
    attitude: Vec<usize>,
    thrust: Option<usize>,
    wheels: Vec<usize>,
    /// Their axes in the body.
    wheel_axes: Vec<[f64; 3]>,
    /// What is recorded of a tip, and which coordinates these are.
    tip: Vec<usize>,
    coordinates: Vec<usize>,
    /// What it is to follow: the coordinates of a tip where it has some, else those of q.
    target: Vec<usize>,
}

#[derive(Clone, Copy, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Arm,
    Ship,
    Vehicle,
    Spacecraft,
    Point,
}

/// What leads: an agent, or a motion with columns of its own.
#[derive(Serialize)]
struct LeaderScene {
    vertex: usize,
    name: String,
    q: Vec<usize>,
}

/// The packets of a link, in the order in which they were sent.
#[derive(Serialize)]
struct Flights {
    from: usize,
    to: usize,
    sent_s: Vec<f64>,
    /// None of a packet that was lost.
    took_s: Vec<Option<f64>>,
}

impl Flights {
    /// Of all links, and which part of the packets that is: every so many where there are very many.
    fn all(network: &Network, until_s: f64) -> (Vec<Flights>, usize) {
        let links = packets::links(network);
        let count: usize = links.iter().map(|(_, _, trace)| trace.packets().len()).sum();
        let every = count.div_ceil(MOST_PACKETS).max(1);
        // Digits that a run of this length can tell apart.
        let digits = 10_f64.powf((9.0 - until_s.max(1e-9).log10().ceil()).clamp(0.0, 15.0));
        let short = |t_s: f64| (t_s * digits).round() / digits;
        let flights = links.into_iter().map(|(from, to, trace)| {
            let sent = trace.packets().iter().filter(|packet| packet.send_s <= until_s).step_by(every);
            let (sent_s, took_s) = sent.map(|it| (short(it.send_s), it.delay_s.map(short))).unzip();
            Flights { from, to, sent_s, took_s }
        });
        (flights.collect(), every)
    }
}

/// Rows as they were recorded, of many some.
pub(super) struct Rows {
    pub(super) t_s: Vec<f64>,
    picks: Vec<usize>,
    pub(super) numbers: Singles,
}

impl Rows {
    fn new(rows_t_s: &[f64], columns: usize, moving: &[&[f64]]) -> Rows {
        let room = (ROOM / columns.max(1)).clamp(FEWEST_ROWS, MOST_ROWS);
        let picks = busy_rows(rows_t_s.len(), room, moving.iter().copied());
        let t_s = picks.iter().filter_map(|row| rows_t_s.get(*row).copied()).collect();
        Rows { t_s, picks, numbers: Singles::default() }
    }

    fn add(&mut self, value: impl Fn(usize, usize) -> f64) -> usize {
        let values: Vec<f64> = self.picks.iter().enumerate().map(|(k, row)| value(k, *row)).collect();
        self.numbers.add(&values)
    }

    fn column(&mut self, values: &[f64]) -> usize {
        self.add(|_, row| values.get(row).copied().unwrap_or(f64::NAN))
    }

    fn columns(&mut self, table: &Table<'_>, agent: usize, signal: Signal, entries: usize) -> Vec<usize> {
        (0..entries).map_while(|entry| table.column(agent, signal, entry)).map(|values| self.column(values)).collect()
    }

    fn motion(&mut self, trajectory: &Trajectory) -> Vec<usize> {
        let t_s = self.t_s.clone();
        let path = |path: &forwardstep_sim::trajectory::Path| self.add(|k, _| path.jet(t_s[k])[0]);
        trajectory.paths().iter().map(path).collect()
    }
}

impl Scene {
    /// Whether bodies are drawn, and not points alone.
    pub(super) fn is_solid(&self) -> bool {
        self.agents.iter().any(|agent| matches!(agent.kind, Kind::Arm | Kind::Vehicle | Kind::Spacecraft))
    }

    pub(super) fn of(
        setup: &Setup,
        table: &Table<'_>,
        timeline: &Timeline<'_>,
        shapes: Option<&Shapes>,
    ) -> (Scene, Rows) {
        let columns: usize = setup.agents.iter().map(|agent| 2 * agent.robot.axes.len() + 1).sum();
        let moving = |agent: usize| {
            let axes = setup.agents[agent].robot.axes.len();
            let (q, attitude) = ((0..axes).map(|k| (Signal::Position, k)), (0..4).map(|k| (Signal::Attitude, k)));
            q.chain(attitude).filter_map(move |(signal, entry)| table.column(agent, signal, entry))
        };
        let moving: Vec<&[f64]> = (0..setup.agents.len()).flat_map(moving).collect();
        let mut rows = Rows::new(table.t_s, columns, &moving);
        let mut arms = Vec::new();
        let agents =
            (0..setup.agents.len()).map(|agent| AgentScene::of(setup, table, agent, shapes, &mut arms, &mut rows));
        let agents: Vec<AgentScene> = agents.collect();
        let leader = setup.following().zip(setup.leader()).map(|(following, vertex)| LeaderScene {
            vertex,
            name: setup.vertex_name(vertex).to_owned(),
            q: match &following.leader {
                Leading::Motion(leader) => rows.motion(&leader.trajectory),
                Leading::Agent(_) => Vec::new(),
            },
        });
        let shown = network::shown_delays(setup, timeline);
        let series = |delay: usize| shown.iter().position(|(index, _)| *index == delay);
        let mut room = MOST_EDGES;
        let graphs = timeline.graphs.iter().map(|graph| {
            let edges: Vec<_> = graph.iter().take(room).map(|edge| (edge.from, edge.to, series(edge.delay))).collect();
            room -= edges.len();
            edges
        });
        let graphs = graphs.collect();
        let down = agents.iter().any(|agent| agent.kind == Kind::Vehicle);
        let (packets, packets_every) = Flights::all(&setup.network, table.t_s.last().copied().unwrap_or(0.0));
        let solids = shapes.map(|shapes| shapes.solids.clone()).unwrap_or_default();
        let edge_counts = timeline.graphs.iter().map(Vec::len).collect();
        (Scene { arms, solids, agents, leader, graphs, edge_counts, packets, packets_every, down }, rows)
    }
}

impl AgentScene {
    fn of(
        setup: &Setup,
        table: &Table<'_>,
        agent: usize,
        shapes: Option<&Shapes>,
        arms: &mut Vec<ArmScene>,
        rows: &mut Rows,
    ) -> AgentScene {
        let own = &setup.agents[agent];
        let (axes, kind) = (own.robot.axes.len(), &own.robot.kind);
        let law: Option<&TaskSpaceLaw> = own.law.downcast();
        let parts = shapes.map(|shapes| shapes.of(agent)).unwrap_or_default();
        let arm = arm(own).map(|arm| arm.with(parts)).map(|arm| match arms.iter().position(|known| *known == arm) {
            Some(known) => known,
            None => {
                arms.push(arm);
                arms.len() - 1
            }
        });
        let interface = own.robot.interface();
        let spacecraft: Option<&SpacecraftModel> = kind.downcast();
        let shape = if arm.is_some() {
            Kind::Arm
        } else if kind.is::<forwardstep_core::robot::Ship>() {
            Kind::Ship
        } else if kind.is::<VehicleModel>() || kind.is::<RotorcraftModel>() {
            Kind::Vehicle
        } else if interface.position == PositionKind::UnitQuaternion {
            Kind::Spacecraft
        } else {
            Kind::Point
        };
        let coordinates = match law.map(|law| &law.tip) {
            Some(TipSetup::Planar(_)) => vec![0, 2],
            Some(TipSetup::Point { coordinates, .. }) => coordinates.clone(),
            None => Vec::new(),
        };
        let follows = own.target.as_ref().filter(|_| setup.tracks(agent));
        AgentScene {
            kind: shape,
            arm,
            q: rows.columns(table, agent, Signal::Position, axes),
            attitude: rows.columns(table, agent, Signal::Attitude, 4),
            thrust: rows.columns(table, agent, Signal::Thrust, 1).first().copied(),
            wheels: rows.columns(table, agent, Signal::WheelMomentum, usize::MAX),
            wheel_axes: spacecraft.map(|it| it.wheels.list().iter().map(|it| it.axis).collect()).unwrap_or_default(),
            tip: rows.columns(table, agent, Signal::TaskPosition, coordinates.len()),
            coordinates,
            target: follows.map(|target| rows.motion(target)).unwrap_or_default(),
        }
    }
}

/// The kinematics of an agent that is an arm.
fn arm(agent: &AgentSetup) -> Option<ArmScene> {
    let law: Option<&TaskSpaceLaw> = agent.law.downcast();
    let theta = &agent.robot.theta;
    match agent.robot.interface().attachments {
        Attachments::Links(tree) => {
            let tip = match law.map(|law| &law.tip) {
                Some(TipSetup::Point { point, .. }) => {
                    point.link.body.map(|body| (body, point.link.x_body_link.point(point.at)))
                }
                _ => None,
            };
            let tree: &Tree = &tree;
            ArmScene::of_tree(tree, theta, tip.filter(|(body, _)| *body < tree.joint_count())).ok()
        }
        Attachments::PlanarTip => {
            let gripped = agent.pushes.iter().find_map(|push| match &push.effect {
                Effect::Wrench { at: AttachmentPoint::Tip(tip), .. }
                | Effect::SpringOnPoint { at: AttachmentPoint::Tip(tip), .. } => Some(tip.length_m),
                _ => None,
            });
            let length_m = match law.map(|law| &law.tip) {
                Some(TipSetup::Planar(tip)) => Some(tip.length_m),
                _ => gripped,
            };
            Some(ArmScene::planar(length_m.unwrap_or_else(|| uniform_lengths(theta))))
        }
        _ => None,
    }
}
