//! The mean of Σ sᵀKs beside its bounds, before a run and along it.

use forwardstep::check::{Finding, along, practical};
use forwardstep::io::SourceText;
use forwardstep::io::scenario::read_scenario;
use forwardstep::sim::run;

use super::head;

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
    for (count, end_s, weight) in [(2, 600, 5), (2, 3000, 5), (16, 100, 110), (40, 100, 110)] {
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
