//! Constants and struct layouts that shaders declare a second time, by the declaring file. A test compares
//! them with the shader compiler's reflection and fails on entries that are missing here.

use super::{
    adaptive, blur, box_filter, cells, copy, device::stage, direct, emitters, fitted, fixed_point, harmonics,
    lamp, mirror, octaves, oem, reparameterise, sat_f32, sat_hensley, sat_scan, shadow,
};
use crate::cpu::adaptive::{TINT_ROUNDING, USELESS};
use crate::cpu::cells::{DIMMEST, FAINT, FIELDS, QUAD_FIELDS, RESIDUE};
use crate::cpu::fitted::{CONE, CONE_ALPHA, HARMONICS_ALONE, HARMONICS_FROM};
use crate::cpu::leaves::LANES;
use crate::cpu::leaves::NEGLIGIBLE_TINT;
use crate::cpu::subtexel::SMOOTH_SIDE;
use crate::environment::LUMINANCE;
use crate::geometry::source_texels::{CUBE, PANORAMA};
use crate::geometry::tint::TINT_FIELDS;
use crate::lobe::kernel::shape;
use crate::lobe::profiles::NOTHING;
use crate::realtime::emitters::{COUNT, GRID};
use crate::realtime::tables::{KNOTS, OCTAVES, triangle};

/// A constant: the file under `shaders/` that declares it, its name there, and the values in Rust.
pub type Constant = (&'static str, &'static str, Vec<f64>);

/// A struct: the file under `shaders/` that declares it, its name there, and the member names, offsets and
/// size of the Rust struct, in bytes.
pub type Struct = (&'static str, &'static str, &'static [(&'static str, usize)], usize);

