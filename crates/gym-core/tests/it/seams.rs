//! Cases around an episode: after `close`, ids without version, environments
//! that truncate by themselves.

use gym_core::wrappers::{OrderEnforcing, TimeLimit};
use gym_core::{
    Array, BoxEnv, Dynamics, Env, EnvExt, Error, Generator, NoArguments, Registration, Reset,
    Result, Snapshot, Space, Stateful, Task, Transition, Value, VectorEnv, VectorEnvExt, registry,
};

/// A task with `budget` steps per episode, and an array as observation.
#[derive(Clone, Debug)]
struct Budget(Config);

gym_core::arguments! {
    #[derive(Copy)]
    struct Config {
        /// The number of steps of an episode.
        pub budget: f64 = 3.0,
    }
}

impl Task for Budget {
    type Config = Config;
    type State = i64;
    type Observation = Array;
    type Action = i64;
    const NAME: &'static str = "Budget";

    fn new(config: Config) -> Result<Self> {
        Ok(Self(config))
    }

    fn config(&self) -> &Config {
        &self.0
    }

    fn observation_space(&self) -> Space {
        Space::boxed([0.0], [100.0])
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn start(&self, _reset: &Reset, _rng: &mut Generator) -> Result<i64> {
        Ok(0)
    }

    fn is_valid(&self, state: &i64) -> bool {
        (0..=10).contains(state)
    }
}

impl Dynamics for Budget {
    fn transition(
        &self,
        state: &i64,
        _action: &i64,
        _rng: &mut Generator,
    ) -> Result<Transition<i64>> {
        Ok(Transition {
            state: state + 1,
            reward: 1.0,
            terminated: *state == 9,
        })
    }

    fn observe(&self, state: &i64) -> Array {
        Array::from([*state as f32])
    }

    fn observe_into(&self, state: &i64, observation: &mut Array) {
        match observation.as_mut_slice::<f32>() {
            Some([x]) => *x = *state as f32,
            _ => *observation = self.observe(state),
        }
    }

    fn truncates(&self, state: &i64) -> bool {
        *state as f64 >= self.0.budget
    }
}

gym_core::register!(Registration::new::<Stateful<Budget>>("seams/Budget-v2"));
gym_core::register!(Registration::new::<Stateful<Budget>>("seams/Budget-v4"));

fn make() -> BoxEnv {
    gym_core::make("seams/Budget-v4").unwrap()
}

#[test]
fn dynamics_truncate_and_keep_their_buffer() {
    let mut env = Stateful::<Budget>::new(Config::default()).unwrap();
    let mut observation = env.reset(0).unwrap();
    let place = observation.as_slice::<f32>().unwrap().as_ptr();
    let ends: Vec<_> = (0..4)
        .map(|_| {
            env.step_into(&0, &mut observation)
                .map(|outcome| (outcome.terminated, outcome.truncated))
                .unwrap()
        })
        .collect();
    assert_eq!(
        ends,
        [(false, false), (false, false), (false, true), (false, true)]
    );
    assert_eq!(observation.as_slice::<f32>().unwrap(), [4.0]);
    assert_eq!(observation.as_slice::<f32>().unwrap().as_ptr(), place);
}

#[test]
fn nothing_opens_a_closed_environment() {
    let mut env = make();
    env.reset(0).unwrap();
    let snapshot = env.snapshot().unwrap();
    env.close();
    let closed = |result: Result<()>| matches!(result, Err(Error::Closed(_)));
    assert!(closed(env.restore(&snapshot)));
    assert!(closed(env.snapshot().map(drop)));
    assert!(closed(env.reset(0).map(drop)));
    assert!(closed(env.step(&Value::Int(0)).map(drop)));
    assert!(closed(env.render().map(drop)));
    // without the wrappers of `make`, a closed environment needs a reset
    let mut env = Stateful::<Budget>::new(Config::default()).unwrap();
    env.reset(0).unwrap();
    env.close();
    assert!(env.step(&0).is_err());
    // a snapshot of a closed environment does not close an open one
    let mut env = OrderEnforcing::new(Stateful::<Budget>::new(Config::default()).unwrap());
    env.reset(0).unwrap();
    let text = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
    let text = text.replace("\"Reset\"", "\"Closed\"");
    assert!(text.contains("Closed") && env.restore(&serde_json::from_str(&text).unwrap()).is_err());
    env.step(&0).unwrap();
}

#[test]
fn messages_name_what_is_wrong() {
    let message = |error: Error| {
        assert_eq!(
            format!("{error:?}"),
            error.to_string(),
            "`fn main() -> Result<()>` prints the first"
        );
        error.to_string()
    };
    let error = message(registry::find("seams/Budget").unwrap_err());
    assert_eq!(
        error,
        "environment `seams/Budget` has versions: ask for one of `seams/Budget-v2`, `seams/Budget-v4`"
    );
    let error = message(registry::find("seams/Budget-v3").unwrap_err());
    assert!(error.contains("version 3"), "{error}");
    let error = message(
        gym_core::builder("seams/Budget-v4")
            .arg("budget", f64::NAN)
            .build()
            .unwrap_err(),
    );
    assert!(error.contains("NaN and infinite"), "{error}");
    let mut env = TimeLimit::new(make(), 9).unwrap();
    env.reset(0).unwrap();
    let error = message(env.step(&Value::from([0.5; 900])).unwrap_err());
    assert!(error.starts_with("invalid action [0.5 0.5 "), "{error}");
    assert!(
        error.ends_with(
            "...: expected a whole number, not an array; the action space is Discrete(2)"
        ),
        "{error}"
    );
    assert!(error.len() < 500, "{} characters", error.len());
    let error = message(
        Space::boxed([-1.0], [1.0])
            .check(&Value::from([0.5_f64]))
            .unwrap_err(),
    );
    assert!(
        error.starts_with("the numbers are float64 and should be float32"),
        "{error}"
    );
}

/// An environment without snapshots.
#[derive(Clone)]
struct Forgetful;

impl Env for Forgetful {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(1)
    }

