//! Chains and the laws for them, and nonlinear couplings: every mistake in a scenario, where it is reported and what is said.

use super::{Case, refused};

/// Two plants of order three.
pub(super) const DERIVATIVES: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "chain"
count = 2
robot.chain = { order = 3, chi = "-dx*d2x", psi = "2 + cos(x)", regressor = ["sin(x)", "dx"], parameters = [-9, 0.5] }
start = { position_m = [[1], [-1]], velocity_m_s = [0.5], higher_states = [0.1] }

[reference.consensus]
roots_per_s = [1, 2, 1.5]
exchange = "position"

[law.immersion]
gain_per_s = 3
adaptation_gain = [20, 5]
estimate_start.scaled = 0.5
antiderivatives = ["d2x*sin(x)", "d2x*dx"]
floor = 1e-2

[network]
coupling.saturated = 0.4
edges.ring = {}

[goal]
disagreement_below = 1e-3
"#;

#[rustfmt::skip]
const DERIVATIVES_CASES: &[Case] = &[
    ("order = 3", "order = 0",
        "test.toml:7:25: `order` is 0, but must be from 1 to 255", ""),
    ("order = 3", "order = 256",
        "test.toml:7:25: `order` is 256, but must be from 1 to 255", ""),
    ("order = 3", "order = 2.5",
        "test.toml:7:25: found 2.5 where a whole number should stand", ""),
    ("order = 3, ", "",
        "test.toml:7:15: the key `order` is missing", ""),
    ("order = 3", "oder = 3",
        "test.toml:7:17: unknown key `oder`", "did you mean `order`? allowed here: `order`, `chi`, `psi`, `regressor`, `parameters`"),
    ("\"-dx*d2x\"", "\"-dx*d3x\"",
        "test.toml:7:39: there is no `d3x` in this formula", "did you mean `d2x`? there are `x`, `dx`, `d2x`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("\"-dx*d2x\"", "\"-dx*ddx\"",
        "test.toml:7:39: there is no `ddx` in this formula", "did you mean `d2x`? there are `x`, `dx`, `d2x`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("\"-dx*d2x\"", "\"-dx*t\"",
        "test.toml:7:39: there is no `t` in this formula", "did you mean `x`? there are `x`, `dx`, `d2x`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("\"-dx*d2x\"", "\"\"",
        "test.toml:7:35: the formula is empty", "a formula in t is for example \"0.2 + 0.1*sin(2*pi*t/3)\", one of a chain \"-x^3 + sin(x)\""),
    ("\"-dx*d2x\"", "\"-dx*\"",
        "test.toml:7:39: found its end in a formula where a number, a variable, a function or a parenthesis should stand", ""),
    ("\"-dx*d2x\"", "\"(dx\"",
        "test.toml:7:35: this parenthesis is not closed", ""),
    ("\"-dx*d2x\"", "\"2dx\"",
        "test.toml:7:36: found \"d\" in a formula where an operator (+ - * / ^) or the end should stand", "products are written with a star: `2*pi`, `3*(pi + 1)`"),
    ("\"-dx*d2x\"", "\"dx**2\"",
        "test.toml:7:37: found \"**\" in a formula where one operator should stand", "powers are written `2^3`"),
    ("\"-dx*d2x\"", "\"2^dx\"",
        "test.toml:7:37: the exponent changes with dx", "exponents are constant; write `exp(dx*log(2))` for 2 to the dx"),
    ("\"-dx*d2x\"", "\"sin dx\"",
        "test.toml:7:35: the function `sin` has no argument", "write `sin(…)`"),
    ("\"-dx*d2x\"", "\"sine(dx)\"",
        "test.toml:7:35: there is no function `sine`", "did you mean `sin`? the functions are `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("\"-dx*d2x\"", "\"sign(dx)\"",
        "test.toml:7:35: `sign` jumps, but formulas are continuous", "what jumps has keys of its own: `delay.piecewise_constant`, `delay.saw_tooth`, or phases of a network; elsewhere `tanh` of something large comes close"),
    ("\"-dx*d2x\"", "\"max(dx)\"",
        "test.toml:7:35: `max` takes two arguments or more, but has 1", ""),
    ("\"-dx*d2x\"", "\"1e99*x\"",
        "test.toml:7:35: 1e99 is too large a number", "numbers may be up to 1e30 in size"),
    ("\"-dx*d2x\"", "0",
        "test.toml:7:34: found 0 where a text in quotes should stand", ""),
    ("chi = \"-dx*d2x\"", "ch = \"-dx\"",
        "test.toml:7:28: unknown key `ch`", "did you mean `chi`? allowed here: `order`, `chi`, `psi`, `regressor`, `parameters`"),
    ("\"2 + cos(x)\"", "\"2 + cos(y)\"",
        "test.toml:7:60: there is no `y` in this formula", "did you mean `x`? there are `x`, `dx`, `d2x`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("\"2 + cos(x)\"", "\"1/\"",
        "test.toml:7:54: found its end in a formula where a number, a variable, a function or a parenthesis should stand", ""),
    ("[\"sin(x)\", \"dx\"]", "[\"sin(x)\"]",
        "test.toml:7:102: `parameters` has 2 entries, but `regressor` needs 1", ""),
    ("[\"sin(x)\", \"dx\"]", "[\"sin(x)\", \"dy\"]",
        "test.toml:7:89: there is no `dy` in this formula", "did you mean `dx`? there are `x`, `dx`, `d2x`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("[\"sin(x)\", \"dx\"]", "\"sin(x)\"",
        "test.toml:7:77: found \"sin(x)\" where a list should stand", ""),
    ("[\"sin(x)\", \"dx\"]", "[\"sin(x)\", \"abs(d2x)\"]",
        "test.toml:18:34: agent `chain-1`: the antiderivative of regressor 2 has the slope 0.7703296142690075 in the highest derivative where the regressor is 1.8754845034029017", "leave `antiderivatives` out for regressors without the highest derivative"),
    ("parameters = [-9, 0.5]", "parameters = [-9]",
        "test.toml:7:108: `parameters` has 1 entry, but `regressor` needs 2", ""),
    ("parameters = [-9, 0.5]", "parameters = -9",
        "test.toml:7:108: found -9 where a list should stand", ""),
    ("parameters = [-9, 0.5]", "parameters = [-9, nan]",
        "test.toml:7:113: nan is not a finite number", ""),
    ("parameters = [-9, 0.5]", "parameter = [-9, 0.5]",
        "test.toml:7:95: unknown key `parameter`", "did you mean `parameters`? allowed here: `order`, `chi`, `psi`, `regressor`, `parameters`"),
    ("velocity_m_s = [0.5]", "velocity_m_s = [0.5, 1]",
        "test.toml:8:52: `velocity_m_s` has 2 entries, but `chain-1` needs 1", ""),
    ("higher_states = [0.1]", "higher_states = [0.1, 0]",
        "test.toml:8:75: `higher_states` has 2 entries, but `chain-1` needs 1", ""),
    ("higher_states = [0.1]", "higher_state = [0.1]",
        "test.toml:8:59: unknown key `higher_state`", "did you mean `higher_states`? allowed here: `position_rad`, `position_m`, `position`, `velocity_rad_s`, `velocity_m_s`, `velocity`, `attitude`, `angular_velocity_rad_s`, `spacecraft`, `rotation`, `higher_states`, `reference`"),
    ("higher_states = [0.1]", "attitude = [0, 0, 0, 1]",
        "test.toml:8:70: `attitude` says nothing about `chain-1`", "vehicles, rotorcraft and spacecraft have an attitude"),
    ("[1, 2, 1.5]", "[1]",
        "test.toml:11:15: agent `chain-1`: roots of the reference dynamics: 1, but at least 2 are needed here", "an agent may have `reference` with roots of its own"),
    ("[1, 2, 1.5]", "[1, 0, 1.5]",
        "test.toml:11:19: `roots_per_s` is 0, but must be positive", ""),
    ("exchange = \"position\"", "exchange = \"position_velocity\"",
        "test.toml:22:1: a nonlinear coupling goes with consensus by positions only", "write `exchange = \"position\"` in `reference.consensus`, or leave `coupling` out"),
    ("exchange = \"position\"", "exchange = \"position\"\nmanipulability_gain = 1",
        "test.toml:13:23: agent `chain-1`: immersion and invariance has no manipulability gain, but 1 is given", "leave `manipulability_gain` out"),
    ("[reference.consensus]", "[reference.pure_integral]",
        "test.toml:11:15: agent `chain-1`: the list of roots has 3 entries where 2 are needed", "give it 2 roots; an agent may have `reference` with roots of its own"),
    ("[reference.consensus]\nroots_per_s = [1, 2, 1.5]\nexchange = \"position\"", "[reference.tracking]\nroots_per_s = [1, 2, 1.5]",
        "test.toml:21:1: a nonlinear coupling goes with consensus by positions only", "write `exchange = \"position\"` in `reference.consensus`, or leave `coupling` out"),
    ("gain_per_s = 3", "gain_per_s = 0",
        "test.toml:15:14: `gain_per_s` is 0, but must be positive", ""),
    ("gain_per_s = 3", "gain = 3",
        "test.toml:15:1: unknown key `gain`", "allowed here: `gain_per_s`, `adaptation_gain`, `estimate_start`, `bounds`, `antiderivatives`, `floor`"),
    ("adaptation_gain = [20, 5]", "adaptation_gain = [20, 5, 1]",
        "test.toml:16:19: `adaptation_gain` has 3 entries, but `chain-1` needs 2", ""),
    ("adaptation_gain = [20, 5]", "adaptation_gain = [20, -5]",
        "test.toml:16:24: `adaptation_gain` is -5, but must be positive", ""),
    ("adaptation_gain = [20, 5]", "adaptation_gain = 0",
        "test.toml:16:19: `adaptation_gain` is 0, but must be positive", ""),
    ("adaptation_gain = [20, 5]", "adaptation_gain = { bandwidth_per_s = 2 }",
        "test.toml:16:19: found a table where a number, or a list of numbers should stand", ""),
    ("estimate_start.scaled = 0.5", "estimate_start.given = [1]",
        "test.toml:17:24: `estimate_start.given` has 1 entry, but `chain-1` needs 2", ""),
    ("estimate_start.scaled = 0.5", "estimate_start.half = true",
        "test.toml:17:16: unknown choice `half`", "choose one of `zero`, `true`, `scaled`, `given`"),
    ("[\"d2x*sin(x)\", \"d2x*dx\"]", "[\"d2x*sin(x)\"]",
        "test.toml:18:19: `antiderivatives` has 1 entry, but `chain-1` needs 2", ""),
    ("[\"d2x*sin(x)\", \"d2x*dx\"]", "[\"d2x*sin(x)\", \"d2x\"]",
        "test.toml:18:34: agent `chain-1`: the antiderivative of regressor 2 has the slope 1 in the highest derivative where the regressor is 0.7703296142690075", "leave `antiderivatives` out for regressors without the highest derivative"),
    ("[\"d2x*sin(x)\", \"d2x*dx\"]", "[\"d2x*sin(x)\", \"d3x\"]",
        "test.toml:18:35: there is no `d3x` in this formula", "did you mean `d2x`? there are `x`, `dx`, `d2x`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("floor = 1e-2", "floor = 0",
        "test.toml:19:9: `floor` is 0, but must be positive", ""),
    ("floor = 1e-2", "flor = 1",
        "test.toml:19:1: unknown key `flor`", "did you mean `floor`? allowed here: `gain_per_s`, `adaptation_gain`, `estimate_start`, `bounds`, `antiderivatives`, `floor`"),
    ("[law.immersion]\ngain_per_s = 3\nadaptation_gain = [20, 5]\nestimate_start.scaled = 0.5\nantiderivatives = [\"d2x*sin(x)\", \"d2x*dx\"]\nfloor = 1e-2", "[law.linearising]\ngain_per_s = -1",
        "test.toml:15:14: `gain_per_s` is -1, but must be positive", ""),
    ("[law.immersion]\ngain_per_s = 3\nadaptation_gain = [20, 5]\nestimate_start.scaled = 0.5\nantiderivatives = [\"d2x*sin(x)\", \"d2x*dx\"]\nfloor = 1e-2", "[law.linearising]\nadaptation_gain = 1",
        "test.toml:15:1: unknown key `adaptation_gain`", "allowed here: `gain_per_s`, `floor`"),
    ("[law.immersion]\ngain_per_s = 3\nadaptation_gain = [20, 5]\nestimate_start.scaled = 0.5\nantiderivatives = [\"d2x*sin(x)\", \"d2x*dx\"]\nfloor = 1e-2", "[law.linear_adaptive]\ngain_per_s = inf",
        "test.toml:15:14: inf is not a finite number", ""),
    ("[law.immersion]\ngain_per_s = 3\nadaptation_gain = [20, 5]\nestimate_start.scaled = 0.5\nantiderivatives = [\"d2x*sin(x)\", \"d2x*dx\"]\nfloor = 1e-2", "[law.linear_adaptive]\nadaptation_gain = [1]",
        "test.toml:15:19: `adaptation_gain` has 1 entry, but `chain-1` needs 2", ""),
    ("[law.immersion]\ngain_per_s = 3\nadaptation_gain = [20, 5]\nestimate_start.scaled = 0.5\nantiderivatives = [\"d2x*sin(x)\", \"d2x*dx\"]\nfloor = 1e-2", "[law.linear_adaptive]\nfloor = -1",
        "test.toml:15:9: `floor` is -1, but must be positive", ""),
    ("[law.immersion]\ngain_per_s = 3\nadaptation_gain = [20, 5]\nestimate_start.scaled = 0.5\nantiderivatives = [\"d2x*sin(x)\", \"d2x*dx\"]\nfloor = 1e-2", "[law.adaptive_backstepping]",
        "test.toml:14:2: agent `chain-1`: the law `adaptive_backstepping` is made for `strict_feedback` and `pure_feedback`, chains with unknown parameters in every equation", "for this robot there is `linearising`, `linear_adaptive` and `immersion`"),
    ("[law.immersion]\ngain_per_s = 3\nadaptation_gain = [20, 5]\nestimate_start.scaled = 0.5\nantiderivatives = [\"d2x*sin(x)\", \"d2x*dx\"]\nfloor = 1e-2", "[law.adaptive]",
        "test.toml:14:2: agent `chain-1`: the law `adaptive` is made for arms and point masses", "for this robot there is `linearising`, `linear_adaptive` and `immersion`"),
    ("[law.immersion]\ngain_per_s = 3\nadaptation_gain = [20, 5]\nestimate_start.scaled = 0.5\nantiderivatives = [\"d2x*sin(x)\", \"d2x*dx\"]\nfloor = 1e-2", "[law.position_only]",
        "test.toml:14:2: agent `chain-1`: the law `position_only` is made for point masses without damping and friction, of which it knows no velocity to compensate them at", "for this robot there is `linearising`, `linear_adaptive` and `immersion`"),
    ("coupling.saturated = 0.4", "coupling.saturated = 0",
        "test.toml:22:22: `saturated` is 0, but must be positive", ""),
    ("coupling.saturated = 0.4", "coupling.tanh = -1",
        "test.toml:22:17: `tanh` is -1, but must be positive", ""),
    ("coupling.saturated = 0.4", "coupling.rational = \"soft\"",
        "test.toml:22:21: found \"soft\" where a number should stand", ""),
    ("coupling.saturated = 0.4", "coupling.saturate = 0.4",
        "test.toml:22:10: unknown choice `saturate`", "did you mean `saturated`? choose one of `saturated`, `tanh`, `rational`"),
    ("coupling.saturated = 0.4", "coupling = \"saturated\"",
        "test.toml:22:12: `saturated` needs a value", "write it with its value: { saturated = … }"),
    ("coupling.saturated = 0.4", "coupling = { saturated = 0.4, tanh = 1 }",
        "test.toml:22:31: both `saturated` and `tanh` are given, but only one can be", ""),
    ("coupling.saturated = 0.4", "coupling = 0.4",
        "test.toml:22:12: found 0.4 where a choice of saturated, tanh, rational should stand", "say which it is, behind the key and a dot, such as `.saturated = 0.4`"),
    ("count = 2", "count = 2\ntarget.formulas = [\"t\"]",
        "test.toml:7:1: agent `chain-1`: immersion and invariance knows no offsets", "leave its `target` out; only vehicles and rotorcraft agree up to offsets"),
    ("count = 2", "count = 2\nenforce_limits = true",
        "test.toml:7:18: `enforce_limits` is true, but axis `x` of `chain-1` has no effort limit", "only a URDF states limits, as <limit effort=\"…\"> of a joint"),
    ("[network]", "[[external_wrenches]]\non = [\"chain-1\"]\nby.force_n = [1]\n[network]",
        "test.toml:23:14: `force_n` does not act on `chain-1`", "what acts on it is `disturbance`"),
    ("[network]", "[control]\nsample_hz = 100\ntorque_limit = [1, 1]\n[network]",
        "test.toml:23:16: agent `chain-1`: the limit of torques has 2 entries where 1 are needed", "a single number stands for all axes"),
];

/// A chain in strict-feedback form and one in pure-feedback form.
pub(super) const CASCADES: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "strict"
robot.strict_feedback = { regressors = [["x1^2", "0"], ["x1*x2", "sin(x2)"]], parameters = [0.5, -0.8] }
start = { position_m = [1], higher_states = [0.2] }

[[agents]]
name = "pure"
robot.pure_feedback = { known = ["x2 + 0.2*x2^3", "0"], regressors = [["x1^2", "0"], ["tanh(x2)", "x1*x2"]], psi = "2 + sin(x1)", parameters = [0.4, -0.3] }

[reference.consensus]
roots_per_s = [1, 2]
exchange = "position"

[law.adaptive_backstepping]
gains_per_s = [1, 2]
adaptation_gain = 1
estimate_start = "zero"
floor = 1e-3

[network]
edges.ring = {}

[goal]
disagreement_below = 1e-3
"#;

#[rustfmt::skip]
const CASCADES_CASES: &[Case] = &[
    ("[[\"x1^2\", \"0\"], [\"x1*x2\", \"sin(x2)\"]]", "[[\"x1^2\", \"0\"], [\"x1*x2\"]]",
        "test.toml:6:56: `regressors` has 1 entry, but `equation 2` needs 2", ""),
    ("[[\"x1^2\", \"0\"], [\"x1*x2\", \"sin(x2)\"]]", "[[\"x2\", \"0\"], [\"x1*x2\", \"sin(x2)\"]]",
        "test.toml:6:41: equation 1 of the chain uses x2, but may use no state beyond x1", ""),
    ("[[\"x1^2\", \"0\"], [\"x1*x2\", \"sin(x2)\"]]", "[[\"x1^2\", \"0\"], [\"x1*x3\", \"sin(x2)\"]]",
        "test.toml:6:61: there is no `x3` in this formula", "did you mean `x1`? there are `x1`, `x2`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("[[\"x1^2\", \"0\"], [\"x1*x2\", \"sin(x2)\"]]", "[[\"abs(x1)\", \"0\"], [\"x1*x2\", \"sin(x2)\"]]",
        "test.toml:6:1: agent `strict`: a derivative is needed, but abs has none everywhere; use a smooth function such as tanh", ""),
    ("[[\"x1^2\", \"0\"], [\"x1*x2\", \"sin(x2)\"]]", "[]",
        "test.toml:6:40: `regressors` is empty", ""),
    ("[[\"x1^2\", \"0\"], [\"x1*x2\", \"sin(x2)\"]]", "[\"x1\", \"x2\"]",
        "test.toml:6:41: found \"x1\" where a list should stand", ""),
    ("[[\"x1^2\", \"0\"], [\"x1*x2\", \"sin(x2)\"]]", "[[0], [0]]",
        "test.toml:6:42: found 0 where a text in quotes should stand", ""),
    ("parameters = [0.5, -0.8]", "parameters = [0.5]",
        "test.toml:6:92: `parameters` has 1 entry, but `regressor` needs 2", ""),
    ("parameters = [0.5, -0.8]", "params = [0.5, -0.8]",
        "test.toml:6:79: unknown key `params`", "did you mean `parameters`? allowed here: `regressors`, `parameters`"),
    ("robot.strict_feedback", "robot.strict_feedbak",
        "test.toml:6:7: unknown choice `strict_feedbak`", "did you mean `strict_feedback`? choose one of `urdf`, `planar_arm`, `point_mass`, `ship`, `vehicle`, `rotorcraft`, `spacecraft`, `chain`, `vector_chain`, `strict_feedback`, `pure_feedback`"),
    ("higher_states = [0.2]", "higher_states = [0.2, 0]",
        "test.toml:7:45: `higher_states` has 2 entries, but `strict` needs 1", ""),
    ("higher_states = [0.2]", "velocity_m_s = [0.2]",
        "test.toml:7:44: `velocity_m_s` says nothing about `strict`", "chains of order one or in feedback form have `higher_states`, spacecraft `angular_velocity_rad_s`"),
    ("known = [\"x2 + 0.2*x2^3\", \"0\"]", "known = [\"x2 + 0.2*x2^3\"]",
        "test.toml:11:33: `known` has 1 entry, but `regressors` needs 2", ""),
    ("known = [\"x2 + 0.2*x2^3\", \"0\"]", "known = [\"x2 + 0.2*x3^3\", \"0\"]",
        "test.toml:11:44: there is no `x3` in this formula", "did you mean `x1`? there are `x1`, `x2`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("known = [\"x2 + 0.2*x2^3\", \"0\"]", "known = [\"x2 +\", \"0\"]",
        "test.toml:11:39: found its end in a formula where a number, a variable, a function or a parenthesis should stand", ""),
    ("known = [\"x2 + 0.2*x2^3\", \"0\"], ", "",
        "test.toml:11:23: the key `known` is missing", ""),
    ("known = [\"x2 + 0.2*x2^3\", \"0\"]", "knwon = [\"x2\", \"0\"]",
        "test.toml:11:25: unknown key `knwon`", "did you mean `known`? allowed here: `known`, `regressors`, `psi`, `parameters`"),
    ("psi = \"2 + sin(x1)\"", "psi = \"2 + sin(u)\"",
        "test.toml:11:125: there is no `u` in this formula", "did you mean `e`? there are `x1`, `x2`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("psi = \"2 + sin(x1)\"", "psi = 2",
        "test.toml:11:116: found 2 where a text in quotes should stand", ""),
    ("psi = \"2 + sin(x1)\"", "phi = \"2\"",
        "test.toml:11:110: unknown key `phi`", "did you mean `psi`? allowed here: `known`, `regressors`, `psi`, `parameters`"),
    ("roots_per_s = [1, 2]\n", "",
        "test.toml:13:2: `strict` has no `roots_per_s`", "add `roots_per_s` to [reference.consensus], or `reference.consensus.roots_per_s` to the agent"),
    ("exchange = \"position\"", "exchange = \"position_velocity\"",
        "test.toml:15:12: agent `strict`: adaptive backstepping sends its position only, but the agents exchange positions and velocities", "write `exchange = \"position\"`"),
    ("gains_per_s = [1, 2]", "gains_per_s = [1, 2, 3]",
        "test.toml:18:15: `gains_per_s` has 3 entries, but `strict` needs 2", ""),
    ("gains_per_s = [1, 2]", "gains_per_s = [1, 0]",
        "test.toml:18:19: `gains_per_s` is 0, but must be positive", ""),
    ("gains_per_s = [1, 2]", "gains_per_s = -1",
        "test.toml:18:15: `gains_per_s` is -1, but must be positive", ""),
    ("gains_per_s = [1, 2]", "gain_per_s = 1",
        "test.toml:18:1: unknown key `gain_per_s`", "did you mean `gains_per_s`? allowed here: `gains_per_s`, `adaptation_gain`, `estimate_start`, `bounds`, `floor`"),
    ("adaptation_gain = 1", "adaptation_gain = [1, 2, 3]",
        "test.toml:19:19: `adaptation_gain` has 3 entries, but `strict` needs 2", ""),
    ("adaptation_gain = 1", "adaptation_gain = inf",
        "test.toml:19:19: inf is not a finite number", ""),
    ("estimate_start = \"zero\"", "estimate_start = \"ones\"",
        "test.toml:20:18: unknown choice `ones`", "choose one of `zero`, `true`, `scaled`, `given`"),
    ("floor = 1e-3", "floor = -1e-3",
        "test.toml:21:9: `floor` is -0.001, but must be positive", ""),
    ("[law.adaptive_backstepping]\ngains_per_s = [1, 2]\nadaptation_gain = 1\nestimate_start = \"zero\"\nfloor = 1e-3", "[law.linearising]",
        "test.toml:17:2: agent `strict`: the law `linearising` is made for `chain` and `vector_chain`, plants of derivatives", "for this robot there is `adaptive_backstepping`"),
    ("[law.adaptive_backstepping]\ngains_per_s = [1, 2]\nadaptation_gain = 1\nestimate_start = \"zero\"\nfloor = 1e-3", "[law.immersion]",
        "test.toml:17:2: agent `strict`: the law `immersion` is made for `chain`, plants of derivatives", "for this robot there is `adaptive_backstepping`"),
];

#[test]
fn mistakes_about_plants_of_derivatives_are_reported_at_their_place() {
    refused(DERIVATIVES, DERIVATIVES_CASES);
}

#[test]
fn mistakes_about_chains_in_feedback_form_are_reported_at_their_place() {
    refused(CASCADES, CASCADES_CASES);
}
