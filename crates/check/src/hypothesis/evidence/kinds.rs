//! Evidence of a kind of system and its law.

use forwardstep_core::expression::Gap;
use forwardstep_core::robot::tree::Uncertain;
use forwardstep_sim::ThrustKind;
use forwardstep_sim::probe::Probe;

use crate::hypothesis::{Answer, Named, Rigour};

/// What was found of systems and their laws.
#[derive(Clone, Debug, PartialEq)]
pub enum KindEvidence {
    /// Positive numbers, refused otherwise when they were read.
    PositiveNumbers,
    /// Positive numbers; a mass that is not adapted is the true one.
    PositiveNumbersTrueMass,
    /// Matrices that are positive definite in exact arithmetic and positive numbers, refused otherwise when they were read.
    PositiveMatrices,
    /// What the theorems say of agents of different kinds: where each of them is treated.
    Mixture(Vec<&'static str>),
    /// What the author of a law says of it.
    Declared {
        /// What is required.
        requires: String,
        /// Why it should be so.
        because: String,
    },
    /// What is said of a robot or of a law, and was tried at random states.
    Probed {
        /// What is required.
        requires: String,
        /// Where it was tried, and where it failed.
        probe: Probe,
    },
    /// The law has the mass of the plant.
    MassOfPlant,
    /// An estimate that is neither adapted nor true.
    MassNotAdapted {
        /// Whose.
        agent: Named,
    },
    /// A run ends where a thrust falls to its floor.
    ThrustFloor {
        /// The lowest of the floors, N.
        least_n: f64,
    },
    /// A saturation keeps a thrust above a floor.
    ThrustKept {
        /// Whose.
        agent: Named,
        /// The floor, N.
        floor_n: f64,
    },
    /// An offset that can be kept only with a thrust below its floor, again and again.
    FallsFreely {
        /// Whose.
        agent: Named,
        /// When, s.
        t_s: f64,
        /// The thrust that keeps it then, N.
        thrust_n: f64,
        /// The floor, N.
        floor_n: f64,
    },
    /// Accelerometers give ẍ as it is.
    AccelerationUnbiased,
    /// One gives too much.
    AccelerationBiased {
        /// Whose.
        agent: Named,
        /// Between which speeds vehicles that all do so rise together for ever, m/s; nothing where the vertical has no bias.
        drift_m_s: Option<[f64; 2]>,
    },
    /// Torques turn a body into the angular velocity asked for.
    AngularRate {
        /// Whose is the slowest.
        agent: Named,
        /// Its bandwidth, 1/s.
        bandwidth_per_s: f64,
        /// The law, which tells whether the rate is foreseen.
        design: ThrustKind,
    },
    /// Rotors have limits.
    Rotors {
        /// Whose.
        agent: Named,
        /// Of the thrust of each, N.
        thrust_n: [f64; 2],
    },
    /// The factor of the input is a constant that is not zero.
    ConstantFactor,
    /// Enclosures keep the factor of the input away from zero in every state.
    FactorAway {
        /// It is nowhere smaller in magnitude.
        least: f64,
        /// Whether a factor is a matrix, whose magnitude is its smallest singular value.
        matrix: bool,
    },
    /// The terms of chains have a value in every state.
    TermsDefined,
    /// A term has no value somewhere.
    TermFails {
        /// Whose.
        agent: Named,
        /// Which.
        term: Term,
        /// In which state, but for rounding.
        at: Vec<f64>,
        /// Why.
        gap: Gap,
    },
    /// Whether a term has a value in every state could not be told.
    TermNotShown {
        /// Whose.
        agent: Named,
        /// Which.
        term: Term,
    },
    /// A term of a chain that has a value everywhere, of which more derivatives are taken than its powers are shown to bear.
    TermNotSmooth {
        /// Whose.
        agent: Named,
        /// What it is.
        term: Term,
        /// How many are taken.
        derivatives: usize,
    },
    /// The factor of the input is a constant below its floor.
    FactorBelowFloor {
        /// Whose.
        agent: Named,
        /// Its value.
        value: f64,
        /// Its floor.
        floor: f64,
    },
    /// A thrust starts at its floor or below.
    ThrustAtStart {
        /// Whose.
        agent: Named,
        /// The thrust, N.
        thrust_n: f64,
        /// Its floor, N.
        floor_n: f64,
    },
    /// What a law divides by is below its floor where the run begins: the factor of the input, the smallest singular value of a matrix, or a
    /// product of slopes.
    FactorAtStart {
        /// Whose.
        agent: Named,
        /// Its value.
        value: f64,
        /// Its floor.
        floor: f64,
    },
    /// An equation of a chain is not moved by its next state.
    Unmoved {
        /// Whose.
        agent: Named,
        /// Which, from zero.
        equation: usize,
    },
    /// The factor of the input is a constant matrix without an inverse.
    FactorSingular {
        /// Whose.
        agent: Named,
    },
    /// A run ends where the factor of the input comes close to zero.
    FactorFloor {
        /// Whose.
        agent: Named,
        /// How close.
        floor: f64,
        /// What is known of it for all states.
        everywhere: FactorEverywhere,
        /// Whether it is a matrix, whose magnitude is its smallest singular value.
        matrix: bool,
    },
    /// A run that is completed keeps states, and with them regressors, bounded.
    BoundedStates {
        /// One of those that need it.
        agent: Named,
    },
    /// det Ĵ at the start; a run ends where it falls below a part of that.
    Determinant {
        /// Its value.
        start: f64,
        /// The part.
        floor: f64,
    },
    /// The smallest singular value of Ĵ at the start; a run ends where it falls below a part of that.
    SingularValue {
        /// Its value.
        start: f64,
        /// The part.
        floor: f64,
    },
    /// Ĵ has not full rank at the start.
    RankDeficient {
        /// The smallest singular value.
        smallest: f64,
        /// The largest.
        largest: f64,
    },
    /// |Δq_o| at the start is positive.
    AttitudeApart {
        /// It is not smaller.
        scalar: f64,
    },
    /// Whether Δq_o is zero at the start could not be told from what rounding leaves.
    AttitudeNotShown {
        /// Its magnitude is not larger.
        most: f64,
    },
    /// Δq_o is zero at the start, exactly.
    HalfTurn,
    /// The law is for another robot.
    NoTip,
    /// None of the lengths that are uncertain enters the dynamics.
    LengthsOutsideRegressor(Uncertain),
    /// Lengths enter the dynamics, but none is uncertain.
    LengthsKnown,
    /// Lengths that the law is said not to know, by name, enter its regressor.
    LengthsInRegressor(Vec<String>),
    /// Matrices that are positive definite in exact arithmetic and positive numbers; lengths that are not adapted are the true ones.
    PositiveMatricesTrueLengths,
    /// Lengths that are neither adapted nor true.
    LengthsNotAdapted {
        /// Whose.
        agent: Named,
    },
    /// The true parameters, or lengths, lie within the bounds.
    ParametersInside,
    /// One does not.
    ParameterOutside {
        /// Whose it is.
        agent: Named,
        /// Its name, if it has one.
        name: Option<String>,
        /// Its value, in its unit.
        value: f64,
        /// What its estimate is kept within.
        bounds: [f64; 2],
    },
    /// h_I by the start, N m s.
    Momentum([f64; 3]),
    /// A torque from outside changes h_I, and the law goes on with that of the start.
    MomentumPushed,
    /// What would end the run does not: a safe command stands there.
    SafeCommand,
    /// The law is for another plant.
    NoSpacecraft,
    /// The attitude to follow is a constant.
    TargetStill,
    /// The inertia is a multiple of the identity.
    EqualInertia,
    /// Neither: V̇ of a passivity filter beside wheels holds a term without a sign.
    TurningTarget,
    /// Disturbances enter the last equation of strict-feedback chains.
    Matched,
    /// A disturbance enters elsewhere, where the slopes of the steps may grow with the state.
    Unmatched {
        /// Whose.
        agent: Named,
    },
}

/// A term of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// χ, or one of f_1 … f_n.
    Drift,
    /// An entry of φ.
    Regressor,
    /// ψ.
    Factor,
}

