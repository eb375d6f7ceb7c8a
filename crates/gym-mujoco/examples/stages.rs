//! Where the time of a step goes: `cargo run --release --package gym-mujoco --example stages --
//! Humanoid-v5`.
//!
//! Plays an environment with random actions, and prints the time of its steps and of each stage of
//! the engine.

use std::time::{Duration, Instant};

use gym_core::{Element, Env, EnvExt, Error, Value};
use gym_sim::SimEnv;
use mujoco_engine::physics as p;
use mujoco_engine::{Data, Model};

type Stage = fn(&Model, &mut Data);

const STAGES: [(&str, Stage); 13] = [
    ("kinematics", p::kinematics),
    ("com_pos", p::com_pos),
    ("crb", p::crb),
    ("factor_m", p::factor_m),
    ("collision", p::collision),
    ("make_constraint", p::make_constraint),
    ("com_vel", p::com_vel),
    ("passive", p::passive),
    ("reference_constraint", p::reference_constraint),
    ("rne", p::rne),
    ("fwd_actuation", p::fwd_actuation),
    ("fwd_constraint", p::fwd_constraint),
    ("forward", p::forward),
];

/// The least mean time of a stage, of some tries.
fn time(stage: Stage, m: &Model, d: &mut Data) -> Duration {
    let tries = (0..5).map(|_| {
        let start = Instant::now();
        for _ in 0..20 {
            stage(m, d);
        }
        start.elapsed() / 20
    });
    tries.min().unwrap_or_default()
}

fn main() -> Result<(), Error> {
    const STEPS: u32 = 2000;
    for id in std::env::args().skip(1) {
        let mut env = gym_core::make(&id)?;
        let mut sampler = env.action_sampler(0)?;
        let mut observation = Value::empty();
        env.reset_into(&0.into(), &mut observation)?;
        let (mut total, mut rows, mut stages) = (Duration::ZERO, 0, [Duration::ZERO; STAGES.len()]);
        for i in 0..STEPS {
            let action = sampler.sample();
            let start = Instant::now();
            let outcome = env.step_into(&action, &mut observation)?;
            total += start.elapsed();
            let Some(simulated) = env.layer::<SimEnv>() else {
                continue;
            };
            let (m, Some(d)) = (&*simulated.simulation().model, simulated.data()) else {
                continue;
            };
            rows += d.efc.nefc();
            if i % 20 == 0 {
                let mut d = d.clone();
                p::forward(m, &mut d);
                for (sum, (_, stage)) in stages.iter_mut().zip(STAGES) {
                    *sum += time(stage, m, &mut d);
                }
            }
            if outcome.done() {
                env.reset_into(&().into(), &mut observation)?;
            }
        }
        println!(
            "{id}: {:?} a step, {:.1} rows",
            total / STEPS,
            rows as f64 / f64::from(STEPS)
        );
        for (sum, (name, _)) in stages.iter().zip(STAGES) {
            println!("  {name:22} {:?}", *sum / (STEPS / 20));
        }
    }
    Ok(())
}
