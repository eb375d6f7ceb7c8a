//! What the program that builds the commands asks Cargo and the compiler for: programs that stand in for them tell.

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::folder;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// A folder for one test, with a Cargo that prints its words, a compiler that prints the folder and a target folder.
struct Place(PathBuf);

impl Place {
    fn new(name: &str) -> Self {
        let place = Self(folder(name));
        place.script("cargo", "echo \"$@\"\nexit ${GYM_CODE:-0}");
        place.script("rustc", "echo \"$@\" >\"$0.log\"\ndirname \"$0\"");
        place
    }

    fn script(&self, name: &str, text: &str) {
        let path = self.0.join(name);
        std::fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    }

    /// Runs the launcher with a line of words, while Cargo ends with `code`. Returns its exit code and
    /// what it prints, with `ROOT` and `TARGET` for the folders.
    fn run(&self, line: &str, code: &str) -> (Option<i32>, String) {
        let target = self.0.join("target");
        let output = Command::new(env!("CARGO_BIN_EXE_xtask"))
            .args(line.split_whitespace())
            .current_dir(&self.0)
            .env("CARGO", self.0.join("cargo"))
            .env("RUSTC", self.0.join("rustc"))
            .env("CARGO_TARGET_DIR", &target)
            .env("GYM_CODE", code)
            .output()
            .unwrap();
        let printed = [output.stdout, output.stderr].concat();
        let printed = String::from_utf8(printed).unwrap();
        let printed = printed.replace(target.to_str().unwrap(), "TARGET");
        let printed = printed.replace(root().to_str().unwrap(), "ROOT");
        (output.status.code(), printed)
    }
}

#[test]
fn each_command_is_built_with_its_profile_and_features() {
    let place = Place::new("launcher");
    let asked = |line: &str, profile: &str, features: &str| {
        format!(
            "run --package xtask --bin commands --profile {profile} --manifest-path ROOT/Cargo.toml \
             --no-default-features --features {features} --{}{line}\n",
            if line.is_empty() { "" } else { " " }
        )
    };
    let lines = [
        ("", "quick", "families"),
        ("list CartPole", "quick", "families"),
        ("new a", "quick", "families"),
        ("python", "quick", "families"),
        ("mjcf a.xml", "quick", "families"),
        ("run --help", "quick", "families"),
        ("conform -h", "quick", "families"),
        ("mjcf a.xml --out a.png", "play", "families"),
        ("mjcf a.xml --steps=9", "play", "families"),
        ("mjcf a.xml --window", "play", "families,human"),
        ("gif Taxi-v4", "play", "families"),
        ("run rapier/LunarLander-v3", "play", "families,rapier"),
        ("replay a.json", "play", "families"),
        ("play Taxi-v4", "play", "families,human"),
        ("play Taxi-v4 --terminal", "play", "families"),
        ("atari check", "play", "families"),
        ("docs --check", "play", "families,rapier"),
        ("demo --all", "play", "families,rapier"),
        ("conform", "play", "families,rapier,native-vectors,conform"),
        ("bench --json a", "release", "families,native-vectors"),
        ("soak", "release", "families,rapier"),
    ];
    for (line, profile, features) in lines {
        let expected = (Some(0), asked(line, profile, features));
        assert_eq!(place.run(line, "0"), expected, "{line}");
    }
    // the quick families are shown first, if they can be
    let first = "The quick families first: the others are built after their GIFs.\n".to_owned();
    let small = first + &asked("demo", "play", "small");
    assert_eq!(place.run("demo", "7"), (Some(7), small.clone()));
    let both = small + &asked("demo", "play", "families");
    assert_eq!(place.run("demo", "0"), (Some(0), both));
    let web = "\n`cargo xtask web` builds a page that runs the environments in a browser: `cargo xtask web --help`.\n";
    for line in ["help", "--help", "-h"] {
        let expected = asked(line, "quick", "families") + web;
        assert_eq!(place.run(line, "0"), (Some(0), expected));
    }
    // an optimised program that is there serves what needs no speed
    let built = place.0.join("target/play");
    std::fs::create_dir_all(&built).unwrap();
    std::fs::write(built.join("commands"), "").unwrap();
    for line in ["list", "demo"] {
        assert_eq!(
            place.run(line, "0"),
            (Some(0), asked(line, "play", "families"))
        );
    }
    assert_eq!(place.run("bench", "3").0, Some(3));
}

#[test]
fn the_gallery_is_built_for_the_browser() {
    let place = Place::new("launcher-web");
    let failed = "error: the module could not be built\n";
    for (line, feature) in [
        ("web", "families"),
        ("web --small --out a", "small"),
        ("web --robot", "compiled"),
        ("web --small --robot", "compiled"),
    ] {
        let asked = format!(
            "--config ROOT/crates/gym-web/profile.toml rustc --profile gallery --target wasm32-unknown-unknown --lib \
             --crate-type cdylib --target-dir TARGET --package gym-web --manifest-path ROOT/Cargo.toml \
             --no-default-features --features {feature} -- -C link-arg=--export=__wasm_call_ctors \
             -C link-arg=--compress-relocations -C link-arg=-O2\n"
        );
        assert_eq!(place.run(line, "1"), (Some(1), asked + failed), "{line}");
    }
    let asked = std::fs::read_to_string(place.0.join("rustc.log")).unwrap();
    assert_eq!(
        asked,
        "--print target-libdir --target wasm32-unknown-unknown\n"
    );
    let remedy = "error: the compiler has no standard library for wasm32-unknown-unknown. With rustup: \
                  `rustup target add \
                  wasm32-unknown-unknown`. Without, install your system's package of it (Fedora: \
                  rust-std-static-wasm32-unknown-unknown; Arch: rust-wasm); on Debian run .ci/web-setup, \
                  which says more\n";
    for compiler in ["echo \"$0/none\"", "dirname \"$0\"\nexit 1"] {
        place.script("rustc", compiler);
        assert_eq!(place.run("web", "0"), (Some(1), remedy.to_owned()));
    }
}
