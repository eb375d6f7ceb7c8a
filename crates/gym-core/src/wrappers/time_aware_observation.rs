use crate::spaces::{BoxSpace, DictSpace, TupleSpace, array_of};
use crate::{
    Array, BoxEnv, DType, Element, Env, Error, Outcome, Reset, Result, Snapshot, Space, Value, WrapperSpec,
};

/// Adds the number of steps taken in the episode to the observation.
///
/// To a dict it is added under a key, to a tuple as its last member; anything else becomes a dict of
/// `obs` and `time`. All this is then flattened to one row of numbers, unless told otherwise.
#[derive(Clone, Debug)]
pub struct TimeAwareObservation<E = BoxEnv> {
    env: E,
    max_timesteps: u32,
    timesteps: u32,
    options: Options,
    /// The space of the observation with the time, before it is flattened.
    full_space: Space,
    space: Space,
    /// The observation with the time.
    full: Value,
    inner: Value,
}

#[derive(Clone, Debug)]
struct Options {
    flatten: bool,
    normalize_time: bool,
    dict_time_key: String,
}

super::reach!(TimeAwareObservation<E>);

impl<E: Env> TimeAwareObservation<E> {
    /// Adds the time to the observations of `env`, which has a time limit in its [`spec`](Env::spec).
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if it has none: see [`with_limit`](Self::with_limit);
    /// [`Error::InvalidSpace`] if the observations do not flatten.
    pub fn new(env: E) -> Result<Self> {
        match env.spec().and_then(|spec| spec.time_limit()) {
            Some(limit) => Self::with_limit(env, limit),
            None => Err(Error::argument(
                "TimeAwareObservation",
                "no time limit is known: wrap what `make` gives in TimeLimit, or use `with_limit`",
            )),
        }
    }

    /// Adds the time to the observations of an environment whose episodes last `max_timesteps` at most.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a limit of 0 or beyond an `int32`, or if a dict has the key `time`
    /// already; [`Error::InvalidSpace`] if the observations do not flatten.
    pub fn with_limit(env: E, max_timesteps: u32) -> Result<Self> {
        let options = Options { flatten: true, normalize_time: false, dict_time_key: "time".into() };
        Self::build(env, max_timesteps, options)
    }

    /// Leaves the observation as it is beside the time with `false`.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the observations do not flatten.
    pub fn with_flatten(self, flatten: bool) -> Result<Self> {
        Self::build(self.env, self.max_timesteps, Options { flatten, ..self.options })
    }

    /// Observes the share of the time limit that has gone by, in `[0, 1]`, instead of steps.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the observations do not flatten.
    pub fn with_normalize_time(self, normalize_time: bool) -> Result<Self> {
        Self::build(self.env, self.max_timesteps, Options { normalize_time, ..self.options })
    }

    /// Adds the time to dict observations under another key than `time`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the observation has that key already.
    pub fn with_dict_time_key(self, key: impl Into<String>) -> Result<Self> {
        let dict_time_key = key.into();
        Self::build(self.env, self.max_timesteps, Options { dict_time_key, ..self.options })
    }

    pub(crate) fn build_with(
        env: E,
        flatten: bool,
        normalize_time: bool,
        dict_time_key: Option<String>,
        max_timesteps: Option<u32>,
    ) -> Result<Self> {
        let known = || env.spec().and_then(|spec| spec.time_limit());
        let Some(limit) = max_timesteps.or_else(known) else { return Self::new(env) };
        let dict_time_key = dict_time_key.unwrap_or_else(|| "time".into());
        Self::build(env, limit, Options { flatten, normalize_time, dict_time_key })
    }

