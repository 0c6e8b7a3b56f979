//! The equations of the paper as they are printed, beside what is derived.

use num_rational::BigRational;
use num_traits::{One, Zero};

use super::attitude;
use super::cascade::Upper;
use super::dynamics::{Dynamics, Heard, Measured, Smooth, backstepping, consensus, following, tracking};
use super::factors::Factors;
use super::form::{Combination, Form, Letter, Links, Operator, Quantity, Term, Undifferentiable, Vertex};
use super::laplacian::{RootsOfAll, chain};
use super::lower::{self, ChainError, Outside};
use super::polynomial::Polynomial;
use super::reduction::{Name, Reduced, Variable};
use super::task_space;

const Q: Letter = Letter::Position;
const Z: Letter = Letter::Reference;
const S: Letter = Letter::Error;
const V0: Letter = Letter::Variable(0);
const V1: Letter = Letter::Variable(1);
const V2: Letter = Letter::Variable(2);
const V3: Letter = Letter::Variable(3);

fn number(n: i64) -> BigRational {
    BigRational::from_integer(n.into())
}

fn poly(coefficients: &[i64]) -> Polynomial {
    Polynomial::new(coefficients.iter().map(|c| number(*c)).collect())
}

fn of(terms: &[(Quantity, &[i64])]) -> Combination {
    terms.iter().fold(Combination::default(), |all, (quantity, c)| all.plus(*quantity, &poly(c)))
}

fn form(own: &[(Quantity, &[i64])], network: &[(Quantity, &[i64])]) -> Form {
    Form { own: of(own), network: of(network) }
}

fn own(letter: Letter) -> Quantity {
    Quantity::own(letter)
}

fn heard(letter: Letter) -> Quantity {
    Quantity::heard(letter)
}

fn term(term: Term) -> Quantity {
    own(Letter::Term(term))
}

fn variable(name: Name, state: &[i64], input: &[i64]) -> Variable {
    Variable { name, state: poly(state), input: poly(input), common: true }
}

fn robot(roots: &[i64], told: Heard, measured: Measured) -> Dynamics {
    let roots: Vec<BigRational> = roots.iter().map(|root| number(*root)).collect();
    consensus(&Factors::of_real(&roots), told, &BigRational::zero(), measured).unwrap()
}

fn reduced(upper: &Upper, variables: Vec<Variable>) -> Reduced {
    upper.reduced(variables).unwrap()
}

/// ξ and y for α = 3.
fn xi_and_y() -> Vec<Variable> {
    vec![variable(Name::Xi, &[3, 1], &[]), variable(Name::Y, &[0, 3, 1], &[0, 1])]
}

#[test]
fn eq_aa10_and_aa12_for_alpha_3() {
    let first = robot(&[3], Heard::Velocities, Measured::ROBOT);
    // (aa10): ż = −3 q̇ − Σ w [ξ − ξ_j]
    assert_eq!(first.right, form(&[(own(Q), &[0, -3])], &[(own(Q), &[-3, -1]), (heard(Q), &[3, 1])]));
    assert_eq!((first.total_order(), first.upper().degree(1)), (2, 1));
    // (aa12): ξ̇ = −Σ w [ξ − ξ_j] + ṡ
    let xi = reduced(&first.upper(), vec![variable(Name::Xi, &[3, 1], &[])]);
    assert_eq!(xi.rates, [form(&[(own(S), &[0, 1])], &[(own(V0), &[-1]), (heard(V0), &[1])])]);
}

