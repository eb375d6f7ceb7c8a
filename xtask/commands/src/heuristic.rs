//! A simple good policy for every environment: rules by hand, and for transition tables the best
//! policy there is.

use std::f64::consts::PI;

use gym::box2d::{BipedalWalker, CarRacing, LunarLander, bipedal_walker, lunar_lander};
use gym::classic::{Acrobot, CartPole, MountainCar, MountainCarContinuous, Pendulum};
use gym::toytext::tabular::Table;
use gym::toytext::{Blackjack, CliffWalking, FrozenLake, Taxi};
use gym::{BoxEnv, Element, Env, EnvExt, Space};

use crate::policy::Controller;

/// The controller of an environment for one episode, if there is one.
pub(crate) fn controller(env: &BoxEnv) -> Option<Controller> {
    let discrete = matches!(env.action_space(), Space::Discrete(_));
    if env.unwrapped::<CartPole>().is_some() {
        return Some(reflex(cartpole));
    } else if env.unwrapped::<MountainCar>().is_some() {
        return Some(reflex(mountain_car));
    } else if env.unwrapped::<MountainCarContinuous>().is_some() {
        return Some(reflex(mountain_car_continuous));
    } else if env.unwrapped::<Pendulum>().is_some() {
        return Some(reflex(pendulum));
    } else if env.unwrapped::<Acrobot>().is_some() {
        return Some(reflex(acrobot));
    } else if env.unwrapped::<Blackjack>().is_some() {
        return Some(reflex(blackjack));
    } else if env.unwrapped::<LunarLander>().is_some() {
        return Some(reflex(move |seen| lunar_lander::heuristic(seen, !discrete)));
    } else if env.unwrapped::<BipedalWalker>().is_some() {
        let mut gait = bipedal_walker::Heuristic::default();
        return Some(reflex(move |seen| gait.act(seen)));
    } else if env.unwrapped::<CarRacing>().is_some() {
        return (!discrete).then(follow_the_track);
    }
    let table = (env.unwrapped::<FrozenLake>().map(|lake| lake.dynamics().p()))
        .or_else(|| env.unwrapped::<CliffWalking>().map(|cliff| cliff.dynamics().p()))
        .or_else(|| env.unwrapped::<Taxi>().map(|taxi| taxi.dynamics().p()));
    table.map(|table| {
        let best = value_iteration(table);
        reflex(move |state: &usize| best.get(*state).copied().unwrap_or(0))
    })
}

/// A controller that needs nothing but the observation.
fn reflex<O: Element, A: Element>(mut act: impl FnMut(&O) -> A + 'static) -> Controller {
    Box::new(move |_, seen| O::with(seen, |seen| act(seen).to_value()))
}

/// Pushes to the side that a weighted sum of the state calls for: a linear controller, in sign alone.
fn cartpole([x, x_dot, theta, theta_dot]: &[f32; 4]) -> i64 {
    i64::from(x + 1.6 * x_dot + 18.0 * theta + 3.0 * theta_dot > 0.0)
}

/// Drives right while the velocity lies between two curves over the position (Zhiqing Xiao,
/// *Reinforcement Learning: Theory and Python Implementation*, 2024), else left.
fn mountain_car([position, velocity]: &[f32; 2]) -> i64 {
    let x = *position;
    let low = (-0.09 * (x + 0.25).powi(2) + 0.03).min(0.3 * (x + 0.9).powi(4) - 0.008);
    let high = -0.07 * (x + 0.38).powi(2) + 0.07;
    if low < *velocity && *velocity < high { 2 } else { 0 }
}

/// Drives along with the velocity, which gathers energy, and gently, since force costs reward.
fn mountain_car_continuous([_, velocity]: &[f32; 2]) -> [f32; 1] {
    [if *velocity < 0.0 { -0.4 } else { 0.4 }]
}

/// Gathers energy until the pole is near the top, then holds it there.
fn pendulum([cos, sin, theta_dot]: &[f32; 3]) -> [f32; 1] {
    let theta = sin.atan2(*cos);
    // per unit of inertia: that at the top is 15
    let energy = 0.5 * theta_dot * theta_dot + 15.0 * cos;
    let torque =
        if theta.abs() < 0.5 { -10.0 * theta - 2.0 * theta_dot } else { (15.0 - energy) * theta_dot };
    [torque.clamp(-2.0, 2.0)]
}

/// Pushes the lower link along with its own motion, which gathers energy.
fn acrobot(seen: &[f32; 6]) -> i64 {
    let [_, _, _, _, _, dtheta2] = *seen;
    if dtheta2 < 0.0 { 0 } else { 2 }
}

/// Basic strategy: Sutton and Barto, figure 5.2.
fn blackjack((sum, dealer, usable_ace): &(i64, i64, i64)) -> i64 {
    let stick = if *usable_ace == 1 {
        *sum >= if *dealer >= 9 { 19 } else { 18 }
    } else {
        let least = match *dealer {
            2..=3 => 13,
            4..=6 => 12,
            _ => 17,
        };
        *sum >= least
    };
    i64::from(!stick)
}

/// The best action in each state of a table (Sutton and Barto, section 4.4).
fn value_iteration(table: &Table) -> Vec<i64> {
    const DISCOUNT: f64 = 0.999;
    const TOLERANCE: f64 = 1e-9;
    let rate = |values: &[f64], state, action| -> f64 {
        let outcomes = table.outcomes(state, action).iter();
        outcomes
            .map(|o| o.probability * (o.reward + if o.terminated { 0.0 } else { DISCOUNT * values[o.next] }))
            .sum()
    };
    let best = |values: &[f64], state| {
        let rated = (0..table.actions()).map(|action| (action, rate(values, state, action)));
        rated.reduce(|best, other| if other.1 > best.1 { other } else { best }).unwrap_or((0, 0.0))
    };
    let mut values = vec![0.0; table.states()];
    loop {
        let mut change = 0.0_f64;
        for state in 0..values.len() {
            let (_, value) = best(&values, state);
            change = change.max((value - values[state]).abs());
            values[state] = value;
        }
        if change < TOLERANCE {
            return (0..values.len()).map(|state| best(&values, state).0 as i64).collect();
        }
    }
}

/// Steers towards the sixth track point ahead, at a moderate speed. It looks at the track, not at the
/// picture.
fn follow_the_track() -> Controller {
    let mut passed = 0;
    Box::new(move |env, _| {
        let env = env.unwrapped::<CarRacing>()?;
        let track = env.track()?;
        let [x, y, angle, vx, vy, _] = env.state()?.hull;
        let ahead = |n: usize| &track[(passed + n) % track.len()];
        let distance = |n: &usize| f64::hypot(ahead(*n).x - x, ahead(*n).y - y);
        passed += (0..40).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let target = &track[(passed + 6) % track.len()];
        let turn = (f64::atan2(x - target.x, target.y - y) - angle + PI).rem_euclid(2.0 * PI) - PI;
        let speed = f64::hypot(vx, vy);
        let pedals = [
            (-1.5 * turn).clamp(-1.0, 1.0),
            if speed < 40.0 { 0.4 } else { 0.0 },
            if speed > 60.0 { 0.3 } else { 0.0 },
        ];
        Some(pedals.map(|pedal| pedal as f32).to_value())
    })
}
