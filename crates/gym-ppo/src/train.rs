//! The training: rollouts and rounds of learning, with a checkpoint now and then.

use std::time::Instant;

use anyhow::{Context, ensure};
use gym::rendering::Plot;
use gym::vector::wrappers::RecordEpisodeStatistics;
use gym::vector::{Autoreset, VectorEnv, VectorSpec};
use gym::{Generator, Space, WrapperSpec, builder};
use indicatif::{ProgressBar, ProgressStyle};

use crate::Training;
use crate::agent::Agent;
use crate::rollout::Rollout;
use crate::settings::Settings;
use crate::store::Checkpoint;

/// Episodes whose mean return decides whether the task is solved.
const WINDOW: usize = 100;

/// The vector of a task: its wrappers record the returns as they are, and normalize what the agent gets.
fn spec(id: &str, settings: &Settings, continuous: bool) -> gym::Result<VectorSpec> {
    let spec = builder(id).vector(settings.envs).autoreset(Autoreset::SameStep).spec()?;
    let mut wrappers = vec![WrapperSpec::new("RecordEpisodeStatistics")];
    if continuous {
        wrappers.push(WrapperSpec::new("ClipAction"));
    }
    if settings.normalize {
        wrappers.push(WrapperSpec::new("NormalizeObservation"));
        wrappers.push(WrapperSpec::new("NormalizeReward").arg("gamma", f64::from(settings.discount)));
        wrappers.push(WrapperSpec::new("ClipReward").arg("min_reward", -10.0).arg("max_reward", 10.0));
    }
    Ok(wrappers.into_iter().fold(spec, VectorSpec::wrapped))
}

/// The numbers of an observation.
pub(crate) fn width(space: &Space) -> anyhow::Result<usize> {
    match space.shape() {
        Some([width]) => Ok(*width),
        _ => anyhow::bail!("the observations are {space}: this example needs rows of numbers"),
    }
}

/// A training as it stands between two rounds of learning.
struct Run {
    spec: VectorSpec,
    settings: Settings,
    envs: Box<dyn VectorEnv>,
    agent: Agent,
    rollout: Rollout,
    rng: Generator,
    seed: u64,
    steps: u64,
    returns: Vec<f64>,
}

impl Run {
    fn new(spec: VectorSpec, settings: Settings, seed: u64) -> anyhow::Result<Self> {
        let envs = spec.make()?;
        let mut rng = Generator::from(seed);
        let width = width(&envs.single_observation_space())?;
        let agent = Agent::new(width, &envs.single_action_space(), &mut rng)?;
        let rollout = Rollout::new(&*envs, settings.steps)?;
        Ok(Self { spec, settings, envs, agent, rollout, rng, seed, steps: 0, returns: Vec::new() })
    }

    fn start(id: &str, seed: u64, set: &[String]) -> anyhow::Result<Self> {
        let continuous = matches!(gym::Env::action_space(&gym::make(id)?), Space::Box(_));
        let settings = Settings::of(id, continuous).with(set)?;
        let mut run = Self::new(spec(id, &settings, continuous)?, settings, seed)?;
        run.rollout.reset(&mut *run.envs, seed)?;
        Ok(run)
    }

    fn resume(checkpoint: Checkpoint) -> anyhow::Result<Self> {
        let Checkpoint { seed, settings, spec, envs, observations, agent, rng, steps, returns } = checkpoint;
        let mut run = Self::new(spec, settings, seed)?;
        run.envs.restore(&envs)?;
        run.rollout.set_observations(&observations)?;
        run.agent.restore(&agent)?;
        Ok(Self { rng, steps, returns, ..run })
    }

    fn checkpoint(&mut self) -> anyhow::Result<Checkpoint> {
        Ok(Checkpoint {
            seed: self.seed,
            settings: self.settings.clone(),
            spec: self.spec.clone(),
            envs: self.envs.snapshot()?,
            observations: self.rollout.observations(),
            agent: self.agent.store()?,
            rng: self.rng.clone(),
            steps: self.steps,
            returns: self.returns.clone(),
        })
    }

    /// The mean return of the last episodes, and how many these are.
    fn recent(&self) -> (f64, usize) {
        let recent = &self.returns[self.returns.len().saturating_sub(WINDOW)..];
        (recent.iter().sum::<f64>() / recent.len().max(1) as f64, recent.len())
    }

    /// A rollout and what there is to learn from it.
    fn round(&mut self, total: u64) -> anyhow::Result<()> {
        let Self { settings, envs, agent, rollout, rng, returns, .. } = self;
        rollout.collect(&mut **envs, agent, rng, |envs| {
            if let Some(statistics) = envs.wrapper::<RecordEpisodeStatistics>() {
                let ended = (0..envs.num_envs()).filter_map(|index| statistics.ended(index));
                returns.extend(ended.map(|episode| episode.episode_return));
            }
        })?;
        let progress = self.steps as f64 / total as f64;
        agent.learn(&rollout.batch(agent, settings)?, settings, progress, rng)?;
        self.steps += (settings.steps * settings.envs) as u64;
        Ok(())
    }
}

pub(crate) fn train(training: &Training) -> anyhow::Result<()> {
    let Training { id, seed, steps, plot, checkpoint: folder, save_every, set } = training;
    let found = folder.as_deref().map(Checkpoint::find).transpose()?.flatten();
    let mut run = match found {
        Some(checkpoint) => {
            let (made, with) = (&checkpoint.spec.env.id, checkpoint.seed);
            ensure!(
                made == id && with == *seed,
                "the checkpoint is of {made} with seed {with}: choose another folder"
            );
            println!("resumes after {} steps", checkpoint.steps);
            Run::resume(checkpoint)?
        }
        None => Run::start(id, *seed, set)?,
    };
    let threshold = run.spec.env.reward_threshold.unwrap_or(f64::INFINITY);
    let solved = |run: &Run| matches!(run.recent(), (mean, WINDOW) if mean >= threshold);

    let bar = ProgressBar::new(*steps).with_style(ProgressStyle::with_template(
        "{elapsed} {wide_bar} {human_pos} steps, {per_sec}, {msg}",
    )?);
    bar.set_position(run.steps);
    let (started, before) = (Instant::now(), run.steps);
    for round in 1u64.. {
        if run.steps >= *steps || solved(&run) {
            break;
        }
        run.round(*steps)?;
        if let Some(folder) = folder
            && round.is_multiple_of((*save_every).max(1))
        {
            run.checkpoint()?.write(folder)?;
        }
        bar.set_position(run.steps);
        bar.set_message(format!("{} episodes, mean return {:.1}", run.returns.len(), run.recent().0));
    }
    bar.abandon();
    if let Some(folder) = folder {
        run.checkpoint()?.write(folder)?;
    }

    let seconds = started.elapsed().as_secs_f64();
    let env_seconds = run.rollout.env_time.as_secs_f64();
    let (mean, window) = run.recent();
    println!(
        "{id}: mean return {mean:.1} over the last {window} of {} episodes, after {} steps; {} of them in {seconds:.1} \
         s, {env_seconds:.2} s ({:.1} %) of it in the environments",
        run.returns.len(),
        run.steps,
        run.steps - before,
        100.0 * env_seconds / seconds,
    );
    Plot::new(format!("{id}, PPO, seed {seed}"))
        .x_label("episode")
        .y_label("return")
        .series("return", &run.returns)
        .moving_average(WINDOW)
        .write_svg(plot)
        .with_context(|| format!("the plot {}", plot.display()))?;
    println!("returns: {}", plot.display());
    Ok(())
}
