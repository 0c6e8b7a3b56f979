//! The hypotheses that exist: one row each.

use crate::source::Source;

/// Makes the enumeration and its columns out of the rows, so that no row can lack one.
macro_rules! table {
    ($($(#[$doc:meta])* $id:ident, $name:literal, $place:literal, $source:expr, $requires:literal, $breaks:literal;)*) => {
        /// Which hypothesis. The names are stable: certificates, waivers and summaries refer to them.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Id {
            $(
                #[doc = concat!("`", $name, "`: ", $requires, ".")]
                $(#[$doc])*
                $id,
            )*
        }

        impl Id {
            /// All of them, in the order of the table.
            pub const ALL: &[Id] = &[$(Id::$id),*];

            /// The stable name, in kebab case.
            pub fn name(self) -> &'static str {
                match self { $(Id::$id => $name,)* }
            }

            /// Where the paper asks for it: a theorem, an equation, a section.
            pub fn place(self) -> &'static str {
                match self { $(Id::$id => $place,)* }
            }

            /// Whose hypothesis it is.
            pub fn source(self) -> Source {
                match self { $(Id::$id => $source,)* }
            }

            /// What is required, with `…` in the place of what it is required of, see [`super::Subject`].
            pub(crate) fn sentence(self) -> &'static str {
                match self { $(Id::$id => $requires,)* }
            }

            /// What would break it, and what follows then.
            pub fn broken_by(self) -> &'static str {
                match self { $(Id::$id => $breaks,)* }
            }
        }
    };
}

