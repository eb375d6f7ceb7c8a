//! Vectors with a fault each, around a sync vector: a registration names them as its native vector.

use gym_core::vector::{Autoreset, Columns, Progress, Seeds, VectorKind, VectorReset, VectorSpec};
use gym_core::{Error, Registration, Result, Snapshot, Value, VectorEnv, VectorWrapper};

use crate::twisted::Twisted;

/// The fault of a vector.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// The final observations are the first observations of the next episodes.
    Final,
    /// A mask is ignored.
    Mask,
    /// The step that begins an episode has the reward of a step.
    Reward,
    /// The time limit is one step too long.
    Limit,
    /// All sub-environments have the same seed.
    Seeds,
    /// A restored vector has the observations of the reset, and starts from there.
    Snapshot,
    /// Options do not reach the sub-environments.
    Options,
    /// The infos of each sub-environment are the infos of the next sub-environment.
    Infos,
    /// Arguments of single sub-environments do not reach them.
    Each,
    /// `close` has no effect.
    Close,
    /// Every sub-environment after the eighth steps twice.
    Remainder,
    /// With autoreset disabled, a step after an end resets all sub-environments.
    BeyondTheEnd,
    /// A step with an action that is refused resets the first sub-environment.
    Refusal,
    /// Masks, seeds and actions of another number are accepted.
    OtherMask,
    OtherSeeds,
    OtherActions,
    /// `restore` accepts anything.
    AnySnapshot,
    /// After `close` an episode can begin.
    Reopens,
    /// A reset that is refused resets the first sub-environment.
    RefusedReset,
    /// A restored vector has no infos before its next call.
    InfosRestored,
    /// An action outside of the space of the second sub-environment counts as 0.
    OneRefusal,
    /// A step before the first reset begins an episode.
    Unreset,
    /// A step without actions takes the first action everywhere.
    NoActions,
    /// A vector refuses its own snapshot.
    OwnSnapshot,
    /// A reset of some sub-environments is refused.
    Masked,
    /// One column says otherwise of the last sub-environment: its own kind of column each.
    Observations,
    Terminated,
    Truncated,
    HasFinal,
    Progress,
}

const FAULTS: [Fault; 31] = [
    Fault::None,
    Fault::Final,
    Fault::Mask,
    Fault::Reward,
    Fault::Limit,
    Fault::Seeds,
    Fault::Snapshot,
    Fault::Options,
    Fault::Infos,
    Fault::Each,
    Fault::Close,
    Fault::Remainder,
    Fault::BeyondTheEnd,
    Fault::Refusal,
    Fault::OtherMask,
    Fault::OtherSeeds,
    Fault::OtherActions,
    Fault::AnySnapshot,
    Fault::Reopens,
    Fault::RefusedReset,
    Fault::InfosRestored,
    Fault::OneRefusal,
    Fault::Unreset,
    Fault::NoActions,
    Fault::OwnSnapshot,
    Fault::Masked,
    Fault::Observations,
    Fault::Terminated,
    Fault::Truncated,
    Fault::HasFinal,
    Fault::Progress,
];

struct Vector {
    envs: Box<dyn VectorEnv>,
    fault: Fault,
    /// Whether an episode has begun, and whether one has ended in the last step.
    is_begun: bool,
    has_ended: bool,
    is_closed: bool,
    is_restored: bool,
}

/// Makes a sync vector with the fault `F`.
fn vector<const F: usize>(spec: &VectorSpec) -> Result<Box<dyn VectorEnv>> {
    let fault = FAULTS[F];
    let mut sync = spec.clone();
    sync.vectorization_mode = VectorKind::Sync;
    if fault == Fault::Limit {
        sync.env.max_episode_steps = spec.env.max_episode_steps.map(|limit| limit + 1);
    }
    if fault == Fault::Each {
        sync.each.clear();
    }
    Ok(Box::new(Vector {
        envs: sync.make()?,
        fault,
        is_begun: false,
        has_ended: false,
        is_closed: false,
        is_restored: false,
    }))
}

