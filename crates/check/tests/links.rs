//! Verdicts about links: packets, random holds, formulas.

use crate::common::{edge, masses};
use crate::verdicts::control;
use forwardstep_check::hypothesis::{LinkEvidence, WeightFault};
use forwardstep_check::{Answer, Evidence, Id, NoPrediction, NotFixed, check, predict};
use forwardstep_core::expression::Expression;
use forwardstep_sim::Exchange;
use forwardstep_sim::delay::{Delay, Loss, Packet, PacketLink, RandomHold, Trace};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::schedule::{Phase, Schedule};

/// The answer to the hypothesis on delays, and on weights if there is one, of two agents that hear each other.
fn links(delay: Delay, weight: Option<Expression>) -> (Answer, String, Option<(Answer, String)>) {
    let end_s = 20.0;
    let mut setup =
        masses(Exchange::Position, 2, Schedule::fixed(vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 0)]), vec![delay]);
    setup.agents.truncate(2);
    setup.network.agents = 2;
    setup.time.end_s = end_s;
    if let Some(formula) = weight {
        setup.network.weights = vec![BoundedFormula::new(formula, end_s)];
        setup.network.schedule = Schedule::fixed(vec![
            Edge { weight: Weight::Formula(0), ..edge(0, 1, 1.0, 0) },
            Edge { weight: Weight::Formula(0), ..edge(1, 0, 1.0, 0) },
        ]);
        assert!(matches!(
            predict(&setup),
            Err(NoPrediction::NotFixed(NotFixed::VaryingWeight | NotFixed::VaryingDelay))
        ));
    }
    let report = check(&setup);
    let find = |words: &str| {
        report.hypotheses.iter().find(|h| h.requires().starts_with(words)).map(|h| (h.answer(), h.because()))
    };
    let (answer, because) = find("delays").unwrap();
    (answer, because, find("weights"))
}

/// The time at which a weight is more than twice what it is on the run.
#[test]
fn a_weight_that_grows_is_told_with_a_time_after_the_run() {
    let mut setup =
        masses(Exchange::Position, 2, Schedule::fixed(vec![edge(0, 1, 1.0, 0)]), vec![Delay::constant(0.1)]);
    setup.network.weights = vec![BoundedFormula::new(Expression::variable(0) + 1.0, 20.0)];
    setup.network.schedule = Schedule::fixed(vec![Edge { weight: Weight::Formula(0), ..edge(0, 1, 1.0, 0) }]);
    let found = check(&setup).hypotheses.into_iter().find(|h| h.id == Id::BoundedWeights).unwrap();
    let Evidence::Links(LinkEvidence::RefutedWeight { fault: WeightFault::Grows, witness: Some(witness) }) =
        found.evidence
    else {
        panic!("{:?}", found.evidence)
    };
    assert!(witness.t_s > 41.0 && witness.value > 42.0, "{witness:?}");
}

/// Beyond every bound in the end, or down to zero, but gone by then; where it comes back it is not.
#[test]
fn a_formula_counts_until_its_edge_is_gone_for_good() {
    let t = || Expression::variable(0);
    let [lasts_s, end_s] = [30.0, 20.0];
    let found = |delay: Expression, weight: Expression, schedule: fn(Vec<Phase>) -> Schedule| {
        let delays = vec![Delay::constant(0.1), Delay::new(BoundedFormula::new(delay, end_s))];
        let first = vec![Edge { weight: Weight::Formula(0), ..edge(0, 1, 1.0, 1) }];
        let phase = |edges| Phase { edges, dwell_s: lasts_s };
        let mut setup =
            masses(Exchange::Position, 2, schedule(vec![phase(first), phase(vec![edge(0, 1, 1.0, 0)])]), delays);
        setup.time.end_s = end_s;
        setup.network.weights = vec![BoundedFormula::new(weight, end_s)];
        setup.control = control(0.0);
        setup.control.as_mut().unwrap().failures.message_timeout_s = Some(31.0);
        let hypotheses = check(&setup).hypotheses;
        [Id::BoundedDelays, Id::BoundedWeights, Id::MessagesInTime].map(|id| {
            let found = hypotheses.iter().find(|hypothesis| hypothesis.id == id).unwrap();
            (found.answer(), found.because())
        })
    };
    let [delays, weights, ages] = found(t(), (-t()).exp_of(), Schedule::once);
    assert_eq!(delays, (Answer::Holds, "no delay exceeds 30 s".into()));
    assert_eq!(weights, (Answer::Holds, "weights that follow a formula stay from 9.357e-14 to 1".into()));
    assert_eq!(ages.0, Answer::Holds, "{}", ages.1);
    let [delays, weights, ages] = found(t(), (-t()).exp_of(), Schedule::periodic);
    assert_eq!([delays.0, weights.0, ages.0], [Answer::NotShown, Answer::Violated, Answer::NotShown]);
    // Negative, or zero, after the run and before it is gone.
    let [delays, weights, _] = found(-t() + 25.0, -t() + 25.0, Schedule::once);
    assert_eq!([delays.0, weights.0], [Answer::NotShown; 2]);
}

