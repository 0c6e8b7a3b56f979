//! `[leader]` and `reference.leader`: what is read, and what mistakes get.

use forwardstep_core::reference::Choice;
use forwardstep_sim::Exchange;
use forwardstep_sim::leader::{FollowingDesign, Leading};
use forwardstep_sim::trajectory::Path;
use miette::Diagnostic;

use super::read;

const SOUND: &str = r#"format = 2
time.end_s = 5
[leader]
motion.formulas = ["sin(t)"]
[[agents]]
name = "cart"
count = 2
robot.point_mass = { dimension = 1, mass_kg = 2 }
[reference.leader]
design = "continuous"
roots_per_s = [1.5]
gain = 3
[network]
edges = [["leader", "cart-1"], ["cart-1", "cart-2"]]
[goal]
error_below = 1e-2
"#;

fn changed(from: &str, to: &str) -> String {
    assert_eq!(SOUND.matches(from).count(), 1, "{from:?} must occur once");
    SOUND.replace(from, to)
}

#[test]
fn a_leader_is_the_last_vertex_of_the_network() {
    let scenario = read(SOUND).unwrap();
    let following = scenario.setup.following().unwrap();
    assert_eq!((scenario.setup.agents.len(), scenario.setup.network.agents), (2, 3));
    assert_eq!((following.design, following.choice), (FollowingDesign::Continuous, Choice::Implicit));
    assert_eq!((following.alpha, following.gain, following.period_s), (1.5, 3.0, 1e-3));
    assert_eq!(scenario.setup.network.schedule.graph(0)[0].from, 2);
    assert_eq!(scenario.setup.vertex_name(2), "leader");
}

#[test]
fn designs_signs_and_motions_are_read() {
    let two = changed("\"continuous\"", "\"without_acceleration\"").replace("[1.5]", "[1.0, 3.0]");
    let setup = read(&two).unwrap().setup;
    let following = setup.following().unwrap();
    assert_eq!((following.alpha, following.beta), (3.0, 4.0));
    assert_eq!(following.design, FollowingDesign::WithoutAcceleration);
    // (p + 0.5)² + 2²
    let pair = two.replace("[1.0, 3.0]", "[{ real = 0.5, imaginary = 2 }]");
    let setup = read(&pair).unwrap().setup;
    assert_eq!(setup.following().map(|following| (following.alpha, following.beta)), Some((4.25, 1.0)));
    let one = |text: String| read(&text).unwrap_err().to_string();
    let needs = |found: &str, need: usize| format!("`roots_per_s` has {found}, but this design needs {need}");
    assert!(one(pair.replace("without_acceleration", "continuous")).contains(&needs("2 roots", 1)));
    assert!(one(pair.replace("= 2 }]", "= 2 }, 1]")).contains(&needs("3 roots", 2)));
    assert!(one(changed("[1.5]", "[]")).contains(&needs("0 roots", 1)));
    let swarm = two.replace("without_acceleration", "swarm").replace("gain = 3", "gain = 3\ncoupling = 7");
    assert_eq!(read(&swarm).unwrap().setup.following().unwrap().design, FollowingDesign::Swarm { coupling: 7.0 });
    // α is the first of the two, however large, and κ the second.
    let observer = changed("\"continuous\"", "\"observer\"").replace("[1.5]", "[3.0, 0.5]");
    let setup = read(&observer).unwrap().setup;
    let following = setup.following().unwrap();
    assert_eq!((following.design, following.alpha), (FollowingDesign::Observer { kappa: 0.5 }, 3.0));
    assert_eq!(setup.exchange, Exchange::Estimates);
    // One vector has α and β of two roots, a pair, or as they are stated, and is what is told.
    let told = two.replace("without_acceleration", "composite");
    let paired = pair.replace("without_acceleration", "composite");
    let stated = told.replace("roots_per_s = [1.0, 3.0]", "alpha = 3\nbeta = 4");
    for (text, wanted) in [(&told, (3.0, 4.0)), (&paired, (4.25, 1.0)), (&stated, (3.0, 4.0))] {
        let setup = read(text).unwrap().setup;
        let following = setup.following().unwrap();
        assert_eq!((following.design, setup.exchange), (FollowingDesign::Composite, Exchange::Composite));
        assert_eq!((following.alpha, following.beta), wanted);
    }
    for (sign, choice) in [
        ("\"implicit\"", Choice::Implicit),
        ("\"explicit\"", Choice::Explicit),
        ("{ boundary_layer = { width = 0.1 } }", Choice::Layer { width: 0.1 }),
    ] {
        let text = changed("gain = 3", &format!("gain = 3\nsign = {sign}"));
        assert_eq!(read(&text).unwrap().setup.following().unwrap().choice, choice);
    }
    let swings = "motion.sinusoids = [{ offset = 1, waves = [{ amplitude = 2, rad_per_s = 3 }] }]";
    let points = "motion.points = { times_s = [0, 1, 3], positions = [[0], [1], [-1]] }";
    for motion in [swings, points] {
        let setup = read(&changed("motion.formulas = [\"sin(t)\"]", motion)).unwrap().setup;
        let path = &setup.following().unwrap().motion().unwrap().trajectory.paths()[0];
        assert_eq!(matches!(path, Path::Spline(_)), motion == points);
    }
    // A rule joins the agents, not the leader.
    let ring = changed("edges = [[\"leader\", \"cart-1\"], [\"cart-1\", \"cart-2\"]]", "edges.ring = {}");
    assert!(read(&ring).unwrap().setup.network.schedule.graph(0).iter().all(|edge| edge.from < 2 && edge.to < 2));
}

