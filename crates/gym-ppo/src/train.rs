//! The training: rollouts, updates and checkpoints.

use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, ensure};
use gym::render::Plot;
use gym::vector::{Autoreset, VectorEnv, VectorKind, VectorSpec};
use gym::wrappers::RecordEpisodeStatistics;
use gym::{BoxVector, Generator, WrapperSpec, builder};
use indicatif::{ProgressBar, ProgressStyle};

use crate::Training;
use crate::agent::Agent;
use crate::rollout::Rollout;
use crate::settings::{Settings, Task};
use crate::store::Checkpoint;

/// The number of episodes whose mean return decides whether the task is solved.
const WINDOW: usize = 100;
/// Frames per observation of a game: a single frame does not show motion.
const FRAMES: usize = 4;
/// Progress lines that a whole training prints.
const LINES: u64 = 40;

/// The spec of the vector. `RecordEpisodeStatistics` comes first, to record the returns before
/// other wrappers change rewards.
fn spec(id: &str, settings: &Settings, task: Task) -> gym::Result<VectorSpec> {
    let mut env = builder(id);
    if task == Task::Atari {
        env = env
            .arg("frameskip", 1)
            .wrap(WrapperSpec::new("AtariPreprocessing"));
        env = env.wrap(WrapperSpec::new("FrameStackObservation").arg("stack_size", FRAMES));
    }
    if task == Task::Control {
        env = env.arg("flat", true).arg("dtype", "float32");
    }
    if task == Task::Grid {
        // observe the one-hot encoding of each cell's object type, colour and state, without the
        // mission
        let names = [
            "OneHotPartialObsWrapper",
            "ImgObsWrapper",
            "FlattenObservation",
        ];
        env = names
            .into_iter()
            .map(WrapperSpec::new)
            .fold(env, gym::registry::EnvBuilder::wrap);
        env = env.wrap(WrapperSpec::new("DtypeObservation").arg("dtype", "float32"));
    }
    let mut vector = env.vector(settings.envs).autoreset(Autoreset::SameStep);
    if task == Task::Atari {
        vector = vector.kind(VectorKind::Async);
    }
    let mut wrappers = vec![WrapperSpec::new("RecordEpisodeStatistics")];
    if matches!(task, Task::Continuous | Task::Control) {
        wrappers.push(WrapperSpec::new("ClipAction"));
    }
    if settings.normalize {
        wrappers.push(WrapperSpec::new("NormalizeObservation"));
        wrappers
            .push(WrapperSpec::new("NormalizeReward").arg("gamma", f64::from(settings.discount)));
    }
    let bound = if task == Task::Atari {
        Some(1.0)
    } else {
        settings.normalize.then_some(10.0)
    };
    if let Some(bound) = bound {
        wrappers.push(
            WrapperSpec::new("ClipReward")
                .arg("min_reward", -bound)
                .arg("max_reward", bound),
        );
    }
    Ok(wrappers
        .into_iter()
        .fold(vector.spec()?, VectorSpec::wrapped))
}

/// The state of a training between two updates.
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
        let agent = Agent::new(
            &envs.single_observation_space(),
            &envs.single_action_space(),
            &mut rng,
        )?;
        let rollout = Rollout::new(&*envs, settings.steps)?;
        Ok(Self {
            spec,
            settings,
            envs,
            agent,
            rollout,
            rng,
            seed,
            steps: 0,
            returns: Vec::new(),
        })
    }

    fn start(id: &str, seed: u64, set: &[String]) -> anyhow::Result<Self> {
        let task = Task::of(&gym::make(id)?);
        let settings = Settings::of(id, task).with(set)?;
        let mut run = Self::new(spec(id, &settings, task)?, settings, seed)?;
        run.rollout.reset(&mut *run.envs, seed)?;
        Ok(run)
    }

    fn resume(checkpoint: Checkpoint) -> anyhow::Result<Self> {
        let Checkpoint {
            seed,
            settings,
            spec,
            envs,
            observations,
            agent,
            rng,
            steps,
            returns,
        } = checkpoint;
        let mut run = Self::new(spec, settings, seed)?;
        run.envs.restore(&envs)?;
        run.rollout.set_observations(&observations)?;
        run.agent.restore(&agent)?;
        Ok(Self {
            rng,
            steps,
            returns,
            ..run
        })
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

    /// Returns the mean return of the last [`WINDOW`] episodes, and their number, which is less
    /// than [`WINDOW`] at first.
    fn recent(&self) -> (f64, usize) {
        let recent = &self.returns[self.returns.len().saturating_sub(WINDOW)..];
        (
            recent.iter().sum::<f64>() / recent.len().max(1) as f64,
            recent.len(),
        )
    }

    /// Collects one rollout and learns from it.
    fn round(&mut self, total: u64) -> anyhow::Result<()> {
        let Self {
            settings,
            envs,
            agent,
            rollout,
            rng,
            returns,
            ..
        } = self;
        rollout.collect(&mut **envs, agent, rng, |envs| {
            if let Some(statistics) = envs.layer::<RecordEpisodeStatistics<BoxVector>>() {
                let ended = (0..envs.num_envs()).filter_map(|index| statistics.ended(index));
                returns.extend(ended.map(|episode| episode.episode_return));
            }
        })?;
        let progress = self.steps as f64 / total as f64;
        agent.learn(&rollout.batch(agent, settings)?, settings, progress, rng)?;
        self.steps += (settings.steps * settings.envs) as u64;
        Ok(())
    }

    /// Plots all returns; creates the plot's folder if it is missing.
    fn plot(&self, path: &Path) -> anyhow::Result<()> {
        let written = || -> anyhow::Result<()> {
            if let Some(folder) = path.parent() {
                fs::create_dir_all(folder)?;
            }
            Ok(
                Plot::new(format!("{}, PPO, seed {}", self.spec.env.id, self.seed))
                    .x_label("episode")
                    .y_label("return")
                    .series("return", &self.returns)
                    .moving_average(WINDOW)
                    .write_svg(path)?,
            )
        };
        written().with_context(|| format!("the plot {}", path.display()))
    }
}

