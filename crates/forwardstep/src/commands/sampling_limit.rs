//! `forwardstep sampling-limit`

use forwardstep::io::output::{Accepted, Deployment, LimitRemark, Measuring, Rule, SamplingLimit, Trial};
use forwardstep::io::scenario::Scenario;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::sim::{SetupError, VelocitySensor};

use super::progress::Bar;
use crate::arguments::SamplingLimitOptions;
use crate::console::{Console, DIM, Plain, complain};
use crate::number::short;
use crate::status::Status;

/// Ways to sample that a table shows for scenarios in continuous time: how late as a part of the period, and the filter in Hz.
const VARIANTS: [(Option<f64>, Option<f64>); 7] = [
    (None, None),
    (Some(0.25), None),
    (Some(0.5), None),
    (Some(0.9), None),
    (None, Some(60.0)),
    (None, Some(20.0)),
    (Some(0.5), Some(60.0)),
];

/// What to do where a scenario without `[control]` has a meaning and the same with samples has none.
const SHORTER: &str = "the scenario itself runs in continuous time; to find a period it is run with samples that are short for its gains: let \
                       `time.end_s` be shorter";

/// Measures the longest period with which scenarios still work, beside what rules allow.
pub(crate) fn sampling_limit(
    options: &SamplingLimitOptions,
    kinds: &Kinds,
    console: &mut Console,
) -> Result<Status, Status> {
    let mut status = Status::Fine;
    if options.table {
        console.line("| Scenario | Torque late by | Velocity | Rule, ms | Measured, ms | Rule / measured |");
        console.line("|---|---|---|---|---|---|");
    }
    for name in &options.scenarios {
        let scenario = kinds.open_scenario(name).map_err(|error| complain(&error))?;
        scenario.check_recording().map_err(|error| complain(&error))?;
        let deployments = deployments(options, &scenario);
        for deployment in &deployments {
            let accepted = Accepted { peak_error: options.peak_error, remains: options.disagreement };
            let (mut bar, mut of_s) = (Some(Bar::new()), f64::NAN);
            let mut watch = |seen: Measuring| match seen {
                Measuring::Runs { period_s, progress } => {
                    if period_s != of_s {
                        let what = format!("{}, {} ms", scenario.name, to_digits(1e3 * period_s, 4));
                        (bar, of_s) = (bar.take().map(|bar| bar.next(what)), period_s);
                    }
                    bar.iter_mut().for_each(|bar| bar.update(progress));
                }
                Measuring::Ran(trial) => {
                    if !options.table {
                        bar.iter().for_each(Bar::hide);
                        console.line(tried(trial));
                    }
                }
            };
            let measured = SamplingLimit::measure(&scenario.setup, *deployment, accepted, &mut watch);
            bar.into_iter().for_each(Bar::clear);
            let found = match measured {
                Ok(found) => found,
                // Of all ways to sample those that the laws have no use for, which measure no velocity.
                Err(SetupError::VelocityUnused { .. }) if deployments.len() > 1 => continue,
                Err(error) if scenario.setup.control.is_some() => return Err(complain(&Plain::new(error))),
                Err(error) => {
                    let said = format!("with the samples that are tried: {error}");
                    return Err(complain(&Plain::with_help(said, Some(SHORTER))));
                }
            };
            if options.table {
                console.line(row(&scenario, *deployment, &found));
            } else {
                conclude(&scenario, &found, console);
            }
            if found.measured_s.is_none() {
                status = Status::Missed;
            }
        }
    }
    Ok(status)
}

/// As asked for; in a table all of them, unless one is asked for or the scenario samples already.
fn deployments(options: &SamplingLimitOptions, scenario: &Scenario) -> Vec<Deployment> {
    let asked = Deployment { late: options.late, filter_hz: options.filter_hz };
    let all = options.table && asked == Deployment::default() && scenario.setup.control.is_none();
    if all {
        VARIANTS.into_iter().map(|(late, filter_hz)| Deployment { late, filter_hz }).collect()
    } else {
        vec![asked]
    }
}

fn tried(trial: Trial) -> String {
    let Trial { period_s, peak_error, remains, .. } = trial;
    // Periods that are tried may differ by half of what the one that is looked for is found to.
    let period = to_digits(1e3 * period_s, 4);
    if peak_error.is_finite() {
        format!("{DIM}  {period} ms: {}{} remains at the end{DIM:#}", bounded(peak_error, ", "), short(remains))
    } else {
        format!("{DIM}  {period} ms: breaks down{DIM:#}")
    }
}

