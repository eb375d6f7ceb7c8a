//! The environment under test, its episodes, and their comparison.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;
use std::thread;
use std::time::Duration;

use crate::clock::Paused;
use crate::damaged::Damaged;
use crate::long::LongRuns;
use crate::turns::Turns;
use crate::variants::Variants;
use crate::verdict::{Trouble, Verdict, broken, skipped};
use gym_core::{
    BoxEnv, Element, Env, EnvExt, EnvSpec, Info, Kwargs, Outcome, Registration, Reset, Result,
    Space, Step, Value, registry,
};

/// The number of steps of a comparison. Short episodes are followed by further episodes.
pub(crate) const STEPS: usize = 150;
/// The number of steps after which an episode counts as begun.
pub(crate) const MIDWAY: usize = 5;
pub(crate) const SEEDS: [u64; 3] = [0, 1, 123_456_789];

/// A run: the seed, the number of steps before the comparison, and the number of steps in the
/// comparison.
type Run = (u64, usize, usize);

/// The environment under test.
pub(crate) struct Subject<'a> {
    make: &'a dyn Fn() -> Result<BoxEnv>,
    /// A long run, played before all other calls.
    first_run: OnceCell<Vec<Shown>>,
    /// The observation and the action space after the long run.
    late_spaces: OnceCell<[Space; 2]>,
    /// An episode that pauses until the check of the clock.
    paused: OnceCell<Paused>,
    /// The events of each seed, played once for several checks.
    events: OnceCell<Vec<(u64, Vec<Shown>)>>,
    /// The faults of long runs, which are played once for several checks.
    long_runs: OnceCell<LongRuns>,
    /// The faults with other arguments and with options, which are played once for several checks.
    variants: OnceCell<Variants>,
    /// The faults with damaged snapshots, which are tried once for several checks.
    damaged: OnceCell<Damaged>,
    /// The runs of [`untouched`](Self::untouched), by seed and steps, played once for several
    /// checks.
    untouched: RefCell<BTreeMap<Run, Rc<[Shown]>>>,
    /// The turns of the threads that check several environments.
    turns: Option<&'a Turns>,
    /// The spec and the registration, if any.
    pub(crate) spec: Option<EnvSpec>,
    pub(crate) registration: Option<Registration>,
}

