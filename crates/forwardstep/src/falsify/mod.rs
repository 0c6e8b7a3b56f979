//! Tries to refute what is claimed: random scenarios over all theorems, sizes, delays and schedules.

mod attack;
mod case;
mod judge;
mod own;
mod text;

use std::collections::BTreeMap;

pub(crate) use attack::{Attack, Target};
pub(crate) use case::Case;
pub(crate) use judge::{Failure, Verdict};
pub(crate) use own::{GROWS, NoAttack, OwnAttack, OwnFound};

/// What became of many cases.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    /// Spreads that did not grow, of which no fall is guaranteed.
    pub(crate) kept: u64,
    /// Spreads that shrank at least by what is guaranteed.
    pub(crate) shrank: u64,
    /// Closed loops whose balance holds and whose error falls.
    pub(crate) fell: u64,
    /// Those of them that came to where it was predicted for certain.
    pub(crate) reached: u64,
    /// Closed loops whose balance holds, of which nothing more is promised.
    pub(crate) balanced: u64,
    /// Those whose error had not fallen.
    pub(crate) undecided: Vec<Case>,
    /// Why nothing could be said, and of how many.
    pub(crate) silent: BTreeMap<String, u64>,
    /// Claims that are not so, shrunk.
    pub(crate) failed: Vec<(Case, Failure)>,
}

impl Tally {
    /// Judges one more case. A failure is made as small as it stays one of its kind.
    pub(crate) fn add(&mut self, case: Case) {
        match judge::judge(&case) {
            Verdict::Kept => self.kept += 1,
            Verdict::Shrank => self.shrank += 1,
            Verdict::Fell => self.fell += 1,
            Verdict::Reached => (self.fell, self.reached) = (self.fell + 1, self.reached + 1),
            Verdict::Balanced => self.balanced += 1,
            Verdict::Undecided => self.undecided.push(case),
            Verdict::Silent(reason) => *self.silent.entry(without_numbers(&reason)).or_default() += 1,
            Verdict::Failed(failure) => self.failed.push(shrunk(case, failure)),
        }
    }

    /// How many were judged.
    pub(crate) fn cases(&self) -> u64 {
        let listed = self.undecided.len() + self.failed.len();
        self.kept + self.shrank + self.fell + self.balanced + self.silent.values().sum::<u64>() + listed as u64
    }
}

/// Takes whatever smaller case still fails in the same way, until none does.
fn shrunk(mut case: Case, mut failure: Failure) -> (Case, Failure) {
    loop {
        let smaller = case.smaller().into_iter().find_map(|smaller| match judge::judge(&smaller) {
            Verdict::Failed(found) if found.is_like(&failure) => Some((smaller, found)),
            Verdict::Failed(_)
            | Verdict::Kept
            | Verdict::Shrank
            | Verdict::Fell
            | Verdict::Reached
            | Verdict::Balanced
            | Verdict::Undecided
            | Verdict::Silent(_) => None,
        });
        match smaller {
            Some(found) => (case, failure) = found,
            None => return (case, failure),
        }
    }
}

