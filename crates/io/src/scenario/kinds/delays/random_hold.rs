//! `delay.random_hold`: random values, each held for a random time.

use forwardstep_sim::delay::{Delay, RandomHold};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, seed};
use super::super::super::network::NetworkReader;
use super::super::super::values::{NotNegative, Positive};
use super::super::KindTable;
use super::{DelayKind, DelayPlan, Link, LinkDelays};

/// A delay that takes a new value after a random time. Every edge draws its own.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomHoldFile {
    /// The same seed gives the same delays, always.
    #[schemars(range(min = 0))]
    seed: At<i64>,
    /// Least and largest value, in s.
    #[schemars(with = "[NotNegative; 2]")]
    value_s: [f64; 2],
    /// Shortest and longest time for which a value is held, in s.
    #[schemars(with = "[Positive; 2]")]
    hold_s: [f64; 2],
}

impl DelayKind for RandomHoldFile {
    fn table() -> KindTable {
        KindTable { key: "random_hold", description: "Random values, each held for a random time." }
    }

    fn plan(&self, _: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let (value_s, hold_s) = (self.value_s, self.hold_s);
        RandomHold::check(value_s, hold_s)?;
        Ok(DelayPlan::each_link(Holds { seed: seed(&self.seed)?, value_s, hold_s }))
    }
}

/// Random holds with a seed of their own.
#[derive(Clone, Debug, PartialEq)]
struct Holds {
    seed: u64,
    value_s: [f64; 2],
    hold_s: [f64; 2],
}

impl LinkDelays for Holds {
    fn stays_with_link(&self) -> bool {
        false
    }

    fn draw(&self, link: &mut Link<'_>) -> Result<Delay, Fault> {
        let Holds { seed, value_s, hold_s } = *self;
        link.few("jumps of the delay", 2.0 * link.end_s / (hold_s[0] + hold_s[1]))?;
        Ok(Delay::new(RandomHold::draw(seed, link.agents, value_s, hold_s, link.end_s)?))
    }
}
