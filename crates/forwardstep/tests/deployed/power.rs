//! The mean of Σ sᵀKs beside its bounds, before a run and along it.

use forwardstep::check::{Finding, along, practical};
use forwardstep::io::SourceText;
use forwardstep::io::scenario::read_scenario;
use forwardstep::sim::run;

use super::head;
use crate::support::some;

/// The mean of Σ sᵀKs that is bounded before a run, and along it, and that of the run.
fn powers(scenario: &str) -> [f64; 3] {
    let setup = read_scenario("a loop", &SourceText::new("loop.toml", scenario), None).unwrap().setup;
    let before = practical(&setup).findings.into_iter().find_map(|finding| match finding {
        Finding::TrackingPower(bound) => Some(bound.mean_w),
        _ => None,
    });
    let found = along(&setup, &run(&setup).unwrap().recording).power.unwrap();
    [before.unwrap(), found.bound.unwrap().mean_w, found.mean_w]
}

/// The start was in no state of the way where a run is long or agents are many: of two masses over 2000 s the bound was 10⁻⁷ times what the run had.
#[test]
fn regress_bounds_of_power_know_of_starts_that_are_short_beside_the_run() {
    let masses = |count: usize, end_s: u32, weight: u32| {
        head(end_s, 50.0)
            + &format!(
                "[[agents]]\nname = \"m\"\ncount = {count}\nrobot.point_mass = {{ dimension = 1, mass_kg = 1 }}\n\
                 start.position = {{ random = {{ seed = 2, within = [-0.5, 0.5] }} }}\n[reference.consensus]\nroots_per_s = [1, 2]\n\
                 exchange = \"position_velocity\"\n[law.known]\ndamping.gain = 5\n[network]\nweight = {weight}\nedges.ring.direction = \"both\"\n"
            )
    };
    for (count, end_s, weight) in some([(2, 600, 5), (2, 3000, 5), (16, 100, 110), (40, 100, 110)], 2) {
        let [before, along, seen] = powers(&masses(count, end_s, weight));
        assert!(seen <= before && seen <= along, "{count} over {end_s} s: {seen:e} of {before:e} and {along:e}");
    }
    // What is recorded is no measure of what is looked at before the run.
    let seldom = masses(2, 3000, 5).replacen("end_s = 3000", "end_s = 3000\nrecord_every_s = 1", 1);
    let [before, _, seen] = powers(&seldom);
    assert!(seen <= before, "{seen:e} of {before:e}");
}

/// The motion was taken from state to state of those that are looked at, and swings several times between them in a run that is long.
#[test]
fn regress_what_holding_feeds_is_the_same_however_long_a_motion_lasts() {
    let held_w = |end_s: u32| {
        let scenario = format!(
            "format = 2\ntime = {{ end_s = {end_s}, record_every_s = 0.0025 }}\ncontrol = {{ sample_hz = 400, computation_delay_s = 0.0025 }}\n\
             [[agents]]\nname = \"a\"\nrobot.planar_arm = {{ mass_kg = [1.0, 0.8], length_m = [1.0, 0.8] }}\n\
             start.position_rad = [0.5, 0.3]\ntarget.sinusoids = [{{ offset = 0.5, waves = [{{ amplitude = 0.02, rad_per_s = 30 }}] }}, \
             {{ offset = 0.3, waves = [{{ amplitude = 0.03, rad_per_s = 20 }}] }}]\n[reference.tracking]\nroots_per_s = [1.0, 2.0]\n\
             [law.known]\ndamping.gain = 2\n"
        );
        let setup = read_scenario("a loop", &SourceText::new("loop.toml", &scenario), None).unwrap().setup;
        along(&setup, &run(&setup).unwrap().recording).power.unwrap().bound.unwrap().held_w
    };
    let (short, long) = (held_w(20), held_w(300));
    assert!((0.8..1.5).contains(&(long / short)), "{short:e} {long:e}");
}

/// Until the first torque comes an arm falls; and a filter that begins with zero was unknown to the bound along a run.
#[test]
fn regress_bounds_of_power_know_of_late_first_torques_and_of_filters_that_begin_with_zero() {
    let falling = "format = 2\ntime.end_s = 10\n[[agents]]\nname = \"a\"\ncount = 2\n\
                   robot.planar_arm = { mass_kg = [1.0, 0.8], length_m = [1.0, 0.8] }\nstart.position_rad = [[0.6, 0.3], [0.6, 0.3]]\n\
                   [reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position_velocity\"\n[law.known]\ndamping.gain = 0.8\n\
                   [network]\nedges.ring = {}\n[control]\nsample_hz = 100\ncomputation_delay_s = 0.01\nnoise = { seed = 1, velocity = 1e-4 }\n";
    let filtered = "format = 2\ntime = { end_s = 20, record_every_s = 0.01 }\n[[agents]]\nname = \"a\"\ncount = 2\n\
                    robot.point_mass = { dimension = 1, mass_kg = 2 }\nstart = { position = [[1], [0]], velocity = [2.0] }\n\
                    [reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n[law.known]\ndamping.gain = 20\n\
                    [network]\nedges.ring = {}\n[control]\nsample_hz = 50\nvelocity.filtered_difference = { cut_off_hz = 5 }\n";
    for scenario in [falling, filtered] {
        let [before, along, seen] = powers(scenario);
        assert!(seen <= before && seen <= along, "{seen:e} of {before:e} and {along:e}\n{scenario}");
    }
}