    fn build(env: E, max_timesteps: u32, options: Options) -> Result<Self> {
        let refuse = |reason: String| Error::argument("TimeAwareObservation", reason);
        if max_timesteps == 0 || i32::try_from(max_timesteps).is_err() {
            return Err(refuse(format!("a time limit of {max_timesteps} does not fit an int32 above 0")));
        }
        let (time, zero) = match options.normalize_time {
            true => (BoxSpace::uniform(0.0, 1.0, [1], DType::F32)?, Array::zeros(DType::F32, [1])),
            false => {
                let space = BoxSpace::uniform(0.0, f64::from(max_timesteps), [1], DType::I32)?;
                (space, Array::zeros(DType::I32, [1]))
            }
        };
        let (time, zero) = (Space::from(time), Value::Array(zero));
        let key = &options.dict_time_key;
        let (full_space, full) = match env.observation_space() {
            Space::Dict(space) => {
                let sorted = super::filter_observation::is_sorted(&space);
                let members = std::iter::once((key.clone(), time)).chain(space.spaces().iter().cloned());
                let build = if sorted { DictSpace::new } else { DictSpace::in_order };
                let space = build(members.collect::<Vec<_>>()).map_err(|error| refuse(error.to_string()))?;
                let zeros = space
                    .spaces()
                    .iter()
                    .map(|(name, _)| (name.clone(), if name == key { zero.clone() } else { Value::Null }));
                let full = Value::Dict(zeros.collect());
                (Space::from(space), full)
            }
            Space::Tuple(space) => {
                let mut full = vec![Value::Null; space.spaces().len()];
                full.push(zero);
                let members = space.spaces().iter().cloned().chain(std::iter::once(time));
                (TupleSpace::new(members).into(), Value::Tuple(full))
            }
            space => {
                let full = vec![("obs".to_owned(), Value::Null), ("time".to_owned(), zero)];
                (DictSpace::new([("obs", space), ("time", time)])?.into(), Value::Dict(full))
            }
        };
        let space = if options.flatten { full_space.flatten_space()? } else { full_space.clone() };
        let inner = Value::Null;
        Ok(Self { env, max_timesteps, timesteps: 0, options, full_space, space, full, inner })
    }

    /// The steps taken since the last reset.
    pub fn timesteps(&self) -> u32 {
        self.timesteps
    }

    /// The time limit.
    pub fn max_timesteps(&self) -> u32 {
        self.max_timesteps
    }

    fn observe(&mut self, out: &mut Value) -> Result<()> {
        let time = f64::from(self.timesteps);
        let time = if self.options.normalize_time { time / f64::from(self.max_timesteps) } else { time };
        let set_time = |value: &mut Value| {
            if let Value::Array(array) = value {
                array.set_f64(0, time);
            }
        };
        let lacking = || Error::Contract("the observation is not of the form of its space".into());
        match (&mut self.full, &self.inner) {
            (Value::Dict(entries), Value::Dict(_)) => {
                for (name, value) in entries {
                    if *name == self.options.dict_time_key {
                        set_time(value);
                    } else {
                        value.clone_from(self.inner.get(name).ok_or_else(lacking)?);
                    }
                }
            }
            (Value::Tuple(entries), Value::Tuple(members)) => {
                let [entries @ .., last] = entries.as_mut_slice() else { return Err(lacking()) };
                if entries.len() != members.len() {
                    return Err(lacking());
                }
                entries.iter_mut().zip(members).for_each(|(entry, member)| entry.clone_from(member));
                set_time(last);
            }
            (Value::Dict(entries), inner) => {
                let [(_, obs), (_, last)] = entries.as_mut_slice() else { return Err(lacking()) };
                obs.clone_from(inner);
                set_time(last);
            }
            _ => return Err(lacking()),
        }
        match &self.space {
            Space::Box(space) if self.options.flatten => {
                let array = array_of(out, space.dtype(), space.shape());
                let broken = |error: Error| Error::Contract(error.to_string());
                self.full_space.flatten_into(&self.full, array).map_err(broken)?;
            }
            _ if self.options.flatten => *out = self.full_space.flatten(&self.full)?,
            _ => out.clone_from(&self.full),
        }
        Ok(())
    }
}

impl<E: Env> crate::Wrapper for TimeAwareObservation<E> {
    type Observation = Value;
    type Action = E::Action;

    super::within!(E);

    fn observation_space(&self) -> Space {
        self.space.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let Self { env, inner, .. } = self;
        E::Observation::fill(inner, |inner| env.reset_into(reset, inner))?;
        self.timesteps = 0;
        self.observe(observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut Value) -> Result<Outcome> {
        let Self { env, inner, .. } = self;
        let outcome = E::Observation::fill(inner, |inner| env.step_into(action, inner))?;
        self.timesteps = self.timesteps.saturating_add(1);
        self.observe(observation)?;
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.env.snapshot()?, self.timesteps))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, timesteps) = snapshot.get()?;
        self.env.restore(&env)?;
        self.timesteps = timesteps;
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        let wrapper = WrapperSpec::new("TimeAwareObservation")
            .arg("flatten", self.options.flatten)
            .arg("normalize_time", self.options.normalize_time)
            .arg("dict_time_key", self.options.dict_time_key.as_str());
        let known = self.env.spec().and_then(|spec| spec.time_limit());
        Some(match known == Some(self.max_timesteps) {
            true => wrapper,
            false => wrapper.arg("max_timesteps", self.max_timesteps),
        })
    }
}
