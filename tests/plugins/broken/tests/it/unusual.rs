//! Environments that are no walks: what a correct one may do, and faults of long episodes.

use gym_core::spaces::DictSpace;
use gym_core::{BoxEnv, Env, Error, Generator, Outcome, Reset, Result, Snapshot, Space, Value};
use serde::{Deserialize, Serialize};

/// What is unusual about an environment.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// There is no snapshot before the first reset.
    Unstored,
    /// Episodes of different seeds begin alike.
    AlikeAtFirst,
    /// The observation is a dict.
    Dict,
    /// It panics when it is stepped beyond the end of an episode.
    PanicsBeyondTheEnd,
    /// In a long episode the reward is not a number.
    LateNaN,
    /// The same, with a dict.
    LateNaNOfDict,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct State {
    steps: u32,
    rng: Generator,
}

/// Shows a random number and the part of the episode that is over.
#[derive(Clone, Debug)]
struct Counter {
    way: Way,
    state: Option<State>,
}

/// The steps in which episodes are alike: more than a glance at them takes.
const ALIKE: u32 = 12;
/// The step after which there is no reward: beyond the runs in which pictures are observed.
const LATE: u32 = 700;

impl Counter {
    fn is_dict(&self) -> bool {
        matches!(self.way, Way::Dict | Way::LateNaNOfDict)
    }

    fn length(&self) -> u32 {
        match self.way {
            Way::LateNaN | Way::LateNaNOfDict => 900,
            _ => 90,
        }
    }

    fn show(&mut self, observation: &mut Value) -> Result<()> {
        let length = self.length();
        let state = self.state.as_mut().ok_or(Error::ResetNeeded("step"))?;
        let is_alike = self.way == Way::AlikeAtFirst && state.steps < ALIKE;
        let chance = if is_alike {
            0.5
        } else {
            state.rng.uniform(0.0, 1.0) as f32
        };
        let seen = Value::from([state.steps as f32 / length as f32, chance]);
        *observation = match self.is_dict() {
            true => Value::Dict(vec![("seen".into(), seen)]),
            false => seen,
        };
        Ok(())
    }
}

impl Env for Counter {
    type Observation = Value;
    type Action = Value;

    fn observation_space(&self) -> Space {
        let space = Space::boxed([0.0_f32; 2], [1.0; 2]);
        match self.is_dict() {
            true => Space::Dict(DictSpace::new([("seen", space)]).unwrap()),
            false => space,
        }
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let rng = match (&reset.seed, self.state.take()) {
            (Some(seed), _) => Generator::new(seed),
            (None, Some(last)) => last.rng,
            (None, None) => Generator::from_os()?,
        };
        self.state = Some(State { steps: 0, rng });
        self.show(observation)
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        let (space, length) = (self.action_space(), self.length());
        let state = self.state.as_mut().ok_or(Error::ResetNeeded("step"))?;
        if !space.contains(action) {
            return Err(Error::InvalidAction {
                action: action.to_string(),
                space: space.to_string(),
                hint: String::new(),
            });
        }
        let panics = self.way == Way::PanicsBeyondTheEnd;
        assert!(!panics || state.steps < length, "there is no more");
        state.steps = (state.steps + 1).min(length);
        let steps = state.steps;
        let is_late = matches!(self.way, Way::LateNaN | Way::LateNaNOfDict) && steps > LATE;
        self.show(observation)?;
        Ok(Outcome {
            reward: if is_late { f64::NAN } else { 1.0 },
            terminated: steps == length,
            truncated: false,
        })
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.state.as_mut().map(|state| &mut state.rng)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        if self.way == Way::Unstored && self.state.is_none() {
            return Err(Error::Snapshot("no episode has begun".into()));
        }
        Snapshot::of(&self.state)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let state: Option<State> = snapshot.get()?;
        let is_sound = |state: &State| state.steps <= self.length();
        if state.as_ref().is_some_and(|state| !is_sound(state)) {
            return Err(Error::Snapshot("it is beyond the end".into()));
        }
        self.state = state;
        Ok(())
    }
}

#[test]
fn each_check_finds_the_faults_of_long_episodes_and_excuses_what_is_allowed() {
    let found = |way: Way| {
        let findings = gym_conform::check(|| Ok(BoxEnv::new(Counter { way, state: None })));
        // an observation of one's own is a new one each time
        let findings = findings
            .into_iter()
            .filter(|finding| finding.check != "no-allocation");
        let told = findings.map(|finding| format!("{}: {}", finding.check, finding.message));
        told.collect::<Vec<_>>().join("\n")
    };
    let late = "reward-finite: a long run, step 701: the reward is NaN";
    let ways = [
        (Way::Unstored, ""),
        (Way::AlikeAtFirst, ""),
        (Way::Dict, ""),
        (
            Way::PanicsBeyondTheEnd,
            "no-panic: when stepped beyond the end of an episode it panics with \"there is no more\"",
        ),
        (Way::LateNaN, late),
        (Way::LateNaNOfDict, late),
    ];
    // in threads, because the check of the clock waits for a second
    std::thread::scope(|scope| {
        for (way, expected) in ways {
            scope.spawn(move || assert_eq!(found(way), expected, "{way:?}"));
        }
    });
}
