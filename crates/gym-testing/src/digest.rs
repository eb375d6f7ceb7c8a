use gym_core::{Step, Value};
use sha2::{Digest as _, Sha256};

/// The SHA-256 of numbers, in hexadecimal digits.
#[derive(Clone, Debug, Default)]
pub struct Digest(Sha256);

impl Digest {
    /// Adds bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Adds numbers, each as eight bytes, the lowest first.
    pub fn numbers(&mut self, numbers: &[f64]) {
        numbers
            .iter()
            .for_each(|number| self.bytes(&number.to_le_bytes()));
    }

    /// Adds a value to the last bit, in its stored form.
    ///
    /// # Panics
    /// If the value cannot be stored.
    pub fn value(&mut self, value: &Value) {
        self.bytes(&serde_json::to_vec(value).expect("values are stored as JSON"));
    }

    /// Adds the result of a step.
    pub fn step(&mut self, step: &Step<Value>) {
        self.value(&step.observation);
        self.bytes(&step.reward.to_le_bytes());
        self.bytes(&[u8::from(step.terminated), u8::from(step.truncated)]);
    }

    /// Returns the digest of what was added.
    #[must_use]
    pub fn finish(self) -> String {
        let digest = self.0.finalize();
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// A sum of words as recordings have it: FNV-1a, with a word in place of a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sum(u64);

impl Default for Sum {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Sum {
    /// Adds a word.
    pub fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0100_0000_01b3);
    }

    /// The sum of an observation.
    #[must_use]
    pub fn of(observation: &[f32]) -> Self {
        let mut sum = Self::default();
        sum.observe(observation);
        sum
    }

    /// Adds an observation.
    pub fn observe(&mut self, observation: &[f32]) {
        observation
            .iter()
            .for_each(|x| self.word(u64::from(x.to_bits())));
    }

    /// Adds the result of a step.
    pub fn step(&mut self, observation: &[f32], reward: f64, done: bool) {
        self.observe(observation);
        self.word(reward.to_bits());
        self.word(u64::from(done));
    }

    /// Returns the sum of what was added.
    #[must_use]
    pub fn finish(self) -> u64 {
        self.0
    }
}
