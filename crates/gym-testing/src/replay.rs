use crc32fast::Hasher;
use gym_core::{BoxEnv, Env, EnvExt, Reset, Value};

/// The lines of a recording, and of a longer one in the file that the environment variable `more`
/// names.
///
/// # Panics
/// If there is no such file.
#[must_use]
pub fn lines(text: &str, more: &str) -> Vec<String> {
    let more = std::env::var_os(more).map(|path| std::fs::read_to_string(path).expect("a file"));
    let lines = text
        .lines()
        .chain(more.iter().flat_map(|more| more.lines()));
    lines.map(str::to_owned).collect()
}

/// Adds the arrays of an observation to `crc`, in the order of their keys.
fn observe(crc: &mut Hasher, observation: &Value) {
    match observation {
        Value::Dict(entries) => entries.iter().for_each(|(_, part)| observe(crc, part)),
        array => crc.update(&array.as_array().expect("an array").to_bytes()),
    }
}

/// Plays an episode, and further ones after its end, and compares the checksums of a recording.
///
/// A mark `10:0af19719` has the CRC-32 of all observations, rewards and ends up to the tenth step.
/// `other` computes the checksum of a mark that is no number, from the last observation. Returns
/// the first mark that differs, with the last observation.
///
/// # Panics
/// If a mark is malformed, or the environment returns an error.
pub fn replay<'a>(
    env: &mut BoxEnv,
    reset: Reset,
    marks: impl Iterator<Item = &'a str>,
    mut action: impl FnMut() -> Value,
    other: impl Fn(&str, &BoxEnv, &Value) -> u32,
) -> Option<String> {
    let mut crc = Hasher::new();
    let mut observation = env.reset(reset).expect("a start");
    observe(&mut crc, &observation);
    let mut step = 0;
    for mark in marks {
        let (at, expected) = mark.split_once(':').expect("a mark");
        let found = match at.parse::<u32>() {
            Err(_) => other(at, env, &observation),
            Ok(last) => {
                while step < last {
                    step += 1;
                    let outcome = env.step_into(&action(), &mut observation).expect("a step");
                    observe(&mut crc, &observation);
                    crc.update(&outcome.reward.to_le_bytes());
                    crc.update(&[outcome.terminated.into(), outcome.truncated.into()]);
                    if outcome.done() {
                        let next = env.reset_into(&Reset::default(), &mut observation);
                        next.expect("another start");
                        observe(&mut crc, &observation);
                    }
                }
                crc.clone().finalize()
            }
        };
        if format!("{found:08x}") != expected {
            return Some(format!("{at}: {observation}"));
        }
    }
    None
}