pub(crate) fn train(training: &Training) -> anyhow::Result<()> {
    let Training {
        id,
        seed,
        steps,
        plot,
        checkpoint: folder,
        save_every,
        set,
    } = training;
    let found = folder
        .as_deref()
        .map(Checkpoint::find)
        .transpose()?
        .flatten();
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
    // fail before the training if the plot cannot be written
    run.plot(plot)?;
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
        let before_round = run.steps;
        run.round(*steps)?;
        if let Some(folder) = folder
            && round.is_multiple_of((*save_every).max(1))
        {
            run.checkpoint()?.write(folder)?;
        }
        if run.steps * LINES / steps > before_round * LINES / steps {
            let (seconds, (mean, window)) = (started.elapsed().as_secs(), run.recent());
            bar.suspend(|| {
                println!(
                    "{} steps, {seconds} s: mean return {mean:.1} over {window} episodes",
                    run.steps
                );
            });
        }
        bar.set_position(run.steps);
        bar.set_message(format!(
            "{} episodes, mean return {:.1}",
            run.returns.len(),
            run.recent().0
        ));
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
    run.plot(plot)?;
    println!("returns: {}", plot.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use gym::spaces::BoxSpace;
    use gym::{
        Array, DType, Dynamics, NoArguments, Registration, Reset, Space, Stateful, Task, Transition,
    };

    use super::*;

    const SIDE: usize = 28;

    gym::discrete! {
        /// The direction of the bar in an image.
        enum Answer { Lying, Standing }
    }

    /// A one-step task: the action classifies the bar in an image as horizontal or vertical.
    #[derive(Clone, Debug)]
    struct Bars;

    impl Task for Bars {
        type Config = NoArguments;
        type State = (bool, usize);
        type Observation = Array;
        type Action = Answer;
        const NAME: &'static str = "Bars";

        fn new(_: NoArguments) -> gym::Result<Self> {
            Ok(Self)
        }
        fn config(&self) -> &NoArguments {
            &NoArguments {}
        }
        fn observation_space(&self) -> Space {
            Space::Box(BoxSpace::uniform(0.0, 255.0, [1, SIDE, SIDE], DType::U8).unwrap())
        }
        fn action_space(&self) -> Space {
            Answer::space()
        }
        fn start(&self, _reset: &Reset, rng: &mut Generator) -> gym::Result<(bool, usize)> {
            Ok((
                rng.random() < 0.5,
                rng.integers(4, SIDE as i64 - 6) as usize,
            ))
        }
        fn is_valid(&self, (_, place): &(bool, usize)) -> bool {
            *place < SIDE - 2
        }
    }

    impl Dynamics for Bars {
        fn transition(
            &self,
            bar: &(bool, usize),
            action: &Answer,
            _rng: &mut Generator,
        ) -> gym::Result<Transition<(bool, usize)>> {
            let right = bar.0 == (*action == Answer::Standing);
            Ok(Transition {
                state: *bar,
                reward: if right { 1.0 } else { 0.0 },
                terminated: true,
            })
        }
        fn observe(&self, (standing, place): &(bool, usize)) -> Array {
            let pixel = |i: usize| {
                let across = if *standing { i % SIDE } else { i / SIDE };
                if (*place..place + 2).contains(&across) {
                    255u8
                } else {
                    40
                }
            };
            Array::from((0..SIDE * SIDE).map(pixel).collect::<Vec<_>>())
                .reshape([1, SIDE, SIDE])
                .unwrap()
        }
    }

    gym::register!(Registration::new::<Stateful<Bars>>("gym_ppo/Bars-v0"));

    #[test]
    fn pictures_are_told_apart_and_a_training_on_them_resumes() {
        let set = ["envs=8", "steps=16", "minibatch=64", "learning_rate=1e-3"].map(str::to_owned);
        let mut run = Run::start("gym_ppo/Bars-v0", 1, &set).unwrap();
        let total = 128 * 24;
        for _ in 0..20 {
            run.round(total).unwrap();
        }
        assert!(run.recent().0 > 0.95, "{:?}", run.recent());

        let text = serde_json::to_string(&run.checkpoint().unwrap()).unwrap();
        let mut resumed = Run::resume(serde_json::from_str(&text).unwrap()).unwrap();
        for run in [&mut run, &mut resumed] {
            run.round(total).unwrap();
        }
        assert!(resumed.agent.store().unwrap() == run.agent.store().unwrap());
        assert_eq!(resumed.returns, run.returns);
    }
}
