//! Vectors: many environments stepped together.

use std::collections::BTreeMap;
use std::mem::ManuallyDrop;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};

use gym::registry::{Each, EnvBuilder};
use gym::render::RenderMode;
use gym::vector::{
    AsyncVectorEnv, Autoreset, Columns, Seeds, VectorEnv, VectorEnvExt, VectorKind, VectorReset,
    VectorSpec,
};
use gym::{BoxEnv, Error, Info, Kwargs, Seed, Snapshot, Space, Value, WrapperSpec, builder};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyDict, PyList, PyTuple};
use serde_json::{Value as Json, json};

use crate::convert::{action_from_python, new_array, refill, rendered, to_python};
use crate::env::Env;
use crate::error::{OrRaise, guard, gymnasium};
use crate::fork::{IN_USE, Origin, THREADS};
use crate::infos::{Key, info_keys, ordered};
use crate::json::{from_json, reset_of};
use crate::numbers::Numbers;

/// A vector of environments. The vector releases the GIL during a call.
#[pyclass(frozen, module = "rustgym._native")]
#[derive(Debug)]
pub(crate) struct Vector {
    /// A forked child must not drop the vector: dropping waits for threads that exist only in the
    /// parent.
    core: ManuallyDrop<Mutex<Core>>,
    spec: VectorSpec,
    /// The space of one action, and the space of a batch.
    action: Space,
    actions: Space,
    /// The types of infos.
    numbers: Numbers,
    /// See [`info_keys`].
    info_keys: OnceLock<[Vec<Key>; 2]>,
    origin: Origin,
}

#[derive(Debug)]
struct Core {
    envs: Envs,
    columns: Columns,
    /// The arrays returned by the last two steps, the older first, if they are reused.
    spares: Option<[Option<Py<PyTuple>>; 2]>,
}

#[derive(Debug)]
enum Envs {
    /// A sync or native vector.
    Here(Box<dyn VectorEnv>),
    /// An async vector. The variant has the concrete type for `send` and `recv`.
    Async(Box<AsyncVectorEnv>),
}

impl Envs {
    fn as_dyn(&mut self) -> &mut (dyn VectorEnv + 'static) {
        match self {
            Self::Here(envs) => envs.as_mut(),
            Self::Async(envs) => envs.as_mut(),
        }
    }

    fn of_threads(&mut self) -> PyResult<&mut AsyncVectorEnv> {
        match self {
            Self::Async(envs) => Ok(envs),
            Self::Here(_) => Err(Error::custom(
                "only a vector of kind async can step some of its environments: make one with kind=\"async\"",
            ))
            .or_raise(),
        }
    }
}

impl Drop for Vector {
    fn drop(&mut self) {
        if self.origin.is_here() {
            // SAFETY: the field is not used after this.
            unsafe { ManuallyDrop::drop(&mut self.core) };
        }
    }
}

impl Vector {
    fn lock(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Core>> {
        let has_threads = self.spec.vectorization_mode == VectorKind::Async;
        if has_threads {
            self.origin.check("vector", THREADS)?;
        }
        match self.core.try_lock() {
            Ok(core) => Ok(core),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                self.origin.check("vector", IN_USE)?;
                Ok(self
                    .core
                    .lock_py_attached(py)
                    .unwrap_or_else(PoisonError::into_inner))
            }
        }
    }

    fn info_keys(&self, py: Python<'_>) -> &[Vec<Key>; 2] {
        self.info_keys.get_or_init(|| info_keys(py, &self.spec.env))
    }

    /// Converts a batch of `n` actions in the space `batch`.
    fn actions(&self, n: usize, batch: &Space, actions: &Bound<'_, PyAny>) -> PyResult<Value> {
        action_from_python(&self.action, Some((n, batch)), actions).map_err(|error| {
            let py = actions.py();
            let text = format!(
                "invalid actions: the action space is {batch} ({})",
                error.value(py)
            );
            gymnasium(py, "InvalidAction", text)
        })
    }
}

