//! What s adds to the disagreement, and how fast it moves the posture: the bound of `power` through the gains of `gains`.
//!
//! Not from the paper, derived for this software. On an axis a, s_a² ≤ (K⁻¹)_aa sᵀKs, and the axes of a linear reference do not mix. So where
//! the mean of Σ sᵀKs is at most x² and c_a is the largest (K⁻¹)_aa of any agent, rms |s_a| ≤ x √c_a, and the gains apply axis by axis.
//! It is what s adds to the course of s ≡ 0 from the same z(0); messages of before t = 0 count as if s(0) had been there, and what noise does
//! to the reference by itself is left out. So is, where controllers sample, what that does to the reference with s ≡ 0: it holds what it hears
//! over a period, which adds errors of the order of the period for as long as agents move.

use forwardstep_sim::{AxisUnit, Setup, VelocitySensor};

use super::PracticalAnswer;
use super::gains::{NoReferenceGains, ReferenceGains};
use super::power::{PowerBound, is_fed};
use super::rates::Gains;

/// What s adds to the disagreement.
#[derive(Clone, Debug, PartialEq)]
pub struct AgreementBound {
    /// What the reference makes of s.
    pub gains: Result<ReferenceGains, NoReferenceGains>,
    /// The axes with the smallest and the largest bound; `None` where how large s is cannot be told before the run.
    pub axes: Option<[AxisBound; 2]>,
    /// Whether something besides the start and pushes is in the bound, so that it is one to be expected.
    pub expected: bool,
    /// Whether controllers sample, and with them the references.
    pub sampled: bool,
    /// Whether positions are read with noise or in steps, which references hear whatever s is.
    pub inexact: bool,
    /// Whether velocities are measured under digital control, so that an error of them may stay.
    pub measured: bool,
}

/// The bounds on one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisBound {
    /// Its name.
    pub name: String,
    /// rad, m, or nothing.
    pub unit: &'static str,
    /// The root mean square of |s| over all agents, in its unit per s.
    pub tracking: f64,
    /// That of the largest difference that s adds, in its unit.
    pub disagreement: f64,
    /// How fast the posture moves on the average, in its unit per s.
    pub drift: f64,
}

impl AgreementBound {
    /// Of a setup in which something besides its start feeds s; `power` is what is known of s. `None` where there is nothing to be said: all
    /// follow targets of their own, or one is alone.
    pub(super) fn of(setup: &Setup, power: Option<&PowerBound>) -> Option<AgreementBound> {
        if !is_fed(setup) || setup.agents.len() < 2 || setup.all_track() {
            return None;
        }
        let gains = ReferenceGains::of(setup);
        let axes = match (&gains, power) {
            (Ok(gains), Some(power)) => axes(setup, gains, power),
            (Ok(_) | Err(_), Some(_) | None) => None,
        };
        let sensors = setup.control.as_ref().map(|control| &control.sensors);
        Some(AgreementBound {
            gains,
            axes,
            expected: power.is_some_and(PowerBound::is_expected),
            sampled: setup.control.is_some(),
            inexact: sensors.is_some_and(|sensors| sensors.position_noise > 0.0 || sensors.position_quantum > 0.0),
            measured: sensors.is_some_and(|sensors| sensors.velocity == VelocitySensor::Measured),
        })
    }

    /// A bound where there are gains.
    pub fn answer(&self) -> PracticalAnswer {
        if self.gains.is_ok() { PracticalAnswer::Bound } else { PracticalAnswer::NotShown }
    }

    /// The numbers in it, by stable names.
    pub(super) fn numbers(&self) -> Vec<(&'static str, f64)> {
        let Ok(gains) = &self.gains else { return Vec::new() };
        let mut numbers = vec![
            ("peak_gain_s", gains.peak_s),
            ("rms_gain_s", gains.rms_s),
            ("drift_gain", gains.drift_peak),
            ("drift_rms_gain", gains.drift_rms),
        ];
        numbers.extend(gains.bias.map(|bias| ("drift_by_velocity_error", bias)));
        if let Some([least, most]) = &self.axes {
            numbers.extend([
                ("rms_tracking", most.tracking),
                ("rms_disagreement", most.disagreement),
                ("least_rms_disagreement", least.disagreement),
                ("drift_per_s", most.drift),
            ]);
        }
        numbers
    }
}

/// The axes with the smallest and the largest bound.
fn axes(setup: &Setup, gains: &ReferenceGains, power: &PowerBound) -> Option<[AxisBound; 2]> {
    let first = setup.agents.first()?;
    let mut largest = vec![0.0_f64; first.robot.axes.len()];
    for agent in &setup.agents {
        // Of what is no robot under (6)–(7) `power` says nothing.
        let compliance = Gains::of(agent)?.damping.cholesky()?.inverse();
        if compliance.nrows() != largest.len() {
            return None;
        }
        largest.iter_mut().enumerate().for_each(|(axis, largest)| *largest = largest.max(compliance[(axis, axis)]));
    }
    let bounds = first.robot.axes.iter().zip(largest).map(|(axis, compliance)| {
        let tracking = (power.mean_w * compliance).sqrt();
        AxisBound {
            name: axis.name.clone(),
            unit: match axis.unit {
                AxisUnit::Radian => " rad",
                AxisUnit::Metre => " m",
                AxisUnit::One | AxisUnit::Own => "",
            },
            tracking,
            disagreement: gains.rms_s * tracking,
            drift: gains.drift_rms * tracking,
        }
    });
    let mut bounds: Vec<AxisBound> = bounds.collect();
    bounds.sort_by(|a, b| a.tracking.total_cmp(&b.tracking));
    let finite = bounds.iter().all(|bound| bound.disagreement.is_finite());
    Some([bounds.first()?.clone(), bounds.last()?.clone()]).filter(|_| finite)
}
