//! Witnesses: what is violated, shown by numbers that the checker replays.

use std::fs;

use super::{certified, changed, checked, judged, proof, root};
use crate::support::{folder, some};

fn violated(text: &str, id: &str, kind: &str) {
    assert_eq!(judged(text, id), ("violated".to_owned(), "accepted".to_owned()), "{id}: {text}");
    assert_eq!(proof(text, id)["kind"], kind, "{id}");
}

/// The third derivative of a curve jumps at its points and has no value there: the witness is another time.
#[test]
fn regress_a_leader_through_points_is_refuted_between_them() {
    violated(&changed("remark-12", "times_s = [2, 6, 10", "times_s = [2, 3, 10"), "sign-gain", "instant");
}

#[test]
fn regress_a_target_in_the_hole_that_a_long_tool_leaves_is_refuted() {
    let longer = changed("pose-ur5e", "at_m = [0, 0, 0.15]", "at_m = [0, 3, 0.15]")
        .replace("given = [0, 0, 0.1]", "given = [0, 3, 0.1]")
        .replace("upper_m = [0.05, 0.05, 0.3]", "upper_m = [0.05, 3.05, 0.3]");
    violated(&longer, "target-within-reach", "out-of-reach");
}

/// Of an attitude through points no entry keeps away from zero, and the last point comes after the run.
#[test]
fn regress_an_attitude_through_points_is_judged_for_all_time() {
    let text = fs::read_to_string(super::file_of("rest-to-rest")).unwrap();
    let (from, to) = (text.find("[agents.target.points]").unwrap(), text.find("[agents.robot").unwrap());
    let turning = |last: &str| {
        let positions = format!("[[1, 0, 0, 0], [0, 1, 0, 0], {last}]");
        let points = format!("[agents.target.points]\ntimes_s = [1, 40, 80]\npositions = {positions}\n\n");
        format!("{}{points}{}", &text[..from], &text[to..])
    };
    assert_eq!(judged(&turning("[0, 0, 1, 0]"), "nonzero-quaternion"), ("holds".to_owned(), "accepted".to_owned()));
    // It comes to rest at zero after the run.
    assert_eq!(judged(&turning("[0, 0, 0, 0]"), "nonzero-quaternion").0, "not shown");
}

fn watched(text: &str, id: &str) {
    assert_eq!(judged(text, id), ("watched during the run".to_owned(), "could not check".to_owned()), "{id}: {text}");
}

#[test]
fn a_start_at_which_the_jacobian_is_singular_comes_with_the_vector_that_it_takes_to_zero() {
    let arm = |q: &str| changed("theorem-6", "start.position_rad = [0.2, 1.4]", &format!("start.position_rad = {q}"));
    violated(&arm("[0.2, 0.0]"), "regular-jacobian", "left-null");
    // Folded back; no binary number is π.
    violated(&arm("[0.2, 3.141592653589793]"), "regular-jacobian", "left-null");
    violated(&arm("[0.2, 1e-7]"), "regular-jacobian", "left-null");
    watched(&arm("[0.2, 1e-4]"), "regular-jacobian");
    // The elbow of a UR5e is straight.
    let straight = changed("pose-ur5e", "0.4, -1.2, 1.6, -1.9", "0.4, -1.2, 0.0, -1.9");
    violated(&straight, "regular-jacobian", "left-null");
    // Its wrist is.
    let wrist = changed("pose-ur5e", "-1.9, -1.5, 0.3", "-1.9, 0.0, 0.3");
    violated(&wrist, "regular-jacobian", "left-null");
}

/// Through a joint that slides and one about an oblique axis, with an uncertain tool and with all lengths uncertain.
#[test]
fn a_singular_start_has_its_witness_whatever_carries_the_tip() {
    let folder = folder();
    let cases = root().join("checker/cases");
    fs::copy(cases.join("slider.urdf"), folder.path().join("slider.urdf")).unwrap();
    let text = fs::read_to_string(cases.join("slider.toml")).unwrap();
    let file = folder.path().join("own.toml");
    for (uncertain, bend, expected) in [
        ("tool", "-0.6435011087932844", ("violated", "accepted")),
        ("chain", "-0.6435011087932844", ("violated", "accepted")),
        ("chain", "2.498091544796509", ("violated", "accepted")),
        ("tool", "-0.6434", ("watched during the run", "could not check")),
        ("chain", "0", ("watched during the run", "could not check")),
    ] {
        let text = text.replace("at_m = [0.05, 0, 0]", &format!("at_m = [0.05, 0, 0], uncertain = \"{uncertain}\""));
        fs::write(&file, text.replace("-0.6435011087932844", bend)).unwrap();
        let found = checked(&certified(file.to_str().unwrap(), folder.path()), &file);
        let entries = found["entries"].as_array().unwrap();
        assert!(entries.iter().all(|entry| entry["outcome"] != "rejected"), "{found}");
        let entry = entries.iter().find(|entry| entry["id"] == "regular-jacobian").unwrap();
        assert_eq!(
            (entry["answer"].as_str().unwrap(), entry["outcome"].as_str().unwrap()),
            expected,
            "{uncertain} {bend}"
        );
    }
}

