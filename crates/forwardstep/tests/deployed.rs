//! What `check --practical` says of loops as they are deployed, beside long runs of them.

mod power;

use std::fs;

use forwardstep::check::{SamplingMargin, along};
use forwardstep::io::output::Deployment;
use forwardstep::io::scenario::open_scenario;
use forwardstep::sim::run;
use serde_json::Value;
use tempfile::TempDir;

use super::support::{folder, forwardstep, some, stderr, stdout};

/// A loop, the verdict on it, and whether a run of it runs away.
struct Case {
    name: &'static str,
    scenario: String,
    answer: &'static str,
    runs_away: bool,
}

fn case(name: &'static str, scenario: String, answer: &'static str, runs_away: bool) -> Case {
    Case { name, scenario, answer, runs_away }
}

fn head(end_s: u32, hz: f64) -> String {
    format!("format = 2\ntitle = \"a loop\"\n[time]\nend_s = {end_s}\n[control]\nsample_hz = {hz}\n")
}

/// Three masses without velocity, which adapt from `estimate` kg; true are 1.5.
fn blind(hz: f64, adaptation: f64, estimate: f64, delay_s: f64) -> String {
    head(80, hz)
        + &format!(
            "[[agents]]\nname = \"m\"\ncount = 3\nrobot.point_mass = {{ dimension = 1, mass_kg = 1.5 }}\n\
             start.position_m = [[0.3], [-0.8], [0.6]]\n[reference.consensus]\nroots_per_s = [3, 5.1]\nexchange = \"position\"\n\
             [law.position_only]\ndamping = 5\nfilter_per_s = 5\nadaptation_gain = {adaptation}\nestimate_start_kg = {estimate}\n\
             [network]\nweight = 8\ndelay.constant_s = {delay_s}\nedges.ring = {{}}\n"
        )
}

/// Two double integrators under a known law of this gain.
fn stiff(gain_per_s: f64) -> String {
    head(60, 2.0)
        + &format!(
            "[[agents]]\nname = \"c\"\ncount = 2\nrobot.chain = {{ order = 2, chi = \"0\", psi = \"1\" }}\n\
             start = {{ position = [[1.0], [-1.0]], velocity = [[0.1], [0.0]] }}\n[reference.consensus]\nroots_per_s = [1, 2]\n\
             exchange = \"position\"\n[law.linearising]\ngain_per_s = {gain_per_s}\n[network]\nedges.ring = {{}}\n"
        )
}

/// A mass that follows a target and adapts.
fn tracker(roots: &str, target: &str, adaptation: u32, hz: f64) -> String {
    head(100, hz)
        + &format!(
            "[[agents]]\nname = \"m\"\nrobot.point_mass = {{ dimension = 1, mass_kg = 1.5 }}\nstart.position_m = [0.0]\n\
             target.formulas = [\"{target}\"]\n[reference.tracking]\nroots_per_s = {roots}\n\
             [law.adaptive]\ndamping.gain = 10\nadaptation_gain = {adaptation}\n"
        )
}

/// Two masses with fast roots, whose joints rub a little or not at all.
fn rubbing(friction: &str) -> String {
    head(40, 10.0)
        + &format!(
            "[[agents]]\nname = \"a\"\ncount = 2\nrobot.point_mass = {{ dimension = 1, mass_kg = 1.5{friction} }}\n\
             start.position_m = [[0.7], [-0.4]]\n[reference.consensus]\nroots_per_s = [8, 10]\nexchange = \"position\"\n\
             [law.adaptive]\ndamping.gain = 8\nadaptation_gain = 0.3\nestimate_start = {{ scaled = 0.8 }}\n\
             [network]\nweight = 10\nedges.ring = {{}}\n"
        )
}

