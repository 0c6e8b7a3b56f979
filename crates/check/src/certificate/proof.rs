//! What proves a claim, or refutes a hypothesis.

use num_rational::BigRational;

/// A proof or a witness. Agents are vertices of the network; phases count from zero.
#[derive(Clone, Debug, PartialEq)]
pub enum Proof {
    /// Runs of phases, one after the other, that tile what recurs, each with a spanning tree.
    Windows(Vec<TreeWindow>),
    /// Every phase that recurs has a spanning tree: the order does not matter.
    EveryPhase(Vec<TreeWindow>),
    /// Windows along a sequence that was drawn, up to the end of the run.
    Drawn {
        /// What was drawn.
        given: Vec<DrawnPhase>,
        /// The windows.
        windows: Vec<TreeWindow>,
        /// No window, and no rest after the last, is longer, s.
        longest_s: BigRational,
    },
    /// Windows along the sequence of a log, up to the end of the run.
    Logged {
        /// The windows.
        windows: Vec<TreeWindow>,
        /// No window, and no rest after the last, is longer, s.
        longest_s: BigRational,
    },
    /// Witness: groups that hear no agent outside themselves in anything that recurs.
    Cut(Vec<Vec<usize>>),
    /// Witness: a group that hears no agent outside itself in a phase that recurs.
    Unheard {
        /// The phase.
        phase: usize,
        /// The group, without the leader.
        group: Vec<usize>,
    },
    /// There is one graph.
    NeverSwitches,
    /// No phase is shorter, s.
    ShortestPhase(BigRational),
    /// There is one graph, whose weights do not change where that matters.
    OneGraph,
    /// The text of the scenario says so at once.
    Text,
    /// Bounds of delays.
    Delays {
        /// No delay is longer, s.
        bound_s: BigRational,
        /// What formulas keep within.
        formulas: Vec<Enclosure>,
        /// What packets that were drawn come to.
        given: Vec<GivenAge>,
    },
    /// No message is older, s.
    Ages(BigRational),
    /// What weights keep within.
    Weights(Vec<Enclosure>),
    /// The form of a coupling and its limit or scale.
    Form(&'static str, BigRational),
    /// A number that the text bears out: the smallest root, the largest gain, an order, a time.
    Number(BigRational),
    /// The first column of the array of Routh, without an entry that is not positive.
    Routh(Vec<BigRational>),
    /// Witness: this column up to its first entry that is not positive.
    NoRouth(Vec<BigRational>),
    /// Classes of agents with one κ₀, in an order in which no edge leads back.
    Classes(Vec<Vec<usize>>),
    /// Graph, weights and delays are constant.
    Constant,
    /// Gains are positive definite; matrices by their pivots.
    Definite(Vec<Matrix>),
    /// The pivots of the shifted Laplacian of the followers.
    Laplacian {
        /// What k λ exceeds, and at least what the derivation asks for.
        least: BigRational,
        /// Those of L − (`least`/k) 1.
        pivots: Vec<BigRational>,
    },
    /// Derivatives are bounded up to an order, as far as stretches of formulas tell.
    Derivatives(usize, Range),
    /// What drives a leader keeps within these, axis by axis.
    Drive(Vec<Enclosure>),
    /// Witness: at this time, s, what drives the leader reaches γ on this axis, from zero.
    Reached(BigRational, usize),
    /// One pass over all states shows that the factor of the input keeps away from zero, or its smallest singular value where it is a matrix.
    FactorAway,
    /// Witness: the factor of the input of this agent is below its floor in this state, or in all.
    SmallFactor(usize, Option<Vec<BigRational>>),
    /// An agent whose chain has an equation that its next state does not move, and which, from zero.
    Unmoved(usize, usize),
    /// Witness: in this state, or in all, the matrix that is the factor of the input of this agent makes this vector shorter than its floor
    /// allows: it takes it to zero, or close.
    NullVector(usize, Vec<BigRational>, Option<Vec<BigRational>>),
    /// Witness: by the text a thrust starts at its floor or below.
    StartsBelow,
    /// The scalar part of the error of an attitude starts with this size at least.
    Apart(BigRational),
    /// Witness: it starts at zero.
    HalfTurn,
    /// Witness: the vector that the transpose of the estimated Jacobian takes to zero at the start, or so close that the law takes it
    /// for zero.
    LeftNull(Vec<BigRational>),
    /// Witness: every entry of a quaternion goes to zero as t → ∞.
    Fades,
    /// Witness: a time at which all entries of a quaternion are zero.
    Vanishes {
        /// When, s.
        at_s: BigRational,
    },
    /// Witness: an entry of a quaternion passes zero, and every other is zero for ever or a number times the same formula.
    ChangesSign {
        /// Which, from zero.
        entry: usize,
        /// When it has one sign, s.
        from_s: BigRational,
        /// When it has the other, s.
        to_s: BigRational,
    },
    /// Witness: a parameter, or a length, lies outside of the bounds of its estimate, by the text of the scenario.
    Outside,
    /// Witness: at this time, s, what this edge (from, to, phase) follows is not positive, or a delay is negative.
    Below(BigRational, (usize, usize, usize)),
    /// Witness: what this edge follows goes where it must not go as t → ∞: a weight to zero or without bound, a delay without bound.
    Limit((usize, usize, usize)),
    /// Witness: this edge loses every packet.
    LosesAll((usize, usize, usize)),
    /// Witness: all that is heard over this edge is older than it may be.
    Older((usize, usize, usize)),
    /// Witness: a derivative of a motion goes beyond every bound as t → ∞.
    Diverges {
        /// Whose motion, among the agents that the claim is about; zero for a leader.
        motion: usize,
        /// The axis, from zero.
        axis: usize,
        /// The derivative.
        order: usize,
    },
    /// Witness: in this state a term of this agent has no value.
    NoValue(usize, Vec<BigRational>),
    /// The square of the distance of a target from the base keeps within what a tip can reach.
    Distance(Enclosure),
    /// Witness: at this time, s, a target is out of reach.
    OutOfReach(BigRational),
    /// An entry of a quaternion, from zero, keeps away from zero.
    EntryAway(usize, Enclosure),
    /// The square of the norm of a quaternion keeps away from zero.
    Norm(Enclosure),
}

/// A run of phases and a spanning tree of their union.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeWindow {
    /// The phases, in order.
    pub phases: Vec<usize>,
    /// The root of the tree.
    pub root: usize,
    /// Its edges (from, to, phase), each from an agent that those before reach.
    pub arborescence: Vec<(usize, usize, usize)>,
}

