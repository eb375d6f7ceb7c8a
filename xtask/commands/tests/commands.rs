//! The commands as a user runs them.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value as Json;

fn xtask(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_xtask-commands"))
        .args(arguments)
        .output()
        .expect("the command starts")
}

/// The output of a command, which must succeed.
fn prints(arguments: &[&str]) -> String {
    let output = xtask(arguments);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).expect("text")
}

/// The error of a command that fails.
fn fails(arguments: &[&str]) -> String {
    let output = xtask(arguments);
    assert!(!output.status.success(), "{arguments:?} succeeds");
    String::from_utf8(output.stderr).expect("text")
}

/// An empty folder of a test's own.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn first_word(line: &str) -> &str {
    line.split_whitespace().next().unwrap_or_default()
}

fn json(path: &std::path::Path) -> Json {
    serde_json::from_slice(&std::fs::read(path).expect("the file")).expect("JSON")
}

#[test]
fn list() {
    let short = prints(&["list"]);
    assert!(
        short.contains("CartPole-v1") && !short.contains("limit"),
        "{short}"
    );
    let long = prints(&["list", "--long"]);
    let row = |id: &str| {
        let line = long.lines().find(|line| first_word(line) == id).expect(id);
        line.split_whitespace()
            .skip(1)
            .collect::<Vec<_>>()
            .join(" ")
    };
    assert_eq!(
        row("Taxi-v4"),
        "limit 200 threshold 8 Discrete(6) -> Discrete(500)"
    );
    assert_eq!(
        row("Reacher-v4"),
        "limit 50 threshold -3.75 Box(-1.0, 1.0, (2,), float32) -> Box(-inf, inf, (11,), float64)"
    );
    assert_eq!(
        row("CliffWalking-v1"),
        "limit none threshold none Discrete(4) -> Discrete(48)"
    );

    let mut without_roms = Command::new(env!("CARGO_BIN_EXE_xtask-commands"));
    without_roms
        .args(["list", "--long"])
        .env("ALE_ROMS_DIR", folder("no-roms"));
    let said = String::from_utf8(without_roms.output().expect("it starts").stderr).expect("text");
    assert!(
        said.contains("ids of gym-atari: they need ROMs (none here); name an id to use it"),
        "{said}"
    );
}

#[test]
fn help_knows_every_command() {
    let help = prints(&["help"]);
    assert!(help.contains("Usage: cargo xtask"), "{help}");
    for command in [
        "list", "demo", "gif", "play", "run", "replay", "atari", "docs", "bench", "conform", "new",
        "soak",
    ] {
        let names_it = |line: &str| first_word(line) == command;
        assert!(help.lines().any(names_it), "{command}: {help}");
        let usage = prints(&["help", command]);
        assert!(
            usage.contains(&format!("Usage: cargo xtask {command}")),
            "{usage}"
        );
    }
}

#[test]
fn demo() {
    let out = folder("demo");
    let output = xtask(&[
        "demo",
        "--episodes",
        "2",
        "--max-frames",
        "4",
        "--out",
        out.to_str().unwrap(),
    ]);
    let [table, said] =
        [output.stdout, output.stderr].map(|text| String::from_utf8(text).expect("text"));
    assert!(output.status.success(), "{said}");
    let ids: Vec<_> = table
        .lines()
        .filter(|line| line.contains(" return "))
        .map(first_word)
        .collect();
    assert!(
        ids.is_sorted() && ids.len() > 20,
        "one row for each, in the order of the registry: {ids:?}"
    );
    for old in [
        "CartPole-v0",
        "CliffWalking-v0",
        "Ant-v4",
        "rapier/LunarLander-v3",
    ] {
        assert!(!ids.contains(&old), "{old} is asked for by --all");
    }
    // environments with requirements are left out, named once for each crate
    assert_eq!(
        said.matches("ids of gym-atari: they need ROMs").count(),
        1,
        "{said}"
    );
    assert_eq!(
        said.matches("left out GymV26Environment-v0: it needs")
            .count(),
        1,
        "{said}"
    );
    for id in ["CartPole-v1", "Taxi-v4", "CliffWalking-v1", "Blackjack-v1"] {
        assert!(
            table.contains(&format!("{id}.gif\n")),
            "each GIF is named as it appears: {table}"
        );
        for extension in ["gif", "svg", "png"] {
            let file = out.join(format!("{id}.{extension}"));
            assert!(
                std::fs::metadata(&file).is_ok_and(|file| file.len() > 500),
                "{}",
                file.display()
            );
        }
    }
}