impl<'a> Subject<'a> {
    pub(crate) fn new(make: &'a dyn Fn() -> Result<BoxEnv>) -> Self {
        // the first check makes an environment again, and reports a panic
        let made = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| make().ok()?.spec()));
        let spec = made.ok().flatten();
        let registration = spec.as_ref().and_then(|spec| registry::find(&spec.id).ok());
        Self::with(make, spec, registration)
    }

    /// Makes the subject for an environment whose spec is `spec`.
    pub(crate) fn of_spec(make: &'a dyn Fn() -> Result<BoxEnv>, spec: EnvSpec) -> Self {
        let registration = registry::find(&spec.id).ok();
        Self::with(make, Some(spec), registration)
    }

    fn with(
        make: &'a dyn Fn() -> Result<BoxEnv>,
        spec: Option<EnvSpec>,
        registration: Option<Registration>,
    ) -> Self {
        let (first_run, paused, events) = (OnceCell::new(), OnceCell::new(), OnceCell::new());
        let (long_runs, damaged) = (OnceCell::new(), OnceCell::new());
        let variants = OnceCell::new();
        Self {
            make,
            first_run,
            late_spaces: OnceCell::new(),
            paused,
            events,
            long_runs,
            variants,
            damaged,
            untouched: RefCell::default(),
            turns: None,
            spec,
            registration,
        }
    }

    /// Lets other threads work while this one sleeps.
    pub(crate) fn in_turns(mut self, turns: &'a Turns) -> Self {
        self.turns = Some(turns);
        self
    }

    /// Sleeps.
    pub(crate) fn sleep(&self, time: Duration) {
        match self.turns {
            Some(turns) => turns.sleep(time),
            None => thread::sleep(time),
        }
    }

    /// Makes a new environment.
    pub(crate) fn make(&self) -> Result<BoxEnv> {
        (self.make)()
    }

    /// Makes a new environment, without a time limit if it is registered. Its snapshots then
    /// contain only its own state.
    pub(crate) fn unlimited(&self) -> Result<BoxEnv> {
        match &self.spec {
            // (a wrapper may need the time limit)
            Some(spec) if self.registration.is_some() => EnvSpec {
                max_episode_steps: None,
                ..spec.clone()
            }
            .make()
            .or_else(|_| self.make()),
            _ => self.make(),
        }
    }

    /// Makes a new environment and resets it.
    pub(crate) fn reset(&self, seed: u64) -> Result<BoxEnv> {
        let mut env = self.make()?;
        env.reset(seed)?;
        Ok(env)
    }

    /// Makes a new environment and takes [`MIDWAY`] steps.
    pub(crate) fn midway(&self, seed: u64) -> Result<BoxEnv> {
        self.after(seed, MIDWAY)
    }

    /// Makes a new environment and takes `steps` steps, with resets at the ends of episodes.
    pub(crate) fn after(&self, seed: u64, steps: usize) -> Result<BoxEnv> {
        let mut env = self.make()?;
        roll_out(&mut env, seed, steps)?;
        Ok(env)
    }

    /// Returns `after` steps of an environment that took `before` steps before. Nothing else was
    /// called on the environment.
    pub(crate) fn untouched(&self, seed: u64, before: usize, after: usize) -> Result<Rc<[Shown]>> {
        let key = (seed, before, after);
        if let Some(run) = self.untouched.borrow().get(&key) {
            return Ok(Rc::clone(run));
        }
        let run: Rc<[Shown]> = carry_on(&mut self.after(seed, before)?, seed, after)?.into();
        self.untouched.borrow_mut().insert(key, Rc::clone(&run));
        Ok(run)
    }

    /// Returns the number of steps of a long comparison: the time limit, clamped to a range.
    pub(crate) fn long(&self) -> Result<usize> {
        let limit = self
            .spec
            .as_ref()
            .and_then(|spec| spec.max_episode_steps)
            .unwrap_or(1000);
        Ok(if self.shows_pictures()? {
            400
        } else {
            limit.clamp(400, 1600) as usize
        })
    }

    /// Returns whether observations are images. Hundreds of images fill the memory.
    fn shows_pictures(&self) -> Result<bool> {
        const PICTURE: usize = 10_000;
        Ok(match self.make()?.observation_space() {
            Space::Box(space) => space.shape().iter().product::<usize>() > PICTURE,
            _ => false,
        })
    }

    /// Returns the number of steps of the longest comparisons.
    pub(crate) fn longest(&self) -> Result<usize> {
        Ok(self
            .long()?
            .max(if self.shows_pictures()? { 0 } else { 1000 }))
    }

    /// Returns whether observations have few numbers. Such an environment is likely fast.
    pub(crate) fn is_small(&self) -> Result<bool> {
        const FEW: usize = 6;
        Ok(match self.make()?.observation_space() {
            Space::Box(space) => space.shape().iter().product::<usize>() <= FEW,
            Space::Discrete(_) | Space::Tuple(_) => true,
            _ => false,
        })
    }

    /// Returns the number of resets of a comparison of many seeds. An environment whose
    /// observations have few numbers likely resets fast.
    pub(crate) fn many_resets(&self) -> Result<usize> {
        const FEW: usize = 32;
        Ok(match self.make()?.observation_space() {
            Space::Box(space) if space.shape().iter().product::<usize>() <= FEW => 2000,
            Space::Discrete(_) => 2000,
            _ => 300,
        })
    }

    /// Returns the number of steps to take from each of many states.
    pub(crate) fn few(&self) -> Result<usize> {
        Ok(if self.shows_pictures()? { 5 } else { 20 })
    }

    /// Returns a long run of the first seed. The first call plays the run, before other checks can
    /// change static variables.
    pub(crate) fn first_run(&self) -> Result<&[Shown]> {
        if let Some(run) = self.first_run.get() {
            return Ok(run);
        }
        let mut env = self.make()?;
        let run = roll_out(&mut env, SEEDS[0], self.longest()?)?;
        self.late_spaces
            .get_or_init(|| [env.observation_space(), env.action_space()]);
        Ok(self.first_run.get_or_init(|| run))
    }

    /// Returns the observation and the action space after the first run, if it succeeded.
    pub(crate) fn late_spaces(&self) -> Option<&[Space; 2]> {
        self.late_spaces.get()
    }

    /// Returns an episode that began before the other checks.
    pub(crate) fn paused(&self) -> Result<&Paused> {
        if let Some(paused) = self.paused.get() {
            return Ok(paused);
        }
        let paused = Paused::new(self)?;
        Ok(self.paused.get_or_init(|| paused))
    }

    /// Returns the events of each seed.
    fn events(&self) -> Result<&[(u64, Vec<Shown>)]> {
        if let Some(events) = self.events.get() {
            return Ok(events);
        }
        let mut env = self.make()?;
        let events = SEEDS
            .into_iter()
            .map(|seed| Ok((seed, roll_out(&mut env, seed, STEPS)?)));
        let events = events.collect::<Result<_>>()?;
        Ok(self.events.get_or_init(|| events))
    }

    /// Returns the faults of long and unusual runs.
    pub(crate) fn long_runs(&self) -> Result<&LongRuns> {
        if let Some(runs) = self.long_runs.get() {
            return Ok(runs);
        }
        let runs = LongRuns::play(self.unlimited()?)?;
        Ok(self.long_runs.get_or_init(|| runs))
    }

    /// Returns the faults of other arguments and of options.
    pub(crate) fn variants(&self) -> &Variants {
        self.variants.get_or_init(|| Variants::play(self))
    }

    /// Returns the spec, and all arguments with their default values, if the environment is
    /// registered.
    pub(crate) fn arguments(&self) -> Option<(EnvSpec, Kwargs)> {
        let (spec, registration) = (self.spec.as_ref()?, self.registration.as_ref()?);
        let table = registration.arguments().ok()?.into_iter();
        let mut kwargs: Kwargs = table
            .map(|argument| (argument.name.to_owned(), argument.default))
            .collect();
        kwargs.extend(spec.kwargs.clone());
        Some((spec.clone(), kwargs))
    }

    /// Returns the faults with damaged snapshots. The snapshots are taken after some steps.
    pub(crate) fn damaged(&self) -> Result<&Damaged> {
        if let Some(damaged) = self.damaged.get() {
            return Ok(damaged);
        }
        let mut env = self.unlimited()?;
        roll_out(&mut env, SEEDS[0], 5)?;
        let damaged = Damaged::try_all(&env, self.few()?)?;
        Ok(self.damaged.get_or_init(|| damaged))
    }

    /// Returns the reason for which the registration allows `check` to fail.
    pub(crate) fn exception(&self, check: &str) -> Option<&'static str> {
        let exceptions = self.registration.as_ref()?.exceptions;
        exceptions
            .iter()
            .find_map(|(name, reason)| (*name == check).then_some(*reason))
    }

    /// Returns whether the same seed may give different episodes.
    pub(crate) fn is_nondeterministic(&self) -> bool {
        self.spec.as_ref().is_some_and(|spec| spec.nondeterministic)
    }

    /// Skips the check if the same seed may give different episodes.
    pub(crate) fn repeatable(&self) -> Verdict {
        if self.is_nondeterministic() {
            skipped("it is registered as nondeterministic")
        } else {
            Ok(())
        }
    }
}

