//! The search for an effect of a change of arguments or options.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use serde_json::Value as Json;

use crate::calls::Calls;
use crate::damage::moves;
use crate::subject::{SEEDS, STEPS, Shown, Subject, alike, info};
use gym_core::spaces::Sampler;
use gym_core::{BoxEnv, Env, EnvExt, EnvSpec, Kwargs, Reset, Result, Snapshot};

/// A way to make an environment, and to reset it.
#[derive(Clone)]
pub(crate) struct Variant {
    pub(crate) spec: EnvSpec,
    pub(crate) options: Kwargs,
}

impl Variant {
    /// Returns this variant with other arguments.
    pub(crate) fn with_arguments(
        mut self,
        arguments: impl IntoIterator<Item = (String, Json)>,
    ) -> Self {
        self.spec.kwargs.extend(arguments);
        self
    }

    /// Returns this variant with a reset option.
    pub(crate) fn with_option(mut self, name: &str, value: Json) -> Self {
        self.options.insert(name.to_owned(), value);
        self
    }
}

/// The result of a [`Search`].
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Effect {
    /// The environment refuses every change.
    Refused,
    /// The environment accepts some changes, but they have no effect.
    None,
    Seen,
}

/// Searches for an effect of a change; cheap comparisons come first.
pub(crate) struct Search {
    /// The default variant, and the default variant with each bool inverted, because a bool may
    /// hide the effect of other arguments.
    surroundings: Vec<Variant>,
    /// The episodes of each variant in `surroundings` and each seed, played once for all changes.
    plays: BTreeMap<(usize, u64), Result<Play>>,
    long: usize,
    few: usize,
}

impl Search {
    pub(crate) fn new(subject: &Subject<'_>, surroundings: Vec<Variant>) -> Result<Self> {
        Ok(Self {
            surroundings,
            plays: BTreeMap::new(),
            long: subject.long()?,
            few: subject.few()?,
        })
    }

    /// Returns the effect of `changes`. Each change turns a variant of `surroundings` into a
    /// changed variant, or into `None` if it does not apply.
    pub(crate) fn effect(&mut self, changes: &[impl Fn(&Variant) -> Option<Variant>]) -> Effect {
        let mut effect = Effect::Refused;
        let [seed, others @ ..] = SEEDS;
        let short = (STEPS, &[seed][..]);
        let long = (self.long, &[&[seed], &others[..]].concat()[..]);
        for (steps, seeds) in [short, long] {
            for (i, surrounding) in self.surroundings.iter().enumerate() {
                for variant in changes.iter().filter_map(|change| change(surrounding)) {
                    for &seed in seeds {
                        let play = match self.plays.entry((i, seed)) {
                            Entry::Occupied(entry) => entry.into_mut(),
                            Entry::Vacant(entry) => entry.insert(Play::start(surrounding, seed)),
                        };
                        let (Ok(play), Ok(mut other)) = (play, Play::start(&variant, seed)) else {
                            break;
                        };
                        effect = Effect::None;
                        if play.differs(&mut other, steps) {
                            return Effect::Seen;
                        }
                    }
                }
            }
        }
        let is_seen = self.surroundings.iter().any(|surrounding| {
            let mut variants = changes.iter().filter_map(|change| change(surrounding));
            variants.any(|variant| {
                differ_elsewhere(surrounding, &variant, seed, self.few).unwrap_or(false)
            })
        });
        if is_seen { Effect::Seen } else { effect }
    }
}

/// Episodes with random actions, played only as far as a comparison needs.
struct Play {
    env: BoxEnv,
    actions: Sampler,
    options: Kwargs,
    /// The spaces and the metadata, as text.
    look: String,
    /// The first drawing.
    drawing: Drawing,
    shown: Vec<Shown>,
}

impl Play {
    fn start(Variant { spec, options }: &Variant, seed: u64) -> Result<Self> {
        let mut env = spec.make()?;
        let observation = env.reset(Reset {
            options: options.clone(),
            ..Reset::seed(seed)
        })?;
        let spaces = [env.observation_space(), env.action_space()];
        let look = format!("{} {} {:?}", spaces[0], spaces[1], env.metadata());
        let drawing = drawing(&env);
        let shown = vec![Shown::Reset(observation, info(&env))];
        Ok(Self {
            actions: env.action_sampler(seed)?,
            options: options.clone(),
            env,
            look,
            drawing,
            shown,
        })
    }

    /// Returns the result of a reset or step.
    fn event(&mut self, i: usize) -> Result<&Shown> {
        while self.shown.len() <= i {
            let shown = match self.shown.last() {
                Some(Shown::Step(step, _)) if step.done() => {
                    let options = self.options.clone();
                    Shown::Reset(
                        self.env.reset(Reset {
                            options,
                            ..Reset::default()
                        })?,
                        info(&self.env),
                    )
                }
                _ => Shown::Step(self.env.step(&self.actions.sample())?, info(&self.env)),
            };
            self.shown.push(shown);
        }
        Ok(&self.shown[i])
    }

    /// Returns whether two plays differ within `events` events, or in the last drawing.
    fn differs(&mut self, other: &mut Self, events: usize) -> bool {
        if self.look != other.look || self.drawing != other.drawing {
            return true;
        }
        for i in 0..=events {
            match (self.event(i), other.event(i)) {
                (Ok(a), Ok(b)) if alike(a, b) => (),
                (Err(_), Err(_)) => return false,
                _ => return true,
            }
        }
        // the last drawings are of the same step only if both plays have equal length
        self.shown.len() == other.shown.len() && drawing(&self.env) != drawing(&other.env)
    }
}

/// The calls of a drawing, and the drawing as text.
type Drawing = (Vec<u8>, Option<String>);

fn drawing(env: &BoxEnv) -> Drawing {
    (Calls::of(env).record, env.ansi())
}

/// Returns whether two variants differ in states that random actions do not reach. Such states come
/// from snapshots in which one number or bool is changed.
fn differ_elsewhere(a: &Variant, b: &Variant, seed: u64, steps: usize) -> Result<bool> {
    const START: usize = 5;
    /// The largest number of changes to try, because large models have hundreds of numbers.
    const MAX: usize = 100;
    let [mut a, mut b] = [Play::start(a, seed)?, Play::start(b, seed)?];
    for play in [&mut a, &mut b] {
        play.event(START)?;
    }
    let [mut at_a, mut at_b] = [
        a.env.snapshot()?.get::<Json>()?,
        b.env.snapshot()?.get::<Json>()?,
    ];
    // skip the parts in which the two snapshots differ: these parts are the effect of the change
    // itself
    let moves = moves(&at_a)
        .into_iter()
        .filter(|to| to.is_same(&at_a, &at_b));
    for to in moves.take(MAX).collect::<Vec<_>>() {
        let restored = |env: &BoxEnv, json: &mut Json| {
            let mut env = env.clone();
            to.done_to(json, |json| env.restore(&Snapshot::of(json)?))
                .map(|()| env)
        };
        let (Ok(mut a), Ok(mut b)) = (restored(&a.env, &mut at_a), restored(&b.env, &mut at_b))
        else {
            continue;
        };
        let mut actions = a.action_sampler(seed)?;
        for _ in 0..steps {
            let action = actions.sample();
            let (Ok(step), Ok(other)) = (a.step(&action), b.step(&action)) else {
                break;
            };
            if !alike(&step, &other) || !alike(&info(&a), &info(&b)) {
                return Ok(true);
            }
            if step.done() {
                break;
            }
        }
    }
    Ok(false)
}
