//! Formulas in t, [`Expression`]s whose only variable is t, with what they keep within: delays and weights that change
//! continuously.
//!
//! Bounds are how a delay is shown never to be negative and a weight to stay positive.

use forwardstep_core::expression::{Expression, ForEver, Interval, KinkError};

use crate::quantity::{QuantityError, Requirement, Sign, not_negative, positive, such};

/// Times at which a value that a formula must not have is looked for.
const LOOKS: u32 = 1000;

/// A formula with what it keeps within.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedFormula {
    formula: Expression,
    until_s: f64,
    within: Interval,
    for_ever: ForEver,
    kinks_s: Vec<f64>,
}

impl BoundedFormula {
    /// Encloses `formula` on [0, `until_s`], and for ever.
    pub fn new(formula: Expression, until_s: f64) -> Self {
        let within = formula.bounds(0.0, until_s);
        let for_ever = formula.for_ever();
        // Where they cannot be told apart they are left to the error control: the value is continuous.
        let kinks_s = kinks_s(&formula, 0.0, until_s).unwrap_or_default();
        BoundedFormula { formula, until_s, within, for_ever, kinks_s }
    }

    /// The formula.
    pub fn formula(&self) -> &Expression {
        &self.formula
    }

    /// Its bounds hold until here, s.
    pub fn until_s(&self) -> f64 {
        self.until_s
    }

    /// What it keeps within until [`until_s`](Self::until_s).
    pub fn within(&self) -> Interval {
        self.within
    }

    /// What it does for ever, as far as that could be shown; see [`Expression::for_ever`].
    pub fn for_ever(&self) -> ForEver {
        self.for_ever
    }

    /// When it is seen to be outside `range`, and its value then: the first of many times looked at, far beyond the run, at
    /// which that is certain. `None` where it is not seen.
    pub fn seen_outside(&self, range: Interval) -> Option<Witness> {
        let end_s = self.until_s;
        times_s(end_s).find_map(|t_s| Witness::outside(t_s, self.formula.enclose(Interval::point(t_s)), range))
    }

    /// Its value, where one pass of exact interval arithmetic shows that it has one for ever, though t may be in it: 0.3 + 0 t. That of a
    /// formula without t may be no number.
    pub fn constant(&self) -> Option<f64> {
        if self.formula.is_constant() {
            return Some(self.formula.constant().map_or(f64::NAN, |number| number.value()));
        }
        // No more than that: others have to see it, too.
        self.formula.constant_over(Interval { low: 0.0, high: f64::INFINITY }).map(|number| number.value())
    }

    /// Where it has kinks until [`until_s`](Self::until_s), s, rising; none where they could not be told apart.
    pub fn kinks_s(&self) -> &[f64] {
        &self.kinks_s
    }

    /// Its value at `t_s`. Beyond [`until_s`](Self::until_s) it is kept within the bounds.
    #[inline]
    pub fn value(&self, t_s: f64) -> f64 {
        // Not f64::clamp, which lets not-a-number through.
        self.formula.eval(t_s).max(self.within.low).min(self.within.high)
    }
}

impl BoundedFormula {
    /// Checks that what messages call `key` has this sign, and is finite, until [`until_s`](Self::until_s).
    ///
    /// # Errors
    /// [`QuantityError`] if that could not be shown.
    pub fn stays(&self, key: &'static str, must: Sign) -> Result<(), QuantityError> {
        if let Some(value) = self.constant() {
            such(!value.is_nan(), "", key, value, "must have a finite value")?;
            // sin π is zero, though not the number next to it.
            let irrational = self.formula.constant().filter(|number| number.exact().is_none());
            if let Some(Interval { low, high }) = irrational.map(|number| number.within())
                && must.is_of(value)
                && !(must.is_of(low) && must.is_of(high))
            {
                let requirement =
                    Requirement::Throughout { must, within: [low, high], seen_s: None, until_s: self.until_s };
                return Err(QuantityError { path: key.into(), value, requirement });
            }
            return match must {
                Sign::Positive => positive("", key, value),
                Sign::NotNegative => not_negative("", key, value),
            };
        }
        let Interval { low, high } = self.within;
        if must.is_of(low) && must.is_of(high) {
            return Ok(());
        }
        let mut looks = (0..=LOOKS).map(|k| f64::from(k) / f64::from(LOOKS) * self.until_s);
        let seen_s = looks.find(|t_s| !must.is_of(self.formula.eval(*t_s)));
        let value = seen_s.map_or(low, |t_s| self.formula.eval(t_s));
        let requirement = Requirement::Throughout { must, within: [low, high], seen_s, until_s: self.until_s };
        Err(QuantityError { path: key.into(), value, requirement })
    }
}

/// A value that was found, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witness {
    /// When, s.
    pub t_s: f64,
    /// The value, rounded towards what it is a witness against.
    pub value: f64,
}

impl Witness {
    /// The value at `t_s` as a witness against `range`, if what encloses it is outside.
    pub(crate) fn outside(t_s: f64, value: Interval, range: Interval) -> Option<Witness> {
        match () {
            () if value.low > range.high => Some(Witness { t_s, value: value.low }),
            () if value.high < range.low => Some(Witness { t_s, value: value.high }),
            () => None,
        }
    }
}

/// Times to look at, s: evenly spread over the run, then ever further apart.
pub(crate) fn times_s(end_s: f64) -> impl Iterator<Item = f64> {
    const EVEN: u32 = 1000;
    const FAR: usize = 20_000;
    const FARTHEST_S: f64 = 1e80;
    let even = (0..=EVEN).map(move |k| end_s * f64::from(k) / f64::from(EVEN));
    let later = |t_s: f64| Some(1.01 * t_s).filter(|t_s| *t_s < FARTHEST_S);
    even.chain(std::iter::successors(later(end_s), move |t_s| later(*t_s)).take(FAR))
}

/// Where a formula has kinks between two times, s, rising.
///
/// # Errors
/// [`KinkError`] when they cannot be told apart.
pub fn kinks_s(formula: &Expression, from_s: f64, until_s: f64) -> Result<Vec<f64>, KinkError> {
    let switches = formula.switches(from_s, until_s)?;
    let mut kinks_s: Vec<f64> = switches.iter().flat_map(|switch| switch.at()).copied().collect();
    kinks_s.sort_by(f64::total_cmp);
    kinks_s.dedup();
    Ok(kinks_s)
}
