//! Octahedral interchange files, read by the `ktx2` and `exr` crates and an independent bilinear look-up.

use crate::support::common::{Random, landmarks};
use crate::support::written::first_difference;
use exr::prelude as exr_crate;
use exr_crate::ReadChannels as _;
use exr_crate::ReadLayers as _;
use glam::{DVec2, DVec3};
use half::f16;
use octagloss::internals::chain::Level;
use octagloss::internals::format::Pixel;
use octagloss::internals::format::container::Container;
use octagloss::internals::io::oem_write::oem_bytes;
use octagloss::internals::oem::level_sizes;
use octagloss::{Layout, Rgb};

/// Returns `count` octahedral levels from `size` down, of random half floats.
pub(crate) fn levels(size: u32, count: u32, seed: u64) -> Vec<Level> {
    let mut random = Random::new(seed);
    let mut texel = || [(); 3].map(|()| f16::from_f64(random.unit()).to_f32());
    (0..count)
        .map(|l| Level {
            layout: Layout::Octahedral { size: size >> l },
            roughness: f64::from(l) / f64::from((count - 1).max(1)),
            texels: (0..(size >> l).pow(2)).map(|_| texel()).collect(),
            bounds: None,
        })
        .collect()
}

/// Side and texels of a level of half floats.
pub(crate) type ReadLevel = (u32, Vec<[f16; 4]>);

/// Returns the levels of a 2D KTX2 file of half floats, and its key/value pairs.
pub(crate) fn read_ktx2(bytes: &[u8]) -> (Vec<ReadLevel>, Vec<(String, String)>) {
    let reader = ktx2::Reader::new(bytes).unwrap();
    let header = reader.header();
    assert_eq!((header.face_count, header.layer_count, header.pixel_depth), (1, 0, 0));
    assert_eq!(header.format, Some(ktx2::Format::R16G16B16A16_SFLOAT));
    let level = |(index, level): (usize, ktx2::Level<'_>)| {
        let side = header.pixel_width >> index;
        let data = zstd::bulk::decompress(level.data, level.uncompressed_byte_length as usize).unwrap();
        assert_eq!(data.len() as u32, side * side * 8);
        let half = |t: &[u8], c: usize| f16::from_le_bytes([t[2 * c], t[2 * c + 1]]);
        (side, data.chunks_exact(8).map(|t| [0, 1, 2, 3].map(|c| half(t, c))).collect())
    };
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap().trim_end_matches('\0').to_owned();
    let pairs = reader.key_value_data().map(|(key, value)| (key.to_owned(), text(value))).collect();
    (reader.levels().enumerate().map(level).collect(), pairs)
}

/// Returns octahedral coordinates by the rule in the file's metadata.
fn oct(d: DVec3) -> DVec2 {
    let p = d / (d.x.abs() + d.y.abs() + d.z.abs());
    let s = |t: f64| if t >= 0.0 { 1.0 } else { -1.0 };
    if p.y >= 0.0 {
        DVec2::new(p.x, p.z)
    } else {
        DVec2::new((1.0 - p.z.abs()) * s(p.x), (1.0 - p.x.abs()) * s(p.z))
    }
}

/// Interpolates `image` (`side` x `side`) bilinearly at `place`, in texels; fails if that would wrap.
pub(crate) fn bilinear(side: u32, place: DVec2, texel: impl Fn(u32, u32) -> [f64; 3]) -> [f64; 3] {
    let at = place - 0.5;
    let low = at.floor();
    assert!(
        low.min_element() >= 0.0 && low.max_element() + 1.0 < f64::from(side),
        "{place} of {side} asks to wrap"
    );
    let f = at - low;
    let (x, y) = (low.x as u32, low.y as u32);
    let mix = |a: [f64; 3], b: [f64; 3], t: f64| std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t);
    mix(mix(texel(x, y), texel(x + 1, y), f.x), mix(texel(x, y + 1), texel(x + 1, y + 1), f.x), f.y)
}

