//! A sound walk with one method that is not: faults in what is shown, remembered, copied and taken.
//!
//! Each [`Twist`] writes the method anew that it breaks, and leaves the others to the [`Walk`]. Those that are named after no check,
//! as `broken/none.held-drawing-v0`, are sound, and unusual.

use std::cell::Cell;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use gym_core::canvas::{Align, Canvas, Color, Segment, Shape, Transform};
use gym_core::render::{Metadata, RenderMode};
use gym_core::spaces::{DictSpace, TextSpace, TupleSpace};
use gym_core::{
    Array, Configure, DType, Element, Env, Error, Generator, Outcome, Registration, Reset, Result, Snapshot,
    Space, Value,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

use crate::{Config, Fault, Walk};

/// A walk with a twist.
pub(crate) struct Twisted<T: Twist> {
    walk: Walk,
    mind: Mind,
    arguments: T::Arguments,
    twist: PhantomData<fn() -> T>,
}

/// What a twist may remember. It is in no snapshot.
#[derive(Debug, Default)]
pub(crate) struct Mind {
    /// The steps since the last seed.
    age: u64,
    /// How often somebody looked since the last reset or step.
    looked: Cell<u64>,
    /// Whether something that must change nothing has happened.
    is_spoilt: Cell<bool>,
    /// Whether an episode was begun, and whether it is over.
    is_begun: bool,
    is_over: bool,
    /// What clones share, if they do.
    shared: Arc<AtomicU64>,
    own: u64,
    /// A generator that is not the walk's.
    other: Option<Generator>,
    /// What the walk showed, where the twist shows something else.
    seen: Value,
}

impl Clone for Mind {
    fn clone(&self) -> Self {
        let shared = Arc::new(self.shared.load(Ordering::Relaxed).into());
        let (looked, is_spoilt) = (self.looked.clone(), self.is_spoilt.clone());
        Self { looked, is_spoilt, shared, other: self.other.clone(), seen: self.seen.clone(), ..*self }
    }
}

/// What is told or done wrong: each method is the walk's, but for those that are written anew.
pub(crate) trait Twist: Sized + 'static {
    /// The constructor's arguments.
    type Arguments: Arguments;

    /// The memory of a clone.
    fn copied(env: &Twisted<Self>) -> Mind {
        env.mind.clone()
    }

    /// As [`Env::observation_space`].
    fn observation_space(env: &Twisted<Self>) -> Space {
        env.walk.observation_space()
    }

    /// As [`Env::action_space`].
    fn action_space(env: &Twisted<Self>) -> Space {
        env.walk.action_space()
    }

    /// As [`Env::reset_into`].
    fn reset(env: &mut Twisted<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
        env.walk.reset_into(reset, observation)
    }

    /// As [`Env::step_into`].
    fn step(env: &mut Twisted<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
        env.walk.step_into(action, observation)
    }

    /// As [`Env::snapshot`].
    fn snapshot(env: &Twisted<Self>) -> Result<Snapshot> {
        env.walk.snapshot()
    }

    /// As [`Env::restore`].
    fn restore(env: &mut Twisted<Self>, snapshot: &Snapshot) -> Result<()> {
        env.walk.restore(snapshot)
    }

    /// As [`Env::info`].
    fn info(env: &Twisted<Self>, visit: &mut dyn FnMut(&str, Value)) {
        env.walk.info(visit);
    }

    /// As [`Env::metadata`].
    fn metadata(env: &Twisted<Self>) -> Metadata {
        env.walk.metadata()
    }

    /// As [`Env::draw`].
    fn draw(env: &Twisted<Self>, canvas: &mut dyn Canvas) {
        env.walk.draw(canvas);
    }

    /// As [`Env::ansi`].
    fn ansi(_: &Twisted<Self>) -> Option<String> {
        None
    }

    /// As [`Env::generator`].
    fn generator(env: &mut Twisted<Self>) -> Option<&mut Generator> {
        env.walk.generator()
    }
}

/// Arguments of a [`Twisted`] walk.
pub(crate) trait Arguments:
    Clone + fmt::Debug + Default + Serialize + for<'de> Deserialize<'de> + Send + 'static
{
}