#[test]
fn mistakes_about_leaders_are_reported() {
    for (text, message, help) in [
        (changed("[leader]\nmotion.formulas = [\"sin(t)\"]\n", ""), "there is none", "add `[leader]`"),
        (changed("[1.5]", "[1, 2]"), "needs 1", "one root"),
        (changed("[\"cart-1\", \"cart-2\"]]", "[\"cart-1\", \"leader\"]]"), "hears no agent", "turn it round"),
        (changed("[\"sin(t)\"]", "[\"abs(sin(1e5*t))\"]"), "more than 10000 kinks", "shorten the run"),
        (changed("gain = 3", "gain = 0"), "must be positive", ""),
        (changed("\"continuous\"", "\"observer\""), "1 root, but this design needs 2", "`observer` has two real ones"),
        (
            changed("\"continuous\"", "\"observer\"").replace("[1.5]", "[{ real = 1, imaginary = 2 }]"),
            "needs 2",
            "`observer` has two real ones",
        ),
        (
            changed("\"continuous\"", "\"observer\"").replace("[1.5]", "[1, 2, 3]"),
            "3 roots, but this design needs 2",
            "",
        ),
        (
            changed("\"continuous\"", "\"observer\"").replace("roots_per_s = [1.5]", "alpha = 1"),
            "given by its roots",
            "write `roots_per_s = [1.0, 2.0]`",
        ),
        (
            changed("\"continuous\"", "\"observer\"").replace("roots_per_s = [1.5]\n", ""),
            "`roots_per_s` is missing",
            "",
        ),
        (changed("gain = 3", "gain = 3\ncoupling = 1"), "belongs to the design `swarm`", ""),
        (changed("\"continuous\"", "\"swarm\"").replace("[1.5]", "[1, 2]"), "`coupling` is missing", ""),
        (changed("[leader]", "[leader]\nname = \"cart-1\""), "cart-1", ""),
        (changed("[\"sin(t)\"]", "[\"sin(t)\", \"t\"]"), "2 entries", ""),
        (changed("error_below", "disagreement_below"), "follows a target or a leader", "error_below"),
        (
            changed("motion.formulas = [\"sin(t)\"]", "motion.points = { times_s = [0, 0], positions = [[0], [1]] }"),
            "`times_s` goes from 0 to 0, but must rise",
            "",
        ),
    ] {
        let error = read(&text).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
        let said = error.help().map(|help| help.to_string()).unwrap_or_default();
        assert!(said.contains(help), "{error}: {said}");
    }
}

const LED_BY_AGENT: &str = r#"format = 2
time.end_s = 5
[leader]
agent = "pilot"
[[agents]]
name = "cart"
count = 2
robot.point_mass = { dimension = 1, mass_kg = 2 }
[[agents]]
name = "pilot"
robot.point_mass = { dimension = 1, mass_kg = 3 }
reference.tracking.roots_per_s = [2, 1]
target.formulas = ["sin(t)"]
[reference.leader]
design = "continuous"
roots_per_s = [1.5]
gain = 3
[network]
edges = [["pilot", "cart-1"], ["cart-1", "cart-2"]]
[goal]
error_below = 1e-2
"#;

#[test]
fn an_agent_leads_and_is_a_vertex_already() {
    let setup = read(LED_BY_AGENT).unwrap().setup;
    assert_eq!(setup.following().unwrap().leader, Leading::Agent(2));
    assert_eq!((setup.agents.len(), setup.network.agents, setup.leader()), (3, 3, Some(2)));
    assert_eq!((0..3).map(|agent| setup.tracks(agent)).collect::<Vec<_>>(), [false, false, true]);
    assert_eq!([2, 0].map(|agent| setup.agents[agent].roots_per_s.clone()), [[2.0, 1.0][..].into(), [][..].into()]);
    assert_eq!(setup.vertex_name(2), "pilot");
    let one = LED_BY_AGENT.replace("\"pilot\"", "\"cart-1\"");
    let error = read(&one).unwrap_err().to_string();
    assert!(error.contains("cart-1"), "{error}");
}

