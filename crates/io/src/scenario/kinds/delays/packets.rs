//! `delay.packets`: packets that are late, lost and overtaken.

use forwardstep_sim::delay::{Delay, Loss, PacketLink};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, count, seed};
use super::super::super::network::NetworkReader;
use super::super::super::network_problem::NetworkProblem;
use super::super::super::values::NotNegative;
use super::super::KindTable;
use super::{DelayKind, DelayPlan, Link, LinkDelays};

/// Packets lost one after another that a bound may allow.
const MOST_IN_A_ROW: u32 = 1_000_000;

/// A link that sends packets. What is heard is the newest message that has arrived; every edge draws its own packets.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PacketsFile {
    /// From one packet to the next, in s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub period_s: f64,
    /// When the first is sent, in s; at most `period_s`. Default: 0.
    #[serde(default)]
    #[schemars(with = "Option<NotNegative>")]
    pub first_s: f64,
    /// The least time that a packet takes, in s.
    #[schemars(range(min = 0))]
    pub latency_s: f64,
    /// Each packet takes up to this much longer, uniformly drawn, in s; beyond `period_s` packets overtake each other.
    /// Default: 0.
    #[serde(default)]
    #[schemars(with = "Option<NotNegative>")]
    pub jitter_s: f64,
    /// The same seed gives the same packets, always.
    #[schemars(range(min = 0))]
    pub seed: At<i64>,
    /// How packets are lost. Default: none is.
    pub loss: Option<LossFile>,
}

/// How packets are lost.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LossFile {
    /// Each by itself.
    Random(RandomLossFile),
    /// In bursts: the link is good or bad, and loses every packet while it is bad.
    Bursts(BurstsFile),
}

/// Packets are lost independently.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomLossFile {
    /// How likely each packet is lost.
    #[schemars(range(min = 0, max = 1))]
    pub probability: f64,
    /// No more than this are lost one after another. Default: any number may be.
    #[schemars(range(min = 1))]
    pub most_consecutive: Option<At<i64>>,
}

/// Packets are lost in bursts.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurstsFile {
    /// How likely a good link turns bad from one packet to the next.
    #[schemars(range(min = 0, max = 1))]
    pub enter: f64,
    /// How likely a bad link turns good from one packet to the next; a burst lasts 1/leave packets on average.
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1))]
    pub leave: f64,
    /// No more than this are lost one after another. Default: any number may be.
    #[schemars(range(min = 1))]
    pub most_consecutive: Option<At<i64>>,
}

impl DelayKind for PacketsFile {
    fn table() -> KindTable {
        KindTable {
            key: "packets",
            description: "Packets that are late, lost and overtaken; the newest that has arrived is heard.",
        }
    }

    fn plan(&self, _: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let (loss, most_consecutive) = match self.loss {
            None => (Loss::Never, &None),
            Some(LossFile::Random(RandomLossFile { probability, ref most_consecutive })) => {
                (Loss::Random { probability }, most_consecutive)
            }
            Some(LossFile::Bursts(BurstsFile { enter, leave, ref most_consecutive })) => {
                (Loss::Bursts { enter, leave }, most_consecutive)
            }
        };
        let most = most_consecutive.as_ref().map(|most| count("most_consecutive", most, MOST_IN_A_ROW));
        let link = PacketLink {
            every_s: self.period_s,
            first_s: self.first_s,
            latency_s: self.latency_s,
            jitter_s: self.jitter_s,
            loss,
            most_in_a_row: most.transpose()?.map(|most| most as u32),
            seed: seed(&self.seed)?,
        };
        link.check()?;
        Ok(DelayPlan::each_link(link))
    }
}

impl LinkDelays for PacketLink {
    fn stays_with_link(&self) -> bool {
        true
    }

    fn draw(&self, link: &mut Link<'_>) -> Result<Delay, Fault> {
        link.few("packets", self.packets(link.end_s))?;
        let trace = self.trace(link.agents, link.end_s);
        Ok(Delay::new(trace.map_err(|error| Fault::new(NetworkProblem::Link(error)))?))
    }
}