/// What is known of a factor of the input over all states, where that is not enough.
#[derive(Clone, Debug, PartialEq)]
pub enum FactorEverywhere {
    /// It has one sign, but was not shown to keep away from zero, far away.
    Fades,
    /// It stays away from zero, but comes below its floor.
    Away {
        /// It is nowhere smaller in magnitude.
        least: f64,
    },
    /// It is zero in this state, or changes its sign there.
    Zero(Vec<f64>),
    /// It is a product of slopes along states, of which no bound is looked for.
    Slopes,
    /// Nothing.
    Unknown,
}

impl KindEvidence {
    pub(super) fn answer(&self) -> Answer {
        match self {
            KindEvidence::PositiveNumbers
            | KindEvidence::PositiveNumbersTrueMass
            | KindEvidence::PositiveMatrices
            | KindEvidence::MassOfPlant
            | KindEvidence::ConstantFactor
            | KindEvidence::FactorAway { .. }
            | KindEvidence::TermsDefined
            | KindEvidence::LengthsOutsideRegressor(_)
            | KindEvidence::LengthsKnown
            | KindEvidence::PositiveMatricesTrueLengths
            | KindEvidence::ParametersInside
            | KindEvidence::AttitudeApart { .. }
            | KindEvidence::Matched
            | KindEvidence::TargetStill
            | KindEvidence::EqualInertia
            | KindEvidence::AccelerationUnbiased
            | KindEvidence::Momentum(_) => Answer::Holds,
            KindEvidence::ThrustFloor { .. }
            | KindEvidence::FactorFloor { .. }
            | KindEvidence::BoundedStates { .. }
            | KindEvidence::SingularValue { .. }
            | KindEvidence::Determinant { .. } => Answer::Watched,
            // Where all agree it fails; a start is no witness of that.
            KindEvidence::FallsFreely { .. }
            | KindEvidence::Declared { .. }
            | KindEvidence::AttitudeNotShown { .. }
            | KindEvidence::TermNotShown { .. }
            | KindEvidence::TermNotSmooth { .. }
            | KindEvidence::TurningTarget
            | KindEvidence::Probed { probe: Probe { found: None, .. }, .. } => Answer::NotShown,
            KindEvidence::Mixture(_)
            | KindEvidence::MassNotAdapted { .. }
            | KindEvidence::ThrustKept { .. }
            | KindEvidence::AngularRate { .. }
            | KindEvidence::Rotors { .. }
            | KindEvidence::NoTip
            | KindEvidence::LengthsInRegressor(_)
            | KindEvidence::LengthsNotAdapted { .. }
            | KindEvidence::MomentumPushed
            | KindEvidence::AccelerationBiased { .. }
            | KindEvidence::Unmatched { .. }
            | KindEvidence::SafeCommand
            | KindEvidence::NoSpacecraft => Answer::NotCovered,
            KindEvidence::ParameterOutside { .. }
            | KindEvidence::TermFails { .. }
            | KindEvidence::RankDeficient { .. }
            | KindEvidence::HalfTurn
            | KindEvidence::FactorBelowFloor { .. }
            | KindEvidence::FactorAtStart { .. }
            | KindEvidence::ThrustAtStart { .. }
            | KindEvidence::FactorSingular { .. }
            | KindEvidence::Unmoved { .. }
            | KindEvidence::Probed { probe: Probe { found: Some(_), .. }, .. } => Answer::Violated,
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            KindEvidence::Declared { .. } | KindEvidence::Probed { probe: Probe { found: None, .. }, .. } => {
                Rigour::Declared
            }
            KindEvidence::Probed { probe: Probe { found: Some(_), .. }, .. } => Rigour::Sampled,
            KindEvidence::PositiveNumbers
            | KindEvidence::PositiveNumbersTrueMass
            | KindEvidence::PositiveMatrices
            | KindEvidence::PositiveMatricesTrueLengths
            | KindEvidence::Mixture(_)
            | KindEvidence::MassOfPlant
            | KindEvidence::MassNotAdapted { .. }
            | KindEvidence::ThrustKept { .. }
            | KindEvidence::AngularRate { .. }
            | KindEvidence::Rotors { .. }
            | KindEvidence::ConstantFactor
            | KindEvidence::NoTip
            | KindEvidence::FactorBelowFloor { .. }
            | KindEvidence::FactorAtStart { .. }
            | KindEvidence::ThrustAtStart { .. }
            | KindEvidence::FactorSingular { .. }
            | KindEvidence::Unmoved { .. }
            | KindEvidence::LengthsOutsideRegressor(_)
            | KindEvidence::LengthsKnown
            | KindEvidence::LengthsInRegressor(_)
            | KindEvidence::LengthsNotAdapted { .. }
            | KindEvidence::ParametersInside
            | KindEvidence::ParameterOutside { .. }
            | KindEvidence::MomentumPushed
            | KindEvidence::TargetStill
            | KindEvidence::EqualInertia
            | KindEvidence::TurningTarget
            | KindEvidence::AccelerationUnbiased
            | KindEvidence::AccelerationBiased { .. }
            | KindEvidence::Matched
            | KindEvidence::Unmatched { .. }
            | KindEvidence::SafeCommand
            | KindEvidence::NoSpacecraft => Rigour::Exact,
            KindEvidence::FactorAway { .. }
            | KindEvidence::TermsDefined
            | KindEvidence::TermFails { .. }
            | KindEvidence::AttitudeApart { .. }
            | KindEvidence::AttitudeNotShown { .. }
            | KindEvidence::HalfTurn
            | KindEvidence::TermNotShown { .. }
            | KindEvidence::TermNotSmooth { .. } => Rigour::Enclosed,
            KindEvidence::FallsFreely { .. } | KindEvidence::RankDeficient { .. } | KindEvidence::Momentum(_) => {
                Rigour::Computed
            }
            KindEvidence::ThrustFloor { .. }
            | KindEvidence::FactorFloor { .. }
            | KindEvidence::BoundedStates { .. }
            | KindEvidence::SingularValue { .. }
            | KindEvidence::Determinant { .. } => Rigour::Watched,
        }
    }
}
