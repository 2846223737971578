//! Octahedral interchange files, read by the `ktx2` and `exr` crates and an independent bilinear look-up.

use exr::prelude as exr_crate;
use exr_crate::ReadChannels as _;
use exr_crate::ReadLayers as _;
use half::f16;
use octagloss_core::files::format::Pixel;
use octagloss_core::files::format::container::Container;
use octagloss_core::files::io::oem_write::oem_bytes;
use octagloss_core::light::chain::Level;
use octagloss_core::light::environment::{Layout, Rgb};
use octagloss_core::light::oem::level_sizes;
use octagloss_fixtures::files::oem_file::{bilinear, directions, levels, oct, read_ktx2, unfolded};
use octagloss_fixtures::files::written::first_difference;

#[test]
fn bilinear_look_ups_never_wrap_and_match_the_unfolded_plane() {
    for (size, count) in [(1, 1), (8, 1), (8, 4), (48, 5), (40, 3)] {
        let levels = levels(size, count, 1);
        let file = oem_bytes(Container::Ktx2, &levels, Pixel::F16, &[]).unwrap();
        let (found, pairs) = read_ktx2(&file);
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
    let (expected, _) = read_ktx2(&oem_bytes(Container::Ktx2, &levels, Pixel::F16, &metadata).unwrap());
    for pixel in [Pixel::F16, Pixel::F32] {
        let bytes = oem_bytes(Container::Exr, &levels, pixel, &metadata).unwrap();
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