#[test]
fn mistakes_about_an_agent_that_leads_are_reported_at_their_place() {
    for (from, to, message, help) in [
        ("agent = \"pilot\"", "agent = \"pilto\"", "4:9: there is no agent `pilto`", "did you mean `pilot`?"),
        ("agent = \"pilot\"", "agent = \"cart\"", "4:9: there is no agent `cart`", "`cart-1`"),
        (
            "agent = \"pilot\"",
            "agent = \"pilot\"\nname = \"boss\"",
            "5:8: `pilot` leads, and has a name already",
            "leave",
        ),
        (
            "agent = \"pilot\"",
            "agent = \"pilot\"\nmotion.formulas = [\"t\"]",
            "4:9: there are two leaders",
            "own `target`",
        ),
        ("agent = \"pilot\"", "name = \"boss\"", "3:1: a leader needs a `motion`, or an `agent`", "which agent leads"),
        ("target.formulas = [\"sin(t)\"]\n", "", "10:8: agent `pilot` is to track a target", "`target`"),
        ("reference.tracking.roots_per_s = [2, 1]\n", "", "roots of the reference dynamics: 0", "roots of its own"),
        ("reference.tracking", "reference.consensus", "12:1: `pilot` cannot have", "`reference.tracking`"),
        ("count = 2", "count = 2\nreference.tracking.roots_per_s = [1]", "8:1: `cart-1` cannot have", "remove it"),
        ("[\"cart-1\", \"cart-2\"]]", "[\"cart-1\", \"pilot\"]]", "19:31: `pilot` leads and hears no agent", ""),
        ("count = 2", "count = 2\ntarget.formulas = [\"t\"]", "offsets", "leave its `target` out"),
        ("error_below", "disagreement_below", "follows a target or a leader", "error_below"),
    ] {
        assert_eq!(LED_BY_AGENT.matches(from).count(), 1, "{from:?} must occur once");
        let error = read(&LED_BY_AGENT.replace(from, to)).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
        let said = error.help().map(|help| help.to_string()).unwrap_or_default();
        assert!(said.contains(help), "{error}: {said}");
    }
    let sampled = LED_BY_AGENT.replace("\"continuous\"", "\"differentiable\"").replace("[1.5]", "[1, 2]");
    assert!(read(&sampled).is_ok());
    let error = read(&format!("{sampled}[control]\nsample_hz = 100\n")).unwrap_err().to_string();
    assert!(error.contains("3:1: agent `pilot` cannot lead the others: its acceleration"), "{error}");
    assert!(read(&format!("{LED_BY_AGENT}[control]\nsample_hz = 100\n")).is_ok());
}

/// α and β as the paper writes them are those of the roots that they have.
#[test]
fn a_leader_is_followed_by_alpha_and_beta_as_by_roots() {
    let following =
        |text: &str| read(text).unwrap_or_else(|error| panic!("{error}")).setup.following().cloned().unwrap();
    assert_eq!(following(&changed("roots_per_s = [1.5]", "alpha = 1.5")), following(SOUND));
    for (design, roots, stated) in [
        ("differentiable", "[1.0, 3.0]", "alpha = 3\nbeta = 4"),
        ("without_acceleration", "[{ real = 0.5, imaginary = 2 }]", "alpha = 4.25\nbeta = 1"),
        ("swarm\"\ncoupling = 9 # \"", "[1.0, 3.0]", "alpha = 3\nbeta = 4"),
    ] {
        let by_roots = changed("continuous", design).replace("[1.5]", roots);
        let stated = by_roots.replace(&format!("roots_per_s = {roots}"), stated);
        assert_eq!(following(&stated), following(&by_roots), "{design}");
    }
    // Roots that no number of a file is: p² + p + 0.2.
    let irrational =
        following(&changed("continuous", "differentiable").replace("roots_per_s = [1.5]", "alpha = 0.2\nbeta = 1"));
    assert_eq!((irrational.alpha, irrational.beta), (0.2, 1.0));
}

#[test]
fn mistakes_about_alpha_and_beta_are_reported() {
    let two = changed("continuous", "differentiable");
    let swarm = changed("\"continuous\"", "\"swarm\"\ncoupling = 9").replace("roots_per_s = [1.5]", "alpha = 4");
    for (text, message) in [
        (
            changed("roots_per_s = [1.5]", "roots_per_s = [1.5]\nalpha = 1.5"),
            "test.toml:12:9: both `roots_per_s` and `alpha` are given",
        ),
        (two.replace("[1.5]", "[1, 2]\nbeta = 3"), "test.toml:12:8: both `roots_per_s` and `beta` are given"),
        (changed("roots_per_s = [1.5]", "alpha = 1.5\nbeta = 1"), "test.toml:12:8: `continuous` has no β"),
        (two.replace("roots_per_s = [1.5]", "alpha = 1.5"), "the key `beta` is missing"),
        (two.replace("roots_per_s = [1.5]", "beta = 1.5"), "the key `alpha` is missing"),
        (two.replace("roots_per_s = [1.5]\n", ""), "the key `roots_per_s` is missing"),
        (
            two.replace("roots_per_s = [1.5]", "alpha = 0\nbeta = 1"),
            "test.toml:11:9: `alpha` is 0, but must be positive",
        ),
        (swarm, "the key `beta` is missing"),
        (two.replace("roots_per_s = [1.5]", "alpha = 1\nbeta = nan"), "nan is not a finite number"),
    ] {
        let error = read(&text).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}