impl Core {
    /// Returns arrays for observations, rewards and flags: new arrays, or the arrays that the step
    /// before last returned.
    fn arrays<'py>(&mut self, py: Python<'py>) -> PyResult<[Bound<'py, PyAny>; 4]> {
        let Self {
            columns, spares, ..
        } = self;
        let old = spares.as_mut().and_then(|spares| {
            spares.swap(0, 1);
            spares[0].take().map(|old| old.into_bound(py))
        });
        let old = |i: usize| old.as_ref().and_then(|old| old.get_item(i).ok());
        let n = [columns.len()];
        let arrays = [
            refill(py, &columns.observations, old(0))?,
            old(1).map_or_else(
                || Ok(new_array(py, &n, &columns.rewards)),
                |to| copy_into(to, &columns.rewards),
            )?,
            old(2).map_or_else(
                || Ok(new_array(py, &n, &columns.terminated)),
                |to| copy_into(to, &columns.terminated),
            )?,
            old(3).map_or_else(
                || Ok(new_array(py, &n, &columns.truncated)),
                |to| copy_into(to, &columns.truncated),
            )?,
        ];
        if let Some(spares) = spares {
            spares[0] = Some(PyTuple::new(py, &arrays)?.unbind());
        }
        Ok(arrays)
    }

    /// The infos as a dict of columns in Gymnasium's order, each with its mask.
    fn infos<'py, 'a>(
        &mut self,
        py: Python<'py>,
        order: impl FnOnce() -> &'a [Key],
        numbers: (&Numbers, bool),
    ) -> PyResult<Bound<'py, PyDict>> {
        let Self { envs, columns, .. } = self;
        let infos: Info = guard(|| Ok(envs.as_dyn().infos(columns)))?;
        let dict = PyDict::new(py);
        if infos.is_empty() {
            return Ok(dict);
        }
        ordered(py, &infos, order(), numbers, &dict)?;
        Ok(dict)
    }
}

fn copy_into<'py, T: numpy::Element + Copy>(
    array: Bound<'py, PyAny>,
    numbers: &[T],
) -> PyResult<Bound<'py, PyAny>> {
    array
        .cast::<PyArray1<T>>()?
        .try_readwrite()?
        .as_slice_mut()?
        .copy_from_slice(numbers);
    Ok(array)
}

#[pymethods]
impl Vector {
    /// Makes a vector of `num_envs` environments `id`, each with the same arguments and the
    /// wrappers of `make`.
    #[new]
    #[pyo3(signature = (id, num_envs, kind, kwargs, render_mode, max_episode_steps, autoreset, threads, copy, wrappers = "[]", each = "{}", render_size = None, affinity = None))]
    #[expect(clippy::too_many_arguments, reason = "the Python side names them")]
    fn new(
        id: &str,
        num_envs: usize,
        kind: Option<&str>,
        kwargs: &str,
        render_mode: Option<&str>,
        max_episode_steps: Option<i64>,
        autoreset: &str,
        threads: Option<usize>,
        copy: bool,
        wrappers: &str,
        each: &str,
        render_size: Option<(u32, u32)>,
        affinity: Option<usize>,
    ) -> PyResult<Self> {
        guard(|| {
            let map: Kwargs = from_json(id, kwargs)?;
            let wrappers: Vec<WrapperSpec> = from_json(id, wrappers)?;
            let each: BTreeMap<String, Each> = from_json(id, each)?;
            let autoreset: Autoreset = serde_json::from_value(json!(autoreset))
                .map_err(|error| Error::argument("autoreset_mode", error.to_string()))
                .or_raise()?;
            let mut env = builder(id).args(map);
            if let Some(steps) = max_episode_steps {
                env = env.args(
                    [("max_episode_steps".to_owned(), json!(steps))]
                        .into_iter()
                        .collect(),
                );
            }
            if let Some(mode) = render_mode {
                env = env.render_mode(mode.parse().or_raise()?);
            }
            if let Some((width, height)) = render_size {
                env = env.render_size(width, height);
            }
            let env = wrappers.into_iter().fold(env, EnvBuilder::wrap);
            let mut vector = env.vector(num_envs).autoreset(autoreset);
            for (name, values) in each {
                vector = vector.arg_each(&name, values);
            }
            if let Some(kind) = kind {
                vector = vector.kind(kind.parse().or_raise()?);
            }
            if let Some(threads) = threads {
                vector = vector.threads(threads);
            }
            if let Some(first) = affinity {
                vector = vector.affinity(first);
            }
            let (spec, made) = vector.resolve().or_raise()?;
            let envs = match made {
                Some(vector) => Envs::Here(vector),
                None => make(&spec)?,
            };
            Self::holding(envs, spec, copy)
        })
    }

