//! Two controllers, each on a processor of its own, and a radio that is late, loses packets and lets them overtake each other.
//! There is no simulator: whoever calls [`Pair::tick`] makes time pass. Run it with `cargo run --example stepped`.

use std::error::Error;

use forwardstep::core::Gain;
use forwardstep::core::law::SlotineLi;
use forwardstep::core::reference::{Consensus, PositionVelocity};
use forwardstep::core::robot::PointMass;
use forwardstep::core::sampled::{BeforeFirst, Mailbox, Recipe, Sampled};

/// Time between two samples, s.
pub const PERIOD_S: f64 = 1.0 / 128.0;
/// The mass of both carts, kg.
pub const MASS_KG: f64 = 2.0;
/// Where they start, at rest, m.
pub const START_M: [f64; 2] = [0.0, 1.0];

/// How long the packet of this tick is under way, s; nothing where it is lost.
pub fn latency_s(tick: u32) -> Option<f64> {
    let periods = if tick.is_multiple_of(4) { 40.5 } else { 20.5 };
    (tick % 3 != 2).then_some(periods * PERIOD_S)
}

/// A processor: what it runs and what it has received.
struct Node {
    controller: Box<dyn Sampled>,
    mailbox: Mailbox,
}

/// A message on its way to the other node.
struct Packet {
    from: usize,
    sent_s: f64,
    arrives_s: f64,
    message: [f64; 2],
}

/// Both nodes, and what is between them.
pub struct Pair {
    nodes: [Node; 2],
    radio: Vec<Packet>,
    tick: u32,
}

impl Pair {
    /// Both know their mass, and where the other starts.
    pub fn new() -> Result<Self, Box<dyn Error>> {
        Ok(Pair { nodes: [node(START_M[1])?, node(START_M[0])?], radio: Vec::new(), tick: 0 })
    }

    /// One period: takes x and ẋ of both carts, and returns the forces to be held until the next one.
    pub fn tick(&mut self, measured: [[f64; 2]; 2]) -> Result<[f64; 2], Box<dyn Error>> {
        let now_s = f64::from(self.tick) * PERIOD_S;
        for (from, node) in self.nodes.iter().enumerate() {
            let mut message = [0.0; 2];
            node.controller.message(now_s, &measured[from], &mut message)?;
            if let Some(latency_s) = latency_s(self.tick) {
                self.radio.push(Packet { from, sent_s: now_s, arrives_s: now_s + latency_s, message });
            }
        }
        for packet in self.radio.extract_if(.., |packet| packet.arrives_s <= now_s) {
            // An older message than the one that stands changes nothing: the mailbox counts it as late.
            self.nodes[1 - packet.from].mailbox.post(now_s, 0, packet.sent_s, &packet.message)?;
        }
        for (node, measured) in self.nodes.iter_mut().zip(&measured) {
            node.controller.step(now_s, measured, node.mailbox.inbox(now_s))?;
        }
        self.tick += 1;
        Ok([0, 1].map(|k| self.nodes[k].controller.command()[0]))
    }

    /// How many packets were heard and how many came too late, by both.
    pub fn arrivals(&self) -> (u64, u64) {
        let counts = || self.nodes.iter().filter_map(|node| node.mailbox.counts(0));
        (counts().map(|count| count.heard).sum(), counts().map(|count| count.late).sum())
    }
}

/// A processor with the controller (6) led by (a1), whose neighbour starts at rest at `neighbour_m`.
fn node(neighbour_m: f64) -> Result<Node, Box<dyn Error>> {
    let reference = Consensus::<PositionVelocity>::new([(&[1.0, 2.0][..], 0.0)])?;
    let law = SlotineLi { damping: Gain::Number(8.0).resolve(1, &[])?, adaptation: None, bounds: None };
    let controller = Recipe::lagrangian(PointMass { dimension: 1 }, reference, law, vec![MASS_KG]).build()?;
    let initial = BeforeFirst::Initial { stamp_s: 0.0, message: vec![neighbour_m, 0.0] };
    let mut mailbox = Mailbox::new(controller.message_len(), vec![initial])?;
    mailbox.set_weights(&[1.0])?;
    Ok(Node { controller, mailbox })
}

/// Position and velocity after a period under a force that is held.
pub fn moved([x, v]: [f64; 2], force: f64) -> [f64; 2] {
    let a = force / MASS_KG;
    [x + PERIOD_S * (v + 0.5 * PERIOD_S * a), v + PERIOD_S * a]
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut pair = Pair::new()?;
    let mut carts = START_M.map(|x| [x, 0.0]);
    for tick in 0..=20 * 128 {
        if tick % 512 == 0 {
            println!("{:5.1} s  {:8.4} m  {:8.4} m", f64::from(tick) * PERIOD_S, carts[0][0], carts[1][0]);
        }
        let forces = pair.tick(carts)?;
        carts = [0, 1].map(|k| moved(carts[k], forces[k]));
    }
    let (heard, late) = pair.arrivals();
    println!("{heard} packets heard, {late} came too late");
    let apart = (carts[0][0] - carts[1][0]).abs();
    assert!(apart < 1e-3, "they agree, but for {apart} m");
    Ok(())
}
