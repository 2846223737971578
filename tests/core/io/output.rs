//! Outputs appear whole or not at all, and never replace foreign files.

use octagloss_core::common::error::Result;
use octagloss_core::files::format::Pixel;
use octagloss_core::files::io::ktx2::write::ktx2_bytes;
use octagloss_core::files::io::output::{Existing, commit, stage_folder, write_file};
use octagloss_fixtures::files::written::{chain, names_in};
use std::fs;
use std::path::Path;

/// Writes a folder as a bake does, staged and committed.
fn write_folder(path: &Path, existing: Existing, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    let staged = stage_folder(path, existing, write)?;
    commit(vec![staged])
}

#[test]
fn a_failing_file_writer_leaves_nothing_and_spares_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.bin");
    let full = || std::io::Error::from(std::io::ErrorKind::StorageFull);
    let attempt = |existing| {
        write_file(&path, existing, |file| {
            file.write_all(&[1; 100_000])?;
            Err(full())
        })
    };
    let message = attempt(Existing::Keep).unwrap_err().to_string();
    assert!(message.contains("out.bin") && !message.contains('\n'), "{message}");
    assert!(names_in(folder.path()).is_empty());

    fs::write(&path, "old").unwrap();
    attempt(Existing::Replace).unwrap_err();
    assert_eq!(names_in(folder.path()), ["out.bin"]);
    assert_eq!(fs::read(&path).unwrap(), b"old");

    let message = write_file(&path, Existing::Keep, |_| Ok(())).unwrap_err().to_string();
    assert!(message.contains("`force`"), "{message}");
    write_file(&path, Existing::Replace, |file| file.write_all(b"new")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
}

#[test]
fn a_failing_folder_writer_leaves_nothing_and_spares_the_old_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bake");
    let attempt = |existing| {
        write_folder(&path, existing, |inside| {
            fs::write(inside.join("m0_px.exr"), "new").unwrap();
            let nowhere = inside.join("m0_nx.exr");
            Err::<(), _>(octagloss_core::common::error::Error::io(
                &nowhere,
                std::io::ErrorKind::StorageFull.into(),
            ))
        })
    };
    let message = attempt(Existing::Keep).unwrap_err().to_string();
    let place = path.join("m0_nx.exr").display().to_string();
    assert!(message.contains(&place) && !message.contains(".octagloss-"), "{message}");
    assert!(names_in(folder.path()).is_empty());

    fs::create_dir(&path).unwrap();
    fs::write(path.join("m0_px.exr"), "octagloss, old").unwrap();
    attempt(Existing::Replace).unwrap_err();
    assert_eq!(names_in(folder.path()), ["bake"]);
    assert_eq!(fs::read(path.join("m0_px.exr")).unwrap(), b"octagloss, old");
    write_folder(&path, Existing::Keep, |_| Ok(())).unwrap_err();

    write_folder(&path, Existing::Replace, |inside| {
        fs::write(inside.join("report.json"), "{}").unwrap();
        Ok(())
    })
    .unwrap();
    assert_eq!(names_in(folder.path()), ["bake"]);
    assert_eq!(names_in(&path), ["report.json"]);
}

#[test]
fn force_never_replaces_a_folder_with_other_files_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("photos");
    for stranger in ["thesis.txt", "m0_qx.exr", "m_px.exr", "mx_px.exr", "m0_px.png", "px.exr"] {
        fs::create_dir(&path).unwrap();
        fs::write(path.join("m0_px.exr"), "octagloss").unwrap();
        fs::write(path.join(stranger), "").unwrap();
        let message = write_folder(&path, Existing::Replace, |_| Ok(())).unwrap_err().to_string();
        assert!(message.contains(stranger) && message.contains("photos"), "{message}");
        assert!(path.join(stranger).exists());
        fs::remove_dir_all(&path).unwrap();
    }
    // Images of such names by another program, without a report.
    for name in ["m0.exr", "m7_px.exr", "m0_px.hdr"] {
        fs::create_dir(&path).unwrap();
        fs::write(path.join(name), "#?RADIANCE").unwrap();
        let message = write_folder(&path, Existing::Replace, |_| Ok(())).unwrap_err().to_string();
        assert!(message.contains(name), "{message}");
        assert!(path.join(name).exists());
        fs::remove_dir_all(&path).unwrap();
    }
    fs::create_dir_all(path.join("m0_px.exr")).unwrap();
    write_folder(&path, Existing::Replace, |_| Ok(())).unwrap_err();
    fs::remove_dir_all(&path).unwrap();
    fs::create_dir(&path).unwrap();
    for ours in ["report.json", "m10_nz_bound.exr", "m0_px.hdr", "irradiance_ny.exr"] {
        fs::write(path.join(ours), "").unwrap();
    }
    write_folder(&path, Existing::Replace, |_| Ok(())).unwrap();
    assert!(names_in(&path).is_empty());
}

#[test]
fn outputs_in_impossible_places_are_errors_that_name_them() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let inside_nothing = folder.path().join("missing").join("out.ktx2");
    let inside_file = file.join("out.ktx2");
    let bytes = ktx2_bytes(&chain(2, 1, false).levels, Pixel::F16, &[]).unwrap();
    for path in [&inside_nothing, &inside_file, folder.path(), Path::new("/dev/null"), Path::new("/")] {
        for existing in [Existing::Keep, Existing::Replace] {
            let message = write_file(path, existing, |file| file.write_all(&bytes)).unwrap_err().to_string();
            assert!(message.contains(&path.display().to_string()) && !message.contains('\n'), "{message}");
        }
    }
    for path in [&inside_nothing, &inside_file, &file] {
        let message = write_folder(path, Existing::Replace, |_| Ok(())).unwrap_err().to_string();
        assert!(message.contains(&path.display().to_string()), "{message}");
    }
    assert_eq!(names_in(folder.path()), ["file"]);
}

#[cfg(unix)]
#[test]
fn a_link_keeps_pointing_at_the_file_that_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let (target, link) = (folder.path().join("target"), folder.path().join("link"));
    fs::write(&target, "old").unwrap();
    std::os::unix::fs::symlink(&target, &link).unwrap();
    write_file(&link, Existing::Replace, |file| file.write_all(b"new")).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&target).unwrap(), b"new");
}
