//! Reflections by adaptive quadrature against the oracle: no error exceeds its bound.

use octagloss_fixtures::scenes::reflections::{Reflections, reflections};

#[test]
fn no_reflection_is_off_by_more_than_its_bound() {
    use rayon::prelude::*;
    let all = (0..24)
        .into_par_iter()
        .map(|index| reflections(5, index))
        .reduce(Default::default, Reflections::join);
    assert!(all.violations.is_empty(), "{:#?}", all.violations);
    let off = (all.squares / all.count as f64).sqrt();
    // Relative to each answer, dark ones, too.
    assert!(all.count > 60 && off < 0.02, "{off} of {}", all.count);
}
