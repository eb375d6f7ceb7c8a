//! Tests of each command.

use super::{fails, first_word, folder, json, prints, program, xtask};

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

    let mut without_roms = program();
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

/// Returns the ids of the table that the demo prints.
fn played(table: &str) -> Vec<&str> {
    let rows = table.lines().filter(|line| line.contains(" return "));
    rows.map(first_word).collect()
}

/// One page shows a moving picture, the spaces, the results and a command for each task, family by
/// family.
#[test]
fn demo() {
    let out = folder("demo");
    let mut program = program();
    program.args(["demo", "--episodes", "3", "--max-frames", "8"]);
    program.args(["--out".as_ref(), out.as_os_str()]);
    let output = program
        .env("ALE_ROMS_DIR", folder("no-roms"))
        .output()
        .unwrap();
    let table = super::said(&output, &["demo"]);
    let ids = played(&table);
    assert!((70..85).contains(&ids.len()), "one for each page: {ids:?}");
    let place = |id: &str| ids.iter().position(|other| *other == id).expect(id);
    let in_order = [
        "Acrobot-v1",
        "CartPole-v1",
        "FrozenLake-v1",
        "LunarLander-v3",
        "Ant-v5",
        "dm_control/acrobot-swingup-v0",
    ];
    let first_of_family: Vec<_> = in_order.map(place).into();
    assert!(first_of_family.is_sorted(), "{ids:?}");
    for other in ["CartPole-v0", "Ant-v4", "rapier/LunarLander-v3"] {
        assert!(!ids.contains(&other), "{other} is played by --all");
    }

    let files: Vec<_> = std::fs::read_dir(&out).unwrap().collect();
    assert_eq!(files.len(), 1, "{files:?}");
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.ends_with("</html>\n") && !page.contains("so far"));
    assert!(
        !page.contains("http") && !page.contains("src=\"i"),
        "it needs no other file"
    );
    assert_eq!(page.matches("<article>").count(), ids.len());
    assert_eq!(
        page.matches("src=\"data:image/gif;base64,").count(),
        ids.len()
    );
    for heading in ["Classic control", "Toy text", "Box2D", "MuJoCo", "Atari"] {
        assert!(page.contains(&format!("<h2>{heading}</h2>")), "{heading}");
    }
    let card = |id: &str| {
        let (_, card) = page.split_once(&format!("<h3>{id}</h3>")).expect(id);
        card.split("</article>").next().unwrap_or_default()
    };
    for (id, words) in [
        (
            "CartPole-v1",
            "cargo xtask run CartPole-v1 --policy good --seeds 0..3",
        ),
        ("CartPole-v1", "Discrete(2)"),
        ("CartPole-v1", "return <b>500.00</b>"),
        ("CartPole-v1", "length <b>500.00</b>"),
        ("Taxi-v4", "cargo xtask play Taxi-v4"),
        ("CarRacing-v3", "Box(0, 255, (96, 96, 3), uint8)"),
    ] {
        assert!(card(id).contains(words), "{id}: {}", card(id));
    }
    // what was left out, and what to do
    for text in [&table, &page] {
        assert!(text.contains("pip install ale-py"), "{table}");
        assert!(text.contains("env_id"), "{table}");
    }
    // the command of a card repeats its numbers
    for id in ["Pendulum-v1", "Taxi-v4", "BipedalWalker-v3", "Hopper-v5"] {
        let (_, command) = card(id).split_once("<code>cargo xtask run ").expect(id);
        let mut arguments = vec!["run"];
        arguments.extend(
            command
                .split('<')
                .next()
                .unwrap_or_default()
                .split_whitespace(),
        );
        let again = prints(&arguments);
        let row = table.lines().find(|line| first_word(line) == id);
        let [one, other] = [row, again.lines().last()]
            .map(|line| line.and_then(|line| line.split_once("return")).expect(id).1);
        assert_eq!(one, other, "{arguments:?}");
    }
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

