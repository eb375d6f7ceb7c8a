//! The evaluation of a policy: plays the best actions in one environment, with the training's
//! observation statistics, which are not updated.

use anyhow::Context;
use gym::registry::EnvBuilder;
use gym::render::{RecordVideo, RecordVideoConfig, RenderMode};
use gym::{BoxEnv, Env, EnvExt, Generator, Space, Wrap, wrappers};

use crate::Evaluation;
use crate::agent::{Agent, tensor};
use crate::policy::Policy;

pub(crate) fn evaluate(evaluation: &Evaluation) -> anyhow::Result<()> {
    let Evaluation {
        policy,
        episodes,
        seed,
        video,
        size,
        frames,
    } = evaluation;
    let Policy {
        env: spec,
        normalization,
        network,
    } = Policy::find(policy)?;

    let mut env = EnvBuilder::from_spec(spec.clone());
    if video.is_some() {
        env = env.render_mode(RenderMode::RgbArray);
    }
    if let Some(size) = size {
        let numbers = size
            .split_once('x')
            .and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
        let (width, height) =
            numbers.with_context(|| format!("{size} is not a size: write it as 320x200"))?;
        env = env.render_size(width, height);
    }
    let mut env = env.build()?;
    if let Some(folder) = video {
        let config = RecordVideoConfig {
            video_length: frames.unwrap_or(0),
            ..folder.into()
        };
        env = BoxEnv::new(RecordVideo::new(env, config)?.episode_trigger(|_| true));
    }
    if matches!(env.action_space(), Space::Box(_)) {
        env = BoxEnv::new(env.clip_action()?);
    }
    if let Some(statistics) = normalization {
        let mut normalized = wrappers::NormalizeObservation::new(
            env,
            wrappers::normalize_observation::Config::default(),
        )?;
        normalized.set_statistics(statistics)?;
        normalized.update_running_mean(false);
        env = BoxEnv::new(normalized);
    }

    let mut agent = Agent::new(
        &env.observation_space(),
        &env.action_space(),
        &mut Generator::from(0),
    )?;
    agent.set_policy(&network)?;
    let mut returns = Vec::new();
    for episode in 0..*episodes {
        let mut observation = env.reset(seed + episode)?;
        let mut total = 0.0;
        loop {
            let actions = agent.best(&tensor(&observation)?.unsqueeze(0)?)?;
            let action = env
                .action_space()
                .iterate(&actions)?
                .next()
                .context("an action")?;
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
    let n = returns.len().max(1) as f64;
    let mean = returns.iter().sum::<f64>() / n;
    let deviation = (returns.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    println!(
        "{}: mean return {mean:.1}, standard deviation {deviation:.1}, over {episodes} episodes",
        spec.id
    );
    if let Some(folder) = video {
        println!("videos: {}", folder.display());
    }
    Ok(())
}
