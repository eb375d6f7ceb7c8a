//! `environments_match` finds each difference that it is asked to find, and no other.

use broken_envs::{Config, Fault, Walk};
use gym_conform::{InfoComparison, Matching, environments_match};
use gym_core::canvas::{Canvas, Color};
use gym_core::render::RenderMode;
use gym_core::wrappers::Render;
use gym_core::{BoxEnv, Env, EnvExt, Outcome, Reset, Result, Space, Value};
use gym_render as _;

/// The difference between the two walks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Otherwise {
    #[default]
    Nothing,
    ActionSpace,
    ObservationSpace,
    Reset,
    Observation,
    Reward,
    Terminated,
    Truncated,
    InfoValue,
    InfoKey,
    Picture,
}

#[derive(Clone, Debug)]
struct Other {
    walk: Walk,
    otherwise: Otherwise,
    steps: u32,
}

impl Other {
    fn is(&self, otherwise: Otherwise) -> bool {
        self.otherwise == otherwise
    }
}

/// The step of the difference: late enough for the action seed to matter.
const STEP: u32 = 2;

impl gym_core::Wrapper for Other {
    type Inner = Walk;
    type Observation = Value;
    type Action = Value;

    fn inner(&self) -> &Walk {
        &self.walk
    }

    fn inner_mut(&mut self) -> &mut Walk {
        &mut self.walk
    }

    fn on_action_space(&self) -> Space {
        if self.is(Otherwise::ActionSpace) {
            Space::discrete(1)
        } else {
            self.walk.action_space()
        }
    }

    fn on_observation_space(&self) -> Space {
        match self.otherwise {
            Otherwise::ObservationSpace => Space::boxed([-2.0; 2], [2.0; 2]),
            _ => self.walk.observation_space(),
        }
    }

    fn on_reset(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        self.steps = 0;
        self.walk.reset_into(reset, observation)?;
        if self.is(Otherwise::Reset) {
            *observation = elsewhere();
        }
        Ok(())
    }

    fn on_step(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        self.steps += 1;
        let mut outcome = self.walk.step_into(action, observation)?;
        if self.steps == STEP {
            match self.otherwise {
                Otherwise::Observation => *observation = elsewhere(),
                Otherwise::Reward => outcome.reward += 1.0,
                Otherwise::Terminated => outcome.terminated ^= true,
                Otherwise::Truncated => outcome.truncated ^= true,
                _ => (),
            }
        }
        Ok(outcome)
    }

    fn on_info(&self, visit: &mut dyn FnMut(&str, Value)) {
        visit(
            "steps",
            Value::Int(if self.is(Otherwise::InfoValue) {
                -1
            } else {
                self.steps.into()
            }),
        );
        if self.is(Otherwise::InfoKey) {
            visit("more", Value::Bool(true));
        }
    }

    fn on_draw(&self, canvas: &mut dyn Canvas) {
        self.walk.draw(canvas);
        if self.is(Otherwise::Picture) {
            canvas.circle([20.0, 20.0], 9.0, Color::BLACK);
        }
    }
}

/// Returns an observation that no walk has.
fn elsewhere() -> Value {
    gym_core::Element::to_value(&[0.75f32, 0.75])
}

fn env(otherwise: Otherwise) -> BoxEnv {
    let walk = Walk::<Config>::new(Fault::None).unwrap();
    let env = BoxEnv::new(Other {
        walk,
        otherwise,
        steps: 0,
    });
    BoxEnv::new(Render::new(env, RenderMode::RgbArray).unwrap())
}

/// Returns the difference that `environments_match` finds, if any.
fn difference(a: Otherwise, b: Otherwise, matching: Matching) -> Option<String> {
    environments_match(&mut env(a), &mut env(b), &matching)
        .err()
        .map(|error| error.to_string())
}

#[test]
fn each_difference_is_seen_unless_it_is_left_out() {
    let all = Matching {
        num_steps: 5,
        ..Matching::default()
    };
    assert_eq!(
        difference(Otherwise::Nothing, Otherwise::Nothing, all),
        None
    );
    let skip_info = Matching {
        info_comparison: InfoComparison::Skip,
        ..all
    };
    for (otherwise, named, without) in [
        (Otherwise::ActionSpace, "the action space", None),
        (
            Otherwise::ObservationSpace,
            "the observation space",
            Some(Matching {
                skip_obs: true,
                ..all
            }),
        ),
        (
            Otherwise::Reset,
            "the observation of reset",
            Some(Matching {
                skip_obs: true,
                ..all
            }),
        ),
        (
            Otherwise::Observation,
            "the observation of step 1",
            Some(Matching {
                skip_obs: true,
                ..all
            }),
        ),
        (
            Otherwise::Reward,
            "the reward of step 1",
            Some(Matching {
                skip_rew: true,
                ..all
            }),
        ),
        (
            Otherwise::Terminated,
            "`terminated` of step 1",
            Some(Matching {
                skip_terminal: true,
                ..all
            }),
        ),
        (
            Otherwise::Truncated,
            "`truncated` of step 1",
            Some(Matching {
                skip_truncated: true,
                ..all
            }),
        ),
        (Otherwise::InfoValue, "the info of reset", Some(skip_info)),
        (Otherwise::InfoKey, "the info of reset", Some(skip_info)),
        (
            Otherwise::Picture,
            "the picture of reset",
            Some(Matching {
                skip_render: true,
                ..all
            }),
        ),
    ] {
        for (a, b) in [
            (otherwise, Otherwise::Nothing),
            (Otherwise::Nothing, otherwise),
        ] {
            let text = difference(a, b, all).unwrap_or_default();
            assert!(
                text.contains(&format!("differ in {named}")),
                "{otherwise:?}: {text}"
            );
            assert_eq!(
                without.and_then(|matching| difference(a, b, matching)),
                None,
                "{otherwise:?}"
            );
        }
    }
    // without steps there is no difference in steps
    assert_eq!(
        difference(
            Otherwise::Reward,
            Otherwise::Nothing,
            Matching {
                num_steps: 0,
                ..all
            }
        ),
        None
    );
    assert_eq!(
        difference(
            Otherwise::Reward,
            Otherwise::Nothing,
            Matching {
                num_steps: 1,
                ..all
            }
        ),
        None
    );
}

