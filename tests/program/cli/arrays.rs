//! `octagloss query` with NumPy arrays: directions from .npy, radiance to .npy.

use super::{Ran, command, done, fails, names, with_sky};
use octagloss_core::files::io::npy;
use octagloss_fixtures::files::inputs;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

const DIRECTIONS: [[f64; 3]; 4] = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.5, -0.25, 2.0], [0.1, 0.2, -0.3]];

/// The directions as an array of doubles, with `roughness` as a fourth column if there is any.
fn doubles(roughness: Option<[f64; 4]>) -> Vec<u8> {
    let rows = DIRECTIONS.iter().enumerate();
    let values = rows.flat_map(|(row, d)| d.iter().copied().chain(roughness.map(|r| r[row])));
    let data: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
    inputs::npy("<f8", false, (4, if roughness.is_some() { 4 } else { 3 }), &data)
}

fn csv(roughness: Option<[f64; 4]>) -> String {
    let rows = DIRECTIONS.iter().enumerate().map(|(row, [x, y, z])| match roughness {
        Some(roughness) => format!("{x},{y},{z},{}\n", roughness[row]),
        None => format!("{x},{y},{z}\n"),
    });
    let more = if roughness.is_some() { ",roughness" } else { "" };
    format!("x,y,z{more}\n{}", rows.collect::<String>())
}

fn query<'a>(directions: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["query", "sky.exr", "--engine", "cpu", "--directions", directions][..], more].concat()
}

fn table(path: &Path, columns: usize) -> Vec<f64> {
    npy::read_table(&fs::read(path).expect("written")[..], &[columns], 100).expect("an array").values
}

#[test]
fn arrays_of_directions_are_answered_as_csv_is() {
    let folder = with_sky();
    let own = Some([0.3, 0.0, 1.0, 0.3]);
    for (roughness, more) in [(None, &["--roughness", "0.5"][..]), (own, &["--bound"])] {
        fs::write(folder.path().join("d.csv"), csv(roughness)).expect("writable");
        fs::write(folder.path().join("d.npy"), doubles(roughness)).expect("writable");
        let text = done(folder.path(), &query("d.csv", more)).out;
        assert_eq!(text.lines().count(), 5, "{text}");
        assert_eq!(done(folder.path(), &query("d.npy", more)).out, text);
        // The content decides, not the name.
        fs::copy(folder.path().join("d.npy"), folder.path().join("array")).expect("writable");
        assert_eq!(done(folder.path(), &query("array", more)).out, text);
    }
}

#[test]
fn float32_of_the_other_byte_and_axis_order_is_the_same() {
    let folder = with_sky();
    let columns = (0..12).map(|k| DIRECTIONS[k % 4][k / 4] as f32);
    let data: Vec<u8> = columns.flat_map(f32::to_be_bytes).collect();
    fs::write(folder.path().join("d.npy"), inputs::npy(">f4", true, (4, 3), &data)).expect("writable");
    let text = done(folder.path(), &query("d.npy", &["--roughness", "0.5"])).out;
    let rows: Vec<&str> = text.lines().skip(1).collect();
    // The shortest text of each float32.
    assert!(rows[3].starts_with("0.1,0.2,-0.3,") && rows[2].starts_with("0.5,-0.25,2,"), "{text}");
    let rounded: String = DIRECTIONS
        .iter()
        .map(|d| d.map(|value| f64::from(value as f32).to_string()).join(",") + "\n")
        .collect();
    fs::write(folder.path().join("d.csv"), format!("x,y,z\n{rounded}")).expect("writable");
    let of_csv = done(folder.path(), &query("d.csv", &["--roughness", "0.5"])).out;
    let answers = |line: &str| line.split(',').skip(3).map(str::to_owned).collect::<Vec<_>>();
    for (row, line) in rows.iter().zip(of_csv.lines().skip(1)) {
        assert_eq!(answers(row), answers(line));
    }
}

