//! Plants with several axes: what turning the axes of two plants of one axis makes of them is one plant with a full matrix ψ, and its
//! trajectory is theirs, turned. The laws for one axis are validated elsewhere.

use std::ops::ControlFlow;

use forwardstep_check::{Answer, Id, check};
use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Inputs, Scenario, read_scenario};
use forwardstep_sim::{Ending, Method, Outcome, Signal, simulate};

/// Cosine and sine of the angle by which axes are turned, exactly: 0.8² + 0.6² = 1.
const TURNED: [&str; 2] = ["(0.8*x1 + 0.6*x2)", "(-0.6*x1 + 0.8*x2)"];
const TURNED_RATES: [&str; 2] = ["(0.8*dx1 + 0.6*dx2)", "(-0.6*dx1 + 0.8*dx2)"];

const HEAD: &str = r#"format = 2
time = { end_s = 12, record_every_s = 0.5 }
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position"
[network]
delay.saw_tooth = { min_s = 0.05, max_s = 0.4, period_s = 0.6 }
edges.ring = {}
"#;

/// χ₀, φ (times one parameter each) and ψ of an axis, in x and dx.
const PLANTS: [[&str; 3]; 2] = [["-x^3 - dx*abs(dx)", "sin(x)", "1 + x^2"], ["tanh(x)", "dx", "-2 - cos(x)"]];
const PARAMETERS: [f64; 2] = [0.8, -0.5];
/// Of two agents, by axis.
const STARTS: [[[f64; 2]; 2]; 2] = [[[0.4, -0.3], [-0.8, 0.2]], [[-0.5, 0.1], [0.9, 0.6]]];

fn read(text: &str) -> Scenario {
    read_scenario("vectors", &SourceText::new("vectors.toml", text), Inputs::default())
        .unwrap_or_else(|error| panic!("{text}\n{:?}", miette::Report::new(error)))
}

fn run(text: &str) -> Outcome {
    let mut setup = read(text).setup;
    setup.solver.method = Method::Adaptive { rtol: 1e-10, atol: 1e-12 };
    let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

fn laws(adaptive: bool) -> &'static str {
    if adaptive {
        "[law.linear_adaptive]\ngain_per_s = 2\nadaptation_gain = 3\n"
    } else {
        "[law.linearising]\ngain_per_s = 2\n"
    }
}

/// Two agents with one axis of a plant.
fn alone(axis: usize, adaptive: bool) -> String {
    let [chi, phi, psi] = PLANTS[axis];
    let starts = STARTS.map(|agent| agent[axis]);
    format!(
        "{HEAD}[[agents]]\nname = \"one\"\ncount = 2\n\
         robot.chain = {{ order = 2, chi = \"{chi}\", regressor = [\"{phi}\"], parameters = [{}], psi = \"{psi}\" }}\n\
         start = {{ position_m = [[{}], [{}]], velocity_m_s = [[{}], [{}]] }}\n{}",
        PARAMETERS[axis],
        starts[0][0],
        starts[1][0],
        starts[0][1],
        starts[1][1],
        laws(adaptive)
    )
}

/// Both axes of it, turned: with y = R x there is ÿ = R χ(Rᵀy) + R Y(Rᵀy) θ + R diag ψ(Rᵀy) u.
fn together(adaptive: bool) -> String {
    let own = |axis: usize, which: usize| {
        let text = PLANTS[axis][which].replace("dx", "@").replace('x', "#");
        // `x` of functions is none: there is none here but in the letters.
        format!("({})", text.replace('@', TURNED_RATES[axis]).replace('#', TURNED[axis]))
    };
    let rows = [["0.8", "-0.6"], ["0.6", "0.8"]];
    let chi = rows.map(|[a, b]| format!("\"{a}*{} + {b}*{}\"", own(0, 0), own(1, 0))).join(", ");
    let matrix = |which: usize| {
        let row = |[a, b]: [&str; 2]| format!("[\"{a}*{}\", \"{b}*{}\"]", own(0, which), own(1, which));
        rows.map(row).join(", ")
    };
    let turned = |pair: [f64; 2]| [0.8 * pair[0] - 0.6 * pair[1], 0.6 * pair[0] + 0.8 * pair[1]];
    let starts =
        |which: usize| STARTS.map(|agent| format!("{:?}", turned([agent[0][which], agent[1][which]]))).join(", ");
    format!(
        "{HEAD}[[agents]]\nname = \"both\"\ncount = 2\nstart = {{ position_m = [{}], velocity_m_s = [{}] }}\n\
         [agents.robot.vector_chain]\norder = 2\nchi = [{chi}]\nregressor = [{}]\nparameters = {PARAMETERS:?}\npsi = [{}]\n{}",
        starts(0),
        starts(1),
        matrix(1),
        matrix(2),
        laws(adaptive)
    )
}

