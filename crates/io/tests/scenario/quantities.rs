//! One check of every quantity: what a file is refused for at its line and column, a setup from the library is refused for in
//! the same words, under a path.

use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_sim::delay::packets::PacketError;
use forwardstep_sim::delay::{
    Delay, DelayFunction, Loss, PacketLink, PiecewiseConstant, RandomHold, SawTooth, Sinusoid,
};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::quantity::QuantityError;
use forwardstep_sim::schedule::{Periodic, Schedule};
use forwardstep_sim::{Adaptive, ChainLaw, ChainStep, Estimate, Setup, SetupError, check_recording, simulate};

use super::chains::{CASCADES, DERIVATIVES};
use super::{SOUND, read};

/// What is wrong before there is a setup, or with the one that was changed.
type Change = fn(&mut Setup) -> Result<(), QuantityError>;

/// What to replace in a sound scenario, by what, its place, the same change of its setup, and the path of what is wrong.
type Case = (&'static str, &'static str, &'static str, Change, &'static str);

fn law(setup: &mut Setup, change: fn(&mut Adaptive)) -> Result<(), QuantityError> {
    assert!(setup.agents[0].change_law(change));
    Ok(())
}

fn delay<D: DelayFunction>(setup: &mut Setup, delay: D) -> Result<(), QuantityError> {
    setup.network.delays[0] = Delay::new(delay);
    Ok(())
}

fn graphs(setup: &Setup) -> Vec<Vec<Edge>> {
    setup.network.schedule.graphs.clone()
}

/// A delay or a weight that is a cosine, shifted up.
fn cosine(up: f64) -> BoundedFormula {
    BoundedFormula::new(Expression::variable(0).cos_of() + up, 10.0)
}

fn radio(every_s: f64, latency_s: f64, probability: f64) -> Result<(), QuantityError> {
    let loss = Loss::Random { probability };
    let link = PacketLink { every_s, first_s: 0.0, latency_s, jitter_s: 0.0, loss, most_in_a_row: None, seed: 1 };
    match link.trace((0, 1), 10.0) {
        Err(PacketError::Quantity(error)) => Err(error),
        other => panic!("{other:?}"),
    }
}

const SAW: SawTooth = SawTooth { min_s: 0.1, max_s: 0.4, period_s: 0.6, offset_s: 0.0 };
const SWING: Sinusoid = Sinusoid { mean_s: 0.1, amplitude_s: 0.1, period_s: 1.0, phase_rad: 0.0 };
const DELAY: &str = "delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }";
const LAWS: &str = "agents[0].law.";

fn steps(times_s: &[f64], values_s: &[f64], period_s: Option<f64>) -> PiecewiseConstant {
    PiecewiseConstant { times_s: times_s.to_vec(), values_s: values_s.to_vec(), period_s }
}

