//! Episodes and pictures of minigrid, by checksum: `record.py` recorded them.

use gym_core::render::{RenderMode, Rendered};
use gym_core::{BoxEnv, Env, EnvExt, Space, Value, WrapperSpec, builder, make};
use gym_minigrid as _;
use gym_render as _;

/// The CRC-32 of all observations and rewards so far.
#[derive(Clone, Default)]
struct Seen(crc32fast::Hasher);

impl Seen {
    fn observation(&mut self, observation: &Value) {
        let part = |key: &str| observation.get(key).unwrap();
        self.0
            .update(&part("direction").as_int().unwrap().to_le_bytes());
        self.0.update(part("image").as_slice::<u8>().unwrap());
        self.0.update(part("mission").as_text().unwrap().as_bytes());
    }

    /// Adds every array of a wrapper's observation.
    fn parts(&mut self, observation: &Value) {
        match observation {
            Value::Dict(entries) => entries.iter().for_each(|(_, part)| self.parts(part)),
            Value::Int(number) => self.0.update(&number.to_le_bytes()),
            Value::Text(text) => self.0.update(text.as_bytes()),
            Value::Array(array) => self.0.update(&array.to_bytes()),
            other => panic!("{other}"),
        }
    }

    fn checksum(&self) -> String {
        format!("{:08x}", self.0.clone().finalize())
    }
}

fn picture(env: &mut BoxEnv) -> String {
    let Rendered::Frame(frame) = env.render().unwrap() else {
        panic!("no frame");
    };
    format!("{:08x}", crc32fast::hash(frame.pixels()))
}

/// Returns the next state of the generator of actions.
fn next(state: u64) -> u64 {
    state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407)
}

/// Plays the episode of a line. Returns the first checksum of the line that differs.
fn difference(line: &str) -> Option<String> {
    let mut words = line.split(' ');
    let (id, seed) = (words.next()?, words.next()?.parse::<u64>().unwrap());
    let marks: Vec<(&str, &str)> = words.map(|mark| mark.split_once(':').unwrap()).collect();
    let mut env = match builder(id).render_mode(RenderMode::RgbArray).build() {
        Ok(env) => env,
        Err(error) => return Some(format!("{id}: {error}")),
    };
    let Space::Discrete(actions) = env.action_space() else {
        panic!("{id} has no discrete actions");
    };
    let (mut seen, mut state) = (Seen::default(), seed);
    let mut observation = env.reset(seed).unwrap();
    seen.observation(&observation);
    let mut step = 0;
    for (mark, expected) in marks {
        let at = mark.trim_start_matches('f').parse().unwrap();
        while step < at {
            step += 1;
            state = next(state);
            let action = (state >> 33) as i64 % actions.n();
            let outcome = env
                .step_into(&Value::Int(action), &mut observation)
                .unwrap();
            seen.observation(&observation);
            seen.0.update(&outcome.reward.to_le_bytes());
            seen.0
                .update(&[outcome.terminated.into(), outcome.truncated.into()]);
            if outcome.done() {
                env.reset_into(&().into(), &mut observation).unwrap();
                seen.observation(&observation);
            }
        }
        let found = if mark.starts_with('f') {
            picture(&mut env)
        } else {
            seen.checksum()
        };
        if found != expected {
            return Some(format!("{id}, seed {seed}: mark {mark}"));
        }
    }
    None
}

#[test]
fn episodes_and_pictures_are_minigrids() {
    // another recording can be given, such as a recording of all steps
    let given = std::env::var("MINIGRID_EPISODES").ok();
    let lines = given.map_or_else(
        || include_str!("episodes.txt").to_owned(),
        |path| std::fs::read_to_string(path).unwrap(),
    );
    let differing: Vec<String> = lines.lines().filter_map(difference).collect();
    let count = lines.lines().count();
    assert!(count > 0);
    assert!(
        differing.is_empty(),
        "{} of {count} episodes differ:\n{}",
        differing.len(),
        differing.join("\n")
    );
}

/// Covers other tile sizes, frames with and without highlighting, and frames of the agent's view.
#[test]
fn pictures_of_every_size_are_minigrids() {
    let lines = include_str!("pictures.txt");
    assert!(lines.lines().count() > 100);
    for line in lines.lines() {
        let [id, size, highlight, agent_pov, expected] = line.split(' ').collect::<Vec<_>>()[..]
        else {
            panic!("{line}");
        };
        let seed: u64 = size.parse().unwrap();
        let mut env = builder(id)
            .arg("tile_size", seed)
            .arg("highlight", highlight == "1")
            .arg("agent_pov", agent_pov == "1")
            .render_mode(RenderMode::RgbArray)
            .build()
            .unwrap();
        let Space::Discrete(actions) = env.action_space() else {
            panic!("{id} has no discrete actions");
        };
        env.reset(seed).unwrap();
        let mut state = seed;
        for _ in 0..10 {
            state = next(state);
            let action = (state >> 33) as i64 % actions.n();
            if env.step(&Value::Int(action)).unwrap().done() {
                env.reset(()).unwrap();
            }
        }
        assert_eq!(picture(&mut env), expected, "{line}");
    }
}

/// Turns on the spot, which ends no episode, until the limit.
#[test]
fn limits_are_minigrids() {
    let lines = include_str!("limits.txt");
    assert_eq!(lines.lines().count(), 172);
    for line in lines.lines() {
        let mut words = line.split(' ');
        let mut env = make(words.next().unwrap()).unwrap();
        for (seed, limit) in words.enumerate() {
            let mut observation = env.reset(seed as u64).unwrap();
            let mut steps = 1;
            let turn = Value::Int(0);
            while !env.step_into(&turn, &mut observation).unwrap().done() {
                steps += 1;
            }
            assert_eq!(steps.to_string(), limit, "{line}, seed {seed}");
        }
    }
}

#[test]
fn wrappers_are_minigrids() {
    let lines = include_str!("wrappers.txt");
    assert!(lines.lines().count() > 60);
    for line in lines.lines() {
        let [id, name, kwargs, expected] = line.split(' ').collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        let spec = WrapperSpec {
            name: name.to_owned(),
            kwargs: serde_json::from_str(kwargs).unwrap(),
        };
        let mut env = spec.wrap(make(id).unwrap()).unwrap();
        let Space::Discrete(actions) = env.action_space() else {
            panic!("{id} has no discrete actions");
        };
        let (mut seen, mut state) = (Seen::default(), 9);
        seen.parts(&env.reset(9).unwrap());
        for _ in 0..60 {
            state = next(state);
            let after = env
                .step(&Value::Int((state >> 33) as i64 % actions.n()))
                .unwrap();
            seen.parts(&after.observation);
            seen.0.update(&after.reward.to_le_bytes());
            seen.0
                .update(&[after.terminated.into(), after.truncated.into()]);
            if after.done() {
                seen.parts(&env.reset(()).unwrap());
            }
        }
        assert_eq!(seen.checksum(), expected, "{line}");
    }
}