/// Three masses whose torques are late and whose velocities are filtered, each of which hears another for a part of the time.
fn in_turns() -> String {
    head(300, 10.0)
        + "computation_delay_s = 0.09\nvelocity.filtered_difference = { cut_off_hz = 1.5 }\n\
           [[agents]]\nname = \"a\"\ncount = 3\nrobot.point_mass = { dimension = 1, mass_kg = 1.5 }\nstart.position_m = [[0.7], [-0.4], [0.1]]\n\
           [reference.consensus]\nroots_per_s = [0.5, 3]\nexchange = \"position_velocity\"\n\
           [law.adaptive]\ndamping.gain = 8\nadaptation_gain = 0.3\nestimate_start = \"true\"\n[network]\nweight = 3\n\
           [[network.phases]]\ndwell_s = 0.7\nedges = [[\"a-1\", \"a-2\"]]\n\
           [[network.phases]]\ndwell_s = 0.5\nedges = [[\"a-2\", \"a-3\"], [\"a-3\", \"a-1\"]]\n"
}

/// Two chains that adapt while they come to rest.
fn settling() -> String {
    head(300, 20.0)
        + "[[agents]]\nname = \"p\"\ncount = 2\n\
           robot.strict_feedback = { regressors = [[\"sin(x1)\", \"0\"], [\"0\", \"x2\"]], parameters = [-3, -1] }\n\
           start = { position = [[1.0], [-0.8]] }\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n\
           [law.adaptive_backstepping]\ngains_per_s = 2\nadaptation_gain = 4\n[network]\nedges.ring = {}\n"
}

/// A chain that adapts along a motion which comes back.
fn swinging() -> String {
    head(300, 20.0)
        + "[[agents]]\nname = \"p\"\nrobot.chain = { order = 2, regressor = [\"dx\"], parameters = [-0.5] }\nstart.position = [0.0]\n\
           target.formulas = [\"sin(t)\"]\n[reference.tracking]\nroots_per_s = [1, 2]\n\
           [law.linear_adaptive]\ngain_per_s = 2\nadaptation_gain = 50\n"
}

fn checked(folder: &TempDir, scenario: &str) -> Vec<Value> {
    fs::write(folder.path().join("loop.toml"), scenario).unwrap();
    let said = forwardstep(folder, &["check", "loop.toml", "--practical", "--json"]);
    let document: Value = serde_json::from_str(&stdout(&said)).unwrap();
    document["practical"]["verdicts"].as_array().unwrap().clone()
}

/// Limits let the estimates run away; the design settles within some seconds, and the margin was small before the run.
#[test]
fn regress_a_run_that_ran_away_is_not_called_slow_nor_its_samples() {
    let folder = folder();
    let scenario = "format = 2\ntime.end_s = 30\n[[agents]]\nname = \"a\"\ncount = 2\nrobot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }\n\
                    start.position_rad = [[1.2, 0.2], [1.9, -0.2]]\n[reference.consensus]\nroots_per_s = [1.0, 2.0]\nexchange = \"position_velocity\"\n\
                    [law.adaptive]\ndamping.gain = 8\nadaptation_gain = 10\n[control]\nsample_hz = 200\ntorque_limit = [12, 9]\n\
                    torque_rate_limit_per_s = 100\n[network]\nedges.ring = {}\n[goal]\ndisagreement_below = 0.01\n";
    fs::write(folder.path().join("own.toml"), scenario).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "own.toml"]).code(1));
    assert!(
        said.contains("limits of torque") && said.contains("see what acts on them first; the sampling margin, 0.2"),
        "{said}"
    );
    assert!(!said.contains("the design is slow") && !said.contains("the sampling period is too long"), "{said}");
}

/// Every rate makes these run away within some samples, sixteen times as fast as well; in continuous time they agree.
#[test]
fn regress_what_runs_away_at_sixteen_times_the_rate_as_well_is_not_called_adequate() {
    let folder = folder();
    for sample_hz in [18.5, 37.0, 74.0] {
        let scenario = format!(
            "format = 2\ntime.end_s = 10\n[[agents]]\nname = \"m\"\ncount = 4\nrobot.point_mass = {{ dimension = 1, mass_kg = 2 }}\n\
             start.position_m = [[0.0], [-1.7], [3.4], [-5.1]]\n[reference.consensus]\nroots_per_s = [3.94]\n\
             exchange = \"position_velocity\"\n[law.adaptive]\ndamping.gain = 42.7\nadaptation_gain = 62.92\n\
             estimate_start.scaled = 1.1\n[network]\nweight = 6.28\nedges.complete = {{}}\n[control]\nsample_hz = {sample_hz}\n"
        );
        let verdicts = checked(&folder, &scenario);
        let whole = verdicts.iter().find(|verdict| verdict["id"] == "whole-loop").unwrap();
        assert_eq!(whole["answer"], "inadequate", "{sample_hz} Hz: {whole}");
        forwardstep(&folder, &["run", "loop.toml", "--out", "run", "--force"]).code(3);
    }
}

