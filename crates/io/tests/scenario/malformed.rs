//! One mistake at a time: where it is reported, what is said, and what help is offered.

use miette::Diagnostic;

use super::{Case, SOUND, changed, read, refused};

#[rustfmt::skip]
pub(super) const CASES: &[Case] = &[
    // The text.
    ("[time]", "[time",
        "test.toml:4:6: not valid TOML: unclosed table, expected `]`", ""),
    ("format = 2", "format = ",
        "test.toml:1:10: not valid TOML: string values must be quoted, expected literal string", ""),
    ("title = \"test\"", "title = \"test\"\ntitle = \"again\"",
        "test.toml:3:1: not valid TOML: duplicate key", ""),
    ("format = 2", "format = 1",
        "test.toml:1:10: `format` is 1, but this version reads format 2", "`forwardstep upgrade test.toml` converts it"),
    ("format = 2", "format = 3",
        "test.toml:1:10: `format` is 3, but this version reads format 2", "use a later version of forwardstep"),
    ("format = 2", "format = -1",
        "test.toml:1:10: `format` is -1, but this version reads format 2", ""),
    ("format = 2\n", "",
        "test.toml: the key `format` is missing", "write `format = 2`"),
    ("format = 2", "format = \"1\"",
        "test.toml:1:10: found \"1\" where a whole number should stand", "write 1"),
    ("title = \"test\"", "title = 7",
        "test.toml:2:9: found 7 where a text in quotes should stand", ""),
    ("end_s = 10", "ends_s = 10",
        "test.toml:5:1: unknown key `ends_s`", "did you mean `end_s`?"),
    ("[goal]", "[gaol]",
        "test.toml:37:2: unknown key `gaol`", "did you mean `goal`?"),
    ("weight = 1.0", "obstacles = []",
        "test.toml:28:1: unknown key `obstacles`", "not modelled (see Limits in the README, and What is not modelled in the book): robots pass through each other, and there are no obstacles. Nearest: a `target` keeps vehicles and rotorcraft apart"),
    ("end_s = 10\n", "",
        "test.toml:4:1: the key `end_s` is missing", "`end_s = 10`"),
    ("end_s = 10", "end_s = \"ten\"",
        "test.toml:5:9: found \"ten\" where a number should stand", ""),
    ("end_s = 10", "end_s = 2026-01-01",
        "test.toml:5:9: found the date 2026-01-01 where a number should stand", ""),
    ("end_s = 10", "end_s = nan",
        "test.toml:5:9: nan is not a finite number", ""),
    ("end_s = 10", "end_s = -inf",
        "test.toml:5:9: -inf is not a finite number", ""),
    ("end_s = 10", "end_s = 1e999",
        "test.toml:5:9: 1e999 is too large a number", "numbers may be up to 1e30 in size, whole numbers up to 9e18"),
    ("end_s = 10", "end_s = 99999999999999999999",
        "test.toml:5:9: 99999999999999999999 is too large a number", "numbers may be up to 1e30 in size, whole numbers up to 9e18"),
    ("end_s = 10", "end_s = 2e30",
        "test.toml:5:9: 2e30 is too large a number", "numbers may be up to 1e30 in size, whole numbers up to 9e18"),
    ("end_s = 10", "end_s = 1e-300",
        "test.toml:5:9: `end_s` is 1e-300, but must be from 1e-30 to 1e30", ""),
    ("title = \"test\"", "title = \"two\\nlines\"",
        "test.toml:2:9: the text \"two\\nlines\" does not fit into a line", "names, choices and titles are one line of at most 500 bytes without control characters"),
    ("[\"arm-2\", \"cart\"]", "[\"arm-2\", \"\\u001b[31m\"]",
        "test.toml:35:20: the text \"\\u{1b}[31m\" does not fit into a line", "control characters"),
    ("weight = 1.0", "\"\\u202e\" = 1.0",
        "test.toml:28:1: the text \"\\u{202e}\" does not fit into a line", "control characters"),
    ("weight = 1.0", "weight = \"1 + \\u001b[31m\"",
        "test.toml:28:10: the formula \"1 + \\u{1b}[31m\" cannot be read", "at most 10000 bytes, over as many lines as it needs"),
    ("weight = 1.0", "weight = \"\"\"\n1 +\n foo\"\"\"",
        "test.toml:30:2: there is no `foo` in a formula", "t"),
    ("weight = 1.0", "formation = 1",
        "test.toml:28:1: unknown key `formation`", "vehicles and rotorcraft keep a formation by a `target`"),
    // Time.
    ("end_s = 10", "end_s = 0",
        "test.toml:5:9: `end_s` is 0, but must be positive", ""),
    ("end_s = 10", "end_s = -3.5",
        "test.toml:5:9: `end_s` is -3.5, but must be positive", ""),
    ("record_every_s = 0.1", "record_every_s = 0",
        "test.toml:6:18: `record_every_s` is 0, but must be positive", ""),
    ("record_every_s = 0.1", "record_every_s = \"often\"",
        "test.toml:6:18: found \"often\" where a number should stand", ""),
    // Agents.
    ("name = \"cart\"", "name = \"arm-2\"",
        "test.toml:15:8: a second agent is named `arm-2`; the first is on line 9", "agents of a counted population are named after it: `arm` with `count = 2` gives `arm-1` and `arm-2`"),
    ("name = \"cart\"", "name = \"cart.left\"",
        "test.toml:15:8: \"cart.left\" cannot be the name of an agent", "use up to 64 letters, digits, `-` and `_`"),
    ("name = \"cart\"", "name = \"a_name_of_more_than_sixty-four_letters_which_no_column_of_a_table_needs\"",
        "test.toml:15:8: \"a_name_of_more_than_sixty-four_letters_which_no_column_of_a_table_needs\" cannot be the name of an agent", "use up to 64 letters"),
    ("name = \"cart\"", "nme = \"cart\"",
        "test.toml:15:1: unknown key `nme`", "did you mean `name`?"),
    ("count = 2", "count = 0",
        "test.toml:10:9: `count` is 0, but must be from 1 to 200000", ""),
    ("count = 2", "count = 1_000_000_000",
        "test.toml:10:9: `count` is 1e9, but must be from 1 to 200000", ""),
    ("count = 2", "count = 2.5",
        "test.toml:10:9: found 2.5 where a whole number should stand", ""),
    ("robot.point_mass =", "robot.point_mas =",
        "test.toml:16:7: unknown choice `point_mas`", "did you mean `point_mass`?"),
    ("robot.point_mass = { dimension = 2, mass_kg = 4.0 }", "robot = {}",
        "test.toml:16:9: nothing is chosen here", "choose one of `urdf`, `planar_arm`, `point_mass`"),
    ("robot.point_mass = { dimension = 2, mass_kg = 4.0 }", "robot = \"point_mass\"",
        "test.toml:16:9: `point_mass` needs a value", "write it with its value"),
    ("robot.point_mass = { dimension = 2, mass_kg = 4.0 }", "robot = 3",
        "test.toml:16:9: found 3 where a choice of urdf, planar_arm, point_mass, ship, vehicle, rotorcraft, spacecraft, chain, vector_chain, strict_feedback, pure_feedback should stand", "say which it is, behind the key and a dot, such as `.urdf = …`"),
    ("dimension = 2", "dimension = 3",
        "test.toml:16:1: `arm-1` has 2 axes and `cart` has 3, but all agents of a scenario need as many", "references, the network and goals are of one vector of axes; `locked` removes joints of a URDF"),
    ("dimension = 2", "dimension = -2",
        "test.toml:16:34: `dimension` is -2, but must be from 1 to 100", ""),
    ("mass_kg = 4.0", "mass_kg = -4.0",
        "test.toml:16:47: `mass_kg` is -4, but must be positive", ""),
    ("mass_kg = [2.0, 1.5]", "mass_kg = [2.0, 0]",
        "test.toml:11:38: `mass_kg` is 0, but must be positive", ""),
    ("mass_kg = [2.0, 1.5]", "mass_kg = [2.0]",
        "test.toml:11:32: found a list of 1 where 2 are needed", ""),
    ("mass_kg = [2.0, 1.5]", "mass_kg = 2.0",
        "test.toml:11:32: found 2.0 where a list should stand", ""),
    ("length_m = [1.0, 0.8]", "length_m = [1.0, 0.8], com_m = [0.5, 0], inertia_kg_m2 = [0.1, 0]",
        "test.toml:11:1: the mass matrix of this arm is not positive definite: its second link resists no torque", "give the second link inertia, or a centre of mass off its joint"),
    ("robot.point_mass = { dimension = 2, mass_kg = 4.0 }", "robot.urdf = { file = \"ur6e.urdf\" }",
        "test.toml:16:23: cannot read the robot file `ur6e.urdf`: there is no such file", "did you mean `ur5e.urdf`?"),
    ("robot.point_mass = { dimension = 2, mass_kg = 4.0 }", "robot.urdf = { file = \"ur5e.urdf\" }",
        "test.toml:16:1: `arm-1` has 2 axes and `cart` has 6, but all agents of a scenario need as many", "references, the network and goals are of one vector of axes; `locked` removes joints of a URDF"),
    ("robot.point_mass = { dimension = 2, mass_kg = 4.0 }", "robot.urdf = { file = \"ur5e.urdf\", locked = { wrist_4_joint = 0 } }",
        "test.toml:16:47: cannot lock `wrist_4_joint`: there is no such joint", "did you mean `wrist_1_joint`?"),
    ("robot.point_mass = { dimension = 2, mass_kg = 4.0 }", "robot.urdf = { file = \"ur5e.urdf\", locked = { wrist_3_joint = \"up\" } }",
        "test.toml:16:63: found \"up\" where a number should stand", ""),
    ("count = 2", "count = 2\nenforce_limits = true",
        "test.toml:11:18: `enforce_limits` is true, but axis `shoulder` of `arm-1` has no effort limit", "only a URDF states limits, as <limit effort=\"…\"> of a joint"),
    // Start.
    ("[[0.1, 0.2], [0.3, 0.4]]", "[0.1, 0.2, 0.3]",
        "test.toml:12:22: `position_rad` has 3 entries, but `arm-1` needs 2", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "[[0.1, 0.2], [0.3, 0.4, 0.5]]",
        "test.toml:12:35: `position_rad` has 3 entries, but `arm-2` needs 2", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "[[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]]",
        "test.toml:12:22: `position_rad` has 3 lists, but there are 2 agents", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "[[0.1, 0.2], 0.3]",
        "test.toml:12:22: `position_rad` mixes numbers and lists", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "0.1",
        "test.toml:12:22: found 0.1 where a list of numbers, one such list per agent, or { random = { seed = …, within = [low, high] } } should stand", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "{ random = { seed = 1, within = [1, -1] } }",
        "test.toml:12:54: `within` is [1, -1], but the first must not exceed the second", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "{ random = { seed = 1, within = [[0, 1], [2, 1]] } }",
        "test.toml:12:54: `within` is [2, 1], but the first must not exceed the second", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "{ random = { seed = 1, within = [[0, 1], [1, 2], [2, 3]] } }",
        "test.toml:12:54: `within` has 3 entries, but `arm-1` needs 2", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "{ random = { seed = 1, within = [[0, 1], 2] } }",
        "test.toml:12:54: found a list where [low, high], or one such pair per axis should stand", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "{ random = { seed = -1, within = [-1, 1] } }",
        "test.toml:12:42: `seed` is -1, but must not be negative", ""),
    ("[[0.1, 0.2], [0.3, 0.4]]", "{ radnom = { seed = 1, within = [-1, 1] } }",
        "test.toml:12:24: unknown key `radnom`", "did you mean `random`?"),
    ("start.position_rad", "start.position_m",
        "test.toml:12:20: `position_m` does not fit `arm-1`, whose axis `shoulder` is measured in rad", "`position` takes rad or m as each axis has it"),
    ("start.position_rad", "start.position = [0, 0]\nstart.position_rad",
        "test.toml:12:18: both `position_rad` and `position` are given, but they say the same", ""),
    ("start.position_rad", "start.reference = { derivatives = [[1, 2], [3, 4]] }\nstart.position_rad",
        "test.toml:12:44: `derivatives` has 2 entries, but the reference of `arm-1` is of order 2", "an order of l has the derivatives 1 to l − 1"),
    // Spread.
    ("count = 2", "count = 2\nparameter_variation = 0.2",
        "test.toml:11:23: found 0.2 where a table of seed, relative should stand", ""),
    ("count = 2", "count = 2\nparameter_variation = { seed = 1, relativ = 0.2 }",
        "test.toml:11:35: unknown key `relativ`", "did you mean `relative`?"),
    ("count = 2", "count = 2\nparameter_variation = { seed = 1 }",
        "test.toml:11:23: the key `relative` is missing", ""),
    ("count = 2", "count = 2\nparameter_variation = { seed = -1, relative = 0.2 }",
        "test.toml:11:32: `seed` is -1, but must not be negative", ""),
    ("count = 2", "count = 2\nparameter_variation = { seed = 1, relative = 20 }",
        "test.toml:11:46: `relative` is 20, but must be from 0 to 0.9", ""),
    ("name = \"cart\"", "name = \"cart\"\nparameter_variation = { seed = 1, relative = 0.2 }",
        "test.toml:16:23: `parameter_variation` is given, but there is no `count`", "a population of `count = 1` may have a spread, too"),
    // Reference.
    ("[1.0, 2.0]", "[1.0, -2.0]",
        "test.toml:19:21: `roots_per_s` is -2, but must be positive", ""),
    ("[1.0, 2.0]", "[1.0, 0]",
        "test.toml:19:21: `roots_per_s` is 0, but must be positive", ""),
    ("[1.0, 2.0]", "[]",
        "test.toml:19:15: `roots_per_s` is empty", ""),
    ("[1.0, 2.0]", "[1.0, { real = -0.1, imaginary = 2 }]",
        "test.toml:19:30: `real` is -0.1, but must be positive", ""),
    ("[1.0, 2.0]", "[{ real = 0.1, imaginary = 0 }]",
        "test.toml:19:42: `imaginary` is 0, but must be positive", ""),
    ("[1.0, 2.0]", "[{ real = 0.1, imaginary = 2 }, -1]",
        "test.toml:19:47: `roots_per_s` is -1, but must be positive", ""),
    ("[1.0, 2.0]", "[{ real = 0.1 }]",
        "test.toml:19:16: the key `imaginary` is missing", ""),
    ("[1.0, 2.0]", "[\"fast\"]",
        "test.toml:19:16: found \"fast\" where a number, or a pair of complex roots { real = …, imaginary = … } should stand", ""),
    ("[1.0, 2.0]", "[{ real = 0.1, imaginary = 2 }]",
        "test.toml:19:15: agent `arm-1`: all roots are complex, but (a5), which sends velocities, needs a real one: κ₀, the first real root", "add a real root, or write `exchange = \"position\"`"),
    ("roots_per_s = [1.0, 2.0]\n", "",
        "test.toml:18:2: `arm-1` has no `roots_per_s`", "add `roots_per_s` to [reference.consensus], or `reference.consensus.roots_per_s` to the agent"),
    ("\"position_velocity\"", "\"velocity\"",
        "test.toml:20:12: unknown choice `velocity`", "choose one of `position_velocity`, `position`"),
    ("exchange = \"position_velocity\"\n", "",
        "test.toml:18:1: the key `exchange` is missing", ""),
    // Law.
    ("damping.gain = 8", "damping.gain = -8",
        "test.toml:23:16: `damping.gain` is -8, but must be positive", ""),
    ("damping.gain = 8", "damping.gain = [8, -8]",
        "test.toml:23:20: `damping.gain` is -8, but must be positive", ""),
    ("damping.gain = 8", "damping.gain = [8, 8, 8]",
        "test.toml:23:16: `damping.gain` has 3 entries, but `arm-1` needs 2", ""),
    ("damping.gain = 8", "damping.gain = [[8, 1], [2, 8]]",
        "test.toml:23:16: `damping.gain` of `arm-1`: entries (0, 1) and (1, 0) differ: 1 and 2; the matrix must be symmetric", ""),
    ("damping.gain = 8", "damping.gain = [[1, 2], [2, 1]]",
        "test.toml:23:16: `damping.gain` of `arm-1`: the matrix is not positive definite: vᵀ A v = -3 for v = (-2, 1)", ""),
    ("damping.gain = 8", "damping.gain = [[1, 2], [2]]",
        "test.toml:23:25: `damping.gain` has 2 rows, but row 2 has 1 entry", ""),
    ("damping.gain = 8", "damping.gain = \"strong\"",
        "test.toml:23:16: found \"strong\" where a number, a list (the diagonal) or a list of rows should stand", ""),
    ("damping.gain = 8", "damping.gain = 8\ndamping.bandwidth_per_s = 20",
        "test.toml:24:9: both `gain` and `bandwidth_per_s` are given, but only one can be", ""),
    ("damping.gain = 8", "damping.bandwidth = 20",
        "test.toml:23:9: unknown choice `bandwidth`", "did you mean `bandwidth_per_s`?"),
    ("damping.gain = 8", "damping.bandwidth_per_s = 0",
        "test.toml:23:27: `damping.bandwidth_per_s` is 0, but must be positive", ""),
    ("adaptation_gain = 10", "adaptation_gain = [1, 2, 3]",
        "test.toml:24:19: `adaptation_gain` has 3 entries, but `arm-1` needs 5", ""),
    ("adaptation_gain = 10", "adaptation_gain = { bandwidth_per_s = -1 }",
        "test.toml:24:39: `adaptation_gain.bandwidth_per_s` is -1, but must be positive", ""),
    ("estimate_start = \"zero\"", "estimate_start = \"zeros\"",
        "test.toml:25:18: unknown choice `zeros`", "did you mean `zero`?"),
    ("estimate_start = \"zero\"", "estimate_start = \"scaled\"",
        "test.toml:25:18: `scaled` needs a value", "write it with its value"),
    ("estimate_start = \"zero\"", "estimate_start = { zero = 1 }",
        "test.toml:25:20: `zero` takes no value", "write it as a text: \"zero\""),
    ("estimate_start = \"zero\"", "estimate_start.given = [1, 2]",
        "test.toml:25:24: `estimate_start.given` has 2 entries, but `arm-1` needs 5", ""),
    // Network.
    ("weight = 1.0", "weight = 0",
        "test.toml:28:10: `weight` is 0, but must be positive", ""),
    ("[\"arm-2\", \"cart\"]", "{ from = \"arm-2\", to = \"cart\", weight = -1 }",
        "test.toml:35:50: `weight` is -1, but must be positive", ""),
    ("[\"arm-2\", \"cart\"]", "{ from = \"arm-2\", too = \"cart\" }",
        "test.toml:35:28: unknown key `too`", "did you mean `to`?"),
    ("[\"arm-2\", \"cart\"]", "{ from = \"arm-2\" }",
        "test.toml:35:10: the key `to` is missing", ""),
    ("[\"arm-2\", \"cart\"]", "[\"arm-2\", \"cat\"]",
        "test.toml:35:20: there is no agent `cat`", "did you mean `cart`?"),
    ("[\"arm-2\", \"cart\"]", "[\"arm-2\"]",
        "test.toml:35:10: found a list of 1 where an edge, [\"from\", \"to\"] or { from = \"…\", to = \"…\" } should stand", ""),
    ("[\"arm-2\", \"cart\"]", "[\"arm-2\", 3]",
        "test.toml:35:20: found 3 where a text in quotes should stand", ""),
    ("[\"arm-2\", \"cart\"]", "\"arm-2\"",
        "test.toml:35:10: found \"arm-2\" where an edge, [\"from\", \"to\"] or { from = \"…\", to = \"…\" } should stand", ""),
    ("[\"arm-2\", \"cart\"]", "[\"cart\", \"cart\"]",
        "test.toml:35:10: `cart` cannot hear itself", ""),
    ("[\"arm-2\", \"cart\"]", "[\"cart\", \"arm-1\"]",
        "test.toml:35:29: a second edge from `cart` to `arm-1` in one graph; the first is on line 35", ""),
    ("weight = 1.0", "edges = []",
        "test.toml:30:1: `edges` and `phases` are both given, but a network is either fixed or switches", "move the edges into a phase, or delete the phases"),
    ("weight = 1.0", "switching = \"twice\"",
        "test.toml:28:13: unknown choice `twice`", "choose one of `repeat`, `once`, `random`"),
    ("weight = 1.0", "switching.random = { seed = 1, dwell_s = [2, 1] }",
        "test.toml:28:43: `dwell_s` is 2, but must not exceed the longest, which is 1", ""),
    ("weight = 1.0", "switching.random = { seed = 1, dwell_s = [0, 1] }",
        "test.toml:28:43: `dwell_s` is 0, but must be positive", ""),
    ("dwell_s = 1.0", "dwell_s = -1.0",
        "test.toml:31:11: `dwell_s` is -1, but must be positive", ""),
    ("dwell_s = 1.0", "dwell_s = 0",
        "test.toml:31:11: `dwell_s` is 0, but must be positive", ""),
    ("dwell_s = 2.0\n", "",
        "test.toml:33:1: phase 2 has no `dwell_s`", "only the last phase of a network that switches \"once\" needs none, and random switching"),
    ("dwell_s = 1.0\nedges = [[\"arm-1\", \"arm-2\"]]", "dwell_s = 1.0",
        "test.toml:30:1: the key `edges` is missing", ""),
    // Edges by rule.
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges = 3",
        "test.toml:32:9: found 3 where a list of edges or a table of ring, path, star, complete, random or csv should stand", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges = \"ring\"",
        "test.toml:32:9: found \"ring\" where a list of edges or a table of ring, path, star, complete, random or csv should stand", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges = {}",
        "test.toml:32:9: nothing is chosen here", "choose one of `ring`, `path`, `star`, `complete`, `random`, `csv`"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.rign = {}",
        "test.toml:32:7: unknown choice `rign`", "did you mean `ring`?"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges = { ring = {}, path = {} }",
        "test.toml:32:22: both `ring` and `path` are given, but only one can be", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.ring = 1",
        "test.toml:32:14: found 1 where a table of direction, among, weight, delay should stand", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.ring.direction = \"back\"",
        "test.toml:32:24: unknown choice `back`", "choose one of `forward`, `both`"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.path.wieght = 2",
        "test.toml:32:12: unknown key `wieght`", "did you mean `weight`?"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.path.weight = 0",
        "test.toml:32:21: `weight` is 0, but must be positive", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.complete.delay.constant_s = -1",
        "test.toml:32:35: `constant_s` is -1, but must not be negative", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.complete.delay = 1",
        "test.toml:32:24: found 1 where a choice of constant_s, sinusoid, piecewise_constant, saw_tooth, formula_s, random_hold, packets, log, hold_log should stand", "say which it is, behind the key and a dot, such as `.constant_s = 1`"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.ring.among = []",
        "test.toml:32:20: `among` is empty", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.ring.among = [\"arm-1\", \"amr-2\"]",
        "test.toml:32:30: there is no agent `amr-2`", "did you mean `arm-2`?"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.ring.among = [\"arm-1\", \"cart\", \"arm-1\"]",
        "test.toml:32:38: `arm-1` is named twice in `among`", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.star = {}",
        "test.toml:32:14: the key `centre` is missing", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.star.centre = \"card\"",
        "test.toml:32:21: there is no agent `card`", "did you mean `cart`?"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.star = { centre = \"cart\", direction = \"forward\" }",
        "test.toml:32:45: unknown choice `forward`", "choose one of `out`, `in`, `both`"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.random = { in_degree = 3, seed = 1 }",
        "test.toml:32:30: every agent is to hear 3 others, but there are only 2", "an agent hears no other twice, and never itself"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.random = { in_degree = 2, seed = 1, among = [\"arm-1\", \"cart\"] }",
        "test.toml:32:30: every agent is to hear 2 others, but there are only 1", "an agent hears no other twice, and never itself"),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.random = { in_degree = 0, seed = 1 }",
        "test.toml:32:30: `in_degree` is 0, but must be positive", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.random = { in_degree = 1.5, seed = 1 }",
        "test.toml:32:30: found 1.5 where a whole number should stand", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.random = { in_degree = 1 }",
        "test.toml:32:16: the key `seed` is missing", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.random = { in_degree = 1, seed = -1 }",
        "test.toml:32:40: `seed` is -1, but must not be negative", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.csv = \"edges.csv\"",
        "test.toml:32:13: found \"edges.csv\" where a table of file should stand", ""),
    ("edges = [[\"arm-1\", \"arm-2\"]]", "edges.csv.file = \"edges.csv\"",
        "test.toml:32:18: cannot read the table `edges.csv`: there is no such file", ""),
    // Delays.
    ("delay.saw_tooth = {", "delay.sawtooth = {",
        "test.toml:29:7: unknown choice `sawtooth`", "did you mean `saw_tooth`?"),
    ("min_s = 0.1", "min_s = 0.5",
        "test.toml:29:29: `min_s` is 0.5, but must not exceed `max_s`, which is 0.4", ""),
    ("min_s = 0.1", "min_s = -0.1",
        "test.toml:29:29: `min_s` is -0.1, but must not be negative", ""),
    ("period_s = 0.6", "period_s = 0",
        "test.toml:29:58: `period_s` is 0, but must be positive", ""),
    ("period_s = 0.6", "period_s = 1e-9",
        "test.toml:29:58: about 1e10 jumps of the delay until the end of the run, but at most 1e7 are accepted", "is a unit of time mistaken? All of them are seconds"),
    ("delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }", "delay.constant_s = -0.1",
        "test.toml:29:20: `constant_s` is -0.1, but must not be negative", ""),
    ("delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }", "delay = 0.1",
        "test.toml:29:9: found 0.1 where a choice of constant_s, sinusoid, piecewise_constant, saw_tooth, formula_s, random_hold, packets, log, hold_log should stand", "say which it is, behind the key and a dot, such as `.constant_s = 0.1`"),
    ("delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }", "delay.sinusoid = { mean_s = 0.1, amplitude_s = 0.2, period_s = 1 }",
        "test.toml:29:48: `amplitude_s` is 0.2, but must not exceed `mean_s`, which is 0.1", "a delay is never negative"),
    ("delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }", "delay.piecewise_constant = { times_s = [0, 2, 1], values_s = [0, 1, 2] }",
        "test.toml:29:47: `times_s` is 1, but must exceed the one before, which is 2", ""),
    ("delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }", "delay.piecewise_constant = { times_s = [1, 2], values_s = [0, 1] }",
        "test.toml:29:41: `times_s` is 1, but must begin at 0", ""),
    ("delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }", "delay.piecewise_constant = { times_s = [0, 2], values_s = [0] }",
        "test.toml:29:59: `values_s` has 1 entry, but `times_s` has 2 entries", ""),
    ("delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }", "delay.piecewise_constant = { times_s = [0, 2], values_s = [0, -1] }",
        "test.toml:29:63: `values_s` is -1, but must not be negative", ""),
    ("delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }", "delay.piecewise_constant = { times_s = [0, 2], values_s = [0, 1], period_s = 2 }",
        "test.toml:29:78: `period_s` is 2, but must exceed the last time, which is 2", ""),
    // Solver and goal.
    ("[goal]", "[solver]\nmethod.adaptive = { rtol = 0 }\n[goal]",
        "test.toml:38:28: `rtol` is 0, but must be from 1e-14 to 0.1", ""),
    ("[goal]", "[solver]\nmethod.fixed = { step_s = -1 }\n[goal]",
        "test.toml:38:27: `step_s` is -1, but must be positive", ""),
    ("[goal]", "[solver]\nmethod = \"euler\"\n[goal]",
        "test.toml:38:10: unknown choice `euler`", "choose one of `adaptive`, `fixed`"),
    ("[goal]", "[solver]\nmethod.fixed.step_s = 1e-20\n[goal]",
        "test.toml:38:23: `step_s` is 1e-20, but must not be less than `min_step_s`, which is 1e-12", ""),
    ("[goal]", "[solver]\nmin_step_s = 1e-3\nmax_step_s = 1e-5\n[goal]",
        "test.toml:39:14: `max_step_s` is 1e-5, but must not be less than `min_step_s`, which is 0.001", ""),
    ("[goal]", "[solver]\nmax_step_s = 0\n[goal]",
        "test.toml:38:14: `max_step_s` is 0, but must be positive", ""),
    ("[goal]", "[solver]\nmemory_budget_bytes = 0\n[goal]",
        "test.toml:38:23: `memory_budget_bytes` is 0, but must be positive", ""),
    ("[goal]", "[solver]\nmemory_budget_bytes = -5\n[goal]",
        "test.toml:38:23: `memory_budget_bytes` is -5, but must be positive", ""),
    ("[goal]", "[solver]\nmemory_budget_bytes = 1e9\n[goal]",
        "test.toml:38:23: found 1e9 where a whole number should stand", "write 1000000000"),
    ("[goal]", "[solver]\nmemory_budget_bytes = 100\n[goal]",
        "test.toml:38:23: messages that can still be heard take 1008 bytes or more, but the memory budget is 100 bytes",
        "write `memory_budget_bytes = 1008` or more in `[solver]`, sample more slowly, or shorten the longest delay"),
    ("disagreement_below = 1e-3", "disagreement_below = -1",
        "test.toml:38:22: `disagreement_below` is -1, but must be positive", ""),
    ("disagreement_below = 1e-3", "disagreement_below = 1\nexpect = \"diverges\"",
        "test.toml:38:22: `disagreement_below` says nothing about agents that diverge", "delete one of the two"),
    ("disagreement_below = 1e-3", "",
        "test.toml:37:1: the goal says nothing about the disagreement", "set `disagreement_below = 1e-3` (with targets `error_below`), or `expect = \"diverges\"`, or delete the goal"),
    ("disagreement_below = 1e-3", "disagreement_below = true",
        "test.toml:38:22: found true where a number should stand", ""),
];

#[test]
fn a_table_in_single_brackets_is_told_from_a_list_of_them() {
    let text = "format = 2\n[time]\nend_s = 1\n[agents]\nname = \"arm\"\n";
    let error = read(text).unwrap_err();
    assert_eq!(error.to_string(), "test.toml:4:1: found a table where a list should stand");
    assert!(error.help().unwrap().to_string().contains("[[agents]]"));
}

/// As the program prints it.
fn printed(text: &str) -> String {
    let (error, mut shown) = (read(text).unwrap_err(), String::new());
    miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor())
        .render_report(&mut shown, &error)
        .unwrap();
    shown
}

#[test]
fn regress_what_a_run_would_record_is_asked_of_runs_alone() {
    let refused = |text: &str| {
        let error = read(text).unwrap().check_recording().unwrap_err();
        (error.to_string(), error.help().unwrap().to_string())
    };
    let (said, help) = refused(&changed("record_every_s = 0.1", "record_every_s = 1e-9"));
    let numbers = "the recording would hold 5.3e11 numbers, 1e10 rows of 53 columns, but at most 1e8 fit";
    assert_eq!(said, format!("test.toml:6:18: {numbers}"));
    assert_eq!(help, "for this `end_s` let `record_every_s` be at least 5.6e-6");
    // Where nothing says how often rows are recorded, it is the end of the run that asks for too much.
    let (said, _) = refused(&changed("end_s = 10\nrecord_every_s = 0.1\n", "end_s = 1e6\n"));
    assert!(said.starts_with("test.toml:5:9: the recording would hold"), "{said}");
    read(SOUND).unwrap().check_recording().unwrap();
}

#[test]
fn a_message_is_short_however_long_the_line() {
    let long = "x".repeat(1_000_000);
    let lists = "[".repeat(100_000);
    for (to, place) in [
        (format!("weight = [\"{long}\"]"), "28:10"),
        (format!("\"{long}\" = 1"), "28:1"),
        (format!("weight = \"{long}\""), "28:10"),
        (format!("weight = {lists}"), "28:"),
        (format!("switching = \"once\" # {long}\nweigth = 1"), "29:1"),
        (format!("# {long}\nweigth = 1 # {long}"), "29:1"),
    ] {
        let shown = printed(&changed("weight = 1.0", &to));
        assert!(shown.len() < 2_500, "{} bytes", shown.len());
        assert!(shown.contains(&format!("[test.toml:{place}")), "{shown}");
    }
    // The part around a place far to the right, with the place marked.
    let edges = " ".repeat(2000) + "[\"arm-1\", \"cärt\"]";
    let shown = printed(&changed("[\"arm-2\", \"cart\"]", &edges));
    let lines: Vec<&str> = shown.lines().collect();
    let at = lines.iter().position(|line| line.contains("cärt\"]")).unwrap();
    let column = |line: &str, what: char| line.chars().position(|c| c == what).unwrap();
    assert!(
        column(lines[at + 1], '─') < column(lines[at], 'ä') && column(lines[at], 'ä') < lines[at + 1].chars().count()
    );
}

#[test]
fn nothing_in_a_file_steers_the_terminal() {
    for to in ["title = \u{1b}[31m", "[[agen\r\r", "\u{9b}31m = 1", "# \u{202e}\ntitle = 7", "\0", "title = \"\u{7f}"] {
        let shown = printed(&changed("title = \"test\"", to));
        assert!(!shown.contains(|c: char| c.is_control() && c != '\n' || c == '\u{202e}'), "{shown:?}");
    }
}

#[test]
fn regress_lines_may_end_as_on_other_systems() {
    let long = printed(&changed("end_s = 10", &format!("end_s = {}ten", " ".repeat(500))).replace('\n', "\r\n"));
    assert!(long.contains("\n 5 │") && !long.contains('\r'), "{long:?}");
    let shown = printed(&changed("end_s = 10", "end_s = ten").replace('\n', "\r\n"));
    assert!(shown.contains("│ end_s = ten\n") && !shown.contains('\r'), "{shown:?}");
}

#[test]
fn every_mistake_is_reported_at_its_place() {
    refused(SOUND, CASES);
}