/// Of a spacecraft with this target what `check` answers about its quaternion, and what the checker says.
fn quaternion(target: &str) -> (String, String) {
    judged(
        &changed("theorem-7", "target.formulas = [0, 0, 0, 1]", &format!("target.formulas = {target}")),
        "nonzero-quaternion",
    )
}

#[test]
fn an_attitude_that_fades_or_turns_over_is_refuted_by_its_limit_a_time_or_a_change_of_sign() {
    let craft =
        |target: &str| changed("theorem-7", "target.formulas = [0, 0, 0, 1]", &format!("target.formulas = {target}"));
    let refuted = |target: &str, kind: &str| violated(&craft(target), "nonzero-quaternion", kind);
    refuted(r#"["0.5*exp(-t)", "exp(-2*t)", 0, "1/(1+t)"]"#, "fades");
    refuted(r#"[0, 0, "exp(-t)", "exp(-t)"]"#, "fades");
    // After the run, which ends at 60 s: all entries together, and without a change of sign.
    refuted(r#"[0, 0, 0, "1 - t/90"]"#, "vanishes");
    refuted(r#"[0, "2 - t/45", "3*(1 - t/90)", "1 - t/90"]"#, "vanishes");
    refuted(r#"["(1 - t/90)^2", 0, "abs(sin(0.05*(t - 90)))", 0]"#, "vanishes");
    // At no rational time.
    refuted(r#"[0, 0, "cos(0.02*t)", "0*t"]"#, "changes-sign");
    refuted(r#"["-cos(0.02*t)", 0, "3*cos(0.02*t)", "cos(0.02*t)/7"]"#, "changes-sign");
    // It stays, or two entries vanish at two times.
    for apart in [r#"[0, 0, 0, "1 + 1/(1+t)"]"#, r#"[0, 0, "sin(0.02*t)", "cos(0.02*t)"]"#] {
        assert_eq!(quaternion(apart).0, "holds", "{apart}");
    }
}

/// Two entries that pass zero a millionth of a second apart were said to vanish together.
#[test]
fn regress_an_attitude_that_only_comes_close_to_zero_is_not_called_violated() {
    for close in [
        r#"[0, 0, "sin(t)", "cos(t)*cos(t/100) + 1e-6"]"#,
        r#"[0, "1e-12", "1 - t/90", 0]"#,
        r#"[0, 0, "sin(0.02*t)", "sin(0.02*t) + 1e-12*cos(0.02*t)"]"#,
    ] {
        assert_ne!(quaternion(close).0, "violated", "{close}");
    }
    // Small beside what it is at other times, and an attitude all the same.
    for meaningful in [r#"[0, "1e-6", "sin(t)", "cos(t)*cos(t/10)"]"#, r#"[0, 0, "exp(t)", "1"]"#] {
        assert_eq!(quaternion(meaningful), ("holds".to_owned(), "accepted".to_owned()), "{meaningful}");
    }
}

#[test]
fn a_target_that_swings_ever_wider_is_refuted() {
    let driven = |target: &str, law: &str| {
        format!(
            "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.point_mass = {{ mass_kg = 2, dimension = 1 }}\n\
             start.position_m = [[0.0], [1.0]]\ntarget.formulas = [\"{target}\"]\n\
             [reference.tracking]\nroots_per_s = [1.0, 2.0]\n{law}"
        )
    };
    let masses = |target: &str| driven(target, "");
    for target in some(
        [
            "t*sin(t)",
            "3 - t*cos(2*t)*t^2",
            "t*sin(t) + 1/(1+t)",
            "-(t^2*cos(t))",
            "sin(t^2)",
            "cos(1 - t^2)/2",
            "t*sin(t)/10",
        ],
        3,
    ) {
        violated(&masses(target), "bounded-target", "diverges");
    }
    // Where the position counts, it is enough.
    let blind = driven("t", "[law.position_only]\n").replace("[1.0, 2.0]", "[1.0, 1.5, 2.0]");
    violated(&blind, "bounded-target", "diverges");
    let holds = ("holds".to_owned(), "accepted".to_owned());
    assert_eq!(judged(&masses("t"), "bounded-target"), holds);
    // In linear dynamics of one's own q_d drops out, and not where a protocol holds it against q.
    let own = |more: &str| {
        let roots = "[reference.tracking]\nroots_per_s = [1.0, 2.0]\n";
        masses("t").replace(roots, &format!("[reference.desired]\npolynomial = [1, 2]\nfollows_target = true\n{more}"))
    };
    assert_eq!(judged(&own(""), "bounded-target"), holds);
    let protocol = "nonlinear = \"-0.1*tanh(x - xd)\"\nstable_because = \"it pulls as the rest does\"\n";
    violated(&own(protocol), "bounded-target", "diverges");
    for target in ["sin(t)", "sin(t)/(1+t)", "t*sin(t)*exp(-t)"] {
        assert_ne!(judged(&masses(target), "bounded-target").0, "violated", "{target}");
    }
}

/// The edge is one of a phase that comes back, or stays.
#[test]
fn a_link_over_which_everything_is_too_old_is_a_witness() {
    let masses = |delay: &str, switching: &str| {
        format!(
            "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.point_mass = {{ mass_kg = 2, dimension = 1 }}\n\
             start.position_m = [[0.0], [1.0]]\n[reference.consensus]\nroots_per_s = [1.0, 2.0]\nexchange = \"position\"\n\
             [control]\nsample_hz = 100\nmessage_timeout_s = 0.25\n[network]\nswitching = \"{switching}\"\ndelay.constant_s = 0.1\n\
             [[network.phases]]\ndwell_s = 1\nedges = [[\"m-1\", \"m-2\"]]\n[[network.phases]]\ndwell_s = 1\n\
             edges = [{{ from = \"m-2\", to = \"m-1\", delay.{delay} }}]\n"
        )
    };
    for switching in ["repeat", "once"] {
        for delay in ["constant_s = 0.3", "packets = { period_s = 0.1, latency_s = 0.26, jitter_s = 0.1, seed = 1 }"] {
            violated(&masses(delay, switching), "messages-in-time", "older");
        }
        assert_eq!(judged(&masses("constant_s = 0.25", switching), "messages-in-time").0, "not shown");
    }
    assert_eq!(
        judged(&masses("constant_s = 0.24", "repeat"), "messages-in-time"),
        ("holds".to_owned(), "accepted".to_owned())
    );
}

/// What has a value in no neighbourhood of rounded numbers, and what is too small where the run begins.
#[test]
fn terms_and_factors_of_chains_are_refuted_by_a_state() {
    let chain = |terms: &str| {
        format!(
            "format = 2\ntime.end_s = 20\n[[agents]]\nname = \"c\"\nrobot.chain = {{ order = 2, {terms} }}\nstart.position = [0.5]\n\
             target.formulas = [\"sin(t)\"]\n[reference.tracking]\nroots_per_s = [1, 2]\n[law.linearising]\n"
        )
    };
    violated(&chain("chi = \"1/(1 + x*dx)\""), "defined-terms", "no-value");
    violated(&chain("psi = \"0.0005 + 0.0002*sin(x)\""), "input-factor", "factor");
    // Above one a power of what comes to zero has a slope there.
    let smooth = judged(&chain("chi = \"abs(x)^1.5\""), "defined-terms");
    assert_eq!(smooth, ("holds".to_owned(), "accepted".to_owned()));
}

/// A run that ends before its first step is refuted before it, whatever it is that a law divides by.
#[test]
fn regress_what_a_law_divides_by_is_looked_at_where_it_starts() {
    let one = |robot: &str, position: &str, target: &str, rest: &str| {
        format!(
            "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"one\"\n{robot}\nstart.position = {position}\n\
             target.formulas = {target}\n[reference.tracking]\nroots_per_s = [1, 2]\n{rest}\n"
        )
    };
    let matrix = |psi: &str| format!("robot.vector_chain = {{ order = 1, chi = [\"0\", \"-x2\"], psi = {psi} }}");
    let tanks = |psi: &str| one(&matrix(psi), "[0.4, -0.2]", "[\"sin(t)\", \"0\"]", "[law.linearising]");
    violated(&tanks(r#"[["x1 - 0.4", "0"], ["0", "2"]]"#), "input-factor", "null-vector");
    violated(&tanks(r#"[["1", "2"], ["2", "3.6 + x1"]]"#), "input-factor", "null-vector");
    violated(&tanks(r#"[["0.001", "0"], ["0", "0.0009"]]"#), "input-factor", "null-vector");
    assert_eq!(judged(&tanks(r#"[["x1 - 0.5", "0"], ["0", "2"]]"#), "input-factor").0, "watched during the run");

    let chain = |known: &str| {
        let robot = format!(
            "robot.pure_feedback = {{ known = [\"{known}\", \"0\"], regressors = [[\"0\"], [\"x1\"]], parameters = [0.1] }}\n\
             start.higher_states = [0.5]"
        );
        one(&robot, "[0.5]", "[\"sin(t)\"]", "[law.adaptive_backstepping]\ngains_per_s = 1\nadaptation_gain = 1")
    };
    assert_eq!(judged(&chain("(x2 - 0.5)^3"), "input-factor").0, "violated");
    assert_eq!(judged(&chain("x2^3"), "input-factor").0, "watched during the run");

    let vehicle = |law: &str| {
        format!(
            "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"own\"\ncount = 2\nrobot.vehicle = {{ mass_kg = 2 }}\n\
             start.position_m = [[0, 0, 0], [1, 0, 0]]\n[reference.consensus]\nroots_per_s = [1, 2, 3]\nexchange = \"position\"\n\
             [law.thrust]\n{law}\n[network]\n\
             edges = [[\"own-1\", \"own-2\"], [\"own-2\", \"own-1\"]]\n"
        )
    };
    violated(&vehicle("thrust_start_n = 1"), "nonzero-thrust", "starts-below");
    violated(&vehicle("floor.stops_n = 20"), "nonzero-thrust", "starts-below");
    assert_eq!(judged(&vehicle("thrust_start_n = 3"), "nonzero-thrust").0, "watched during the run");
    assert_eq!(
        judged(&vehicle("thrust_start_n = 1\nfloor.kept.thrust_n = 2"), "nonzero-thrust").0,
        "not covered by the paper"
    );
}

/// A planar arm of one metre and 0.8 m on a run of 20 s.
fn reaching(target: &str) -> String {
    format!(
        "format = 2\ntime.end_s = 20\n[[agents]]\nname = \"arm\"\nrobot.planar_arm = {{ mass_kg = [2, 1.5], length_m = [1, 0.8] }}\n\
         start.position_rad = [0.6, 0.9]\ntarget.{target}\n[reference.tracking]\n[law.task_space]\n"
    )
}

#[test]
fn regress_a_target_is_within_reach_for_all_time_or_leaves_it_after_the_run() {
    let id = "target-within-reach";
    violated(&reaching("formulas = [\"1 + 0.9*sin(t/100)\", \"0\"]"), id, "out-of-reach");
    let wave = |amplitude: f64, rate: f64, phase: f64| {
        format!("waves = [{{ amplitude = {amplitude}, rad_per_s = {rate}, phase_rad = {phase} }}]")
    };
    let slow = wave(0.9, 0.01, 0.0);
    violated(&reaching(&format!("sinusoids = [{{ offset = 1, {slow} }}, {{ offset = 0 }}]")), id, "out-of-reach");
    let circle = reaching(&format!("sinusoids = [{{ {} }}, {{ {} }}]", wave(1.4, 1.0, 1.57), wave(1.4, 1.0, 0.0)));
    assert_eq!(judged(&circle, id), ("holds".to_owned(), "accepted".to_owned()));
    let edge = reaching("formulas = [\"1.8\", \"0\"]");
    assert_eq!(judged(&edge, id), ("not shown".to_owned(), "could not check".to_owned()));
}

/// A quaternion of any length is an attitude: that one grows says nothing of where a spacecraft turns.
#[test]
fn regress_a_quaternion_that_grows_refutes_no_bound_of_an_attitude() {
    for law in ["passivity_filter", "attitude"] {
        let text = format!(
            "format = 2\ntime.end_s = 20\n[[agents]]\nname = \"craft\"\ntarget.formulas = [0, 0, \"t + 1\", \"t + 1\"]\n\
             robot.spacecraft = {{ inertia_kg_m2 = [[10, 0.5, -0.3], [0.5, 8, 0.2], [-0.3, 0.2, 6]] }}\n[reference.tracking]\n[law.{law}]\n"
        );
        let expected = ("not shown".to_owned(), "could not check".to_owned());
        assert_eq!(judged(&text, "bounded-target"), expected, "{law}");
    }
}

/// The sum of the sizes of every derivative is 5.415, the largest value 3.864.
#[test]
fn regress_two_waves_without_a_common_period_need_no_larger_gain_than_they_come_to() {
    let folder = folder();
    let file = folder.path().join("own.toml");
    let own = "format = 2\ntime.end_s = 30\n[leader]\nmotion.formulas = [\"sin(t) + sin(sqrt(2)*t)\"]\n[[agents]]\nname = \"m\"\n\
               robot.point_mass = { dimension = 1, mass_kg = 2 }\nstart.position_m = [0.5]\n[reference.leader]\n\
               design = \"continuous\"\nroots_per_s = [1]\ngain = 4\n[law.known]\n[network]\nedges = [[\"leader\", \"m\"]]\n";
    fs::write(&file, own).unwrap();
    let found = checked(&certified(file.to_str().unwrap(), folder.path()), &file);
    let entry = found["entries"].as_array().unwrap().iter().find(|entry| entry["id"] == "sign-gain").unwrap().clone();
    assert_eq!(entry["answer"], "holds", "{found}");
}
