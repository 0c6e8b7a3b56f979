//! What a scenario states and nothing reads: refused at its line, with the reason.

use super::blind::BLIND;
use super::spacecraft::SPACECRAFT;
use super::tips::TIP;
use super::vehicles::VEHICLES;
use super::{Case, read, refused};

#[rustfmt::skip]
const BLIND_CASES: &[Case] = &[
    ("exchange = \"position\"", "exchange = \"position\"\nmanipulability_gain = 2",
        "test.toml:13:23: agent `mass-1`: the law without velocity has no manipulability gain, but 2 is given", "leave `manipulability_gain` out"),
    ("[reference.consensus]", "[[agents]]\nname = \"other\"\nrobot.point_mass = { dimension = 2, mass_kg = 1 }\nreference.consensus.manipulability_gain = 1\n[reference.consensus]",
        "test.toml:13:43: agent `other`: the law without velocity has no manipulability gain, but 1 is given", "leave `manipulability_gain` out"),
    ("[network]", "[control]\nsample_hz = 100\nnoise = { seed = 1, velocity = 0.01 }\n[network]",
        "test.toml:22:32: the noise of velocities is 0.01, but no law measures velocities", "leave it out"),
    ("[network]", "[control]\nsample_hz = 100\nquantisation.velocity = 0.01\n[network]",
        "test.toml:22:25: the step of velocities is 0.01, but no law measures velocities", "leave it out"),
    ("[network]", "[control]\nsample_hz = 100\nvelocity.filtered_difference.cut_off_hz = 20\n[network]",
        "test.toml:22:1: the cut-off of the filter of velocities is 20, but no law measures velocities", "leave it out"),
    ("[network]", "[start]\nattitude = [0, 0, 0, 1]\n[network]",
        "test.toml:21:12: `attitude` says nothing about `mass-1`", "vehicles, rotorcraft and spacecraft have an attitude"),
];

#[rustfmt::skip]
const TIP_CASES: &[Case] = &[
    ("[reference.tracking]\n", "[reference.tracking]\nroots_per_s = [1, 2]\n",
        "test.toml:14:15: agent `arm`: the list of roots has 2 entries where 0 are needed", "leave `roots_per_s` out"),
    ("[goal]", "[[agents]]\nname = \"other\"\nrobot.point_mass = { dimension = 3, mass_kg = 1 }\nlaw.position_only = {}\ntarget.formulas = [0, 0, 0]\nreference.tracking.roots_per_s = [1, 2, 3]\n[network]\nedges = [[\"arm\", \"other\"]]\n[goal]",
        "test.toml:34:1: agents that follow targets of their own hear no other, but the network has edges (1 in all)", "leave `network` out, or write `reference.consensus`"),
];

#[rustfmt::skip]
const SPACECRAFT_CASES: &[Case] = &[
    ("[reference.tracking]\n", "[reference.tracking]\nroots_per_s = [1, 2]\n",
        "test.toml:23:15: agent `craft`: the list of roots has 2 entries where 0 are needed", "leave `roots_per_s` out"),
    ("[goal]", "[control]\nsample_hz = 100\nnoise = { seed = 1, velocity = 0.01 }\n[goal]",
        "test.toml:32:32: the noise of velocities is 0.01, but no law measures velocities", "leave it out"),
];

#[rustfmt::skip]
const VEHICLES_CASES: &[Case] = &[
    ("gain_per_s = 2", "gain_per_s = 0",
        "test.toml:27:59: `heading_rad` has no effect beside `gain_per_s` = 0", "leave it out"),
    ("start.attitude = [0, 0, 0, 1]", "law.thrust.rate_bandwidth_per_s = 20",
        "test.toml:9:35: `rate_bandwidth_per_s` has no effect: the angular velocity of `vehicle-1` is the one that is asked for", "leave it out, or let the robot be a `rotorcraft`"),
    ("start.attitude = [0, 0, 0, 1]", "start.reference.z = [0, 0, 1]\nlaw.thrust.design = \"continuous\"\nreference.consensus.roots_per_s = [1, 2]",
        "test.toml:9:7: agent `vehicle-1`: the start of the reference has 1 entries where 0 are needed", "leave it out: this law has no reference velocity of its own"),
];

#[test]
fn what_masses_without_velocity_do_not_read_is_refused() {
    refused(BLIND, BLIND_CASES);
}

#[test]
fn what_tips_do_not_read_is_refused() {
    refused(TIP, TIP_CASES);
}

#[test]
fn what_spacecraft_do_not_read_is_refused() {
    refused(SPACECRAFT, SPACECRAFT_CASES);
}

#[test]
fn what_vehicles_do_not_read_is_refused() {
    refused(VEHICLES, VEHICLES_CASES);
}

/// What stands for all may speak to some, but not to nobody.
#[test]
fn what_stands_for_all_is_read_by_somebody() {
    assert!(read(VEHICLES).is_ok());
    let (head, tail) = VEHICLES.split_once("[[agents]]\nname = \"rotor\"").unwrap();
    let (_, tail) = tail.split_once("[reference.consensus]").unwrap();
    let error = read(&format!("{head}[reference.consensus]{tail}")).unwrap_err().to_string();
    assert_eq!(
        error,
        "test.toml:20:24: `rate_bandwidth_per_s` has no effect: the angular velocity of `vehicle-1` is the one that is asked for"
    );
    // Roots of all that track are for those whose laws have roots.
    let other = "[[agents]]\nname = \"other\"\nrobot.point_mass = { dimension = 3, mass_kg = 1 }\n\
                 law.position_only = {}\ntarget.formulas = [0, 0, 0]\n[goal]";
    let both =
        TIP.replace("[goal]", other).replace("[reference.tracking]", "[reference.tracking]\nroots_per_s = [1, 2, 3]");
    let agents = read(&both).unwrap().setup.agents;
    assert_eq!([agents[0].roots_per_s.len(), agents[1].roots_per_s.len()], [0, 3]);
}

/// A mass and a leader.
#[test]
fn what_a_sampled_leader_does_not_read_is_refused() {
    let text = |sign: &str, control: &str| {
        format!(
            "format = 2\ntime.end_s = 5\nleader.motion.formulas = [\"sin(t)\"]\n[[agents]]\nname = \"cart\"\n\
             robot.point_mass = {{ dimension = 1, mass_kg = 2 }}\n[reference.leader]\ndesign = \"continuous\"\n\
             roots_per_s = [1.5]\ngain = 3\nsign_period_s = 0.01\n{sign}\n[network]\nedges = [[\"leader\", \"cart\"]]\n{control}"
        )
    };
    let said = |sign, control| read(&text(sign, control)).err().map(|error| error.to_string());
    assert_eq!(said("", ""), None);
    let control = "[control]\nsample_hz = 100";
    assert_eq!(
        said("", control).as_deref(),
        Some("test.toml:11:17: `sign_period_s` has no effect: sampled controllers set the sign at every sample")
    );
    assert_eq!(
        said("sign.boundary_layer.width = 0.1", "").as_deref(),
        Some("test.toml:11:17: `sign_period_s` has no effect: a boundary layer has its value at every instant")
    );
}
