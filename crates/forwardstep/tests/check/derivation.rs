//! `explain`: what is derived from a scenario, and the identities along its run.

use std::ops::ControlFlow;

use forwardstep::check::derivation::residual::{Missing, Residual, Residuals};
use forwardstep::io::scenario::{SHIPPED_SCENARIOS, open_scenario};
use forwardstep::sim::{Moment, Observers, RecordAt, simulate_with};
use serde_json::Value;

use super::{TWO, with};
use crate::support::{folder, forwardstep, stderr, stdout};

#[test]
fn an_explanation_holds_the_numbers_of_the_scenario_in_every_form() {
    let folder = with(TWO);
    let text = stdout(&forwardstep(&folder, &["explain", "two.toml"]).success());
    // (a1) with α = 1, β = 2, and (a2) after degree reduction.
    for line in [
        "z\u{308}_i = −3 z\u{307}_i − 2 q\u{307}_i − Σ_j w_ij [",
        "y\u{307}_i = −2 y_i − Σ_j w_ij [y_i + 2 ξ_i − 2 ξ_j] + s\u{307}_i    (a2)",
    ] {
        assert!(text.contains(line), "{text}");
    }
    let latex = stdout(&forwardstep(&folder, &["explain", "two.toml", "--latex"]).success());
    assert!(latex.contains("\\dot{y}_{i} = -2\\, y_{i} - \\Sigma_{j\\in\\mathcal{N}_i}"), "{latex}");
    assert_eq!(latex.matches("\\begin{equation*}").count(), latex.matches("\\end{equation*}").count());
    let json = stdout(&forwardstep(&folder, &["explain", "two.toml", "--json"]).success());
    let document: Value = serde_json::from_str(&json).unwrap();
    let design = &document["designs"][0];
    assert_eq!(design["agents"], serde_json::json!(["arm-1", "arm-2"]));
    assert_eq!((&design["order"], &design["degree"], &design["reduced_degree"]), (&3.into(), &2.into(), &1.into()));
    assert!(json.contains("\"paper\": \"(a2)\""), "{json}");
    // What does not hold is told first, since the derivation takes it for granted.
    assert!(text.contains("What it lacks") && text.contains("applied-torque: not covered by the paper: "), "{text}");
    assert!(latex.contains("% applied-torque: not covered by the paper: "), "{latex}");
    assert!(document["lacks"].as_array().unwrap().iter().any(|one| one["id"] == "applied-torque"), "{document}");
    // What holds says what would break it, in every form and on the page; what does not hold is broken already.
    let broken = "real-roots: complex roots: the disagreement can then grow";
    assert!(text.contains("What would break it") && text.contains(broken), "{text}");
    assert!(latex.contains(&format!("% {broken}")), "{latex}");
    let ids: Vec<&str> = document["breaks"].as_array().unwrap().iter().map(|one| one["id"].as_str().unwrap()).collect();
    assert!(ids.starts_with(&["spanning-tree", "dwell-time"]) && ids.contains(&"positive-gains"), "{ids:?}");
    forwardstep(&folder, &["run", "two.toml", "--out", "run"]).success();
    let page = std::fs::read_to_string(folder.path().join("run/report.html")).unwrap();
    assert!(page.contains("Why it would work") && page.contains("What it lacks"));
    assert!(page.contains("Why it would converge") && !page.contains("Why it converges"));
    assert!(page.contains("What would break it") && page.contains("complex roots: the disagreement can then grow"));
    forwardstep(&folder, &["explain", "two.toml", "--json", "--latex"]).code(2);
    assert!(stderr(&forwardstep(&folder, &["explain", "thre.toml"]).code(2)).contains("thre.toml"));
}

#[test]
fn regress_nothing_is_put_into_the_mouth_of_an_author_who_said_nothing() {
    let folder = folder();
    let said = stdout(&forwardstep(&folder, &["scenarios", "desired-nonlinear"]).success());
    let explained = |text: &str| {
        std::fs::write(folder.path().join("own.toml"), text).unwrap();
        stdout(&forwardstep(&folder, &["explain", "own.toml"]).success())
    };
    assert!(explained(&said).contains("of which its author says where it leads"));
    let silent: String =
        said.lines().filter(|line| !line.contains("_because")).map(|line| format!("{line}\n")).collect();
    let text = explained(&silent);
    assert!(text.contains("and nothing says where that leads") && !text.contains("its author says"), "{text}");
}

