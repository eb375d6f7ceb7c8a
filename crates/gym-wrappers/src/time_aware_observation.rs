//! Observations that include the number of steps.

use gym_core::registry::WrapperConfig;
use gym_core::spaces::{BoxSpace, DictSpace, TupleSpace, array_of};
use gym_core::{Array, BoxEnv, DType, Env, Error, Result, Snapshot, Space, Value};

use crate::filter_observation::dict_like;
use crate::observing::{Observer, Observing};

/// Adds the number of steps taken in the episode to the observation.
///
/// A dict gets a key, a tuple a last member; other observations become a dict of `obs` and `time`.
/// By default the result is flattened to one row of numbers.
pub type TimeAwareObservation<E = BoxEnv> = Observing<E, TimeAware>;

/// The observer of [`TimeAwareObservation`].
#[derive(Clone, Debug)]
pub struct TimeAware {
    config: Config,
    max_timesteps: u32,
    timesteps: u32,
    /// The space of the unflattened observation with the time.
    full_space: Space,
    /// The unflattened observation with the time.
    full: Value,
}

gym_core::arguments! {
    /// The arguments of [`TimeAwareObservation`].
    pub struct Config {
        /// Whether the observation and the time are flattened to one row of numbers.
        pub flatten: bool = true,
        /// Whether the time is the elapsed share of the limit, in `[0, 1]`, instead of a number of
        /// steps.
        pub normalize_time: bool = false,
        /// The key of the time in dict observations.
        pub dict_time_key: String = "time".into(),
        /// The time limit, above 0; the default is the limit in the environment's spec.
        pub max_timesteps: Option<u32> = None,
    }
}

gym_core::register_wrapper!(
    "TimeAwareObservation", "adds the number of steps to observations", Config, env: TimeAwareObservation::new
);

impl<E: Env> TimeAwareObservation<E> {
    /// Adds the time to the observations of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a time limit of 0, beyond `int32` or unknown, or if a dict
    /// already has the key of the time; [`Error::InvalidSpace`] if the observations do not flatten.
    pub fn new(env: E, config: impl Into<Config>) -> Result<Self> {
        let config = config.into();
        let known = || env.spec().and_then(|spec| spec.time_limit());
        let Some(max_timesteps) = config.max_timesteps.or_else(known) else {
            return Err(Config::refuse(
                "the time limit is unknown: wrap the environment in TimeLimit, or give max_timesteps",
            ));
        };
        if max_timesteps == 0 || i32::try_from(max_timesteps).is_err() {
            let reason = format!("a time limit of {max_timesteps} does not fit an int32 above 0");
            return Err(Config::refuse(reason));
        }
        let (dtype, limit) = if config.normalize_time {
            (DType::F32, 1.0)
        } else {
            (DType::I32, f64::from(max_timesteps))
        };
        let time = Space::from(BoxSpace::uniform(0.0, limit, [1], dtype)?);
        let zero = Value::Array(Array::zeros(dtype, [1])?);
        let key = &config.dict_time_key;
        let (full_space, full) = match env.observation_space() {
            Space::Dict(space) => {
                let members =
                    std::iter::once((key.clone(), time)).chain(space.spaces().iter().cloned());
                let space = dict_like(&space, members.collect())
                    .map_err(|error| Config::refuse(error.to_string()))?;
                let value = |name: &String| {
                    if name == key {
                        zero.clone()
                    } else {
                        Value::Null
                    }
                };
                let full = space
                    .spaces()
                    .iter()
                    .map(|(name, _)| (name.clone(), value(name)))
                    .collect();
                (Space::from(space), Value::Dict(full))
            }
            Space::Tuple(space) => {
                let mut full = vec![Value::Null; space.spaces().len()];
                full.push(zero);
                let members = space.spaces().iter().cloned().chain(std::iter::once(time));
                (TupleSpace::new(members).into(), Value::Tuple(full))
            }
            space => {
                let full = vec![("obs".to_owned(), Value::Null), ("time".to_owned(), zero)];
                (
                    DictSpace::new([("obs", space), ("time", time)])?.into(),
                    Value::Dict(full),
                )
            }
        };
        let space = if config.flatten {
            full_space.flatten_space()?
        } else {
            full_space.clone()
        };
        let observer = TimeAware {
            config,
            max_timesteps,
            timesteps: 0,
            full_space,
            full,
        };
        Ok(Self::with_observer(env, observer, space))
    }
}

impl Observer for TimeAware {
    type Config = Config;

    fn arguments(&self) -> Config {
        self.config.clone()
    }

    fn observe<E: Env>(
        &mut self,
        _env: &mut E,
        space: &Space,
        seen: &mut Value,
        is_reset: bool,
        out: &mut Value,
    ) -> Result<()> {
        self.timesteps = if is_reset {
            0
        } else {
            self.timesteps.saturating_add(1)
        };
        let time = f64::from(self.timesteps);
        let time = if self.config.normalize_time {
            time / f64::from(self.max_timesteps)
        } else {
            time
        };
        let set_time = |value: &mut Value| {
            if let Value::Array(array) = value {
                array.set_f64(0, time);
            }
        };
        let lacking = || Error::Contract("the observation does not fit its space".into());
        match (&mut self.full, &*seen) {
            (Value::Dict(entries), Value::Dict(_)) => {
                for (name, value) in entries {
                    if *name == self.config.dict_time_key {
                        set_time(value);
                    } else {
                        value.clone_from(seen.get(name).ok_or_else(lacking)?);
                    }
                }
            }
            (Value::Tuple(entries), Value::Tuple(members)) => {
                let [entries @ .., last] = entries.as_mut_slice() else {
                    return Err(lacking());
                };
                if entries.len() != members.len() {
                    return Err(lacking());
                }
                entries
                    .iter_mut()
                    .zip(members)
                    .for_each(|(entry, member)| entry.clone_from(member));
                set_time(last);
            }
            (Value::Dict(entries), seen) => {
                let [(_, obs), (_, last)] = entries.as_mut_slice() else {
                    return Err(lacking());
                };
                obs.clone_from(seen);
                set_time(last);
            }
            _ => return Err(lacking()),
        }
        match space {
            Space::Box(space) if self.config.flatten => {
                let array = array_of(out, space.dtype(), space.shape());
                let broken = |error: Error| Error::Contract(error.to_string());
                self.full_space
                    .flatten_into(&self.full, array)
                    .map_err(broken)?;
            }
            _ if self.config.flatten => *out = self.full_space.flatten(&self.full)?,
            _ => out.clone_from(&self.full),
        }
        Ok(())
    }

    fn snapshot<E: Env>(&self, env: &E) -> Result<Snapshot> {
        Snapshot::of(&(env.snapshot()?, self.timesteps))
    }

    fn restore<E: Env>(&mut self, env: &mut E, snapshot: &Snapshot) -> Result<()> {
        let (inner, timesteps) = snapshot.get()?;
        env.restore(&inner)?;
        self.timesteps = timesteps;
        Ok(())
    }
}
