//! Finite-number checks for JSON, which has neither NaN nor infinity; `serde_json` would write null.

use serde::ser::{Error as _, Serialize, Serializer};

/// One number or several.
pub trait Numbers {
    /// First number that is NaN or infinite.
    fn not_finite(&self) -> Option<f64>;
}

impl Numbers for f64 {
    fn not_finite(&self) -> Option<f64> {
        (!self.is_finite()).then_some(*self)
    }
}

impl Numbers for f32 {
    fn not_finite(&self) -> Option<f64> {
        f64::from(*self).not_finite()
    }
}

impl<T: Numbers> Numbers for Option<T> {
    fn not_finite(&self) -> Option<f64> {
        self.as_ref().and_then(Numbers::not_finite)
    }
}

impl<T: Numbers, const N: usize> Numbers for [T; N] {
    fn not_finite(&self) -> Option<f64> {
        self.iter().find_map(Numbers::not_finite)
    }
}

impl<T: Numbers> Numbers for Vec<T> {
    fn not_finite(&self) -> Option<f64> {
        self.iter().find_map(Numbers::not_finite)
    }
}

/// For `serde(serialize_with)`: serialises `value`; fails if a number in it is NaN or infinite.
pub fn finite<T: Numbers + Serialize, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    match value.not_finite() {
        Some(number) => Err(S::Error::custom(format!("a number is {number}"))),
        None => value.serialize(serializer),
    }
}