table! {
    // The network.
    SpanningTree, "spanning-tree", "Theorems 1 to 5", Source::Paper,
        "the union of the graphs over uniformly bounded windows contains a directed spanning tree",
        "groups that from some time on hear no agent outside themselves: each then agrees for itself";
    LeaderReachesAll, "leader-reaches-all", "Theorems 8 and 9", Source::Paper,
        "the leader reaches everybody: the graph contains a directed spanning tree rooted at it",
        "an agent that nothing of the leader reaches any more: it then follows those alone that it hears, if any";
    LeaderInEveryGraph, "leader-in-every-graph", "own derivation", Source::Derived,
        "the leader reaches everybody in each of the graphs that take turns",
        "a graph in which nothing of the leader reaches some: with the sign they draw others away meanwhile, and an error stays";
    DwellTime, "dwell-time", "Section II-A", Source::Paper,
        "graphs stay for at least some positive dwell time",
        "switches that follow each other ever faster, without a shortest phase; how short that is does not matter";
    FixedGraph, "fixed-graph", "Theorems 1, 8 and 9, Remark 3", Source::Paper,
        "the graph is fixed",
        "a link that comes, goes or changes its weight: the torque then jumps, or what is integrated is no longer the design";
    MutualWeights, "mutual-weights", "own derivation", Source::Derived,
        "agents hear each other with the same weight",
        "a link that leads one way only, or back with another weight: their coupling then has no energy function, which the argument uses";
    BoundedDelays, "bounded-delays", "Section III-A", Source::Paper,
        "delays are piecewise uniformly continuous and uniformly bounded",
        "a delay that grows for ever, such as T = t, or a link that loses every packet; no bounded delay does, however long or abrupt";
    NoDelay, "no-delay", "Theorems 8 and 9", Source::Paper,
        "messages arrive without delay",
        "messages that are late: who follows a moving leader then lags behind, and the sign acts on old data";
    MessagesInTime, "messages-in-time", "own derivation", Source::Derived,
        "no message becomes older than the time-out, so that graphs are those that are stated",
        "a message later than the time-out: its link then counts as lost, and the graph is another";
    BoundedWeights, "bounded-weights", "own derivation", Source::Derived,
        "weights are piecewise uniformly continuous, bounded, and bounded away from zero while their edge is there",
        "a weight that fades to zero, so that its link is lost in the end, or one that grows without end, and the torque with it";
    ConstantWeights, "constant-weights", "Theorem 9, Remark 12", Source::Paper,
        "weights are constant",
        "a weight that changes: the integral then keeps what the old one left in it, and the error can grow (`forwardstep attack 119-weights`)";
    CouplingSector, "coupling-sector", "own derivation", Source::Derived,
        "the coupling is odd and continuous, grows, and keeps within the sector (0, 1]",
        "a coupling that grows faster than its argument, or draws to one side more than to the other: averages then overshoot, or drift";

    // Reference dynamics.
    RealRoots, "real-roots", "(25)", Source::Paper,
        "the polynomial (25) is Hurwitz with real roots",
        "complex roots: the disagreement can then grow where graphs take turns (`forwardstep attack 24-complex-roots`)";
    Hurwitz, "hurwitz", "(a9), (43), Theorem 9", Source::Paper,
        "the polynomial of what follows a target or a leader is Hurwitz",
        "a root without a negative real part: what there is of an error then stays, or grows";
    CommonOrder, "common-order", "Theorem 3", Source::Paper,
        "all agents have reference dynamics of the same order",
        "reference dynamics of several orders: Theorem 3 does not speak about them, and the hypothesis `own-orders` takes its place";
    OwnOrders, "own-orders", "own derivation", Source::Derived,
        "every agent has reference dynamics of some order; the argument of Theorem 3 does not need the same for all",
        "an agent without reference dynamics of its own";
    CommonFirstRoot, "common-first-root", "Theorem 3", Source::Corrected("E1"),
        "κ₀ is common within each strongly connected component of the union graph, unless graph and delays are constant",
        "another κ₀ for one agent of a cycle while graphs or delays vary: what comes back to it is then no average, and the \
         disagreement can grow (`forwardstep attack a1-first-roots`)";
    MeasuredDerivative, "measured-derivative", "(aa6)", Source::Paper,
        "what is heard has a derivative that can be measured",
        "a switch, or a delay that jumps: what is heard then has no finite derivative";
    DesiredDesign, "desired-design", "(43), Section IV-B", Source::Derived,
        "the desired dynamics are a design of the paper",
        "other coefficients: the desired dynamics are then no design of the paper, and have to be judged by themselves";
    DesiredDynamics, "desired-dynamics", "(43), Section IV-B", Source::Paper,
        "the desired dynamics do without s what they are for",
        "desired dynamics that fail by themselves: a law can bring no more than they do without s";
    Manipulability, "manipulability", "Remark 4", Source::Paper,
        "the manipulability gain λ of Remark 4 is positive",
        "a gain λ that is negative; with zero there is nothing that Remark 4 adds";

    // Robots.
    UniformInertia, "uniform-inertia", "Property 1", Source::Paper,
        "the inertia matrix M(q) is symmetric and uniformly positive definite",
        "a robot, or a moving link of one, without mass or inertia: M(q) then becomes singular in some posture";
    BoundedDynamics, "bounded-dynamics", "proofs of Theorems 1, 6 and 8", Source::Paper,
        "C(q, q̇) and g(q) are bounded independent of q",
        "a robot with a sliding joint askew to the axes that carry it: C(q, q̇) and g(q) can then grow with its travel, and that s vanishes is not shown";

    // The loop around a law.
    PositiveGains, "positive-gains", "(6), (7)", Source::Paper,
        "K and Γ are symmetric positive definite",
        "a K or a Γ with an eigenvalue that is not positive: V then need not fall, and s need not vanish";
    PushesEnd, "pushes-end", "own derivation", Source::Derived,
        "external torques, forces and disturbances end or fade, so that s is square-integrable all the same",
        "a push that never ends: s then stays, and agents as far apart as the push holds them";
    AppliedTorque, "applied-torque", "(6)", Source::Paper,
        "the torque that the law asks for is applied",
        "a limit that cuts off what the law asks for: V can rise meanwhile";
    ContinuousTime, "continuous-time", "Section II", Source::Paper,
        "the controllers work in continuous time",
        "controllers that work at sampling times: the paper does not speak about them, and the sampling margin says how long a period may be";
    ExactMeasurements, "exact-measurements", "Section II", Source::Paper,
        "q and q̇ are measured",
        "noise, encoders, or velocities from differences: s then stays, as large as the power balance allows";
    OneKind, "one-kind", "Theorems 2 to 5", Source::Paper,
        "all agents are of the kind that one theorem speaks about",
        "a robot of another kind in the same network, about which another theorem speaks";

    // Targets and leaders.
    BoundedTarget, "bounded-target", "Sections V-A and V-C", Source::Paper,
        "… are bounded",
        "a target without a bound: what the law asks for then has none either";
    BoundedLeader, "bounded-leader", "Section V-D", Source::Paper,
        "the velocity, acceleration and jerk of the leader are bounded",
        "a leader whose velocity, acceleration or jerk grows for ever: no constant γ exceeds what drives it for all time";
    SignGain, "sign-gain", "(113), Theorem 9", Source::Paper,
        "γ exceeds the largest entry of |…| at any time",
        "a leader that is driven away harder than γ: those who follow it then fall behind";
    SetValuedSign, "set-valued-sign", "(110), (119), (122)", Source::Paper,
        "the sign is the set-valued sgn",
        "a sign that is sampled or smoothed: an error then stays, in proportion to the period or the width";
    SharedDesign, "shared-design", "(110), (119), (122)", Source::Paper,
        "all agents share α, β and γ",
        "an α, a β or a γ of one agent alone: the errors of all are then not solutions of one equation";
    PrintedDesign, "printed-design", "Remark 11", Source::Paper,
        "the paper prints the design",
        "a variation that the paper does not print, about which its theorem says nothing";
    SwarmCoupling, "swarm-coupling", "own derivation", Source::Derived,
        "k λ > β + κ₀⁴/(2 (β² − α) κ₁), λ the smallest eigenvalue of the followers' Laplacian",
        "a smaller k, or followers that are coupled less: what their references do to each other can then outweigh the coupling";

    // Laws of Sections IV and V.
    DefinedTerms, "defined-terms", "(33)", Source::Paper,
        "χ, ψ and the regressors have a value, and bounded slopes on bounded sets, in every state",
        "a state in which a term has a pole or no value: a run stops there";
    InputFactor, "input-factor", "(33), (43)", Source::Derived,
        "the factor of the input stays away from zero",
        "a state in which the factor of the input is zero: the input then moves nothing";
    ChainGains, "chain-gains", "(43)", Source::Paper,
        "the gains are positive",
        "a gain that is zero or negative: the error of its equation then stays, or grows";
    ChainAdaptation, "chain-adaptation", "Section IV", Source::Derived,
        "the gains of the laws and Γ are positive",
        "a gain or a Γ that is not positive: V then need not fall";
    BoundedRegressors, "bounded-regressors", "own derivation", Source::Derived,
        "regressors and their derivatives are bounded along the run",
        "regressors that grow along the run: s is still square-integrable, and need not vanish";
    MatchedDisturbance, "matched-disturbance", "own derivation", Source::Derived,
        "what disturbs a chain in feedback form enters where the input does, and the chain is strict-feedback",
        "a disturbance that enters elsewhere than the input: no input then takes it back at once";
    PositionOnlyGains, "position-only-gains", "(a8), Remark 7", Source::Corrected("E9, E10"),
        "k, λ_f and γ* are positive",
        "a k, λ_f or γ* that is zero or negative: V then need not fall";
    ModelReferenceGains, "model-reference-gains", "own derivation", Source::Derived,
        "λ_f and γ* are positive",
        "a λ_f or γ* that is zero or negative: V then need not fall";
    KnownMasses, "known-masses", "(45)", Source::Paper,
        "the masses are known",
        "a wrong mass: the thrust then carries too much or too little, and vehicles drift";
    ThrustGains, "thrust-gains", "Theorems 4 and 5", Source::Paper,
        "α*, k and γ* are positive, and a mass that is not adapted is known",
        "an α*, k or γ* that is not positive, or a wrong mass that is not adapted: V then need not fall";
    NonzeroThrust, "nonzero-thrust", "(45)", Source::Paper,
        "no thrust comes to zero",
        "a vehicle that should fall freely: its thrust is then zero and has no direction, and a run stops there";
    UnbiasedAcceleration, "unbiased-acceleration", "own derivation", Source::Derived,
        "accelerometers give the acceleration",
        "an accelerometer with a bias: the vehicles then drift";
    AngularVelocity, "angular-velocity", "(44)", Source::Paper,
        "the angular velocity is the one that the law asks for",
        "an airframe that turns later than it is asked to: the thrust meanwhile points elsewhere";
    EveryWrench, "every-wrench", "own derivation", Source::Derived,
        "every thrust and torque that is asked for can be produced",
        "a manoeuvre for which rotors or thrusters are too weak, or would have to push backwards";
    Declared, "declared", "declared by its author", Source::Declared,
        "what the author says of … is so",
        "a property that is declared and false";
    TaskSpaceGains, "task-space-gains", "Theorem 6", Source::Paper,
        "K*, K, Γ and Λ are symmetric positive definite, κ and α are positive",
        "a gain that is not positive definite, or a κ or an α that is not positive: V then need not fall";
    RegularJacobian, "regular-jacobian", "Theorem 6", Source::Paper,
        "the estimated Jacobian of … stays away from singularity",
        "a posture in which the estimated Jacobian loses its rank: joints would then have to move without bound, and a run stops there";
    TargetWithinReach, "target-within-reach", "own derivation", Source::Derived,
        "the target of … keeps within the reach of its end-effector, where alone the Jacobian can stay regular",
        "a target farther away, or nearer, than the end-effector can come";
    CertainRegressor, "certain-regressor", "own derivation", Source::Derived,
        "the regressor of … depends on nothing uncertain",
        "a length that is uncertain, and enters the regressor";
    ParametersWithinBounds, "parameters-within-bounds", "own derivation", Source::Derived,
        "the true parameters lie within the bounds of their estimates",
        "a true parameter outside of the bounds: its estimate is then held away from it, and V can rise";
    SmoothFriction, "smooth-friction", "own derivation", Source::Derived,
        "friction at the joints is a smooth function of their velocities",
        "dry friction: robots then stick wherever it can hold them, and an error stays";
    LengthsWithinBounds, "lengths-within-bounds", "own derivation", Source::Derived,
        "the true lengths of … lie within the bounds of their estimates",
        "a true length outside of the bounds: its estimate is then held away from it, and V can rise";
    AttitudeGains, "attitude-gains", "Theorem 7", Source::Paper,
        "K and Λ_f are symmetric positive definite, α₁ and α₂ are positive",
        "a K or a Λ_f that is not positive definite, or an α that is not positive: V then need not fall";
    KnownMomentum, "known-momentum", "Theorem 7", Source::Paper,
        "the inertia of … and its angular momentum h_I are known and constant",
        "an inertia or an angular momentum that is wrong or changes: the law then counters a torque that is not there";
    PassivityFilterGains, "passivity-filter-gains", "own derivation", Source::Derived,
        "K and Λ_f are symmetric positive definite, k is positive",
        "a K or a Λ_f that is not positive definite, or a k that is not positive: V then need not fall";
    TargetAtRest, "target-at-rest", "own derivation", Source::Derived,
        "the target of … keeps still, or its moments of inertia are equal",
        "a target that turns, for a body whose moments of inertia differ: an error then stays";
    StartAttitude, "start-attitude", "own derivation", Source::Derived,
        "the start of … is not half a turn from the attitude of its target",
        "a start half a turn from the target: the error then gives no direction of rotation";
    NonzeroQuaternion, "nonzero-quaternion", "own derivation", Source::Derived,
        "the quaternion that … is to follow is never zero",
        "a quaternion that becomes zero, which is no attitude";
}
