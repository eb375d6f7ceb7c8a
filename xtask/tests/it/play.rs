//! Tests of `cargo xtask play` in a terminal.

use std::io::Write;
use std::process::Stdio;

use super::{folder, json, program, said};

/// Returns what is printed for lines that are typed.
fn played(arguments: &[&str], lines: &str) -> String {
    let mut child = program()
        .args(["play", "FrozenLake-v1", "--terminal", "--seed=3"])
        .args(["--kwargs", r#"{"is_slippery": false}"#])
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    // a game that is over reads no further
    let _ = input.write_all(lines.as_bytes());
    drop(input);
    said(&child.wait_with_output().unwrap(), arguments)
}

/// The episode, step and score of each prompt.
fn prompts(said: &str) -> Vec<&str> {
    let ends = said.lines().filter_map(|line| {
        let (status, _) = line.split_once('>')?;
        status.strip_prefix("FrozenLake-v1  ")
    });
    ends.collect()
}

#[test]
fn a_line_is_a_key_or_the_start_of_one_and_steps_are_counted() {
    let folder = folder("play-terminal");
    let trace = folder.join("trace.json");
    let arguments = ["--trace", trace.to_str().unwrap()];
    // the second step is into a hole
    let lines = "down\nR\nwhat\nrestart\nDOWN\n\n  left \nq\ndown\n";
    let said = played(&arguments, lines);
    assert_eq!(
        prompts(&said),
        [
            "episode 1  step 0  score 0.00",
            "episode 1  step 1  score 0.00",
            "episode 1  step 2  score 0.00",
            "episode 2  step 0  score 0.00",
            "episode 2  step 0  score 0.00",
            "episode 3  step 0  score 0.00",
            "episode 3  step 1  score 0.00",
            "episode 3  step 1  score 0.00",
            "episode 3  step 2  score 0.00",
        ],
        "{said}"
    );
    let help = "keys: Down = 1, Left = 0, Right = 2, Up = 3, restart, q";
    assert_eq!(said.matches(help).count(), 2, "{said}");
    assert!(
        said.contains(&format!("{}: 7 events", trace.display())),
        "{said}"
    );
    let trace = json(&trace);
    let actions: Vec<_> = trace["events"]
        .as_array()
        .unwrap()
        .iter()
        .map(|event| event["step"].as_i64())
        .collect();
    assert_eq!(
        actions,
        [None, Some(1), Some(2), None, None, Some(1), Some(0)]
    );
}

#[test]
fn the_game_ends_after_the_episodes_asked_for() {
    let goal = "down\ndown\nright\nright\ndown\nright\n";
    let said = played(&["--episodes=2"], &format!("{goal}down\nright\nup\nup\n"));
    let prompts = prompts(&said);
    assert_eq!(prompts.len(), 7 + 3, "{said}");
    assert_eq!(prompts[6], "episode 1  step 6  score 1.00");
    assert_eq!(prompts[9], "episode 2  step 2  score 0.00");
}

#[test]
fn keys_of_the_command_line_go_before_those_of_the_environment() {
    let said = played(&["--key=down=2", "--key=X=1"], "x\ndown\n");
    let first = said.lines().next().unwrap();
    assert_eq!(first, "Left = 0, Right = 2, Up = 3, down = 2, X = 1");
    // down, then right: into the hole
    let last = *prompts(&said).last().unwrap();
    assert_eq!(last, "episode 2  step 0  score 0.00", "{said}");
}
