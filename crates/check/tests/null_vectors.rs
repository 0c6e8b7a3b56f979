//! How much each agent counts, beside exact arithmetic.

use crate::common::{edge, masses, noise};
use forwardstep_check::{NoPrediction, Prediction, predict};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{Exchange, Setup};
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};

/// Half the distance from one to the next number.
const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// Masses over this graph, by (receiver, sender, weight).
fn over(agents: usize, weights: &[(usize, usize, f64)]) -> Setup {
    let edges: Vec<Edge> = weights.iter().map(|&(i, j, weight)| edge(j, i, weight, 0)).collect();
    let mut setup = masses(Exchange::Position, 2, Schedule::fixed(edges), vec![Delay::constant(0.0)]);
    let first = setup.agents[0].clone();
    setup.agents = (0..agents)
        .map(|index| {
            let mut agent = first.clone();
            agent.name = format!("a-{}", index + 1);
            agent.start.q = vec![noise(index), noise(index + 7)];
            agent
        })
        .collect();
    setup.network.agents = agents;
    setup
}

fn predicted(agents: usize, weights: &[(usize, usize, f64)]) -> Result<Prediction, NoPrediction> {
    predict(&over(agents, weights))
}

fn exact(weight: f64) -> BigRational {
    BigRational::from_float(weight).unwrap()
}

/// The left null vector of a strongly connected graph, by elimination in rational numbers.
fn eliminated(n: usize, weights: &[(usize, usize, f64)]) -> Vec<BigRational> {
    let mut w = vec![vec![BigRational::zero(); n]; n];
    for &(i, j, weight) in weights {
        w[i][j] += exact(weight);
    }
    for k in (1..n).rev() {
        let out: BigRational = w[k][..k].iter().sum();
        for i in 0..k {
            let share = &w[i][k] / &out;
            for j in (0..k).filter(|j| *j != i) {
                let added = &share * &w[k][j];
                w[i][j] += added;
            }
        }
    }
    let mut u = vec![BigRational::from_float(1.0).unwrap()];
    for k in 1..n {
        let out: BigRational = w[k][..k].iter().sum();
        let inflow: BigRational = (0..k).map(|i| &u[i] * &w[i][k]).sum();
        u.push(inflow / out);
    }
    let total: BigRational = u.iter().sum();
    u.into_iter().map(|u| u / &total).collect()
}

/// The largest relative error of an entry; entries below the range of numbers must be zero, or nearly.
fn error(found: &[f64], truth: &[BigRational]) -> f64 {
    let each = found.iter().zip(truth).map(|(found, truth)| {
        if truth.to_f64().unwrap() < 1e-300 {
            assert!(*found < 1.1e-300);
            return 0.0;
        }
        let off = (exact(*found) - truth) / truth;
        off.to_f64().unwrap().abs()
    });
    each.fold(0.0, f64::max)
}

/// Pseudo-random numbers in [0, 1).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
}

/// A cycle through all, and some chords; weights over so many decades.
fn connected(draw: &mut Draw, n: usize, chords: usize, decades: f64) -> Vec<(usize, usize, f64)> {
    let mut order: Vec<usize> = (0..n).collect();
    for k in (1..n).rev() {
        order.swap(k, draw.below(k + 1));
    }
    let mut pairs: std::collections::BTreeSet<(usize, usize)> =
        (0..n).map(|k| (order[k], order[(k + 1) % n])).collect();
    for _ in 0..chords {
        let (i, j) = (draw.below(n), draw.below(n));
        if i != j {
            pairs.insert((i, j));
        }
    }
    pairs.into_iter().map(|(i, j)| (i, j, 10_f64.powf(decades * (draw.next() - 0.5)))).collect()
}

#[test]
fn regress_a_weight_of_1e_17_counts() {
    let setup = over(2, &[(1, 0, 1e-17), (0, 1, 1.0)]);
    let found = predict(&setup).unwrap();
    // u ∝ (1e-17, 1).
    assert_eq!(found.influence, [1e-17, 1.0]);
    // The other way round the first counts alone, wherever the second starts.
    let other = predicted(2, &[(1, 0, 1.0), (0, 1, 1e-17)]).unwrap();
    assert_eq!(other.influence[0], 1.0);
    assert!(other.value[0].is_sign_positive() && (other.value[0] - setup.agents[0].start.q[0]).abs() < 1.0);
}