#[test]
fn run_writes_episodes() {
    let file = folder("run").join("episodes.json");
    let path = file.to_str().unwrap();
    prints(&[
        "run",
        "Pendulum-v1",
        "--seeds",
        "3..5",
        "--kwargs",
        r#"{"g": 9.81}"#,
        "--json",
        path,
    ]);
    let episodes = json(&file);
    let episodes = episodes.as_array().expect("a list");
    assert_eq!(episodes.len(), 2);
    assert_eq!(episodes[0]["seed"], 3);
    assert_eq!(episodes[0]["length"], 200);
    assert_eq!(
        (&episodes[0]["terminated"], &episodes[0]["truncated"]),
        (&false.into(), &true.into())
    );
    let [sum, last] = ["return", "last_reward"].map(|name| episodes[0][name].as_f64().unwrap());
    assert!(
        sum < last && last < 0.0,
        "every reward is a cost: {sum}, {last}"
    );
    assert_eq!(episodes[0]["last_observation"].as_array().unwrap().len(), 3);
    let again = folder("run-again").join("episodes.json");
    let path = again.to_str().unwrap();
    prints(&[
        "run",
        "Pendulum-v1",
        "--seeds",
        "4..5",
        "--kwargs",
        r#"{"g": 9.81}"#,
        "--json",
        path,
    ]);
    assert_eq!(
        json(&again)[0],
        episodes[1],
        "an episode depends on its seed alone"
    );
}

#[test]
fn replay_compares_and_writes() {
    let out = folder("replay");
    let trace = out.join("trace.json");
    let seed = "1427247692705959881058285969449495136382746631"; // 2^150 + 7
    let recorded = format!(
        r#"{{"id": "FrozenLake-v1", "kwargs": {{"is_slippery": false}}, "note": "kept", "events": [
            {{"reset": {{"seed": {seed}, "options": null}}, "observation": 0, "info": {{"prob": 1}}}},
            {{"step": 2, "observation": 1, "reward": 0.0, "terminated": false, "truncated": false, "info": {{"prob": 1.0}}}}
        ]}}"#
    );
    std::fs::write(&trace, &recorded).unwrap();
    prints(&["replay", trace.to_str().unwrap()]);

    let answers = out.join("answers");
    prints(&[
        "replay",
        "--out",
        answers.to_str().unwrap(),
        trace.to_str().unwrap(),
    ]);
    let text = std::fs::read_to_string(answers.join("trace.json")).unwrap();
    assert!(text.contains(seed), "the seed keeps its digits: {text}");
    assert_eq!(json(&answers.join("trace.json"))["note"], "kept");
    assert_eq!(text.matches("\"events\"").count(), 1, "{text}");
    prints(&["replay", answers.join("trace.json").to_str().unwrap()]);

    std::fs::write(
        &trace,
        recorded.replace(r#""observation": 1"#, r#""observation": 4"#),
    )
    .unwrap();
    let difference = fails(&["replay", trace.to_str().unwrap()]);
    assert!(
        difference.contains("event 1, observation: 1 for 4"),
        "{difference}"
    );
    std::fs::write(&trace, "[]").unwrap();
    assert!(fails(&["replay", trace.to_str().unwrap()]).contains("not a trace"));
}