#[test]
fn only_a_bounded_loss_gives_a_bounded_delay() {
    let link = |loss, most_in_a_row| {
        let link =
            PacketLink { every_s: 0.02, first_s: 0.0, latency_s: 0.03, jitter_s: 0.02, loss, most_in_a_row, seed: 1 };
        links(Delay::new(link.trace((0, 1), 20.0).unwrap()), None)
    };
    let (answer, because, _) = link(Loss::Never, None);
    assert_eq!(
        (answer, because.as_str()),
        (Answer::Holds, "no delay exceeds 0.07 s; between the arrivals of packets it grows like t")
    );
    let (answer, because, _) = link(Loss::Bursts { enter: 0.1, leave: 0.2 }, Some(4));
    assert_eq!(
        (answer, because.as_str()),
        (Answer::Holds, "no delay exceeds 0.15 s; between the arrivals of packets it grows like t")
    );
    for loss in [
        Loss::Random { probability: 0.1 },
        Loss::Bursts { enter: 0.01, leave: 0.2 },
        Loss::Random { probability: 1e-9 },
    ] {
        let (answer, because, _) = link(loss, None);
        assert_eq!(answer, Answer::HoldsOnHorizon);
        assert!(because.contains("any number of packets may be lost one after another"), "{because}");
    }
    // Of a link that loses every packet, and of one on which none has arrived, nothing is known that holds.
    let (answer, because, _) = link(Loss::Random { probability: 1.0 }, None);
    assert_eq!((answer, because.contains("loses every packet")), (Answer::Violated, true), "{because}");
    assert_eq!(link(Loss::Random { probability: 1.0 }, Some(3)).0, Answer::Holds);
    assert_eq!(link(Loss::Bursts { enter: 1.0, leave: 1e-9 }, None).0, Answer::NotShown);
    let lost = vec![Packet { send_s: 0.0, delay_s: None }, Packet { send_s: 1.0, delay_s: None }];
    assert_eq!(links(Delay::new(Trace::new(lost, 20.0).unwrap()), None).0, Answer::NotShown);
    let packets = vec![Packet { send_s: 0.0, delay_s: Some(0.5) }, Packet { send_s: 1.0, delay_s: None }];
    let (answer, because, _) = links(Delay::new(Trace::new(packets, 20.0).unwrap()), None);
    assert_eq!(answer, Answer::NotShown);
    assert!(
        because.starts_with("no delay exceeds 20 s until the end of the run at 20 s") && because.contains("replayed"),
        "{because}"
    );
    let hold = RandomHold::draw(1, (0, 1), [0.05, 0.4], [0.1, 0.8], 20.0).unwrap();
    let (answer, because, _) = links(Delay::new(hold), None);
    assert_eq!((answer, because.as_str()), (Answer::Holds, "no delay exceeds 0.4 s"));
}

#[test]
fn formulas_hold_for_ever_only_where_that_is_shown() {
    let t = || Expression::variable(0);
    let swing = |mean: f64| t().sin_of() * 0.5 + mean;
    let growing = t() * 0.01 + 0.1;
    let delay = |formula: Expression| Delay::new(BoundedFormula::new(formula, 20.0));
    let (answer, because, _) = links(delay(swing(0.5)), None);
    assert_eq!((answer, because.as_str()), (Answer::Holds, "no delay exceeds 1 s"));
    let (answer, because, _) = links(delay(growing.clone()), None);
    assert_eq!(answer, Answer::Violated);
    assert!(because.starts_with("a delay that is a formula exceeds every bound; at t = "), "{because}");
    let constant = || Delay::constant(0.1);
    let (_, _, weight) = links(constant(), Some(swing(1.0)));
    assert_eq!(weight.unwrap(), (Answer::Holds, "weights that follow a formula stay from 0.5 to 1.5".to_owned()));
    let (_, _, weight) = links(constant(), Some(growing));
    assert_eq!(weight.unwrap().0, Answer::Violated);
    assert_eq!(links(constant(), None).2, None);

    // What is said for ever is the bound for ever, not what the run happens to see of it: 0.2 + 0.1 tanh(t / 1000).
    let rising = (t() / 1000.0).tanh_of() * 0.1 + 0.2;
    let (answer, because, weight) = links(delay(rising.clone()), Some(rising));
    assert_eq!((answer, because.as_str()), (Answer::Holds, "no delay exceeds 0.3 s"));
    assert_eq!(weight.unwrap(), (Answer::Holds, "weights that follow a formula stay from 0.2 to 0.3".to_owned()));

    // 0.2 + 0.1 sin t² swings faster and faster; the run sees a part of it on which it is uniformly continuous.
    let swings = |argument: Expression| argument.sin_of() * 0.1 + 0.2;
    let faster = swings(t() * t());
    let (answer, because, weight) = links(delay(faster.clone()), Some(faster));
    assert_eq!(answer, Answer::NotShown);
    assert!(because.contains("could not be shown to be uniformly continuous for ever"), "{because}");
    let (answer, because) = weight.unwrap();
    assert_eq!(answer, Answer::NotShown);
    assert!(because.contains("could not be shown to be uniformly continuous for ever"), "{because}");
    let steady = swings(t() * core::f64::consts::TAU / 3.0);
    let (answer, because, weight) = links(delay(steady.clone()), Some(steady));
    assert_eq!((answer, because.as_str()), (Answer::Holds, "no delay exceeds 0.3 s"));
    assert_eq!(weight.unwrap().0, Answer::Holds);
}

