//! A walk along a line, which can have many faults.

use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, ThreadId};

use gym_core::canvas::{Canvas, Color, Transform};
use gym_core::render::{Metadata, RenderMode};
use gym_core::spaces::{MultiDiscrete, TupleSpace};
use gym_core::{
    Element, Env, Error, Generator, Outcome, Reset, Result, Seed, Snapshot, Space, Value,
};
use serde::{Deserialize, Serialize};

use crate::{Config, Fault};

/// Walk from the middle to either end of a line, in the wind.
///
/// The observation is position and wind, both from -1 to 1; the actions are left and right. `C` is
/// the type of the arguments.
#[derive(Debug)]
pub struct Walk<C = Config> {
    fault: Fault,
    observation_space: Space,
    action_space: Space,
    state: Option<State>,
    /// The steps of the episode; with some faults, the steps of its clones are counted too.
    shared: Arc<AtomicU64>,
    /// The steps since the last seed.
    age: u32,
    /// The number of drawings.
    drawn: Cell<u32>,
    /// The thread on which the episode began.
    home: Option<ThreadId>,
    /// A generator of another environment.
    other: Generator,
    /// The number of this environment among all walks.
    number: u64,
    arguments: PhantomData<fn() -> C>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct State {
    rng: Generator,
    seed: String,
    position: f64,
    wind: f64,
    steps: u32,
    /// The direction of the last step, and the number of consecutive steps in it.
    held: (f64, u32),
    number: u64,
}

/// The length of a step, and the strength of the wind.
const STEP: f64 = 0.2;
const WIND: f64 = 0.1;
/// The time limit.
const LIMIT: u32 = 12;
/// A number of consecutive steps in one direction that a random walk does not reach.
const LONG: u32 = 30;
/// More steps than any short comparison makes.
const LATE: u32 = 300;

impl State {
    fn is_at_end(&self) -> bool {
        self.position.abs() == 1.0
    }
}

impl<C> Walk<C> {
    /// Makes a walk with this fault.
    ///
    /// # Errors
    /// [`Error::Custom`] for [`Fault::Constructs`].
    pub fn new(fault: Fault) -> Result<Self> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        if fault == Fault::Constructs {
            return Err(Error::custom("no ground to stand on"));
        }
        let line = || Space::boxed([-1.0; 2], [1.0; 2]);
        let observation_space = match fault {
            Fault::SpaceBounded => Space::boxed([-1.0; 2], [1.0, f32::INFINITY]),
            Fault::ObservationFinite => {
                Space::boxed([-1.0, f32::NEG_INFINITY], [1.0, f32::INFINITY])
            }
            Fault::SpaceWidth => Space::boxed([-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]),
            Fault::SpaceNotEmpty => TupleSpace::new([line(), TupleSpace::new([]).into()]).into(),
            _ => line(),
        };
        let action_space = match fault {
            Fault::ActionNormalised => Space::boxed([-2.0], [2.0]),
            Fault::ActionValidatedOneElement => Space::boxed([-1.0; 2], [1.0; 2]),
            Fault::ActionValidatedOneNumber => MultiDiscrete::new([2i64, 2])?.into(),
            Fault::ObservationInSpaceHugeAction => Space::boxed([-1.0], [1.0]),
            _ => Space::discrete(2),
        };
        Ok(Self {
            fault,
            observation_space,
            action_space,
            state: None,
            shared: Arc::default(),
            age: 0,
            drawn: Cell::new(0),
            home: None,
            other: Generator::from(0),
            number: COUNT.fetch_add(1, Ordering::Relaxed),
            arguments: PhantomData,
        })
    }

    /// Returns the steps of the episode, 0 before the first.
    pub(crate) fn steps(&self) -> u32 {
        self.state.as_ref().map_or(0, |state| state.steps)
    }

    /// Returns the position, from -1 to 1.
    pub(crate) fn position(&self) -> f64 {
        self.state.as_ref().map_or(0.0, |state| state.position)
    }

