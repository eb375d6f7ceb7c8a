//! A digest of many numbers, and the comparison of digests with those of libmujoco.

use std::fmt;

use gym_numerics::RandomState;
use mujoco_engine::{Data, Model, step};

/// A digest as recordings have it: FNV-1a, with a word in place of a byte.
pub(crate) struct Digest(pub(crate) u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    pub(crate) fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x100_0000_01b3);
    }

    pub(crate) fn numbers<'a>(&mut self, numbers: impl IntoIterator<Item = &'a f64>) {
        numbers
            .into_iter()
            .for_each(|number| self.word(number.to_bits()));
    }
}

/// A model whose digest is another than the recorded one.
pub(crate) struct Unlike {
    pub(crate) version: &'static str,
    /// The line of the model, from 1 on.
    pub(crate) line: usize,
    pub(crate) name: String,
    pub(crate) found: String,
}

impl fmt::Debug for Unlike {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (version, line, name) = (self.version, self.line, &self.name);
        write!(f, "{version}, line {line}, {name}: {}", self.found)
    }
}

/// Compares the digest of each model in each version with its line of a recording; `-` is not compared.
pub(crate) fn unlike<T: AsRef<str>>(
    models: &[T],
    recordings: [(&'static str, &str); 3],
    digest: impl Fn(&str, &str) -> String,
) -> Vec<Unlike> {
    let mut all = Vec::new();
    for (version, recording) in recordings {
        assert_eq!(models.len(), recording.lines().count(), "{version}");
        for ((line, text), expected) in (1..).zip(models).zip(recording.lines()) {
            if expected == "-" {
                continue;
            }
            let text = text.as_ref();
            let found = digest(text, version);
            if found != expected {
                let name = text.split('"').nth(1).unwrap_or_default().to_owned();
                all.push(Unlike {
                    version,
                    line,
                    name,
                    found,
                });
            }
        }
    }
    all
}

/// The digest of the states and sensors of some steps of a model, or why it is refused. `start` sets the state before the
/// first step, and `drive` the controls of each, both at random.
pub(crate) fn of_steps(
    (text, version): (&str, &str),
    steps: usize,
    start: impl FnOnce(&mut Data, &mut RandomState),
    drive: impl Fn(&Model, &mut Data, &mut RandomState),
) -> String {
    let m = match Model::from_xml_with(text, version.parse().unwrap()) {
        Ok(m) => m,
        Err(error) => return error.to_string(),
    };
    let (mut d, mut random) = (Data::new(&m), RandomState::new(0));
    let mut digest = Digest::default();
    start(&mut d, &mut random);
    for _ in 0..steps {
        drive(&m, &mut d, &mut random);
        step(&m, &mut d);
        let numbers = d.qpos.iter().chain(&d.qvel).chain(&d.act);
        digest.numbers(numbers.chain(&d.sensordata));
    }
    format!("{:016x}", digest.0)
}