/// A phase that was drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnPhase {
    /// Which.
    pub phase: usize,
    /// Until when, s.
    pub until_s: BigRational,
}

/// The largest age of what is heard on a link whose packets were drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenAge {
    /// The sender.
    pub from: usize,
    /// The receiver.
    pub to: usize,
    /// Its largest age, s.
    pub worst_s: BigRational,
}

/// A full matrix among the gains of an agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// The agent.
    pub agent: usize,
    /// Its key in the table of the law.
    pub gain: &'static str,
    /// D of A = L D Lᵀ.
    pub pivots: Vec<BigRational>,
}

/// What a formula keeps within, and how that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Enclosure {
    /// An edge (from, to, phase) whose weight or delay it is; `None` where the proof says otherwise.
    pub edge: Option<(usize, usize, usize)>,
    /// The stretch that is looked at.
    pub range: Range,
    /// What it keeps within.
    pub within: [BigRational; 2],
}

/// A stretch of time in as many equal pieces, on each of which one pass of interval arithmetic suffices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// [0, ∞) at once.
    ForEver,
    /// One period of the sines and cosines in it.
    Period {
        /// How many pieces.
        cells: usize,
    },
    /// Pieces until a time, and one from there on.
    Tail {
        /// How many pieces there are before.
        cells: usize,
        /// From when on the last lasts, s.
        until_s: u32,
    },
    /// Up to the end of the run.
    Run {
        /// How many pieces.
        cells: usize,
    },
}