impl<T: Clone + fmt::Debug + Default + Serialize + for<'de> Deserialize<'de> + Send + 'static> Arguments
    for T
{
}

impl<T: Twist> Twisted<T> {
    /// A step of the walk, whose reward is another where something was spoilt.
    fn step_of_spoilt(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        let outcome = self.walk.step_into(action, observation)?;
        let spoilt = if self.mind.is_spoilt.get() { 0.5 } else { 0.0 };
        Ok(Outcome { reward: outcome.reward + spoilt, ..outcome })
    }

    /// The number of looks before this one since the last reset or step.
    fn look(&self) -> u64 {
        self.mind.looked.replace(self.mind.looked.get() + 1)
    }
}

impl<T: Twist> fmt::Debug for Twisted<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Twisted").field("walk", &self.walk).field("mind", &self.mind).finish_non_exhaustive()
    }
}

impl<T: Twist> Clone for Twisted<T> {
    fn clone(&self) -> Self {
        let (walk, arguments) = (self.walk.clone(), self.arguments.clone());
        Self { walk, mind: T::copied(self), arguments, twist: PhantomData }
    }
}

impl<T: Twist> Configure for Twisted<T> {
    type Config = T::Arguments;

    fn configure(arguments: T::Arguments) -> Result<Self> {
        let walk = Walk::<Config>::new(Fault::None)?;
        Ok(Self { walk, mind: Mind::default(), arguments, twist: PhantomData })
    }
}

impl<T: Twist> Env for Twisted<T> {
    type Observation = Value;
    type Action = Value;

    fn observation_space(&self) -> Space {
        T::observation_space(self)
    }

    fn action_space(&self) -> Space {
        T::action_space(self)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        if reset.seed.is_some() {
            self.mind.age = 0;
        }
        self.mind.looked.set(0);
        T::reset(self, reset, observation)?;
        (self.mind.is_begun, self.mind.is_over) = (true, false);
        Ok(())
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        self.mind.looked.set(0);
        let outcome = T::step(self, action, observation)?;
        self.mind.age = self.mind.age.saturating_add(1);
        self.mind.is_over = outcome.done();
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        T::snapshot(self)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        T::restore(self, snapshot)
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        T::info(self, visit);
    }

    fn metadata(&self) -> Metadata {
        T::metadata(self)
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        T::draw(self, canvas);
    }

    fn ansi(&self) -> Option<String> {
        T::ansi(self)
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        T::generator(self)
    }
}

/// No arguments.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Nothing {}

/// One number, which is 1 where it is not given.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Number {
    /// What a twist makes of it.
    pub(crate) number: f64,
}

impl Default for Number {
    fn default() -> Self {
        Self { number: 1.0 }
    }
}

/// A number that is 2 where it is not given, though the default is 1.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TwoDefaults {
    /// What a reward is multiplied by, less one.
    #[serde(default = "one")]
    pub(crate) number: u32,
}

fn one() -> u32 {
    1
}

/// A number of which anything is taken.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Anything {
    /// A number, or whatever comes.
    pub(crate) number: Json,
}

impl Default for Anything {
    fn default() -> Self {
        Self { number: 1.into() }
    }
}

/// A number, with a message that does not tell what arguments there are.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Map<String, Json>")]
pub(crate) struct Silent {
    /// What a reward is multiplied by.
    pub(crate) number: f64,
}

impl Default for Silent {
    fn default() -> Self {
        Self { number: 1.0 }
    }
}

impl TryFrom<Map<String, Json>> for Silent {
    type Error = &'static str;

    fn try_from(map: Map<String, Json>) -> std::result::Result<Self, &'static str> {
        match map.iter().next() {
            None => Ok(Self::default()),
            Some((name, value)) if name == "number" && map.len() == 1 => {
                Ok(Self { number: value.as_f64().ok_or("not so")? })
            }
            _ => Err("not so"),
        }
    }
}