    /// Returns the number of this environment among all walks.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    fn observe(&self, observation: &mut Value) {
        let Some(State {
            position,
            wind,
            steps,
            held,
            ..
        }) = &self.state
        else {
            return;
        };
        let [mut x, mut wind] = [*position as f32, *wind as f32];
        match self.fault {
            Fault::ObservationInSpace if *steps > 3 => x = 1.5,
            Fault::ObservationInSpaceHeld if held.1 > LONG => x = 1.5,
            Fault::ObservationFinite if *steps > 3 => wind = f32::INFINITY,
            Fault::SpaceBounded => wind = wind.abs(),
            _ => (),
        }
        match self.fault {
            Fault::ObservationDtype => [0i8, steps.is_multiple_of(2).into()].write(observation),
            Fault::SpaceWidth => [x, wind, 0.0].write(observation),
            Fault::SpaceNotEmpty => match observation {
                Value::Tuple(items) if items.len() == 2 => [x, wind].write(&mut items[0]),
                _ => *observation = Value::Tuple(vec![[x, wind].to_value(), Value::Tuple(vec![])]),
            },
            // does not write the second element
            Fault::ObservationWhole => match observation {
                Value::Array(array) if array.shape() == [2] => {
                    if let Some([first, _]) = array.as_mut_slice::<f32>() {
                        *first = x;
                    }
                }
                _ => [x, wind].write(observation),
            },
            _ => [x, wind].write(observation),
        }
    }

    /// Returns the direction of an action, if the action is valid.
    fn direction(&self, action: &Value) -> Option<f64> {
        match (self.fault, action) {
            (Fault::ActionValidated, _) => Some(1.0),
            (Fault::ActionAccepted, Value::Int(1)) => None,
            (Fault::ActionNormalised, Value::Array(array)) => match array.as_slice::<f32>()? {
                [x] if x.is_finite() => Some(f64::from(*x).clamp(-1.0, 1.0)),
                _ => None,
            },
            (Fault::ObservationInSpaceHugeAction, Value::Array(array)) => {
                match array.as_slice::<f32>()? {
                    [x] if x.is_finite() => Some(f64::from(*x).clamp(-4.0, 4.0)),
                    _ => None,
                }
            }
            // accepts any second element
            (Fault::ActionValidatedOneElement, Value::Array(array)) => {
                match array.as_slice::<f32>()? {
                    [x, _] if array.shape() == [2] && x.is_finite() => {
                        Some(f64::from(*x).clamp(-1.0, 1.0))
                    }
                    _ => None,
                }
            }
            (Fault::ActionValidatedOneNumber, Value::Array(array)) => {
                match array.as_slice::<i64>()? {
                    [x @ 0..2, _] if array.shape() == [2] => Some(*x as f64 * 2.0 - 1.0),
                    _ => None,
                }
            }
            (
                Fault::ActionNormalised
                | Fault::ObservationInSpaceHugeAction
                | Fault::ActionValidatedOneElement
                | Fault::ActionValidatedOneNumber,
                _,
            ) => None,
            (Fault::ActionAcceptedHeld, _)
                if self.state.as_ref().is_some_and(|state| state.held.1 > LONG) =>
            {
                None
            }
            (_, Value::Int(0)) => Some(-1.0),
            (_, Value::Int(1)) => Some(1.0),
            _ => None,
        }
    }

    /// Returns a number that depends on more than the state.
    fn disturbance(&self) -> f64 {
        /// The first thread that walks.
        static FIRST: OnceLock<ThreadId> = OnceLock::new();
        /// The steps of all environments.
        static STEPS: AtomicU64 = AtomicU64::new(0);
        let unit = |n: u64| (n % 7) as f64 / 100.0;
        let late = |n: u64| if n > LATE.into() { 0.01 } else { 0.0 };
        match self.fault {
            Fault::SameSeedSameEpisode => unit(self.number),
            Fault::CloneApart => unit(self.shared.fetch_add(1, Ordering::Relaxed)),
            // the steps of this walk and of a short comparison are fewer
            Fault::CloneApartLate => late(self.shared.fetch_add(1, Ordering::Relaxed) / 2),
            Fault::SameSeedSameEpisodeLate => late(STEPS.fetch_add(1, Ordering::Relaxed)),
            Fault::SnapshotContinuesLate => late(self.age.into()),
            Fault::DrawingPure => unit(self.drawn.get().into()),
            Fault::AnyThreadMoved => unit(u64::from(
                self.home.is_some_and(|home| home != thread::current().id()),
            )),
            Fault::CloneApartClosed => unit(self.shared.load(Ordering::Relaxed)),
            Fault::AnyThread => {
                let here = thread::current().id();
                unit(u64::from(*FIRST.get_or_init(|| here) != here))
            }
            _ => 0.0,
        }
    }
}