#[test]
fn every_shipped_scenario_is_explained_or_says_why_not() {
    let folder = folder();
    for scenario in SHIPPED_SCENARIOS {
        let text = stdout(&forwardstep(&folder, &["explain", scenario.name]).success());
        assert!(text.contains("Reference dynamics") && !text.contains("nan") && !text.contains('…'), "{text}");
        // Each step of a reduction leaves less than there was.
        for step in text.lines().filter_map(|line| line.trim().strip_prefix("A new variable absorbs ")) {
            let (absorbed, left) = step.split_once("; ").unwrap();
            assert!(!left.starts_with(absorbed), "{}: {step}", scenario.name);
        }
    }
}

#[test]
fn own_a_law_by_a_model_is_explained_with_its_numbers_and_with_what_pushes_it() {
    let folder = folder();
    let text =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../checker/cases/model-reference.toml"));
    let text = text.unwrap();
    let pushed = format!("{text}\n[[external_wrenches]]\non = [\"mass\"]\nby.force_n = [1, 0]\n");
    let said = |text: &str| {
        std::fs::write(folder.path().join("mass.toml"), text).unwrap();
        stdout(&forwardstep(&folder, &["explain", "mass.toml"]).success())
    };
    let plain = said(&text);
    // Roots 1 and 2: α₁ = 3, α₀ = 2, p = 6/13, b = 33/13 and α₀ − p b = 140/169.
    for line in [
        " φ − 3 η\n",
        "_d − 2 e − 3 y\n",
        " + (6/13) φ = φ_0",
        " = −(33/13) e + r + m⁻¹ Δm φ\n",
        " = −(6/13) r − (140/169) e − 3 m⁻¹ δ\n",
        " + 20 δ = 0\n",
    ] {
        assert!(plain.contains(line), "{line}: {plain}");
    }
    let pushed = said(&pushed);
    for line in [" = u + f ", "− 3 m⁻¹ δ + m⁻¹ f\n", " + 20 δ = −f\n"] {
        assert!(pushed.contains(line), "{line}: {pushed}");
    }
}

/// The cases beside the checker have laws and bounds that no shipped scenario has. Text stands behind a `%`.
#[test]
fn regress_every_letter_of_every_case_has_a_command_in_latex() {
    let folder = folder();
    let cases = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../checker/cases")).unwrap();
    let cases: Vec<_> =
        cases.map(|entry| entry.unwrap().path()).filter(|path| path.extension().unwrap() == "toml").collect();
    assert!(cases.len() > 10, "{cases:?}");
    for case in cases {
        let latex = stdout(&forwardstep(&folder, &["explain", case.to_str().unwrap(), "--latex"]).success());
        let formulas: Vec<&str> = latex.lines().filter(|line| !line.starts_with('%')).collect();
        assert!(formulas.iter().any(|line| line.contains("equation")), "{case:?}: {latex}");
        let wrong = formulas.iter().find(|line| !line.is_ascii());
        assert!(wrong.is_none(), "{case:?}: {wrong:?}");
    }
}

#[test]
fn eq_43_a_target_is_explained_as_a_target_and_an_offset_as_an_offset() {
    let folder = folder();
    let explained = |name: &str| stdout(&forwardstep(&folder, &["explain", name]).success());
    let (protocol, targets) = (explained("desired-together"), explained("desired-in-z"));
    assert!(protocol.contains("what the scenario states") && !protocol.contains("linear system with"), "{protocol}");
    assert!(targets.contains("linear system with the given"), "{targets}");
    assert!(!protocol.contains("keep an offset") && !targets.contains("keep an offset"), "{targets}");
    assert!(explained("formation").contains("keep an offset"));
}

/// Equations that are not evaluated, though they say more than what their letters stand for: their scenario, and how many.
/// An inner loop turns these vehicles, so that what (52) makes of s* does not hold.
/// Where 𝒵 is written in x, derivatives of z are no states.
const NOT_EVALUATED: [(&str, usize); 3] = [("gusts", 1), ("formation", 1), ("desired-in-x", 7)];

#[test]
fn every_identity_of_every_shipped_scenario_holds_along_its_run() {
    for shipped in SHIPPED_SCENARIOS {
        let mut setup = open_scenario(shipped.name).unwrap().setup;
        setup.control = None;
        // Limits and pushes are no part of the equations.
        for agent in &mut setup.agents {
            agent.enforce_limits = false;
            agent.pushes.clear();
        }
        (setup.time.record_at, setup.time.record_every_s) = (RecordAt::Intervals, 0.05);
        setup.time.end_s = setup.time.end_s.min(1.5);
        let mut residuals = Residuals::of(&setup).unwrap();
        let mut rows = 0;
        let mut look = |moment: Moment<'_>| {
            rows += 1;
            residuals.look(moment);
        };
        simulate_with(
            &setup,
            &mut |_| ControlFlow::Continue(()),
            Observers { moments: Some(&mut look), ..Observers::default() },
        )
        .unwrap();
        assert!(rows >= 30 * setup.agents.len(), "{}: {rows}", shipped.name);
        let found: Vec<Residual> = residuals.found().into_iter().flat_map(|(_, found)| found).collect();
        let broken: Vec<_> = found.iter().filter(|one| one.holds() == Some(false)).collect();
        assert!(broken.is_empty(), "{}: {broken:?}", shipped.name);
        let left =
            found.iter().filter(|one| one.largest.as_ref().is_err_and(|missing| *missing != Missing::Definition));
        let expected = NOT_EVALUATED.iter().find(|(name, _)| *name == shipped.name).map_or(0, |(_, count)| *count);
        assert_eq!(left.clone().count(), expected, "{}: {:?}", shipped.name, left.collect::<Vec<_>>());
        let held = found.iter().filter(|one| one.holds() == Some(true)).count();
        assert!(held > 0, "{}: {found:?}", shipped.name);
    }
}