#[test]
fn eq_3_9_11_12_14_17_and_19_for_alpha_3_and_beta_5() {
    let three = robot(&[3, 5], Heard::Velocities, Measured::WITH_ACCELERATION);
    // (3): z̈ = −8 q̈ − 15 q̇ − Σ w [ξ̇ + 5 ξ − 5 ξ_j], ξ = q̇ + 3 q
    let bracket: [(Quantity, &[i64]); 2] = [(own(Q), &[-15, -8, -1]), (heard(Q), &[15, 5])];
    assert_eq!(three.right, form(&[(own(Q), &[0, -15, -8])], &bracket));
    // (9) has degree two.
    let upper = three.upper();
    assert_eq!((upper.order, upper.degree(1)), (3, 2));
    // (11): ξ̇ = y + ṡ, ẏ = −5 y − Σ w [y + 5 ξ − 5 ξ_j] − (5 + Σ w) ṡ
    let eleven = reduced(&upper, xi_and_y());
    let network: [(Quantity, &[i64]); 4] = [(own(V1), &[-1]), (own(V0), &[-5]), (heard(V0), &[5]), (own(S), &[0, -1])];
    let rates =
        [form(&[(own(V1), &[1]), (own(S), &[0, 1])], &[]), form(&[(own(V1), &[-5]), (own(S), &[0, -5])], &network)];
    assert_eq!((&eleven.rates[..], eleven.degree(1)), (&rates[..], 1));
    // (12): the coefficient of ṡ is −(5 I + D_w), and that of it in the first row is one.
    let rows = eleven.stacked(S).unwrap();
    assert_eq!(rows[0].inputs, [(1, [number(1), number(0)])]);
    assert_eq!(rows[1].inputs, [(1, [number(-5), number(-1)])]);
    assert_eq!(rows[1].own, of(&[(own(V1), &[-5])]));
    // (14): the same without ṡ, with Ψ_D = column{Σ w [y + 5 ξ − 5 ξ_j]}.
    assert_eq!(rows[1].network, of(&[(own(V1), &[-1]), (own(V0), &[-5]), (heard(V0), &[5])]));
    // (17), whose matrix is −[[5 I, −5 I], [−W, D_w]].
    let laplacian = upper.laplacian(chain(&[number(3), number(5)], 1, RootsOfAll::Same)).unwrap();
    let blocks = laplacian.blocks.iter().flatten();
    let entries: Vec<[BigRational; 3]> =
        blocks.map(|block| [block.identity.clone(), block.degrees.clone(), block.weights.clone()]).collect();
    let expected = [[-5, 0, 0], [5, 0, 0], [0, 0, 1], [0, -1, 0]].map(|entry| entry.map(number));
    assert_eq!(entries, expected);
    // (19): z̈ = −8 ż − 15 z − Σ w [y + 5 ξ − 5 ξ_j] − 15 s − (8 + Σ w) ṡ
    let filter = three.filter().unwrap();
    assert_eq!(filter.own, of(&[(own(Z), &[-15, -8]), (own(S), &[-15, -8])]));
    let network_of = upper.expressed(&Form::network(upper.right.network.clone()), &eleven.variables).unwrap();
    assert_eq!(network_of.network, of(&network));
}

#[test]
fn eq_a1_a2_a3_and_a4_for_alpha_3_and_beta_5() {
    let a1 = robot(&[3, 5], Heard::Velocities, Measured::ROBOT);
    // (a1): z̈ = −8 ż − 15 q̇ − Σ w [ż + 3 q̇ + 5 ξ − 5 ξ_j]
    let bracket: [(Quantity, &[i64]); 3] = [(own(Z), &[0, -1]), (own(Q), &[-15, -8]), (heard(Q), &[15, 5])];
    assert_eq!(a1.right, form(&[(own(Z), &[0, -8]), (own(Q), &[0, -15])], &bracket));
    // (a2): ẏ = −5 y − Σ w [y + 5 ξ − 5 ξ_j] + 3 ṡ, whose last coefficient no weight touches: (a3).
    let upper = a1.upper();
    let a2 = reduced(&upper, xi_and_y());
    let network: [(Quantity, &[i64]); 3] = [(own(V1), &[-1]), (own(V0), &[-5]), (heard(V0), &[5])];
    assert_eq!(a2.rates[0], form(&[(own(V1), &[1]), (own(S), &[0, 1])], &[]));
    assert_eq!(a2.rates[1], form(&[(own(V1), &[-5]), (own(S), &[0, 3])], &network));
    assert_eq!(a2.stacked(S).unwrap()[1].inputs, [(1, [number(3), number(0)])]);
    // (a4) is (17).
    let roots = [number(3), number(5)];
    let pure = robot(&[3, 5], Heard::Velocities, Measured::WITH_ACCELERATION);
    let [a4, seventeen] =
        [upper, pure.upper()].map(|upper| upper.laplacian(chain(&roots, 1, RootsOfAll::Same)).unwrap());
    assert_eq!(a4, seventeen);
}