#[test]
fn weights_and_delays_are_judged_by_what_they_do_for_all_time() {
    let t = || Expression::variable(0);
    let one = || Expression::number(1.0);
    let delay = |formula: Expression| {
        let (answer, because, _) = links(Delay::new(BoundedFormula::new(formula, 20.0)), None);
        (answer, because)
    };
    let weight = |formula: Expression| links(Delay::constant(0.1), Some(formula)).2.unwrap();
    // t/(1 + t) is below one for ever; t is not bounded; what is negative later is no delay.
    assert_eq!(delay(t() / (one() + t())), (Answer::Holds, "no delay exceeds 1 s".into()));
    assert_eq!(delay(t()).0, Answer::Violated);
    let (answer, because) = delay(one() - t() * 0.01);
    assert!(answer == Answer::Violated && because.contains("becomes negative after the run"), "{because}");
    // A pole or a root after the run: neither is shown.
    assert_eq!(delay(one() / (t() - 100.0) + 1.0).0, Answer::NotShown);
    assert_eq!(delay((Expression::number(50.0) - t()).sqrt_of()).0, Answer::NotShown);
    for fading in [(-t()).exp_of(), one() / (one() + t()), one() + (t() * 0.01).cos_of()] {
        let (answer, because) = weight(fading.clone());
        assert_eq!(answer, Answer::Violated, "{fading:?}");
        assert!(because.contains("its infimum is 0; at t = "), "{because}");
    }
    let (answer, because) = weight(one() - t() * 0.01);
    assert!(answer == Answer::Violated && because.contains("negative after the run; at t = "), "{because}");
    let (answer, because) = weight(one() + t().sqrt_of());
    assert!(answer == Answer::Violated && because.contains("exceeds every bound; at t = "), "{because}");
    assert_eq!(
        weight((-t()).exp_of() + 0.2),
        (Answer::Holds, "weights that follow a formula stay from 0.2 to 1.2".into())
    );
    // Two waves that drift apart, and come to −0.1 after hours: neither bound alone says that a weight holds.
    let drifting = t().sin_of() * 0.5 - (t() * 1.0001).sin_of() * 0.5 + 0.9;
    let (answer, because) = weight(drifting);
    assert!(answer != Answer::Holds && !because.contains("uniformly"), "{answer:?}: {because}");
    // No more is it where its size is taken, which is not shown to stay off zero.
    let (answer, because) = weight((t().sin_of() * 0.5 - (t() * 1.0001).sin_of() * 0.5 + 0.9).abs_of());
    assert!(answer == Answer::NotShown && because.contains("that they do so for ever could not be shown"), "{because}");
    let (answer, because) = weight(one() + one() / (t() - 100.0).power(2.0));
    assert!(answer != Answer::Holds && !because.contains("uniformly"), "{answer:?}: {because}");
    // A sum of two waves is larger than the sum of their lower bounds.
    let waves = t().sin_of() * 0.2 + t().cos_of() * 0.2 + 0.3;
    assert_eq!(weight(waves).0, Answer::Holds);
}

#[test]
fn bounds_are_said_outwards() {
    let (answer, because, _) = links(Delay::constant(4e-7), None);
    assert_eq!((answer, because.as_str()), (Answer::Holds, "no delay exceeds 4e-7 s"));
}

#[test]
fn a_weight_in_which_time_cancels_is_constant() {
    let constant = Expression::number(1.0) + Expression::variable(0) * 0.0;
    let bounded = BoundedFormula::new(constant, 20.0);
    assert_eq!(
        [bounded.constant(), BoundedFormula::new(Expression::number(2.0), 20.0).constant()],
        [Some(1.0), Some(2.0)]
    );
    assert_eq!(BoundedFormula::new(Expression::variable(0).sin_of() * 1e-9 + 1.0, 20.0).constant(), None);
}

/// A delay that is as long as the run is bounded by that alone: a log with one packet tells nothing.
#[test]
fn regress_a_log_after_whose_first_packet_everything_is_lost_shows_no_bound() {
    let said = |received: &[u64]| {
        let packet = |number: &u64| Packet { send_s: *number as f64, delay_s: Some(0.05) };
        let trace = Trace::new(received.iter().map(packet).collect(), 20.0).unwrap();
        let (answer, because, _) = links(Delay::new(trace), None);
        (answer, because)
    };
    let every: Vec<u64> = (0..20).collect();
    assert_eq!(said(&every).0, Answer::HoldsOnHorizon);
    let (answer, because) = said(&[0]);
    assert_eq!(answer, Answer::NotShown);
    assert!(because.contains("nothing is seen to arrive again and again"), "{because}");
    // Lost for the second half but a little.
    assert_eq!([said(&every[..9]).0, said(&every[..12]).0], [Answer::NotShown, Answer::HoldsOnHorizon]);
}
