//! Whole episodes of Gymnasium 1.4.0 on MuJoCo 3.12.0, 3.17.0 and 4.0.0. Digests of the observations,
//! rewards and ends are compared.

use gym_core::{EnvExt, builder};
use gym_mujoco as _;
use serde_json::Value;

/// SHA-256 (FIPS 180-4).
struct Sha256 {
    state: [u32; 8],
    block: Vec<u8>,
    length: u64,
}

/// Returns the first 32 bits of the fractional part of a root of the `n`-th prime.
fn root_of_prime(n: usize, root: impl Fn(u128) -> u128) -> u32 {
    let primes = (2_u128..).filter(|n| (2..*n).take_while(|d| d * d <= *n).all(|d| n % d != 0));
    root(primes.skip(n).take(1).sum()) as u32
}

/// Returns the largest number whose `power`-th power is at most `prime * 2^(32 power)`.
fn root(prime: u128, power: u32) -> u128 {
    let goal = prime << (32 * power);
    (0..40).rev().fold(0, |x: u128, bit| {
        let next = x | 1 << bit;
        if next.checked_pow(power).is_some_and(|p| p <= goal) {
            next
        } else {
            x
        }
    })
}

impl Sha256 {
    fn new() -> Self {
        let state = std::array::from_fn(|n| root_of_prime(n, |prime| root(prime, 2)));
        Self {
            state,
            block: Vec::with_capacity(64),
            length: 0,
        }
    }

    fn put(&mut self, bytes: &[u8], constants: &[u32; 64]) {
        for &byte in bytes {
            self.block.push(byte);
            self.length += 8;
            if self.block.len() == 64 {
                self.compress(constants);
                self.block.clear();
            }
        }
    }

    fn compress(&mut self, constants: &[u32; 64]) {
        let mut w = [0_u32; 64];
        for (w, bytes) in w.iter_mut().zip(self.block.as_chunks::<4>().0) {
            *w = u32::from_be_bytes(*bytes);
        }
        for i in 16..64 {
            let (a, b) = (w[i - 15], w[i - 2]);
            let s0 = a.rotate_right(7) ^ a.rotate_right(18) ^ (a >> 3);
            let s1 = b.rotate_right(17) ^ b.rotate_right(19) ^ (b >> 10);
            w[i] = w[i - 16]
                .wrapping_add(s0)
                .wrapping_add(w[i - 7])
                .wrapping_add(s1);
        }
        let [mut a, mut b, mut c, mut d, mut e, mut f, mut g, mut h] = self.state;
        for (w, constant) in w.iter().zip(constants) {
            let s1 = e.rotate_right(6) ^ e.rotate_right(11) ^ e.rotate_right(25);
            let t1 = h
                .wrapping_add(s1)
                .wrapping_add((e & f) ^ (!e & g))
                .wrapping_add(*constant)
                .wrapping_add(*w);
            let s0 = a.rotate_right(2) ^ a.rotate_right(13) ^ a.rotate_right(22);
            let t2 = s0.wrapping_add((a & b) ^ (a & c) ^ (b & c));
            (h, g, f, e, d, c, b, a) = (g, f, e, d.wrapping_add(t1), c, b, a, t1.wrapping_add(t2));
        }
        for (state, x) in self.state.iter_mut().zip([a, b, c, d, e, f, g, h]) {
            *state = state.wrapping_add(x);
        }
    }

    fn finish(mut self, constants: &[u32; 64]) -> String {
        let length = self.length;
        self.put(&[0x80], constants);
        while self.block.len() != 56 {
            self.put(&[0], constants);
        }
        self.put(&length.to_be_bytes(), constants);
        self.state
            .iter()
            .map(|word| format!("{word:08x}"))
            .collect()
    }
}

fn constants() -> [u32; 64] {
    std::array::from_fn(|n| root_of_prime(n, |prime| root(prime, 3)))
}

#[test]
fn the_digest_is_sha256() {
    let constants = constants();
    let mut sha = Sha256::new();
    sha.put(b"abc", &constants);
    assert_eq!(
        sha.finish(&constants),
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    );
}

/// Returns the digest of `steps` steps with actions sampled from the action space. A reset follows
/// the end of each episode.
fn digest(
    (id, mujoco): (&str, &str),
    seed: u64,
    steps: usize,
    constants: &[u32; 64],
) -> (String, u64) {
    let mut env = builder(id).arg("mujoco", mujoco).build().unwrap();
    let mut actions = env.action_sampler(seed).unwrap();
    let mut sha = Sha256::new();
    let mut put = |observation: &gym_core::Value, reward: f64, end: u8| {
        for x in observation
            .as_slice::<f64>()
            .unwrap()
            .iter()
            .chain(&[reward, f64::from(end)])
        {
            sha.put(&x.to_le_bytes(), constants);
        }
    };
    let mut episodes = 0;
    put(&env.reset(seed).unwrap(), 0.0, 0);
    for _ in 0..steps {
        let step = env.step(&actions.sample()).unwrap();
        put(
            &step.observation,
            step.reward,
            u8::from(step.terminated) + 2 * u8::from(step.truncated),
        );
        if step.done() {
            episodes += 1;
            put(&env.reset(()).unwrap(), 0.0, 0);
        }
    }
    (sha.finish(constants), episodes)
}

/// Each recording is one seed of one id, with 1000 steps. Without `GYM_REFERENCE`, only one seed of
/// each id is compared.
#[test]
fn episodes_have_gymnasiums_digests() {
    let (constants, every) = (constants(), std::env::var_os("GYM_REFERENCE").is_some());
    for (file, seeds) in [
        ("episodes.json", 3),
        ("episodes.3.17.json", 1),
        ("episodes.4.0.json", 3),
    ] {
        let path = format!("{}/tests/recorded/{file}", env!("CARGO_MANIFEST_DIR"));
        let told: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let steps = told["steps"].as_u64().unwrap() as usize;
        let mujoco = told["mujoco"].as_str().unwrap();
        let (mut compared, mut wrong) = (0, Vec::new());
        for (key, expected) in told["digests"].as_object().unwrap() {
            let (id, seed) = key.rsplit_once('.').unwrap();
            let seed = seed.parse().unwrap();
            if seed == 0 || every {
                let (sha256, episodes) = digest((id, mujoco), seed, steps, &constants);
                compared += 1;
                if expected["sha256"] != *sha256 || expected["episodes"] != episodes {
                    wrong.push(key);
                }
            }
        }
        assert_eq!(compared, if every { 21 * seeds } else { 21 });
        assert!(wrong.is_empty(), "MuJoCo {mujoco}: {wrong:?} differ");
    }
}