#[rustfmt::skip]
const CASES: &[Case] = &[
    // The run.
    ("end_s = 10", "end_s = 0", "5:9", |s| { s.time.end_s = 0.0; Ok(()) }, "time.end_s"),
    ("record_every_s = 0.1", "record_every_s = 1e-9", "6:18", |s| { s.time.record_every_s = 1e-9; Ok(()) }, "time.record_every_s"),
    // Reference dynamics.
    ("[1.0, 2.0]", "[1.0, -2.0]", "19:21", |s| { s.agents[0].roots_per_s.real[1] = -2.0; Ok(()) }, "agents[0].reference.consensus.roots_per_s[1]"),
    ("[1.0, 2.0]", "[1.0, 2.0]\nmanipulability_gain = -1", "20:23", |s| { s.agents[0].manipulability = -1.0; Ok(()) }, "agents[0].reference.consensus.manipulability_gain"),
    // K.
    ("damping.gain = 8", "damping.gain = -8", "23:16", |s| law(s, |law| law.damping = Gain::Number(-8.0)), "damping.gain"),
    ("damping.gain = 8", "damping.gain = [8, 0]", "23:20", |s| law(s, |law| law.damping = Gain::Diagonal(vec![8.0, 0.0])), "damping.gain[1]"),
    ("damping.gain = 8", "damping.gain = [8, 8, 8]", "23:16", |s| law(s, |law| law.damping = Gain::Diagonal(vec![8.0; 3])), "damping.gain"),
    ("damping.gain = 8", "damping.gain = [[8]]", "23:16", |s| law(s, |law| law.damping = Gain::Matrix(vec![8.0])), "damping.gain"),
    ("damping.gain = 8", "damping.gain = [[8, 1], [2, 8]]", "23:16", |s| law(s, |law| law.damping = Gain::Matrix(vec![8.0, 1.0, 2.0, 8.0])), "damping.gain"),
    ("damping.gain = 8", "damping.gain = [[1, 2], [2, 1]]", "23:16", |s| law(s, |law| law.damping = Gain::Matrix(vec![1.0, 2.0, 2.0, 1.0])), "damping.gain"),
    ("damping.gain = 8", "damping.bandwidth_per_s = 0", "23:27", |s| law(s, |law| law.damping = Gain::Bandwidth(0.0)), "damping.bandwidth_per_s"),
    // Γ and ϑ̂.
    ("adaptation_gain = 10", "adaptation_gain = 0", "24:19", |s| law(s, |law| law.adaptation = Gain::Number(0.0)), "adaptation_gain"),
    ("adaptation_gain = 10", "adaptation_gain = [1, 2, 3]", "24:19", |s| law(s, |law| law.adaptation = Gain::Diagonal(vec![1.0, 2.0, 3.0])), "adaptation_gain"),
    ("adaptation_gain = 10", "adaptation_gain.bandwidth_per_s = -1", "24:35", |s| law(s, |law| law.adaptation = Gain::Bandwidth(-1.0)), "adaptation_gain.bandwidth_per_s"),
    ("estimate_start = \"zero\"", "estimate_start.given = [1, 2]", "25:24", |s| law(s, |law| law.estimate_start = vec![1.0, 2.0]), "estimate_start.given"),
    // Weights and dwell times.
    ("weight = 1.0", "weight = 0", "28:10", |s| { let mut g = graphs(s); g[0][0].weight = 0.0.into(); s.network.schedule = Schedule::new(g, Periodic { dwell_s: vec![1.0, 2.0] }); Ok(()) }, "network.graphs[0][0].weight"),
    ("weight = 1.0", "weight = \"cos(t) + 0.9\"", "28:10", |s| { let mut g = graphs(s); g[0][0].weight = Weight::Formula(0); s.network.weights.push(cosine(0.9)); s.network.schedule = Schedule::new(g, Periodic { dwell_s: vec![1.0, 2.0] }); Ok(()) }, "network.graphs[0][0].weight"),
    ("dwell_s = 2.0", "dwell_s = -2", "34:11", |s| { s.network.schedule = Schedule::new(graphs(s), Periodic { dwell_s: vec![1.0, -2.0] }); Ok(()) }, "network.phases[1].dwell_s"),
    ("weight = 1.0", "switching.random = { seed = 1, dwell_s = [2, 1] }", "28:43", |s| { s.network.schedule = Schedule::random(graphs(s), [2.0, 1.0], 1); Ok(()) }, "network.switching.random.dwell_s[0]"),
    ("weight = 1.0", "switching.random = { seed = 1, dwell_s = [1e-9, 1e-9] }", "28:42", |s| { s.network.schedule = Schedule::random(graphs(s), [1e-9, 1e-9], 1); Ok(()) }, "network.switching.random.dwell_s"),
    // Delays.
    (DELAY, "delay.constant_s = -0.1", "29:20", |s| { s.network.delays[0] = Delay::constant(-0.1); Ok(()) }, "network.delays[0].constant_s"),
    ("min_s = 0.1", "min_s = 0.5", "29:29", |s| delay(s, SawTooth { min_s: 0.5, ..SAW }), "network.delays[0].min_s"),
    ("period_s = 0.6", "period_s = 0", "29:58", |s| delay(s, SawTooth { period_s: 0.0, ..SAW }), "network.delays[0].period_s"),
    ("period_s = 0.6", "period_s = 1e-9", "29:58", |s| delay(s, SawTooth { period_s: 1e-9, ..SAW }), "network.delays[0].period_s"),
    (DELAY, "delay.sinusoid = { mean_s = 0.1, amplitude_s = 0.2, period_s = 1 }", "29:48", |s| delay(s, Sinusoid { amplitude_s: 0.2, ..SWING }), "network.delays[0].amplitude_s"),
    (DELAY, "delay.sinusoid = { mean_s = 0.1, amplitude_s = -0.1, period_s = 1 }", "29:48", |s| delay(s, Sinusoid { amplitude_s: -0.1, ..SWING }), "network.delays[0].amplitude_s"),
    (DELAY, "delay.sinusoid = { mean_s = 0.1, amplitude_s = 0.1, period_s = 1e-8 }", "29:64", |s| delay(s, Sinusoid { period_s: 1e-8, ..SWING }), "network.delays[0].period_s"),
    (DELAY, "delay.piecewise_constant = { times_s = [], values_s = [] }", "29:40", |s| delay(s, steps(&[], &[], None)), "network.delays[0].times_s"),
    (DELAY, "delay.piecewise_constant = { times_s = [1, 2], values_s = [0, 1] }", "29:41", |s| delay(s, steps(&[1.0, 2.0], &[0.0, 1.0], None)), "network.delays[0].times_s[0]"),
    (DELAY, "delay.piecewise_constant = { times_s = [0, 2, 2], values_s = [0, 1, 2] }", "29:47", |s| delay(s, steps(&[0.0, 2.0, 2.0], &[0.0, 1.0, 2.0], None)), "network.delays[0].times_s[2]"),
    (DELAY, "delay.piecewise_constant = { times_s = [0, 2], values_s = [0] }", "29:59", |s| delay(s, steps(&[0.0, 2.0], &[0.0], None)), "network.delays[0].values_s"),
    (DELAY, "delay.piecewise_constant = { times_s = [0, 2], values_s = [0, -1] }", "29:63", |s| delay(s, steps(&[0.0, 2.0], &[0.0, -1.0], None)), "network.delays[0].values_s[1]"),
    (DELAY, "delay.piecewise_constant = { times_s = [0, 2], values_s = [0, 1], period_s = 2 }", "29:78", |s| delay(s, steps(&[0.0, 2.0], &[0.0, 1.0], Some(2.0))), "network.delays[0].period_s"),
    (DELAY, "delay.piecewise_constant = { times_s = [0], values_s = [1], period_s = 1e-8 }", "29:72", |s| delay(s, steps(&[0.0], &[1.0], Some(1e-8))), "network.delays[0].period_s"),
    (DELAY, "delay.formula_s = \"cos(t) + 0.9\"", "29:19", |s| delay(s, cosine(0.9)), "network.delays[0].formula_s"),
    // Packets and holds, which are refused where they are drawn.
    (DELAY, "delay.packets = { period_s = 0, latency_s = 0.1, seed = 1, loss.random = { probability = 0.1 } }", "29:30", |_| radio(0.0, 0.1, 0.1), "period_s"),
    (DELAY, "delay.packets = { period_s = 0.1, latency_s = -1, seed = 1, loss.random = { probability = 0.1 } }", "29:47", |_| radio(0.1, -1.0, 0.1), "latency_s"),
    (DELAY, "delay.packets = { period_s = 0.1, latency_s = 0, seed = 1, loss.random = { probability = 1.1 } }", "29:90", |_| radio(0.1, 0.0, 1.1), "loss.random.probability"),
    (DELAY, "delay.packets = { period_s = 1e-7, latency_s = 0, seed = 1, loss.random = { probability = 0.1 } }", "32:10", |_| radio(1e-7, 0.0, 0.1), "packets"),
    (DELAY, "delay.random_hold = { seed = 1, value_s = [0.3, 0.2], hold_s = [1, 2] }", "29:44", |_| RandomHold::draw(1, (0, 1), [0.3, 0.2], [1.0, 2.0], 10.0).map(|_| ()), "value_s[0]"),
    (DELAY, "delay.random_hold = { seed = 1, value_s = [0.1, 0.2], hold_s = [2, 1] }", "29:65", |_| RandomHold::draw(1, (0, 1), [0.1, 0.2], [2.0, 1.0], 10.0).map(|_| ()), "hold_s[0]"),
    (DELAY, "delay.random_hold = { seed = 1, value_s = [0.1, 0.2], hold_s = [1e-9, 1e-9] }", "32:10", |_| RandomHold::draw(1, (0, 1), [0.1, 0.2], [1e-9, 1e-9], 10.0).map(|_| ()), "jumps of the delay"),
];

