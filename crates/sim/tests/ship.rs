//! Surface ships under (6)–(7): the balance of the proof, agreement, and the same motion in the axes of the body.

use crate::common::{balance_residual, column, last, run, switching};
use forwardstep_core::Gain;
use forwardstep_sim::{Adaptive, AgentSetup, Known, RobotSetup, Setup, Signal};

/// kg, kg m, kg m²; N s/m, N s, N m s. D is not symmetric.
const THETA: [f64; 9] = [25.8, 33.8, 1.1, 2.8, 12.0, 17.0, 0.4, 0.7, 1.5];

fn ship(name: &str, q: [f64; 3], adapts: bool) -> AgentSetup {
    let damping = Gain::Diagonal(vec![60.0, 60.0, 12.0]);
    let robot = RobotSetup::ship(THETA);
    let agent = if adapts {
        let law = Adaptive { damping, adaptation: Gain::Bandwidth(1.5), estimate_start: vec![0.0; 9], bounds: None };
        AgentSetup::new(name, robot, law)
    } else {
        AgentSetup::new(name, robot, Known { damping })
    };
    agent.roots([0.8, 1.2]).at(&q).moving(&[0.3, -0.2, 0.4])
}

fn ships(adapts: bool) -> Setup {
    let starts = [[2.0, 0.0, 0.5], [-1.0, 1.5, -2.0], [0.0, -2.0, 2.5]];
    let agents: Vec<_> = (0..3).map(|k| ship(&format!("ship-{k}"), starts[k], adapts)).collect();
    Setup::consensus(agents, switching(), 60.0)
}

#[test]
fn thm2_ships_agree_and_their_balance_holds_along_the_run() {
    for adapts in [false, true] {
        let setup = ships(adapts);
        let outcome = run(&setup);
        for agent in 0..3 {
            // V̇ = −sᵀ(K + ½ (D_q + D_qᵀ)) s.
            let error = balance_residual(&outcome, agent, 1e-3);
            assert!(error < 1e-5, "adapts: {adapts}, ship {agent}: {error:e}");
            for axis in 0..3 {
                let gap = last(&outcome, agent, Signal::Position, axis) - last(&outcome, 0, Signal::Position, axis);
                assert!(gap.abs() < 2e-3, "adapts: {adapts}, ship {agent}, axis {axis}: {gap:e}");
            }
        }
    }
}

/// d/dt of (x, y, ψ, u, v, r) by M ν̇ + C(ν) ν + D ν = Rᵀ τ, with τ in the earth frame.
fn body_rate(x: [f64; 6], tau: [f64; 3]) -> [f64; 6] {
    let [m11, m22, m23, m33, d11, d22, d23, d32, d33] = THETA;
    let [_, _, psi, u, v, r] = x;
    let (sin, cos) = psi.sin_cos();
    let lateral = m22 * v + m23 * r;
    let surge = cos * tau[0] + sin * tau[1] + lateral * r - d11 * u;
    let sway = cos * tau[1] - sin * tau[0] - m11 * u * r - d22 * v - d23 * r;
    let yaw = tau[2] - (lateral - m11 * v) * u - d32 * v - d33 * r;
    let determinant = m22 * m33 - m23 * m23;
    let d_v = (m33 * sway - m23 * yaw) / determinant;
    let d_r = (m22 * yaw - m23 * sway) / determinant;
    [cos * u - sin * v, sin * u + cos * v, r, surge / m11, d_v, d_r]
}

#[test]
fn val_a_ship_moves_as_in_a_simulation_in_the_axes_of_its_body() {
    const ROW_S: f64 = 1e-3;
    let mut setup = ships(true);
    setup.time.end_s = 5.0;
    setup.time.record_every_s = ROW_S;
    setup.solver.method = forwardstep_sim::Method::Adaptive { rtol: 1e-10, atol: 1e-12 };
    let outcome = run(&setup);
    let row = |agent, signal, row: usize| [0, 1, 2].map(|axis| column(&outcome, agent, signal, axis)[row]);
    for agent in 0..3 {
        let (q, dq) = (row(agent, Signal::Position, 0), row(agent, Signal::Velocity, 0));
        let (sin, cos) = q[2].sin_cos();
        let nu = [cos * dq[0] + sin * dq[1], cos * dq[1] - sin * dq[0], dq[2]];
        let mut x = [q[0], q[1], q[2], nu[0], nu[1], nu[2]];
        // The classical method over two rows, whose three torques are those of its stages. Torques are continuous here.
        let h = 2.0 * ROW_S;
        let mut worst = 0.0_f64;
        for step in 0..2500 {
            let tau = [0, 1, 2].map(|k| row(agent, Signal::Torque, 2 * step + k));
            let moved = |k: [f64; 6], by: f64| std::array::from_fn(|i| x[i] + by * k[i]);
            let k1 = body_rate(x, tau[0]);
            let k2 = body_rate(moved(k1, 0.5 * h), tau[1]);
            let k3 = body_rate(moved(k2, 0.5 * h), tau[1]);
            let k4 = body_rate(moved(k3, h), tau[2]);
            x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
            let q = row(agent, Signal::Position, 2 * step + 2);
            worst = (0..3).fold(worst, |worst, axis| worst.max((x[axis] - q[axis]).abs()));
        }
        assert!(worst < 1e-7, "ship {agent}: {worst:e}");
    }
}
