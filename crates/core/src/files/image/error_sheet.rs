//! A sheet of the errors of levels in false colour.

use super::faces::draw_cross;
use crate::analysis::channels::shown_errors;
use crate::analysis::compare::LevelErrors;
use crate::common::error::{Result, wrong};
use crate::common::percent::percent;
use crate::light::chain::Level;
use crate::light::environment::Layout;
use glam::DVec2;
use octagloss_drawing::page::{BAR_WIDTH, colour_bar, page};
use octagloss_drawing::scale::RELATIVE_ERROR;
use octagloss_drawing::scene::{Anchor, Scene};
use octagloss_drawing::style::{GAP, INK, LABEL, LINE, MARGIN, SMALL, SOFT};

/// Edge of a face in pixels.
const FACE: f64 = 96.0;

/// Greatest height of the colour bar in pixels.
const BAR_HEIGHT: f64 = 400.0;

/// Pixels above a cross for its labels.
const LABELS: f64 = 48.0;

/// Draws the relative error of each texel of `levels`, of which each is given with its measured errors, which
/// have the reference: unfolded crosses in false colour beside a colour bar, |difference| / (reference +
/// 0.001 of its mean), of luminance or the channel where it is greatest.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if a level and its reference differ in size or are no cubes, or
/// there is no level.
pub fn error_sheet(title: &str, against: &str, levels: &[(&LevelErrors, Level)]) -> Result<Scene> {
    let errors = levels.iter().map(relative_errors).collect::<Result<Vec<_>>>()?;
    if errors.is_empty() {
        return wrong("an error sheet needs at least one level");
    }
    let columns = (1..=3).find(|n| n * n >= errors.len()).unwrap_or(3);
    let rows = errors.len().div_ceil(columns);
    let cell = DVec2::new(4.0 * FACE + GAP, LABELS + 3.0 * FACE + GAP);
    let caption = format!(
        "Relative error against {against}, of luminance or the channel where it is greatest: |difference| / \
         (reference + 0.001 of its mean); black is no error. A pixel over several texels shows their mean. \
         Faces as stored, unfolded around +Z. relRMSE: root mean square of the difference over the mean of \
         the reference, of luminance and of the worst channel."
    );
    let width = BAR_WIDTH + cell.x * columns as f64 - GAP + 2.0 * MARGIN;
    let (mut scene, body) = page(width, cell.y * rows as f64 - GAP, title, &caption);
    let most =
        errors.iter().flat_map(|errors| &errors.texels).map(|texel| f64::from(texel[0])).fold(0.0, f64::max);
    let mut bar = body;
    bar.low.y += LABELS;
    bar.high.y = bar.high.y.min(bar.low.y + BAR_HEIGHT);
    colour_bar(&mut scene, &bar, &RELATIVE_ERROR, "relative error", [RELATIVE_ERROR.range()[0], most]);
    for (index, ((level, shown), errors)) in levels.iter().zip(&errors).enumerate() {
        let place = DVec2::new((index % columns) as f64, (index / columns) as f64);
        let low = body.low + DVec2::new(BAR_WIDTH, 0.0) + place * cell;
        let head = format!("level {}: roughness {:.3}", level.level, level.roughness);
        scene.text(low + DVec2::new(0.0, LABEL), &head, LABEL, Anchor::Start, INK);
        let greatest = errors.texels.iter().map(|texel| f64::from(texel[0])).fold(0.0, f64::max);
        let worst = level.rmse.worst_channel();
        let (luminance, channel) = (percent(level.rmse.luminance), percent(worst.error));
        let text = format!("relRMSE {luminance}, {} {channel}; greatest {}", worst.of, percent(greatest));
        let second = low.y + LABEL + LINE * SMALL;
        scene.text(DVec2::new(low.x, second), &text, SMALL, Anchor::Start, INK);
        let (size, shown) = (level.size, shown.size());
        let sides =
            if shown == size { format!("{size}\u{b2}") } else { format!("{shown}\u{b2} of {size}\u{b2}") };
        let text = format!("6 \u{d7} {sides} texels");
        let right = low.x + 4.0 * FACE;
        scene.text(DVec2::new(right, second), &text, SMALL, Anchor::End, SOFT);
        let colour = |texel: [f32; 3]| RELATIVE_ERROR.colour(f64::from(texel[0]));
        draw_cross(&mut scene, low + DVec2::new(0.0, LABELS), FACE as u32, errors, colour);
    }
    Ok(scene)
}

/// The relative error of each texel, in all channels.
fn relative_errors((errors, level): &(&LevelErrors, Level)) -> Result<Level> {
    let Some(reference) = &errors.reference else {
        return wrong(format!("level {} was compared with no whole level", errors.level));
    };
    let is_cube = matches!(level.layout, Layout::Cube { size: 1.. });
    if !is_cube || level.layout != reference.layout || level.texels.len() != reference.texels.len() {
        return wrong(format!(
            "cannot show errors of a {:?} against a {:?}; both must be cubes of one size",
            level.layout, reference.layout
        ));
    }
    let got = level.texels.iter().map(|texel| texel.map(f64::from));
    let texels = shown_errors(got, &reference.texels).into_iter().map(|error| [error as f32; 3]).collect();
    Ok(Level { texels, ..level.clone() })
}
