//! Programs under the name `ffmpeg` that do not do its work. The search path of a process leads to
//! them, so the process is one of its own.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use gym_core::canvas::Color;
use gym_render::{frame, write_video};
use tempfile::TempDir;

const FOLDER: &str = "GYM_RENDER_TEST_FOLDER";

/// The programs under the name `ffmpeg`, each with words of the error.
const BROKEN: [(&str, &str); 4] = [
    (
        "exit 3",
        "fails (`ffmpeg -version` gives exit status: 3): repair it",
    ),
    (
        "echo no library >&2; exit 127",
        "fails (`ffmpeg -version` gives \"no library\"): repair it",
    ),
    (
        "[ \"$1\" = -version ] || cat > /dev/null",
        "`ffmpeg` ended early and wrote nothing",
    ),
    ("exit 0", "`ffmpeg` ended early and wrote nothing"),
];

/// The program that writes a video with the broken programs, which the next test puts into the
/// search path; does nothing unless that test starts it.
#[test]
fn recording_with_broken_programs() {
    let Some(folder) = std::env::var_os(FOLDER) else {
        return;
    };
    let folder = Path::new(&folder);
    let (program, video) = (folder.join("bin/ffmpeg"), folder.join("videos/a.mp4"));
    let frames = [frame((8, 4), |canvas| canvas.clear(Color::WHITE)).unwrap()];
    for (script, words) in BROKEN {
        fs::write(&program, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        fs::write(&video, "old").unwrap();
        let error = write_video(&video, 10, &frames).unwrap_err().to_string();
        assert!(error.contains(words), "{script}: {error}");
        assert!(!error.contains("install"), "{script}: {error}");
        assert_eq!(fs::read(&video).unwrap(), b"old", "{script}");
        let files = fs::read_dir(folder.join("videos")).unwrap().count();
        assert_eq!(files, 1, "{script}: nothing else is left behind");
    }
    fs::write(folder.join("done"), "").unwrap();
}

#[test]
fn a_broken_ffmpeg_is_an_error_and_replaces_no_video() {
    let folder = TempDir::new().unwrap();
    for name in ["bin", "videos"] {
        fs::create_dir(folder.path().join(name)).unwrap();
    }
    let mut path = folder.path().join("bin").into_os_string();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap());
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "recording_with_broken_programs"])
        .env(FOLDER, folder.path())
        .env("PATH", path)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}");
    assert!(folder.path().join("done").exists(), "{said}");
}