#[test]
fn the_book_is_up_to_date() {
    prints(&["docs", "--check"]);
}

#[test]
fn atari_check_tells_of_every_rom() {
    let roms = folder("roms");
    let check = || xtask(&["atari", "check", "--rom-dir", roms.to_str().unwrap()]);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    let output = check();
    assert!(
        !output.status.success() && output.stdout.is_empty(),
        "there is nothing to compare"
    );
    let error = text(output.stderr);
    let first = gym::atari::games::GAMES[0].name;
    assert!(
        error.contains(&format!(
            "has no ROM of a known game: a file is named as {first}.bin"
        )),
        "{error}"
    );

    let games = gym::atari::games::GAMES.len();
    let mut equal = 0;
    if let Some(found) = gym::atari::RomDir::find() {
        std::fs::copy(found.path().join("pong.bin"), roms.join("pong.bin")).unwrap();
        let table = prints(&["atari", "check", "--rom-dir", roms.to_str().unwrap()]);
        let expected = format!(
            "1 of {games} games are as recorded, {} have no ROM here\n",
            games - 1
        );
        assert_eq!(table, format!("{:20} as recorded\n{expected}", "pong"));
        equal = 1;
    }
    std::fs::write(roms.join("seaquest.bin"), "no game").unwrap();
    let output = check();
    assert!(!output.status.success());
    let (table, error) = (text(output.stdout), text(output.stderr));
    let row = table
        .lines()
        .find(|line| first_word(line) == "seaquest")
        .expect("a row");
    assert!(
        row.contains("seaquest.bin has the MD5") && row.contains("another game or edition"),
        "{row}"
    );
    assert!(
        table.contains(&format!("\n{equal} of {games} games are as recorded")),
        "{table}"
    );
    assert!(
        error.contains(&format!("1 of {} ROMs failed", equal + 1)),
        "{error}"
    );
}

/// Each has a controller, and one that is better than chance.
#[test]
fn good_policies_beat_chance() {
    let mean = |id: &str, policy: &str| {
        let file = folder(&format!("policy-{id}-{policy}")).join("episodes.json");
        prints(&[
            "run",
            id,
            "--policy",
            policy,
            "--seeds",
            "0..20",
            "--json",
            file.to_str().unwrap(),
        ]);
        let episodes = json(&file);
        let returns = episodes
            .as_array()
            .unwrap()
            .iter()
            .map(|episode| episode["return"].as_f64().unwrap());
        returns.sum::<f64>() / 20.0
    };
    for (id, least) in [
        ("CartPole-v1", 475.0),
        ("MountainCar-v0", -110.0),
        ("MountainCarContinuous-v0", 90.0),
        ("Pendulum-v1", -200.0),
        ("Acrobot-v1", -100.0),
        ("FrozenLake-v1", 0.6),
        ("CliffWalking-v1", -13.0),
        ("Taxi-v4", 7.0),
        ("LunarLander-v3", 200.0),
    ] {
        let (good, random) = (mean(id, "good"), mean(id, "random"));
        assert!(
            good >= least && good > random,
            "{id}: {good}, at random {random}"
        );
    }
    // by Gymnasium's word
    assert_eq!(
        mean("LunarLander-v3", "heuristic"),
        mean("LunarLander-v3", "good")
    );
    let error = fails(&[
        "run",
        "CarRacing-v3",
        "--policy",
        "good",
        "--kwargs",
        r#"{"continuous": false}"#,
    ]);
    assert!(error.contains("has no good policy"), "{error}");
}

