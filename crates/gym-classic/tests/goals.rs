//! Ends of episodes where a number is just what it must be.

use gym_classic::{mountain_car, mountain_car_continuous};
use gym_core::{Dynamics, Generator, Task};

/// At the right end of the valley, at the highest speed: both are clipped to just these numbers.
#[test]
fn the_goal_itself_counts() {
    let mut rng = Generator::from(0);
    let config = mountain_car::Config { goal_position: 0.6, goal_velocity: 0.07, ..Default::default() };
    let car = mountain_car::MountainCarDynamics::new(config).unwrap();
    let before = mountain_car::State { position: 0.55, velocity: 0.07 };
    let after = car.transition(&before, &mountain_car::Action::Right, &mut rng).unwrap();
    assert_eq!((after.state.position, after.state.velocity), (0.6, 0.07));
    assert!(after.terminated);

    // its numbers are those of float32
    let [goal_position, goal_velocity] = [0.6f32, 0.07].map(f64::from);
    let config = mountain_car_continuous::Config { goal_position, goal_velocity, ..Default::default() };
    let car = mountain_car_continuous::MountainCarContinuousDynamics::new(config).unwrap();
    let before = mountain_car_continuous::State { position: 0.55, velocity: 0.07, fresh: false };
    let after = car.transition(&before, &[1.0f32].into(), &mut rng).unwrap();
    assert_eq!((after.state.position, after.state.velocity), (goal_position, goal_velocity));
    assert!(after.terminated);
}
