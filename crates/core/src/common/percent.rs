//! Shares of energy as text.

/// Formats a share in percent with two significant digits below ten, and as `less than 0.01 %` instead of
/// 0.00.
pub fn percent(share: f64) -> String {
    match 100.0 * share {
        0.0 => "0 %".to_owned(),
        p if p.abs() < 0.005 => "less than 0.01 %".to_owned(),
        p if p.abs() < 0.095 => format!("{p:.2} %"),
        p if p.abs() < 9.5 => format!("{p:.1} %"),
        p => format!("{p:.0} %"),
    }
}

/// Whether a share deserves a warning: it must not round to 0.00 %.
pub(crate) fn share_matters(share: f64) -> bool {
    share >= 5e-5
}
