//! Where what is derived stands in the paper; nothing where it does not.

use forwardstep_sim::leader::FollowingDesign;
use num_traits::Zero;

use super::case::{Case, Led, Step, ThrustStep};
use super::dynamics::Heard;

/// The places of one design. Empty where the paper does not print it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Places {
    /// The identity that the design starts from.
    pub(super) identity: &'static str,
    /// What s is.
    pub(super) error: &'static str,
    /// The reference dynamics.
    pub(super) reference: &'static str,
    /// The equations of motion.
    pub(super) plant: &'static str,
    /// The law.
    pub(super) law: &'static str,
    /// The closed loop.
    pub(super) cascade: &'static str,
    /// After degree reduction in derivatives of z.
    pub(super) reduced: &'static str,
    /// The same in the variables ξ and y.
    pub(super) in_xi: &'static str,
    /// All agents stacked.
    pub(super) stacked: &'static str,
    /// The same without s.
    pub(super) undisturbed: &'static str,
    /// z as the output of a stable filter.
    pub(super) filter: &'static str,
    /// The Laplacian form.
    pub(super) laplacian: &'static str,
    /// Its matrix.
    pub(super) matrix: &'static str,
}

impl Places {
    /// Those of a design whose reference dynamics have this order.
    pub(super) fn of(case: &Case<'_>, order: usize) -> Places {
        let places = match &case.led {
            Led::Consensus(heard) => consensus(*heard, order),
            Led::PureIntegral(heard) => pure_integral(*heard, !case.lambda.is_zero()),
            Led::Backstepping => {
                Places { identity: "(aa2)", reference: "before (aa6)", cascade: "after (aa6)", ..Places::default() }
            }
            Led::Leader(design, _) => leader(design),
            Led::Target | Led::Desired(_) | Led::Outside(..) | Led::Refuted(..) => Places::default(),
        };
        own_step(case, order, places)
    }
}

fn identity(order: usize) -> &'static str {
    match order {
        0 => "(aa2)",
        1 => "(aa3)",
        2 => "(aa13)",
        _ => "before (a5)",
    }
}

fn consensus(heard: Heard, order: usize) -> Places {
    let common = Places { identity: identity(order), error: "(5)", reduced: "(27)", ..Places::default() };
    match (heard, order) {
        (Heard::Velocities, 1) => {
            Places { reference: "(aa10)", cascade: "after (4)", reduced: "", in_xi: "(aa12)", ..common }
        }
        (Heard::Velocities, 2) => Places {
            reference: "(a1)",
            cascade: "(26) for (a1)",
            reduced: "(27)",
            in_xi: "(a2)",
            stacked: "(a3)",
            laplacian: "(a4)",
            ..common
        },
        (Heard::Velocities, _) => Places { reference: "(a5)", cascade: "(26)", laplacian: "(a6)", ..common },
        (Heard::Positions, _) => Places { reference: "(24)", cascade: "(26) for (24)", laplacian: "(30)", ..common },
        (Heard::Coupled, _) => Places { reference: "(24) with φ", cascade: "(26) for (24)", ..common },
    }
}

fn pure_integral(heard: Heard, manipulated: bool) -> Places {
    let common = Places { identity: identity(2), error: "(5)", ..Places::default() };
    match heard {
        Heard::Velocities => Places {
            reference: if manipulated { "(31)" } else { "(3)" },
            cascade: "(9)",
            in_xi: "(11)",
            stacked: "(12)",
            undisturbed: "(14)",
            filter: "(19)",
            laplacian: "(17)",
            matrix: "after (17)",
            ..common
        },
        Heard::Positions | Heard::Coupled => Places { reference: "(23)", ..common },
    }
}

fn leader(design: &FollowingDesign) -> Places {
    match design {
        FollowingDesign::Continuous => Places {
            identity: "(aa3)",
            error: "(5)",
            reference: "(110)",
            cascade: "(112)",
            filter: "after (115)",
            ..Places::default()
        },
        FollowingDesign::Differentiable => {
            Places { identity: "(aa13)", error: "(5)", reference: "(119)", ..Places::default() }
        }
        FollowingDesign::WithoutAcceleration => {
            Places { identity: "(aa13)", error: "(5)", reference: "(122)", ..Places::default() }
        }
        FollowingDesign::Composite => Places { error: "(5)", ..Places::default() },
        FollowingDesign::Observer { .. } => {
            Places { error: "(5)", reference: "named in Remark 11, not printed", ..Places::default() }
        }
        FollowingDesign::Swarm { .. } => Places {
            identity: "(aa13)",
            error: "(5)",
            reference: "named in Remark 11, not printed",
            ..Places::default()
        },
    }
}

/// What the law and the plant change.
fn own_step(case: &Case<'_>, order: usize, places: Places) -> Places {
    let tracks = case.led == Led::Target;
    match &case.step {
        Step::Robot { known } => {
            Places { plant: "(1)", law: if *known { "(6) with ϑ̂ = ϑ" } else { "(6)" }, error: "(5)", ..places }
        }
        Step::PositionOnly(_) => Places {
            identity: "",
            error: "",
            plant: "(a7)",
            law: "(a8)",
            reference: if tracks && order == 2 { "(a9)" } else { "Remark 7" },
            cascade: "",
            reduced: if tracks { "after Remark 7" } else { "" },
            laplacian: "",
            ..places
        },
        Step::Thrust(ThrustStep::ByAcceleration, _) => Places {
            identity: "",
            error: "before Theorem 4",
            plant: "(47)",
            law: "(57)",
            cascade: "",
            reduced: "",
            ..places
        },
        Step::Thrust(step, _) => Places {
            identity: "",
            error: "before Theorem 4",
            plant: "(47)",
            law: if *step == ThrustStep::Adaptive { "(57)" } else { "(50)" },
            reference: "(49)",
            cascade: if *step == ThrustStep::Adaptive { "" } else { "before (54)" },
            reduced: if *step == ThrustStep::Adaptive { "proof of Theorem 5" } else { "(54)" },
            ..places
        },
        Step::Chain(..) => Places {
            identity: "before (43)",
            error: "",
            plant: "(33)",
            law: "",
            cascade: "(43)",
            reduced: "",
            ..places
        },
        Step::Attitude(_)
        | Step::PassivityFilter(_)
        | Step::ModelReference(_)
        | Step::TaskSpace(_)
        | Step::TipVelocity(_)
        | Step::Outside(_) => places,
    }
}
