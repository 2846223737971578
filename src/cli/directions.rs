//! Directions of `octagloss query --directions`, with or without a roughness each.

use super::rows::Kind;
use crate::queries::unit;
use anyhow::{anyhow, bail};
use glam::DVec3;

/// A unit vector, and its roughness if the rows have that column.
pub type Direction = (DVec3, Option<f64>);

/// The rows of `--directions`.
pub const DIRECTIONS: Kind<Direction> = Kind {
    columns: &["x", "y", "z", "roughness"],
    required: 3,
    plural: "directions",
    parse: |values| {
        let roughness = values.get(3).copied();
        if let Some(roughness) = roughness.filter(|roughness| !(0.0..=1.0).contains(roughness)) {
            bail!("roughness is {roughness}; it must be between 0 and 1");
        }
        let direction = unit(DVec3::new(values[0], values[1], values[2]));
        Ok((direction.ok_or_else(|| anyhow!("0,0,0 is not a direction"))?, roughness))
    },
};

#[cfg(test)]
mod tests {
    use super::super::rows::{LIMITS, Limits};
    use super::DIRECTIONS;

    fn error(text: &[u8], limits: Limits) -> String {
        match DIRECTIONS.read_from(text, limits) {
            Ok(read) => panic!("{} directions were read", read.values.len()),
            Err(error) => format!("{error:#}"),
        }
    }

    #[test]
    fn limits_stop_what_has_no_end() {
        let few = Limits { rows: 2, bytes: 30, line: 10 };
        assert_eq!(DIRECTIONS.read_from(&b"x,y,z\n1,0,0\n0,1,0\n"[..], few).expect("within").values.len(), 2);
        let rows = error(b"x,y,z\n1,0,0\n0,1,0\n0,0,1\n", few);
        assert_eq!(rows, "more than 2 directions, at line 4; split the file");
        let endless = DIRECTIONS.read_from(std::io::repeat(0), LIMITS).err().expect("no end").to_string();
        assert_eq!(endless, "line 1 is longer than 1000 bytes; a line is x,y,z");
        let lines = DIRECTIONS.read_from(std::io::repeat(b'\n'), Limits { bytes: 100_000, ..LIMITS });
        let lines = lines.err().expect("no end").to_string();
        assert!(lines.starts_with("more than 100000 bytes, at line "), "{lines}");
    }

    #[test]
    fn rows_may_have_a_roughness() {
        let read =
            DIRECTIONS.read_from(&b"x,y,z,roughness\n1,0,0, .25\n0,2,0,1\n"[..], LIMITS).expect("two rows");
        assert!(read.is_full);
        assert_eq!(read.typed, ["1,0,0,.25", "0,2,0,1"]);
        let roughness: Vec<_> = read.values.iter().map(|(_, roughness)| *roughness).collect();
        assert_eq!(roughness, [Some(0.25), Some(1.0)]);
        assert!(!DIRECTIONS.read_from(&b"x,y,z\n"[..], LIMITS).expect("no rows").is_full);
        for (text, words) in [
            ("x,y,z,roughness\n1,0,0\n", "line 2 has 3 values; its header has 4"),
            ("x,y,z\n1,0,0,1\n", "line 2 has 4 values; its header has 3"),
            ("x,y,z,roughness\n1,0,0,1.5\n", "line 2: roughness is 1.5; it must be between 0 and 1"),
            ("x,y,z,roughness\n1,0,0,nan\n", "line 2: roughness is NaN; it must be finite"),
            ("x,y,z,r\n", "line 1 is \"x,y,z,r\"; the header must be x,y,z or x,y,z,roughness"),
        ] {
            assert_eq!(error(text.as_bytes(), LIMITS), words);
        }
    }

    #[test]
    fn wrong_values_are_quoted_and_cut() {
        let text = format!("x,y,z\n1,\u{1b}[31m{},0\n", "9x".repeat(400));
        let error = error(text.as_bytes(), LIMITS);
        assert!(error.starts_with(r#"line 2: y is "\u{1b}[31m9x9x"#), "{error}");
        assert!(error.ends_with("(805 bytes), not a number") && error.len() < 120, "{error}");
    }
}
