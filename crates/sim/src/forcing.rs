//! What enters a run as functions of time: pushes, targets and offsets, a leader, weights, delays, and what depends on t alone within
//! a nonlinear protocol.

use forwardstep_core::expression::{Expression, Step};

use crate::engine::{Forcing, Shape};
use crate::formula::{BoundedFormula, kinks_s};
use crate::push::{Course, Function};
use crate::reference::Desired;
use crate::setup::{Method, Setup};
use crate::trajectory::{Path, Trajectory};

/// All of them, once each. Digital controllers see their targets and the network at samples, so that pushes alone act within a step.
pub(crate) fn forcing(setup: &Setup) -> Forcing {
    let mut found = Found { shapes: Vec::new(), end_s: setup.time.end_s };
    for agent in &setup.agents {
        for push in &agent.pushes {
            if let Course::Each(functions) = push.course() {
                let formulas = functions.iter().filter_map(|function| match function {
                    Function::Constant(_) => None,
                    Function::Formula(formula) => Some(formula),
                });
                formulas.for_each(|formula| found.formula(formula, push.span_s()));
            }
        }
    }
    if setup.control.is_none() {
        let targets = setup.agents.iter().filter_map(|agent| agent.target.as_ref());
        let leader = setup.following().and_then(|following| following.motion()).map(|leader| &leader.trajectory);
        targets.chain(leader).for_each(|motion| found.motion(motion));
        let delays = setup.network.delays.iter().filter_map(|delay| delay.downcast());
        setup.network.weights.iter().chain(delays).for_each(|formula: &BoundedFormula| {
            found.formula(formula.formula(), [0.0, setup.time.end_s]);
        });
    }
    if let Some(desired) = setup.reference.downcast::<Desired>()
        && let Some(protocol) = &desired.protocol
    {
        let of_time = parts_in(&protocol.term, desired.protocol_time());
        of_time.iter().for_each(|formula| found.formula(formula, [0.0, setup.time.end_s]));
    }
    // What is below the tolerance of the states hardly moves them.
    let room = match setup.solver.method {
        Method::Adaptive { atol, .. } => atol,
        Method::Fixed { .. } => f64::INFINITY,
    };
    Forcing::new(found.shapes, room)
}

/// The largest parts of a term in which variable number `time`, and no other, stands, as formulas in it alone.
fn parts_in(term: &Expression, time: usize) -> Vec<Expression> {
    /// Where a part begins among the steps, whether time stands in it, and whether another variable does.
    type Part = (usize, bool, bool);
    let (mut parts, mut found): (Vec<Part>, Vec<[usize; 2]>) = (Vec::new(), Vec::new());
    for (at, step) in term.steps().iter().enumerate() {
        let operands = match step {
            Step::Variable(_) | Step::Number(_) => 0,
            Step::Unary(_) | Step::Power(_) => 1,
            Step::Binary(_) => 2,
        };
        let of = parts.split_off(parts.len().saturating_sub(operands));
        let own = |is: fn(usize, usize) -> bool| matches!(step, Step::Variable(index) if is(*index, time));
        let whole = (
            of.first().map_or(at, |part| part.0),
            own(|index, time| index == time) || of.iter().any(|part| part.1),
            own(|index, time| index != time) || of.iter().any(|part| part.2),
        );
        if whole.2 {
            let ends = of.iter().skip(1).map(|part| part.0).chain([at]);
            found.extend(of.iter().zip(ends).filter(|(part, _)| part.1 && !part.2).map(|(part, end)| [part.0, end]));
        }
        parts.push(whole);
    }
    found.extend(parts.iter().filter(|part| part.1 && !part.2).map(|part| [part.0, term.steps().len()]));
    let alone = |[from, to]: [usize; 2]| {
        let steps = term.steps()[from..to].iter();
        let own = steps.map(|step| if matches!(step, Step::Variable(_)) { Step::Variable(0) } else { step.clone() });
        Expression::new(own.collect()).ok()
    };
    found.into_iter().filter_map(alone).collect()
}

struct Found {
    shapes: Vec<Shape>,
    end_s: f64,
}

impl Found {
    fn formula(&mut self, formula: &Expression, span_s: [f64; 2]) {
        self.path(&Path::Formula(formula.clone()), span_s);
    }

    fn motion(&mut self, motion: &Trajectory) {
        motion.paths().iter().for_each(|path| self.path(path, [0.0, self.end_s]));
    }

    fn path(&mut self, path: &Path, [from_s, to_s]: [f64; 2]) {
        let span_s = [from_s, to_s.min(self.end_s)];
        let kinks_s = match path {
            Path::Formula(formula) if formula.is_constant() => return,
            Path::Formula(formula) => kinks_s(formula, span_s[0], span_s[1]).ok(),
            Path::Spline(spline) => Some(spline.ends_s().to_vec()),
            Path::Sinusoids { .. } => Some(Vec::new()),
        };
        if span_s[0] < span_s[1] && !self.shapes.iter().any(|shape| shape.is(path, span_s)) {
            self.shapes.push(Shape::new(path.clone(), span_s, kinks_s));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn x(index: usize) -> Expression {
        Expression::variable(index)
    }

    #[test]
    fn of_a_term_the_parts_that_depend_on_time_alone_are_found() {
        let (sin, exp) = (x(2) * 3.0, (-(x(2) * x(2))).exp_of());
        let term = x(0) * sin.clone().sin_of() + (x(1) + exp.clone()) * 2.0 - Expression::number(5.0);
        let alone = |of: Expression| {
            let steps = of.steps().iter().map(|step| match step {
                Step::Variable(_) => Step::Variable(0),
                other => other.clone(),
            });
            Expression::new(steps.collect()).unwrap()
        };
        assert_eq!(parts_in(&term, 2), [alone(sin.sin_of()), alone(exp.clone())]);
        assert_eq!(parts_in(&exp, 2), [alone(exp)]);
        assert_eq!(parts_in(&(x(0) * x(1) + 1.0), 2), []);
        assert_eq!(parts_in(&(x(0) * (x(2) - x(1))), 2), [x(0)]);
    }
}
