//! V of one agent by itself along its run, and what changed it: the parts of V̇ that its plant, its controller and its balance give.

use forwardstep_sim::{Energy, Inside, Place, Powers};

use super::{Injection, InjectionBalance, name_first};

/// V of one agent, as it goes.
pub(super) struct Tally {
    pushes_end: bool,
    start: Option<f64>,
    /// V at the end of the step before.
    before: Option<f64>,
    largest: f64,
    terms: [f64; 8],
    first: Option<(Injection, f64)>,
}

impl Tally {
    pub(super) fn new(pushes_end: bool) -> Self {
        Tally { pushes_end, start: None, before: None, largest: super::FLOOR_J, terms: [0.0; 8], first: None }
    }

    pub(super) fn balance(&self, agent: usize) -> Option<InjectionBalance> {
        Some(InjectionBalance {
            agent,
            start_j: self.start?,
            end_j: self.before?,
            largest_j: self.largest,
            terms_j: self.terms,
            first: self.first,
        })
    }

    /// `None` where nothing is known of V.
    pub(super) fn look(&mut self, Inside { t_s, place, energy, .. }: Inside<'_>) -> Option<()> {
        let Energy { value, powers } = energy?;
        match place {
            Place::Start => {
                self.start.get_or_insert(value);
                // The controller's state jumps at a sample, and V with it.
                self.terms[Injection::Held as usize] += value - self.before.unwrap_or(value);
            }
            Place::Node { weight_s } => {
                let Powers { dissipated, held, reconstructed, measured, limited, pushed } = powers;
                let parts = [
                    (Injection::Dissipated, dissipated),
                    (Injection::Held, held),
                    (Injection::Reconstructed, reconstructed),
                    (Injection::Measured, measured),
                    (Injection::Limited, limited),
                    (Injection::Pushed, pushed),
                ];
                parts.into_iter().for_each(|(part, power)| self.terms[part as usize] += weight_s * power);
            }
            Place::End => {
                self.largest = self.largest.max(value);
                self.before = Some(value);
                self.first = self.first.or_else(|| name_first(&self.terms, self.largest, self.pushes_end, t_s));
            }
        }
        Some(())
    }
}