/// The policy `good` is better than random actions.
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
    // `heuristic` is Gymnasium's name for the policy `good`
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
        "gym_toytext",
        "serde_json",
        "flate2",
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

/// What `new` writes has its names, and nothing that stands for another. (The weekly tests build it.)
#[test]
fn new_writes_every_name() {
    fn texts(folder: &std::path::Path, all: &mut Vec<(std::path::PathBuf, String)>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                texts(&path, all);
            } else if path.file_name().unwrap() != "Cargo.lock" {
                let text = std::fs::read_to_string(&path).unwrap();
                all.push((path, text));
            }
        }
    }
    let parent = folder("new-names");
    for (options, task) in [(&[][..], "Corridor"), (&["--native"], "Rocket")] {
        let plugin = parent.join(task);
        let path = plugin.to_str().unwrap();
        let said = prints(&[&["new", "my_envs", "--path", path], options].concat());
        let first = said.lines().next().unwrap();
        assert_eq!(
            first,
            format!("{path} has the environment `my_envs/{task}-v0`. In that folder:")
        );
        let mut all = Vec::new();
        texts(&plugin, &mut all);
        for (path, text) in &all {
            for other in ["plugin_name", "TASK_", "GYM_C", "GYM_N", "GYM_R"] {
                assert!(!text.contains(other), "{}: {other}", path.display());
            }
        }
        let file = |name: &str| {
            let path = plugin.join(name);
            let found = all.iter().find(|(other, _)| *other == path);
            &found.unwrap_or_else(|| panic!("{name} of {task}")).1
        };
        let readme = file("README.md");
        assert!(readme.contains(&format!("my_envs/{task}-v0")), "{readme}");
        let source = format!("src/{}.rs", task.to_lowercase());
        assert!(file(&source).contains(task), "{source}");
        let manifest = file("Cargo.toml");
        assert!(manifest.contains("name = \"my_envs\""), "{manifest}");
        assert_eq!(
            manifest.contains("gym-native"),
            task == "Rocket",
            "{manifest}"
        );
        // each dependency is the package of its name
        let manifests = all.iter().filter(|(path, _)| path.ends_with("Cargo.toml"));
        let lines = manifests.flat_map(|(_, text)| text.lines());
        let of_this_workspace = lines.filter_map(|line| {
            let (name, rest) = line.split_once(" = {")?;
            let (_, path) = rest.split_once("path = \"")?;
            Some((name, path.split('"').next()?))
        });
        let mut named = 0;
        for (name, path) in of_this_workspace.filter(|(_, path)| path.contains("crates")) {
            assert_eq!(path.rsplit('/').next(), Some(name), "{task}");
            let manifest = std::path::Path::new(path).join("Cargo.toml");
            assert!(manifest.exists(), "{}", manifest.display());
            named += 1;
        }
        assert!(named >= 4, "{manifest}");
        let lock = std::fs::read(plugin.join("Cargo.lock")).unwrap();
        assert_eq!(lock, std::fs::read("../Cargo.lock").unwrap());
    }
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
        // 20,000 steps of each environment: an episode of CartPole has about 20 steps, an episode
        // of Taxi at most 200
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

/// The table shows how each episode ended. The last line has the means of the rows.
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
    // each step has the reward 1
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
    // (the minimum of positive returns must not be 0)
    let [one, other] = [1, 2].map(|row| poles[row][1].parse::<f64>().unwrap());
    assert_eq!(poles[3][2], format!("[{:.1},", one.min(other)), "{poles:?}");
}

/// The seed decides the actions, even if nothing else is random.
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

