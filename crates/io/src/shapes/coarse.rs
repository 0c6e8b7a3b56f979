//! Fewer triangles: points in the same cell of a grid become one, at their mean, and what has no area left goes. One grid for all, as fine as
//! there is room for.

use std::collections::{HashMap, HashSet};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::Solid;
use super::triangles::Triangles;

/// What all solids may take together, before they are encoded: 1 MB in base64.
const ROOM_BYTES: usize = 750_000;
/// Triangles of one picture, each as often as robots have it: what a computer without a graphics card draws in about a second.
const MOST_DRAWN: usize = 400_000;
/// Points of a solid, whose numbers have two bytes.
const MOST_POINTS: usize = 1 << 16;
/// Cells along the largest robot are so many at most, and each step halves the number of those along two edges.
const FINEST: f64 = 4096.0;
const STEPS: u32 = 24;

/// Each point once, and no triangle that has no area for its corners alone.
pub(super) fn distinct(own: &Triangles) -> Triangles {
    clustered(own, 0.0)
}

/// All solids, each as fine as the others; robots have them so many times. Nothing is left of one that is smaller than a cell.
pub(super) fn coarse(all: &[Triangles], times: &[usize]) -> Vec<Solid> {
    let fit = |all: &[Triangles]| {
        let drawn: usize = all.iter().zip(times).map(|(own, times)| own.faces.len() * times).sum();
        drawn <= MOST_DRAWN && fit(all)
    };
    if fit(all) {
        return all.iter().map(encoded).collect();
    }
    let largest = all.iter().map(extent).fold(0.0, f64::max);
    let at = |step: u32| -> Vec<Triangles> {
        let cell = largest / FINEST * (0.5 * f64::from(step)).exp2();
        all.iter().map(|own| clustered(own, cell)).collect()
    };
    // The finest that fits: room only grows with the cells.
    let (mut fine, mut rough) = (0, STEPS);
    while fine < rough {
        let middle = fine.midpoint(rough);
        if fit(&at(middle)) { rough = middle } else { fine = middle + 1 }
    }
    at(rough).iter().map(encoded).collect()
}

fn fit(all: &[Triangles]) -> bool {
    let bytes = |own: &Triangles| 6 * (own.points.len() + own.faces.len());
    all.iter().map(bytes).sum::<usize>() <= ROOM_BYTES && all.iter().all(|own| own.points.len() <= MOST_POINTS)
}

fn ends(own: &Triangles) -> [[f64; 3]; 2] {
    let mut ends = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for point in own.faces.iter().flatten().filter_map(|k| own.points.get(*k as usize)) {
        for (k, x) in point.iter().enumerate() {
            ends[0][k] = ends[0][k].min(*x);
            ends[1][k] = ends[1][k].max(*x);
        }
    }
    ends
}

fn extent(own: &Triangles) -> f64 {
    let [low, high] = ends(own);
    (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max)
}

/// Without a cell only points that are the same become one.
fn clustered(own: &Triangles, cell: f64) -> Triangles {
    let key = |point: &[f64; 3]| {
        point.map(|x| if cell > 0.0 { (x / cell).floor() as i64 } else { (x + 0.0).to_bits() as i64 })
    };
    let mut numbers: HashMap<[i64; 3], u32> = HashMap::new();
    let mut sums: Vec<([f64; 3], f64)> = Vec::new();
    let mut new = vec![u32::MAX; own.points.len()];
    for &old in own.faces.iter().flatten() {
        let (point, new) = (&own.points[old as usize], &mut new[old as usize]);
        if *new != u32::MAX {
            continue;
        }
        *new = *numbers.entry(key(point)).or_insert_with(|| {
            sums.push(([0.0; 3], 0.0));
            sums.len() as u32 - 1
        });
        let (sum, count) = &mut sums[*new as usize];
        sum.iter_mut().zip(point).for_each(|(sum, x)| *sum += x);
        *count += 1.0;
    }
    let mut seen = HashSet::new();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for face in &own.faces {
        let face = face.map(|k| new[k as usize]);
        let mut sorted = face;
        sorted.sort_unstable();
        if sorted[0] < sorted[1] && sorted[1] < sorted[2] && seen.insert(sorted) {
            faces.push(face);
        }
    }
    Triangles { points: sums.iter().map(|(sum, count)| sum.map(|x| x / count)).collect(), faces }
}

