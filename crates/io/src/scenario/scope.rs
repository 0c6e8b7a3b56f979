//! Wishes for what is not modelled, and the nearest thing that is.

/// Words for what has another name here, each a whole word of a key or the key, and where it is.
const NAMES: &[(&[&str], &str)] = &[
    (
        &["quadrotor", "quadrotors", "quadcopter", "multirotor", "multicopter", "hexacopter", "drone", "uav"],
        "a quadrotor is called `rotorcraft` here: `robot.rotorcraft`",
    ),
    (&["satellite", "cubesat"], "a satellite is called `spacecraft` here: `robot.spacecraft`"),
    (&["boat", "vessel", "usv"], "a vessel is called `ship` here: `robot.ship`"),
    (
        &["integrator", "integrators", "particle", "double_integrator"],
        "an integrator is `robot.point_mass`, which takes forces, or `robot.chain` of any order",
    ),
    (
        &["mujoco", "mjcf", "sdf", "gazebo", "usd", "xacro", "dh", "denavit"],
        "robots are read from URDF: convert the model, and write `robot.urdf.file = \"my-robot.urdf\"`",
    ),
    (
        &["gripper", "grippers", "finger", "fingers"],
        "a gripper is a part of the URDF; its joints are held with `robot.urdf.locked = { panda_finger_joint1 = 0.02 }`",
    ),
    (
        &["payload", "load", "payloads"],
        "what an arm carries is a part of its URDF: a link with its mass and inertia, held by a fixed joint; an adaptive law learns it",
    ),
    (
        &["backstepping"],
        "the baseline of backstepping is `reference.backstepping`; chains in feedback form have `law.adaptive_backstepping`",
    ),
    (
        &["formation", "formations", "offset", "offsets"],
        "vehicles and rotorcraft keep a formation by a `target` of each agent, which is then its offset from where all agree",
    ),
    (
        &["packet_loss", "packet", "packets", "loss", "dropout", "dropouts", "jitter"],
        "packets that are late and get lost are a delay: `delay.packets`, with `loss` and `jitter_s`",
    ),
    (
        &["gui", "visualization", "visualisation", "viewer", "animation", "render", "plot", "plots", "display"],
        "every run writes a page, `report.html`, with plots and a picture that plays; nothing has to be asked for",
    ),
    (
        &["realtime", "real_time", "rt"],
        "a run takes as long as it takes to compute; controllers that a clock calls are those of the library: `core::sampled::Sampled`",
    ),
];

/// Words that a wish is written with, each a whole word of a key or the key; what is so here, and what comes nearest. The first row that
/// fits counts.
const WISHES: &[(&[&str], &str)] = &[
    (
        &[
            "obstacle",
            "obstacles",
            "barrier",
            "barriers",
            "sphere",
            "spheres",
            "scene",
            "collision",
            "collisions",
            "avoidance",
            "avoid",
            "environment",
            "world",
            "walls",
            "wall",
            "safety",
            "safe",
            "distance",
            "distances",
            "separation",
        ],
        "robots pass through each other, and there are no obstacles. Nearest: a `target` keeps vehicles and rotorcraft apart by constant \
         offsets, and `enforce_limits` ends a run where a joint leaves the position limits of its URDF",
    ),
    (
        &["contact", "contacts", "ground", "grasp", "touch", "impact", "terrain", "floor", "slope"],
        "nothing touches anything. Nearest: `[[external_wrenches]]`, which push a robot as a course in time or as virtual springs",
    ),
    (
        &["floating", "base", "freeflyer", "legged", "humanoid", "mobile", "quadruped", "biped", "hexapod", "legs"],
        "arms stand on a fixed base. Nearest: the kinds that move freely, `robot.vehicle`, `robot.rotorcraft`, `robot.spacecraft`, `robot.ship`",
    ),
    (
        &[
            "unicycle",
            "car",
            "cars",
            "bicycle",
            "rover",
            "wheeled",
            "wheels",
            "differential",
            "diff_drive",
            "ackermann",
        ],
        "nothing rolls. Nearest: `robot.ship`, which moves in the plane in every direction, and `robot.vehicle`, which is pushed along one axis of its body",
    ),
    (
        &["auv", "rov", "submarine", "underwater", "airplane", "aircraft", "helicopter"],
        "submarines and aircraft with wings have no kind of their own. Nearest: `robot.ship` in the plane, `robot.vehicle` and `robot.rotorcraft` in space",
    ),
    (
        &["camera", "cameras", "sensor", "sensors", "imu", "gps", "vision", "lidar", "image", "perception", "slam"],
        "controllers measure positions and velocities alone. Nearest: noise, resolution and late samples of those, in `[control]`",
    ),
    (
        &["trajectory", "trajectories", "planner", "planning", "mpc", "optimal", "optimisation", "optimization"],
        "nothing is planned. Nearest: robots agree (`reference.consensus`), follow a leader (`reference.leader`) or targets (`reference.tracking`)",
    ),
    (
        &["soft", "flexible", "elastic", "elasticity", "backlash", "cable", "tendon"],
        "joints and links are rigid. Nearest: what is known of drives, `damping`, `armature` and `friction`",
    ),
    (
        &["ros", "ros2", "hardware", "driver", "ethercat", "fieldbus"],
        "the program talks to no robot. Nearest: the controllers of the library, which a program of your own steps: `core::sampled::Sampled`",
    ),
    (
        &["learning", "neural", "policy", "reward", "training", "rl", "reinforcement"],
        "nothing is trained. Nearest: `law.adaptive`, which adapts the parameters of a model",
    ),
    (
        &["pid", "pd", "pi", "lqr", "lqg", "computed_torque", "inverse_dynamics", "feedforward"],
        "laws follow the reference velocity z. Nearest: `law.known` for a robot whose parameters are known, `law.adaptive` for others, each with a damping K",
    ),
    (
        &["impedance", "admittance", "compliance", "stiffness", "spring", "springs"],
        "no law shapes an impedance. Nearest: virtual springs, `[[external_wrenches]]`, and `manipulability_gain`, by which agents give way when they are pushed",
    ),
    (
        &["sliding_mode", "sliding", "smc", "h_infinity", "robust", "supertwisting"],
        "no tracking law switches. Nearest: `reference.leader`, which has a set-valued sign; `law.known` or `law.adaptive` follow what it asks for",
    ),
    (
        &["wind", "weather", "aerodynamics", "drag", "waves"],
        "there is no air and no sea. Nearest: `[[external_wrenches]]`, which act from outside as a course in time or drawn",
    ),
    (
        &["flocking", "flock", "boids", "repulsion", "cohesion"],
        "agents do not repel each other. Nearest: they agree (`reference.consensus`), vehicles and rotorcraft up to a `target` of each, or follow a \
         leader (`reference.leader`)",
    ),
];

