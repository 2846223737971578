//! Files of the DFG table.

use half::f16;
use octagloss_core::bake::dfg::{DfgBlue, DfgForm, dfg_table};
use octagloss_core::files::io::ktx2::lookup_table::{Channels, table_bytes};
use std::process::Command;

/// Returns vkFormat and texels of a KTX2 table, read by the specification's offsets.
fn parse(bytes: &[u8], channels: usize) -> (u32, Vec<Vec<f32>>) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let long = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    assert!(bytes.starts_with(b"\xabKTX 20\xbb\r\n\x1a\n"));
    let size = word(20);
    assert_eq!((word(24), word(28), word(32), word(36), word(40), word(44)), (size, 0, 0, 1, 1, 2));
    assert_eq!((word(48) as usize, word(56)), (80 + 24, word(48) + word(52)), "sections follow one another");
    assert_eq!(long(80), (word(56) + word(60)) as usize);
    assert_eq!(long(80) + long(88), bytes.len());
    let data = zstd::bulk::decompress(&bytes[long(80)..], long(96)).unwrap();
    assert_eq!(data.len(), (size * size) as usize * channels * 2);
    let half = |b: &[u8]| f16::from_le_bytes([b[0], b[1]]).to_f32();
    (word(12), data.chunks_exact(2 * channels).map(|t| t.chunks_exact(2).map(half).collect()).collect())
}

#[test]
fn tables_come_back_as_half_floats() {
    let table = dfg_table(16, DfgForm::SplitSum, DfgBlue::Charlie).unwrap();
    for (channels, count, vk_format) in [(Channels::Two, 2, 83), (Channels::Four, 4, 97)] {
        let bytes = table_bytes(16, &table.texels, channels, "a table").unwrap();
        let (format, texels) = parse(&bytes, count);
        assert_eq!((format, texels.len()), (vk_format, 256));
        for (stored, exact) in texels.iter().zip(&table.texels) {
            let expected: Vec<f32> = exact.iter().chain([&1.0]).map(|v| f16::from_f32(*v).to_f32()).collect();
            assert_eq!(stored[..2], expected[..2]);
            assert!(count == 2 || *stored == expected, "{stored:?} {expected:?}");
        }
        let reader = ktx2::Reader::new(&bytes).unwrap();
        assert_eq!(reader.header().face_count, 1);
    }
    assert!(table_bytes(15, &table.texels, Channels::Two, "").is_err());
}

#[test]
fn the_program_writes_tables_and_refuses_what_it_cannot() {
    let folder = tempfile::TempDir::new().unwrap();
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_octagloss"));
        command.current_dir(folder.path()).arg("dfg").args(args).output().unwrap()
    };
    assert!(run(&["-o", "a.ktx2", "--size", "8", "--charlie", "--quiet"]).status.success());
    let (_, texels) = parse(&std::fs::read(folder.path().join("a.ktx2")).unwrap(), 4);
    // Rows are roughness. In the rightmost column, the first is nearly a mirror, the last far from it.
    let white = |at: usize| texels[at][0] + texels[at][1];
    assert!(white(7) > 0.99 && white(63) < 0.75, "{} {}", white(7), white(63));
    assert!(
        run(&["-o", "a.exr", "--size", "8", "--form", "multiple-scattering", "--quiet"]).status.success()
    );
    assert_eq!(run(&["-o", "a.exr"]).status.code(), Some(1), "the file exists already");
    assert_eq!(run(&["-o", "a.png"]).status.code(), Some(2));
    assert_eq!(run(&["-o", "b.exr", "--size", "0"]).status.code(), Some(2));
}
