//! The check of an environment's native vector.

use std::collections::BTreeMap;
use std::fmt::Debug;

use gym_core::registry::Each;
use gym_core::vector::VectorSpec;
use gym_core::vector::{Autoreset, Columns, Seeds, VectorEnvExt, VectorKind, VectorReset};
use gym_core::{Array, Data, EnvSpec, Info, Result, Snapshot, Space, Value, VectorEnv};

use crate::arguments::others;
use crate::options::examples;
use crate::subject::{Subject, alike};
use crate::verdict::{Verdict, broken};

/// The seed of the first sub-environment.
const SEED: u64 = 3;

/// The lengths of a comparison.
#[derive(Clone, Copy)]
struct Size {
    /// The number of sub-environments, which is no multiple of the number of SIMD lanes.
    envs: usize,
    /// A time limit that episodes reach soon.
    limit: u32,
    steps: usize,
    /// The number of arguments that are tried.
    arguments: usize,
}

/// For environments whose observations have few numbers. Most of these environments are fast.
const SMALL: Size = Size {
    envs: 11,
    limit: 9,
    steps: 24,
    arguments: 8,
};
/// For physics and images, with slow steps and copies.
const LARGE: Size = Size {
    envs: 3,
    limit: 3,
    steps: 5,
    arguments: 1,
};

/// Checks that the registration's vector equals a sync vector of the environments, in each
/// autoreset mode, with masks, options, snapshots and different arguments.
pub(crate) fn equal(subject: &Subject<'_>) -> Verdict {
    let (Some(spec), Some(registration)) = (&subject.spec, &subject.registration) else {
        return Ok(());
    };
    let has_wrappers = !spec.additional_wrappers.is_empty() || spec.render_mode.is_some();
    if registration.vector_entry_point.is_none() || has_wrappers {
        return Ok(());
    }
    subject.repeatable()?;
    let size = if subject.is_small()? { SMALL } else { LARGE };
    let limit = size.limit;
    let limited = EnvSpec {
        max_episode_steps: Some(limit),
        ..spec.clone()
    };
    for autoreset in [
        Autoreset::NextStep,
        Autoreset::SameStep,
        Autoreset::Disabled,
    ] {
        let name = format!("with {autoreset:?}");
        let make = |env: &EnvSpec| {
            let mut vector = VectorSpec::new(env.clone(), size.envs, VectorKind::Native);
            vector.autoreset_mode = autoreset;
            vector
        };
        let own = make(spec);
        let Some(mut pair) = Pair::new(&own, &name, size)? else {
            continue;
        };
        // a vector may refuse another limit
        let limited = make(&limited);
        let name = format!("{name}, a limit of {limit} steps");
        match Pair::new(&limited, &name, size)? {
            Some(mut limited) => {
                limited.play(subject)?;
                pair.reset(&VectorReset::from(SEED))?;
                pair.steps(size.steps)?;
            }
            None => pair.play(subject)?,
        }
    }
    arguments_apart(subject, &limited, size)
}

/// Compares vectors whose sub-environments have different values of an argument.
fn arguments_apart(subject: &Subject<'_>, spec: &EnvSpec, size: Size) -> Verdict {
    let Some((_, kwargs)) = subject.arguments() else {
        return Ok(());
    };
    let numbers = kwargs.into_iter().filter(|(_, value)| value.is_number());
    for (name, value) in numbers.take(size.arguments) {
        // the environment may refuse some values
        let is_accepted = |value: &serde_json::Value| {
            let mut spec = spec.clone();
            spec.kwargs.insert(name.clone(), value.clone());
            spec.make().is_ok()
        };
        let mut values = others(&value);
        values.retain(is_accepted);
        let Some(other) = values.into_iter().next() else {
            continue;
        };
        let mut vector = VectorSpec::new(spec.clone(), size.envs, VectorKind::Native);
        let each = (0..size.envs).map(|i| if i % 2 == 0 { &value } else { &other });
        let each = Each::Values(each.cloned().collect());
        vector.each = BTreeMap::from([(name.clone(), each)]);
        let what = format!("with {name}={value} and {name}={other} in turn");
        // (a vector may refuse sub-environments with different arguments)
        let Some(mut pair) = Pair::new(&vector, &what, size)? else {
            continue;
        };
        pair.reset(&VectorReset::from(SEED))?;
        pair.steps(size.steps / 2)?;
    }
    Ok(())
}

/// Makes the vector of `spec` as a vector of the kind `kind`.
fn kind(spec: &VectorSpec, kind: VectorKind) -> Result<Box<dyn VectorEnv>> {
    let mut spec = spec.clone();
    spec.vectorization_mode = kind;
    spec.make()
}

/// The vector of the registration and a sync vector, with the results of both.
struct Pair<'a> {
    own: Box<dyn VectorEnv>,
    sync: Box<dyn VectorEnv>,
    seen: Columns,
    expected: Columns,
    actions: gym_core::spaces::Sampler,
    spec: &'a VectorSpec,
    /// A description of the settings, for messages.
    what: &'a str,
    size: Size,
    calls: usize,
}

