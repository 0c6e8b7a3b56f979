//! Cases that lie close to the edge of a hypothesis, and statements that have to be true there.

use std::fs;

use super::{answered, with};
use crate::support::{folder, forwardstep, stderr, stdout};

/// Two masses that hear each other, and more.
fn masses(more: &str) -> String {
    format!(
        "format = 2\ntime.end_s = 10\n[[agents]]\nname = \"m\"\ncount = 2\n\
         robot.point_mass = {{ dimension = 1, mass_kg = 2 }}\nstart.position_m = [[1.0], [0.0]]\n\
         [reference.consensus]\nroots_per_s = [1.0, 2.0]\nexchange = \"position_velocity\"\n[law.known]\ndamping.gain = 5\n\
         [network]\nedges = [[\"m-1\", \"m-2\"], [\"m-2\", \"m-1\"]]\n{more}"
    )
}

/// Two chains that hear each other.
fn chains(robot: &str, law: &str) -> String {
    format!(
        "format = 2\ntime.end_s = 10\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.{robot}\nstart.position = [[1.0], [-0.8]]\n\
         [reference.consensus]\nroots_per_s = [1.0, 2.0]\nexchange = \"position\"\n[law.{law}]\n\
         [network]\nedges = [[\"m-1\", \"m-2\"], [\"m-2\", \"m-1\"]]\n"
    )
}

/// What is said where a scenario is refused.
fn refused(text: &str) -> String {
    let folder = with(text);
    stderr(&forwardstep(&folder, &["check", "two.toml"]).code(2))
}

fn answer(text: &str, id: &str) -> String {
    answered(&folder(), text, id).0
}

/// A planar arm of one metre and 0.8 m as a URDF, in the plane of x and z.
const FLAT: &str = r#"<robot name="r"><link name="base"/>
<link name="one"><inertial><origin xyz="0.5 0 0"/><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="two"><inertial><origin xyz="0.4 0 0"/><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="a" type="revolute"><parent link="base"/><child link="one"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="100" velocity="5"/></joint>
<joint name="b" type="revolute"><parent link="one"/><child link="two"/><origin xyz="1 0 0"/><axis xyz="0 -1 0"/><limit lower="-3" upper="3" effort="100" velocity="5"/></joint>
</robot>"#;

