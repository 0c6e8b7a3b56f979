//! Postures to look at before a run: those at the start, and points of the smallest box that holds them, in which agents of the same
//! number of axes agree. A sample, no proof.

use forwardstep_sim::Setup;

use crate::kinds::is_lagrangian;

/// Postures that are looked at in all, but the start of every agent at least, and for one agent.
const MOST: usize = 1024;
const MOST_OF_ONE: usize = 64;

/// Calls `look` with every agent of `agents`, a posture, and whether it is the start.
pub(super) fn each_posture(setup: &Setup, agents: &[usize], mut look: impl FnMut(usize, &[f64], bool)) {
    let each = (MOST / agents.len().max(1)).clamp(1, MOST_OF_ONE);
    for (number, &agent) in agents.iter().enumerate() {
        let start = &setup.agents[agent].start.q;
        look(agent, start, true);
        let hull = if each > 1 { hull(setup, start.len()) } else { Vec::new() };
        // Where all start alike there is one posture.
        if hull.iter().any(|[low, high]| low < high) {
            (1..each).for_each(|point| look(agent, &within(&hull, number * each + point), false));
        }
    }
}

/// The smallest box that holds the starts of all agents under (6)–(7) with so many axes.
fn hull(setup: &Setup, axes: usize) -> Vec<[f64; 2]> {
    let mut hull = vec![[f64::INFINITY, f64::NEG_INFINITY]; axes];
    for agent in setup.agents.iter().filter(|agent| is_lagrangian(agent) && agent.start.q.len() == axes) {
        for ([low, high], q) in hull.iter_mut().zip(&agent.start.q) {
            *low = low.min(*q);
            *high = high.max(*q);
        }
    }
    hull
}

/// A point of a box: the `index`-th of a sequence that fills it evenly, by multiples of irrational numbers.
fn within(hull: &[[f64; 2]], index: usize) -> Vec<f64> {
    let square_free = (2_u32..).filter(|number| (2..*number).all(|factor| !number.is_multiple_of(factor * factor)));
    let parts = square_free.map(|number| (index as f64 * f64::from(number).sqrt()).fract());
    hull.iter().zip(parts).map(|([low, high], part)| low + part * (high - low)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_their_box_and_stay_in_it() {
        let hull = [[-1.0, 3.0], [0.5, 0.5], [2.0, 2.25], [0.0, 1e-3]];
        let points: Vec<Vec<f64>> = (0..400).map(|index| within(&hull, index)).collect();
        for (axis, [low, high]) in hull.into_iter().enumerate() {
            for tenth in 0..10 {
                let [from, to] = [tenth, tenth + 1].map(|part| low + 0.1 * f64::from(part) * (high - low));
                let count = points.iter().filter(|point| point[axis] >= from && point[axis] <= to).count();
                assert!(count >= 30 && count <= if low < high { 50 } else { 400 }, "axis {axis}, {tenth}: {count}");
            }
        }
    }
}