impl<C> Clone for Walk<C> {
    fn clone(&self) -> Self {
        let mut state = self.state.clone();
        if let (Fault::CloneContinues, Some(state)) = (self.fault, &mut state) {
            state.position = 0.0;
        }
        let shared = match self.fault {
            Fault::CloneApart | Fault::CloneApartLate | Fault::CloneApartClosed => {
                Arc::clone(&self.shared)
            }
            _ => Arc::new(self.shared.load(Ordering::Relaxed).into()),
        };
        Self {
            fault: self.fault,
            observation_space: self.observation_space.clone(),
            action_space: self.action_space.clone(),
            state,
            shared,
            age: self.age,
            drawn: self.drawn.clone(),
            home: self.home,
            other: self.other.clone(),
            number: self.number,
            arguments: PhantomData,
        }
    }
}

impl<C: 'static> Env for Walk<C> {
    type Observation = Value;
    type Action = Value;

    fn observation_space(&self) -> Space {
        match (self.fault, &self.state) {
            (Fault::SpaceConstant, Some(_)) => Space::boxed([-2.0; 2], [2.0; 2]),
            _ => self.observation_space.clone(),
        }
    }

    fn action_space(&self) -> Space {
        self.action_space.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        if self.fault == Fault::Resets
            && reset
                .seed
                .as_ref()
                .is_some_and(|seed| seed.to_string().len() > 20)
        {
            return Err(Error::custom("the seed is too large"));
        }
        if self.fault == Fault::OptionsIgnored && reset.options.contains_key("no_such_option") {
            return Err(Error::argument("reset", "there are no options"));
        }
        let start = match (self.fault, reset.options.get("start")) {
            (Fault::OptionsAccepted, Some(_)) => {
                return Err(Error::argument("reset", "there are no options"));
            }
            (_, None) => None,
            (Fault::OptionsMatter, Some(start)) if start.is_number() => None,
            (_, Some(start)) => match start.as_f64() {
                Some(start) if (-1.0..=1.0).contains(&start) => Some(start),
                _ => {
                    return Err(Error::argument(
                        "reset",
                        "`start` must be a number from -1 to 1",
                    ));
                }
            },
        };
        let last = self.state.take();
        if reset.seed.is_some() {
            self.age = 0;
        }
        self.home = Some(thread::current().id());
        if reset.seed.is_some() || self.fault != Fault::CloneApartLate {
            self.shared.store(0, Ordering::Relaxed);
        }
        let seed = match (&reset.seed, &last) {
            (_, _) if self.fault == Fault::OtherSeedOtherEpisode && reset.seed.is_some() => {
                Some(Seed::from(0))
            }
            (Some(seed), _) if self.fault == Fault::OtherSeedOtherEpisodeCut => Some(Seed::from(
                seed.to_string()
                    .parse()
                    .map_or(0, |seed: u64| seed % (1 << 32)),
            )),
            (Some(seed), _) => Some(seed.clone()),
            (None, Some(last)) if self.fault == Fault::ResetCarriesOnToTheNextSeed => last
                .seed
                .parse()
                .ok()
                .map(|seed: u64| Seed::from(seed.wrapping_add(1))),
            (None, Some(last))
                if self.fault == Fault::SameSeedSameEpisodeInterrupted
                    && last.steps < LIMIT
                    && !last.is_at_end() =>
            {
                Some(Seed::from(self.number))
            }
            (None, Some(last)) if self.fault == Fault::ResetCarriesOn => last.seed.parse().ok(),
            (None, _) => None,
        };
        let mut rng = match (&seed, &last) {
            (Some(seed), _) => Generator::new(seed),
            (None, Some(last)) => last.rng.clone(),
            (None, None) => Generator::from_os()?,
        };
        let seed = seed
            .map(|seed| seed.to_string())
            .or(last.as_ref().map(|last| last.seed.clone()));
        let mut position = rng.uniform(-0.3, 0.3) + self.disturbance();
        position = start.unwrap_or(position);
        if self.fault == Fault::ResetForgets {
            position += last.map_or(0.0, |last| f64::from(last.steps.min(20)) / 100.0);
        }
        let (seed, number) = (seed.unwrap_or_default(), self.number);
        self.state = Some(State {
            rng,
            seed,
            position,
            wind: 0.0,
            steps: 0,
            held: (0.0, 0),
            number,
        });
        self.observe(observation);
        Ok(())
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        let direction = self.direction(action);
        let disturbance = self.disturbance();
        if self.state.is_none() && self.fault == Fault::ResetNeeded {
            self.reset_into(&0.into(), observation)?;
        }
        let Some(state) = &mut self.state else {
            return Err(Error::ResetNeeded("step"));
        };
        if direction.is_none() && self.fault == Fault::RefusalChangesNothing {
            state.rng.random();
        }
        let Some(direction) = direction else {
            return Err(Error::InvalidAction {
                action: action.to_string(),
                space: self.action_space.to_string(),
                hint: String::new(),
            });
        };
        if self.fault == Fault::NoAllocation {
            drop(std::hint::black_box(vec![0u8; 8]));
        }
        self.age = self.age.saturating_add(1);
        state.wind = state.rng.uniform(-1.0, 1.0);
        let moved = state.position + direction * STEP + state.wind * WIND + disturbance;
        // without a check of the action, the walk may leave the line
        let reach = match self.fault {
            Fault::SnapshotLegal => state.position.abs().max(1.0),
            _ => direction.abs().max(1.0),
        };
        state.position = moved.clamp(-reach, reach);
        state.held = if state.held.0 == direction {
            (direction, state.held.1 + 1)
        } else {
            (direction, 1)
        };
        state.steps = state.steps.saturating_add(1);
        let is_endless = matches!(
            self.fault,
            Fault::ActionAcceptedHeld | Fault::ObservationInSpaceHeld
        );
        let (steps, terminated) = (state.steps, state.is_at_end() && !is_endless);
        self.observe(observation);
        let reward = match self.fault {
            Fault::RewardFinite if steps == 3 => f64::NAN,
            // beyond the time limit
            Fault::RewardFiniteLate if steps == 15 => f64::NAN,
            _ => f64::from(terminated),
        };
        Ok(Outcome {
            reward,
            terminated,
            truncated: self.fault == Fault::TimeLimit && steps == 1,
        })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        let mut state = self.state.clone();
        if let (Fault::SnapshotContinues, Some(state)) = (self.fault, &mut state) {
            state.rng = Generator::from(0);
        }
        Snapshot::of(&state)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let state = snapshot.get::<Option<State>>();
        if state.is_err() && self.fault == Fault::SnapshotRefused {
            return Ok(());
        }
        if let (Err(_), Fault::SnapshotRefusedChanges, Some(old)) =
            (&state, self.fault, &mut self.state)
        {
            old.wind = 0.0;
        }
        let state = state?;
        let on_the_line = |x: f64| (-1.0..=1.0).contains(&x);
        let is_off = |state: &State| !(on_the_line(state.position) && on_the_line(state.wind));
        if self.fault != Fault::SnapshotLegal && state.as_ref().is_some_and(is_off) {
            return Err(Error::Snapshot("it is off the line".into()));
        }
        let state = match (self.fault, &self.state, state) {
            (Fault::SnapshotContinuesUnused, Some(_), None) => return Ok(()),
            (Fault::SnapshotContinuesUsed, Some(old), Some(new)) => Some(State {
                rng: old.rng.clone(),
                ..new
            }),
            (_, _, state) => state,
        };
        // the number is part of the state: a restored environment has the number of the stored
        // environment
        self.number = state.as_ref().map_or(self.number, |state| state.number);
        self.state = state;
        Ok(())
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        assert!(
            self.state.is_some() || self.fault != Fault::NoPanic,
            "info before reset"
        );
        if let Some(state) = &self.state {
            match self.fault {
                Fault::InfoConstantType if state.steps > 3 => {
                    visit("steps", Value::Float(state.steps.into()));
                }
                _ => visit("steps", Value::Int(state.steps.into())),
            }
            if self.fault == Fault::InfoConstant && state.steps > 3 {
                visit("late", Value::Bool(true));
            }
            if self.fault == Fault::InfoConsistent
                || self.fault == Fault::InfoConsistentAtTheEnd && state.is_at_end()
            {
                visit("steps", Value::Int(0));
            }
        }
    }

    fn metadata(&self) -> Metadata {
        match self.fault {
            Fault::FrameRate => Metadata::drawn(1000, (200, 40)),
            Fault::MetadataComplete => Metadata::drawn(0, (200, 40)),
            Fault::DrawingPureText => Metadata {
                render_modes: &[RenderMode::RgbArray, RenderMode::Ansi],
                ..Metadata::drawn(10, (200, 40))
            },
            Fault::RenderModes => Metadata {
                render_modes: &[RenderMode::RgbArray, RenderMode::Ansi],
                ..Metadata::drawn(10, (200, 40))
            },
            _ => Metadata::drawn(10, (200, 40)),
        }
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        let Some(state) = &self.state else { return };
        self.drawn.set(self.drawn.get() + 1);
        canvas.clear(Color::WHITE);
        let (y, color) = match self.fault {
            Fault::DrawingVisibleOffTheCanvas => (2000.0, Color::BLACK),
            Fault::DrawingVisible => (20.0, Color::WHITE),
            _ => (20.0, Color::BLACK),
        };
        canvas.push(Transform::translate(100.0, y));
        canvas.line([-100.0, 0.0], [100.0, 0.0], 2.0, color);
        let shown = if self.fault == Fault::DrawingFollows {
            0.0
        } else {
            state.position
        };
        canvas.circle([shown * 100.0, 0.0], 8.0, color);
        match self.fault {
            Fault::DrawingSound => (),
            Fault::DrawingSoundAtTheEnd if state.is_at_end() => (),
            Fault::NoPanicAtTheEnd if state.is_at_end() => panic!("nowhere to stand"),
            _ => canvas.pop(),
        }
    }

    fn ansi(&self) -> Option<String> {
        let is_written = self.state.is_some() && self.fault == Fault::DrawingPureText;
        is_written.then(|| {
            self.drawn.set(self.drawn.get() + 1);
            self.drawn.get().to_string()
        })
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        if self.fault == Fault::GeneratorLentFixed {
            return self.state.as_ref().map(|_| &mut self.other);
        }
        self.state
            .as_mut()
            .filter(|_| self.fault != Fault::GeneratorLent)
            .map(|state| &mut state.rng)
    }

    fn close(&mut self) {
        if self.fault == Fault::CloneApartClosed {
            self.shared.fetch_add(1, Ordering::Relaxed);
        }
        self.state = None;
    }
}
