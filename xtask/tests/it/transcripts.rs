//! The whole of what commands print, beside a recording, `xtask/tests/transcripts.txt`. After an
//! intended change, read what differs, and record again with
//! `GYM_UPDATE_KEPT=1 cargo test --package xtask --test it transcripts`.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

use gym_testing::kept;

use super::{folder, program};

/// Command lines, whose words have a space between them, and what is typed.
const COMMANDS: &[(&str, &str)] = &[
    ("help", ""),
    ("help list", ""),
    ("help demo", ""),
    ("help gif", ""),
    ("help play", ""),
    ("help run", ""),
    ("help replay", ""),
    ("help mjcf", ""),
    ("help atari check", ""),
    ("help docs", ""),
    ("help bench", ""),
    ("help conform", ""),
    ("help python", ""),
    ("help new", ""),
    ("help soak", ""),
    ("run CartPole-v1 --policy random,good --seeds 0..3", ""),
    ("run Taxi-v4 --seeds 5..7", ""),
    (
        "run FrozenLake-v1 --kwargs {\"map_name\":\"8x8\"} --seeds 1..3",
        "",
    ),
    ("run Blackjack-v1", ""),
    ("run Taxi-v4 --policy good,nope", ""),
    ("run Taxi-v4 --seeds 3..3", ""),
    ("run Taxi-v4 --kwargs [1]", ""),
    ("run Blackjack-v1 --kwargs {\"natural\":1}", ""),
    ("run Blackjack-v1 --kwargs {\"nature\":true}", ""),
    ("run Taxi-v4 --plot a.svg --seeds 0..1", ""),
    (
        "play Taxi-v4 --terminal --seed 2 --episodes 1",
        "down\nup\nwhat\nrestart\nl\nq\n",
    ),
    (
        "play FrozenLake-v1 --terminal --seed 3 --trace game.json",
        "d\nr\nd\nd\nd\nl\nr\n",
    ),
    ("replay game.json", ""),
    ("play Blackjack-v1 --terminal --key Up=2", ""),
    ("play CartPole-v1 --terminal", ""),
    ("gif CartPole-v1 --max-frames 3 --out a.gif", ""),
    (
        "gif CartPole-v1 --policy good --seed 4 --max-frames 2 --out a.png",
        "",
    ),
    ("mjcf arm.xml", ""),
    ("mjcf arm.xml --mujoco 3.12", ""),
    ("mjcf Reacher-v5 --mujoco 3.17", ""),
    ("mjcf Reacher-v5 --mujoco 9.9", ""),
    ("mjcf arm.xml --steps 5 --seed 1", ""),
    (
        "mjcf arm.xml --steps 8 --keyframe bent --out arm.png --size 32x24",
        "",
    ),
    ("mjcf arm.xml --keyframe straight", ""),
    ("mjcf arm.xml --camera nose --out arm.png", ""),
    ("mjcf CartPole-v1", ""),
    ("replay whole.json vector.json", ""),
    ("replay wrong.json whole.json other.json empty.json", ""),
    ("replay whole.json --out whole.json", ""),
    ("soak CartPole-v1 Taxi-v4 --steps 2001 --seed 3", ""),
    ("soak CartPole-v1 --steps 2001", ""),
    ("conform Nope-v1", ""),
    ("conform --format xml", ""),
    ("new 1a", ""),
    ("atari check --rom-dir .", ""),
];

const ARM: &str = r#"<mujoco model="arm"><worldbody>
<geom type="plane" size="1 1 1" contype="0"/><camera name="eye" pos="0 -2 1" xyaxes="1 0 0 0 0 1"/>
<body name="upper" pos="0 0 1"><joint name="elbow" axis="0 1 0" range="-60 30"/><site name="tip"/>
<geom type="capsule" size="0.1" fromto="0 0 0 0 0 0.5" mass="2"/></body></worldbody>
<actuator><motor name="pull" joint="elbow" ctrlrange="-2 2"/></actuator>
<sensor><gyro name="felt" site="tip"/></sensor><keyframe><key name="bent" qpos="0.5"/></keyframe></mujoco>"#;

const WHOLE: &str = r#"{"id": "FrozenLake-v1", "kwargs": {"is_slippery": false}, "numpy": "2.4.6",
"max_episode_steps": 100, "events": [{"reset": {"seed": 1}, "observation": 0, "info": {"prob": 1}},
{"step": 2, "observation": 1, "reward": 0.0, "terminated": false, "truncated": false,
"info": {"prob": 1.0}}]}"#;

const VECTOR: &str = r#"{"id": "FrozenLake-v1", "kwargs": {"is_slippery": false},
"vector": {"num_envs": 2}, "events": [{"reset": {"seed": 1}, "observation": [0, 0]},
{"step": [2, 1], "observation": [1, 4], "reward": [0, 0], "terminated": [false, false]}]}"#;

fn write_files(home: &Path) {
    let files = [
        ("arm.xml", ARM.to_owned()),
        ("whole.json", WHOLE.to_owned()),
        ("vector.json", VECTOR.to_owned()),
        (
            "wrong.json",
            WHOLE.replace("\"observation\": 1", "\"observation\": 4"),
        ),
        ("other.json", WHOLE.replace(": 100", ": 99")),
        ("empty.json", WHOLE.replace("\"events\"", "\"event\"")),
    ];
    for (name, text) in files {
        std::fs::write(home.join(name), text).unwrap();
    }
}

/// Returns a command line, and what it prints: to the standard output, then to the error output.
fn transcript(home: &Path, line: &str, typed: &str) -> String {
    let mut child = program()
        .args(line.split(' '))
        .current_dir(home)
        .env("ALE_ROMS_DIR", home)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // (a command that reads nothing may have ended)
    let _ = child.stdin.take().unwrap().write_all(typed.as_bytes());
    let output = child.wait_with_output().unwrap();
    let mut text = format!("$ {line}\n");
    for (mark, printed) in [("", output.stdout), ("! ", output.stderr)] {
        for line in String::from_utf8(printed).unwrap().lines() {
            writeln!(text, "{}", format!("{mark}{}", timeless(line)).trim_end()).unwrap();
        }
    }
    let code = output.status.code();
    if code != Some(0) {
        writeln!(text, "! ends with {code:?}").unwrap();
    }
    text
}

/// Leaves out times, speeds and sizes of memory.
fn timeless(line: &str) -> String {
    if let Some((before, rest)) = line.split_once(" steps in ")
        && let Some((_, after)) = rest.split_once(" steps per second")
    {
        return format!("{before} steps{after}");
    }
    match line.strip_suffix(" kB more memory") {
        Some(rest) => rest
            .rsplit_once(' ')
            .map_or("", |(before, _)| before)
            .into(),
        None => line.to_owned(),
    }
}

#[test]
fn commands_print_what_they_printed() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/transcripts.txt");
    let home = folder("transcripts");
    write_files(&home);
    let all = COMMANDS
        .iter()
        .map(|(line, typed)| transcript(&home, line, typed));
    let all: Vec<String> = all.collect();
    kept(&path, &all.join("\n"));
}
