//! Two masses that hear each other 0.3 s late agree on a position. Run it with `cargo run --example first`.

use forwardstep::sim::delay::Delay;
use forwardstep::sim::{AgentSetup, Known, Network, RobotSetup, Setup, SetupError, Signal, run};

fn main() -> Result<(), SetupError> {
    let mass = |name: &str, at: f64| {
        AgentSetup::new(name, RobotSetup::point_mass(1, 2.0), Known::gain(8.0)).roots([1.0, 2.0]).at(&[at])
    };
    let network = Network::fixed(2, [(0, 1), (1, 0)], Delay::constant(0.3));
    let setup = Setup::consensus([mass("left", 0.0), mass("right", 1.0)], network, 20.0);
    let recording = run(&setup)?.recording;
    let [left, right] = [0, 1].map(|agent| recording.values(agent, Signal::Position, 0).unwrap_or_default());
    for (row, t_s) in recording.t_s.iter().enumerate().step_by(100) {
        println!("{t_s:5.1} s  {:8.4} m  {:8.4} m", left[row], right[row]);
    }
    Ok(())
}