/// A mode that is faster than its filter decays and yet swings up: pushes and noise fed up to 24 times the power that was claimed.
#[test]
fn regress_bounds_of_power_know_how_far_filtered_and_late_loops_swing_up() {
    let mass = |control: &str, more: &str| {
        format!(
            "format = 2\ntime.end_s = 60\ncontrol = {{ {control} }}\n[[agents]]\nname = \"a\"\ncount = 2\n\
             robot.point_mass = {{ dimension = 1, mass_kg = 1 }}\nstart.position_m = [[0], [0]]\n[reference.consensus]\nroots_per_s = [1, 2]\n\
             exchange = \"position\"\n[law.known]\ndamping.gain = 80\n[network]\nedges.ring = {{}}\n{more}"
        )
    };
    let push = |rate: f64| format!("[[external_wrenches]]\non = [\"a-1\"]\nby.force_n = [\"sin({rate}*t)\"]\n");
    let filtered = "sample_hz = 1000, velocity.filtered_difference.cut_off_hz = 2";
    // A torque a period late, with nine tenths of the gain that it bears.
    let late = "sample_hz = 89, computation_delay_s = 0.011";
    let noisy = "sample_hz = 100, velocity.filtered_difference.cut_off_hz = 0.5, noise = { seed = 1, position = 1e-3 }";
    // Where it swings most, the bound is nearly reached.
    for (scenario, most) in [
        (mass(filtered, &push(31.7)), 3.0),
        (mass(filtered, &push(25.0)), 200.0),
        (mass(filtered, &push(4.0)), 200.0),
        (mass(late, &push(92.0)), 10.0),
        (mass(late, &push(60.0)), 200.0),
        (mass(noisy, ""), 3.0),
    ] {
        let [before, along, seen] = powers(&scenario);
        // What noise makes is to be expected: one run may have more by chance, as slow swings are few.
        let chance = if scenario.contains("noise") { 1.2 } else { 1.0 };
        assert!(seen <= chance * before && seen <= chance * along, "{seen:e} of {before:e} and {along:e}\n{scenario}");
        assert!(before < most * seen, "{seen:e} of {before:e}, which says little\n{scenario}");
    }
}

/// What errors of positions make of M, C and g, and of what references ask, was in no part of the bound: 7e-5 W of 2e-10 W.
#[test]
fn regress_bounds_of_power_know_of_errors_of_positions() {
    let arms = |error: &str, gravity: &str| {
        format!(
            "format = 2\ntime.end_s = 100\ncontrol = {{ sample_hz = 500, {error} }}\n[[agents]]\nname = \"a\"\ncount = 2\n\
             robot.planar_arm = {{ mass_kg = [2, 1.5], length_m = [1, 0.8]{gravity} }}\nstart.position_rad = [[0.1, 0.2], [0.15, 0.1]]\n\
             [law.known]\ndamping.gain = 2\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position_velocity\"\n\
             [network]\nedges.ring = {{}}\n"
        )
    };
    // Of masses nothing depends on positions, but what references hear comes late.
    let masses = "format = 2\ntime.end_s = 200\ncontrol = { sample_hz = 20, computation_delay_s = 0.05, noise = { seed = 3, position = 0.02 } }\n\
                  [[agents]]\nname = \"a\"\ncount = 2\nrobot.point_mass = { dimension = 1, mass_kg = 10 }\nstart.position_m = [[0.1], [0.15]]\n\
                  [law.known]\ndamping.gain = 30\n[reference.consensus]\nroots_per_s = [2, 2]\nexchange = \"position_velocity\"\n\
                  [network]\nedges.ring = {}\n";
    let [before, along, seen] = powers(masses);
    assert!(seen <= before && seen <= along, "{seen:e} of {before:e} and {along:e}");
    for gravity in ["", ", gravity_m_s2 = 0"] {
        for error in ["noise = { seed = 3, position = 0.02 }", "quantisation.position = 0.02"] {
            let scenario = arms(error, gravity);
            let [before, along, seen] = powers(&scenario);
            assert!(seen <= before && seen <= along, "{seen:e} of {before:e} and {along:e}\n{scenario}");
        }
    }
}
