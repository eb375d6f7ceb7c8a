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
    ("list Nope", ""),
    ("run Taxi-v4 --seeds 5..7 --plot a.SVG", ""),
    ("run Taxi-v4 --seeds 0..1 --plot a.txt", ""),
    ("run Taxi-v4 --seeds 0..1 --plot a", ""),
    ("run Taxi-v4 --seeds 7..5", ""),
    ("run Taxi-v4 --seeds 5", ""),
    ("run MiniGrid-Empty-5x5-v0 --policy good --seeds 0..1", ""),
    ("run CartPole-v0 --seeds 1..3 --policy good", ""),
    ("run CartPole-v1 --kwargs {\"gravity\":1e400}", ""),
    ("gif CartPole-v1 --max-frames 0", ""),
    ("gif CartPole-v1 --out a.txt", ""),
    ("gif Blackjack-v1 --policy good --out b.gif", ""),
    ("demo --episodes 0", ""),
    ("demo --max-frames 0", ""),
    ("bench Nope-v1 --seconds 86400", ""),
    ("bench Nope-v1 --seconds 86400.5", ""),
    ("bench Nope-v1 --seconds 0", ""),
    ("bench Nope-v1 --seconds -0.5", ""),
    ("bench Nope-v1 --num-envs 0", ""),
    ("bench Nope-v1 --kind slow", ""),
    ("soak CartPole-v1 --steps 0", ""),
    ("soak Nope-v1 --steps 5", ""),
    ("play Taxi-v4 --terminal --seed 2 --fps 0", ""),
    ("play Taxi-v4 --terminal --seed 2 --zoom 0", ""),
    ("play Taxi-v4 --terminal --key A=9", ""),
    ("play Taxi-v4 --terminal --key A", ""),
    ("play Taxi-v4 --terminal --idle 9", ""),
    ("play Taxi-v4 --terminal --episodes 0", ""),
    ("play Taxi-v4 --terminal --record a.txt", ""),
    (
        "play CliffWalking-v1 --terminal --seed 1 --episodes 2",
        "u\nr\n\nd\nrestart\nu\nq\n",
    ),
    ("mjcf rich.xml", ""),
    ("mjcf rich.xml --keyframe 1 --steps 3", ""),
    ("mjcf rich.xml --keyframe 2", ""),
    ("mjcf rich.xml --out a.png --camera 1 --size 32x24", ""),
    ("mjcf rich.xml --out a.png --camera 2", ""),
    ("mjcf rich.xml --out a.png --size 0x24", ""),
    ("mjcf rich.xml --out a.png --size 32", ""),
    ("mjcf rich.xml --out a.png --distance 0", ""),
    ("mjcf rich.xml --out a.txt", ""),
    ("mjcf rich.xml --out a.gif", ""),
    ("mjcf rich.xml --steps 0", ""),
    ("replay twice.json neither.json rewards.json notes.json", ""),
    ("replay seed.json fraction.json action.json text.json", ""),
    ("replay settings.json", ""),
    ("replay limit.json threshold.json space.json sign.json", ""),
    ("replay nothing.json silent.json wrapper.json", ""),
    (
        "replay none.json fast.json mode.json mask.json seeds.json few.json",
        "",
    ),
    ("replay seeds.json --out replayed", ""),
    ("replay replayed/seeds.json", ""),
];