fn column(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> &[f64] {
    let found = outcome.recording.columns.iter().find(|c| (c.agent, c.signal, c.axis) == (agent, signal, axis));
    &found.unwrap_or_else(|| panic!("{agent} {signal:?} {axis}")).values
}

#[test]
fn eq_33_axes_that_are_turned_move_as_they_did_turned() {
    for adaptive in [false, true] {
        let (both, alone) = (run(&together(adaptive)), [0, 1].map(|axis| run(&alone(axis, adaptive))));
        let mut moved = 0.0_f64;
        for (agent, signal) in [0, 1].into_iter().flat_map(|agent| {
            [Signal::Position, Signal::Velocity, Signal::TrackingError, Signal::Reference(0), Signal::Reference(1)]
                .map(|signal| (agent, signal))
        }) {
            let found = [0, 1].map(|axis| column(&both, agent, signal, axis));
            let own = [0, 1].map(|axis| column(&alone[axis], agent, signal, 0));
            for row in 0..found[0].len() {
                let turned = [0.8 * own[0][row] - 0.6 * own[1][row], 0.6 * own[0][row] + 0.8 * own[1][row]];
                for axis in 0..2 {
                    assert!((found[axis][row] - turned[axis]).abs() < 1e-8, "{adaptive} {agent} {signal:?} {row}");
                    moved = moved.max((turned[axis] - found[axis][0]).abs());
                }
            }
        }
        assert!(moved > 0.5);
        // The input is not turned: each drives its own axis as before.
        for (axis, alone) in alone.iter().enumerate() {
            let (found, own) = (column(&both, 0, Signal::Torque, axis), column(alone, 0, Signal::Torque, 0));
            assert!(found.iter().zip(own).all(|(a, b)| (a - b).abs() < 1e-7), "{adaptive} {axis}");
            if adaptive {
                let (found, own) = (column(&both, 0, Signal::Estimate, axis), column(alone, 0, Signal::Estimate, 0));
                assert!(found.iter().zip(own).all(|(a, b)| (a - b).abs() < 1e-8), "{axis}");
                assert!(found.iter().any(|estimate| estimate.abs() > 0.05), "{axis}");
            }
        }
    }
}

/// What is said of the factor of the input, and in which words.
fn factor(psi: &str, floor: &str) -> (Answer, String) {
    let text = format!(
        "{HEAD}[[agents]]\nname = \"two\"\ncount = 2\nstart.position_m = [[0.1, 0.2], [0.3, 0.4]]\n\
         robot.vector_chain = {{ order = 1, chi = [\"0\", \"0\"], psi = {psi} }}\n[law.linearising]\nfloor = {floor}\n"
    );
    let report = check(&read(&text).setup);
    let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::InputFactor).unwrap();
    (found.answer(), found.because())
}

#[test]
fn eq_43_a_matrix_keeps_its_inverse_where_that_is_shown_and_nowhere_else() {
    use Answer::{Holds, Violated, Watched};
    for (psi, floor, answer, says) in [
        (r#"[["2", "sin(x1)"], ["0.5", "-3"]]"#, "1e-3", Holds, "its smallest singular value is 1.4"),
        (r#"[["0", "1"], ["-1", "0"]]"#, "0.5", Holds, "its smallest singular value is 0.7"),
        (r#"[["0.8", "-0.6"], ["0.6", "0.8"]]"#, "1e-3", Holds, "its smallest singular value is"),
        (r#"[["2 + x1^2", "x1"], ["-x1", "1"]]"#, "1e-3", Watched, "smallest singular value below 0.001"),
        (r#"[["cos(x1)", "-sin(x1)"], ["sin(x1)", "cos(x1)"]]"#, "1e-3", Watched, "smallest singular value below"),
        (r#"[["2", "sin(x1)"], ["0.5", "-3"]]"#, "1.5", Watched, "at least, which is less"),
        (r#"[["0.1", "0.3"], ["0.3", "0.9"]]"#, "1e-9", Violated, "a matrix without an inverse"),
        (r#"[["0", "0"], ["0", "0"]]"#, "1e-9", Violated, "a matrix without an inverse"),
        (r#"[["1", "x1"], ["1", "x1"]]"#, "1e-3", Violated, "starts at 0, where the run ends"),
        (r#"[["1", "x1"], ["0.1 - x2", "x1"]]"#, "1e-3", Watched, "smallest singular value below"),
    ] {
        let (found, words) = factor(psi, floor);
        assert!(found == answer && words.contains(says), "{psi}: {found:?} {words}");
    }
}
