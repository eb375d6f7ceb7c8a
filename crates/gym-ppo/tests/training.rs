//! Training improves the return. A training that is killed and resumed ends like an uninterrupted
//! training: with the same weights, moments, statistics, generators and returns, bit for bit.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value as Json;

fn program(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gym-ppo"));
    command
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}

fn training(folder: &Path, id: &str, steps: u64, checkpoint: &str) -> Command {
    let mut command = program(folder);
    let steps = steps.to_string();
    command.args([
        id,
        "--steps",
        &steps,
        "--seed",
        "3",
        "--save-every",
        "1",
        "--plot",
        "ppo.svg",
    ]);
    command.args(["--checkpoint", checkpoint]);
    command
}

/// Returns the checkpoint in `folder` without the episodes' wall-clock times.
fn checkpoint(folder: &Path) -> Option<Json> {
    fn without_clock(json: &mut Json) {
        match json {
            Json::Object(entries) => {
                entries.remove("t");
                entries.values_mut().for_each(without_clock);
            }
            Json::Array(items) => items.iter_mut().for_each(without_clock),
            _ => {}
        }
    }
    let text = std::fs::read_to_string(folder.join("checkpoint.json")).ok()?;
    // files are replaced atomically, so a readable checkpoint is complete
    let mut json = serde_json::from_str(&text).expect("a checkpoint is never half written");
    without_clock(&mut json);
    Some(json)
}

fn steps(checkpoint: &Json) -> u64 {
    checkpoint["steps"].as_u64().expect("a number of steps")
}

fn killed_and_resumed(id: &str, total: u64) {
    let folder = tempfile::tempdir().unwrap();
    assert!(
        training(folder.path(), id, total, "whole")
            .status()
            .unwrap()
            .success()
    );
    let whole = checkpoint(&folder.path().join("whole")).unwrap();
    assert!(steps(&whole) >= total, "{id}");

    let resumed = folder.path().join("killed");
    let (mut kills, started) = (0, Instant::now());
    loop {
        let before = checkpoint(&resumed).map_or(0, |checkpoint| steps(&checkpoint));
        let mut child = training(folder.path(), id, total, "killed")
            .spawn()
            .unwrap();
        // kill the child twice, each time after it has written a new checkpoint
        let killed = loop {
            if child.try_wait().unwrap().is_some() {
                break false;
            }
            let now = checkpoint(&resumed).map_or(0, |checkpoint| steps(&checkpoint));
            if kills < 2 && now > before && now < total {
                child.kill().unwrap();
                child.wait().unwrap();
                break true;
            }
            assert!(started.elapsed() < Duration::from_secs(600), "{id} hangs");
            std::thread::sleep(Duration::from_millis(5));
        };
        if !killed {
            break;
        }
        kills += 1;
    }
    assert!(kills > 0, "{id}: it was too fast to be killed");
    let resumed = checkpoint(&resumed).unwrap();
    assert!(
        resumed == whole,
        "{id}: after {kills} kills the training is another one"
    );

    let video = folder.path().join("videos");
    let output = program(folder.path())
        .args(["evaluate", "killed", "--episodes", "2", "--video", "videos"])
        // (drawing a whole episode takes a minute without optimisation)
        .args(["--frames", "50"])
        .stdout(Stdio::piped())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success() && text.contains("episode 1: return"),
        "{id}: {text}"
    );
    assert_eq!(std::fs::read_dir(video).unwrap().count(), 2, "{id}");
}

#[test]
fn discrete_actions_resume() {
    killed_and_resumed("CartPole-v1", 4096);
}

#[test]
fn continuous_actions_with_normalization_resume() {
    killed_and_resumed("Pendulum-v1", 8192);
}

#[test]
fn actions_in_float64_resume() {
    killed_and_resumed("dm_control/cartpole-swingup-v0", 8192);
}

#[test]
fn a_checkpoint_of_another_training_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    assert!(
        training(folder.path(), "CartPole-v1", 256, "run")
            .status()
            .unwrap()
            .success()
    );
    let other = training(folder.path(), "Pendulum-v1", 256, "run")
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&other.stderr).into_owned();
    assert!(
        !other.status.success() && text.contains("CartPole-v1 with seed 3"),
        "{text}"
    );
    let none = program(folder.path())
        .args(["evaluate", "nowhere"])
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&none.stderr).contains("no checkpoint"));
}

#[test]
fn cart_pole_is_balanced_after_some_thousand_steps() {
    let folder = tempfile::tempdir().unwrap();
    let mut program = program(folder.path());
    program
        .args(["CartPole-v1", "--steps", "20000"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let output = program.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let last = text
        .lines()
        .find_map(|line| line.strip_prefix("CartPole-v1: mean return "))
        .unwrap();
    let mean: f64 = last.split(' ').next().unwrap().parse().unwrap();
    assert!(mean > 150.0, "a random policy has 22: {text}");
    let plot = std::fs::read_to_string(folder.path().join("target/ppo.svg")).unwrap();
    assert!(plot.starts_with("<svg") && plot.len() > 1000, "{plot}");
}

#[test]
fn a_plot_that_cannot_be_written_is_told_before_the_training() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let mut program = program(folder.path());
    program.args([
        "CartPole-v1",
        "--steps",
        "1000000000",
        "--plot",
        "file/ppo.svg",
    ]);
    let output = program.stderr(Stdio::piped()).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        !output.status.success() && error.contains("the plot file/ppo.svg"),
        "{error}"
    );
}
