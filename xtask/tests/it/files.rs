//! Tests of the files that commands write, and of outputs that fail.

use super::{fails, folder, json, prints, program, xtask};

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

/// Neither a file nor a folder is left by a command that fails, and what was there stays.
#[test]
fn a_command_that_fails_leaves_nothing() {
    let folder = folder("leaves-nothing");
    let there = [
        ("file", "text"),
        ("cut.json", "{\"id\":"),
        ("cut.xml", "<mujoco><worldbody><geom/></worldbody></mujoco>"),
        (
            "m.xml",
            "<mujoco><worldbody><body><freejoint/><geom size=\".1\"/></body></worldbody></mujoco>",
        ),
    ];
    for (name, text) in there {
        std::fs::write(folder.join(name), text).unwrap();
    }
    for line in [
        "replay none --out to",
        "replay cut.json file none --out to/deep",
        "replay / --out to",
        "gif Nope-v1 --out to.gif",
        "gif CartPole-v1 --out to.txt",
        "gif CartPole-v1 --out none/to.gif",
        "gif CartPole-v1 --kwargs {\"length\":0} --out to.gif",
        "run Nope-v1 --json to.json --plot to.svg",
        "run CartPole-v1 --json to.json --plot to.txt",
        "run CartPole-v1 --json to.json --plot none/to.svg",
        "run CartPole-v1 --json to.svg --plot to.svg",
        "new 9 --path to",
        "new ok --path file/to",
        "new ok --path file",
        "bench Nope-v1 --json to.json",
        "bench CartPole-v1 --json none/to.json",
        "mjcf cut.xml --out to.png",
        "mjcf m.xml --out to.gif",
        "mjcf m.xml --out to.png --camera none",
        "mjcf m.xml --out none/to.png",
        "demo --out file",
        "demo --out file/to",
        "demo --out to --episodes 0",
        "play Nope-v1 --terminal --record to.gif --trace to.json",
        "play CartPole-v1 --terminal --record to.gif --trace to.json",
        "play FrozenLake-v1 --terminal --record to.gif --trace to.json --key A=9",
        "play FrozenLake-v1 --terminal --record to.gif --trace to.json --key A=1 --key a=2",
        "play FrozenLake-v1 --terminal --record to.gif --trace none/to.json",
        "play FrozenLake-v1 --terminal --record to.txt --trace to.json",
    ] {
        let arguments = line.split(' ');
        let output = program()
            .args(arguments)
            .current_dir(&folder)
            .output()
            .unwrap();
        assert!(
            !output.status.success() && !output.stderr.is_empty(),
            "{line}"
        );
        let names = std::fs::read_dir(&folder).unwrap();
        let mut names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["cut.json", "cut.xml", "file", "m.xml"], "{line}");
    }
    for (name, text) in there {
        assert_eq!(std::fs::read_to_string(folder.join(name)).unwrap(), text);
    }
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
        // the reward does not change the picture
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

/// A closed pipe ends a command; a full disk is an error. (`println!` would panic in both cases.)
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
        let mut command = program();
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
        &["mjcf", "../crates/gym-mujoco/models/ant.xml"],
        &["help"],
        &["run", "--help"],
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

