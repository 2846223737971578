//! `octagloss query` with a roughness in every row.

use super::{done, fails, octagloss, with_sky};
use std::fs;

#[test]
fn each_row_is_answered_with_its_own_roughness() {
    let folder = with_sky();
    let rows = [("0,1,0", 0.3), ("1,0,0", 1.0), ("0,1,0", 0.0), ("0,0,2", 0.3), ("0,1,0", 1.0)];
    let text: String = rows.iter().map(|(row, roughness)| format!("{row},{roughness}\n")).collect();
    fs::write(folder.path().join("own.csv"), format!("x,y,z,roughness\n{text}")).expect("writable");
    let text: String = rows.iter().map(|(row, _)| format!("{row}\n")).collect();
    fs::write(folder.path().join("plain.csv"), format!("x,y,z\n{text}")).expect("writable");
    // One table for all, so that it is the same in both.
    let query = |csv: &str, more: &[&str]| {
        let args = ["query", "sky.exr", "--oem-size", "128", "--bound", "--quiet", "--directions", csv];
        let out = done(folder.path(), &[&args[..], more].concat()).out;
        out.lines().map(str::to_owned).collect::<Vec<String>>()
    };
    let own = query("own.csv", &[]);
    assert_eq!((own.len(), &own[0][..]), (6, "x,y,z,roughness,r,g,b,bound,bound_r,bound_g,bound_b"));
    for (index, (row, roughness)) in rows.iter().enumerate() {
        let roughness = roughness.to_string();
        let plain = query("plain.csv", &["--roughness", &roughness]);
        let answer = plain[index + 1].strip_prefix(row).expect("the direction first");
        assert_eq!(own[index + 1], format!("{row},{roughness}{answer}"));
    }
}

#[test]
fn a_roughness_is_given_once() {
    let folder = with_sky();
    fs::write(folder.path().join("own.csv"), "x,y,z,roughness\n0,1,0,0.5\n").expect("writable");
    fs::write(folder.path().join("plain.csv"), "x,y,z\n0,1,0\n").expect("writable");
    fs::write(folder.path().join("bad.csv"), "x,y,z,roughness\n0,1,0,2\n").expect("writable");
    let query = |csv: &'static str, more: &[&'static str]| {
        [&["query", "sky.exr", "--quiet", "--directions", csv], more].concat()
    };
    fails(folder.path(), &query("own.csv", &["--roughness", "0.5"]), 2, "omit one");
    fails(folder.path(), &query("own.csv", &["--lobe", "cosine"]), 2, "omit the column");
    fails(folder.path(), &query("plain.csv", &[]), 2, "--directions is required");
    fails(folder.path(), &query("bad.csv", &[]), 1, "line 2: roughness is 2; it must be between 0 and 1");
    assert_eq!(octagloss(folder.path(), &query("plain.csv", &["--lobe", "cosine"])).code, 0);
}
