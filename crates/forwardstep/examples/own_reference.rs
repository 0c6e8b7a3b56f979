//! A program of your own: `forwardstep` with reference dynamics that it does not have. Agents agree as (24) says, but each is
//! drawn home too, as if one more neighbour stood there. Scenario files name them as they name the shipped kinds:
//!
//! ```toml
//! [reference.anchored]
//! roots_per_s = [1, 2]
//! homes = [[0, 0], [1, 0], [0, 1]]
//! weight = 0.5
//! ```

use std::process::ExitCode;

use forwardstep::own::*;
use schemars::JsonSchema;
use serde::Deserialize;

/// The shipped kinds and this one.
///
/// # Errors
/// [`KindError`] when its key is taken.
pub fn kinds() -> Result<Kinds, KindError> {
    let mut kinds = Kinds::shipped();
    kinds.add_reference::<AnchoredFile>()?;
    Ok(kinds)
}

fn main() -> Result<ExitCode, KindError> {
    Ok(forwardstep::program(&kinds()?))
}

/// Agreement between agents that are drawn home.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AnchoredFile {
    /// The positive numbers κ₀, κ₁, … in 1/s. Agents may have their own.
    pub roots_per_s: Option<RootsFile>,
    /// Where each agent is drawn: a number for every axis.
    pub homes: Vec<At<Vec<At<f64>>>>,
    /// How much a home counts beside neighbours.
    pub weight: At<f64>,
}

impl ReferenceKind for AnchoredFile {
    fn table() -> ReferenceTable {
        ReferenceTable {
            key: "anchored",
            description: "Agreement between agents that are drawn home.",
            own_roots: true,
        }
    }

    fn read(&self, reader: &mut ReferenceReader<'_>) -> Result<ReferenceRead, Fault> {
        let home = |home: &At<Vec<At<f64>>>| {
            length("homes", &home.span, home.value.len(), reader.axes().len(), "each agent")?;
            Ok(home.value.iter().map(|entry| entry.value).collect())
        };
        let homes = self.homes.iter().map(home).collect::<Result<_, Fault>>()?;
        let anchored = Anchored { homes, weight: self.weight.value };
        let read = ReferenceRead::new(anchored, Exchange::Position);
        Ok(ReferenceRead { roots_per_s: self.roots_per_s.clone(), ..read })
    }
}

/// (24) with one more neighbour for every agent, who stands still.
#[derive(Clone, Debug)]
pub struct Anchored {
    /// Where that neighbour stands, agent by agent.
    pub homes: Vec<Vec<f64>>,
    /// Its weight.
    pub weight: f64,
}

impl ReferenceDynamics for Anchored {
    fn words(&self) -> ReferenceWords {
        ReferenceWords { name: "agreement with homes", key: "anchored" }
    }

    fn interface(&self) -> ReferenceInterface {
        ReferenceInterface {
            family: ReferenceFamily::Own,
            exchanges: &[Exchange::Position],
            roots: Roots::Every,
            manipulability: false,
            nonlinear_coupling: false,
        }
    }

    fn free_derivatives(&self, roots: usize) -> usize {
        roots
    }

    fn known(&self) -> Known {
        Known::Declared(Declaration {
            source: "Theorem 3 for the graph with the homes as vertices".into(),
            promises: "all agents come to rest, at one place if their homes are".into(),
            claims: vec![DeclaredClaim {
                requires: "every agent has a home that counts".into(),
                because: "there are as many homes as agents, and the weight is positive".into(),
            }],
        })
    }

    /// With αᵣ of ∏ (p + κᵣ): z^(ℓ) = −Σ αᵣ₋₁ xᵣ − w [Σ αᵣ xᵣ − α₀ home] − Σ_j w_ij [Σ αᵣ xᵣ − α₀ q_j], xᵣ being q, q̇, ż, ….
    fn linear(&self, agent: &AgentSetup, _: Exchange) -> Option<LinearReference> {
        let alpha = polynomial(&agent.roots_per_s).ok()?;
        let order = agent.roots_per_s.len();
        let terms = |of: &dyn Fn(usize) -> f64| {
            let z = (0..order).map(|k| if k == 0 { 0.0 } else { of(k + 1) });
            LinearTerms { q: vec![of(0), of(1)], z: z.collect() }
        };
        let own = terms(&|r| -self.weight * alpha[r] - if r == 0 { 0.0 } else { alpha[r - 1] });
        let coupled = terms(&|r| -alpha[r]);
        Some(LinearReference { order, own, constant: true, coupled, heard: [-alpha[0], 0.0] })
    }

    fn check(&self, setup: &Setup) -> Result<(), SetupError> {
        let (homes, agents) = (self.homes.len(), setup.agents.len());
        quantity::such(homes == agents, "reference.anchored", "homes", homes as f64, "must be as many as agents")?;
        Ok(quantity::positive("reference.anchored", "weight", self.weight)?)
    }

    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        let (setup, w) = (assembly.setup(), self.weight);
        // α₀ … α_ℓ and the home of every agent.
        let each = assembly.agents().iter().map(|agent| {
            let own = &setup.agents[*agent];
            let roots = |error| SetupError::Roots { agent: own.name.clone(), error };
            Ok((polynomial(&own.roots_per_s).map_err(roots)?, self.homes[*agent].clone()))
        });
        let each = each.collect::<Result<Vec<_>, SetupError>>()?;
        let (agents, order) = (each.len(), assembly.agent().roots_per_s.len());
        let law = move |given: AxisInput<'_, '_, Position>, asked: &mut AxisOutput<'_, '_>| {
            let (alpha, home) = &each[given.agent()];
            let x = |r: usize| match r {
                0 => given.q(),
                1 => given.dq(),
                _ => given.state(r - 1),
            };
            let d = given.degree() + w;
            let heard = given.heard_position() + w * home[given.axis()];
            let drawn = |r: usize| (if r == 0 { 0.0 } else { alpha[r - 1] } + d * alpha[r]) * x(r);
            let top = alpha[0] * heard - (0..=order).map(drawn).sum::<f64>();
            let rate = |r: usize| if r + 1 < order { given.state(r + 1) } else { top };
            (0..order).for_each(|r| asked.rate(r, rate(r)));
            asked.reference(given.state(0), rate(0));
        };
        Ok(Dynamics::position(PerAxis::new([agents, order, order], law)))
    }
}