/// A closed pipe ends only the printing. The command still writes its files, and its exit status is
/// the status of the work.
#[test]
fn a_closed_pipe_ends_the_printing_alone() {
    use std::io::Write;
    use std::process::Stdio;

    let out = folder("closed-pipe");
    let path = |name: &str| out.join(name).to_str().unwrap().to_owned();
    let run = |arguments: &[&str]| {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut child = program()
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(writer)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let keys = child.stdin.take().unwrap().write_all(b"Right\nq\n");
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(!said.contains("panic"), "{arguments:?}: {said}");
        drop(keys);
        (output.status.code(), said)
    };
    let (episodes, plot) = (path("episodes.json"), path("episodes.svg"));
    let options = ["--seeds", "0..7", "--json", &episodes, "--plot", &plot];
    let (code, said) = run(&[&["run", "CartPole-v1"], &options[..]].concat());
    assert_eq!((code, &*said), (Some(0), ""));
    assert_eq!(
        json(&out.join("episodes.json")).as_array().unwrap().len(),
        7
    );
    let (gif, trace, bench) = (path("a.gif"), path("trace.json"), path("bench.json"));
    run(&["gif", "CartPole-v1", "--max-frames", "3", "--out", &gif]);
    run(&[
        "play",
        "FrozenLake-v1",
        "--seed=0",
        "--terminal",
        "--trace",
        &trace,
    ]);
    run(&[
        "bench",
        "CartPole-v1",
        "--kind=make",
        "--seconds=0",
        "--json",
        &bench,
    ]);
    for file in [&plot, &gif, &trace, &bench] {
        assert!(
            std::fs::metadata(file).is_ok_and(|file| file.len() > 50),
            "{file}"
        );
    }
    assert_eq!(
        json(&out.join("trace.json"))["events"]
            .as_array()
            .unwrap()
            .len(),
        2
    );

    let recorded = std::fs::read_to_string(&trace).unwrap();
    let bad = path("bad.json");
    std::fs::write(
        &bad,
        recorded.replace(r#""step":2,"observation":"#, r#""step":2,"observation":1"#),
    )
    .unwrap();
    for traces in [[&*trace, &bad], [&bad, &trace]] {
        let (code, said) = run(&["replay", traces[0], traces[1]]);
        assert!(
            code == Some(1) && said.contains("1 of 2 traces failed"),
            "{said}"
        );
    }
    let unseeded = path("unseeded.json");
    run(&["play", "FrozenLake-v1", "--terminal", "--trace", &unseeded]);
    assert_eq!(run(&["replay", &trace, &unseeded]).0, Some(0));
    // an unknown id is an error with a closed pipe too
    assert_eq!(run(&["run", "CartPoleee-v1"]).0, Some(1));
}

/// If the video cannot be written, the command still writes the trace.
#[cfg(target_os = "linux")]
#[test]
fn a_trace_is_kept_if_the_video_fails() {
    use std::io::Write;
    use std::process::Stdio;

    let out = folder("full-video");
    std::os::unix::fs::symlink("/dev/full", out.join("video.gif")).unwrap();
    let mut child = program()
        .args(["play", "FrozenLake-v1", "--seed=0", "--terminal"])
        .args(["--record", "video.gif", "--trace", "trace.json"])
        .current_dir(&out)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut keys = child.stdin.take().unwrap();
    keys.write_all(b"Right\nDown\nq\n").unwrap();
    drop(keys);
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.code() == Some(1) && said.contains("video.gif: No space left"),
        "{said}"
    );
    let trace = json(&out.join("trace.json"));
    assert_eq!(trace["events"].as_array().unwrap().len(), 3);
}

/// Two paths of one file are refused, even if one path is a link and the file does not exist yet.
#[cfg(unix)]
#[test]
fn two_results_go_to_two_files() {
    let out = folder("links");
    let path = |name: &str| out.join(name).to_str().unwrap().to_owned();
    std::os::unix::fs::symlink("b.svg", out.join("a.svg")).unwrap();
    for names in [["a.svg", "b.svg"], ["b.svg", "a.svg"]] {
        let [json, plot] = names.map(path);
        let error = fails(&["run", "CartPole-v1", "--json", &json, "--plot", &plot]);
        assert!(
            error.contains("`--json` and `--plot` name one file"),
            "{error}"
        );
    }
    std::os::unix::fs::symlink("t.gif", out.join("u.gif")).unwrap();
    let [record, trace] = ["t.gif", "u.gif"].map(path);
    let arguments = [
        "play",
        "Taxi-v4",
        "--terminal",
        "--record",
        &record,
        "--trace",
        &trace,
    ];
    let error = fails(&arguments);
    assert!(
        error.contains("`--record` and `--trace` name one file"),
        "{error}"
    );
    assert!(!out.join("b.svg").exists() && !out.join("t.gif").exists());
}

#[test]
fn file_names_of_every_length_are_written() {
    let out = folder("long-names");
    for length in [200, 244, 250, 255] {
        let path = |extension: &str| {
            let name = "n".repeat(length - extension.len()) + extension;
            out.join(name).to_str().unwrap().to_owned()
        };
        let (json, plot) = (path(".json"), path(".svg"));
        prints(&[
            "run",
            "CartPole-v1",
            "--seeds=0..1",
            "--json",
            &json,
            "--plot",
            &plot,
        ]);
        let gif = path(".gif");
        prints(&["gif", "CartPole-v1", "--max-frames=2", "--out", &gif]);
        for file in [json, plot, gif] {
            assert!(
                std::fs::metadata(&file).is_ok_and(|file| file.len() > 50),
                "{file}"
            );
        }
    }
}