fn summary_of_run(folder: &TempDir) -> Value {
    forwardstep(folder, &["run", "loop.toml", "--out", "run", "--force"]);
    serde_json::from_str(&fs::read_to_string(folder.path().join("run/summary.json")).unwrap()).unwrap()
}

#[test]
fn regress_the_verdict_on_a_deployed_loop_is_that_of_its_run() {
    let grows = "(1 - exp(-t/20))*sin(3*t)";
    let cases = [
        // Linearised with the estimate that they start with, wrong ones grew in continuous time too, which excused what sampling does.
        case("blind, slow", blind(4.0, 1.0, 0.0, 0.3), "inadequate", true),
        case("blind, right", blind(16.0, 1.0, 1.5, 0.3), "adequate", false),
        // Adaptation along a motion, which nothing at rest knows.
        case("blind, adapting", blind(8.0, 1.0, 3.0, 0.0), "inadequate", true),
        // With what it estimates at first a mode would grow by sampling; it does not keep to that.
        case("blind, adapting, twice as often", blind(16.0, 1.0, 3.0, 0.0), "marginal", false),
        // Sixteen times as fast it is too slow as well.
        case("stiff", stiff(100.0), "inadequate", true),
        case("very stiff", stiff(1000.0), "inadequate", true),
        case("not stiff", stiff(2.0), "marginal", false),
        // Targets move, with as many states of the reference as there are roots less one.
        case("one root", tracker("[1]", grows, 20, 20.0), "inadequate", true),
        case("two roots", tracker("[1, 2]", grows, 20, 20.0), "inadequate", true),
        case("three roots", tracker("[1, 2, 3]", grows, 20, 20.0), "inadequate", true),
        case("two roots, often", tracker("[1, 2]", grows, 20, 500.0), "adequate", false),
        // Grows in a part of every swing; the run says that the rest makes up for it.
        case("swings", tracker("[1, 2]", "2*sin(3*t)", 1, 20.0), "not shown", false),
        case("rubs", rubbing(", friction.smooth = { coulomb = [0.01], width = 0.05 }"), "inadequate", true),
        case("rubs dry", rubbing(", friction.dry = { coulomb = [0.01] }"), "inadequate", true),
        case("does not rub", rubbing(""), "inadequate", true),
        case("in turns", in_turns(), "not shown", false),
        case("settles", settling(), "adequate", false),
        case("comes back", swinging(), "adequate", false),
    ];
    let folder = folder();
    for Case { name, scenario, answer, runs_away } in some(cases, 3) {
        let verdicts = checked(&folder, &scenario);
        let whole = verdicts.iter().find(|verdict| verdict["id"] == "whole-loop").unwrap_or_else(|| panic!("{name}"));
        assert_eq!(whole["answer"], answer, "{name}: {whole}");
        let bounds = verdicts.iter().any(|verdict| verdict["id"] == "tracking-power" && verdict["answer"] == "bound");
        assert!(!(bounds && answer == "inadequate"), "{name}: {verdicts:?}");
        let summary = summary_of_run(&folder);
        assert_eq!(
            summary["practical"]["verdicts"].as_array(),
            Some(&verdicts),
            "{name}: said before the run and kept"
        );
        let page = fs::read_to_string(folder.path().join("run/report.html")).unwrap();
        for id in verdicts.iter().map(|verdict| verdict["id"].as_str().unwrap()) {
            assert!(page.contains(&format!("<code>{id}</code>")), "{name}: the page keeps {id}");
        }
        let last = summary["metrics"]["disagreement"]["measured"]["last"].as_f64();
        let is_away = summary["ending"]["kind"] == "broke_down" || last.is_none_or(|last| last > 1e3);
        assert_eq!(is_away, runs_away, "{name}: {} {last:?}", summary["ending"]);
        assert!(is_away || last < Some(0.3), "{name}: {last:?}");
    }
}

