//! Episodes and pictures of minigrid, by checksum: `record.py` recorded them.

use gym_core::render::{RenderMode, Rendered};
use gym_core::{BoxEnv, Env, EnvExt, Space, Value, builder};
use gym_minigrid as _;
use gym_render as _;

/// The CRC-32 of all that happened so far.
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

/// The first mark of a line that differs.
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
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
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
    // another recording can be given, such as one of all steps
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
