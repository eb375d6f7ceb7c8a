//! Maps that go both ways, at both ends of what they map: bins of observations and actions, and other bounds.

use gym_core::spaces::BoxSpace;
use gym_core::{Array, BoxEnv, DType, Env, EnvExt, Outcome, Reset, Result, Space, Value};
use gym_wrappers::{DiscretizeAction, DiscretizeObservation, RescaleAction, RescaleObservation};

/// An environment that shows its action. A reset shows the lower bounds.
#[derive(Clone, Debug)]
struct Echo(BoxSpace);

impl Env for Echo {
    type Observation = Value;
    type Action = Value;

    fn observation_space(&self) -> Space {
        self.0.clone().into()
    }

    fn action_space(&self) -> Space {
        self.0.clone().into()
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut Value) -> Result<()> {
        *observation = self.0.low().clone().into();
        Ok(())
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        observation.clone_from(action);
        Ok(Outcome::default())
    }
}

const TYPES: [DType; 2] = [DType::F32, DType::F64];

fn array(dtype: DType, numbers: [f64; 2]) -> Array {
    let data = gym_core::Data::from_f64(dtype, numbers);
    Array::new([2], data).unwrap()
}

/// The box from 0 to 1 and from -1 to 3.
fn echo(dtype: DType) -> BoxEnv {
    let [low, high] = [[0.0, -1.0], [1.0, 3.0]].map(|bounds| array(dtype, bounds));
    BoxEnv::new(Echo(BoxSpace::with_dtype(low, high, dtype).unwrap()))
}

/// An element of the box, the indices of its bins (of 4 and 2), and the lower and the upper edges of the bins.
type Binned = ([f64; 2], [i64; 2], [f64; 2], [f64; 2]);

const BINS: [Binned; 6] = [
    ([0.0, -1.0], [0, 0], [0.0, -1.0], [0.25, 1.0]),
    ([0.0, 3.0], [0, 1], [0.0, 1.0], [0.25, 3.0]),
    ([0.25, 0.5], [1, 0], [0.25, -1.0], [0.5, 1.0]),
    ([0.625, 1.0], [2, 1], [0.5, 1.0], [0.75, 3.0]),
    ([0.7421875, -0.5], [2, 0], [0.5, -1.0], [0.75, 1.0]),
    ([1.0, 3.0], [3, 1], [0.75, 1.0], [1.0, 3.0]),
];

/// The index of bins, as one integer or one for each element.
fn index([first, second]: [i64; 2], multidiscrete: bool) -> Value {
    match multidiscrete {
        true => Value::from([first, second]),
        false => Value::Int(2 * first + second),
    }
}

#[test]
fn the_edges_of_an_observations_bin_lie_around_it() {
    for dtype in TYPES {
        for multidiscrete in [false, true] {
            let mut env = DiscretizeObservation::new(echo(dtype), ([4, 2], multidiscrete)).unwrap();
            env.reset(0).unwrap();
            for (shown, bins, low, high) in BINS {
                let step = env.step(&array(dtype, shown).into()).unwrap();
                let what = format!("{dtype}, {multidiscrete}, {shown:?}");
                assert_eq!(step.observation, index(bins, multidiscrete), "{what}");
                let edges = env.revert_observation(&step.observation).unwrap();
                assert_eq!(edges, (array(dtype, low), array(dtype, high)), "{what}");
            }
            for beyond in [[4, 0], [0, 2], [-1, 0]] {
                let beyond = index(beyond, multidiscrete);
                let inside = env.observation_space().contains(&beyond);
                assert_eq!(env.revert_observation(&beyond).is_ok(), inside, "{beyond}");
            }
        }
    }
}

#[test]
fn the_centre_of_an_actions_bin_lies_between_its_edges() {
    for dtype in TYPES {
        for multidiscrete in [false, true] {
            let mut env = DiscretizeAction::new(echo(dtype), ([4, 2], multidiscrete)).unwrap();
            env.reset(0).unwrap();
            for (_, bins, low, high) in BINS {
                let what = format!("{dtype}, {multidiscrete}, {bins:?}");
                let bin = index(bins, multidiscrete);
                let centre = array(dtype, [0, 1].map(|i| (low[i] + high[i]) / 2.0));
                let taken = env.step(&bin).unwrap().observation;
                assert_eq!(taken, Value::from(centre.clone()), "{what}");
                // what lies between the edges, at either side of the centre, is of this bin
                let beside = |t: f64| array(dtype, [0, 1].map(|i| low[i] + t * (high[i] - low[i])));
                for action in [beside(0.125), centre, beside(0.875)] {
                    assert_eq!(env.revert_action(&action).unwrap(), bin, "{what}: {action}");
                }
            }
            for (end, bins) in [([0.0, -1.0], [0, 0]), ([1.0, 3.0], [3, 1])] {
                let back = env.revert_action(&array(dtype, end)).unwrap();
                assert_eq!(back, index(bins, multidiscrete));
            }
            let short = Array::new([1], gym_core::Data::from_f64(dtype, [0.5])).unwrap();
            assert!(env.revert_action(&short).is_err());
        }
    }
}

/// Elements of the box, and of the box from 10 to 20 and from -4 to -2.
const SCALED: [([f64; 2], [f64; 2]); 4] = [
    ([0.0, -1.0], [10.0, -4.0]),
    ([1.0, -1.0], [20.0, -4.0]),
    ([0.0, 3.0], [10.0, -2.0]),
    ([0.5, 2.0], [15.0, -2.5]),
];

#[test]
fn other_bounds_are_those_of_the_environment_both_ways() {
    for dtype in TYPES {
        let [low, high] = [[10.0, -4.0], [20.0, -2.0]].map(|bounds| array(dtype, bounds));
        let bounds = || (low.clone(), high.clone());
        let mut seen = RescaleObservation::new(echo(dtype), bounds()).unwrap();
        let mut done = RescaleAction::new(echo(dtype), bounds()).unwrap();
        let space = Space::from(BoxSpace::with_dtype(low.clone(), high.clone(), dtype).unwrap());
        assert_eq!(seen.observation_space(), space);
        assert_eq!(done.action_space(), space);
        assert_eq!(seen.reset(0).unwrap(), Value::from(low.clone()));
        done.reset(0).unwrap();
        for (inner, outer) in SCALED {
            let [inner, outer] = [inner, outer].map(|x| Value::from(array(dtype, x)));
            assert_eq!(seen.step(&inner).unwrap().observation, outer, "{dtype}");
            assert_eq!(done.step(&outer).unwrap().observation, inner, "{dtype}");
        }
    }
}
