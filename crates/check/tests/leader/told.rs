//! What is said of designs that tell no measurement: an observer of the leader, and one vector to agree on.

use super::*;

/// One graph that the leader reaches everybody in and one in which it reaches nobody; two that take turns, both ways.
fn graphs() -> [Schedule; 4] {
    let phase = |edges| Phase { dwell_s: 1.0, edges };
    [
        Schedule::fixed(vec![edge(2, 0, 1.0, 0), edge(0, 1, 1.0, 0)]),
        Schedule::fixed(vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 0)]),
        Schedule::periodic(vec![
            phase(vec![edge(2, 0, 1.0, 0), edge(0, 1, 1.0, 0)]),
            phase(vec![edge(2, 1, 1.0, 0), edge(1, 0, 1.0, 0)]),
        ]),
        Schedule::periodic(vec![phase(vec![edge(2, 0, 1.0, 0)]), phase(vec![edge(0, 1, 1.0, 0)])]),
    ]
}

/// Two masses in a row under a design over one of them.
fn judged(design: FollowingDesign, graph: &Schedule, delay_s: f64, gain: f64) -> Report {
    let mut setup = setup(design, wave(), gain);
    setup.network.schedule = graph.clone();
    setup.network.delays[0] = Delay::constant(delay_s);
    check(&setup)
}

/// Over one graph, graphs that take turns, and late links: the same hypotheses with the same answers, but for the theorem and whose it is.
#[test]
fn own_the_observer_is_judged_as_110_is_but_for_whose_it_is() {
    let graphs = graphs();
    for (graph, delay_s, gain) in
        graphs.iter().flat_map(|graph| [(graph, 0.0, 3.0), (graph, 0.1, 3.0), (graph, 0.0, 2.2)])
    {
        let [told, observed] = [FollowingDesign::Continuous, FollowingDesign::Observer { kappa: 0.25 }]
            .map(|design| judged(design, graph, delay_s, gain));
        let asked = |report: &Report| {
            let each = report.hypotheses.iter().filter(|one| one.id != Id::Hurwitz);
            each.map(|one| (one.id, one.answer(), one.because())).collect::<Vec<_>>()
        };
        assert_eq!(asked(&told), asked(&observed));
        assert_eq!((&observed.theorem, observed.theorem.source()), (&Theorem::LeaderObserver, Source::Derived));
        let near = |report: &Report| report.promises.split(';').next().map(str::to_owned);
        assert_eq!(near(&told), near(&observed));
        // The slower of α = 1 and κ.
        assert!(answer(&observed, "Hurwitz").1.contains("0.25"), "{:?}", answer(&observed, "Hurwitz"));
    }
}

/// Over one graph, graphs that take turns, and late links: one vector is judged as (110) is, but for what drives the leader, whose it is, and
/// the torque. What is left over late links is what the filter p² + β p + α makes of it, with pairs too.
#[test]
fn own_one_vector_is_judged_as_110_is_but_for_its_gain_and_its_torque() {
    let graphs = graphs();
    for (graph, delay_s) in graphs.iter().flat_map(|graph| [(graph, 0.0), (graph, 0.1)]) {
        let of = |design, gain| judged(design, graph, delay_s, gain);
        // |d³q + 2 q̈ + q̇| of ½ sin 2t is 5: half again as large as 3.
        let (told, agreed, weak) = (
            of(FollowingDesign::Continuous, 3.0),
            of(FollowingDesign::Composite, 5.1),
            of(FollowingDesign::Composite, 4.9),
        );
        let asked = |report: &Report| {
            let each = report.hypotheses.iter().filter(|one| one.id != Id::SignGain && one.id != Id::SetValuedSign);
            each.map(|one| (one.id, one.answer())).collect::<Vec<_>>()
        };
        assert_eq!(asked(&told), asked(&agreed));
        assert_eq!((&agreed.theorem, agreed.theorem.source()), (&Theorem::CompositeLeader, Source::Derived));
        assert_eq!([&agreed, &weak].map(|report| answer(report, "γ exceeds").0), [Answer::Holds, Answer::Violated]);
        let over = graph.constant_graph().is_none() || delay_s > 0.0;
        let covered = graph.constant_graph().is_none() != (delay_s > 0.0);
        let smooth = agreed.promises.contains("bounded derivative, through switches and jumps of delays");
        assert_eq!(
            (agreed.promises.contains("the torque is continuous with a bounded derivative"), smooth),
            (true, over && covered),
            "{}",
            agreed.promises
        );
    }
}

/// How near agents come over late links, by what `check` says.
fn near(setup: &Setup) -> f64 {
    let report = check(setup);
    let said = report.promises.split("exceeds ").nth(1).unwrap_or_else(|| panic!("{}", report.promises));
    said.split(';').next().unwrap().parse().unwrap()
}

/// D Σ w T / α of two in a row: the second has twice the first's 0.1 s, and a period and a half of its sign. A pair −a ± b i may swing by 1 + b/a more.
#[test]
fn own_one_vector_over_late_links_is_as_near_as_its_filter_lets_it() {
    let mut late = setup(FollowingDesign::Composite, wave(), 6.0);
    late.network.delays[0] = Delay::constant(0.1);
    assert!((near(&late) - 5.0 * 0.203).abs() < 2e-3, "{}", near(&late));
    // Two and a half periods for each of both links, and what is told a sample older but for the leader's.
    assert!((near(&late.clone().sampled(100.0)) - 5.0 * 0.26).abs() < 2e-3);
    assert!(late.change_reference(|following: &mut Following| (following.alpha, following.beta) = (5.0, 2.0)));
    // p² + 2 p + 5 has −1 ± 2 i, and |d³q + 2 q̈ + 5 q̇| is √(1² + 4²).
    let wanted = 17.0_f64.sqrt() * 0.203 / 5.0 * 3.0;
    assert!((near(&late) - wanted).abs() < 2e-3 * wanted, "{} {wanted}", near(&late));
}

/// Estimates that samples tell are a sample older than what is measured, but for those of a leader.
#[test]
fn own_what_a_sampled_observer_tells_is_a_sample_older() {
    let near = |design| {
        let mut setup = setup(design, wave(), 3.0);
        setup.network.delays[0] = Delay::constant(0.1);
        let report = check(&setup.sampled(100.0));
        report.promises.split("exceeds ").nth(1).unwrap().split(';').next().unwrap().parse::<f64>().unwrap()
    };
    let drive = 5.0_f64.sqrt();
    let measured = near(FollowingDesign::Continuous) / drive;
    let told = near(FollowingDesign::Observer { kappa: 2.0 }) / drive;
    assert!((measured - 0.25).abs() < 1e-3 && (told - 0.26).abs() < 1e-3, "{measured} {told}");
}
