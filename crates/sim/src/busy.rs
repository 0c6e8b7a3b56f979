//! Which rows of a recording to take where there is no room for all: those where much happens.

/// Parts that are tried at most for every row that is to be taken.
const FINEST: usize = 8;

/// At most `most` rows, the first and the last among them, where these signals change, and where they bend: straight lines between these rows look like
/// the signals, and integrals over them are those of the signals.
pub fn busy_rows<'a>(rows: usize, most: usize, signals: impl Iterator<Item = &'a [f64]>) -> Vec<usize> {
    if rows <= most {
        return (0..rows).collect();
    }
    let progress = progress(rows, signals, Spent::OnBendsToo);
    let last = progress.last().copied().unwrap_or(1.0);
    let rows_of = |parts: usize| {
        let row = |k: usize| match k == parts {
            true => rows - 1,
            false => progress.partition_point(|share| *share < last * k as f64 / parts as f64).min(rows - 1),
        };
        let mut picks: Vec<usize> = (0..=parts).map(row).collect();
        picks.dedup();
        picks
    };
    // Where much happens in one row several parts end, which then are of use elsewhere.
    let mut parts = most.max(2) - 1;
    let mut picks = rows_of(parts);
    while picks.len() < most && parts < FINEST * most {
        parts += parts.div_ceil(8);
        match rows_of(parts) {
            finer if finer.len() <= most => picks = finer,
            _ => break,
        }
    }
    picks
}

/// What points are spent on, beside each row alike.
#[derive(Clone, Copy, PartialEq)]
pub enum Spent {
    /// By how much signals change there, each as a part of all that it does.
    OnChanges,
    /// And by how much these changes change.
    OnBendsToo,
}

/// The part of all points that is spent before each row.
pub fn progress<'a>(rows: usize, signals: impl Iterator<Item = &'a [f64]>, spent: Spent) -> Vec<f64> {
    let add = |shares: &mut [f64], steps: &mut dyn Iterator<Item = f64>| {
        let steps: Vec<f64> = steps.map(|step| if step.is_finite() { step.abs() } else { 0.0 }).collect();
        let all: f64 = steps.iter().sum();
        if all > 0.0 && all.is_finite() {
            shares.iter_mut().zip(steps).for_each(|(share, step)| *share += step / all);
        }
    };
    let [mut changed, mut bent] = [(); 2].map(|()| vec![0.0; rows]);
    for values in signals {
        add(changed.get_mut(1..).unwrap_or_default(), &mut values.windows(2).map(|two| two[1] - two[0]));
        if spent == Spent::OnBendsToo {
            let bends = values.windows(3).map(|three| three[2] - 2.0 * three[1] + three[0]);
            add(bent.get_mut(2..).unwrap_or_default(), &mut { bends });
        }
    }
    let parts: Vec<Vec<f64>> =
        [vec![1.0; rows], changed, bent].into_iter().filter(|part| part.iter().sum::<f64>() > 0.0).collect();
    let all: Vec<f64> = parts.iter().map(|part| part.iter().sum()).collect();
    let shares =
        |row: usize| parts.iter().zip(&all).map(|(part, all)| part[row] / all).sum::<f64>() / parts.len() as f64;
    let mut so_far = 0.0;
    (0..rows)
        .map(|row| {
            let before = so_far;
            so_far += shares(row);
            before
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One sharp turn in the first second of a hundred that swing: it had a dozen of 1200 points, and was drawn as a polygon.
    #[test]
    fn rows_are_taken_where_signals_bend() {
        let t_s = |row: usize| 0.02 * row as f64;
        let start = |row: usize| libm::exp(-4.0 * t_s(row)) * libm::sin(8.0 * t_s(row));
        let values: Vec<f64> = (0..5001).map(|row| start(row) + 0.3 * libm::sin(t_s(row))).collect();
        let within_a_second = |picks: &[usize]| picks.iter().filter(|row| t_s(**row) < 1.0).count();
        let picks = busy_rows(5001, 1000, std::iter::once(&values[..]));
        assert!(picks.len() <= 1000 && within_a_second(&picks) > 40, "{} of {}", within_a_second(&picks), picks.len());
        let share = |spent| progress(5001, std::iter::once(&values[..]), spent)[50];
        assert!(share(Spent::OnBendsToo) > 3.0 * share(Spent::OnChanges), "{}", share(Spent::OnChanges));
    }
}