/// Constants that the stages' shaders share with Rust.
#[must_use]
pub fn constants() -> Vec<Constant> {
    let one = |file, name, value: u32| (file, name, vec![f64::from(value)]);
    let float = |file, name, value: f64| (file, name, vec![value]);
    let mut all = vec![
        one("adaptive.wgsl", "LANES", LANES as u32),
        one("adaptive.wgsl", "GROUP_SIZE", adaptive::GROUP_SIZE),
        one("adaptive.wgsl", "LEVELS", adaptive::LEVELS as u32),
        one("adaptive.wgsl", "INCOMPLETE", adaptive::INCOMPLETE),
        float("adaptive.wgsl", "SMOOTH_SIDE", SMOOTH_SIDE),
        one("common/source_pieces.wgsl", "PANORAMA", PANORAMA),
        one("common/source_pieces.wgsl", "CUBE", CUBE),
        one("blur.wgsl", "EDGE", octaves::EDGE),
        one("blur.wgsl", "GROUP_SIZE", blur::GROUP_SIZE),
        float("adaptive.wgsl", "DIMMEST", DIMMEST),
        one("blur.wgsl", "LINE_SIZE", blur::LINE_SIZE),
        one("blur.wgsl", "REACH", blur::REACH),
        one("box_filter.wgsl", "GROUP_SIZE", box_filter::GROUP_SIZE),
        one("cells.wgsl", "EDGE", cells::EDGE),
        float("cells.wgsl", "FAINT", f64::from(FAINT)),
        float("cells.wgsl", "RESIDUE", f64::from(RESIDUE)),
        float("common/charlie.wgsl", "NOTHING", f64::from(NOTHING)),
        one("common/fitted.wgsl", "FIRST_OCTAVE", *OCTAVES.start()),
        float("common/fitted.wgsl", "FIRST_KNOT", KNOTS[0]),
        float("common/fitted.wgsl", "KNOT_STEP", KNOTS[1] - KNOTS[0]),
        float("common/fitted.wgsl", "OVERLAP", KNOTS[3] - KNOTS[0] - 1.0),
        float("common/fitted.wgsl", "HARMONICS_ALONE", HARMONICS_ALONE),
        float("common/fitted.wgsl", "HARMONICS_FROM", HARMONICS_FROM),
        float("common/fitted.wgsl", "CONE_REACH", triangle::CONE_REACH),
        float("common/fitted.wgsl", "CONE_FROM", CONE[0]),
        float("common/fitted.wgsl", "CONE_UNTIL", CONE[1]),
        float("common/fitted.wgsl", "CONE_SHARP", CONE_ALPHA[0]),
        float("common/fitted.wgsl", "CONE_ROUGH", CONE_ALPHA[1]),
        one("common/fitted.wgsl", "KNOTS", KNOTS.len() as u32),
        float("common/fitted.wgsl", "PEAK_FROM", fitted::PEAK_FROM),
        one("common/kernel.wgsl", "SHAPE_GGX", shape::GGX),
        one("common/kernel.wgsl", "SHAPE_PHONG", shape::PHONG),
        one("common/kernel.wgsl", "SHAPE_WIDE_PHONG", shape::WIDE_PHONG),
        one("common/kernel.wgsl", "SHAPE_CONE", shape::CONE),
        one("common/kernel.wgsl", "SHAPE_COSINE", shape::COSINE),
        one("common/light.wgsl", "EMITTERS", COUNT as u32),
        one("common/light.wgsl", "MAX_LIGHTS", fitted::MAX_LIGHTS),
        ("common/luminance.wgsl", "LUMINANCE", LUMINANCE.map(f64::from).to_vec()),
        one("common/octaves.wgsl", "OCTAVE_BORDER", octaves::BORDER),
        one("common/quad.wgsl", "QUAD_FIELDS", QUAD_FIELDS as u32),
        one("common/quad.wgsl", "TINT_FIELDS", TINT_FIELDS as u32),
        one("common/reduction.wgsl", "GROUPS", fixed_point::GROUPS),
        one("common/reduction.wgsl", "GROUP_SIZE", fixed_point::GROUP_SIZE),
        one("common/reduction.wgsl", "TEXELS", fixed_point::TEXELS),
        one("common/rows.wgsl", "ROW", stage::ROW),
        float("common/tints.wgsl", "NEGLIGIBLE_TINT", f64::from(NEGLIGIBLE_TINT)),
        // The GPU's differences are less exact.
        float("common/tints.wgsl", "TINT_ROUNDING", 2.0 * f64::from(TINT_ROUNDING)),
        float("common/tints.wgsl", "USELESS", f64::from(USELESS)),
        one("copy.wgsl", "GROUP_SIZE", copy::GROUP_SIZE),
        one("direct/cull.wgsl", "GROUP_SIZE", direct::list::GROUP_SIZE),
        one("direct/cull.wgsl", "PLANES", direct::view::PLANES as u32),
        one("direct/cull.wgsl", "VIEWS", direct::view::VIEWS as u32),
        one("direct/offsets.wgsl", "GROUP_SIZE", direct::list::GROUP_SIZE),
        one("direct/split.wgsl", "CUT_EDGES", direct::list::Cut::Edges as u32),
        one("direct/split.wgsl", "CUT_OCTANTS", direct::list::Cut::Octants as u32),
        one("direct/split.wgsl", "GROUP_SIZE", direct::list::GROUP_SIZE),
        one("direct/split.wgsl", "PIECES", direct::list::PIECES),
        one("direct/unwrap.wgsl", "BY_ALPHA", direct::unwrap::Remedy::Alpha as u32),
        one("direct/unwrap.wgsl", "DROP", direct::unwrap::Remedy::Drop as u32),
        one("direct/unwrap.wgsl", "ONE_SIDE", direct::unwrap::Remedy::OneSide as u32),
        one("emitters.wgsl", "BATCH", emitters::BATCH),
        one("emitters.wgsl", "EDGE", emitters::EDGE),
        one("emitters.wgsl", "GRID", GRID),
        one("emitters.wgsl", "GROUP_SIZE", emitters::GROUP_SIZE),
        one("emitters.wgsl", "KEPT", emitters::KEPT),
        one("fitted.wgsl", "GROUP_SIZE", fitted::GROUP_SIZE),
        one("harmonics.wgsl", "BATCHES", harmonics::BATCHES),
        one("harmonics.wgsl", "COUNT", crate::sh::MAX_COUNT as u32),
        one("harmonics.wgsl", "FINEST", harmonics::FINEST),
        one("harmonics.wgsl", "GROUP_SIZE", harmonics::GROUP_SIZE),
        one("lamp.wgsl", "EDGE", lamp::EDGE),
        one("lamp.wgsl", "PLACES", lamp::PLACES),
        one("mirror.wgsl", "EDGE", mirror::EDGE),
        one("pack.wgsl", "EDGE", box_filter::EDGE),
        one("reparameterise.wgsl", "EDGE", reparameterise::EDGE),
        one("reparameterise.wgsl", "GROUP_SIZE", reparameterise::GROUP_SIZE),
        one("sat_f32.wgsl", "EDGE", sat_f32::EDGE),
        one("sat_f32.wgsl", "GROUPS", sat_f32::GROUPS),
        one("sat_scan.wgsl", "GROUP_SIZE", sat_scan::GROUP_SIZE),
        one("sat_scan.wgsl", "TILE", sat_scan::TILE),
    ];
    all.extend(FIELDS.map(|(name, field)| one("common/quad.wgsl", name, field as u32)));
    all
}