#[test]
fn regress_a_target_nearer_than_a_folded_arm_of_a_urdf_is_out_of_reach() {
    let folder = folder();
    let found = |urdf: &str, target: &str| {
        fs::write(folder.path().join("flat.urdf"), urdf).unwrap();
        let text = format!(
            "format = 2\ntime.end_s = 10\n[[agents]]\nname = \"arm\"\nrobot.urdf.file = \"flat.urdf\"\n\
             start.position_rad = [0.2, 1.0]\ntarget.formulas = {target}\n[reference.tracking]\n[law.task_space]\n\
             end_effector = {{ link = \"two\", at_m = [0.8, 0, 0], coordinates = [\"x\", \"z\"] }}\n"
        );
        answered(&folder, &text, "target-within-reach").0
    };
    // 0.1 m from the first joint, where the arm folded back ends at 0.2 m.
    assert_eq!(found(FLAT, r#"["0.1*cos(t)", "0.3 + 0.1*sin(t)"]"#), "violated");
    assert_eq!(found(FLAT, r#"["0.5 + 0.1*cos(t)", "0.3 + 0.1*sin(t)"]"#), "holds");
    assert_eq!(found(FLAT, r#"["1.9*cos(t)", "0.3"]"#), "violated");
    // An elbow that turns out of the plane comes nearer in it.
    let turned = FLAT.replace("<axis xyz=\"0 -1 0\"/>", "<axis xyz=\"0 0 1\"/>");
    assert_eq!(found(&turned, r#"["0.1*cos(t)", "0.3 + 0.1*sin(t)"]"#), "holds");
}

#[test]
fn regress_a_small_slip_in_an_antiderivative_is_found() {
    let of = |antiderivative: &str| {
        let robot = r#"chain = { order = 2, regressor = ["0.3*dx"], parameters = [-0.5] }"#;
        let law = "immersion]\ngain_per_s = 2\nadaptation_gain = 4\nantiderivatives = [\"Φ\"";
        chains(robot, law).replace('Φ', antiderivative)
    };
    for slip in ["0.15*dx^2 + 1e-12*dx^3", "0.15*dx^2 + 1e-14*dx^3", "0.15*dx^2*(1 + 1e-12)"] {
        let said = refused(&of(slip));
        assert!(said.contains("the antiderivative of regressor 1 has the slope"), "{slip}: {said}");
    }
    for right in ["0.15*dx^2", "0.3*dx^2/2", "dx^2*(0.1 + 0.2)/2 + sin(x)"] {
        assert_eq!(answer(&of(right), "defined-terms"), "holds", "{right}");
    }
}

#[test]
fn regress_digits_that_would_be_lost_are_refused() {
    let roots = |own: &str| masses("").replace("[1.0, 2.0]", own);
    let said = refused(&roots("[1.00000000000000000001, 2.0]"));
    assert!(said.contains("1.00000000000000000001 has more digits than are computed with"), "{said}");
    assert!(said.contains("write 1.0"), "{said}");
    // What programs print for any `f64`, and zeros that say nothing.
    for fine in [
        "[0.30000000000000004, 2.0]",
        "[0.29999999999999999, 2.0]",
        "[1.000000000000000000000, 200000000000000000000e-20]",
    ] {
        assert_eq!(answer(&roots(fine), "real-roots"), "holds", "{fine}");
    }
}

#[test]
fn regress_a_ship_on_the_edge_of_a_singular_inertia_is_refused() {
    let ship = |inertia: &str| {
        masses("")
            .replace(
                "point_mass = { dimension = 1, mass_kg = 2 }",
                &format!("ship = {{ inertia = {{ surge_kg = 5, {inertia} }} }}"),
            )
            .replace("position_m = [[1.0], [0.0]]", "position = [[1.0, 0, 0], [0.0, 0, 0]]")
    };
    // 0.1 · 0.9 is 0.3², which `f64` takes to be more.
    for singular in
        ["sway_kg = 0.1, sway_yaw_kg_m = 0.3, yaw_kg_m2 = 0.9", "sway_kg = 4, sway_yaw_kg_m = -2, yaw_kg_m2 = 1"]
    {
        let said = refused(&ship(singular));
        assert!(said.contains("`sway_yaw_kg_m` is") && !said.contains("from -2 to 2"), "{said}");
    }
    assert_eq!(answer(&ship("sway_kg = 0.1, sway_yaw_kg_m = 0.29, yaw_kg_m2 = 0.9"), "uniform-inertia"), "holds");
}

#[test]
fn regress_a_push_that_is_zero_from_some_time_on_ends() {
    let pushed = |force: &str| masses(&format!("[[external_wrenches]]\non = [\"m-1\"]\nby.force_n = [{force}]\n"));
    for ends in ["\"0.1 + 0.2 - 0.3\"", "0", "\"max(0, 5 - t)\"", "\"min(1, max(0, 700 - t))\""] {
        assert_eq!(answer(&pushed(ends), "pushes-end"), "holds", "{ends}");
    }
    for stays in ["1e-300", "\"1/sqrt(1 + t)\"", "\"max(0, sin(t))\"", "\"max(0, t - 50)\""] {
        assert_eq!(answer(&pushed(stays), "pushes-end"), "not covered by the paper", "{stays}");
    }
}

/// The run ends at 10 s, the push at 60 s.
#[test]
fn regress_a_push_that_has_a_pole_after_the_run_does_not_just_end() {
    let pushed = |force: &str| {
        masses(&format!("[[external_wrenches]]\non = [\"m-1\"]\nfrom_s = 5\nfor_s = 55\nby.force_n = [\"{force}\"]\n"))
    };
    for ends in ["2 + sin(3*t)", "1/(t - 3)", "1/(t - 61)", "1/(t + 1)", "log(61 - t)"] {
        assert_eq!(answer(&pushed(ends), "pushes-end"), "holds", "{ends}");
    }
    for unbounded in ["1/(t - 50)", "1/(t - 60)", "1/(t - 50)^2", "log(45 - t)", "exp(1/(t - 50))"] {
        assert_eq!(answer(&pushed(unbounded), "pushes-end"), "not shown", "{unbounded}");
    }
    let spring = masses(
        "[[external_wrenches]]\non = [\"m-1\"]\nfor_s = 60\nby.virtual_spring_on_axes = { stiffness = 10, target_m = [\"1/(t - 50)\"] }\n",
    );
    assert_eq!(answer(&spring, "pushes-end"), "not shown");
}

#[test]
fn regress_a_delay_that_begins_after_the_run_is_one() {
    let led = |delay: &str| {
        let text =
            masses(&format!("delay.formula_s = \"{delay}\"\n")).replace("[\"m-2\", \"m-1\"]", "[\"leader\", \"m-1\"]");
        let (from, to) = (text.find("[reference").unwrap(), text.find("[law").unwrap());
        let leader = "[leader]\nmotion.formulas = [\"sin(t)\"]\n[reference.leader]\ndesign = \"differentiable\"\nroots_per_s = [1, 1]\ngain = 3\n";
        format!("{}{leader}{}", &text[..from], &text[to..])
    };
    for late in ["0.3*max(0, min(1, t - 50))", "max(0, t - 50)*exp(-t)"] {
        assert_ne!(answer(&led(late), "no-delay"), "holds", "{late}");
    }
    for prompt in ["0", "0*t", "min(0, t)"] {
        assert_eq!(answer(&led(prompt), "no-delay"), "holds", "{prompt}");
    }
}

/// Two that hear each other and have different first roots, which only a network that never changes lets agree.
#[test]
fn regress_a_delay_that_changes_after_the_run_is_not_constant() {
    let apart = |delay: &str| {
        let one =
            "[[agents]]\nname = \"m-1\"\nrobot.point_mass = { dimension = 1, mass_kg = 2 }\nstart.position_m = [1]\n";
        let agents = format!(
            "{one}reference.consensus.roots_per_s = [4, 2]\n{}reference.consensus.roots_per_s = [0.2, 2]\n",
            one.replace("m-1", "m-2")
        );
        let text = masses(&format!("delay.formula_s = \"{delay}\"\n"));
        let (from, to) = (text.find("[[agents]]").unwrap(), text.find("[reference").unwrap());
        format!("{}{agents}{}", &text[..from], &text[to..]).replace("roots_per_s = [1.0, 2.0]\n", "")
    };
    for stays in ["0.3", "0.1 + 0.2", "0.3 + min(0, 1)"] {
        assert_eq!(answer(&apart(stays), "common-first-root"), "holds", "{stays}");
    }
    // Until then each is a number, and some of them that very number in binary digits.
    for changes in [
        "0.3 + 0.1*max(0, min(1, t - 50))",
        "0.3 + 0.1*min(1, max(0, t - 50))*sin(t^2)",
        "0.25 + 0.25*min(1, max(0, t - 50))",
        "min(1, max(0, t - 50))",
        "max(0, t - 50)",
    ] {
        assert_ne!(answer(&apart(changes), "common-first-root"), "holds", "{changes}");
    }
}

#[test]
fn regress_a_quaternion_that_grows_is_no_attitude_that_does() {
    let craft = |target: &str| {
        let shipped =
            fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../io/scenarios/theorem-7.toml")).unwrap();
        shipped.replace("target.formulas = [0, 0, 0, 1]", &format!("target.formulas = {target}"))
    };
    assert_eq!(answer(&craft(r#"[0, 0, "t", 1]"#), "bounded-target"), "not shown");
    assert_eq!(answer(&craft(r#"[0, 0, "sin(0.1*t)", "cos(0.1*t)"]"#), "bounded-target"), "holds");
}

#[test]
fn regress_of_two_times_at_which_a_quaternion_vanishes_the_first_is_told() {
    let shipped = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../io/scenarios/theorem-7.toml")).unwrap();
    let of = |target: &str| {
        let text =
            shipped.replace("target.formulas = [0, 0, 0, 1]", &format!("target.formulas = [0, 0, 0, \"{target}\"]"));
        refused(&text.replace("end_s = 60", "end_s = 2000"))
    };
    // It is looked at every second: the later time is met, the first lies between two looks.
    for target in ["(t - 10.3)*(t - 1500)", "(t - 1500)*(t - 10.3)"] {
        let said = of(target);
        assert!(said.contains("no attitude at 10.3") || said.contains("no attitude at 10.29"), "{said}");
    }
}

#[test]
fn regress_a_factor_of_the_input_that_is_zero_where_the_run_begins_is_refuted() {
    let of = |psi: &str| {
        answer(&chains(&format!("chain = {{ order = 2, psi = \"{psi}\" }}"), "linearising"), "input-factor")
    };
    for zero in ["x - x", "x - 1", "0.1 + 0.2 - 0.3 + 0*x", "(x - 1)^2"] {
        assert_eq!(of(zero), "violated", "{zero}");
    }
    assert_eq!((of("x").as_str(), of("2 + sin(x)").as_str()), ("watched during the run", "holds"));
    let pure = |known: &str, regressor: &str| {
        let robot = format!(
            "pure_feedback = {{ known = [\"{known}\", \"0\"], regressors = [[\"{regressor}\"], [\"x1\"]], parameters = [0.4] }}"
        );
        answer(&chains(&robot, "adaptive_backstepping"), "input-factor")
    };
    assert_eq!(pure("0", "x1^2"), "violated");
    assert_eq!(pure("x2 + 0.2*x2^3", "x1^2"), "watched during the run");
    // By a parameter whose estimate starts at zero.
    assert_eq!(pure("2*x1", "x2"), "violated");
}

#[test]
fn regress_reasons_for_no_prediction_name_agents() {
    let pushed = "[[external_wrenches]]\non = [\"m-2\"]\nby.force_n = [\"2\"]\n";
    for text in [masses(pushed), masses(&pushed.replace("\"2\"", "\"sin(t)\""))] {
        let folder = with(&text);
        let said = stdout(&forwardstep(&folder, &["check", "two.toml"]).code(1));
        assert!(
            said.contains("no exact value is predicted that all agree upon, since m-2 is pushed for ever"),
            "{said}"
        );
        let findings = stdout(&forwardstep(&folder, &["check", "two.toml", "--json"]).code(1));
        assert!(findings.contains("m-2 is pushed for ever") && !findings.contains("agent number"), "{findings}");
    }
}

#[test]
fn regress_where_no_torque_is_foreseen_no_ratio_to_it_is_printed() {
    let folder = with(&masses("").replace("[[\"m-1\", \"m-2\"], [\"m-2\", \"m-1\"]]", "[]"));
    let said = stdout(&forwardstep(&folder, &["check", "--predict", "two.toml"]).code(1));
    assert!(said.contains("peak force 0.000 N") && !said.contains("NaN"), "{said}");
}

#[test]
fn regress_an_end_is_not_advised_where_the_slope_has_none() {
    let delay = |formula: &str| masses(&format!("delay.formula_s = \"{formula}\"\n"));
    let advised = |formula: &str| answered(&folder(), &delay(formula), "bounded-delays").1;
    assert!(advised("abs(t*sin(t))").ends_with("or one constant"), "{}", advised("abs(t*sin(t))"));
    assert_eq!(advised("sqrt(1 + t)"), "an end of the formula T, such as min(T, 1)");
    assert_eq!(answer(&delay("min(sqrt(1 + t), 1)"), "bounded-delays"), "holds");
}

#[test]
fn regress_numbers_of_any_size_are_said_as_they_are() {
    let said = |text: &str, arguments: &[&str]| {
        let folder = with(text);
        let arguments = [&["check", "two.toml"], arguments].concat();
        String::from_utf8(forwardstep(&folder, &arguments).get_output().stdout.clone()).unwrap()
    };
    let tiny = said(&masses("delay.constant_s = 1e-300\n"), &["--predict"]);
    assert!(tiny.contains("for any delays up to 1 × 10⁻³⁰⁰ s"), "{tiny}");
    let led = |gain: &str, design: &str, roots: &str| {
        format!(
            "format = 2\ntime.end_s = 10\n[leader]\nmotion.formulas = [\"sin(t)\"]\n[[agents]]\nname = \"m\"\n\
             robot.point_mass = {{ dimension = 1, mass_kg = 2 }}\nstart.position_m = [1.0]\n[reference.leader]\n\
             design = \"{design}\"\nroots_per_s = {roots}\ngain = {gain}\n[law.known]\n[network]\nedges = [[\"leader\", \"m\"]]\n"
        )
    };
    assert!(said(&led("1e-12", "continuous", "[1]"), &[]).contains("γ is 1e-12"));
    for (roots, slowest) in [("[1.0, 1.0]", "−1"), ("[0.1, 0.1]", "−0.1"), ("[3.0, 0.5]", "−0.5")] {
        let text = said(&led("5", "differentiable", roots), &[]);
        assert!(text.contains(&format!("the real part of every root is {slowest} per second at most")), "{text}");
    }
}

#[test]
fn what_is_predicted_beside_a_start_that_is_not_on_its_course_says_so() {
    let folder =
        with(&masses("").replacen("start.position_m", "start.reference.z = [[3.0], [0.0]]\nstart.position_m", 1));
    let text = stdout(&forwardstep(&folder, &["check", "two.toml", "--predict"]).success());
    assert!(text.contains("s with s ≡ 0 (but s starts from 3 m/s, V from 9 J, which can delay it)"), "{text}");
    assert!(text.contains("without a bound, since s does not start from zero"), "{text}");
    let folder = with(&masses(""));
    let text = stdout(&forwardstep(&folder, &["check", "two.toml", "--predict"]).success());
    assert!(text.contains("settled to 1 % after") && !text.contains("can delay it"), "{text}");
}

#[test]
fn regress_a_value_that_only_s_zero_leads_to_is_said_to_be_that() {
    let blind = |estimate: &str, edges: &str| {
        let agent = |name: &str, at: f64| {
            format!(
                "[[agents]]\nname = \"{name}\"\nrobot.point_mass = {{ dimension = 1, mass_kg = 2 }}\nstart.position_m = [{at}]\n"
            )
        };
        let law = format!("[law.position_only]\n{estimate}\n");
        let text = format!(
            "format = 2\ntime.end_s = 60\n{}{}[reference.consensus]\nexchange = \"position\"\nroots_per_s = [1, 2]\n{law}[network]\n{edges}\n",
            agent("a", 1.6),
            agent("b", -1.4)
        );
        let folder = with(&text);
        stdout(&forwardstep(&folder, &["check", "two.toml", "--predict"]).success())
    };
    let fixed = "edges = [[\"a\", \"b\"], [\"b\", \"a\"]]";
    let text = blind("", fixed);
    assert!(text.contains("(but estimates start far from the truth, which can delay it)"), "{text}");
    assert!(text.contains(" with s ≡ 0; an s that is not zero moves it\n"), "{text}");
    let text = blind("estimate_start_kg = 2", fixed);
    assert!(text.contains("value agreed upon (") && !text.contains("moves it"), "{text}");
}

/// A delay of a log that grows like t is bounded by the end of the log alone.
#[test]
fn regress_a_delay_held_for_half_of_the_run_is_bounded_by_the_run_alone() {
    let here = folder();
    let scenario = "format = 2\ntime.end_s = 20\n[[agents]]\nname = \"a\"\ncount = 2\nrobot.point_mass = { dimension = 1, mass_kg = 1 }\n\
        start.position_m = [[0], [1]]\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n[law.known]\ndamping.gain = 20\n\
        [network]\ndelay.hold_log.file = \"holds.csv\"\nedges.ring = {}\n";
    fs::write(here.path().join("own.toml"), scenario).unwrap();
    let holds = |held: &dyn Fn(u32) -> u32| {
        let rows = (0..20).map(|t| format!("a-1,a-2,1,{t},{0}\na-2,a-1,1,{t},{0}\n", held(t)));
        format!("from,to,hold,t_s,delay_s\n{}a-1,a-2,1,20,\na-2,a-1,1,20,\n", rows.collect::<String>())
    };
    for (text, status, words) in [
        (holds(&|t| t), 1, "the run is not twice as long"),
        (holds(&|t| t.min(10)), 0, "no delay exceeds 10 s until the end of the run at 20 s"),
    ] {
        fs::write(here.path().join("holds.csv"), text).unwrap();
        let said = stdout(&forwardstep(&here, &["check", "own.toml"]).code(status));
        assert!(said.contains(words), "{said}");
    }
}

/// A leader that rests until long after the run, with agents that start where it is: any sign that is held leaves too much beside that.
#[test]
fn regress_a_period_that_no_run_may_have_is_not_advised() {
    let led = |from_s: f64| {
        let motion =
            format!("motion.formulas = [\"1 + tanh(t - {from_s})\"]\n[reference.leader]\ndesign = \"continuous\"\n");
        let design = format!("[leader]\n{motion}gain = 9\nsign_period_s = 0.01\nroots_per_s = [1.0]\n");
        let text = masses("");
        let (from, to) = (text.find("[reference").unwrap(), text.find("[law").unwrap());
        let edges = "edges = [[\"leader\", \"m-1\"], [\"m-1\", \"m-2\"]]\n";
        let network = text.find("edges = ").unwrap();
        let text = format!("{}{design}{}{edges}", &text[..from], &text[to..network]).replace("[[1.0]", "[[0.0]");
        let folder = with(&text);
        stdout(&forwardstep(&folder, &["check", "two.toml"]).code(1))
    };
    let said = led(60.0);
    assert!(said.contains("since no period that a run may have is short enough"), "{said}");
    assert!(!said.contains("`sign_period_s` of at most"), "{said}");
    let said = led(13.0);
    assert!(said.contains("to make it hold: `sign_period_s` of at most"), "{said}");
}