/// The result of one reset or step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shown {
    Reset(Value, Info),
    Step(Step<Value>, Info),
}

impl Shown {
    pub(crate) fn observation(&self) -> &Value {
        match self {
            Self::Reset(observation, _) | Self::Step(Step { observation, .. }, _) => observation,
        }
    }
}

/// Resets with `seed` and takes `steps` random actions, with unseeded resets at the ends of
/// episodes.
pub(crate) fn roll_out(env: &mut BoxEnv, seed: u64, steps: usize) -> Result<Vec<Shown>> {
    let observation = env.reset(seed)?;
    let mut shown = vec![Shown::Reset(observation, info(env))];
    shown.extend(carry_on(env, seed, steps)?);
    Ok(shown)
}

/// Like [`roll_out`], from the current state.
pub(crate) fn carry_on(env: &mut BoxEnv, action_seed: u64, steps: usize) -> Result<Vec<Shown>> {
    let mut actions = env.action_sampler(action_seed)?;
    let mut shown = Vec::with_capacity(steps);
    for _ in 0..steps {
        let step = env.step(&actions.sample())?;
        let done = step.done();
        shown.push(Shown::Step(step, info(env)));
        if done {
            let observation = env.reset(())?;
            shown.push(Shown::Reset(observation, info(env)));
        }
    }
    Ok(shown)
}

