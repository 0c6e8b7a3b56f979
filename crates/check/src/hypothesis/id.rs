//! The hypotheses that exist: one row each.

use crate::source::Source;

/// Makes the enumeration and its columns out of the rows, so that no row can lack one.
macro_rules! table {
    ($($(#[$doc:meta])* $id:ident, $name:literal, $place:literal, $source:expr, $requires:literal;)*) => {
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
        }
    };
}

table! {
    // The network.
    SpanningTree, "spanning-tree", "Theorems 1 to 5", Source::Paper,
        "the union of the graphs over uniformly bounded windows contains a directed spanning tree";
    LeaderReachesAll, "leader-reaches-all", "Theorems 8 and 9", Source::Paper,
        "the leader reaches everybody: the graph contains a directed spanning tree rooted at it";
    LeaderInEveryGraph, "leader-in-every-graph", "own derivation", Source::Derived,
        "the leader reaches everybody in each of the graphs that take turns";
    DwellTime, "dwell-time", "Section II-A", Source::Paper,
        "graphs stay for at least some positive dwell time";
    FixedGraph, "fixed-graph", "Theorems 1, 8 and 9, Remark 3", Source::Paper,
        "the graph is fixed";
    MutualWeights, "mutual-weights", "own derivation", Source::Derived,
        "agents hear each other with the same weight";
    BoundedDelays, "bounded-delays", "Section III-A", Source::Paper,
        "delays are piecewise uniformly continuous and uniformly bounded";
    NoDelay, "no-delay", "Theorems 8 and 9", Source::Paper,
        "messages arrive without delay";
    MessagesInTime, "messages-in-time", "own derivation", Source::Derived,
        "no message becomes older than the time-out, so that graphs are those that are stated";
    BoundedWeights, "bounded-weights", "own derivation", Source::Derived,
        "weights are piecewise uniformly continuous, bounded, and bounded away from zero while their edge is there";
    ConstantWeights, "constant-weights", "Theorem 9, Remark 12", Source::Paper,
        "weights are constant";
    CouplingSector, "coupling-sector", "own derivation", Source::Derived,
        "the coupling is odd and continuous, grows, and keeps within the sector (0, 1]";

    // Reference dynamics.
    RealRoots, "real-roots", "(25)", Source::Paper,
        "the polynomial (25) is Hurwitz with real roots";
    Hurwitz, "hurwitz", "(a9), (43), Theorem 9", Source::Paper,
        "the polynomial of what follows a target or a leader is Hurwitz";
    CommonOrder, "common-order", "Theorem 3", Source::Paper,
        "all agents have reference dynamics of the same order";
    OwnOrders, "own-orders", "own derivation", Source::Derived,
        "every agent has reference dynamics of some order; the argument of Theorem 3 does not need the same for all";
    CommonFirstRoot, "common-first-root", "Theorem 3", Source::Corrected("E1"),
        "κ₀ is common within each strongly connected component of the union graph, unless graph and delays are constant";
    MeasuredDerivative, "measured-derivative", "(aa6)", Source::Paper,
        "what is heard has a derivative that can be measured";
    DesiredDesign, "desired-design", "(43), Section IV-B", Source::Derived,
        "the desired dynamics are a design of the paper";
    DesiredDynamics, "desired-dynamics", "(43), Section IV-B", Source::Paper,
        "the desired dynamics do without s what they are for";
    Manipulability, "manipulability", "Remark 4", Source::Paper,
        "the manipulability gain λ of Remark 4 is positive";

    // Robots.
    UniformInertia, "uniform-inertia", "Property 1", Source::Paper,
        "the inertia matrix M(q) is symmetric and uniformly positive definite";
    BoundedDynamics, "bounded-dynamics", "proofs of Theorems 1, 6 and 8", Source::Paper,
        "C(q, q̇) and g(q) are bounded independent of q";

    // The loop around a law.
    PositiveGains, "positive-gains", "(6), (7)", Source::Paper,
        "K and Γ are symmetric positive definite";
    PushesEnd, "pushes-end", "own derivation", Source::Derived,
        "external torques, forces and disturbances end, so that s is square-integrable all the same";
    AppliedTorque, "applied-torque", "(6)", Source::Paper,
        "the torque that the law asks for is applied";
    ContinuousTime, "continuous-time", "Section II", Source::Paper,
        "the controllers work in continuous time";
    ExactMeasurements, "exact-measurements", "Section II", Source::Paper,
        "q and q̇ are measured";
    OneKind, "one-kind", "Theorems 2 to 5", Source::Paper,
        "all agents are of the kind that one theorem speaks about";

    // Targets and leaders.
    BoundedTarget, "bounded-target", "Sections V-A and V-C", Source::Paper,
        "… are bounded";
    BoundedLeader, "bounded-leader", "Section V-D", Source::Paper,
        "the velocity, acceleration and jerk of the leader are bounded";
    SignGain, "sign-gain", "(113), Theorem 9", Source::Paper,
        "γ exceeds the largest entry of |…| at any time";
    SetValuedSign, "set-valued-sign", "(110), (119), (122)", Source::Paper,
        "the sign is the set-valued sgn";
    SharedDesign, "shared-design", "(110), (119), (122)", Source::Paper,
        "all agents share α, β and γ";
    PrintedDesign, "printed-design", "Remark 11", Source::Paper,
        "the paper prints the design";
    SwarmCoupling, "swarm-coupling", "own derivation", Source::Derived,
        "k λ > β + κ₀⁴/(2 (β² − α) κ₁), λ the smallest eigenvalue of the followers' Laplacian";

    // Laws of Sections IV and V.
    DefinedTerms, "defined-terms", "(33)", Source::Paper,
        "χ, ψ and the regressors have a value, and bounded slopes on bounded sets, in every state";
    InputFactor, "input-factor", "(33), (43)", Source::Derived,
        "the factor of the input stays away from zero";
    ChainGains, "chain-gains", "(43)", Source::Paper,
        "the gains are positive";
    ChainAdaptation, "chain-adaptation", "Section IV", Source::Derived,
        "the gains of the laws and Γ are positive";
    BoundedRegressors, "bounded-regressors", "own derivation", Source::Derived,
        "regressors and their derivatives are bounded along the run";
    MatchedDisturbance, "matched-disturbance", "own derivation", Source::Derived,
        "what disturbs a chain in feedback form enters where the input does, and the chain is strict-feedback";
    PositionOnlyGains, "position-only-gains", "(a8), Remark 7", Source::Corrected("E9, E10"),
        "k, λ_f and γ* are positive";
    KnownMasses, "known-masses", "(45)", Source::Paper,
        "the masses are known";
    ThrustGains, "thrust-gains", "Theorems 4 and 5", Source::Paper,
        "α*, k and γ* are positive, and a mass that is not adapted is known";
    NonzeroThrust, "nonzero-thrust", "(45)", Source::Paper,
        "no thrust comes to zero";
    UnbiasedAcceleration, "unbiased-acceleration", "own derivation", Source::Derived,
        "accelerometers give the acceleration";
    AngularVelocity, "angular-velocity", "(44)", Source::Paper,
        "the angular velocity is the one that the law asks for";
    EveryWrench, "every-wrench", "own derivation", Source::Derived,
        "every thrust and every torque can be had";
    Declared, "declared", "declared by its author", Source::Declared,
        "what the author says of … is so";
    TaskSpaceGains, "task-space-gains", "Theorem 6", Source::Paper,
        "K*, K, Γ and Λ are symmetric positive definite, κ and α are positive";
    RegularJacobian, "regular-jacobian", "Theorem 6", Source::Paper,
        "the estimated Jacobian of … stays away from singularity";
    TargetWithinReach, "target-within-reach", "own derivation", Source::Derived,
        "the target of … keeps within the reach of its tip, where alone the Jacobian can stay regular";
    CertainRegressor, "certain-regressor", "own derivation", Source::Derived,
        "the regressor of … depends on nothing uncertain";
    ParametersWithinBounds, "parameters-within-bounds", "own derivation", Source::Derived,
        "the true parameters lie within the bounds of their estimates";
    SmoothFriction, "smooth-friction", "own derivation", Source::Derived,
        "friction at the joints is a smooth function of their velocities";
    LengthsWithinBounds, "lengths-within-bounds", "own derivation", Source::Derived,
        "the true lengths of … lie within the bounds of their estimates";
    AttitudeGains, "attitude-gains", "Theorem 7", Source::Paper,
        "K and Λ_f are symmetric positive definite, α₁ and α₂ are positive";
    KnownMomentum, "known-momentum", "Theorem 7", Source::Paper,
        "the inertia of … and its angular momentum h_I are known and constant";
    PassivityFilterGains, "passivity-filter-gains", "own derivation", Source::Derived,
        "K and Λ_f are symmetric positive definite, k is positive";
    TargetAtRest, "target-at-rest", "own derivation", Source::Derived,
        "the target of … keeps still, or its moments of inertia are equal";
    StartAttitude, "start-attitude", "own derivation", Source::Derived,
        "the start of … is not half a turn from the attitude of its target";
    NonzeroQuaternion, "nonzero-quaternion", "own derivation", Source::Derived,
        "the quaternion that … is to follow is never zero";
}