/// Changes the last entry of a column.
fn spoil(fault: Fault, columns: &mut Columns) {
    let flip = |column: &mut Vec<bool>| {
        if let Some(last) = column.last_mut() {
            *last ^= true;
        }
    };
    match fault {
        Fault::Observations => {
            let numbers: Vec<f32> = match &columns.observations {
                Value::Array(array) => array.iter_f64().map(|x| x as f32).collect(),
                _ => return,
            };
            let n = columns.rewards.len();
            let rows = numbers
                .chunks((numbers.len() / n.max(1)).max(1))
                .map(<[f32]>::to_vec);
            let mut rows: Vec<Vec<f32>> = rows.collect();
            if let Some(x) = rows.last_mut().and_then(|row| row.last_mut()) {
                *x = x.next_up();
            }
            let shape = [n, rows.first().map_or(0, Vec::len)];
            let data = gym_core::Data::F32(rows.concat());
            if let Ok(array) = gym_core::Array::new(shape, data) {
                columns.observations = Value::Array(array);
            }
        }
        Fault::Terminated => flip(&mut columns.terminated),
        Fault::Truncated => flip(&mut columns.truncated),
        Fault::HasFinal => flip(&mut columns.has_final),
        Fault::Progress => {
            if let Some(last) = columns.progress.last_mut() {
                *last = match *last {
                    Progress::Started => Progress::Stepped,
                    _ => Progress::Started,
                };
            }
        }
        _ => {}
    }
}

impl VectorWrapper for Vector {
    fn inner(&self) -> &dyn VectorEnv {
        &*self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut *self.envs
    }

    fn on_reset(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        let mut reset = reset.clone();
        let n = self.envs.num_envs();
        if self.fault == Fault::Masked && reset.mask.as_ref().is_some_and(|mask| mask.len() == n) {
            return Err(Error::custom("all or none"));
        }
        match self.fault {
            Fault::Mask => reset.mask = None,
            Fault::Options => reset.options.clear(),
            Fault::OtherMask => {
                let mask = reset.mask.take();
                reset.mask = mask.filter(|mask| mask.len() == self.envs.num_envs());
            }
            Fault::OtherSeeds => {
                if let Seeds::Each(seeds) = &mut reset.seeds {
                    seeds.truncate(self.envs.num_envs());
                }
            }
            Fault::Seeds => {
                let first = reset.of(0).and_then(|reset| reset.seed);
                if let Some(seed) = first {
                    let n = self.envs.num_envs();
                    let options = reset.options.clone();
                    reset = VectorReset::seeds(vec![seed; n]);
                    reset.options = options;
                }
            }
            _ => {}
        }
        self.is_restored = false;
        let done = self.envs.reset_into(&reset, columns);
        if done.is_err() && self.fault == Fault::RefusedReset && self.is_begun {
            let mask: Vec<_> = (0..self.envs.num_envs()).map(|i| i == 0).collect();
            let _ = self
                .envs
                .reset_into(&VectorReset::default().mask(mask), &mut Columns::default());
        }
        (self.is_begun, self.has_ended) = (true, false);
        done
    }

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        if self.is_closed {
            return Err(Error::Closed("step"));
        }
        self.is_restored = false;
        if self.fault == Fault::Unreset && !self.is_begun {
            self.envs.reset_into(&1.into(), columns)?;
            self.is_begun = true;
        }
        let actions = &match actions {
            Value::Null if self.fault == Fault::NoActions => {
                Value::from(vec![0_i64; self.envs.num_envs()])
            }
            Value::Array(array) if self.fault == Fault::OneRefusal => {
                let mut numbers: Vec<i64> = array.iter_f64().map(|x| x as i64).collect();
                if let Some(second) = numbers.get_mut(1).filter(|x| !(0..2).contains(*x)) {
                    *second = 0;
                }
                Value::from(numbers)
            }
            _ => actions.clone(),
        };
        let first = match actions {
            Value::Array(array) if self.fault == Fault::OtherActions => {
                let n = self.envs.num_envs();
                let numbers: Vec<i64> = array.iter_f64().map(|x| x as i64).collect();
                (numbers.len() > n).then(|| Value::from(numbers[..n].to_vec()))
            }
            _ => None,
        };
        let actions = first.as_ref().unwrap_or(actions);
        let stepped = self.envs.step_into(actions, columns);
        if stepped.is_err() && self.is_begun && *actions != Value::Null {
            let all = VectorReset::default();
            if self.fault == Fault::BeyondTheEnd && self.has_ended {
                self.has_ended = false;
                return self.envs.reset_into(&all, columns);
            }
            if self.fault == Fault::Refusal && !self.has_ended {
                let mask: Vec<_> = (0..self.envs.num_envs()).map(|i| i == 0).collect();
                self.envs.reset_into(&all.mask(mask), columns)?;
            }
        }
        stepped?;
        let mut ended = columns.terminated.iter().zip(&columns.truncated);
        self.has_ended =
            ended.any(|(a, b)| *a || *b) && self.envs.autoreset() == Autoreset::Disabled;
        match self.fault {
            Fault::Final if self.envs.autoreset() == Autoreset::SameStep => {
                columns.final_observations = columns.observations.clone();
            }
            Fault::Reward => {
                for (reward, progress) in columns.rewards.iter_mut().zip(&columns.progress) {
                    if *progress == Progress::Started {
                        *reward = 1.0;
                    }
                }
            }
            Fault::Remainder => {
                if let Some(reward) = columns.rewards.get_mut(8) {
                    *reward *= 2.0;
                }
            }
            fault => spoil(fault, columns),
        }
        Ok(())
    }

    fn on_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        let next = (index + 1) % self.envs.num_envs();
        let index = if self.fault == Fault::Infos {
            next
        } else {
            index
        };
        if !(self.fault == Fault::InfosRestored && self.is_restored) {
            self.envs.info(index, visit);
        }
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        self.envs.snapshot()
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        if self.fault == Fault::OwnSnapshot {
            return Err(Error::Snapshot("it is of another vector".into()));
        }
        let restored = self.envs.restore(snapshot);
        if self.fault == Fault::AnySnapshot {
            return Ok(());
        }
        restored?;
        self.is_restored = true;
        if self.fault == Fault::Snapshot {
            self.envs.reset_into(&1.into(), &mut Columns::default())?;
        }
        Ok(())
    }

    fn on_close(&mut self) {
        match self.fault {
            Fault::Close => {}
            Fault::Reopens => self.is_closed = true,
            _ => self.envs.close(),
        }
    }
}

