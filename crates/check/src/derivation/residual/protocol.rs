//! A nonlinear protocol at an instant: f of what 𝒵 has for its arguments.

use forwardstep_core::reference::WrittenIn;

use super::super::case::Led;
use super::Missing;
use super::moment::{At, Vector, exact};

impl At<'_, '_> {
    pub(super) fn protocol(&self) -> Result<Vector, Missing> {
        let Led::Desired(desired) = &self.case.led else { return Err(Missing::Term) };
        let protocol = desired.protocol.as_ref().ok_or(Missing::Term)?;
        let (order, plant) = (desired.polynomial.order(), self.case.step.plant());
        let from = match desired.written {
            WrittenIn::Measured => plant,
            WrittenIn::Z => plant.saturating_sub(1),
            WrittenIn::X => return Err(Missing::Term),
        };
        let written =
            |r: usize| if r < from { self.position(r) } else { self.reference((r + 1).saturating_sub(plant)) };
        let mut variables = (0..order).map(written).collect::<Result<Vec<_>, _>>()?;
        let axes = self.position(0)?.len();
        variables.push(self.moment.sums.get(..axes).ok_or(Missing::Neighbour)?.to_vec());
        variables.push(vec![self.moment.degree; axes]);
        if desired.follows_target {
            let target = self.case.setup.agents[self.moment.agent].target.as_ref();
            for k in 0..=order {
                variables.push(self.jet(target, k)?.into_iter().map(|[value, _]| value).collect());
            }
        }
        variables.push(vec![self.moment.t_s; axes]);
        let of_axis = |axis: usize| {
            let given: Option<Vec<f64>> = variables.iter().map(|variable| variable.get(axis).copied()).collect();
            given.map(|given| protocol.term.value(&given)).ok_or(Missing::Term)
        };
        Ok(exact((0..axes).map(of_axis).collect::<Result<Vec<_>, _>>()?))
    }
}