#[test]
fn prop_null_vectors_are_accurate_entry_by_entry_over_thirty_decades() {
    let mut draw = Draw(0x9E37_79B9_7F4A_7C15);
    for case in 0..400 {
        let n = 2 + draw.below(13);
        let chords = draw.below(3 * n);
        let decades = [0.0, 4.0, 30.0, 600.0][case % 4];
        let weights = connected(&mut draw, n, chords, decades);
        let found = predicted(n, &weights).unwrap();
        let off = error(&found.influence, &eliminated(n, &weights));
        assert!(off <= n as f64 * 4.0 * ROUNDING, "{n}: {off:e} of {weights:?}");
        assert!(off <= found.influence_error && found.influence_error < n as f64 * n as f64 * 40.0 * ROUNDING);
    }
}

/// All products of weights along trees that lead to `root`, added up.
fn trees(n: usize, w: &[Vec<f64>], root: usize) -> f64 {
    let others: Vec<usize> = (0..n).filter(|vertex| *vertex != root).collect();
    (0..n.pow(others.len() as u32))
        .map(|mut code| {
            let mut next = vec![root; n];
            let mut product = 1.0;
            for other in &others {
                next[*other] = code % n;
                product *= w[*other][code % n];
                code /= n;
            }
            let leads = |from: usize| (0..n).fold(from, |at, _| next[at]) == root;
            if others.iter().all(|other| leads(*other)) { product } else { 0.0 }
        })
        .sum()
}

/// By the Markov chain tree theorem uᵢ is the sum over the trees that lead to i, which are there exactly when i reaches all.
#[test]
fn prop_all_digraphs_of_four_agents_have_the_null_vector_that_their_trees_give() {
    for n in 1..=4_usize {
        let pairs: Vec<(usize, usize)> = (0..n * n).map(|at| (at / n, at % n)).filter(|(i, j)| i != j).collect();
        for chosen in 0..1_u32 << pairs.len() {
            let weights: Vec<(usize, usize, f64)> = (0..pairs.len())
                .filter(|bit| chosen >> bit & 1 == 1)
                .map(|bit| (pairs[bit].0, pairs[bit].1, [1.0, 2.0, 3.0, 0.5][bit % 4]))
                .collect();
            let mut w = vec![vec![0.0; n]; n];
            for &(i, j, weight) in &weights {
                w[i][j] = weight;
            }
            let sums: Vec<f64> = (0..n).map(|root| trees(n, &w, root)).collect();
            let total: f64 = sums.iter().sum();
            match predicted(n, &weights) {
                Ok(found) => {
                    assert!(total > 0.0, "{weights:?}");
                    for (found, sum) in found.influence.iter().zip(&sums) {
                        assert!((found - sum / total).abs() <= 1e-15, "{weights:?}: {found} {}", sum / total);
                        assert_eq!(*found == 0.0, *sum == 0.0);
                    }
                    assert!(found.value.iter().all(|value| value.is_finite()));
                }
                Err(NoPrediction::NoSpanningTree { closed_groups }) => {
                    assert!(total == 0.0 && closed_groups > 1, "{weights:?}");
                }
                Err(other) => panic!("{other}"),
            }
        }
    }
}

#[test]
fn who_does_not_reach_all_counts_for_nothing_and_two_closed_groups_have_no_value() {
    // A cycle, a chain of two cycles behind it.
    let chain = [(0, 1, 1.0), (1, 0, 3.0), (2, 1, 1e9), (2, 3, 1.0), (3, 2, 1.0), (4, 3, 1e-9)];
    let found = predicted(5, &chain).unwrap();
    assert_eq!(found.influence, [0.75, 0.25, 0.0, 0.0, 0.0]);
    let groups = [(0, 1, 1.0), (1, 0, 3.0), (2, 1, 1e9), (2, 3, 1.0), (4, 3, 1e-9)];
    let refused = predicted(5, &groups).unwrap_err();
    assert_eq!(refused, NoPrediction::NoSpanningTree { closed_groups: 2 });
    assert!(refused.to_string().contains("2 groups hear no agent outside themselves"));
}