/// Coordinates in 65535 steps between the ends.
fn encoded(own: &Triangles) -> Solid {
    let [low, high] = if own.faces.is_empty() { [[0.0; 3]; 2] } else { ends(own) };
    let step = [0, 1, 2].map(|k| (high[k] - low[k]) / 65535.0);
    let number =
        |k: usize, x: f64| if step[k] > 0.0 { ((x - low[k]) / step[k]).round().clamp(0.0, 65535.0) as u16 } else { 0 };
    let points = own.points.iter().flat_map(|point| [0, 1, 2].map(|k| number(k, point[k]))).flat_map(u16::to_le_bytes);
    let faces = own.faces.iter().flatten().flat_map(|k| (*k as u16).to_le_bytes());
    Solid {
        low,
        step,
        points: STANDARD.encode(points.collect::<Vec<u8>>()),
        faces: STANDARD.encode(faces.collect::<Vec<u8>>()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::PI;

    /// What the page makes of it.
    fn decoded(solid: &Solid) -> Triangles {
        let numbers = |text: &str| -> Vec<u16> {
            STANDARD.decode(text).unwrap().chunks(2).map(|two| u16::from_le_bytes([two[0], two[1]])).collect()
        };
        let point = |row: &[u16]| [0, 1, 2].map(|k| solid.low[k] + solid.step[k] * f64::from(row[k]));
        Triangles {
            points: numbers(&solid.points).chunks(3).map(point).collect(),
            faces: numbers(&solid.faces).chunks(3).map(|row| [row[0], row[1], row[2]].map(u32::from)).collect(),
        }
    }

    /// A ball of very many triangles.
    fn ball(rows: u32, radius: f64) -> Triangles {
        let at = |row: u32, k: u32| {
            let (up, round) = (PI * f64::from(row) / f64::from(rows), 2.0 * PI * f64::from(k) / f64::from(rows));
            [radius * up.sin() * round.cos(), radius * up.sin() * round.sin(), radius * up.cos()]
        };
        let points = (0..=rows).flat_map(|row| (0..rows).map(move |k| at(row, k))).collect();
        let faces = (0..rows).flat_map(|row| {
            (0..rows).flat_map(move |k| {
                let (a, b) = (row * rows + k, row * rows + (k + 1) % rows);
                [[a, b, b + rows], [a, b + rows, a + rows]]
            })
        });
        Triangles { points, faces: faces.collect() }
    }

    #[test]
    fn what_fits_stays_as_it_is() {
        let cuboid = Triangles::cuboid([1.0, 2.0, 3.0]);
        // The same corners once more, as a file that shares none has them.
        let split = Triangles {
            points: cuboid.faces.iter().flatten().map(|k| cuboid.points[*k as usize]).collect(),
            faces: (0..12).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
        };
        let found = decoded(&coarse(&[distinct(&split)], &[1])[0]);
        assert_eq!((found.points.len(), found.faces.len()), (8, 12));
        for point in &found.points {
            assert!(point.iter().zip([0.5, 1.0, 1.5]).all(|(x, half)| (x.abs() - half).abs() < 1e-4), "{point:?}");
        }
    }

    #[test]
    fn very_many_triangles_become_as_many_as_there_is_room_for() {
        let balls = [ball(700, 1.0), ball(300, 0.1)];
        assert!(balls[0].faces.len() > 900_000);
        let solids = coarse(&balls, &[1, 1]);
        let bytes: usize = solids.iter().map(|solid| solid.points.len() + solid.faces.len()).sum();
        assert!((300_000..1_000_100).contains(&bytes), "{bytes}");
        let found = decoded(&solids[0]);
        let worst =
            found.points.iter().map(|p| (p.iter().map(|x| x * x).sum::<f64>().sqrt() - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 0.02 && found.faces.len() > 5000, "{worst} {}", found.faces.len());
        assert_eq!(solids, coarse(&balls, &[1, 1]), "the same each time");
        // A hundred of the large one are drawn with a hundredth of the triangles each.
        let often = decoded(&coarse(&balls, &[100, 1])[0]);
        assert!((1000..=4000).contains(&often.faces.len()), "{}", often.faces.len());
    }

    #[test]
    fn nothing_is_left_of_what_has_no_area() {
        let flat = Triangles { points: vec![[0.0; 3]; 3], faces: vec![[0, 1, 2], [0, 0, 1]] };
        assert!(distinct(&flat).faces.is_empty() && decoded(&coarse(&[distinct(&flat)], &[1])[0]).faces.is_empty());
    }
}