/// Writes twists, and registers a walk with each under the name of the check that must find it.
macro_rules! twists {
    ($($name:literal $Twist:ident $(($Arguments:ident))? $(, $method:ident($argument:expr))* { $($item:item)* })*) => {$(
        #[doc = concat!("`", $name, "`")]
        #[derive(Debug)]
        pub(crate) struct $Twist;

        impl Twist for $Twist {
            type Arguments = twists!(@ $($Arguments)?);

            $($item)*
        }

        gym_core::register!(
            Registration::new::<Twisted<$Twist>>(concat!("broken/", $name, "-v0"))
                .description("Walk from the middle to either end.")
                .max_episode_steps(12)
                $(.$method($argument))*
        );
    )*};
    (@) => { Nothing };
    (@ $Arguments:ident) => { $Arguments };
}

type Of<T> = Twisted<T>;

/// Draws in white on the picture of the walk, after it.
fn drawn_too<T: Twist>(env: &Of<T>, canvas: &mut dyn Canvas, draw: impl FnOnce(&mut dyn Canvas)) {
    env.walk.draw(canvas);
    draw(canvas);
}

// copies
twists! {
    "clone-apart.reset" ResetOfClone {
        fn copied(env: &Of<Self>) -> Mind {
            Mind { shared: Arc::clone(&env.mind.shared), ..env.mind.clone() }
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if reset.seed.is_some() {
                env.mind.own = env.mind.shared.fetch_add(1, Ordering::Relaxed) + 1;
            }
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.mind.is_spoilt.set(env.mind.shared.load(Ordering::Relaxed) != env.mind.own);
            env.step_of_spoilt(action, observation)
        }
    }

    "clone-apart.spoilt" SpoiltByClone {
        fn copied(env: &Of<Self>) -> Mind {
            let copy = env.mind.clone();
            env.mind.is_spoilt.set(true);
            copy
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.step_of_spoilt(action, observation)
        }
    }

    "snapshot-continues.beside" SpoiltBySnapshot {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.mind.is_spoilt.set(env.mind.is_begun);
            env.walk.snapshot()
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.step_of_spoilt(action, observation)
        }
    }

    "snapshot-continues.midway" SpoiltMidway {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let is_episode = !snapshot.get::<Json>()?.is_null();
            env.mind.is_spoilt.set(is_episode && env.mind.is_begun && !env.mind.is_over);
            env.walk.restore(snapshot)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.step_of_spoilt(action, observation)
        }
    }

    "snapshot-continues.after-the-end" SpoiltAfterTheEnd {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.mind.is_spoilt.set(env.mind.is_over);
            env.walk.restore(snapshot)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.step_of_spoilt(action, observation)
        }
    }

    "snapshot-continues.as-new" SpoiltForever {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.walk.restore(snapshot)?;
            if snapshot.get::<Json>()?.is_null() {
                env.mind.is_spoilt.set(true);
            }
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.step_of_spoilt(action, observation)
        }
    }

    // stores how old it is, and not what happened at a certain age
    "snapshot-continues.event" ForgetsAnEvent {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            Snapshot::of(&(env.walk.snapshot()?.get::<Json>()?, env.mind.age))
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let (walk, age) = snapshot.get::<(Json, u64)>()?;
            env.walk.restore(&Snapshot::of(&walk)?)?;
            env.mind.age = age;
            Ok(())
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if reset.seed.is_some() {
                env.mind.is_spoilt.set(false);
            }
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            if env.mind.age == 160 {
                env.mind.is_spoilt.set(true);
            }
            env.step_of_spoilt(action, observation)
        }
    }

    "snapshot-legal.reward" PaysWithoutEnd {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let reward = if env.walk.steps() >= 1000 { f64::INFINITY } else { outcome.reward };
            Ok(Outcome { reward, ..outcome })
        }
    }

    "no-panic.restored" PanicsWhenRestored {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            assert!(env.walk.steps() != 1005, "too far");
            env.walk.info(visit);
        }
    }

    "no-panic.after-a-restored-step" PanicsAfterRestored {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            assert!(env.walk.steps() < 1006, "too far");
            env.walk.info(visit);
        }
    }
}

