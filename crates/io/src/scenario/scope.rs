//! Wishes for what is not modelled, and the nearest thing that is.

/// Words that a wish is written with, each a whole word of a key, and what there is instead. The first row that fits counts.
const WISHES: &[(&[&str], &str)] = &[
    (
        &[
            "obstacle",
            "obstacles",
            "collision",
            "collisions",
            "avoidance",
            "avoid",
            "environment",
            "walls",
            "wall",
            "safety",
            "safe",
            "distance",
            "distances",
            "separation",
        ],
        "robots and obstacles pass through each other; position limits of a URDF can be enforced (`enforce_limits`)",
    ),
    (
        &["contact", "contacts", "ground", "grasp", "touch", "impact", "terrain", "floor", "slope"],
        "nothing touches anything; what pushes a robot is given as a course in time: `[[external_wrenches]]`",
    ),
    (
        &["floating", "freeflyer", "legged", "humanoid", "mobile"],
        "arms stand on a fixed base; what moves freely is a kind of its own: `robot.vehicle`, `robot.rotorcraft`, `robot.spacecraft`, `robot.ship`",
    ),
    (
        &["camera", "cameras", "vision", "lidar", "image", "perception", "slam"],
        "controllers measure positions and velocities; noise, resolution and late samples are in `[control]`",
    ),
    (
        &["trajectory", "trajectories", "planner", "planning", "mpc", "optimal", "optimisation", "optimization"],
        "nothing is planned; robots agree (`reference.consensus`), follow a leader (`reference.leader`) or targets (`reference.tracking`)",
    ),
    (
        &["soft", "flexible", "elastic", "elasticity", "backlash", "cable", "tendon"],
        "joints and links are rigid; `damping`, `armature` and `friction` are what is known of drives",
    ),
    (
        &["ros", "ros2", "hardware", "driver", "ethercat", "fieldbus"],
        "the program talks to no robot; the controllers of the library do, a step at a time: `core::sampled::Sampled`",
    ),
    (
        &["learning", "neural", "policy", "reward", "training"],
        "nothing is trained; what adapts are the parameters of a model: `law.adaptive`",
    ),
    (
        &["wind", "weather", "aerodynamics", "drag", "waves"],
        "what acts from outside is given as a course in time or drawn: `[[external_wrenches]]`",
    ),
];

/// That a key or a choice asks for something that is not modelled, and what is nearest to it.
pub(super) fn beyond(word: &str) -> Option<String> {
    let word = word.to_ascii_lowercase();
    let parts: Vec<&str> = word.split(['_', '-', '.', ' ']).collect();
    if parts.contains(&"gravity") {
        return Some("gravity is said of each robot: `robot.urdf.gravity_m_s2 = [0, 0, -9.81]`, `robot.planar_arm.gravity_m_s2 = 9.81`".into());
    }
    let (_, nearest) = WISHES.iter().find(|(words, _)| parts.iter().any(|part| words.contains(part)))?;
    Some(format!("that is not modelled, see Limits in the README; the nearest there is: {nearest}"))
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
            let said = beyond(word).unwrap_or_default();
            assert!(said.contains("not modelled, see Limits") && said.contains(part), "{word}: {said}");
        }
        assert!(beyond("gravity_direction").is_some_and(|said| said.starts_with("gravity is said of each robot")));
        for word in ["", "grounds", "databases", "cameraman", "base", "weight"] {
            assert_eq!(beyond(word), None, "{word}");
        }
    }
}