    /// The kind of the vector: `sync`, `async` or `native`.
    #[getter]
    fn kind(&self) -> &'static str {
        self.spec.vectorization_mode.name()
    }

    /// Starts episodes. There is one seed for all environments, or a list with one for each; `mask`
    /// selects the environments.
    #[pyo3(signature = (seed, seeds, options, mask))]
    fn reset<'py>(
        &self,
        py: Python<'py>,
        seed: Option<&str>,
        seeds: Option<Vec<Option<String>>>,
        options: Option<&str>,
        mask: Option<Vec<bool>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let one = reset_of(seed, options).or_raise()?;
        let each = seeds.map(|seeds| {
            let seeds = seeds
                .into_iter()
                .map(|seed| seed.map(|seed| Ok(seed.parse::<Seed>()?)).transpose());
            seeds.collect::<gym::Result<Vec<_>>>()
        });
        let seeds = match each.transpose().or_raise()? {
            Some(seeds) => Seeds::Each(seeds),
            None => one.seed.map_or(Seeds::None, Seeds::From),
        };
        let reset = VectorReset {
            seeds,
            options: one.options,
            mask,
        };
        let mut core = self.lock(py)?;
        let Core { envs, columns, .. } = &mut *core;
        py.detach(|| guard(|| envs.as_dyn().reset_into(&reset, columns).or_raise()))?;
        let [observations, ..] = core.arrays(py)?;
        Ok((
            observations,
            core.infos(py, || &self.info_keys(py)[0], (&self.numbers, false))?,
        ))
    }

    /// Takes a step in each environment. Returns observations, rewards, terminated, truncated and
    /// infos; these have the columns `ongoing` too, if no episode ends.
    #[pyo3(signature = (actions, ongoing = None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        actions: &Bound<'py, PyAny>,
        ongoing: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        let numbers = (&self.numbers, self.numbers.is_single(actions));
        let actions = self.actions(self.spec.num_envs, &self.actions, actions)?;
        let mut core = self.lock(py)?;
        let Core { envs, columns, .. } = &mut *core;
        py.detach(|| guard(|| envs.as_dyn().step_into(&actions, columns).or_raise()))?;
        let flags = [&columns.terminated, &columns.truncated];
        let has_ended = flags.into_iter().flatten().any(|flag| *flag);
        let [observations, rewards, terminated, truncated] = core.arrays(py)?;
        let infos = core.infos(py, || &self.info_keys(py)[1], numbers)?;
        if let Some(ongoing) = ongoing.filter(|_| !has_ended) {
            infos.update(ongoing.as_mapping())?;
        }
        (observations, rewards, terminated, truncated, infos).into_pyobject(py)
    }

    /// Starts a step of the environments `ids`, and returns at once.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "Python lends no slice of them"
    )]
    fn send(&self, py: Python<'_>, actions: &Bound<'_, PyAny>, ids: Vec<usize>) -> PyResult<()> {
        let batch = self.action.batch(ids.len().max(1)).or_raise()?;
        let actions = self.actions(ids.len(), &batch, actions)?;
        let mut core = self.lock(py)?;
        let envs = core.envs.of_threads()?;
        py.detach(|| guard(|| envs.send(&actions, &ids).or_raise()))
    }

    /// Waits for the first `m` environments. Returns observations, rewards, terminated, truncated,
    /// infos and ids.
    fn recv<'py>(&self, py: Python<'py>, m: usize) -> PyResult<Bound<'py, PyTuple>> {
        let mut core = self.lock(py)?;
        let mut ids = Vec::new();
        let mut columns = Columns::default();
        let envs = core.envs.of_threads()?;
        py.detach(|| guard(|| envs.recv_into(m, &mut ids, &mut columns).or_raise()))?;
        let infos = PyList::empty(py);
        for id in &ids {
            let info = PyDict::new(py);
            for (key, value) in guard(|| Ok(envs.info_map(*id)))? {
                info.set_item(key, to_python(py, &value)?)?;
            }
            infos.append(info)?;
        }
        let n = [columns.len()];
        let observations = to_python(py, &columns.observations)?;
        let rewards = new_array(py, &n, &columns.rewards);
        let flags = [&columns.terminated, &columns.truncated].map(|flags| new_array(py, &n, flags));
        let [terminated, truncated] = flags;
        (observations, rewards, terminated, truncated, infos, ids).into_pyobject(py)
    }

    /// The pictures or texts of the vector's render mode.
    fn render<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let mut core = self.lock(py)?;
        let envs = &mut core.envs;
        let frames = py.detach(|| guard(|| envs.as_dyn().render().or_raise()))?;
        let frames = frames
            .iter()
            .map(|frame| rendered(py, frame))
            .collect::<PyResult<Vec<_>>>()?;
        PyTuple::new(py, frames)
    }

    /// Spaces and metadata of one environment, as JSON.
    fn describe(&self, py: Python<'_>) -> PyResult<String> {
        let mut core = self.lock(py)?;
        let envs = core.envs.as_dyn();
        let metadata = envs.metadata();
        let description = json!({
            "observation_space": envs.single_observation_space(),
            "action_space": envs.single_action_space(),
            "render_modes": metadata.render_modes,
            "render_fps": metadata.render_fps,
        });
        Ok(description.to_string())
    }

    /// Whether each environment's episode ended in the last step.
    fn done<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let core = self.lock(py)?;
        let done: Vec<bool> = (0..core.columns.len())
            .map(|i| core.columns.done(i))
            .collect();
        Ok(new_array(py, &[done.len()], &done))
    }

    /// The states as a JSON list, for environments whose dynamics are pure functions of their
    /// state.
    fn states(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let mut core = self.lock(py)?;
        guard(|| {
            let envs = core.envs.as_dyn();
            let mut states = Vec::with_capacity(envs.num_envs());
            for index in 0..envs.num_envs() {
                let mut state = None;
                let seen = envs.inspect(index, &mut |env| state = env.state());
                let Some(state) = state.filter(|_| seen.is_ok()) else {
                    return Ok(None);
                };
                states.push(state);
            }
            Ok(Some(Json::Array(states).to_string()))
        })
    }

    /// Copies of the environments with their wrappers.
    fn envs(&self, py: Python<'_>) -> PyResult<Vec<Env>> {
        let mut core = self.lock(py)?;
        let copies = guard(|| {
            core.envs
                .as_dyn()
                .call(|_, env: &mut BoxEnv| env.clone())
                .or_raise()
        })?;
        Ok(copies
            .into_iter()
            .map(|env| Env::of_vector(env, &self.spec.env))
            .collect())
    }

    /// Replaces the vector's environments.
    fn set_envs(&self, py: Python<'_>, envs: Vec<Bound<'_, Env>>) -> PyResult<()> {
        let copies = envs
            .into_iter()
            .map(|env| env.get().inner(py))
            .collect::<PyResult<Vec<_>>>()?;
        let mut core = self.lock(py)?;
        let mut copies = copies.into_iter();
        core.envs
            .as_dyn()
            .call(|_, env: &mut BoxEnv| {
                if let Some(copy) = copies.next() {
                    env.replace_with(copy);
                }
            })
            .map(|_| ())
            .or_raise()
    }

    /// The constructor's arguments, and a snapshot to continue from.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, vector) = (slf.py(), slf.get());
        let mut core = vector.lock(py)?;
        let copy = core.spares.is_none();
        let envs = &mut core.envs;
        let (spec, snapshot) = py.detach(|| {
            guard(|| {
                let snapshot: Json = envs
                    .as_dyn()
                    .snapshot()
                    .and_then(|snapshot| snapshot.get())
                    .or_raise()?;
                Ok((json!(vector.spec).to_string(), snapshot.to_string()))
            })
        })?;
        Ok((
            slf.get_type().getattr("rebuild")?,
            (spec, copy, snapshot).into_pyobject(py)?,
        ))
    }

    /// Rebuilds a vector from the parts that `__reduce__` returned.
    #[staticmethod]
    fn rebuild(py: Python<'_>, spec: &str, copy: bool, snapshot: &str) -> PyResult<Self> {
        let damaged = |error: serde_json::Error| Error::Snapshot(error.to_string());
        let spec: VectorSpec = serde_json::from_str(spec).map_err(damaged).or_raise()?;
        let snapshot: Snapshot = serde_json::from_str(snapshot).map_err(damaged).or_raise()?;
        py.detach(|| {
            guard(|| {
                let mut envs = make(&spec)?;
                envs.as_dyn().restore(&snapshot).or_raise()?;
                Self::holding(envs, spec, copy)
            })
        })
    }

    /// Ends the threads of an async vector, which cannot be used afterwards. Closes the windows of
    /// other vectors, whose episodes continue.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let mut core = self.lock(py)?;
        let envs = &mut core.envs;
        let has_windows = self.spec.env.render_mode == Some(RenderMode::Human);
        py.detach(|| {
            guard(|| match envs {
                Envs::Async(envs) => {
                    envs.close();
                    Ok(())
                }
                Envs::Here(envs) if has_windows => envs
                    .call(|_, env: &mut BoxEnv| {
                        // a copy has no window
                        let copy = env.clone();
                        env.replace_with(copy);
                    })
                    .map(|_| ())
                    .or_raise(),
                Envs::Here(_) => Ok(()),
            })
        })
    }

    /// A description: kind, environment and number of environments.
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(self.lock(py)?.envs.as_dyn().describe())
    }
}

impl Vector {
    fn holding(mut envs: Envs, spec: VectorSpec, copy: bool) -> PyResult<Self> {
        let (action, actions) = (
            envs.as_dyn().single_action_space(),
            envs.as_dyn().action_space().or_raise()?,
        );
        let spares = (!copy).then(Default::default);
        let core = Mutex::new(Core {
            envs,
            columns: Columns::default(),
            spares,
        });
        Ok(Self {
            core: ManuallyDrop::new(core),
            numbers: Numbers::of(&spec.env.id, &spec.env.kwargs),
            spec,
            action,
            actions,
            info_keys: OnceLock::new(),
            origin: Origin::here(),
        })
    }
}

fn make(spec: &VectorSpec) -> PyResult<Envs> {
    match spec.vectorization_mode {
        VectorKind::Async => spec
            .make_async()
            .or_raise()
            .map(|vector| Envs::Async(Box::new(vector))),
        _ => spec.make().or_raise().map(Envs::Here),
    }
}