// how episodes begin, what they show and what they take
twists! {
    "resets.without-a-seed" NeedsASeed {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if reset.seed.is_none() && !env.mind.is_begun {
                return Err(Error::custom("the first reset needs a seed"));
            }
            env.walk.reset_into(reset, observation)
        }
    }

    "reset-needed.other-error" OtherError {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.walk.step_into(action, observation).map_err(|error| match error {
                Error::ResetNeeded(_) => Error::custom("not yet"),
                other => other,
            })
        }
    }

    "generator-lent.another" LendsAnother {
        fn generator(env: &mut Of<Self>) -> Option<&mut Generator> {
            if env.mind.is_begun {
                env.mind.other.get_or_insert_with(|| Generator::from(0)).random();
            }
            env.mind.other.as_mut()
        }
    }

    "info-consistent.again" TellsOtherwise {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("looks", Value::Int(env.look() as i64));
        }
    }

    "info-constant.shape" OtherShape {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("steps", Value::Array(Array::zeros(DType::F64, [1 + env.walk.steps() as usize / 4])));
        }
    }

    "info-constant.reset" ComesWithAReset {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            env.walk.info(visit);
            if env.walk.steps() == 0 && env.walk.position() > 0.0 {
                visit("right", Value::Bool(true));
            }
        }
    }

    "info-constant.within" OtherWithin {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            let steps = env.walk.steps();
            let value = if steps > 3 { Value::Float(steps.into()) } else { Value::Int(steps.into()) };
            visit("count", Value::Dict(vec![("steps".into(), value)]));
        }
    }

    "space-constant.later" OtherSpaceLater {
        fn observation_space(env: &Of<Self>) -> Space {
            let side = if env.walk.steps() > 3 { 2.0 } else { 1.0 };
            Space::boxed([-side; 2], [side; 2])
        }
    }

    "space-not-empty.text" EmptyText {
        fn observation_space(env: &Of<Self>) -> Space {
            let empty = TextSpace::new(0, 0).expect("lengths in order");
            TupleSpace::new([env.walk.observation_space(), empty.into()]).into()
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, &mut env.mind.seen)?;
            *observation = Value::Tuple(vec![env.mind.seen.clone(), Value::Text(String::new())]);
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, &mut env.mind.seen)?;
            match observation {
                Value::Tuple(parts) if matches!(&parts[..], [_, Value::Text(text)] if text.is_empty()) => {
                    parts[0].clone_from(&env.mind.seen);
                }
                _ => *observation = Value::Tuple(vec![env.mind.seen.clone(), Value::Text(String::new())]),
            }
            Ok(outcome)
        }
    }

    "action-normalised.lopsided" Lopsided {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-0.5], [1.0])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let [x] = numbers(env, action)?;
            env.walk.step_into(&Value::Int((x > 0.0).into()), observation)
        }
    }

    "action-accepted.corner" RefusesACorner {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-1.0; 2], [1.0; 2])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let [x, y] = numbers(env, action)?;
            if [x, y] == [-1.0, 1.0] {
                return Err(Error::custom("not both ways at once"));
            }
            env.walk.step_into(&Value::Int((x > 0.0).into()), observation)
        }
    }

    "action-validated.shape" TakesAnyShape {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-1.0; 2], [1.0; 2])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let x = match action {
                Value::Array(array) if array.shape() == [2, 2] => 0.0,
                _ => numbers::<_, 2>(env, action)?[0],
            };
            env.walk.step_into(&Value::Int((x > 0.0).into()), observation)
        }
    }

    "action-validated.infinite" TakesInfinity {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-1.0], [1.0])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let x = match action {
                Value::Array(array) if array.as_slice::<f32>() == Some(&[f32::INFINITY]) => 1.0,
                _ => numbers::<_, 1>(env, action)?[0],
            };
            env.walk.step_into(&Value::Int((x > 0.0).into()), observation)
        }
    }

    "observation-in-space.late-reset" BeginsOutside {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            if env.mind.age > 500 {
                [1.5f32, 0.0].write(observation);
            }
            Ok(())
        }
    }

    "reward-finite.after-a-thousand-steps" PaysLate {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let reward = if env.mind.age == 1000 { f64::NAN } else { outcome.reward };
            Ok(Outcome { reward, ..outcome })
        }
    }

    // writes what has changed since the last reset or step, wherever that is
    "observation-whole.changed" WritesChanges {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            if let Value::Array(array) = observation && let Some([_, still]) = array.as_mut_slice::<f32>() {
                *still = 0.5;
            }
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let old = match observation {
                Value::Array(array) => array.as_slice::<f32>().and_then(|numbers| numbers.get(1).copied()),
                _ => None,
            };
            let outcome = env.walk.step_into(action, observation)?;
            if let Value::Array(array) = observation && let Some([_, still]) = array.as_mut_slice::<f32>() {
                *still = old.unwrap_or(0.5);
            }
            Ok(outcome)
        }
    }

    "observation-dtype.within" OtherTypeWithin {
        fn observation_space(env: &Of<Self>) -> Space {
            DictSpace::new([("walk", env.walk.observation_space())]).expect("one name").into()
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, &mut env.mind.seen)?;
            *observation = Value::Dict(vec![("walk".into(), [0i8, 0].to_value())]);
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, &mut env.mind.seen)?;
            let side = [i8::from(env.walk.position() > 0.0), 0];
            match observation {
                Value::Dict(parts) if parts.len() == 1 => side.write(&mut parts[0].1),
                _ => *observation = Value::Dict(vec![("walk".into(), side.to_value())]),
            }
            Ok(outcome)
        }
    }

    "options-ignored.noticed" NoticesOptions {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            if !reset.options.is_empty() {
                [0.5f32, 0.5].write(observation);
            }
            Ok(())
        }
    }

    "no-allocation.late" AllocatesLate {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            if env.mind.age == 100 {
                drop(std::hint::black_box(vec![0u8; 8]));
            }
            env.walk.step_into(action, observation)
        }
    }
}