#[test]
fn answers_are_written_as_arrays_and_as_csv() {
    let folder = with_sky();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("d.npy"), doubles(Some([0.3, 0.0, 1.0, 0.3]))).expect("writable");
    let text = done(folder.path(), &query("d.npy", &["--bound", "--quiet"])).out;
    let ran = done(folder.path(), &query("d.npy", &["--bound", "-o", "out.npy"]));
    assert_eq!(ran.out, "");
    assert!(ran.err.contains("out.npy: 4 directions, 240 B"), "{}", ran.err);
    let values = table(&at("out.npy"), 7);
    for (row, line) in values.chunks_exact(7).zip(text.lines().skip(1)) {
        let fields: Vec<&str> = line.split(',').skip(4).collect();
        // Mirrors have no bound.
        let number =
            |text: &&str| if text.is_empty() { f64::INFINITY } else { text.parse().expect("a number") };
        let expected: Vec<f64> = fields.iter().map(|text| f64::from(number(text) as f32)).collect();
        assert_eq!(row, expected, "{line}");
    }
    assert!(values[10].is_infinite() && values[3].is_finite(), "{values:?}");
    done(folder.path(), &query("d.npy", &["-o", "plain.NPY", "--quiet"]));
    assert_eq!(table(&at("plain.NPY"), 3).len(), 12);
    done(folder.path(), &query("d.npy", &["--bound", "-o", "out.csv"]));
    assert_eq!(fs::read_to_string(at("out.csv")).expect("written"), text);

    // An existing file stays, and an input is never replaced.
    let before = fs::read(at("out.npy")).expect("written");
    fails(folder.path(), &query("d.npy", &["-o", "out.npy"]), 1, "out.npy");
    assert_eq!(fs::read(at("out.npy")).expect("still there"), before);
    done(folder.path(), &query("d.npy", &["-o", "out.npy", "--force", "--quiet"]));
    assert_eq!(table(&at("out.npy"), 3).len(), 12);
    fails(folder.path(), &query("d.npy", &["-o", "d.npy", "--force"]), 2, "d.npy is an input");
}

#[test]
fn no_directions_are_no_answers() {
    let folder = with_sky();
    fs::write(folder.path().join("d.npy"), inputs::npy("<f4", false, (0, 3), b"")).expect("writable");
    let args = query("d.npy", &["--roughness", "0.5", "-o", "out.npy", "--quiet"]);
    done(folder.path(), &args);
    assert!(table(&folder.path().join("out.npy"), 3).is_empty());
}

#[test]
fn standard_input_may_be_an_array() {
    let folder = with_sky();
    let mut command = command(folder.path(), &query("-", &["--roughness", "0.5", "--quiet"]));
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("starts");
    child.stdin.take().expect("piped").write_all(&doubles(None)).expect("written");
    let output = child.wait_with_output().expect("ends");
    let text = String::from_utf8(output.stdout).expect("text");
    let ran = Ran { code: output.status.code().expect("no signal"), out: text, err: String::new() };
    assert_eq!((ran.code, ran.out.lines().count()), (0, 5), "{}", ran.out);
}

#[test]
fn wrong_arrays_are_named_and_nothing_is_written() {
    let folder = with_sky();
    let before = names(folder.path());
    let numbers = |values: &[f64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let array = |columns: usize, values: &[f64]| {
        inputs::npy("<f8", false, (values.len() / columns, columns), &numbers(values))
    };
    let cases: [(Vec<u8>, &str); 10] = [
        (array(3, &[1.0, 0.0, 0.0, 0.0, f64::NAN, 1.0]), "row [1]: y is NaN; it must be finite"),
        (array(4, &[1.0, 0.0, 0.0, f64::INFINITY]), "row [0]: roughness is inf; it must be finite"),
        (array(4, &[1.0, 0.0, 0.0, 1.5]), "row [0]: roughness is 1.5; it must be between 0 and 1"),
        (array(3, &[0.0; 3]), "row [0]: 0,0,0 is not a direction"),
        (array(2, &[0.0; 4]), "its shape is (2, 2); (N, 3) or (N, 4) is needed"),
        (inputs::npy("<i4", false, (1, 3), &[0; 12]), "its type is \"<i4\"; float32 or float64 is needed"),
        (inputs::npy("<f4", false, (2, 3), &[0; 12]), "truncated: 12 of the 24 bytes"),
        (inputs::npy("<f4", false, (4_000_001, 3), &[]), "more than 4000000 rows, split the array"),
        (b"\x93NUMPY\x01".to_vec(), "truncated within its header"),
        (b"PK\x03\x04and more".to_vec(), "a ZIP file such as .npz; save one array with numpy.save"),
    ];
    let file = tempfile::NamedTempFile::new().expect("a file");
    let path = file.path().to_str().expect("text");
    for (bytes, words) in cases {
        fs::write(path, bytes).expect("writable");
        let roughness = if words.contains("roughness") {
            &["-o", "o.npy"][..]
        } else {
            &["--roughness", "0", "-o", "o.npy"]
        };
        fails(folder.path(), &query(path, roughness), 1, words);
        assert_eq!(names(folder.path()), before, "{words}");
    }
    fails(folder.path(), &query(path, &["-o", "out.txt"]), 2, "must end in .csv or .npy");
    fails(folder.path(), &query(path, &["-o", "-"]), 2, "omit -o");
    fails(folder.path(), &query(path, &["-o", "no/such/out.npy"]), 1, "no/such");
}
