//! The stored form of a native vector: columns of numbers instead of an object per environment.

use gym_core::rng::Stream;
use gym_core::vector::Autoreset;
use gym_core::vector::parts::{row, words};
use gym_core::{Error, Result, Snapshot};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::step::NO_LIMIT;
use crate::varied::Varied;
use crate::{LANES, Native, NativeVectorEnv, Packed};

/// The arguments of the vector, which `restore` compares, and its state.
#[derive(Serialize, Deserialize)]
#[serde(bound = "")]
struct Stored<S: Stream> {
    name: String,
    config: Json,
    num_envs: usize,
    autoreset: Autoreset,
    limit: u16,
    /// The state of the vector; `None` before the first reset.
    numbers: Option<Numbers<S>>,
}

/// The state of the vector.
#[derive(Serialize, Deserialize)]
#[serde(bound = "")]
struct Numbers<S: Stream> {
    /// The values of all environments, each as [`Packed::put`] writes it.
    #[serde(with = "row")]
    states: Vec<u8>,
    #[serde(with = "words")]
    streams: Vec<S>,
    #[serde(with = "row")]
    steps: Vec<u16>,
    #[serde(with = "row")]
    due: Vec<u32>,
    #[serde(with = "row")]
    unset: Vec<u32>,
    left_out: Vec<bool>,
    /// The drawn values of arguments that are ranges.
    #[serde(with = "row")]
    drawn: Vec<f64>,
}

impl<D: Native> NativeVectorEnv<D> {
    fn stored(&self, numbers: Option<Numbers<D::Stream>>) -> Result<Stored<D::Stream>> {
        let config = serde_json::to_value(self.dynamics.config());
        Ok(Stored {
            name: D::NAME.into(),
            config: config.map_err(|error| Error::Snapshot(error.to_string()))?,
            num_envs: self.num_envs,
            autoreset: self.autoreset,
            limit: self.limit,
            numbers,
        })
    }

    pub(crate) fn store(&self) -> Result<Snapshot> {
        if self.blocks.is_empty() {
            return Snapshot::of(&self.stored(None)?);
        }
        let (mut states, mut steps) = (Vec::new(), Vec::new());
        for i in 0..self.num_envs {
            let (block, lane) = (&self.blocks[i / LANES], i % LANES);
            D::Packed::get(&block.states, lane).put(&mut states)?;
            steps.push(block.steps[lane]);
        }
        let numbers = Numbers {
            states,
            streams: self.streams[..self.num_envs].to_vec(),
            steps,
            due: self.blocks.iter().map(|block| block.due).collect(),
            unset: self.blocks.iter().map(|block| block.unset).collect(),
            left_out: self.left_out.clone(),
            drawn: self
                .varied
                .as_ref()
                .map(|varied| varied.drawn().to_vec())
                .unwrap_or_default(),
        };
        Snapshot::of(&self.stored(Some(numbers))?)
    }

    pub(crate) fn read(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.check_open("restore")?;
        let Stored {
            name,
            config,
            num_envs,
            autoreset,
            limit,
            numbers,
        } = snapshot.get::<Stored<D::Stream>>()?;
        let own = self.stored(None)?;
        if (&name, &config) != (&own.name, &own.config) {
            let reason = format!(
                "it was taken from {name} with {config}, and this is {} with {}",
                own.name, own.config
            );
            return Err(Error::Snapshot(reason));
        }
        if (num_envs, autoreset, limit) != (own.num_envs, own.autoreset, own.limit) {
            return Err(Error::Snapshot(format!(
                "it has {num_envs} environments, autoreset {autoreset:?} and a limit of {limit} steps, \
                 and this vector has {}, {:?} and {}",
                own.num_envs, own.autoreset, own.limit
            )));
        }
        let Some(numbers) = numbers else {
            (self.blocks, self.streams, self.finals) = (Vec::new(), Vec::new(), Vec::new());
            self.left_out.clear();
            return Ok(());
        };
        let mut varied = self.varied.clone();
        match &mut varied {
            Some(varied) => varied.restore(&self.dynamics, &numbers.drawn, num_envs)?,
            None if numbers.drawn.is_empty() => {}
            None => {
                return Err(Error::Snapshot(
                    "its arguments were drawn from ranges, but this vector has none".into(),
                ));
            }
        }
        let states = self.check(&numbers, varied.as_ref())?;
        let (Some(state), Some(stream)) = (states.last(), numbers.streams.last()) else {
            return Ok(());
        };
        self.make_room(*state, stream)?;
        for (i, state) in states.into_iter().enumerate() {
            let (block, lane) = (&mut self.blocks[i / LANES], i % LANES);
            state.set(&mut block.states, lane);
            block.steps[lane] = numbers.steps[i];
        }
        for ((block, due), unset) in self.blocks.iter_mut().zip(numbers.due).zip(numbers.unset) {
            (block.due, block.unset) = (due, unset);
        }
        self.streams[..num_envs].clone_from_slice(&numbers.streams);
        self.left_out = numbers.left_out;
        self.varied = varied;
        Ok(())
    }

    /// The states, or an error if a number is invalid.
    fn check(
        &self,
        numbers: &Numbers<D::Stream>,
        varied: Option<&Varied<D>>,
    ) -> Result<Vec<D::Packed>> {
        let n = self.num_envs;
        let refuse = |what: &str| {
            Err(Error::Snapshot(format!(
                "its {what} do not fit {}",
                D::NAME
            )))
        };
        let Numbers {
            states,
            streams,
            steps,
            due,
            unset,
            left_out,
            drawn: _,
        } = numbers;
        let mut bytes = states.as_slice();
        if streams.len() != n || steps.len() != n || !(left_out.is_empty() || left_out.len() == n) {
            return refuse("columns");
        }
        if steps.contains(&NO_LIMIT) {
            return refuse("counts of steps");
        }
        let blocks = n.div_ceil(LANES);
        let beyond = |block: usize| {
            let len = LANES.min(n - block * LANES);
            if len == LANES { 0 } else { u32::MAX << len }
        };
        let fits = |flags: &[u32]| {
            flags.len() == blocks
                && flags
                    .iter()
                    .enumerate()
                    .all(|(i, flags)| flags & beyond(i) == 0)
        };
        let never_due = self.autoreset == Autoreset::SameStep;
        if !fits(due) || !fits(unset) || never_due && due.iter().any(|due| *due != 0) {
            return refuse("flags");
        }
        let mut states = Vec::with_capacity(n);
        for (i, steps) in steps.iter().enumerate() {
            let Some(state) = D::Packed::take(&mut bytes) else {
                return refuse("states");
            };
            let dynamics = match varied {
                Some(varied) => &varied.dynamics(i, &self.dynamics)?,
                None => &self.dynamics,
            };
            let state = dynamics.unpack(state, *steps == 0);
            if !dynamics.is_valid(&state) {
                return refuse("states");
            }
            // packs the state again, to recompute numbers that depend on others
            states.push(self.dynamics.pack(&state));
        }
        if bytes.is_empty() {
            Ok(states)
        } else {
            refuse("states")
        }
    }
}