    fn action_space(&self) -> Space {
        Space::discrete(1)
    }

    fn reset_into(&mut self, _reset: &Reset, observation: &mut i64) -> Result<()> {
        *observation = 0;
        Ok(())
    }

    fn step_into(&mut self, _action: &i64, observation: &mut i64) -> Result<gym_core::Outcome> {
        *observation = 0;
        Ok(gym_core::Outcome::default())
    }
}

impl registry::Configure for Forgetful {
    type Config = NoArguments;

    fn configure(_: NoArguments, _: u32) -> Result<Self> {
        Ok(Self)
    }
}

#[test]
fn snapshots_of_something_else_say_whose_they_are() {
    let mut env = make();
    env.reset(0).unwrap();
    let other = Snapshot::with_config("CartPole", &NoArguments {}, &Some(1)).unwrap();
    let mut bare = Stateful::<Budget>::new(Config::default()).unwrap();
    let error = bare.restore(&other).unwrap_err().to_string();
    assert!(
        error.contains("this is a snapshot of CartPole, not of Budget"),
        "{error}"
    );
    let error = env
        .restore(&Snapshot::of(&(other, 3)).unwrap())
        .unwrap_err()
        .to_string();
    assert!(error.contains("CartPole"), "{error}");
    let error = bare
        .restore(&env.snapshot().unwrap())
        .unwrap_err()
        .to_string();
    assert!(error.contains("its wrappers"), "{error}");
    for error in [
        Forgetful.snapshot().unwrap_err(),
        Forgetful.restore(&env.snapshot().unwrap()).unwrap_err(),
    ] {
        assert!(
            error
                .to_string()
                .contains("implement `Env::snapshot` and `Env::restore`"),
            "{error}"
        );
    }
}

/// For vectors of every kind, a list of arguments must have one entry per sub-environment.
#[test]
fn lists_of_arguments_are_as_long_as_their_vector() {
    use gym_core::vector::VectorKind;

    for kind in [VectorKind::Sync, VectorKind::Async] {
        let vector = |budgets: &[f64]| {
            let vector = gym_core::builder("seams/Budget-v4").vector(2).kind(kind);
            vector.arg_each("budget", budgets.to_vec()).build()
        };
        for budgets in [&[1.0][..], &[1.0, 2.0, 3.0], &[]] {
            let error = vector(budgets).map(drop).unwrap_err().to_string();
            let expected = format!("there are {} values for 2 environments", budgets.len());
            assert!(
                error.contains("budget") && error.contains(&expected),
                "{kind:?}: {error}"
            );
        }
        let mut envs = vector(&[1.0, 2.0]).unwrap();
        let mut columns = envs.reset(0).unwrap();
        let actions = envs.action_sampler(0).unwrap().sample();
        let ends: Vec<_> = (0..2)
            .map(|_| {
                envs.step_into(&actions, &mut columns).unwrap();
                columns.truncated.clone()
            })
            .collect();
        assert_eq!(ends, [[true, false], [false, true]], "{kind:?}");
    }
}

/// Arguments given to `make` replace settings of the builder with the same name; other settings
/// stay.
#[test]
fn arguments_of_make_go_before_what_the_builder_was_told() {
    let built = || {
        let env = gym_core::builder("seams/Budget-v4").arg("budget", 2.0);
        env.disable_env_checker(true).max_episode_steps(5)
    };
    let told = |env: gym_core::registry::EnvBuilder| {
        let spec = env.build().unwrap().spec().unwrap();
        assert_eq!(spec.kwargs.keys().collect::<Vec<_>>(), ["budget"]);
        (spec.disable_env_checker, spec.max_episode_steps)
    };
    assert_eq!(told(built()), (true, Some(5)));
    assert_eq!(
        told(built().arg("disable_env_checker", false)),
        (false, Some(5))
    );
    assert_eq!(told(built().arg("max_episode_steps", 7)), (true, Some(7)));
    assert_eq!(told(built().arg("max_episode_steps", -1)), (true, None));
}
