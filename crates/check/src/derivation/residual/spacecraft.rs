//! Spacecraft under (97)–(105), or under a filter of the attitude error: attitudes, momenta and gains at an instant.

use forwardstep_core::ResolvedGain;
use forwardstep_core::attitude::{Desired, Quaternion, cross, difference, normalized, rate_inertial, rotate_back};
use forwardstep_core::controller::Jet;
use forwardstep_core::plant::{Spacecraft, Wheels};
use forwardstep_sim::{AgentSetup, AttitudeLaw, PassivityFilterLaw, Signal, SpacecraftModel};

use super::super::case::Step;
use super::super::form::{Letter, Operator, Term};
use super::Missing;
use super::moment::{At, Vector, exact};
use super::robot::{Model, times};

/// A spacecraft and the gains of its law.
pub(super) struct Craft {
    inertia: [[f64; 3]; 3],
    plant: Spacecraft,
    /// h_I, as the law knows it from the start.
    momentum_inertial: [f64; 3],
    damping: ResolvedGain,
    filter: ResolvedGain,
}

impl Craft {
    pub(super) fn of(agent: &AgentSetup, model: &SpacecraftModel) -> Option<Craft> {
        let own = agent.law.downcast().map(|law: &AttitudeLaw| [&law.damping, &law.filter]);
        let filter = || agent.law.downcast().map(|law: &PassivityFilterLaw| [&law.damping, &law.filter]);
        let [damping, filter] = own.or_else(filter)?;
        let wheels: Wheels = model.wheels.clone();
        let plant = Spacecraft::new(model.inertia_kg_m2, wheels, false).ok()?;
        let start = &agent.start;
        let attitude = normalized(four(&start.q)?);
        let state: Vec<f64> = attitude.iter().chain(&start.dq).chain(&start.rest).copied().collect();
        Some(Craft {
            inertia: model.inertia_kg_m2,
            momentum_inertial: plant.momentum_inertial(&state).ok()?,
            plant,
            damping: damping.resolve(4, &[]).ok()?,
            filter: filter.resolve(4, &[]).ok()?,
        })
    }
}

fn four(x: &[f64]) -> Option<Quaternion> {
    x.first_chunk().copied()
}

fn three(x: &[f64]) -> Option<[f64; 3]> {
    x.first_chunk().copied()
}

fn values(vector: &Vector) -> Vec<f64> {
    vector.iter().map(|[value, _]| *value).collect()
}

/// A cross product, with the sizes of what it is made of.
fn crossed(a: [f64; 3], b: &Vector) -> Option<Vector> {
    let (value, size) = (three(&values(b))?, b.iter().map(|[_, size]| size).sum::<f64>());
    let of_a: f64 = a.iter().map(|a| a.abs()).sum();
    Some(cross(a, value).iter().map(|entry| [*entry, of_a * size]).collect())
}

fn applied(gain: &ResolvedGain, vector: &Vector) -> Vector {
    let mut out = vec![0.0; vector.len()];
    gain.apply(&values(vector), &mut out);
    let size: f64 = vector.iter().map(|[_, size]| size).sum();
    let mut column = vec![0.0; vector.len()];
    let mut largest = 0.0_f64;
    for k in 0..vector.len() {
        let mut unit = vec![0.0; vector.len()];
        unit[k] = 1.0;
        gain.apply(&unit, &mut column);
        largest = column.iter().fold(largest, |largest, entry| largest.max(entry.abs()));
    }
    out.into_iter().map(|value| [value, largest * size]).collect()
}

/// Everything about the attitude at an instant.
struct Attitude {
    q: Quaternion,
    desired: Desired,
    /// Δq* and its rate, or Δq where the law has no reference attitude.
    apart: [Quaternion; 2],
}

impl At<'_, '_> {
    fn attitude(&self) -> Option<Attitude> {
        let read = |signal, rates| four(&self.state(signal, rates)?);
        let [q, dq] = [read(Signal::Position, false)?, read(Signal::Position, true)?];
        let path: [Jet; 4] = self.target()?.first_chunk().copied()?;
        let desired = Desired::from_path(&path);
        let [q_z, dq_z] = match self.case.step {
            Step::PassivityFilter(_) => [desired.q, rate_inertial(desired.q, desired.omega)],
            _ => [read(Signal::ReferenceAttitude, false)?, read(Signal::ReferenceAttitude, true)?],
        };
        // Of norm one but for the error of the integration, which the law takes away.
        let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [q, dq] = [q, dq].map(|all| all.map(|x| x / norm));
        let (of_q, of_z) = (difference(dq, q_z), difference(q, dq_z));
        let rate = std::array::from_fn(|k| of_q[k] + of_z[k]);
        Some(Attitude { q, desired, apart: [difference(q, q_z), rate] })
    }

    fn craft(&mut self) -> Result<&Craft, Missing> {
        match self.model()? {
            Model::Spacecraft(craft) => Ok(craft),
            Model::Robot(_) | Model::Chain(_) => Err(Missing::Term),
        }
    }

    /// Δω and its rate, ω̇ − Rᵀ ω̇_d^I + S(ω) ω_d.
    pub(super) fn spacecraft_error(&self, k: usize) -> Result<Vector, Missing> {
        let Attitude { q, desired, .. } = self.attitude().ok_or(Missing::Term)?;
        let (omega, rate) = (self.position(0)?, self.position(1)?);
        let omega_d = rotate_back(q, desired.omega);
        let turned = cross(three(&omega).ok_or(Missing::Term)?, omega_d);
        let pull = rotate_back(q, desired.d_omega);
        match k {
            0 => Ok((0..3).map(|k| [omega[k] - omega_d[k], omega[k].abs() + omega_d[k].abs()]).collect()),
            1 => Ok((0..3)
                .map(|k| [rate[k] - pull[k] + turned[k], rate[k].abs() + pull[k].abs() + turned[k].abs()])
                .collect()),
            _ => Err(Missing::Derivative),
        }
    }