/// That a key, a choice or a name asks for something that has another name here, as `quadrotor`, or is not modelled, and what is nearest to it.
pub fn nearest_here(word: &str) -> Option<String> {
    let word = word.to_ascii_lowercase();
    if word.split(SEPARATORS).any(|part| part == "gravity") {
        return Some("gravity is said of each robot: `robot.urdf.gravity_m_s2 = [0, 0, -9.81]`, `robot.planar_arm.gravity_m_s2 = 9.81`".into());
    }
    if let Some(name) = found(NAMES, &word) {
        return Some(name.to_owned());
    }
    let nearest = found(WISHES, &word)?;
    Some(format!("that is not modelled (see Limits in the README, and What is not modelled in the book): {nearest}"))
}

/// What stands between the words of a key.
const SEPARATORS: [char; 4] = ['_', '-', '.', ' '];

/// Whether a key is one word.
pub(super) fn is_one(word: &str) -> bool {
    !word.contains(SEPARATORS)
}

/// The row of the first that is a word of this key, or the key.
fn found(rows: &[(&[&str], &'static str)], word: &str) -> Option<&'static str> {
    let parts: Vec<&str> = word.split(SEPARATORS).collect();
    let is_asked = |asked: &&str| parts.contains(asked) || word.replace(SEPARATORS, "_") == *asked;
    rows.iter().find(|(words, _)| words.iter().any(is_asked)).map(|(_, says)| *says)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wishes_are_known_by_whole_words() {
        for (word, part) in [
            ("obstacles", "position limits"),
            ("collision_avoidance", "position limits"),
            ("safety", "position limits"),
            ("min_distance_m", "position limits"),
            ("terrain", "[[external_wrenches]]"),
            ("floating_base", "`robot.vehicle`"),
            ("Contact", "[[external_wrenches]]"),
            ("camera-rate", "`[control]`"),
        ] {
            let said = nearest_here(word).unwrap_or_default();
            assert!(said.contains("not modelled (see Limits") && said.contains(part), "{word}: {said}");
        }
        for (word, part) in [
            ("quadrotor", "`robot.rotorcraft`"),
            ("packet-loss", "`delay.packets`"),
            ("payload_kg", "its URDF"),
            ("Formation", "`target`"),
            ("mjcf", "read from URDF"),
            ("backstepping", "`reference.backstepping`"),
            ("real_time", "Sampled"),
        ] {
            let said = nearest_here(word).unwrap_or_default();
            assert!(!said.contains("not modelled") && said.contains(part), "{word}: {said}");
        }
        for word in [
            "unicycle",
            "auv",
            "quadruped",
            "base",
            "pid",
            "computed_torque",
            "impedance",
            "sliding_mode",
            "rl",
            "flocking",
        ] {
            assert!(nearest_here(word).is_some_and(|said| said.contains(". Nearest: ")), "{word}");
        }
        assert!(
            nearest_here("gravity_direction").is_some_and(|said| said.starts_with("gravity is said of each robot"))
        );
        for word in ["", "grounds", "databases", "cameraman", "basement", "weight"] {
            assert_eq!(nearest_here(word), None, "{word}");
        }
    }
}