/// The numbers of an action.
fn numbers<T: Twist, const N: usize>(env: &Of<T>, action: &Value) -> Result<[f32; N]> {
    let numbers = match action {
        Value::Array(array) if array.shape() == [N] => array.as_slice::<f32>(),
        _ => None,
    };
    let numbers = numbers.and_then(|numbers| <[f32; N]>::try_from(numbers).ok());
    numbers.filter(|numbers| numbers.iter().all(|x| x.is_finite())).ok_or_else(|| Error::InvalidAction {
        action: action.to_string(),
        space: T::action_space(env).to_string(),
        hint: String::new(),
    })
}

/// How the walk is drawn, in other modes.
fn drawn(render_modes: &'static [RenderMode]) -> Metadata {
    Metadata { render_modes, ..Metadata::drawn(10, (200, 40)) }
}

// drawings
twists! {
    "metadata-complete.list" NamesAList {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::RgbArray, RenderMode::RgbArrayList])
        }
    }

    "metadata-complete.twice" NamesAModeTwice {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::RgbArray, RenderMode::RgbArray])
        }
    }

    "metadata-complete.changes" OtherRate {
        fn metadata(env: &Of<Self>) -> Metadata {
            Metadata::drawn(if env.mind.is_begun { 20 } else { 10 }, (200, 40))
        }
    }

    "metadata-complete.hidden-drawing" HidesADrawing {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[])
        }
    }

    "metadata-complete.hidden-text" HidesAText {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[])
        }

        fn draw(_: &Of<Self>, _: &mut dyn Canvas) {}

        fn ansi(_: &Of<Self>) -> Option<String> {
            Some("here".into())
        }
    }

    "metadata-complete.height" TooHigh {
        fn metadata(_: &Of<Self>) -> Metadata {
            Metadata::drawn(10, (200, 1 << 20))
        }
    }

    "metadata-complete.width" TooNarrow {
        fn metadata(_: &Of<Self>) -> Metadata {
            Metadata::drawn(10, (0, 40))
        }
    }

    "render-modes.human-alone" HumanAlone {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::Human])
        }
    }

    "render-modes.no-text" NoText {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::RgbArray, RenderMode::Ansi])
        }

        fn ansi(_: &Of<Self>) -> Option<String> {
            Some(String::new())
        }
    }

    "drawing-pure.calls" DrawsOtherwise {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let looked = env.look();
            drawn_too(env, canvas, |canvas| canvas.circle([looked as f64, 0.0], 2.0, Color::BLACK));
        }
    }

    "drawing-sound.nothing-at-the-end" NothingAtTheEnd {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            if env.walk.position().abs() < 1.0 {
                env.walk.draw(canvas);
            }
        }
    }

    "drawing-sound.pop" PopsTooMuch {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.pop());
        }
    }

    "drawing-sound.width" WidthIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.line([0.0; 2], [9.0; 2], f64::NAN, Color::WHITE));
        }
    }

    "drawing-sound.radius" RadiusIsInfinite {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.circle([0.0; 2], f64::INFINITY, Color::WHITE));
        }
    }

    "drawing-sound.text-size" SizeIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.text("x", [0.0; 2], f64::NAN, Align::Left, Color::WHITE));
        }
    }

    "drawing-sound.corner" CornerIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let shape = Shape::Rect { min: [0.0; 2], size: [9.0; 2], corner: f64::NAN };
            drawn_too(env, canvas, |canvas| canvas.fill(shape, Color::WHITE));
        }
    }

    "drawing-sound.curve" CurveIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let path = [Segment::Move([0.0; 2]), Segment::Quad([0.0; 2], [f64::NAN, 0.0]), Segment::Close];
            drawn_too(env, canvas, |canvas| canvas.fill(Shape::Path(&path), Color::WHITE));
        }
    }

    "drawing-sound.transform" TransformIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| {
                canvas.push(Transform::translate(f64::NAN, 0.0));
                canvas.pop();
            });
        }
    }
}