/// Whether rows stand at samples, where s is what is left of it, or between them: the mean is that of the balance.
#[test]
fn regress_the_mean_power_is_that_between_samples_wherever_rows_are() {
    let folder = folder();
    let scenario = head(90, 10.0)
        + "[[agents]]\nname = \"a\"\ncount = 2\nrobot.point_mass = { dimension = 1, mass_kg = 1.5 }\nstart.position_m = [[0.6], [-0.2]]\n\
           [reference.consensus]\nroots_per_s = [0.7]\nexchange = \"position\"\n[law.known]\ndamping.gain = 20\n[network]\nweight = 0.5\nedges.ring = {}\n";
    let mut means = Vec::new();
    for every_s in [0.1, 0.05, 0.013] {
        let text = scenario.replace("[control]", &format!("record_every_s = {every_s}\n[control]"));
        let verdicts = checked(&folder, &text);
        let power = verdicts.iter().find(|verdict| verdict["id"] == "tracking-power").unwrap();
        let bound = power["numbers"]["mean_w"].as_f64().unwrap();
        let reached = summary_of_run(&folder)["metrics"]["watched"]["tracking_power"].clone();
        let mean = reached["mean_w"].as_f64().unwrap();
        assert!(mean < bound && mean > 0.2 * bound, "{every_s} s: {mean} W of {bound} W");
        assert!(mean < reached["bound_w"].as_f64().unwrap(), "{reached}");
        means.push(mean);
    }
    assert!(means.iter().all(|mean| (mean / means[0] - 1.0).abs() < 0.05), "{means:?}");
}

/// ẋ = x u keeps the sign of x; steps over zero, where u has no value, are none of it.
#[test]
fn regress_a_factor_that_changes_its_sign_within_a_step_ends_the_run() {
    let here = folder();
    let scenario = "format = 2\n[time]\nend_s = 30\n[[agents]]\nname = \"a\"\ncount = 2\nstart.position = [[-1], [0.5]]\n\
        robot.chain = { order = 1, psi = \"x\" }\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n\
        [law.linearising]\ngain_per_s = 2\n[network]\nedges.ring = {}\n";
    fs::write(here.path().join("own.toml"), scenario).unwrap();
    let run = forwardstep(&here, &["run", "own.toml"]);
    let said = format!("{}{}", stdout(&run), stderr(&run));
    assert!(said.contains("Broke down at t = 1.7") && said.contains("a-2.divisor"), "{said}");
}

/// Whoever follows starts with the velocity and the acceleration that errors make, far above those of its leader.
#[test]
fn regress_the_margin_of_who_follows_is_that_of_its_start() {
    for (name, hz) in [("pilot-ship", 20.0), ("theorem-8", 2000.0), ("theorem-9", 500.0), ("remark-12", 500.0)] {
        let mut setup = open_scenario(name).unwrap().setup.sampled(hz);
        setup.time.end_s = 5.0;
        let said = SamplingMargin::of(&setup).unwrap().worst.sigma;
        let reached = along(&setup, &run(&setup).unwrap().recording).margin.unwrap();
        assert!(said > 0.9 * reached.sigma && said < 1.6 * reached.sigma, "{name}: {said}, {reached:?}");
    }
}

/// References that are as fast as K/M answer what grows by itself: the margin, which freezes them, is not the last word.
#[test]
fn regress_the_margin_of_what_the_loop_as_a_whole_holds_is_marginal() {
    let masses = |roots: &str| {
        head(60, 17.8)
            + &format!(
                "[[agents]]\nname = \"a\"\ncount = 2\nrobot.point_mass = {{ dimension = 1, mass_kg = 2.583 }}\n\
                 start.position_m = [[0.5], [-0.5]]\n[reference.consensus]\nroots_per_s = {roots}\nexchange = \"position_velocity\"\n\
                 [law.known]\ndamping.gain = 123.979\n[network]\nedges.ring = {{}}\n"
            )
    };
    let folder = folder();
    for (roots, margin, whole, agrees) in
        [("[20, 30]", "marginal", "adequate", true), ("[1, 2]", "inadequate", "inadequate", false)]
    {
        let verdicts = checked(&folder, &masses(roots));
        let answer = |name: &str| verdicts.iter().find(|verdict| verdict["id"] == name).unwrap()["answer"].clone();
        assert_eq!((answer("sampling-margin"), answer("whole-loop")), (margin.into(), whole.into()), "{roots}");
        let summary = summary_of_run(&folder);
        let last = summary["metrics"]["disagreement"]["measured"]["last"].as_f64();
        assert_eq!(last.is_some_and(|last| last < 1e-9), agrees, "{roots}: {last:?}");
    }
}

