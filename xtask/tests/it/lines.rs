//! Command lines by lot, from options and values that seldom fit each other.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use super::{folder, program};

/// Commands, what each line of them has, and their options. All of these lines end soon.
const COMMANDS: [(&str, &[&str], &[&str]); 8] = [
    ("list", &[], &["--long"]),
    (
        "gif",
        &[],
        &["--policy", "--seed", "--kwargs", "--max-frames", "--out"],
    ),
    (
        "run",
        &[],
        &["--policy", "--seeds", "--kwargs", "--json", "--plot"],
    ),
    ("replay", &[], &["--out"]),
    ("new", &[], &["--path", "--native"]),
    (
        "bench",
        &["Taxi-v3", "--seconds", "0.001"],
        &["--num-envs", "--kind", "--json"],
    ),
    (
        "mjcf",
        &[],
        &[
            "--mujoco",
            "--keyframe",
            "--steps",
            "--seed",
            "--out",
            "--size",
            "--camera",
            "--distance",
        ],
    ),
    (
        "play",
        &["--terminal"],
        &[
            "--seed",
            "--kwargs",
            "--fps",
            "--zoom",
            "--key",
            "--idle",
            "--episodes",
            "--record",
            "--trace",
        ],
    ),
];

const IDS: [&str; 9] = [
    "CartPole-v1",
    "CartPole",
    "FrozenLake-v1",
    "Taxi-v3",
    "MiniGrid-Empty-5x5-v0",
    "Blackjack-v1",
    "ALE/Pong-v5",
    "GymV26Environment-v0",
    "Nope-v1",
];

const VALUES: [&str; 52] = [
    "0",
    "1",
    "2",
    "-1",
    "20",
    "1e400",
    "nan",
    "18446744073709551616",
    "0x10",
    "",
    " ",
    "é",
    "\u{1b}[2J",
    "{",
    "{}",
    "[]",
    "null",
    "{\"length\":\"x\"}",
    "{\"length\":-1}",
    "{\"desc\":[\"SFG\"]}",
    "{\"gravity\":1e308}",
    "{\"render_mode\":\"x\"}",
    "random",
    "good",
    "m.xml",
    "trace.json",
    "cut.json",
    "file",
    "folder",
    "none",
    "/dev/null",
    "/dev/full",
    "/dev/zero",
    "to",
    "to.gif",
    "to.png",
    "to.svg",
    "to.txt",
    "folder/to.gif",
    "none/to.gif",
    "file/to.gif",
    "1x1",
    "0x0",
    "100000x100000",
    "0..2",
    "2..0",
    "a=1",
    "=",
    "--",
    "-",
    "native",
    "3.12",
];

/// What is in the folder of each line.
const FILES: [(&str, &str); 4] = [
    (
        "m.xml",
        "<mujoco><worldbody><body><freejoint/><geom size=\".1\"/></body></worldbody></mujoco>",
    ),
    (
        "trace.json",
        "{\"id\":\"CartPole-v1\",\"events\":[{\"reset\":{\"seed\":1}},{\"step\":0}]}",
    ),
    ("cut.json", "{\"id\":"),
    ("file", ""),
];

/// Numbers that SplitMix64 draws.
struct Lot(u64);

impl Lot {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (x ^ x >> 31) as usize % n
    }

    fn one_of(&mut self, from: &[&'static str]) -> &'static str {
        from[self.below(from.len())]
    }

    fn line(&mut self) -> Vec<&'static str> {
        let (command, always, options) = COMMANDS[self.below(COMMANDS.len())];
        let mut line = [&[command], always].concat();
        for _ in 0..self.below(3) {
            let ids = self.below(4) > 0;
            line.push(self.one_of(if ids { &IDS } else { &VALUES }));
        }
        for _ in 0..self.below(4) {
            line.push(self.one_of(options));
            if self.below(5) > 0 {
                line.push(self.one_of(&VALUES));
            }
        }
        line
    }
}

fn names(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = names
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Every line ends, and without a panic. If it fails, it says why, and leaves nothing behind.
///
/// `GYM_LINES` is the number of lines, if not 200.
#[test]
fn lines_by_lot_do_something_or_say_why_not() {
    let count = std::env::var("GYM_LINES").map_or(200, |count| count.parse().unwrap());
    for number in 0..count {
        let home = folder("lines");
        for (name, text) in FILES {
            fs::write(home.join(name), text).unwrap();
        }
        fs::create_dir(home.join("folder")).unwrap();
        let line = Lot(number).line();
        let output = program()
            .args(&line)
            .current_dir(&home)
            .env_remove("DISPLAY")
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let [said, told] =
            [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
        let code = output.status.code();
        let all = format!("line {number}, {line:?}: {code:?}\n{said}\n{told}");
        assert!(
            matches!(code, Some(0..=2)) && !told.contains("panicked"),
            "{all}"
        );
        assert!(!said.is_empty() || !told.is_empty(), "{all}");
        // answers to other recordings stay
        if code != Some(0) && line[0] != "replay" {
            assert_eq!(
                names(&home),
                ["cut.json", "file", "folder", "m.xml", "trace.json"],
                "{all}"
            );
            assert_eq!(names(&home.join("folder")), [""; 0], "{all}");
        }
    }
}