impl<'a> Pair<'a> {
    /// Makes both vectors; `None` if the vector of the registration refuses the spec.
    fn new(spec: &'a VectorSpec, what: &'a str, size: Size) -> Verdict<Option<Self>> {
        let Ok(own) = kind(spec, VectorKind::Native) else {
            return Ok(None);
        };
        let sync = match kind(spec, VectorKind::Sync) {
            Ok(sync) => sync,
            Err(error) => {
                return broken(format!(
                    "{what}: its vector is made, and a sync vector gives the error: {error}"
                ));
            }
        };
        let facts = |envs: &dyn VectorEnv| {
            let spaces = [envs.single_observation_space(), envs.single_action_space()];
            let [seen, acts] = spaces.map(|space| space.to_string());
            format!(
                "{} environments, {seen}, {acts}, {:?}",
                envs.num_envs(),
                envs.autoreset()
            )
        };
        let (ours, theirs) = (facts(&*own), facts(&*sync));
        if ours != theirs {
            return broken(format!(
                "{what}: its vector has {ours}, and a sync vector has {theirs}"
            ));
        }
        Ok(Some(Self {
            seen: own.columns()?,
            expected: sync.columns()?,
            actions: sync.action_sampler(SEED)?,
            own,
            sync,
            spec,
            what,
            size,
            calls: 0,
        }))
    }

    /// Makes each kind of call on both vectors.
    fn play(&mut self, subject: &Subject<'_>) -> Verdict {
        let Size { envs, steps, .. } = self.size;
        let action = self.actions.sample();
        self.both("a step before the first reset", |envs, columns| {
            envs.step_into(&action, columns)
        })?;
        self.reset(&VectorReset::from(SEED))?;
        self.steps(steps)?;
        self.both("a step with no actions", |envs, columns| {
            envs.step_into(&Value::Null, columns)
        })?;
        self.malformed()?;
        self.steps(3)?;
        self.refused(|len| len.saturating_sub(1))?;
        self.refused(|len| len.min(2) - 1)?;
        // reset every third sub-environment; some of them have a seed
        let mask: Vec<_> = (0..envs).map(|i| i % 3 == 1).collect();
        let seeds = (0..envs).map(|i| (i % 2 == 0).then(|| (50 + i as u64).into()));
        let masked = VectorReset {
            seeds: Seeds::Each(seeds.collect()),
            ..VectorReset::default().mask(mask)
        };
        self.reset(&masked)?;
        self.steps(steps / 2)?;
        self.restored()?;
        self.steps(steps / 2)?;
        for (name, example) in examples(subject).unwrap_or_default() {
            let option = VectorReset::from(SEED + 40).option(name, example);
            self.reset(&option)?;
            self.steps(3)?;
        }
        self.reset(&VectorReset::default().option("no_such_option", "x"))?;
        self.steps(3)?;
        self.reset(&VectorReset::default())?;
        // start again with empty columns
        (self.seen, self.expected) = (Columns::default(), Columns::default());
        self.steps(steps / 2)?;
        for _ in 0..2 {
            self.own.close();
            self.sync.close();
        }
        let action = self.actions.sample();
        self.both("a step after `close`", |envs, columns| {
            envs.step_into(&action, columns)
        })?;
        self.reset(&VectorReset::from(SEED))
    }

    fn reset(&mut self, reset: &VectorReset) -> Verdict {
        self.both("reset", |envs, columns| envs.reset_into(reset, columns))
    }

    /// Takes random steps. Without autoreset, resets the sub-environments whose episode has ended.
    fn steps(&mut self, steps: usize) -> Verdict {
        for _ in 0..steps {
            let actions = self.actions.sample();
            self.both("step", |envs, columns| envs.step_into(&actions, columns))?;
            let ended = self
                .expected
                .terminated
                .iter()
                .zip(&self.expected.truncated);
            let ended: Vec<bool> = ended.map(|(a, b)| *a || *b).collect();
            if self.spec.autoreset_mode == Autoreset::Disabled && ended.contains(&true) {
                let actions = self.actions.sample();
                self.both("a step after an end", |envs, columns| {
                    envs.step_into(&actions, columns)
                })?;
                self.reset(&VectorReset::default().mask(ended))?;
            }
        }
        Ok(())
    }

    /// Takes a step in which one sub-environment has an action outside of its space, or NaN; `index`
    /// returns which of the numbers of all actions that is. If both vectors refuse it, either no sub-environment of the vector has stepped, or all others
    /// have, as in a sync vector.
    fn refused(&mut self, index: fn(usize) -> usize) -> Verdict {
        let beyond = match self.sync.single_action_space() {
            Space::Discrete(space) => space.last() as f64 + 1.0,
            Space::MultiDiscrete(_) | Space::MultiBinary(_) => 100.0,
            Space::Box(_) => f64::NAN,
            _ => return Ok(()),
        };
        let Value::Array(valid) = self.actions.sample() else {
            return Ok(());
        };
        let mut numbers: Vec<f64> = valid.iter_f64().collect();
        if let Some(number) = numbers.get_mut(index(valid.len())) {
            *number = beyond;
        }
        let data = Data::from_f64(valid.dtype(), numbers);
        let wrong = Value::Array(Array::new(valid.shape(), data)?);
        // (a vector may have no snapshots)
        let (Ok(own), Ok(sync)) = (self.own.snapshot(), self.sync.snapshot()) else {
            return Ok(());
        };
        self.both(
            "a step with an action outside of the space",
            |envs, columns| envs.step_into(&wrong, columns),
        )?;
        if self.own.snapshot()? == own {
            self.sync.restore(&sync)?;
        }
        self.steps(3)
    }