/// Messages quote arguments shortened and without control characters.
#[test]
fn messages_quote_what_was_typed_safely() {
    let huge = "CartPole".repeat(12_500);
    let names = [
        "\u{1b}[2J\u{1b}]0;title\u{7}",
        "Cart\u{202e}Pole-v1",
        "my\u{9b}envs/X\u{2066}-v0",
        &huge,
    ];
    for name in names {
        let kwargs = serde_json::json!({ name: 1 }).to_string();
        for arguments in [
            &["run", name][..],
            &["gif", name],
            &["play", "--terminal", name],
            &["bench", name],
            &["soak", name],
            &["run", "CartPole-v1", "--kwargs", &kwargs],
            &["run", "CartPole-v1", "--seeds", name],
            &["run", "CartPole-v1", "--policy", name],
            &["run", "CartPole-v1", "--plot", name],
            &["replay", name],
            &["new", name],
            &[name],
        ] {
            let start = std::time::Instant::now();
            let said = fails(arguments);
            assert!(start.elapsed().as_secs() < 3, "{:?}", &arguments[..1]);
            let hidden = |c: char| (c.is_control() && c != '\n') || "\u{202e}\u{2066}".contains(c);
            assert!(!said.contains(hidden), "{arguments:?}: {said:?}");
            assert!(said.len() < 8000, "{}: {}", arguments[0], said.len());
        }
    }
}

#[test]
fn numbers_that_no_command_can_use_are_refused_in_its_own_words() {
    for arguments in [
        ["gif", "CartPole-v1", "--max-frames"],
        ["demo", "--episodes=1", "--max-frames"],
        ["play", "CartPole-v1", "--episodes"],
        ["play", "CartPole-v1", "--fps"],
        ["bench", "CartPole-v1", "--num-envs"],
        ["soak", "CartPole-v1", "--steps"],
    ] {
        let error = fails(&[&arguments[..], &["0"]].concat());
        let option = arguments[2];
        assert!(
            error.contains(&format!("invalid value '0' for '{option}")),
            "{error}"
        );
    }
}

#[test]
fn arguments_of_an_environment_are_taken_as_they_stand_or_refused() {
    for (kwargs, message) in [
        (
            r#"{"gravity": 1, "gravity": 2}"#,
            "the key `gravity` stands twice",
        ),
        (
            r#"{"max_episode_steps": -5}"#,
            "max_episode_steps is -5: it must be at least 1",
        ),
        (
            r#"{"max_episode_steps": 0}"#,
            "max_episode_steps is 0: it must be at least 1",
        ),
        (
            r#"{"length": 5e-324}"#,
            "length is 5e-324: its absolute value must be at least 1e-6",
        ),
        (
            r#"{"length": 0}"#,
            "length is 0.0: its absolute value must be at least 1e-6",
        ),
    ] {
        let error = fails(&["run", "CartPole-v1", "--kwargs", kwargs]);
        assert!(error.contains(message), "{error}");
    }
    let limits = |kwargs: &str| {
        let text = prints(&["run", "Pendulum-v1", "--seeds=0..1", "--kwargs", kwargs]);
        text.lines()
            .nth(1)
            .and_then(|row| row.split_whitespace().nth(2).map(str::to_owned))
    };
    assert_eq!(limits(r#"{"max_episode_steps": 3}"#).as_deref(), Some("3"));
    let error = fails(&["play", "Taxi-v4", "--terminal", "--key=A=0", "--key=a=1"]);
    assert!(error.contains("`a` has two actions"), "{error}");
}

/// A level of a billion steps, which random actions do not solve.
#[test]
fn a_recording_ends_where_the_episode_does_not() {
    let gif = folder("endless").join("level.gif");
    let path = gif.to_str().unwrap();
    let kwargs = r#"{"max_steps": 1000000000}"#;
    let options = ["--kwargs", kwargs, "--max-frames", "3", "--out", path];
    let said = prints(&[&["gif", "BabyAI-BossLevel-v0"], &options[..]].concat());
    assert!(said.ends_with(": 3 frames\n"), "{said}");
}

#[test]
fn what_only_a_plugin_or_one_environment_can_do_is_refused_elsewhere() {
    let error = fails(&["python"]);
    let words =
        "the environments of this workspace are in rustgym: `pip install ./crates/gym-python`";
    assert!(error.contains(words), "{error}");
    let error = fails(&["bench", "--only-steps", "3"]);
    assert!(error.contains("name an id, a kind and a number"), "{error}");
}