/// Where roots are faster than K/M the loop as a whole needs shorter periods than σ says.
#[test]
fn regress_what_the_loop_as_a_whole_bears_limits_the_rule_for_slow_damping() {
    let slow = |control: &str| {
        format!(
            "format = 2\n[time]\nend_s = 60\n{control}[[agents]]\nname = \"m\"\ncount = 3\nrobot.point_mass = {{ dimension = 1, mass_kg = 10 }}\n\
             start.position_m = [[0], [1], [-1]]\n[reference.consensus]\nroots_per_s = [2, 4]\nexchange = \"position\"\n[law.known]\n\
             damping.gain = 8\n[network]\nedges.complete = {{}}\n"
        )
    };
    let folder = folder();
    fs::write(folder.path().join("slow.toml"), slow("")).unwrap();
    let setup = open_scenario(folder.path().join("slow.toml").to_str().unwrap()).unwrap().setup;
    let rule = Deployment { late: None, filter_hz: None }.rule(&setup).unwrap();
    assert!(rule.linearised && (0.2..0.3).contains(&rule.period_s), "{rule:?}");
    // The margin alone is enough at four times that, and says whom to ask.
    let verdicts = checked(&folder, &slow("[control]\nsample_hz = 1\n"));
    let find = |id: &str| verdicts.iter().find(|verdict| verdict["id"] == id).unwrap();
    let said = find("sampling-margin")["because"].as_str().unwrap();
    assert!(
        said.contains("references that answer at up to 6/s, by their roots, weights and λ")
            && said.contains("whole-loop"),
        "{said}"
    );
    assert_eq!(find("whole-loop")["answer"], "inadequate");
    assert!(!find("whole-loop")["because"].as_str().unwrap().contains("adapt"), "nothing adapts");
    assert!(
        summary_of_run(&folder)["metrics"]["disagreement"]["measured"]["last"].as_f64().is_none_or(|last| last > 1e3)
    );
}

/// A gain that is too large is named, and no run advises more damping where samples cannot bear what there is.
#[test]
fn regress_the_gain_that_samples_cannot_bear_is_named() {
    let arms = |damping: f64, adaptation: f64| {
        format!(
            "format = 2\ntime.end_s = 10\n[[agents]]\nname = \"arm\"\ncount = 3\nrobot.urdf.file = \"ur5e.urdf\"\n\
             start.position = {{ random = {{ seed = 1, within = [-1, 1] }} }}\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position_velocity\"\n[law.adaptive]\n\
             damping.bandwidth_per_s = {damping}\nadaptation_gain.bandwidth_per_s = {adaptation}\nestimate_start.scaled = 0.8\n\
             [control]\nsample_hz = 100\nvelocity.filtered_difference.cut_off_hz = 20\n[network]\nedges.ring = {{}}\n"
        )
    };
    let folder = folder();
    for (damping, adaptation, gain) in [(3.0, 5.0, "Γ"), (40.0, 0.01, "K")] {
        fs::write(folder.path().join("arms.toml"), arms(damping, adaptation)).unwrap();
        let said = stdout(&forwardstep(&folder, &["check", "arms.toml"]));
        let note = said.lines().find(|line| line.starts_with("note: `sample_hz`")).unwrap_or_else(|| panic!("{said}"));
        assert!(note.ends_with(&format!("let {gain} be smaller")), "{note}");
    }
}

