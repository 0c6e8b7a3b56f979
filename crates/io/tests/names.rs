//! Columns and units of the shipped kinds, whose signals are rows of one table.

use std::collections::HashMap;

use forwardstep_io::output::names::{column_name, entry_words, unit};
use forwardstep_io::scenario::open_scenario;
use forwardstep_sim::{Signal, recorded_columns};

/// Names and units of all columns of a shipped scenario.
fn columns(scenario: &str) -> HashMap<String, String> {
    let setup = open_scenario(scenario).unwrap().setup;
    let columns = recorded_columns(&setup).unwrap();
    let named = columns.iter().map(|c| (column_name(&setup, c.agent, c.signal, c.axis), (c.agent, c.signal, c.axis)));
    named.map(|(name, (agent, signal, axis))| (name, unit(&setup, agent, signal, axis))).collect()
}

#[test]
fn every_kind_names_its_columns_and_their_units() {
    let cases: [(&str, &[(&str, &str)]); 6] = [
        (
            "rest-to-rest",
            &[
                ("craft.q.o", "1"),
                ("craft.dq.z", "rad/s"),
                ("craft.wheel_momentum.3", "N m s"),
                ("craft.wheel_torque.1", "N m"),
                ("craft.dz.z", "rad/s^2"),
                ("craft.error.x", "1"),
                ("craft.angle", "rad"),
                ("craft.dy.o", "J^0.5"),
                ("craft.tau.y", "N m"),
                ("craft.dissipation", "J"),
            ],
        ),
        (
            "theorem-6",
            &[
                ("arm.q.elbow", "rad"),
                ("arm.error.y", "m"),
                ("arm.x.x", "m"),
                ("arm.kinematic_hat.length_2_m", "m"),
                ("arm.theta_hat.inertia.coupling", "SI"),
                ("arm.det_jacobian", "m^2"),
                ("arm.tau.shoulder", "N m"),
            ],
        ),
        (
            "formation",
            &[
                ("front.q.z", "m"),
                ("front.attitude.o", "1"),
                ("front.omega.x", "rad/s"),
                ("front.omega_commanded.y", "rad/s"),
                ("front.sigma", "N"),
                ("front.tau.x", "N m"),
                ("front.d2z.y", "m/s^3"),
                ("front.offset.x", "m"),
            ],
        ),
        (
            "strict-feedback",
            &[
                ("second.q.1", "1"),
                ("second.z.1", "1"),
                ("second.dz.1", "1/s"),
                ("second.s.2", "1"),
                ("second.x2.1", "1"),
                ("second.tau.1", "1"),
                ("second.divisor", "1"),
                ("second.lyapunov", "1"),
                ("second.theta_hat.theta2", "1"),
            ],
        ),
        ("without-velocity", &[("mass.q.2", "m"), ("mass.tau.3", "N"), ("mass.dq.1", "m/s")]),
        ("first-order", &[("arm-1.q.elbow", "rad"), ("arm-1.dz.shoulder", "rad/s^2"), ("arm-1.lyapunov", "J")]),
    ];
    for (scenario, expected) in cases {
        let found = columns(scenario);
        for (name, unit) in expected {
            assert_eq!(found.get(*name).map(String::as_str), Some(*unit), "{scenario}: {name}");
        }
    }
}

#[test]
fn entries_in_running_text_say_what_they_are() {
    let words = |scenario, signal, entry| entry_words(&open_scenario(scenario).unwrap().setup, 0, signal, entry);
    assert_eq!(words("rest-to-rest", Signal::WheelTorque, 2), "wheel 3");
    assert_eq!(words("first-order", Signal::Velocity, 1), "elbow");
    assert_eq!(words("without-velocity", Signal::Velocity, 1), "axis 2");
    assert_eq!(words("first-order", Signal::Lyapunov, 0), "");
}
