//! What rows and the numbers made of them say, against what the same rows hold.

use std::fs;
use std::path::Path;

use forwardstep::io::output::names;
use forwardstep::io::scenario::open_scenario;
use forwardstep::sim::Signal;
use serde_json::Value;

use crate::support::{folder, forwardstep, stdout};

/// A run of `text`: its columns by name, its summary, and what was printed.
struct Ran {
    columns: Vec<(String, Vec<f64>)>,
    summary: Value,
    said: String,
}

impl Ran {
    fn of(text: &str, status: i32) -> Ran {
        let here = folder();
        fs::write(here.path().join("one.toml"), text).unwrap();
        let ran = forwardstep(&here, &["run", "one.toml", "--out", "out", "--csv"]).code(status);
        let read = |name: &str| fs::read_to_string(Path::new(here.path()).join("out").join(name)).unwrap();
        let table = read("trajectory.csv");
        let mut lines = table.lines();
        let names = lines.next().unwrap().split(',').map(str::to_owned);
        let mut columns: Vec<(String, Vec<f64>)> = names.map(|name| (name, Vec::new())).collect();
        for line in lines {
            for ((_, values), value) in columns.iter_mut().zip(line.split(',')) {
                values.push(value.parse().unwrap());
            }
        }
        Ran { columns, summary: serde_json::from_str(&read("summary.json")).unwrap(), said: stdout(&ran) }
    }

    fn column(&self, name: &str) -> &[f64] {
        let found = self.columns.iter().find(|(own, _)| own == name);
        &found
            .unwrap_or_else(|| {
                panic!("no column {name} among {:?}", self.columns.iter().map(|c| &c.0).collect::<Vec<_>>())
            })
            .1
    }
}

const CART: &str = "format = 2\ntime = { end_s = 2, record_every_s = 0.05 }\n[[agents]]\nname = \"cart\"\n\
    robot.point_mass = { dimension = 1, mass_kg = 2 }\nstart.position_m = [0]\ntarget.formulas = [\"t\"]\n\
    [reference.tracking]\nroots_per_s = [1, 2]\n[law.known]\ndamping.gain = 5\n[control]\nsample_hz = 4\n";

#[test]
fn regress_a_goal_is_judged_by_the_state_at_the_end_and_not_at_the_last_sample() {
    let ran = Ran::of(&format!("{CART}[goal]\nerror_below = 0.01\n"), 1);
    for (row, t_s) in ran.column("t_s").iter().enumerate() {
        let at = |name: &str| ran.column(&format!("cart.{name}"))[row];
        let s = at("dq.1") - at("z.1");
        assert!((at("error.1") - (at("q.1") - t_s)).abs() < 1e-12, "{t_s}");
        assert!((at("s.1") - s).abs() < 1e-12 && (at("lyapunov") - s * s).abs() < 1e-12, "{t_s}");
    }
    // It is 0.024 from its target, and was 0.0016 from it a period ago.
    assert!(ran.column("cart.error.1").last().unwrap().abs() > 0.02);
    assert!(ran.said.contains("missed"), "{}", ran.said);
}

#[test]
fn regress_the_torque_of_a_spacecraft_is_what_its_wheels_give() {
    let wheel = |axis: &str| format!("{{ axis = {axis}, torque_limit_n_m = 0.5 }}");
    let wheels = ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"].map(wheel).join(", ");
    let craft = format!(
        "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"craft\"\nenforce_limits = true\n\
         start.attitude = {{ axis = [1, 0, 0], angle_rad = 2 }}\ntarget.formulas = [0, 0, 0, 1]\n\
         robot.spacecraft = {{ inertia_kg_m2 = [10, 8, 6], wheels = [{wheels}] }}\n[reference.tracking]\n[law.attitude]\n"
    );
    for control in ["", "[control]\nsample_hz = 50\n"] {
        let ran = Ran::of(&format!("{craft}{control}"), 0);
        let mut limited = 0;
        for (axis, wheel) in [("x", "1"), ("y", "2"), ("z", "3")] {
            let (torque, given) =
                (ran.column(&format!("craft.tau.{axis}")), ran.column(&format!("craft.wheel_torque.{wheel}")));
            assert!(torque.iter().zip(given).all(|(torque, given)| (torque + given).abs() < 1e-12), "{axis}");
            limited += given.iter().filter(|given| given.abs() == 0.5).count();
        }
        assert!(limited > 10, "{limited}");
        assert_eq!(
            !control.is_empty(),
            ran.said.contains("what wheels and rotors limit is not counted"),
            "{}",
            ran.said
        );
        let peaks = ran.summary["metrics"]["peak_torques"].as_array().unwrap();
        assert!(peaks.iter().all(|peak| peak["value"].as_f64().unwrap().abs() <= 0.5), "{peaks:?}");
    }
}