#[test]
fn infos_are_compared_as_asked() {
    use InfoComparison::{Equivalence, KeysEquivalence, KeysSuperset, Superset};
    use Otherwise::{InfoKey, InfoValue, Nothing};
    let matches = |a, b, info_comparison| {
        difference(
            a,
            b,
            Matching {
                num_steps: 3,
                info_comparison,
                ..Matching::default()
            },
        )
        .is_none()
    };
    for (a, b, expected) in [
        (Nothing, Nothing, [true, true, true, true]),
        (Nothing, InfoValue, [false, false, true, true]),
        // a superset: the second environment may have more entries, but not fewer
        (Nothing, InfoKey, [false, true, false, true]),
        (InfoKey, Nothing, [false, false, false, false]),
    ] {
        let found =
            [Equivalence, Superset, KeysEquivalence, KeysSuperset].map(|how| matches(a, b, how));
        assert_eq!(found, expected, "{a:?} and {b:?}");
    }
}

/// The seed also draws the actions.
#[test]
fn the_seed_chooses_the_actions() {
    #[derive(Clone, Debug)]
    struct Recorder(Walk, std::sync::Arc<std::sync::Mutex<Vec<Value>>>);
    impl gym_core::Wrapper for Recorder {
        type Inner = Walk;
        type Observation = Value;
        type Action = Value;
        fn inner(&self) -> &Walk {
            &self.0
        }
        fn inner_mut(&mut self) -> &mut Walk {
            &mut self.0
        }
        fn on_reset(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
            self.0.reset_into(reset, observation)
        }
        fn on_step(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
            self.1.lock().unwrap().push(action.clone());
            self.0.step_into(action, observation)
        }
    }
    let actions = |seed: u64| {
        let seen = std::sync::Arc::default();
        let walk = || Walk::<Config>::new(Fault::None).unwrap();
        let matching = Matching {
            num_steps: 20,
            seed,
            ..Matching::default()
        };
        environments_match(
            &mut Recorder(walk(), std::sync::Arc::clone(&seen)),
            &mut walk(),
            &matching,
        )
        .unwrap();
        std::mem::take(&mut *seen.lock().unwrap())
    };
    let drawn = |seed: u64| {
        let mut sampler = Space::discrete(2).sampler(seed);
        (0..20).map(|_| sampler.sample()).collect::<Vec<_>>()
    };
    for seed in [0, 1, 7] {
        assert_eq!(actions(seed), drawn(seed), "seed {seed}");
    }
}

/// The first environment's part stands first.
#[test]
fn a_difference_tells_what_both_did() {
    let told = |otherwise: Otherwise, is_first: bool| {
        let (a, b) = match is_first {
            true => (otherwise, Otherwise::Nothing),
            false => (Otherwise::Nothing, otherwise),
        };
        let text = difference(a, b, Matching::default()).unwrap();
        let text = text.strip_prefix("the environments differ in ");
        text.unwrap_or_default().to_owned()
    };
    let mut env = env(Otherwise::Nothing);
    let mut actions = env.action_space().sampler(0);
    let first = env.reset(0).unwrap();
    let step = [(); 2].map(|()| env.step(&actions.sample()).unwrap())[1].clone();
    let (other, info) = (elsewhere(), |steps: i64| {
        format!("{{\"steps\": Int({steps})}}")
    });
    let more = "{\"more\": Bool(true), \"steps\": Int(0)}".to_owned();
    for (otherwise, place, [own, others]) in [
        (
            Otherwise::ActionSpace,
            "the action space",
            ["Discrete(2)".to_owned(), "Discrete(1)".to_owned()],
        ),
        (
            Otherwise::Reset,
            "the observation of reset",
            [first.to_string(), other.to_string()],
        ),
        (
            Otherwise::Observation,
            "the observation of step 1",
            [step.observation.to_string(), other.to_string()],
        ),
        (
            Otherwise::Reward,
            "the reward of step 1",
            [step.reward, step.reward + 1.0].map(|reward| reward.to_string()),
        ),
        (
            Otherwise::Terminated,
            "`terminated` of step 1",
            [step.terminated, !step.terminated].map(|ended| ended.to_string()),
        ),
        (
            Otherwise::Truncated,
            "`truncated` of step 1",
            [step.truncated, !step.truncated].map(|ended| ended.to_string()),
        ),
        (
            Otherwise::InfoValue,
            "the info of reset",
            [info(0), info(-1)],
        ),
        (Otherwise::InfoKey, "the info of reset", [info(0), more]),
    ] {
        assert_eq!(
            told(otherwise, false),
            format!("{place}: {own} and {others}")
        );
        assert_eq!(
            told(otherwise, true),
            format!("{place}: {others} and {own}")
        );
    }
    assert_eq!(told(Otherwise::Picture, true), "the picture of reset");
}