macro_rules! register {
    ($($name:literal = $fault:literal;)*) => {$(
        gym_core::register!(
            Registration::new::<Twisted<crate::faces::ClosesItsGenerator<false>>>(
                concat!("broken/", $name, "-v0")
            )
            .description("Walk from the middle to either end.")
            .reset_options(&[("start", "0.25")])
            .max_episode_steps(12)
            .vector_entry_point(vector::<$fault>)
        );
    )*};
}

register! {
    "none.vector" = 0;
    "vector-equal.final" = 1;
    "vector-equal.mask" = 2;
    "vector-equal.reward" = 3;
    "vector-equal.limit" = 4;
    "vector-equal.seeds" = 5;
    "vector-equal.snapshot" = 6;
    "vector-equal.options" = 7;
    "vector-equal.infos" = 8;
    "vector-equal.each" = 9;
    "vector-equal.close" = 10;
    "vector-equal.remainder" = 11;
    "vector-equal.beyond-the-end" = 12;
    "vector-equal.refusal" = 13;
    "vector-equal.other-mask" = 14;
    "vector-equal.other-seeds" = 15;
    "vector-equal.other-actions" = 16;
    "vector-equal.any-snapshot" = 17;
    "vector-equal.reopens" = 18;
    "vector-equal.refused-reset" = 19;
    "vector-equal.infos-restored" = 20;
    "vector-equal.one-refusal" = 21;
    "vector-equal.unreset" = 22;
    "vector-equal.no-actions" = 23;
    "vector-equal.own-snapshot" = 24;
    "vector-equal.masked" = 25;
    "vector-equal.observations" = 26;
    "vector-equal.terminated" = 27;
    "vector-equal.truncated" = 28;
    "vector-equal.has-final" = 29;
    "vector-equal.progress" = 30;
}