    /// Makes calls for another number of sub-environments, which must change nothing.
    fn malformed(&mut self) -> Verdict {
        let more = self.size.envs + 1;
        let mut spec = self.spec.clone();
        spec.num_envs = more;
        if let Ok(other) = kind(&spec, VectorKind::Sync) {
            let actions = other.action_sampler(SEED)?.sample();
            self.both("a step with an action too many", |envs, columns| {
                envs.step_into(&actions, columns)
            })?;
        }
        let seeds = VectorReset::seeds(0..more as u64);
        let masks = [
            vec![true; more],
            vec![false; more - 1],
            vec![true; more - 2],
        ];
        let masks = masks.map(|mask| VectorReset::default().mask(mask));
        for reset in [seeds].iter().chain(&masks) {
            self.both(&format!("the reset {reset:?}"), |envs, columns| {
                envs.reset_into(reset, columns)
            })?;
        }
        self.both("restoring what is no snapshot", |envs, _| {
            envs.restore(&Snapshot::of(&"no such vector")?)
        })?;
        self.steps(2)
    }

    /// Replaces the vector by a new one that is restored from its snapshot.
    fn restored(&mut self) -> Verdict {
        let restored = || -> Result<Box<dyn VectorEnv>> {
            let mut new = kind(self.spec, VectorKind::Native)?;
            new.restore(&self.own.snapshot()?)?;
            Ok(new)
        };
        match restored() {
            Ok(new) => self.own = new,
            // (the environments themselves may have no snapshots)
            Err(error) if self.sync.snapshot().is_ok() => {
                return broken(format!("{}: its vector's snapshot: {error}", self.what));
            }
            Err(_) => return Ok(()),
        }
        for i in 0..self.size.envs {
            let info = |envs: &dyn VectorEnv| {
                let mut info = Info::new();
                envs.info(i, &mut |key, value| {
                    drop(info.insert(key.to_owned(), value));
                });
                info
            };
            let (a, b) = (info(&*self.own), info(&*self.sync));
            if !alike(&a, &b) {
                return broken(format!(
                    "{}: a vector restored from its snapshot has the info {a:?} of sub-environment {i}, and a sync vector has {b:?}",
                    self.what
                ));
            }
        }
        Ok(())
    }

    /// Makes a call on both vectors and compares the results.
    fn both(
        &mut self,
        call: &str,
        make: impl Fn(&mut dyn VectorEnv, &mut Columns) -> Result<()>,
    ) -> Verdict {
        self.calls += 1;
        let place = format!("{}, call {} ({call})", self.what, self.calls);
        let own = make(&mut *self.own, &mut self.seen);
        let sync = make(&mut *self.sync, &mut self.expected);
        match (own, sync) {
            (Ok(()), Ok(())) => self.compare(&place),
            (Err(_), Err(_)) => Ok(()),
            (Ok(()), Err(error)) => broken(format!(
                "{place}: its vector succeeds, and a sync vector gives the error: {error}"
            )),
            (Err(error), Ok(())) => broken(format!(
                "{place}: its vector gives an error, and a sync vector succeeds: {error}"
            )),
        }
    }

    fn compare(&self, place: &str) -> Verdict {
        let (a, b) = (&self.seen, &self.expected);
        let differs = |part: &str, a: &dyn Debug, b: &dyn Debug| {
            broken(format!(
                "{place}: its vector has the {part} {a:?}, and a sync vector has {b:?}"
            ))
        };
        if a.progress != b.progress {
            return differs("progress", &a.progress, &b.progress);
        }
        if !alike(&a.rewards, &b.rewards) {
            return differs("rewards", &a.rewards, &b.rewards);
        }
        for (part, a, b) in [
            ("terminated", &a.terminated, &b.terminated),
            ("truncated", &a.truncated, &b.truncated),
            ("has_final", &a.has_final, &b.has_final),
        ] {
            if a != b {
                return differs(part, a, b);
            }
        }
        if !alike(&a.observations, &b.observations) {
            return differs("observations", &a.observations, &b.observations);
        }
        // the infos contain the last observations
        let infos = |envs: &dyn VectorEnv, columns| -> Info { envs.infos(columns) };
        let [a, b] = [infos(&*self.own, a), infos(&*self.sync, b)];
        if !alike(&a, &b) {
            return differs("infos", &a, &b);
        }
        Ok(())
    }
}