#[test]
fn eq_27_holds_the_derivative_of_s_once_and_54_none() {
    // (49) with α, β, γ = 1, 2, 3: p³ + 6 p² + 11 p + 6.
    let upper = robot(&[1, 2, 3], Heard::Positions, Measured::ROBOT).upper();
    // Theorem 4: three derivatives of s, whose state holds one: degree two.
    assert_eq!((upper.derivatives_of_input(), upper.degree(1), upper.degree(2)), (3, 3, 2));
    let network: [(Quantity, &[i64]); 5] =
        [(own(V3), &[-1]), (own(V2), &[-6]), (own(V1), &[-11]), (own(V0), &[-6]), (heard(V0), &[6])];
    // (27), and the proof of Theorem 5: q̈ = ż + ṡ, and nothing else of s.
    let steps = upper.steps(0);
    assert_eq!(steps.iter().map(|step| step.derivatives).collect::<Vec<_>>(), [3, 2, 1, 0]);
    let rates = [
        form(&[(own(V1), &[1])], &[]),
        form(&[(own(V2), &[1]), (own(S), &[0, 1])], &[]),
        form(&[(own(V3), &[1])], &[]),
        form(&[(own(V3), &[-6]), (own(V2), &[-11]), (own(V1), &[-6])], &network),
    ];
    assert_eq!(steps[2].rates, rates);
    // (54): z⃛ = −6 z̈ − 11 ż − 6 z − Σ w [z̈ + 6 ż + 11 z + 6 x − 6 x_j] − [6 + 11 Σ w] s
    assert_eq!(steps[3].rates[0], form(&[(own(V1), &[1]), (own(S), &[1])], &[]));
    let last = form(&[(own(V3), &[-6]), (own(V2), &[-11]), (own(V1), &[-6]), (own(S), &[-6])], &network);
    assert_eq!(steps[3].rates[3], last.sum(&form(&[], &[(own(S), &[-11])])));
    assert_eq!(steps[3].rates[2], form(&[(own(V3), &[1])], &[]));
}

#[test]
fn eq_112_114_115_and_118_for_alpha_3_and_gamma_7() {
    let dynamics = following(&number(3), &number(7));
    let upper = dynamics.upper();
    let sign = term(Term::Sign);
    // (112): ξ̇ = −Σ w (ξ_i − ξ_j) − 7 ς + ṡ
    let xi = variable(Name::Xi, &[3, 1], &[]);
    let network: [(Quantity, &[i64]); 2] = [(own(V0), &[-1]), (heard(V0), &[1])];
    let closed = form(&[(sign, &[-7]), (own(S), &[0, 1])], &network);
    assert_eq!(reduced(&upper, vec![xi.clone()]).rates, std::slice::from_ref(&closed));
    // (114): Δξ̇ = the same − ξ̇₀
    let relative = upper.relative_to([Quantity::of_leader(Q); 2]);
    let drive = form(&[(Quantity::of_leader(Q), &[0, -3, -1])], &[]);
    assert_eq!(reduced(&relative, vec![xi]).rates, [closed.sum(&drive)]);
    // (115), with v = Δξ − s: v̇ = −Σ w [(v_i − v_j) + (s_i − s_j)] − 7 ς − ξ̇₀
    let fifteen = reduced(&relative, vec![variable(Name::RelativeXi, &[3, 1], &[1])]);
    let differences: [(Quantity, &[i64]); 4] = [(own(V0), &[-1]), (heard(V0), &[1]), (own(S), &[-1]), (heard(S), &[1])];
    let expected = form(&[(sign, &[-7])], &differences).sum(&drive);
    assert_eq!((&fifteen.rates[..], fifteen.degree(1)), (&[expected][..], 0));
    // Over late links a neighbour tells how far it was from where the leader was then.
    let then = Quantity { vertex: Vertex::LateLeader, ..Quantity::of_leader(Q) };
    let late = upper.relative_to([Quantity::of_leader(Q), then]);
    let late = reduced(&late, vec![variable(Name::RelativeXi, &[3, 1], &[1])]);
    let moved = form(&[], &[(Quantity::of_leader(Q), &[-3, -1]), (then, &[3, 1])]);
    assert_eq!(late.rates[0], fifteen.rates[0].sum(&moved));
    // (118): without s; E-free, with balanced brackets.
    assert_eq!(fifteen.rates[0].without(S), form(&[(sign, &[-7])], &network).sum(&drive));
    // After (115): ż = −3 z − 3 s − Σ w (ξ_i − ξ_j) − 7 ς
    let filter = dynamics.filter().unwrap();
    assert_eq!(filter.own, of(&[(own(Z), &[-3]), (own(S), &[-3]), (sign, &[-7])]));
}