/// Every kind of part twice: with a name, and without one.
const RICH: &str = r#"<mujoco model="rich"><option timestep="0.004" integrator="implicitfast" solver="CG"/>
<asset><mesh name="t" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><mesh name="u" vertex="0 0 0 2 0 0 0 1 0 0 0 1"/>
<texture name="sky" type="skybox" builtin="gradient" width="8" height="8"/><material name="red" rgba="1 0 0 1"/></asset>
<worldbody><geom type="plane" size="1 1 1"/><geom type="plane" size="1 1 1" pos="0 0 -1"/><camera name="eye"/><camera/>
<body name="one" pos="0 0 1"><freejoint name="free"/><geom size="0.1" mass="1"/><geom size="0.1" mass="1"/>
<geom type="capsule" size="0.1 0.2" mass="1" contype="0"/><geom type="capsule" size="0.1 0.2" mass="1" conaffinity="0"/>
<site name="s"/><site name="e" pos="0.1 0 0"/>
<body pos="1 0 0"><joint type="ball"/><geom type="box" size="1 1 1" mass="2" contype="0" conaffinity="0"/>
<geom type="ellipsoid" size="1 1 1" mass="2"/><geom type="ellipsoid" size="1 1 1" mass="2"/>
<body name="three" pos="1 0 0"><joint name="h" range="-60 30"/><joint type="slide" range="-0.5 2" axis="1 0 0"/>
<geom type="mesh" mesh="t"/><geom type="mesh" mesh="u"/><geom type="cylinder" size="0.1 0.2" mass="1"/>
<geom type="cylinder" size="0.1 0.2" mass="1"/></body></body></body>
<body name="hand" mocap="true"><geom type="box" size="1 1 1"/></body></worldbody>
<tendon><fixed name="rope" range="-1 1"><joint joint="h" coef="1"/></fixed>
<spatial><site site="s"/><site site="e"/></spatial></tendon>
<equality><weld body1="one" body2="hand"/><connect body1="three" anchor="0 0 0"/><joint joint1="h"/>
<tendon tendon1="rope"/><weld site1="s" site2="e"/></equality>
<actuator><motor name="m" joint="h" ctrlrange="-2 2"/><position tendon="rope"/><velocity site="s" gear="1 0 0 0 0 0"/>
<motor jointinparent="h"/><adhesion name="stick" body="one" ctrlrange="0 2"/>
<motor cranksite="s" slidersite="e" cranklength="2"/></actuator>
<sensor><gyro name="felt" site="s"/><accelerometer site="e"/><touch site="s"/><jointpos joint="h"/>
<tendonvel tendon="rope"/><actuatorfrc actuator="m"/><framequat objtype="body" objname="three"/>
<framepos objtype="xbody" objname="three"/>
<framepos objtype="camera" objname="eye"/><subtreecom body="one"/><clock/></sensor>
<keyframe><key name="up" time="1"/><key/></keyframe></mujoco>"#;

/// Recordings that differ from another in one place: a name, and what is replaced by what.
const SPOILT: &[(&str, &str, &str, &str)] = &[
    (
        "twice",
        WHOLE,
        "{\"step\": 2",
        "{\"reset\": {\"seed\": 1}, \"step\": 2",
    ),
    ("neither", WHOLE, "\"step\": 2, ", ""),
    ("rewards", WHOLE, "\"reward\"", "\"rewards\""),
    ("notes", WHOLE, "numpy", "numpi"),
    ("seed", WHOLE, "\"seed\": 1", "\"seed\": -1"),
    ("fraction", WHOLE, "\"seed\": 1", "\"seed\": 1.5"),
    ("action", WHOLE, "\"step\": 2", "\"step\": 9"),
    ("text", WHOLE, "\"step\": 2", "\"step\": \"x\""),
    (
        "settings",
        WHOLE,
        "\"numpy\"",
        "\"mujoco\": \"3.12\", \"frame_mask\": [[0, 0, 1, 1]], \"observation_mask\": [[0, 0, 1, 1]], \
         \"policy\": 3, \"numpy\"",
    ),
    ("limit", WHOLE, ": 100", ": 1"),
    (
        "threshold",
        WHOLE,
        "\"numpy\"",
        "\"reward_threshold\": 0.5, \"numpy\"",
    ),
    (
        "space",
        WHOLE,
        "\"numpy\"",
        "\"action_space\": \"Discrete(5)\", \"numpy\"",
    ),
    ("sign", WHOLE, "\"reward\": 0.0", "\"reward\": -0.0"),
    ("nothing", WHOLE, "\"events\"", "\"events\": [], \"note\""),
    (
        "silent",
        WHOLE,
        "\"observation\": 0, \"info\"",
        "\"frame_plain\": 3, \"info\"",
    ),
    (
        "wrapper",
        WHOLE,
        "\"numpy\"",
        "\"wrappers\": [{\"name\": \"Nope\", \"kwargs\": {}}], \"numpy\"",
    ),
    ("none", VECTOR, "\"num_envs\": 2", "\"num_envs\": 0"),
    (
        "fast",
        VECTOR,
        "\"num_envs\": 2",
        "\"num_envs\": 2, \"kind\": \"fast\"",
    ),
    (
        "mode",
        VECTOR,
        "\"num_envs\": 2",
        "\"num_envs\": 2, \"autoreset_mode\": \"Never\"",
    ),
    (
        "mask",
        VECTOR,
        "\"seed\": 1",
        "\"seed\": 1, \"options\": {\"reset_mask\": [true]}",
    ),
    ("seeds", VECTOR, "\"seed\": 1", "\"seed\": [7, null]"),
    ("few", VECTOR, "\"seed\": 1", "\"seed\": [7]"),
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
    std::fs::write(home.join("rich.xml"), RICH).unwrap();
    for (name, text, from, to) in SPOILT {
        let spoilt = text.replacen(from, to, 1);
        assert_ne!(spoilt, *text, "{name}");
        std::fs::write(home.join(name).with_extension("json"), spoilt).unwrap();
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
