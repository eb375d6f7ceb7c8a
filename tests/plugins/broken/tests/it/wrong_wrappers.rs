//! Wrong wrappers around a sound environment are seen, and the sound wrapper is not.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use broken_envs as _;
use gym_core::canvas::{Canvas, Transform};
use gym_core::{
    BoxEnv, Env, EnvSpec, Error, Generator, Outcome, Reset, Result, Snapshot, Value, Wrapper, make,
};
use gym_render as _;

/// The fault of a [`Counts`].
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// Passes a seed on only in the first reset.
    Seed,
    /// Does not store its count.
    Snapshot,
    /// Continues its count after a reset.
    Reset,
    /// Shares its count with its clones.
    Clone,
    /// Doubles the observations, but does not change the observation space.
    Space,
    /// Adds the old content of the buffer.
    Buffer,
    /// Counts refused actions.
    Refusal,
    /// Does not lend the generator.
    Generator,
    /// Leaves a transform on the canvas.
    Draw,
    /// Has an entry of info only in every second step.
    Info,
    /// Allocates in each step.
    Allocation,
    /// Ends the first step of each episode.
    Truncation,
    /// Doubles the observations, and says that its environment's spec is its own.
    Spec,
}

/// Counts steps, and pays a little for each step.
#[derive(Debug)]
struct Counts {
    inner: BoxEnv,
    fault: Fault,
    count: Arc<AtomicU32>,
    has_begun: bool,
}

impl Counts {
    fn new(env: BoxEnv, fault: Fault) -> Self {
        let count = Arc::default();
        Self {
            inner: env,
            fault,
            count,
            has_begun: false,
        }
    }

    fn count(&self) -> u32 {
        self.count.load(Ordering::Relaxed)
    }
}

impl Clone for Counts {
    fn clone(&self) -> Self {
        let count = match self.fault {
            Fault::Clone => Arc::clone(&self.count),
            _ => Arc::new(self.count().into()),
        };
        Self {
            inner: self.inner.clone(),
            count,
            ..*self
        }
    }
}

impl Wrapper for Counts {
    type Observation = Value;
    type Action = Value;

    gym_core::inner!(BoxEnv);

    fn on_reset(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let drops = self.fault == Fault::Seed && self.has_begun;
        let reset = Reset {
            seed: reset.seed.clone().filter(|_| !drops),
            ..reset.clone()
        };
        self.inner.reset_into(&reset, observation)?;
        if self.fault != Fault::Reset {
            self.count.store(0, Ordering::Relaxed);
        }
        self.has_begun = true;
        Ok(())
    }

    fn on_step(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        let first = |observation: &Value| -> Option<f32> {
            let x = observation.as_array()?.as_slice::<f32>()?.first().copied();
            x.filter(|x| x.is_finite())
        };
        let old = first(observation);
        if self.fault == Fault::Refusal {
            self.count.fetch_add(1, Ordering::Relaxed);
        }
        let mut outcome = self.inner.step_into(action, observation)?;
        if self.fault != Fault::Refusal {
            self.count.fetch_add(1, Ordering::Relaxed);
        }
        if let Value::Array(array) = observation
            && let Some([x, _]) = array.as_mut_slice::<f32>()
        {
            match self.fault {
                Fault::Space | Fault::Spec => *x *= 2.0,
                Fault::Buffer => *x = (*x + 0.01 * old.unwrap_or(0.0)).clamp(-1.0, 1.0),
                _ => {}
            }
        }
        if self.fault == Fault::Allocation {
            drop(std::hint::black_box(vec![0_u8; 8]));
        }
        outcome.truncated |= self.fault == Fault::Truncation && self.count() == 1;
        outcome.reward += 0.01 * f64::from(self.count());
        Ok(outcome)
    }

    fn on_info(&self, visit: &mut dyn FnMut(&str, Value)) {
        self.inner.info(visit);
        if self.fault != Fault::Info || self.count().is_multiple_of(2) {
            visit("count", Value::Int(self.count().into()));
        }
    }

    fn on_draw(&self, canvas: &mut dyn Canvas) {
        self.inner.draw(canvas);
        if self.fault == Fault::Draw {
            canvas.push(Transform::IDENTITY);
        }
    }

    fn on_generator(&mut self) -> Option<&mut Generator> {
        match self.fault {
            Fault::Generator => None,
            _ => self.inner.generator(),
        }
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        let count = match self.fault {
            Fault::Snapshot => 0,
            _ => self.count(),
        };
        Snapshot::of(&(self.inner.snapshot()?, count, self.has_begun))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, count, has_begun) = snapshot.get::<(Snapshot, u32, bool)>()?;
        if count > 1_000_000 {
            return Err(Error::Snapshot("no episode is so long".into()));
        }
        self.inner.restore(&env)?;
        self.count.store(count, Ordering::Relaxed);
        self.has_begun = has_begun;
        Ok(())
    }

    fn on_close(&mut self) {
        self.inner.close();
    }

    fn on_spec(&self) -> Option<EnvSpec> {
        self.inner.spec().filter(|_| self.fault == Fault::Spec)
    }
}

#[test]
fn wrong_wrappers_are_seen() {
    let faults = [
        (Fault::None, None),
        (Fault::Seed, Some("reset-forgets")),
        (Fault::Snapshot, Some("snapshot-continues")),
        (Fault::Reset, Some("reset-forgets")),
        (Fault::Clone, Some("clone-apart")),
        (Fault::Space, Some("observation-in-space")),
        (Fault::Buffer, Some("observation-whole")),
        (Fault::Refusal, Some("refusal-changes-nothing")),
        (Fault::Generator, Some("generator-lent")),
        (Fault::Draw, Some("drawing-sound")),
        (Fault::Info, Some("info-constant")),
        (Fault::Allocation, Some("no-allocation")),
        (Fault::Truncation, Some("time-limit")),
        (Fault::Spec, Some("observation-in-space")),
    ];
    // in threads, because the check of the clock waits for a second
    std::thread::scope(|scope| {
        for (fault, check) in faults {
            scope.spawn(move || {
                let findings = gym_conform::check(|| {
                    let env = make("broken/none-v0")?;
                    Ok(BoxEnv::new(Counts::new(env, fault)))
                });
                let found: Vec<_> = findings.iter().map(|finding| finding.check).collect();
                assert_eq!(found, Vec::from_iter(check), "{fault:?}: {findings:#?}");
            });
        }
    });
}