/// Structs of uniforms and buffers that the stages' shaders share with Rust.
#[must_use]
pub fn structs() -> Vec<Struct> {
    macro_rules! layout {
        ($file:literal, $name:literal, $rust:ty) => {
            ($file, $name, <$rust>::MEMBERS, size_of::<$rust>())
        };
    }
    vec![
        layout!("adaptive.wgsl", "Lobe", adaptive::Lobe),
        layout!("adaptive.wgsl", "Packet", adaptive::Packet),
        layout!("cells.wgsl", "Level", cells::CellLevel),
        layout!("cells.wgsl", "Tent", cells::Tent),
        layout!("common/direct.wgsl", "Corner", crate::direct::Corner),
        layout!("common/direct_view.wgsl", "OctaglossView", direct::view::View),
        layout!("common/light.wgsl", "OctaglossEmitter", fitted::EmitterWords),
        // Least radiance, two vectors of units, 25 harmonics, emitters, a rotation.
        (
            "common/light.wgsl",
            "OctaglossLight",
            &[
                ("least", 0),
                ("scale", 16),
                ("harmonics", 48),
                ("emitters", 448),
                ("world_from_source", fitted::ROTATION_OFFSET as usize),
            ],
            fitted::LIGHT as usize,
        ),
        layout!("common/octaves.wgsl", "OctaglossModel", fitted::Model),
        layout!("common/octaves.wgsl", "OctaglossOctave", octaves::Octave),
        layout!("common/octaves.wgsl", "OctaglossOctaves", fitted::Octaves),
        // Four exponents, then the sizes, in a header of 32 bytes.
        ("common/sat.wgsl", "OctaglossTable", &[("exponents", 0), ("inner", 16), ("border", 20)], 32),
        // Four low words and four high ones.
        layout!("common/shadow.wgsl", "OctaglossShadow", shadow::Shadow),
        ("common/sum.wgsl", "Sum", &[("low", 0), ("high", 16)], 32),
        layout!("common/table.wgsl", "Table", oem::Table),
        layout!("direct/cull.wgsl", "Cull", direct::list::Cull),
        layout!("direct/offsets.wgsl", "Offsets", direct::list::Offsets),
        layout!("direct/split.wgsl", "Split", direct::list::Split),
        layout!("direct/unwrap.wgsl", "Panel", direct::unwrap::Panel),
        // Four greatest patterns and four 64-bit sums.
        ("fixed_point.wgsl", "Partial", &[("greatest", 0), ("sums", 16)], 48),
        layout!("lamp.wgsl", "Lamp", lamp::Lamp),
        layout!("reparameterise.wgsl", "Gather", reparameterise::Gather),
        layout!("sat_f32.wgsl", "Doubling", sat_f32::Doubling),
        layout!("sat_hensley.wgsl", "Doubling", sat_hensley::Doubling),
        layout!("sat_scan.wgsl", "Scan", sat_scan::Scan),
    ]
}