fn estimate(setup: &mut Setup, change: fn(&mut f64, &mut Estimate)) -> Result<(), QuantityError> {
    let changed = setup.agents[0].change_law(|law: &mut ChainLaw| match &mut law.step {
        ChainStep::Immersion { gain_per_s, estimate, .. } => change(gain_per_s, estimate),
        step => panic!("{step:?}"),
    });
    assert!(changed);
    Ok(())
}

fn steps_of(setup: &mut Setup, gains: &'static [f64]) -> Result<(), QuantityError> {
    let changed = setup.agents[0].change_law(|law: &mut ChainLaw| match &mut law.step {
        ChainStep::Backstepping { gains_per_s, .. } => *gains_per_s = gains.to_vec(),
        step => panic!("{step:?}"),
    });
    assert!(changed);
    Ok(())
}

#[rustfmt::skip]
const OF_DERIVATIVES: &[Case] = &[
    ("gain_per_s = 3", "gain_per_s = -3", "15:14", |s| estimate(s, |gain, _| *gain = -3.0), "gain_per_s"),
    ("gain = [20, 5]", "gain = [20, -5]", "16:24", |s| estimate(s, |_, estimate| estimate.adaptation[1] = -5.0), "adaptation_gain[1]"),
    ("gain = [20, 5]", "gain = [20]", "16:19", |s| estimate(s, |_, estimate| estimate.adaptation.truncate(1)), "adaptation_gain"),
    ("estimate_start.scaled = 0.5", "estimate_start.given = [1]", "17:24", |s| estimate(s, |_, estimate| estimate.start = vec![1.0]), "estimate_start.given"),
];