/// Where all have come together what is left is the rounding of offsets that move.
#[test]
fn regress_what_moves_with_an_offset_is_as_exact_as_the_offset() {
    let folder = folder();
    let said = stdout(&forwardstep(&folder, &["explain", "vehicles-behind-a-leader", "--along"]).success());
    assert!(said.contains("(49)") && !said.contains("NO ROUNDING"), "{said}");
}

/// Whatever acts from outside is told wherever something is said to vanish, and by whom a late leader is seen late.
#[test]
fn regress_pushes_filters_and_late_leaders_are_in_what_is_derived() {
    let folder = folder();
    let explained = |name: &str| {
        let said = stdout(&forwardstep(&folder, &["explain", name]).success());
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    const ENDS: &str = "what is said to vanish then need not, until it ends";
    let gusts = explained("gusts");
    assert!(gusts.contains(ENDS) && gusts.contains("ext"), "{gusts}");
    assert!(explained("desired-in-x").contains(ENDS));
    assert!(!explained("six-arms").contains(ENDS));
    let backstepping = explained("backstepping");
    assert!(backstepping.contains("+ sᵀM(ζ − ż)") && !backstepping.contains("whatever z does"), "{backstepping}");
    let late = explained("leader-over-late-links");
    assert!(late.contains("q_0(t − T_ij(t))") && late.contains("as the delays let it be"), "{late}");
    assert!(!late.contains("finite time") && explained("theorem-8").contains("finite time"), "{late}");
    assert!(!explained("swarm-tracking").contains("output of a stable filter"));
}

/// (57) and (58) by a measured acceleration, with and without a bias and bounds.
#[test]
fn own_equations_of_vehicles_by_their_acceleration_hold_along_their_run() {
    let text = forwardstep::io::scenario::shipped_scenario("theorem-5").unwrap().text;
    let text =
        text.replace("roots_per_s = [1.0, 1.5, 2.0]", "roots_per_s = [1.0, 1.5]").replace("end_s = 60", "end_s = 5");
    for more in ["", ", bounds.within = 0.3", ", bias_m_s2 = [0.1, 0, 0.2]"] {
        let own = format!("estimate_start_kg = 1.2{more}");
        let folder =
            with(&text.replace("design.adaptive", "design.by_acceleration").replace("estimate_start_kg = 1.2", &own));
        let words = stdout(&forwardstep(&folder, &["explain", "two.toml"]).success());
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains("cascade is of degree 1") && words.contains("Not from the paper"), "{words}");
        assert_eq!(words.contains("nothing of what follows is shown"), more.contains("bias"), "{words}");
        let found = stdout(&forwardstep(&folder, &["explain", "two.toml", "--along"]).success());
        assert!(!found.contains("NO ROUNDING"), "{found}");
        for equation in ["(24)", "(57)", "(58)", "(30)"] {
            assert!(words.contains(equation), "{equation}: {words}");
        }
    }
}

/// z and ż as functions, the law and the adaptation, by an evaluation of their own; a planar arm and one from a URDF.
#[test]
fn own_equations_of_a_tip_by_its_velocity_hold_along_its_run() {
    for name in ["theorem-6", "task-space-ur5e"] {
        let text = forwardstep::io::scenario::shipped_scenario(name).unwrap().text;
        let text = text.replace("[law.task_space]\n", "[law.task_space]\ntip_velocity = \"measured\"\n");
        let folder = with(&text);
        let words = stdout(&forwardstep(&folder, &["explain", "two.toml"]).success());
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains("cascade is of degree 0") && words.contains("Not from the paper"), "{words}");
        let found = stdout(&forwardstep(&folder, &["explain", "two.toml", "--along"]).success());
        assert!(!found.contains("NO ROUNDING"), "{found}");
        for equation in ["z = z_r", "z\u{307} = z\u{307}_r", "(80)", "(81)", "(82)"] {
            assert!(found.contains(equation), "{equation}: {found}");
        }
    }
}