/// Ctrl+C or `kill` in the middle of a recording leaves no part of a file.
#[cfg(unix)]
#[test]
fn an_interrupted_command_leaves_no_partial_file() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let out = folder("interrupted");
    let gif = out.join("a.gif");
    let demo = ["demo", "--episodes=300", "--out", out.to_str().unwrap()];
    let frames = [
        "gif",
        "BipedalWalker-v3",
        "--max-frames=100000000",
        "--out",
        gif.to_str().unwrap(),
    ];
    // the demo has its first page, or the GIF is being written
    for (arguments, begun, signal, code) in [
        (&demo[..], "index.html", "-INT", 130),
        (&frames, ".gym-partial", "-INT", 130),
        (&frames, ".gym-partial", "-TERM", 143),
    ] {
        let mut child = program()
            .args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let names = || -> Vec<_> {
            let entries = std::fs::read_dir(&out).unwrap();
            entries
                .map(|entry| entry.unwrap().file_name().into_string().unwrap())
                .collect()
        };
        let is_partial = |name: &String| name.ends_with(".gym-partial");
        let start = Instant::now();
        while !names().iter().any(|name| name.ends_with(begun)) {
            assert!(
                start.elapsed() < Duration::from_secs(60),
                "nothing is written"
            );
            assert!(
                child.try_wait().unwrap().is_none(),
                "it has ended by itself"
            );
        }
        let pid = child.id().to_string();
        assert!(
            Command::new("kill")
                .args([signal, &pid])
                .status()
                .unwrap()
                .success()
        );
        let interrupted = Instant::now();
        while child.try_wait().unwrap().is_none() && interrupted.elapsed() < Duration::from_secs(60)
        {
            std::thread::sleep(Duration::from_millis(10));
        }
        child.kill().ok();
        assert_eq!(child.wait().unwrap().code(), Some(code));
        assert!(!names().iter().any(is_partial), "{:?}", names());
    }
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.contains("tasks so far") && page.ends_with("</html>\n"));
}

/// A file larger than `ulimit -f` is an error that names it, and nothing of it stays.
#[cfg(unix)]
#[test]
fn a_file_beyond_the_limit_of_the_shell_is_told() {
    let out = folder("limited");
    let (gif, plugin) = (out.join("a.gif"), out.join("my_envs"));
    for (arguments, named) in [
        (["gif", "CartPole-v1", "--out"], &gif),
        (["new", "my_envs", "--path"], &plugin),
    ] {
        let output = std::process::Command::new("sh")
            .args(["-c", "ulimit -f 1; exec \"$@\"", "sh"])
            .arg(program().get_program())
            .args(arguments)
            .arg(named)
            .output()
            .unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {told}");
        assert!(told.contains(named.to_str().unwrap()), "{told}");
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0, "{arguments:?}");
    }
}

/// The name of a file that is read or written is printed without control characters.
#[cfg(unix)]
#[test]
fn names_of_files_are_printed_safely() {
    let folder = folder("hostile-names");
    let name = "\u{1b}[2J\u{9b}\u{202e}";
    let model =
        "<mujoco><worldbody><body><freejoint/><geom size=\".1\"/></body></worldbody></mujoco>";
    let trace = r#"{"id":"CartPole-v1","events":[{"reset":{"seed":1}},{"step":0}]}"#;
    for (file, text) in [("xml", model), ("json", trace)] {
        std::fs::write(folder.join(format!("{name}.{file}")), text).unwrap();
    }
    let said = |line: &str| {
        let arguments = line.split(' ').map(|word| word.replace("NAME", name));
        let output = program()
            .args(arguments)
            .current_dir(&folder)
            .output()
            .unwrap();
        let [stdout, stderr] =
            [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        assert!(output.status.success(), "{line}: {stderr}");
        stdout + &stderr
    };
    let hidden = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
    for (line, names_it) in [
        ("gif CartPole-v1 --max-frames 2 --out NAME.gif", true),
        ("run CartPole-v1 --json NAMEs.json --plot NAME.svg", false),
        ("mjcf NAME.xml --out NAME.png", true),
        ("replay NAME.json --out NAME", false),
        ("replay NAME/NAME.json", true),
    ] {
        let text = said(line);
        assert!(!text.contains(hidden), "{line}: {text:?}");
        assert_eq!(text.contains("[2J"), names_it, "{line}: {text}");
    }
}