#[test]
fn regress_torques_that_are_rounded_below_their_limit_have_reached_it() {
    let limited = CART.replace("sample_hz = 4", "sample_hz = 50\ntorque_limit = 1.3\nquantisation.torque = 0.5");
    let limited = limited.replace("start.position_m = [0]", "start.velocity_m_s = [3]");
    let ran = Ran::of(&limited, 0);
    let reached = ran.summary["metrics"]["limits_reached"].as_array().unwrap();
    assert!(
        reached.iter().any(|limit| limit["kind"] == "effort" && limit["limit"].as_f64().unwrap().abs() == 1.3),
        "{reached:?}"
    );
}

#[test]
fn regress_what_is_far_apart_moves_and_what_was_never_apart_has_not_to_settle() {
    let masses = |start: &str| {
        format!(
            "format = 2\ntime.end_s = 6\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.point_mass = {{ dimension = 1, mass_kg = 2 }}\n\
             start.position_m = {start}\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n[law.known]\n\
             damping.gain = 5\n[network]\nedges.ring = {{}}\n"
        )
    };
    // The first step is no shorter than one may be, however large numbers are.
    let [far, near] = ["[[0], [5e7]]", "[[0], [1]]"].map(|start| Ran::of(&masses(start), 0));
    let apart = |ran: &Ran| ran.column("m-2.q.1").last().unwrap() - ran.column("m-1.q.1").last().unwrap();
    assert!((apart(&far) / apart(&near) / 5e7 - 1.0).abs() < 1e-4, "{} {}", apart(&far), apart(&near));
    let together = Ran::of(&masses("[[1], [1]]"), 0);
    assert!(!together.said.contains("settled to 1 %") && near.said.contains("settled to 1 %"), "{}", together.said);
}

/// Steps are as long as what settles lets them be, though an enclosure of its derivatives grows without bound.
#[test]
fn regress_formulas_that_settle_doubly_fast_take_no_more_steps_than_others() {
    let masses = |network: &str| {
        format!(
            "format = 2\ntime = {{ end_s = 60, record_every_s = 0.1 }}\n[[agents]]\nname = \"m\"\ncount = 3\n\
             robot.point_mass = {{ dimension = 1, mass_kg = 2 }}\nstart.position_m = [[0], [1], [-2]]\n[reference.consensus]\n\
             roots_per_s = [1, 2]\nexchange = \"position\"\n[law.adaptive]\n[network]\nedges.ring = {{}}\n{network}\n"
        )
    };
    for network in ["weight = \"1 + tanh(exp(t - 5))\"", "delay.formula_s = \"0.3*atan(exp(t - 5))\""] {
        let ran = Ran::of(&masses(network), 0);
        let steps = ran.summary["solver"]["steps"].as_u64().unwrap();
        assert!(steps < 5000, "{network}: {steps}");
    }
}