#[test]
fn eq_119_and_122_differentiated_are_one_equation_and_swarms_have_none_of_their_own() {
    let [alpha, beta, gamma] = [2, 3, 7].map(number);
    let smooth = Smooth { alpha, beta, gamma, by_itself: true, coupling: BigRational::one() };
    let sign = term(Term::Sign);
    // (119): z̈ = −3 q̈ − 2 q̇ − Σ w (ξ*_i − ξ*_j) − 7 ς
    let network: [(Quantity, &[i64]); 2] = [(own(Q), &[-2, -3, -1]), (heard(Q), &[2, 3, 1])];
    let dynamics = smooth.dynamics(Links::Constant).unwrap();
    assert_eq!(dynamics.right, form(&[(own(Q), &[0, -2, -3]), (sign, &[-7])], &network));
    assert_eq!(smooth.dynamics(Links::Varying), Err(Undifferentiable::Links));
    let upper = dynamics.upper().relative_to([Quantity::of_leader(Q); 2]);
    assert_eq!(upper.degree(1), 2);
    // v = Δξ* − ṡ: v̇ = −Σ w [(v_i − v_j) + (ṡ_i − ṡ_j)] − 7 ς − ξ̇*₀
    let star = || vec![variable(Name::RelativeXiStar, &[2, 3, 1], &[0, 1])];
    let differences: [(Quantity, &[i64]); 4] =
        [(own(V0), &[-1]), (heard(V0), &[1]), (own(S), &[0, -1]), (heard(S), &[0, 1])];
    let drive = form(&[(Quantity::of_leader(Q), &[0, -2, -3, -1])], &[]);
    assert_eq!(reduced(&upper, star()).rates, [form(&[(sign, &[-7])], &differences).sum(&drive)]);
    // Without terms of its own, and k = 5.
    let swarm = Smooth { by_itself: false, coupling: number(5), ..smooth }.dynamics(Links::Constant).unwrap();
    assert_eq!(swarm.right, form(&[(sign, &[-7])], &[]).sum(&form(&[], &network).scaled(&number(5))));
    assert_eq!(swarm.upper().reduced(star()), None, "differences alone do not close in ξ*");
}

#[test]
fn what_varies_is_not_differentiated() {
    let velocity = backstepping();
    assert_eq!((velocity.order, velocity.upper().degree(1)), (0, 0));
    assert_eq!(velocity.right.differentiated(Links::Varying), Err(Undifferentiable::Links));
    let derivative = form(&[], &[(own(Q), &[0, -1]), (heard(Q), &[0, 1])]);
    assert_eq!(velocity.right.differentiated(Links::Constant), Ok(derivative));
    let motion = Form::own(Combination::of(own(Q).under(Operator::Inertia), poly(&[1])));
    assert_eq!(motion.differentiated(Links::Constant), Err(Undifferentiable::Operator));
}

#[test]
fn eq_3_is_integrated_without_acceleration_and_without_differentiating_what_is_heard() {
    let three = robot(&[3, 5], Heard::Velocities, Measured::WITH_ACCELERATION);
    let integrated = three.integrated();
    // ż = −8 q̇ − 15 q − Σ w [q̇ + 8 q] + η,   η̇ = −Σ w [15 q − 5 q̇_j − 15 q_j]
    let dz = form(&[(own(Q), &[-15, -8]), (own(Letter::Integral), &[1])], &[(own(Q), &[-8, -1])]);
    assert_eq!(integrated.dz, dz);
    assert_eq!(integrated.d_eta, form(&[], &[(own(Q), &[-15]), (heard(Q), &[15, 5])]));
}

#[test]
fn eq_a9_and_the_cascade_after_remark_7() {
    let roots = [1, 2, 3].map(number);
    let a9 = tracking(&Factors::of_real(&roots), Measured { plant: 2, below: 1 }).unwrap();
    // (a9): z̈ = x⃛_d − 6 (ż − ẍ_d) − 11 (z − ẋ_d) − 6 (x − x_d)
    let target = own(Letter::Target);
    assert_eq!(a9.right, form(&[(target, &[6, 11, 6, 1]), (own(Z), &[-11, -6]), (own(Q), &[-6])], &[]));
    // With λ_f = 2: Δẋ = Δz + ẏ/2 + y, Δz̈ = −6 Δż − 11 Δz − 6 Δx, and nothing of x_d.
    let lag = Polynomial::new(vec![number(1), BigRational::new(1.into(), 2.into())]);
    let upper = a9.upper().relative_to([target; 2]).filtered(&lag);
    let y = Letter::Filter;
    let cascade = upper.steps(1);
    let last = cascade.last().unwrap();
    let filtered = Form::own(Combination::of(own(y), lag.clone()));
    assert_eq!(last.rates[0], form(&[(own(V1), &[1])], &[]).sum(&filtered));
    assert_eq!(last.rates[2], form(&[(own(V2), &[-6]), (own(V1), &[-11]), (own(V0), &[-6])], &[]));
    assert_eq!(last.degree(1), 1);
    assert_eq!(upper.right.highest(y), Some(3));
    // With x − y/2 in the place of x no derivative of y is left: its first rate is Δz + y.
    let shifted = upper.shifted().unwrap();
    assert_eq!((shifted.rates[0].clone(), shifted.derivatives), (form(&[(own(V1), &[1]), (own(y), &[1])], &[]), 0));
}

