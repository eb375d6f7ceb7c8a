//! What a model's steps come to, in one word.

use gym_numerics::RandomState;
use mujoco_engine::{Data, Model, step};

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
    let mut digest: u64 = 0xcbf2_9ce4_8422_2325;
    start(&mut d, &mut random);
    for _ in 0..steps {
        drive(&m, &mut d, &mut random);
        step(&m, &mut d);
        let numbers = d.qpos.iter().chain(&d.qvel).chain(&d.act);
        for number in numbers.chain(&d.sensordata) {
            digest = (digest ^ number.to_bits()).wrapping_mul(0x100_0000_01b3);
        }
    }
    format!("{digest:016x}")
}
