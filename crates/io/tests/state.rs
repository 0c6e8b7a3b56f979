//! States of robots as JSON: what they say, and what is refused where.

use forwardstep_io::robot::{JointState, read_state};
use forwardstep_io::{Problem, SourceText};
use proptest::prelude::*;

const JOINTS: [&str; 2] = ["shoulder", "elbow"];

/// The state, or the error and its help as the user sees them.
fn read(text: &str) -> Result<JointState, String> {
    crate::seeds::keep("state", text);
    read_state(&SourceText::new("s.json", text), &JOINTS).map_err(|error| match error.problem.help() {
        Some(help) => format!("{error}; {help}"),
        None => error.to_string(),
    })
}

#[test]
fn numbers_come_in_the_order_of_the_joints() {
    let state =
        read(" {\n\"elbow\": {\"dz\": -4e0, \"z\": 3, \"dq\": 2, \"q\": 1},\t\"should\\u0065r\": {\"q\": 0.1}}\n")
            .unwrap();
    let expected = JointState { q: vec![0.1, 1.0], dq: vec![0.0, 2.0], z: vec![0.0, 3.0], dz: vec![0.0, -4.0] };
    assert_eq!(state, expected);
}

#[test]
fn mistakes_are_reported_at_their_place() {
    let needed = "every moving joint needs a position `q`; `dq`, `z` and `dz` are 0 unless given";
    let object = r#"write { "joint": { "q": 0, "dq": 0, "z": 0, "dz": 0 }, … }"#;
    let cases = [
        ("", "s.json:1:1: not well-formed JSON: EOF while parsing a value".to_owned()),
        ("[]", format!("s.json:1:1: the state is `[]`, but must be an object; {object}")),
        ("{\n \"elbow\": 3 }", format!("s.json:2:11: joint `elbow` is `3`, but must be an object; {object}")),
        (
            "{\"elbwo\": {\"q\": 1}}",
            "s.json:1:2: the robot has no moving joint `elbwo`; did you mean `elbow`? its joints are `shoulder`, `elbow`"
                .to_owned(),
        ),
        (
            "{\"elbow\": {\"qd\": 1}}",
            "s.json:1:12: joint `elbow` has the unknown entry `qd`; did you mean `q`? entries are `q`, `dq`, `z`, `dz`"
                .to_owned(),
        ),
        ("{\"elbow\": {\"q\": 1}}", format!("s.json: the state says nothing of joint `shoulder`; {needed}")),
        ("{\"elbow\": {\"z\": 1}}", format!("s.json:1:11: joint `elbow` has no `q`; {needed}")),
        ("{\"elbow\": {\"q\": \"1\"}}", "s.json:1:17: `q` of joint `elbow` is `\"1\"`, which is not a number".to_owned()),
        ("{\"elbow\": {\"q\": null}}", "s.json:1:17: `q` of joint `elbow` is `null`, which is not a number".to_owned()),
        ("{\"elbow\": {\"q\": 1e999}}", "s.json:1:17: `1e999` is not a finite number".to_owned()),
        ("{\"elbow\": {\"q\": NaN}}", "s.json:1:17: `NaN` is not a finite number".to_owned()),
        ("{\"elbow\": {\"q\": -Infinity}}", "s.json:1:18: `Infinity` is not a finite number".to_owned()),
        ("{\"elbow\": {\"q\": 1, \"q\": 1}}", "s.json:1:20: `q` of joint `elbow` is given twice".to_owned()),
        ("{\"elbow\": {\"q\": 1}, \"elbow\": {}}", "s.json:1:21: joint `elbow` is given twice".to_owned()),
        ("{\n\"elbow\": {\"q\" 1}}", "s.json:2:15: not well-formed JSON: expected `:`".to_owned()),
        ("{\"elbow\": {\"q\": 01}}", "s.json:1:18: not well-formed JSON: invalid number".to_owned()),
        (
            "{\"\\u001b\\n\": {}}",
            "s.json:1:2: the robot has no moving joint `\\u{1b}\\n`; its joints are `shoulder`, `elbow`".to_owned(),
        ),
        ("{\"é\": {\"q\": x}}", "s.json:1:13: not well-formed JSON: expected value".to_owned()),
    ];
    for (text, message) in cases {
        assert_eq!(read(text), Err(message), "{text}");
    }
}

proptest! {
    #[test]
    fn prop_no_state_panics(text in "[\\[\\]{}\":,.a-z0-9é\\\\ \n-]{0,40}", cut in 0_usize..60, at in 0_usize..60) {
        let whole = "{\"shoulder\": {\"q\": 1, \"z\": -2e-3},\n\"elbow\": {\"q\": 0.5}}";
        let (cut, at) = (cut.min(whole.len()), at.min(whole.len()));
        let _ = read(&text);
        let _ = read(&format!("{}{text}{}", &whole[..cut], &whole[at..]));
    }
}