#[rustfmt::skip]
const OF_CASCADES: &[Case] = &[
    ("gains_per_s = [1, 2]", "gains_per_s = [1, 0]", "18:19", |s| steps_of(s, &[1.0, 0.0]), "gains_per_s[1]"),
    ("gains_per_s = [1, 2]", "gains_per_s = [1, 2, 3]", "18:15", |s| steps_of(s, &[1.0, 2.0, 3.0]), "gains_per_s"),
];

#[test]
fn a_file_and_a_setup_are_refused_in_the_same_words() {
    let mut wrong = Vec::new();
    for (sound, cases) in [(SOUND, CASES), (DERIVATIVES, OF_DERIVATIVES), (CASCADES, OF_CASCADES)] {
        for (from, to, place, change, path) in cases {
            assert_eq!(sound.matches(from).count(), 1, "{from:?} must occur once");
            let of_file = read(&sound.replace(from, to)).and_then(|scenario| scenario.check_recording());
            let of_file = of_file.map_or_else(|error| error.to_string(), |()| "accepted".into());
            let mut setup = read(sound).unwrap().setup;
            let (words, at) = match change(&mut setup) {
                Err(error) => (error.to_string(), error.path.to_string()),
                Ok(()) => {
                    let error = check_recording(&setup).unwrap_err();
                    assert_eq!(simulate(&setup, &mut |_| panic!("a step")).err().as_ref(), Some(&error));
                    let at = error.path(&setup).to_string();
                    match error {
                        SetupError::Quantity(error) => (error.to_string(), at),
                        error => (error.to_string(), at),
                    }
                }
            };
            let at = at.strip_prefix(LAWS).unwrap_or(&at);
            if of_file != format!("test.toml:{place}: {words}") || at != *path {
                wrong.push(format!("{to}\n    {of_file}\n    {place}: {words}\n    {at}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn packets_of_all_links_together_are_limited_for_the_library_too() {
    let mut setup = read(SOUND).unwrap().setup;
    let link = PacketLink {
        every_s: 10.0 / 2.6e6,
        first_s: 0.0,
        latency_s: 0.0,
        jitter_s: 0.0,
        loss: Loss::Never,
        most_in_a_row: None,
        seed: 1,
    };
    let delay = Delay::new(link.trace((0, 1), 10.0).unwrap());
    setup.network.delays[0] = delay.clone();
    assert_eq!(setup.network.validate(10.0), Ok(()));
    setup.network.delays.push(delay);
    let error = SetupError::from(setup.network.validate(10.0).unwrap_err());
    let words = "about 5200000 packets until the end of the run, but at most 5000000 are accepted";
    assert_eq!(error.to_string(), format!("network.delays[1].packets: {words}"));
    // What is too many by less than two digits tell is not said to be as many as are accepted.
    let link = PacketLink { every_s: 10.0 / 2_500_001.0, ..link };
    setup.network.delays = vec![Delay::new(link.trace((0, 1), 10.0).unwrap()); 2];
    let error = SetupError::from(setup.network.validate(10.0).unwrap_err());
    assert!(error.to_string().contains("more than 5000000 packets"), "{error}");
}
