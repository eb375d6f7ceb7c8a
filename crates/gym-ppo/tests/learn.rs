//! A training as the README starts it.

use std::process::{Command, Output};

fn train(folder: &std::path::Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gym-ppo")).args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn cart_pole_is_balanced_after_some_thousand_steps() {
    let folder = tempfile::tempdir().unwrap();
    let output = train(folder.path(), &["CartPole-v1", "--steps", "20000"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let last = text.lines().find_map(|line| line.strip_prefix("CartPole-v1: mean return ")).unwrap();
    let mean: f64 = last.split(' ').next().unwrap().parse().unwrap();
    assert!(mean > 150.0, "a random policy has 22: {text}");
    let plot = std::fs::read_to_string(folder.path().join("target/ppo.svg")).unwrap();
    assert!(plot.starts_with("<svg") && plot.len() > 1000, "{plot}");
}

#[test]
fn a_plot_that_cannot_be_written_is_told_before_the_training() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let output = train(folder.path(), &["CartPole-v1", "--steps", "1000000000", "--plot", "file/ppo.svg"]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && error.contains("the plot file/ppo.svg"), "{error}");
}
