//! The book's policy has the returns that the book states, and a damaged policy file is refused.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn stored() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../gym-policies/networks/half-cheetah.json")
}

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gym-ppo"))
        .args(arguments)
        .output()
        .unwrap()
}

fn said(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn the_stored_policy_runs() {
    let path = stored();
    let output = run(&["evaluate", path.to_str().unwrap(), "--episodes", "2"]);
    let text = said(&output.stdout);
    assert!(output.status.success(), "{text}{}", said(&output.stderr));
    let returns: Vec<f64> = text
        .lines()
        .filter_map(|line| line.split_once(": return ")?.1.parse().ok())
        .collect();
    assert_eq!(returns.len(), 2, "{text}");
    assert!(returns.iter().all(|x| *x > 4000.0), "{text}");
    assert!(text.contains("HalfCheetah-v5: mean return"), "{text}");
}

#[test]
fn a_policy_of_another_form_is_refused() {
    let text = std::fs::read_to_string(stored()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("policy.json");
    for (from, to, message) in [
        ("HalfCheetah-v5", "Hopper-v5", "a row has 11"),
        (
            "\"network\": [\n[",
            "\"network\": [\n[0.5,",
            "numbers are stored where",
        ),
        (
            "\"network\": [\n[",
            "\"network\": [\n[0.5],\n[",
            "lists of numbers",
        ),
        ("\"env\"", "\"environment\"", "missing field `env`"),
    ] {
        assert!(text.contains(from), "{from}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let output = run(&["evaluate", path.to_str().unwrap(), "--episodes", "1"]);
        assert!(!output.status.success(), "{to}");
        let error = said(&output.stderr);
        assert!(error.contains(message), "{to}: {error}");
    }
}

#[test]
fn settings_are_checked() {
    for (set, message) in [
        ("learning_rat=1", "unknown setting learning_rat"),
        ("epochs=0", "at least 1"),
        ("epochs=many", "epochs: many"),
        ("normalize=3", "out of range"),
        ("epochs", "NAME=NUMBER"),
    ] {
        let output = run(&["CartPole-v1", "--steps", "1", "--set", set]);
        let error = said(&output.stderr);
        assert!(
            !output.status.success() && error.contains(message),
            "{set}: {error}"
        );
    }
}