/// Looks up `direction` in the unfolded plane, using the square alone: finds texels beyond an edge by
/// stepping over the sphere, from the centre of a texel across the edge.
pub(crate) fn unfolded(level: &Level, direction: DVec3) -> [f64; 3] {
    let n = level.layout.sides().0;
    let texel = |x: u32, y: u32| {
        // Remove the border of one texel.
        let (x, y) = (f64::from(x) - 1.0, f64::from(y) - 1.0);
        let mut uv = (DVec2::new(x, y) + 0.5) * (2.0 / f64::from(n)) - 1.0;
        // Across u = 1: (u, v) -> (2 - u, -v), and so on for the other edges.
        for _ in 0..2 {
            if uv.x.abs() > 1.0 {
                uv = DVec2::new(2.0 * uv.x.signum() - uv.x, -uv.y);
            }
            if uv.y.abs() > 1.0 {
                uv = DVec2::new(-uv.x, 2.0 * uv.y.signum() - uv.y);
            }
        }
        let place = ((uv + 1.0) / 2.0 * f64::from(n)).floor();
        level.texels[place.y as usize * n as usize + place.x as usize].map(f64::from)
    };
    bilinear(n + 2, (oct(direction) + 1.0) / 2.0 * f64::from(n) + 1.0, texel)
}

/// Returns directions on and near every fold, edge midpoint, corner and pole, and anywhere.
pub(crate) fn directions() -> Vec<DVec3> {
    let mut random = Random::new(17);
    let mut all = landmarks();
    for landmark in landmarks() {
        for scale in [1e-3, 0.02, 0.2] {
            all.extend((0..4).map(|_| (landmark + random.direction() * scale).normalize()));
        }
    }
    // The lower half's folds lie over x = 0 and z = 0, the square's edges.
    for k in 0..100 {
        let angle = f64::from(k) * 0.0631;
        all.push(DVec3::new(angle.sin(), angle.cos(), 0.0));
        all.push(DVec3::new(0.0, angle.cos(), angle.sin()));
    }
    all.extend((0..200).map(|_| random.direction()));
    all
}

#[test]
fn bilinear_look_ups_never_wrap_and_match_the_unfolded_plane() {
    for (size, count) in [(1, 1), (8, 1), (8, 4), (48, 5), (40, 3)] {
        let levels = levels(size, count, 1);
        let file = oem_bytes(Container::Ktx2, &levels, Pixel::F16, &[]).unwrap();
        let (found, pairs) = read_ktx2(&file.bytes);
        let text = |key: &str| pairs.iter().find(|(name, _)| name == key).expect(key).1.clone();
        let numbers = |key| text(key).split(',').map(|n| n.parse::<u32>().unwrap()).collect::<Vec<_>>();
        let (interior, borders) = (numbers("octaglossInterior"), numbers("octaglossBorder"));
        assert_eq!(
            (found.len(), interior.len(), borders.len()),
            (count as usize, count as usize, count as usize)
        );
        assert_eq!(*borders.last().unwrap(), 1);
        for key in ["octaglossFold", "octaglossUp", "octaglossBorderRule", "octaglossTexelCentres"] {
            assert!(text(key).len() > 30, "{key}");
        }
        for (index, (side, texels)) in found.iter().enumerate() {
            let (n, border) = (interior[index], borders[index]);
            assert_eq!((*side, n), (n + 2 * border, size >> index));
            // The border's share of the side is the same at every level: one mapping.
            assert_eq!(u64::from(border) * u64::from(found[0].0), u64::from(borders[0]) * u64::from(*side));
            let texel = |x: u32, y: u32| {
                let [r, g, b, a] = texels[(y * side + x) as usize];
                assert_eq!(a, f16::ONE);
                [r, g, b].map(f64::from)
            };
            for direction in directions() {
                let place = (oct(direction) + 1.0) / 2.0 * f64::from(n) + f64::from(border);
                let shown = bilinear(*side, place, texel);
                let expected = unfolded(&levels[index], direction);
                let off = (0..3).map(|c| (shown[c] - expected[c]).abs()).fold(0.0, f64::max);
                assert!(off < 1e-9, "{size} level {index} {direction}: {shown:?} for {expected:?}");
            }
        }
    }
}