#[test]
fn eq_33_and_eq_43_hold_along_a_run_that_is_disturbed_and_where_s_is_zero() {
    // It starts with s = 0 and is disturbed in the middle; both axes of the second pull at each other.
    let plants = [
        ("robot.chain = { order = 2, chi = \"-x^3 + sin(x)*dx\", psi = \"3 + cos(3*x)\" }", "[[0.5], [-0.4]]", "[1.0]"),
        (
            "robot.vector_chain = { order = 2, chi = [\"-x1 + x2\", \"-x2^3 + dx1\"], psi = [[\"2\", \"sin(x1)\"], [\"-0.5\", \"2\"]] }",
            "[[0.5, -0.2], [-0.4, 0.8]]",
            "[1.0, -2.0]",
        ),
    ];
    for (plant, starts, disturbance) in plants {
        let scenario = format!(
            "format = 2\ntime.end_s = 6\n[[agents]]\nname = \"plant\"\ncount = 2\n{plant}\nstart.position_m = {starts}\n\
             [law.linearising]\ngain_per_s = 3\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n\
             [network]\nedges.ring = {{}}\n[[external_wrenches]]\non = [\"plant-1\"]\nfrom_s = 2\nfor_s = 1\nby.disturbance = {disturbance}\n"
        );
        let folder = with(&scenario);
        let words = stdout(&forwardstep(&folder, &["explain", "two.toml"]).success());
        assert!(
            words.split_whitespace().collect::<Vec<_>>().join(" ").contains("the power s w comes beside that"),
            "{words}"
        );
        let text = stdout(&forwardstep(&folder, &["explain", "two.toml", "--along"]).success());
        assert!(text.contains("= w_i + ψ_i u_i") && text.contains("_i = w_i − 3 s_i"), "{text}");
        assert!(!text.contains("NO ROUNDING"), "{text}");
    }
}

#[test]
fn as_many_roots_as_there_may_be_are_explained() {
    let roots: Vec<String> = (0..32).map(|r| format!("{}", 0.5 + 0.1 * f64::from(r))).collect();
    let folder = with(&TWO.replace("[1.0, 2.0]", &format!("[{}]", roots.join(", "))));
    let text = stdout(&forwardstep(&folder, &["explain", "two.toml"]).success());
    assert!(text.contains("p³² + ") && text.contains("cascade is of degree 32") && !text.contains('…'), "{text}");
}

#[test]
fn identities_are_printed_along_a_run_and_the_exit_status_says_whether_they_hold() {
    let folder = with(&TWO.replace("end_s = 30", "end_s = 2"));
    let text = stdout(&forwardstep(&folder, &["explain", "two.toml", "--along"]).success());
    assert!(text.contains("Along a run of 2 s, with control in continuous time") && text.contains("(a1)"), "{text}");
    assert!(text.contains(" at most, at ") && !text.contains("NO ROUNDING"), "{text}");
    let json = stdout(&forwardstep(&folder, &["explain", "two.toml", "--along", "--json"]).success());
    let document: Value = serde_json::from_str(&json).unwrap();
    let residuals = document["designs"][0]["residuals"].as_array().unwrap();
    let a1 = residuals.iter().find(|one| one["paper"] == "(a1)").unwrap();
    assert!(a1["relative"].as_f64().unwrap() < 1e-14 && a1["holds"] == true && a1["moments"] == 42, "{a1}");
    let named = residuals.iter().find(|one| one["holds"].is_null()).unwrap();
    assert!(named["not_evaluated"].as_str().unwrap().contains("by definition"), "{named}");
    forwardstep(&folder, &["explain", "two.toml", "--along", "--latex"]).code(2);
    // Limits that do not let the law have its way, and a run that breaks down.
    let gains = "damping.gain = [[4, 2], [2, 1.5]]";
    let stiff = with(&TWO.replace(gains, "damping.gain = 1e14").replace("end_s = 30", "end_s = 2"));
    forwardstep(&stiff, &["explain", "two.toml", "--along"]).code(3);
}

#[test]
fn regress_the_degree_of_backstepping_counts_what_its_errors_hold_and_pushes_have_derivatives() {
    let folder = folder();
    let explained = |scenario: &str| stdout(&forwardstep(&folder, &["explain", scenario]).success());
    for (scenario, says) in [
        ("strict-feedback-order-10", "holds 9: the cascade is of degree 1."),
        ("strict-feedback", "holds 1: the cascade is of degree 2."),
        ("pure-feedback", "holds 1: the cascade is of degree 2."),
        ("gusts", "= τ̇_ext,i + u*_i + 3 τ_ext,i"),
    ] {
        assert!(explained(scenario).contains(says), "{scenario}: {}", explained(scenario));
    }
}