/// What a run that missed its end says of damping and of goals is what its samples and its goal say.
#[test]
fn regress_no_more_damping_is_advised_where_samples_bear_no_more() {
    let masses = |damping: u32, end_s: u32, more: &str| {
        format!(
            "format = 2\ntime.end_s = {end_s}\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.point_mass = {{ dimension = 1, mass_kg = 2 }}\n\
             start.position_m = [[0], [1]]\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n[law.known]\n\
             damping.gain = {damping}\n[network]\nedges.ring = {{}}\n{more}"
        )
    };
    let folder = folder();
    let said = |text: String, status: i32| {
        fs::write(folder.path().join("own.toml"), text).unwrap();
        stdout(&forwardstep(&folder, &["run", "own.toml", "--force"]).code(status))
    };
    let noisy = "[control]\nsample_hz = 20\nnoise = { velocity = 1, seed = 1 }\n";
    let stiff = said(masses(70, 10, noisy), 0);
    assert!(
        stiff.contains("the sampling period is too long for the gains (margin σ = 0.87")
            && !stiff.contains("raise the damping"),
        "{stiff}"
    );
    let soft = said(masses(10, 10, noisy), 0);
    assert!(soft.contains("raise the damping"), "{soft}");
    // A goal may ask for less than agreement.
    let early = said(masses(5, 2, "[goal]\ndisagreement_below = 0.7\n"), 0);
    assert!(early.contains("agreed as far as the goal asks: 0.2 m apart"), "{early}");
    let late = said(masses(5, 20, "[goal]\ndisagreement_below = 0.7\n"), 0);
    assert!(late.contains("agreed: "), "{late}");
}

/// Three masses whose limits are a quarter of what the design asks for: everything else was adequate, and they ran away.
#[test]
fn regress_limits_that_drive_the_robots_instead_of_the_law_are_told() {
    let scenario = |limits: &str| {
        format!(
            "format = 2\ntime.end_s = 20\n[[agents]]\nname = \"m\"\ncount = 3\nrobot.point_mass = {{ dimension = 1, mass_kg = 2 }}\n\
             start.position_m = [[0.0], [1.0], [3.0]]\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position_velocity\"\n\
             [law.known]\ndamping.gain = 8\n[network]\nedges = [[\"m-1\", \"m-2\"], [\"m-2\", \"m-3\"], [\"m-3\", \"m-1\"]]\n\
             delay.constant_s = 0.1\n[control]\nsample_hz = 20\n{limits}\n"
        )
    };
    let folder = folder();
    for (limits, answer, part) in [
        ("torque_limit = 0.5", "inadequate", "in a trial of the whole run limits of torques change "),
        ("torque_rate_limit_per_s = 0.5", "inadequate", "limits of torque rates change "),
        ("torque_limit = 1.5", "not shown", "do not apply to this loop"),
        ("torque_limit = 2", "marginal", "apply while they change none"),
        ("torque_limit = 0.5\ntorque_rate_limit_per_s = 0.5", "inadequate", " and limits of their rates "),
        ("torque_limit = 7", "adequate", "in a trial of the whole run none of 1200 commands does"),
    ] {
        let found = checked(&folder, &scenario(limits));
        let clipped = found.iter().find(|one| one["id"] == "clipped-commands").unwrap();
        assert_eq!(clipped["answer"], answer, "{limits}: {clipped}");
        assert!(clipped["because"].as_str().unwrap().contains(part), "{limits}: {clipped}");
        assert!((0.0..=1.0).contains(&clipped["numbers"]["share"].as_f64().unwrap()), "{clipped}");
    }
    // Of a run that takes too much work the beginning is tried, which says nothing of a push that comes later.
    let long = scenario("torque_limit = 7")
        .replace("time.end_s = 20", "time = { end_s = 3000, record_every_s = 1 }")
        .replace("sample_hz = 20", "sample_hz = 1000");
    let found = checked(&folder, &long);
    let clipped = found.iter().find(|one| one["id"] == "clipped-commands").unwrap();
    assert_eq!(clipped["answer"], "not shown", "{clipped}");
    assert!(
        clipped["because"].as_str().unwrap().contains("the first 2.048 s, which is no whole run, none of"),
        "{clipped}"
    );
    let found = checked(&folder, &scenario(""));
    assert!(found.iter().all(|one| one["id"] != "clipped-commands"), "no limits");
    fs::write(folder.path().join("loop.toml"), scenario("torque_limit = 0.5")).unwrap();
    let arguments =
        ["check", "loop.toml", "--practical", "--predict", "--accept", "continuous-time", "--accept", "applied-torque"];
    let said = stdout(&forwardstep(&folder, &arguments).code(1));
    assert!(
        said.contains("m-1, axis 1 needs 2.047 N, above its limit of 0.500 N; the run will differ from this"),
        "{said}"
    );
    assert!(said.contains("(but controllers sample, which can delay it)"), "{said}");
}

