//! The evaluation of a saved policy: one environment, the best action each time, and the statistics of the
//! training, which stay as they are.

use anyhow::Context;
use candle_core::{Device, Tensor};
use gym::render::RenderMode;
use gym::rendering::RecordVideo;
use gym::vector::wrappers::NormalizeObservation;
use gym::{BoxEnv, Env, Generator, Space, Wrap, builder, wrappers};

use crate::Evaluation;
use crate::agent::Agent;
use crate::store::Checkpoint;
use crate::train::width;

pub(crate) fn evaluate(evaluation: &Evaluation) -> anyhow::Result<()> {
    let Evaluation { checkpoint: folder, episodes, seed, video } = evaluation;
    let checkpoint =
        Checkpoint::find(folder)?.with_context(|| format!("{}: no checkpoint", folder.display()))?;
    let mut vector = checkpoint.spec.make()?;
    vector.restore(&checkpoint.envs)?;

    let env = builder(&checkpoint.spec.env.id).args(checkpoint.spec.env.kwargs.clone());
    let env = env.render_mode(RenderMode::RgbArray).build()?;
    let mut env = BoxEnv::new(RecordVideo::new(env, video)?.episode_trigger(|_| true));
    if matches!(env.action_space(), Space::Box(_)) {
        env = BoxEnv::new(env.clip_action()?);
    }
    if let Some(trained) = vector.wrapper::<NormalizeObservation>() {
        let mut normalized = wrappers::NormalizeObservation::new(env)?;
        normalized.set_statistics(trained.statistics().clone())?;
        normalized.update_running_mean(false);
        env = BoxEnv::new(normalized);
    }

    let mut agent =
        Agent::new(width(&env.observation_space())?, &env.action_space(), &mut Generator::from(0))?;
    agent.restore(&checkpoint.agent)?;
    let mut returns = Vec::new();
    for episode in 0..*episodes {
        let mut observation = env.reset(seed + episode)?;
        let mut total = 0.0;
        loop {
            let numbers = observation.as_slice::<f32>().context("observations of float32")?;
            let actions = agent.best(&Tensor::from_slice(numbers, (1, numbers.len()), &Device::Cpu)?)?;
            let action = env.action_space().iterate(&actions)?.next().context("an action")?;
            let step = env.step(&action)?;
            total += step.reward;
            if step.done() {
                break;
            }
            observation = step.observation;
        }
        println!("episode {episode}: return {total}");
        returns.push(total);
    }
    env.close();
    let mean = returns.iter().sum::<f64>() / returns.len().max(1) as f64;
    println!(
        "{}: mean return {mean:.1} over {episodes} episodes; videos: {}",
        checkpoint.spec.env.id,
        video.display()
    );
    Ok(())
}