    pub(super) fn spacecraft_term(&mut self, term: Term, k: usize) -> Result<Vector, Missing> {
        let Attitude { q, desired, apart } = self.attitude().ok_or(Missing::Term)?;
        match (term, k) {
            (Term::DesiredRate, 0) => Ok(exact(rotate_back(q, desired.omega))),
            (Term::DesiredAcceleration, 0) => Ok(exact(rotate_back(q, desired.d_omega))),
            (Term::AttitudeError, 0) => Ok(exact(difference(q, desired.q).into_iter().take(3))),
            (Term::AttitudeDifference, 0 | 1) => Ok(exact(apart[k])),
            (Term::AttitudeErrorRate, 0 | 1) => {
                let craft = self.craft()?;
                Ok(applied(&craft.damping, &exact(apart[k])))
            }
            (Term::AttitudeDamping, 0) => {
                let dy = self.state(Signal::Filter, true).ok_or(Missing::Term)?;
                let pulled = applied(&self.craft()?.damping, &exact(dy));
                let columns = map(apart[0]);
                let column = |k: usize| {
                    let each = pulled.iter().enumerate().map(|(row, entry)| entry.map(|x| columns[row][k] * x));
                    each.fold([0.0; 2], |sum, [value, size]| [sum[0] + value, sum[1] + size.abs()])
                };
                Ok((0..3).map(column).collect())
            }
            (Term::GyroscopicPull, 0) => {
                let error = self.spacecraft_error(0)?;
                let turned = self.spacecraft_under(Operator::Gyroscopic, &error)?;
                self.spacecraft_under(Operator::Inertia, &turned)
            }
            _ => Err(Missing::Derivative),
        }
    }

    /// ω̇ with the sizes of what each motor contributes.
    pub(super) fn turned_by_wheels(&mut self) -> Result<Vector, Missing> {
        let mut rate = exact(self.position(1)?);
        let motors = self.recorded(Signal::WheelTorque).unwrap_or_default();
        let Craft { plant, inertia, .. } = self.craft()?;
        let pulls = plant.wheels().list().iter().zip(motors).map(|(wheel, motor)| wheel.axis.map(|axis| axis * motor));
        // Sizes need no more than their order of magnitude.
        let least = (0..3).map(|k| inertia[k][k]).fold(f64::INFINITY, f64::min);
        let size = pulls.flatten().map(f64::abs).sum::<f64>() / least;
        rate.iter_mut().for_each(|[_, entry]| *entry += size);
        Ok(rate)
    }

    pub(super) fn spacecraft_under(&mut self, operator: Operator, vector: &Vector) -> Result<Vector, Missing> {
        let Attitude { q, desired, apart } = self.attitude().ok_or(Missing::Term)?;
        match operator {
            Operator::Inertia => Ok(times(self.craft()?.inertia.as_flattened(), vector)),
            Operator::Filter => {
                let craft = self.craft()?;
                Ok(applied(&craft.filter, vector))
            }
            // S(v) ω_d = v × ω_d = −ω_d × v
            Operator::Gyroscopic => {
                let omega_d = rotate_back(q, desired.omega).map(|entry| -entry);
                crossed(omega_d, vector).ok_or(Missing::Term)
            }
            Operator::AttitudeMap => Ok(times(map(apart[0]).as_flattened(), vector)),
            Operator::Identity
            | Operator::Momentum
            | Operator::Coriolis
            | Operator::Damping
            | Operator::Mass
            | Operator::Viscous => Err(Missing::Term),
        }
    }

    /// S(h) of a letter: the plant has h from its wheels, the law from h_I and the attitude, and they differ by the error of the
    /// integration. Each is given its own: S(h) s is S(h) ω of the plant less S(h) z of the law, or S(h) ω_d where it has no z.
    pub(super) fn turned(&mut self, letter: Letter, k: usize) -> Result<Vector, Missing> {
        if k > 0 {
            return Err(Missing::Derivative);
        }
        let Attitude { q, desired, .. } = self.attitude().ok_or(Missing::Term)?;
        let led = match self.case.step {
            Step::PassivityFilter(_) => rotate_back(q, desired.omega).to_vec(),
            _ => self.reference(0)?,
        };
        let (omega, z) = (exact(self.position(0)?), exact(led));
        let wheels = self.state(Signal::WheelMomentum, false).unwrap_or_default();
        let state: Vec<f64> = q.iter().copied().chain(values(&omega)).chain(wheels).collect();
        let craft = self.craft()?;
        let true_h = craft.plant.momentum(&state).map_err(|_| Missing::Term)?;
        let taken = rotate_back(q, craft.momentum_inertial);
        let [of_plant, of_law] = [crossed(true_h, &omega), crossed(taken, &z)];
        match letter {
            Letter::Position => of_plant,
            Letter::Reference | Letter::Term(Term::DesiredRate) => of_law,
            _ => of_plant.zip(of_law).map(|(plant, law)| {
                plant.iter().zip(&law).map(|(plant, law)| [plant[0] - law[0], plant[1] + law[1]]).collect()
            }),
        }
        .ok_or(Missing::Term)
    }
}

/// D(Δq*) = ½ [Δq_o* I + S(Δq_v*); −Δq_v*ᵀ], row by row.
fn map([a, b, c, o]: Quaternion) -> [[f64; 3]; 4] {
    [[o, -c, b], [c, o, -a], [-b, a, o], [-a, -b, -c]].map(|row| row.map(|entry| 0.5 * entry))
}
