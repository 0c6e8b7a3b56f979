//! Runs of nonlinear protocols: what a table says of one row is held against its neighbours, and samples against continuous control.

use std::fs;

use crate::support::{folder, forwardstep};

/// Columns of a run of `desired-nonlinear-arms` with another protocol, by their names.
fn run(nonlinear: &str, more: &str) -> Vec<(String, Vec<f64>)> {
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/../io/scenarios/desired-nonlinear-arms.toml");
    let text = fs::read_to_string(shipped).unwrap();
    let text = text
        .replace("4*tanh(heard - weights*x)", nonlinear)
        .replace("end_s = 40", "end_s = 2\nrecord_every_s = 0.01")
        .replace("disagreement_below = 1e-3", "disagreement_below = 1e3");
    let folder = folder();
    fs::write(folder.path().join("own.toml"), text + more).unwrap();
    forwardstep(&folder, &["run", "own.toml", "--out", "run", "--csv"]).success();
    let table = fs::read_to_string(folder.path().join("run/trajectory.csv")).unwrap();
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns: Vec<(String, Vec<f64>)> = names.into_iter().map(|name| (name.to_owned(), Vec::new())).collect();
    for line in lines {
        let cells = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN));
        columns.iter_mut().zip(cells).for_each(|((_, column), cell)| column.push(cell));
    }
    columns
}

fn column<'a>(columns: &'a [(String, Vec<f64>)], name: &str) -> &'a [f64] {
    &columns.iter().find(|(known, _)| known == name).unwrap_or_else(|| panic!("{name}")).1
}

#[test]
fn regress_the_rate_of_a_reference_is_told_at_its_time() {
    // At the end the factor of the protocol is 1.54, and 5 at the start.
    let columns = run("(1 + 4*exp(-t))*tanh(heard - weights*x)", "");
    let (mut compared, mut largest) = (0, 0.0_f64);
    for agent in 1..=4 {
        for axis in ["shoulder", "elbow"] {
            let of = |signal: &str| column(&columns, &format!("arm-{agent}.{signal}.{axis}"));
            let (z, dz) = (of("z"), of("dz"));
            for k in (2..z.len() - 2).step_by(7) {
                let slope = (z[k - 2] - 8.0 * z[k - 1] + 8.0 * z[k + 1] - z[k + 2]) / 0.12;
                assert!(
                    (slope - dz[k]).abs() < 0.02 * (1.0 + dz[k].abs()),
                    "arm-{agent} {axis}, row {k}: {slope} {}",
                    dz[k]
                );
                (compared, largest) = (compared + 1, largest.max(dz[k].abs()));
            }
        }
    }
    assert!(compared > 150 && largest > 1.0, "{compared} {largest}");
}

#[test]
fn regress_a_nonlinear_protocol_is_not_stepped_like_an_affine_one() {
    // tanh of what lies far apart is one; by its values at unit vectors it would be many times that.
    let protocol = "5*tanh(heard - weights*x)";
    let (continuous, sampled) = (run(protocol, ""), run(protocol, "\n[control]\nsample_hz = 1000\n"));
    for agent in 1..=4 {
        for name in ["q.shoulder", "q.elbow", "z.shoulder"].map(|signal| format!("arm-{agent}.{signal}")) {
            let [ideal, held] = [&continuous, &sampled].map(|columns| column(columns, &name).to_vec());
            let apart = ideal.iter().zip(&held).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(ideal.len() == held.len() && apart < 0.05, "{name}: {apart}");
        }
    }
}