#[test]
fn numbers_out_of_range_are_found_all_the_same() {
    // From one to the next 1e200 times as much, both ways round.
    let path: Vec<(usize, usize, f64)> = (0..6).flat_map(|k| [(k, k + 1, 1e-100), (k + 1, k, 1e100)]).collect();
    let found = predicted(7, &path).unwrap();
    assert_eq!(found.influence[0], 1.0);
    assert!(error(&found.influence, &eliminated(7, &path)) < 1e-14);
    assert!((found.influence[1] - 1e-200).abs() < 1e-213 && found.influence[2..] == [0.0; 5]);
    let back: Vec<(usize, usize, f64)> = path.iter().map(|&(i, j, weight)| (6 - i, 6 - j, weight)).collect();
    assert_eq!(predicted(7, &back).unwrap().influence[6], 1.0);
}

/// Cycles through all agents, along each of which the same flows: with w_ij = f/uᵢ as much enters every agent as leaves it, so u
/// is known. Powers of two make it exact.
fn with_known_flow(draw: &mut Draw, n: usize, cycles: usize) -> (Vec<(usize, usize, f64)>, Vec<f64>) {
    let u: Vec<f64> = (0..n).map(|_| [1.0, 2.0, 8.0, 1024.0][draw.below(4)]).collect();
    let mut weights = std::collections::BTreeMap::new();
    for cycle in 0..cycles {
        let mut order: Vec<usize> = (0..n).collect();
        for k in (1..n).rev() {
            order.swap(k, draw.below(k + 1));
        }
        for k in 0..n {
            let (i, j) = (order[k], order[(k + 1) % n]);
            *weights.entry((i, j)).or_insert(0.0) += [1.0, 4.0, 0.25][cycle % 3] / u[i];
        }
    }
    let total: f64 = u.iter().sum();
    let weights = weights.into_iter().map(|((i, j), weight)| (i, j, weight)).collect();
    (weights, u.into_iter().map(|u| u / total).collect())
}

/// Where fill is too much for the elimination the rest is iterated, and the truth lies within what is said of it.
#[test]
fn prop_what_is_iterated_is_enclosed() {
    let mut draw = Draw(7);
    // What is eliminated to the end is known better than what is iterated.
    for (n, cycles, within) in [(60, 3, 1e-11), (3000, 3, 1e-7), (10_000, 4, 1e-7)] {
        let (weights, truth) = with_known_flow(&mut draw, n, cycles);
        let found = predicted(n, &weights).unwrap();
        let off = found.influence.iter().zip(&truth).map(|(found, truth)| (found / truth - 1.0).abs());
        let off = off.fold(0.0, f64::max);
        let bound = found.influence_error;
        assert!(off <= bound && bound < within, "{n}: {off:e}, bound {bound:e}");
        // At least what rounding does to a residual, times the steps until an agent is met.
        assert!(n < 1000 || bound > 1e-12, "{n}: {bound:e}");
    }
}

/// Each half settles at once; between them 10¹⁴ times as slowly, which no iteration sees. Nothing is claimed then.
#[test]
fn what_cannot_be_enclosed_is_not_predicted() {
    let (mut draw, n) = (Draw(11), 3000);
    let (mut weights, _) = with_known_flow(&mut draw, n, 3);
    let (other, _) = with_known_flow(&mut draw, n, 3);
    weights.extend(other.into_iter().map(|(i, j, weight)| (n + i, n + j, weight)));
    weights.extend([(0, n, 1e-14), (n, 0, 3e-14)]);
    let refused = predicted(2 * n, &weights).unwrap_err();
    assert_eq!(refused, NoPrediction::Uncertain { error_bound: f64::INFINITY });
    assert!(refused.to_string().contains("no bound was found"));
}

/// 11 roundings for each that is taken out of a ring, twice what its decimal was rounded by, and the rest to second order.
#[test]
fn the_bound_counts_every_rounding() {
    let n = 1000;
    let ring: Vec<(usize, usize, f64)> = (0..n).map(|k| (k, (k + 1) % n, 1.0 + k as f64)).collect();
    let bound = predicted(n, &ring).unwrap().influence_error / (n as f64 * ROUNDING);
    assert!((13.0..13.4).contains(&bound), "{bound}");
}
