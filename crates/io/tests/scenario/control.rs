//! `[control]`: what is read, and what every mistake gets.

use forwardstep_core::sampled::SafeCommand;
use forwardstep_sim::{Actuators, Control, Failures, Sensors, VelocitySensor};
use miette::Diagnostic;

use super::{as_stated, changed, read};

/// The sound scenario with lines of `[control]`, which begins on line 37.
fn with(lines: &str) -> String {
    changed("[goal]", &format!("[control]\n{lines}\n[goal]"))
}

/// The lines, the first line of the error, and a part of the help.
type Case = (&'static str, &'static str, &'static str);

#[rustfmt::skip]
const CASES: &[Case] = &[
    ("",
        "test.toml:37:1: the key `sample_hz` is missing", ""),
    ("sample_hz = 500\nsafe_command = \"zeros\"",
        "test.toml:39:16: unknown choice `zeros`", "did you mean `zero`?"),
    ("sample_hz = 500\nsafe_command.values = []",
        "test.toml:39:23: `values` is empty", ""),
    ("sample_hz = 500\nmessage_timeout_s = -1",
        "test.toml:39:21: `message_timeout_s` is -1, but must not be negative", ""),
    ("sample_hz = 0",
        "test.toml:38:13: `sample_hz` is 0, but must be positive", ""),
    ("sample_hz = -500",
        "test.toml:38:13: `sample_hz` is -500, but must be positive", ""),
    ("sample_hz = \"fast\"",
        "test.toml:38:13: found \"fast\" where a number should stand", ""),
    ("sample_hz = 1e9",
        "test.toml:38:13: about 1e10 samples until the end of the run, but at most 1e7 are accepted", "sample more slowly"),
    ("sample_Hz = 500",
        "test.toml:38:1: unknown key `sample_Hz`", "did you mean `sample_hz`?"),
    ("sample_hz = 500\nsample_hz = 500",
        "test.toml:39:1: not valid TOML: duplicate key", ""),
    ("sample_hz = 500\ncomputation_delay_s = -0.001",
        "test.toml:39:23: `computation_delay_s` is -0.001, but must be from 0 to 0.002", ""),
    ("sample_hz = 500\ncomputation_delay_s = 0.1",
        "test.toml:39:23: `computation_delay_s` is 0.1, but must be from 0 to 0.002", "before the next begins"),
    ("sample_hz = 500\nvelocity = \"guessed\"",
        "test.toml:39:12: unknown choice `guessed`", "choose one of"),
    ("sample_hz = 500\nvelocity = \"filtered_difference\"",
        "test.toml:39:12: `filtered_difference` needs a value", "write it with its value"),
    ("sample_hz = 500\nvelocity.filtered_difference = {}",
        "test.toml:39:32: the key `cut_off_hz` is missing", ""),
    ("sample_hz = 500\nvelocity.filtered_difference.cut_off_hz = 0",
        "test.toml:39:43: `cut_off_hz` is 0, but must be positive", ""),
    ("sample_hz = 500\nvelocity.filtered_difference.cutoff_hz = 50",
        "test.toml:39:30: unknown key `cutoff_hz`", "did you mean `cut_off_hz`?"),
    ("sample_hz = 500\nnoise.position = 1e-4",
        "test.toml:39:1: the key `seed` is missing", ""),
    ("sample_hz = 500\nnoise = { seed = -1 }",
        "test.toml:39:18: `seed` is -1, but must not be negative", ""),
    ("sample_hz = 500\nnoise = { seed = 1, position = -1e-4 }",
        "test.toml:39:32: `noise.position` is -0.0001, but must not be negative", ""),
    ("sample_hz = 500\nnoise = { seed = 1, torque = 1 }",
        "test.toml:39:21: unknown key `torque`", "allowed here"),
    ("sample_hz = 500\nnoise = { seed = 1, velocity = 1e-3 }\nvelocity.filtered_difference.cut_off_hz = 50",
        "test.toml:39:32: the noise of velocities is 0.001, but velocities come from filtered differences of positions", "delete it"),
    ("sample_hz = 500\nquantisation.velocity = 1e-3\nvelocity.filtered_difference.cut_off_hz = 50",
        "test.toml:39:25: the step of velocities is 0.001, but velocities come from filtered differences of positions", "delete it"),
    ("sample_hz = 500\nquantisation.position = -1",
        "test.toml:39:25: `quantisation.position` is -1, but must not be negative", ""),
    ("sample_hz = 500\nquantization.position = 1e-4",
        "test.toml:39:1: unknown key `quantization`", "did you mean `quantisation`?"),
    ("sample_hz = 500\ntorque_limit = 0",
        "test.toml:39:16: `torque_limit` is 0, but must be positive", ""),
    ("sample_hz = 500\ntorque_limit = [1, -2]",
        "test.toml:39:20: `torque_limit` is -2, but must be positive", ""),
    ("sample_hz = 500\ntorque_limit = [1, 2, 3]",
        "test.toml:39:16: agent `arm-1`: the limit of torques has 3 entries where 2 are needed", "a single number stands for all axes"),
    ("sample_hz = 500\ntorque_rate_limit_per_s = []",
        "test.toml:39:27: agent `arm-1`: the limit of torque rates has 0 entries where 2 are needed", "a single number"),
    ("sample_hz = 500\ntorque_rate_limit_per_s = \"none\"",
        "test.toml:39:27: found \"none\" where a number, or a list of numbers should stand", ""),
];

#[test]
fn every_mistake_in_control_is_reported_at_its_place() {
    as_stated(CASES.iter().map(|(lines, line, help)| ((*lines).to_owned(), read(&with(lines)), *line, *help)));
}

#[test]
fn more_messages_than_fit_into_memory_are_refused() {
    let text = with("sample_hz = 1e6")
        .replace("delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }", "delay.constant_s = 1e6")
        .replace("[goal]", "[solver]\nmemory_budget_bytes = 500_000_000\n[goal]");
    let error = read(&text).unwrap_err();
    let message =
        "messages that can still be heard take 960000288 bytes or more, but the memory budget is 500000000 bytes";
    assert_eq!(error.to_string(), format!("test.toml:40:23: {message}"));
    let help = "write `memory_budget_bytes = 960000288` or more in `[solver]`, sample more slowly, or shorten the longest delay";
    assert_eq!(error.help().unwrap().to_string(), help);
    // Where no budget is written the rate is to blame.
    let text = text
        .replace("memory_budget_bytes = 500_000_000", "")
        .replace("count = 2", "count = 4")
        .replace("start.position_rad = [[0.1, 0.2], [0.3, 0.4]]", "");
    let error = read(&text).unwrap_err().to_string();
    assert!(error.starts_with("test.toml:38:13: messages that can still be heard take 1600000480 bytes"), "{error}");
}

#[test]
fn control_is_read_as_it_is_written() {
    let lines = "sample_hz = 500\ncomputation_delay_s = 0.002\nvelocity.filtered_difference.cut_off_hz = 40\n\
                 noise = { seed = 9, position = 1e-4 }\nquantisation = { position = 1e-5, torque = 0.5 }\n\
                 torque_limit = 20\ntorque_rate_limit_per_s = [100, 200]";
    let control = Control {
        failures: Default::default(),
        sample_hz: 500.0,
        computation_delay_s: 0.002,
        sensors: Sensors {
            velocity: VelocitySensor::Filtered { cut_off_hz: 40.0 },
            position_noise: 1e-4,
            velocity_noise: 0.0,
            tip_velocity_noise: 0.0,
            seed: 9,
            position_quantum: 1e-5,
            velocity_quantum: 0.0,
        },
        actuators: Actuators {
            torque_limit: Some(vec![20.0, 20.0]),
            torque_rate_limit: Some(vec![100.0, 200.0]),
            torque_quantum: 0.5,
        },
    };
    assert_eq!(read(&with(lines)).unwrap().setup.control, Some(control));
    let default = read(&with("sample_hz = 1000\nvelocity = \"measured\"")).unwrap().setup.control.unwrap();
    assert_eq!(default.sensors, Sensors::default());
    assert_eq!(default.actuators, Actuators::default());
    assert_eq!(read(super::SOUND).unwrap().setup.control, None);
}

#[test]
fn what_happens_when_a_controller_cannot_go_on_is_read() {
    let failures =
        |lines: &str| read(&with(&format!("sample_hz = 500\n{lines}"))).unwrap().setup.control.unwrap().failures;
    assert_eq!(failures(""), Failures::default());
    let safe = |lines: &str| failures(lines).safe_command.unwrap();
    assert_eq!(safe("safe_command = \"hold\""), SafeCommand::HoldLast);
    assert_eq!(safe("safe_command = \"zero\""), SafeCommand::Zero);
    assert_eq!(safe("safe_command.values = [1, -2.5]"), SafeCommand::Values(vec![1.0, -2.5]));
    assert_eq!(failures("message_timeout_s = 0.25").message_timeout_s, Some(0.25));
}

#[test]
fn sampling_that_is_too_slow_for_the_gain_is_said() {
    let notices = |lines| {
        let scenario = read(&with(lines)).unwrap();
        scenario.notices.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(notices("sample_hz = 1000"), Vec::<String>::new());
    let coarse = notices("sample_hz = 20");
    assert_eq!(coarse.len(), 1);
    assert!(coarse[0].starts_with("`sample_hz` is low for the gains: the sampling margin σ is "), "{coarse:?}");
    assert!(coarse[0].ends_with(" Hz, or let K be smaller"), "{coarse:?}");
    let late = notices("sample_hz = 20\ncomputation_delay_s = 0.049");
    assert!(
        late[0].ends_with("; with these gains the torque comes too late for any rate; let K be smaller"),
        "{late:?}"
    );
}