#[test]
fn eq_52_and_the_other_lower_subsystems_follow_from_motion_and_law() {
    let mass = |letter| own(letter).under(Operator::Mass);
    // (52): m s̈ = −4 m ṡ − 9 s; with (57): m s̈ = −4 m ṡ + Δm w.
    let known = lower::thrust(Outside::default(), &number(4), Some(&number(9)));
    assert_eq!((known.left, known.order), (form(&[(mass(S), &[0, 0, 1])], &[]), 2));
    assert_eq!(known.right, form(&[(mass(S), &[0, -4]), (own(S), &[-9])], &[]));
    let adapted = lower::thrust(Outside::default(), &number(4), None);
    assert_eq!(adapted.right, form(&[(mass(S), &[0, -4]), (term(Term::MassError), &[1])], &[]));
    // (9): M ṡ + C s = −K s + Y Δϑ; (a10) with κ = 4 has −4 Ĵᵀ K* Δx more.
    let left = form(&[(own(S).under(Operator::Inertia), &[0, 1]), (own(S).under(Operator::Coriolis), &[1])], &[]);
    let right = form(&[(own(S).under(Operator::Damping), &[-1]), (term(Term::RegressorError), &[1])], &[]);
    let robot = lower::robot(Outside::default(), false, None);
    assert_eq!((robot.left, robot.right.clone()), (left.clone(), right.clone()));
    let tip = lower::robot(Outside::default(), false, Some(&number(4)));
    assert_eq!((tip.left, tip.right), (left, right.sum(&form(&[(term(Term::TaskForce), &[-4])], &[]))));
    assert_eq!(
        lower::robot(Outside::default(), true, None).right,
        robot.right.without(Letter::Term(Term::RegressorError))
    );
    // (a8): m ṡ = −9 y + Δm ż.
    let blind = lower::position_only(Outside::default(), &number(9));
    assert_eq!(blind.left, form(&[(mass(S), &[0, 1])], &[]));
    assert_eq!(blind.right, form(&[(own(Letter::Filter), &[-9]), (term(Term::MassErrorRate), &[1])], &[]));
    // (43): ṡ = −2 s − φᵀΔθ for a chain of any order.
    for order in 1..6 {
        let chain = lower::chain(Outside::default(), order, &number(2), ChainError::Adapted);
        assert_eq!(chain.left, form(&[(own(S), &[0, 1])], &[]));
        assert_eq!(chain.right, form(&[(own(S), &[-2]), (term(Term::ChainRegressorError), &[-1])], &[]));
        // And with what disturbs it, which the law does not know.
        let pushed = Outside { pushed: true, ..Outside::default() };
        let disturbed = lower::chain(pushed, order, &number(2), ChainError::None);
        assert_eq!(disturbed.right, form(&[(own(S), &[-2]), (term(Term::Disturbance), &[1])], &[]));
    }
}

#[test]
fn eq_107_and_108_with_the_signs_that_e13_corrects() {
    // Δω̇ = −5 Δω − 4 Δq_v + ṡ + 5 s + S(s) ω_d for α₁ = 4, α₂ = 5.
    let first = attitude::error(&attitude::reference(&[number(4), number(5)]));
    let spun = own(S).under(Operator::Gyroscopic);
    let expected = form(
        &[(own(Letter::Deviation), &[-5]), (term(Term::AttitudeError), &[-4]), (own(S), &[5, 1]), (spun, &[1])],
        &[],
    );
    assert_eq!(first, expected);
    // M ṡ = S(h) s − Dᵀ K ẏ
    let second = lower::attitude(Outside::default());
    assert_eq!(second.left, form(&[(own(S).under(Operator::Inertia), &[0, 1])], &[]));
    let spun = own(S).under(Operator::Momentum);
    assert_eq!(second.right, form(&[(spun, &[1]), (term(Term::AttitudeDamping), &[-1])], &[]));
    // (108): ÿ + Λ_f ẏ = K Δq̇*
    let (left, right) = attitude::filter_rate().unwrap();
    let y = own(Letter::Filter);
    assert_eq!(left, form(&[(y, &[0, 0, 1]), (y.under(Operator::Filter), &[0, 1])], &[]));
    assert_eq!(right, form(&[(term(Term::AttitudeErrorRate), &[0, 1])], &[]));
}