fn conclude(scenario: &Scenario, found: &SamplingLimit, console: &mut Console) {
    console.line(&scenario.title);
    console.line(match found.rule {
        None => "  rule       – ms: none says anything of it".to_owned(),
        Some(Rule { period_s, linearised: false }) => {
            format!(
                "  rule       {} ms: at that period the sampling margin σ, as it is known before the run, is 1",
                ms(Some(period_s))
            )
        }
        Some(Rule { period_s, linearised: true }) => {
            format!(
                "  rule       {} ms: linearised, a mode of the loop as a whole grows from there on",
                ms(Some(period_s))
            )
        }
    });
    let accepted = format!(
        "accepted is that {}at most {} remains at the end",
        bounded(found.peak_error, ", and "),
        short(found.remains)
    );
    let runs = if found.trials.len() == 1 { "1 run".to_owned() } else { format!("{} runs", found.trials.len()) };
    let least = if found.remark == Some(LimitRemark::LongestTried) { "at least " } else { "" };
    let remark = found.remark.map_or_else(String::new, |remark| format!("; {}", remark.words()));
    console.line(match (found.measured_s, found.remark) {
        (Some(measured_s), _) => {
            format!("  measured   {least}{} ms; {accepted}; {runs}{remark}", to_digits(1e3 * measured_s, 4))
        }
        (None, None) => format!("  measured   – ms: no period that was tried gave this: {accepted}; {runs}"),
        (None, Some(remark)) => format!("  measured   – ms: {}", remark.words()),
    });
}

/// "|s| ≤ 0.301, ", where there is an s, and a bound on it.
fn bounded(peak_error: f64, joined: &str) -> String {
    if peak_error == 0.0 || peak_error.is_infinite() {
        return String::new();
    }
    if (1e-3..1e6).contains(&peak_error) {
        format!("|s| ≤ {peak_error:.3}{joined}")
    } else {
        format!("|s| ≤ {}{joined}", short(peak_error))
    }
}

fn row(scenario: &Scenario, deployment: Deployment, found: &SamplingLimit) -> String {
    let control = deployment.apply(&scenario.setup, found.trials.first().map_or(1e-3, |trial| trial.period_s)).control;
    let (sensors, delay_s) =
        control.map_or_else(Default::default, |control| (control.sensors, control.computation_delay_s));
    let late = match (deployment.late, delay_s) {
        (Some(late), _) => format!("{late} h"),
        (None, 0.0) => "–".into(),
        (None, delay_s) => format!("{} ms", ms(Some(delay_s))),
    };
    let velocity = match sensors.velocity {
        VelocitySensor::Measured => "measured".into(),
        VelocitySensor::Filtered { cut_off_hz } => format!("filtered at {cut_off_hz} Hz"),
    };
    let rule_s = found.rule.map(|rule| rule.period_s);
    let ratio =
        rule_s.zip(found.measured_s).map_or_else(|| "–".into(), |(rule, measured)| format!("{:.2}", rule / measured));
    let name = &scenario.name;
    let least = if found.remark == Some(LimitRemark::LongestTried) { "≥ " } else { "" };
    format!("| {name} | {late} | {velocity} | {} | {least}{} | {ratio} |", ms(rule_s), ms(found.measured_s))
}

/// Milliseconds to three digits.
fn ms(period_s: Option<f64>) -> String {
    period_s.map_or_else(|| "–".into(), |period_s| to_digits(1e3 * period_s, 3))
}

fn to_digits(value: f64, digits: u32) -> String {
    let places = (f64::from(digits) - 1.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.places$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The last of a bisection differ by half of its tolerance, 0.4 %.
    #[test]
    fn regress_periods_that_are_tried_can_be_told_apart() {
        for period_s in [1.0e-3, 1.1e-2, 9.96e-2] {
            let of = |period_s| Trial { period_s, peak_error: 1.0, peak_reference: 1.0, remains: 0.1, initial: 1.0 };
            assert_ne!(tried(of(period_s)), tried(of(1.002 * period_s)));
        }
        assert_eq!((ms(Some(0.011)), to_digits(11.0, 4)), ("11.0".into(), "11.00".into()));
    }

    #[test]
    fn regress_nothing_is_said_of_s_where_there_is_none_and_no_number_has_300_digits() {
        assert_eq!([0.0, f64::INFINITY].map(|peak| bounded(peak, ", ")), ["", ""]);
        let said = [1.9731, 1e-12, 3.5e170].map(|peak| bounded(peak, ", "));
        assert_eq!(said, ["|s| ≤ 1.973, ", "|s| ≤ 1.00 × 10⁻¹², ", "|s| ≤ 3.50 × 10¹⁷⁰, "]);
    }
}