/// An arm whose estimates leave the truth, which lowers the gain of its loop: at the true ones a mode would grow at 28/s, and a run of any length
/// converges. What a trial of 20 s contradicted was said of runs that were longer than it.
#[test]
fn regress_what_a_trial_contradicts_is_not_said_of_longer_runs() {
    let folder = folder();
    let arm = "[[agents]]\nname = \"arm\"\nrobot.planar_arm = { mass_kg = [2, 1.5], length_m = [1, 0.8] }\nstart.position_rad = [0.3, 0.3]\n\
               target.formulas = [\"0.5\", \"0.1\"]\n[reference.tracking]\nroots_per_s = [1, 1]\n[law.adaptive]\ndamping.gain = 20\n\
               adaptation_gain = 10\n[goal]\nerror_below = 1e-6\n";
    for end_s in [21, 200] {
        let verdicts = checked(&folder, &(head(end_s, 100.0) + arm));
        let whole = verdicts.iter().find(|verdict| verdict["id"] == "whole-loop").unwrap();
        assert_eq!(whole["answer"], "not shown", "{whole}");
        let said = whole.to_string();
        assert!(said.contains("though a trial of 20.48 s does not run away"), "{said}");
    }
    forwardstep(&folder, &["run", "loop.toml"]).success();
}

/// They were said to have agreed, without a word of where they went.
#[test]
fn regress_agents_that_run_away_together_are_said_to_move() {
    let folder = folder();
    let away = "format = 2\ntime.end_s = 200\n[[agents]]\nname = \"m\"\ncount = 3\nrobot.point_mass = { dimension = 1, mass_kg = 2 }\n\
                start = { position = [[0], [1], [3]], velocity = [0.5] }\n[reference.desired]\npolynomial = [0, 2, 3]\n\
                coupling_polynomial = [2, 3, 1]\nheard = [2.2]\n[law.known]\n[network]\ndelay.constant_s = 0.2\nedges.ring = {}\n";
    fs::write(folder.path().join("away.toml"), away).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "away.toml"]).success());
    assert!(said.contains("at most, all together still moving at "), "{said}");
    let said = stdout(&forwardstep(&folder, &["run", "five-ships"]).success());
    assert!(said.contains("agreed: ") && !said.contains("all together"), "{said}");
}

/// What holds the robots alone was said to hold them under a load as well.
#[test]
fn regress_a_standing_push_is_not_held_for_certain() {
    let folder = folder();
    let arm = |push: &str| {
        format!(
            "format = 2\ntime.end_s = 3\n[[agents]]\nname = \"a\"\ncount = 2\n\
             robot.planar_arm = {{ mass_kg = [1.0, 0.8], length_m = [1.0, 0.8] }}\nstart.position_rad = [[0.6, 0.3], [0.5, 0.3]]\n\
             [reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n[law.known]\n[network]\nedges.ring = {{}}\n\
             [control]\nsample_hz = 500\ntorque_limit = [30, 9]\n{push}"
        )
    };
    for (push, answer) in [
        ("", "adequate"),
        ("[[external_wrenches]]\non = [\"a-1\"]\nby.wrench = { force_n = [0, -10] }\n", "not shown"),
        ("[[external_wrenches]]\non = [\"a-1\"]\nfor_s = 1\nby.wrench = { force_n = [0, -10] }\n", "adequate"),
    ] {
        fs::write(folder.path().join("arm.toml"), arm(push)).unwrap();
        let said = stdout(&forwardstep(&folder, &["check", "arm.toml"]));
        assert!(said.contains(&format!("{answer}: torques and thrusts within their limits")), "{push}: {said}");
        assert_eq!(said.contains("a push that does not end asks for is not counted"), answer == "not shown", "{said}");
    }
}
