//! What is said to make a hypothesis hold, applied.

use forwardstep::check::{Answer, Id, check};
use forwardstep::io::SourceText;
use forwardstep::io::scenario::read_scenario;

#[test]
fn regress_changes_that_are_named_help() {
    let found = |text: &str, id: Id| {
        let scenario = read_scenario("own", &SourceText::new("own.toml", text), None).unwrap();
        let report = check(&scenario.setup);
        let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == id).unwrap();
        (found.answer(), found.change().unwrap_or_default())
    };
    let chain = |floor: &str| {
        format!(
            "format = 2\n[time]\nend_s = 10\n[[agents]]\nname = \"c\"\ncount = 2\nstart.position = [[1], [-1]]\n\
             robot.chain = {{ order = 1, chi = \"0\", psi = \"1e-5*(2 + sin(x))\" }}\n[reference.consensus]\nroots_per_s = [1]\n\
             exchange = \"position\"\n[law.linearising]\ngain_per_s = 1\n{floor}\n[network]\nedges.ring = {{}}\n"
        )
    };
    let (answer, change) = found(&chain(""), Id::InputFactor);
    assert!(answer == Answer::Violated && change.contains("`floor` below 2.841e-5 for c-1, or a start"), "{change}");
    assert_eq!(found(&chain("floor = 9e-6"), Id::InputFactor).0, Answer::Holds);

    let delayed = |delay: &str| {
        format!(
            "format = 2\n[time]\nend_s = 10\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.point_mass = {{ dimension = 1, mass_kg = 1 }}\n\
             start.position_m = [[1], [-1]]\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n\
             [law.adaptive]\ndamping.gain = 1\nadaptation_gain = 1\n[network]\ndelay.formula_s = \"{delay}\"\nedges.ring = {{}}\n"
        )
    };
    let (answer, change) = found(&delayed("0.4 - min(t, 0.4)"), Id::BoundedDelays);
    assert_eq!((answer, change.as_str()), (Answer::NotShown, "max(T, 0) in the place of the formula T"));
    assert_eq!(found(&delayed("max(0.4 - min(t, 0.4), 0)"), Id::BoundedDelays).0, Answer::Holds);

    // A swarm over a path that leads one way, then both ways with too small a k, then with the k that is named.
    let swarm = |coupling: f64, back: &str| {
        format!(
            "format = 2\n[time]\nend_s = 10\n[leader]\nmotion.formulas = [\"sin(t)\"]\n[[agents]]\nname = \"m\"\ncount = 3\n\
             robot.point_mass = {{ dimension = 1, mass_kg = 1 }}\nstart.position_m = [[1], [-1], [0]]\n[reference.leader]\n\
             design = \"swarm\"\nroots_per_s = [1, 1]\ncoupling = {coupling}\ngain = 2\nsign_period_s = 0.002\n[law.adaptive]\ndamping.gain = 1\n\
             adaptation_gain = 1\n[network]\nedges = [[\"leader\", \"m-1\"], [\"m-1\", \"m-2\"], [\"m-2\", \"m-3\"]{back}]\n"
        )
    };
    let (answer, change) = found(&swarm(1.0, ""), Id::MutualWeights);
    assert_eq!(answer, Answer::NotCovered);
    assert!(
        change.starts_with("edges from m-1 to m-2, from m-2 to m-3, each")
            || change.starts_with("edges from m-2 to m-1, from m-3 to m-2, each"),
        "{change}"
    );
    let (_, change) = found(&swarm(1.0, ""), Id::SwarmCoupling);
    assert!(change.contains("lead both ways"), "{change}");
    let back = ", [\"m-2\", \"m-1\"], [\"m-3\", \"m-2\"]";
    assert_eq!(found(&swarm(1.0, back), Id::MutualWeights).0, Answer::Holds);
    let (_, change) = found(&swarm(1.0, back), Id::SwarmCoupling);
    let least: f64 =
        change.strip_prefix("a `coupling` of at least ").unwrap_or_else(|| panic!("{change}")).parse().unwrap();
    assert_eq!(found(&swarm(least, back), Id::SwarmCoupling).0, Answer::Holds);
    assert_eq!(found(&swarm(0.98 * least, back), Id::SwarmCoupling).0, Answer::NotShown);
}