#[test]
fn what_is_heard_of_another_plant_stays_as_it_is() {
    // z follows x here, and something else at neighbours of another order.
    let dynamics =
        consensus(&Factors::of_real(&[number(3)]), Heard::Positions, &BigRational::zero(), Measured::whole(1)).unwrap();
    let heard_in = |upper: Upper| upper.steps(0).last().unwrap().rates[1].network.clone();
    let alike: [(Quantity, &[i64]); 5] =
        [(own(V1), &[-1]), (own(V0), &[-3]), (heard(V0), &[3]), (own(S), &[-3]), (heard(S), &[3])];
    assert_eq!(heard_in(dynamics.upper()), of(&alike));
    let others: [(Quantity, &[i64]); 4] = [(own(V1), &[-1]), (own(V0), &[-3]), (heard(Q), &[3]), (own(S), &[-3])];
    assert_eq!(heard_in(dynamics.upper().among_others()), of(&others));
}

#[test]
fn eq_a10_is_reduced_to_degree_zero() {
    let upper = task_space::reference(&number(3)).upper();
    assert_eq!(upper.degree(1), 1);
    // d/dt (q̇ − z_r − s) = −3 (q̇ − z_r − s) − Ĵᵀ K* Δx
    let expected = form(&[(own(Letter::Deviation), &[-3]), (term(Term::TaskForce), &[-1])], &[]);
    assert_eq!(task_space::reduced(&upper), expected);
}

#[test]
fn eq_106_follows_from_how_attitudes_turn() {
    use super::quaternion::{Factor, Products, difference, turning};
    // Δq̇* = Δq* ½ (ω − z), with ω and z as quaternions behind it.
    let half = BigRational::new(1.into(), 2.into());
    let [omega, z] = [Factor::Rate, Factor::Reference].map(|factor| Products::of(&[factor]));
    let rate = turning().unwrap();
    assert_eq!(rate, omega.scaled(&half).sum(&z.scaled(&-half)));
    let expected = Products::of(&difference()).times(&rate);
    assert_eq!(Products::of(&difference()).differentiated().unwrap(), expected);
    // q⁻¹ q is one, whose derivative is zero, and no rate of ω is known.
    let one = Products::of(&[Factor::AttitudeInverse, Factor::Attitude]);
    assert_eq!((one.clone(), one.differentiated()), (Products::of(&[]), Some(Products::default())));
    assert_eq!(omega.differentiated(), None);
    let unreduced = [Factor::AttitudeInverse, Factor::ReferenceAttitude];
    let turned = Products::of(&unreduced).differentiated().unwrap();
    assert_eq!(turned.behind(&unreduced), None, "it turns in front: {turned:?}");
    // In letters: Δq̇* = D(Δq*) s.
    let s = own(S).under(Operator::AttitudeMap);
    assert_eq!(attitude::difference_rate(), form(&[(s, &[1])], &[]));
}

#[test]
fn what_a_robot_loses_and_what_pushes_it_reach_the_lower_subsystem() {
    let outside = Outside { damped: true, pushed: true, ..Outside::default() };
    let [lost, pushed] = [own(S).under(Operator::Viscous), term(Term::External)];
    for known in [false, true] {
        let [plain, other] = [Outside::default(), outside].map(|outside| lower::robot(outside, known, None));
        assert_eq!(other.left, plain.left);
        assert_eq!(
            other.right.less(&plain.right),
            form(&[(lost, &[-1]), (pushed, &[1])], &[]),
            "M ṡ + C s = … − D s + τ_ext"
        );
        assert_eq!(other.law, plain.law, "the law knows no push, and its regressor holds D");
        assert_eq!(other.outside, form(&[(pushed, &[1])], &[]));
    }
    let pushed_mass = lower::position_only(Outside { pushed: true, ..Outside::default() }, &number(9));
    let right = lower::position_only(Outside::default(), &number(9)).right;
    assert_eq!(pushed_mass.right, right.sum(&form(&[(pushed, &[1])], &[])));
}