/// The same words for whichever agent and place: every number becomes `…`, but for those of equations, which are in brackets.
fn without_numbers(reason: &str) -> String {
    let mut found = String::with_capacity(reason.len());
    let mut is_equation = false;
    for c in reason.chars() {
        is_equation = c == '(' || is_equation && c != ')' && c != ' ';
        match c {
            '0'..='9' if is_equation => found.push(c),
            '0'..='9' if found.ends_with('…') => {}
            '0'..='9' => found.push('…'),
            c => found.push(c),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::case::{Course, Phase, Switching, System, Thrust};
    use forwardstep::check::prediction::{CascadeSpread, Fall};

    use super::judge::{Whither, decided, grown, judge, left_more, read};
    use super::*;

    #[test]
    fn every_case_that_is_drawn_is_a_scenario_and_so_is_every_smaller_one() {
        for number in 0..300 {
            let case = Case::draw(5, number);
            assert!(read(&case).is_ok(), "{}\n{case}", read(&case).unwrap_err());
            assert_eq!(case, Case::draw(5, number));
            if number % 10 == 0 {
                for smaller in case.smaller() {
                    assert!(smaller != case && read(&smaller).is_ok(), "{}\n{smaller}", read(&smaller).unwrap_err());
                }
            }
        }
    }

    #[test]
    fn all_kinds_and_courses_are_drawn() {
        let cases: Vec<Case> = (0..600).map(|number| Case::draw(9, number)).collect();
        let has = |is: &dyn Fn(&Case) -> bool| assert!(cases.iter().any(is));
        for system in [
            System::Arm,
            System::Ship,
            System::PositionOnly,
            System::ByModel,
            System::Spacecraft { filtered: false },
            System::Spacecraft { filtered: true },
            System::Tip { measured: false },
            System::Tip { measured: true },
            System::Chain(3),
            System::Vehicle(Thrust::ByAcceleration),
        ] {
            has(&|case| case.system == system);
        }
        has(&|case| matches!(case.system, System::Vehicle(_)));
        has(&|case| matches!(case.course, Course::Integral { velocities: true }));
        has(&|case| matches!(case.course, Course::Follow { .. }));
        has(&|case| matches!(case.course, Course::Track { .. }));
        has(&|case| case.switching == Switching::Random && case.phases.len() == 3);
    }

    #[test]
    fn a_link_that_leads_both_ways_goes_as_a_whole_too() {
        let edges = vec![(0, 1), (1, 0), (1, 2)];
        let case = Case { phases: vec![Phase { edges, ..unlike().phases[0].clone() }], ..unlike() };
        let smaller = case.smaller();
        let left = |edges: &[(usize, usize)]| smaller.iter().any(|case| case.phases[0].edges == edges);
        assert!(left(&[(1, 2)]), "both of it");
        assert!(left(&[(1, 0), (1, 2)]) && left(&[(0, 1), (1, 0)]), "one of it, and one that leads one way");
        assert!(!left(&[(0, 1)]), "nothing leads back along the last");
    }

    #[test]
    fn a_value_is_missed_only_where_hardly_any_disagreement_is_left() {
        assert_eq!(Whither::judged(0.005, 1.0, 1e-6), Whither::There);
        assert_eq!(Whither::judged(0.03, 1.0, 1e-6), Whither::Elsewhere { away: 0.03 });
        assert_eq!(Whither::judged(0.03, 1.0, 2e-3), Whither::There, "some times what is left");
        assert_eq!(Whither::judged(0.9, 1.0, 2e-3), Whither::Unclear);
        assert_eq!(Whither::judged(f64::NAN, 1.0, 2e-3), Whither::Unclear);
        // Who starts together has no size of a disagreement.
        assert_eq!(Whither::judged(5e-6, 0.0, 0.0), Whither::There);
        assert_eq!(Whither::judged(1.0, 0.0, 0.0), Whither::Elsewhere { away: 1.0 });
    }

    /// κ₀ that differ under (a5) with a delay that jumps: the network may diverge, and `check` does not say otherwise.
    fn unlike() -> Case {
        let case = Case { roots: vec![vec![0.5, 1.0], vec![3.0, 1.0]], ..Case::draw(1, 6) };
        let starts = vec![[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
        let phase = |edges| Phase { dwell_s: 0.4, edges, weight: None };
        Case {
            number: 6,
            alone: true,
            system: System::Mass(1),
            course: Course::Agree { velocities: true },
            starts,
            phases: vec![phase(vec![(0, 1)]), phase(vec![(1, 0)])],
            switching: Switching::Repeat,
            delay: "constant_s = 0".into(),
            weight: "2.0".into(),
            ..case
        }
    }

    #[test]
    fn a_spread_that_grows_is_seen_and_nothing_is_said_of_what_is_not_claimed() {
        assert!(matches!(judge(&unlike()), Verdict::Silent(_)));
        let spread = |low: &[f64], high: &[f64]| CascadeSpread { low: vec![low.to_vec()], high: vec![high.to_vec()] };
        assert_eq!(grown(&spread(&[0.0, 0.1, 0.2], &[1.0, 1.0, 0.9]), &[0.0, 1.0, 2.0]), None);
        let out = grown(&spread(&[0.0, 0.1, -0.01], &[1.0, 1.0, 1.02]), &[0.0, 1.0, 2.0]);
        assert!(matches!(out, Some(Failure::Grew { part, t_s: 2.0 }) if (part - 0.02).abs() < 1e-12), "{out:?}");
    }

    #[test]
    fn errors_are_held_against_the_largest_before() {
        let decided = |errors: &[f64]| decided(errors, 1e-5);
        assert_eq!([decided(&[]), decided(&[0.3]), decided(&[0.3, 0.15])], [None, None, None]);
        assert_eq!([decided(&[1e-5]), decided(&[0.3, 0.149])], [Some(Verdict::Fell), Some(Verdict::Fell)]);
        // Small by chance at first, slow from then on: that refutes nothing.
        assert_eq!(decided(&[4.4e-3, 2.0e-2, 1.9e-2, 1.7e-2, 1.4e-2]), None);
        assert_eq!(decided(&[0.1, 0.2, 0.4, 0.8, 1.2]), None);
        let rose = Verdict::Failed(Failure::Rose { most: 0.8, last: 1.21 });
        assert_eq!([decided(&[0.1, 0.2, 0.4, 0.8, 1.21]), decided(&[0.2, 0.4, 0.8, 1.21])], [Some(rose), None]);
    }

    #[test]
    fn a_spread_of_which_more_is_left_than_is_guaranteed_is_seen() {
        // The second axis is left 0.5 at 2 s, the first nothing.
        let spread = CascadeSpread {
            low: vec![vec![0.0; 3], vec![-1.0, -0.9, -0.5]],
            high: vec![vec![4.0, 2.0, 0.0], vec![1.0, 0.9, 0.5]],
        };
        let judged = |t_s: f64, left: f64| left_more(&spread, &[0.0, 1.0, 2.0], 1.0, &[Fall { t_s, left }]);
        assert_eq!(judged(1.0, 0.5), Some(None));
        let failure = Failure::LeftMore { left: 0.5, guaranteed: 0.4, t_s: 2.0 };
        assert_eq!(judged(0.5, 0.4), Some(Some(failure)));
        assert_eq!(judged(1.5, 0.4), None, "there is no row after 2 s");
    }

    #[test]
    fn what_fails_becomes_as_small_as_it_still_fails() {
        // Whatever has a phase with an edge from agent 1 to agent 2 "fails".
        let is = |case: &Case| case.phases.iter().any(|phase| phase.edges.contains(&(0, 1)));
        let case =
            (0..).map(|number| Case::draw(2, number)).find(|case| is(case) && case.starts.len() > 3 && !case.is_led());
        let mut case = case.unwrap();
        while let Some(smaller) = case.smaller().into_iter().find(|smaller| is(smaller)) {
            case = smaller;
        }
        assert_eq!((case.starts.len(), case.phases.len(), case.phases[0].edges.len()), (2, 1, 1), "{case}");
        assert_eq!((case.weight.as_str(), case.delay.as_str(), case.end_s), ("1", "constant_s = 0", 1.0));
    }

    #[test]
    fn reasons_are_counted_whatever_their_numbers_are() {
        assert_eq!(without_numbers("agent 12 at 3.5 s"), "agent … at ….… s");
        assert_eq!(
            without_numbers("2 weights vary under (119) or (122), 3 do not"),
            "… weights vary under (119) or (122), … do not"
        );
    }
}