#[test]
fn regress_z_and_s_of_chains_have_the_unit_of_what_z_leads() {
    let units = |robot: &str, law: &str, start: &str| {
        let text = format!(
            "format = 2\ntime.end_s = 0.1\n[[agents]]\nname = \"c\"\nrobot.{robot}\n{start}\ntarget.formulas = [\"sin(t)\"]\n\
             [reference.tracking]\nroots_per_s = [1, 2, 3]\n[law.{law}]\n"
        );
        let here = folder();
        fs::write(here.path().join("one.toml"), text).unwrap();
        let setup = open_scenario(here.path().join("one.toml").to_str().unwrap()).unwrap().setup;
        [Signal::Reference(0), Signal::Reference(1), Signal::TrackingError]
            .map(|signal| names::unit(&setup, 0, signal, 0))
    };
    assert_eq!(units("chain = { order = 1 }", "linearising", ""), ["1", "1/s", "1"]);
    assert_eq!(units("chain = { order = 2 }", "linearising", ""), ["1/s", "1/s^2", "1/s"]);
    assert_eq!(units("chain = { order = 3 }", "linearising", ""), ["1/s^2", "1/s^3", "1/s^2"]);
    let strict = "strict_feedback = { regressors = [[\"x1\"], [\"0\"]], parameters = [0.1] }";
    assert_eq!(units(strict, "adaptive_backstepping", "start.higher_states = [0.5]"), ["1", "1/s", "1"]);
}

#[test]
fn regress_rotors_that_stand_at_their_limits_are_listed() {
    let craft = |thrust_n: &str, tilted: f64| {
        format!(
            "format = 2\ntime.end_s = 4\n[[agents]]\nname = \"craft\"\ncount = 2\n\
             robot.rotorcraft = {{ mass_kg = 1.2, inertia_kg_m2 = [0.012, 0.012, 0.022], rotors = {{ offset_m = 0.15, drag_m = 0.02, thrust_n = {thrust_n} }} }}\n\
             start.position_m = [[0, 0, 0], [9, 0, 0]]\nstart.attitude = {{ axis = [1, 0, 0], angle_rad = {tilted} }}\n[reference.consensus]\nexchange = \"position\"\nroots_per_s = [1, 1.5, 2]\n[law.thrust]\n\
             design.differentiable = {{ damping_per_s = 3, stiffness = 4 }}\nrate_bandwidth_per_s = 30\n[network]\nedges.ring = {{}}\n"
        )
    };
    let ran = Ran::of(&craft("[2, 4]", 1.2), 0);
    let column = |name: &str| ran.column(&format!("craft-1.{name}"));
    let rows = column("sigma").len();
    let reached = ran.summary["metrics"]["limits_reached"].as_array().unwrap();
    let mut found = 0;
    for (rotor, [x, y, c]) in
        [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]].iter().enumerate()
    {
        let thrust = |row: usize| {
            let tau = |axis: &str| column(&format!("tau.{axis}"))[row];
            0.25 * (column("sigma")[row] + (x * tau("y") - y * tau("x")) / 0.15 + c * tau("z") / 0.02)
        };
        let at = |row: &usize| thrust(*row) < 2.0 + 1e-6 || thrust(*row) > 4.0 - 1e-6;
        let (at_limit, first) = ((0..rows).filter(at).count(), (0..rows).find(at));
        let listed =
            reached.iter().find(|limit| limit["agent"] == 0 && limit["kind"] == "rotor" && limit["axis"] == rotor);
        assert_eq!(listed.is_some(), at_limit > 0, "{rotor}");
        let Some(listed) = listed else { continue };
        found += 1;
        assert_eq!((listed["share"].as_f64().unwrap() * rows as f64).round(), at_limit as f64);
        assert_eq!(listed["first_t_s"].as_f64().unwrap(), ran.column("t_s")[first.unwrap()]);
        assert_eq!((&listed["enforced"], listed["excess"].as_f64()), (&Value::Bool(true), Some(0.0)));
    }
    assert!(found > 0 && ran.said.contains("limits reached"), "{}", ran.said);
    let free = Ran::of(&craft("[0, 100]", 0.0), 0);
    assert_eq!(free.summary["metrics"]["limits_reached"].as_array().unwrap().len(), 0);
}