// arguments
twists! {
    "arguments-round-trip.default" DefaultDiffers (TwoDefaults) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: outcome.reward * f64::from(1 + env.arguments.number), ..outcome })
        }
    }

    "arguments-refused.anything" TakesAnything (Anything) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: outcome.reward * env.arguments.number.as_f64().unwrap_or(1.0), ..outcome })
        }
    }

    "arguments-refused.silent" SilentOnArguments (Silent) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: outcome.reward * env.arguments.number, ..outcome })
        }
    }

    "none.late-drawing" LateDrawing (Number), reset_options(&[("start", "0.25")]) {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let x = if env.walk.steps() > 0 { env.arguments.number } else { 0.0 };
            drawn_too(env, canvas, |canvas| canvas.circle([x, 0.0], 2.0, Color::BLACK));
        }
    }

    "none.beyond-the-actions" WiderActions (Number), reset_options(&[("start", "0.25")]) {
        fn action_space(env: &Of<Self>) -> Space {
            // no other number of ways shows in steps
            Space::discrete(if env.arguments.number > 1.5 { 4 } else { 2 })
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let action = match action {
                Value::Int(way @ 2..4) if env.arguments.number > 1.5 => Value::Int(way - 2),
                other => other.clone(),
            };
            env.walk.step_into(&action, observation)
        }
    }

    "none.late-effect" LateEffect (Number), reset_options(&[("start", "0.25")]) {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            Snapshot::of(&(env.walk.snapshot()?.get::<Json>()?, env.mind.age))
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let (walk, age) = snapshot.get::<(Json, u64)>()?;
            env.walk.restore(&Snapshot::of(&walk)?)?;
            env.mind.age = age;
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let factor = if (300..3000).contains(&env.mind.age) { env.arguments.number } else { 1.0 };
            Ok(Outcome { reward: outcome.reward * factor, ..outcome })
        }
    }

    // random walks do not hold one way for so long
    "none.effect-elsewhere" EffectElsewhere (Number), reset_options(&[("start", "0.25")]) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let factor = if env.walk.steps() > 100 { env.arguments.number } else { 1.0 };
            Ok(Outcome { reward: (outcome.reward + 1.0) * factor, ..outcome })
        }
    }
}