#[test]
fn a_clamped_border_is_detected() {
    let levels = levels(16, 1, 2);
    let n = 16;
    let clamped = |x: u32, y: u32| {
        let (x, y) = (x.clamp(1, n) - 1, y.clamp(1, n) - 1);
        levels[0].texels[(y * n + x) as usize].map(f64::from)
    };
    let off = directions().into_iter().map(|direction| {
        let shown = bilinear(n + 2, (oct(direction) + 1.0) / 2.0 * f64::from(n) + 1.0, clamped);
        let expected = unfolded(&levels[0], direction);
        (0..3).map(|c| (shown[c] - expected[c]).abs()).fold(0.0, f64::max)
    });
    assert!(off.fold(0.0, f64::max) > 0.2);
}

#[test]
fn exr_parts_are_the_levels_of_the_ktx2() {
    let levels = levels(24, 4, 3);
    let metadata = [("octaglossLobe".to_owned(), "ggx".to_owned())];
    let (expected, _) = read_ktx2(&oem_bytes(Container::Ktx2, &levels, Pixel::F16, &metadata).unwrap().bytes);
    for pixel in [Pixel::F16, Pixel::F32] {
        let bytes = oem_bytes(Container::Exr, &levels, pixel, &metadata).unwrap().bytes;
        let image = exr_crate::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_buffered(std::io::Cursor::new(&bytes))
            .unwrap();
        assert_eq!(image.layer_data.len(), 4);
        for (index, (layer, (side, texels))) in image.layer_data.iter().zip(&expected).enumerate() {
            assert_eq!(layer.attributes.layer_name.as_ref().unwrap().to_string(), format!("m{index}"));
            assert_eq!((layer.size.x() as u32, layer.size.y() as u32), (*side, *side));
            let attribute = |name: &str| {
                layer.attributes.other.iter().find(|(key, _)| **key == *name).map(|(_, value)| value.clone())
            };
            assert!(attribute("octaglossBorder").is_some() && attribute("octaglossLobe").is_some());
            let roughness = exr_crate::AttributeValue::F32(levels[index].roughness as f32);
            assert_eq!(attribute("roughness"), Some(roughness));
            let found: Vec<Rgb> = {
                let channel = |name: &str| {
                    let channel = layer.channel_data.list.iter().find(|c| c.name == *name).unwrap();
                    channel.sample_data.values_as_f32().collect::<Vec<_>>()
                };
                let (r, g, b) = (channel("R"), channel("G"), channel("B"));
                r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect()
            };
            let expected: Vec<Rgb> =
                texels.iter().map(|[r, g, b, _]| [r, g, b].map(|c| c.to_f32())).collect();
            assert_eq!(first_difference(&found, &expected), None, "level {index} {pixel:?}");
        }
    }
}

#[test]
fn impossible_maps_are_refused() {
    let words = |size, count| level_sizes(size, count).unwrap_err().to_string();
    assert!(words(100, 4).contains("choose a multiple of 8"), "{}", words(100, 4));
    assert!(
        words(8, 0).contains("`size` 8")
            && words(0, 1).contains("`size` 0")
            && words(8, 40).contains("halve")
    );
    let good = levels(8, 2, 4);
    let refused = |container, levels: &[Level], pixel| {
        oem_bytes(container, levels, pixel, &[]).map(|_| ()).unwrap_err().to_string()
    };
    assert!(refused(Container::Dds, &good, Pixel::F16).contains("ktx2 or exr"));
    assert!(refused(Container::Exr, &good, Pixel::Rgb9e5).contains("rgb9e5"));
    let mut uneven = good;
    uneven[1].layout = Layout::Octahedral { size: 2 };
    assert!(refused(Container::Ktx2, &uneven, Pixel::F16).contains("level 1"));
    assert!(refused(Container::Ktx2, &[], Pixel::F16).contains("`size` 0"));
}