#[test]
fn new_refuses_bad_names_and_leaves_nothing() {
    let parent = folder("new-refused");
    for name in [
        "",
        "1a",
        "My_envs",
        "a-b",
        "a b",
        "gym_core",
        "test",
        "../x",
        "a/b",
        &"a".repeat(65),
    ] {
        let path = parent.join("x");
        assert!(
            fails(&["new", "--path", path.to_str().unwrap(), "--", name]).contains("NAME"),
            "{name:?}"
        );
    }
    let taken = parent.join("taken");
    std::fs::create_dir(&taken).unwrap();
    assert!(
        fails(&["new", "my_envs", "--path", taken.to_str().unwrap()]).contains("exists already")
    );
    let file = parent.join("file");
    std::fs::write(&file, "").unwrap();
    let inside = file.join("x");
    assert!(fails(&["new", "my_envs", "--path", inside.to_str().unwrap()]).starts_with("error: "));
    let left: Vec<_> = std::fs::read_dir(&parent)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[test]
fn soak_has_flat_memory() {
    let text = prints(&[
        "soak",
        "CartPole-v1",
        "Taxi-v4",
        "LunarLander-v3",
        "--steps",
        "60000",
    ]);
    assert!(
        text.contains("60000 steps of 3 environments with flat memory"),
        "{text}"
    );
    for line in text.lines().take(3) {
        // 20,000 steps of each: an episode takes some twenty of CartPole, and at most 200 of Taxi
        let words: Vec<_> = line.split_whitespace().collect();
        let episodes: u64 = words[3].parse().expect(line);
        assert_eq!((words[1], words[4]), ("20000", "episodes,"), "{line}");
        assert!((99..2000).contains(&episodes), "{line}");
    }
}

#[test]
fn errors_are_told_on_one_line() {
    let unknown = fails(&["run", "CartPoleee-v1"]);
    assert!(
        unknown.starts_with("error: ") && unknown.contains("did you mean `CartPole-v1`?"),
        "{unknown}"
    );
    let out = fails(&["gif", "CartPole-v1", "--out", "/nonexistent/folder/x.gif"]);
    assert!(out.contains("/nonexistent/folder"), "{out}");
    assert!(fails(&["run", "CartPole-v1", "--seeds", "5..5"]).contains("A < B"));
    assert!(fails(&["run", "CartPole-v1", "--kwargs", "[]"]).contains("not a JSON object"));
    assert!(
        fails(&["run", "CartPole-v1", "--kwargs", r#"{"foo": 1}"#])
            .contains("unknown argument `foo`")
    );
}

#[test]
fn old_versions_are_pointed_out() {
    let output = xtask(&["run", "CartPole-v0", "--seeds", "0..1"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("warn: `CartPole-v0` is out of date"));
}

#[test]
fn what_cannot_be_done_is_said_before_anything_is_played() {
    assert!(fails(&["soak", "CartPole-v1", "--steps", "0"]).contains("--steps"));
    for command in ["gif", "soak"] {
        let error = fails(&[command, "CartPole-v1", "--seed", "-1"]);
        assert!(
            error.contains("invalid value '-1' for '--seed") && error.contains("from 0 to"),
            "{error}"
        );
    }
    for option in ["--json", "--plot"] {
        let output = xtask(&["run", "CartPole-v1", option, "/nonexistent/folder/x.svg"]);
        assert!(
            !output.status.success() && output.stdout.is_empty(),
            "{option}: it plays first"
        );
        assert!(String::from_utf8_lossy(&output.stderr).contains("/nonexistent/folder"));
    }
}

/// The table says how each episode ended, and the means are those of its rows.
#[test]
fn run_prints_how_episodes_end() {
    let rows = |id: &str, seeds: &str| -> Vec<Vec<String>> {
        let text = prints(&["run", id, "--policy", "random", "--seeds", seeds]);
        text.lines()
            .map(|line| line.split_whitespace().map(str::to_owned).collect())
            .collect()
    };
    let poles = rows("CartPole-v1", "0..2");
    assert_eq!(poles[0], ["seed", "return", "length", "ended"]);
    assert!(
        poles[1..3].iter().all(|row| row[3..] == ["terminated"]),
        "{poles:?}"
    );
    // each step pays 1
    assert!(
        poles[1..3]
            .iter()
            .all(|row| row[1] == format!("{}.0000", row[2])),
        "{poles:?}"
    );
    let pendulums = rows("Pendulum-v1", "0..2");
    assert!(
        pendulums[1..3]
            .iter()
            .all(|row| row[2..] == ["200", "truncated"]),
        "{pendulums:?}"
    );
    let number = |row: usize| pendulums[row][1].parse::<f64>().unwrap();
    let mean: f64 = pendulums[3][1].parse().unwrap();
    assert!(
        (mean - (number(1) + number(2)) / 2.0).abs() < 0.01,
        "{pendulums:?}"
    );
    let [low, high] = [number(1).min(number(2)), number(1).max(number(2))];
    assert_eq!(
        pendulums[3][2..4],
        [format!("[{low:.1},"), format!("{high:.1}]")],
        "{pendulums:?}"
    );
    // where every return is positive the smallest is not 0
    let [one, other] = [1, 2].map(|row| poles[row][1].parse::<f64>().unwrap());
    assert_eq!(poles[3][2], format!("[{:.1},", one.min(other)), "{poles:?}");
}

/// The options of a command reach the environment, the policy and the file.
#[test]
fn gif_follows_its_options() {
    let out = folder("gif");
    let record = |name: &str, options: &[&str]| {
        let path = out.join(name);
        let text = prints(
            &[
                &["gif", "CartPole-v1", "--out", path.to_str().unwrap()],
                options,
            ]
            .concat(),
        );
        let frames = text
            .rsplit(": ")
            .next()
            .and_then(|frames| frames.split_whitespace().next());
        (
            frames.unwrap().parse::<u64>().unwrap(),
            std::fs::read(path).unwrap(),
        )
    };
    let length = {
        let file = out.join("episode.json");
        prints(&[
            "run",
            "CartPole-v1",
            "--seeds",
            "0..1",
            "--json",
            file.to_str().unwrap(),
        ]);
        json(&file)[0]["length"].as_u64().unwrap()
    };
    let (frames, plain) = record("plain.gif", &[]);
    assert_eq!(
        frames,
        length + 1,
        "a frame after the reset and after each step, the last one too"
    );
    assert_eq!(record("cut.gif", &["--max-frames", "3"]).0, 3);
    for options in [
        ["--seed", "1"],
        ["--policy", "good"],
        ["--kwargs", r#"{"sutton_barto_reward": true}"#],
    ] {
        let (_, other) = record("other.gif", &options);
        // the reward is in no picture
        assert_eq!(other == plain, options[0] == "--kwargs", "{options:?}");
    }
    let lake = |kwargs: &str| {
        let path = out.join("lake.gif");
        prints(&[
            "gif",
            "FrozenLake-v1",
            "--kwargs",
            kwargs,
            "--out",
            path.to_str().unwrap(),
        ]);
        std::fs::read(path).unwrap()
    };
    assert_ne!(lake("{}"), lake(r#"{"map_name": "8x8"}"#));
}

/// Where nothing else is random, the actions are.
#[test]
fn run_draws_other_actions_from_other_seeds() {
    let lake = r#"{"is_slippery": false}"#;
    let text = prints(&["run", "FrozenLake-v1", "--kwargs", lake, "--seeds", "0..8"]);
    let lengths = text
        .lines()
        .skip(1)
        .take(8)
        .map(|line| line.split_whitespace().nth(2));
    assert!(
        lengths.collect::<std::collections::BTreeSet<_>>().len() > 2,
        "{text}"
    );
}

/// The state of a MuJoCo task stands beside its observation.
#[test]
fn replay_writes_the_state() {
    let out = folder("replay-state");
    let recorded = r#"{"id": "InvertedPendulum-v5", "events": [
        {"reset": {"seed": 1, "options": null}, "observation": [0, 0, 0, 0], "state": {"qpos": [0, 0], "qvel": [0, 0]}}
    ]}"#;
    let trace = out.join("trace.json");
    std::fs::write(&trace, recorded).unwrap();
    let answers = out.join("answers");
    prints(&[
        "replay",
        "--out",
        answers.to_str().unwrap(),
        trace.to_str().unwrap(),
    ]);
    let answer = &json(&answers.join("trace.json"))["events"][0];
    let numbers = |json: &Json| json.as_array().unwrap().clone();
    let state = [
        numbers(&answer["state"]["qpos"]),
        numbers(&answer["state"]["qvel"]),
    ]
    .concat();
    assert_eq!(
        state,
        numbers(&answer["observation"]),
        "two positions, two velocities"
    );
    assert_ne!(state[0], state[2]);
}

/// One trace that differs is enough, beside others that do not.
#[test]
fn replay_fails_if_one_trace_does() {
    let out = folder("replay-some");
    let recorded = r#"{"id": "FrozenLake-v1", "events": [{"reset": {"seed": 1, "options": null}, "observation": 0}]}"#;
    let [good, bad] = ["good", "bad"].map(|name| out.join(name).with_extension("json"));
    std::fs::write(&good, recorded).unwrap();
    std::fs::write(
        &bad,
        recorded.replace(r#""observation": 0"#, r#""observation": 3"#),
    )
    .unwrap();
    let [good, bad] = [good.to_str().unwrap(), bad.to_str().unwrap()];
    for order in [[good, bad], [bad, good]] {
        let error = fails(&["replay", order[0], order[1]]);
        assert!(error.contains("1 of 2 traces failed"), "{error}");
    }
    assert!(fails(&["replay", bad, good, bad]).contains("2 of 3 traces failed"));
    assert_eq!(
        fails(&["replay", "/nonexistent/a.json"])
            .matches("a.json")
            .count(),
        1,
        "it is named once"
    );
    prints(&["replay", good]);
}

/// A reader that has seen enough ends a command; a full disk is an error. `println!` panics at
/// both.
#[cfg(target_os = "linux")]
#[test]
fn an_output_that_cannot_be_written_is_no_panic() {
    use std::process::Stdio;

    let full = || {
        Stdio::from(
            std::fs::OpenOptions::new()
                .write(true)
                .open("/dev/full")
                .unwrap(),
        )
    };
    let run = |arguments: &[&str], stdout: Stdio, stderr: Stdio| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_xtask-commands"));
        let output = command
            .args(arguments)
            .stdout(stdout)
            .stderr(stderr)
            .spawn()
            .unwrap()
            .wait_with_output();
        let output = output.unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    for arguments in [
        &["list"][..],
        &["list", "--long"],
        &["run", "CartPole-v1", "--seeds", "0..2"],
        &["soak", "CartPole-v1", "--steps", "100"],
        &["mjcf", "../../crates/gym-mujoco/models/ant.xml"],
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let (code, said) = run(arguments, writer.into(), Stdio::piped());
        assert!(
            code == Some(0) && !said.contains("error") && !said.contains("panic"),
            "{arguments:?}: {said}"
        );
        let (code, said) = run(arguments, full(), Stdio::piped());
        assert!(
            code == Some(1) && said.contains("error: standard output: No space left"),
            "{arguments:?}: {said}"
        );
    }
    assert_eq!(
        run(&["run", "CartPoleee-v1"], Stdio::null(), full()).0,
        Some(1)
    );
}

#[test]
fn seconds_of_a_benchmark_are_a_time() {
    for seconds in ["1e300", "nan", "inf", "-1", "x"] {
        let error = fails(&[
            "bench",
            "CartPole-v1",
            "--kind",
            "make",
            "--seconds",
            seconds,
        ]);
        assert!(
            error.contains("seconds are a number from 0 to"),
            "{seconds}: {error}"
        );
    }
    let of_cartpole = ["bench", "CartPole-v1", "--kind", "make", "--seconds", "0"];
    assert!(!prints(&of_cartpole).contains("GIF"));
    assert!(
        prints(&[&of_cartpole[..], &["--gif"]].concat())
            .contains("a GIF of 500 frames of CartPole-v1")
    );
}

#[test]
fn replay_loses_no_recording() {
    let out = folder("replay-names");
    let recorded = r#"{"id": "FrozenLake-v1", "events": [{"reset": {"seed": 1, "options": null}, "observation": 0}]}"#;
    let path = |name: &str| {
        let path = out.join(name).join("c.json");
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, recorded).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let [a, b] = ["a", "b"].map(path);
    let answers = out.join("d");
    let error = fails(&["replay", &a, &b, "--out", answers.to_str().unwrap()]);
    assert!(error.contains("would both be written to"), "{error}");
    assert!(
        !answers.join("c.json").exists(),
        "nothing is written before"
    );
    for out in [out.join("a"), out.join("b/../a")] {
        let error = fails(&["replay", &a, "--out", out.to_str().unwrap()]);
        assert!(
            error.contains("is a recording to replay: choose another folder"),
            "{error}"
        );
    }
    assert_eq!(std::fs::read_to_string(&a).unwrap(), recorded);
    prints(&["replay", &a, &a, "--out", answers.to_str().unwrap()]);
}

#[test]
fn a_trace_without_events_is_not_equal() {
    let trace = folder("replay-empty").join("trace.json");
    std::fs::write(&trace, r#"{"id": "FrozenLake-v1", "events": []}"#).unwrap();
    assert!(fails(&["replay", trace.to_str().unwrap()]).contains("nothing to compare"));
}

/// A file without end is read up to a limit.
#[cfg(target_os = "linux")]
#[test]
fn endless_files_are_refused() {
    assert!(fails(&["replay", "/dev/zero"]).contains("larger than a recording can be"));
    assert!(fails(&["mjcf", "/dev/zero"]).contains("the limit is"));
}

#[test]
fn run_refuses_names_before_it_plays() {
    let out = folder("run-names");
    let [bmp, svg, detour] = ["a.bmp", "a.svg", "../run-names/a.svg"]
        .map(|name| out.join(name).to_str().unwrap().to_owned());
    for (options, message) in [
        (&["--plot", &bmp][..], "the extensions are .svg and .png"),
        (&["--plot", &svg, "--json", &svg], "name one file"),
        (&["--plot", &svg, "--json", &detour], "name one file"),
    ] {
        let output = xtask(&[&["run", "CartPole-v1"], options].concat());
        assert!(
            !output.status.success() && output.stdout.is_empty(),
            "{options:?}: it plays first"
        );
        assert!(
            String::from_utf8_lossy(&output.stderr).contains(message),
            "{options:?}"
        );
    }
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0);
}

/// Results can go to the standard output, which is not replaced as a file.
#[cfg(target_os = "linux")]
#[test]
fn json_goes_to_the_standard_output() {
    let text = prints(&[
        "run",
        "CartPole-v1",
        "--seeds",
        "0..1",
        "--json",
        "/dev/stdout",
    ]);
    let (table, json) = text.split_at(text.find("[{").expect("a list"));
    assert!(table.starts_with("    seed"), "{table}");
    let episodes: Json = serde_json::from_str(json).expect("JSON");
    assert_eq!(episodes[0]["seed"], 0);
}

#[test]
fn a_plot_has_the_format_of_its_name() {
    let out = folder("run-plots");
    for (name, begins) in [("a.svg", &b"<svg"[..]), ("a.png", b"\x89PNG\r\n")] {
        let file = out.join(name);
        prints(&[
            "run",
            "CartPole-v1",
            "--seeds",
            "0..2",
            "--plot",
            file.to_str().unwrap(),
        ]);
        let bytes = std::fs::read(&file).expect("the plot");
        assert!(
            bytes.starts_with(begins),
            "{name}: {:?}",
            &bytes[..bytes.len().min(40)]
        );
    }
}