/// Calls `visit` after each reset and each random step, including the last step of an episode.
pub(crate) fn tour(
    env: &mut BoxEnv,
    seed: u64,
    steps: usize,
    mut visit: impl FnMut(&BoxEnv, usize) -> Verdict,
) -> Verdict {
    let mut actions = env.action_sampler(seed)?;
    env.reset(seed)?;
    visit(env, 0)?;
    for step in 1..=steps {
        let is_over = env.step(&actions.sample())?.done();
        visit(env, step)?;
        if is_over {
            env.reset(())?;
            visit(env, step)?;
        }
    }
    Ok(())
}

/// Returns the entries of `info` without wall-clock time.
pub(crate) fn info(env: &BoxEnv) -> Info {
    let mut info = env.info_map();
    if let Some(Value::Dict(episode)) = info.get_mut("episode") {
        episode.retain(|(key, _)| key != "t");
    }
    info
}

/// Calls `visit` with each event of each seed, and a description of its place.
pub(crate) fn each_event(
    subject: &Subject<'_>,
    mut visit: impl FnMut(&Shown, &str) -> Verdict,
) -> Verdict {
    for (seed, events) in subject.events()? {
        for (i, shown) in events.iter().enumerate() {
            visit(shown, &format!("seed {seed}, event {i}"))?;
        }
    }
    Ok(())
}

/// Reports the first difference of two histories. NaN equals NaN here, because another check
/// reports NaN.
pub(crate) fn same(a: &[Shown], b: &[Shown], what: &str) -> Verdict {
    match a.iter().zip(b).position(|(a, b)| !alike(a, b)) {
        None => Ok(()),
        Some(i) => broken(format!(
            "{what} differs at event {i}: {:?} and {:?}",
            a[i], b[i]
        )),
    }
}

pub(crate) fn alike<T: PartialEq + std::fmt::Debug>(a: &T, b: &T) -> bool {
    a == b || format!("{a:?}") == format!("{b:?}")
}

/// Plays with [`Env::reset_into`] and [`Env::step_into`]. `buffer` turns the last observation into
/// the next buffer. Only the results of resets contain the info.
pub(crate) fn roll_out_into(
    env: &mut BoxEnv,
    seed: u64,
    mut buffer: impl FnMut(Value) -> Value,
) -> std::result::Result<Vec<Shown>, Trouble> {
    let mut actions = env.action_sampler(seed)?;
    let mut observation = buffer(Value::empty());
    env.reset_into(&Reset::seed(seed), &mut observation)?;
    let mut shown = vec![Shown::Reset(observation.clone(), info(env))];
    for _ in 0..STEPS {
        observation = buffer(observation);
        let Outcome {
            reward,
            terminated,
            truncated,
        } = env.step_into(&actions.sample(), &mut observation)?;
        let step = Step {
            observation: observation.clone(),
            reward,
            terminated,
            truncated,
        };
        let is_over = step.done();
        shown.push(Shown::Step(step, Info::default()));
        if is_over {
            observation = buffer(observation);
            env.reset_into(&Reset::default(), &mut observation)?;
            shown.push(Shown::Reset(observation.clone(), info(env)));
        }
    }
    Ok(shown)
}
