//! Rules of the tasks that no recorded episode covers: throttles, bounds, ends on every side, laps,
//! versions.

use gym_box2d::car_racing::{self, CarRacing};
use gym_box2d::lunar_lander::{self, LunarLander};
use gym_core::{BoxEnv, Env, EnvExt, Inspect, Outcome, Reset, Value, builder, make};
use serde_json::{Value as Json, json};

/// Returns the observations and rewards of `steps` steps with the action `action`.
fn after(env: &mut BoxEnv, action: &Value, steps: usize) -> Vec<(Value, f64)> {
    env.reset(5).unwrap();
    (0..steps)
        .map(|_| {
            let step = env.step(action).unwrap();
            (step.observation, step.reward)
        })
        .collect()
}

/// The main engine runs above 0, the side engines beyond 0.5 in either direction. No engine has
/// more power than at 1.
#[test]
fn throttles_have_a_dead_zone_and_an_end() {
    let mut env = builder("LunarLanderContinuous-v3")
        .disable_env_checker(true)
        .build()
        .unwrap();
    let mut after = |main: f32, side: f32| after(&mut env, &Value::from([main, side]), 5);
    let idle = after(-1.0, 0.0);
    for (main, side) in [(0.0, 0.0), (-0.2, 0.5), (0.0, -0.5), (-7.0, 0.3)] {
        assert_eq!(after(main, side), idle, "{main}, {side}");
    }
    let just_beyond = 0.5_f32.next_up();
    for (main, side) in [
        (f32::MIN_POSITIVE, 0.0),
        (0.0, just_beyond),
        (0.0, -just_beyond),
    ] {
        assert_ne!(after(main, side), idle, "{main}, {side}");
    }
    assert_eq!(after(9.0, -3.0), after(1.0, -1.0));
    // the main engine starts at half power
    let [least, half, full] = [f32::MIN_POSITIVE, 0.5, 1.0].map(|main| {
        let (_, reward) = after(main, 0.0)[1];
        let (_, free) = idle[1];
        free - reward
    });
    assert!(least < half && half < full, "{least}, {half}, {full}");
}

/// A lander that leaves the picture at either side has crashed.
#[test]
fn a_lander_may_leave_on_neither_side() {
    for side in [1.0, -1.0] {
        let mut env = builder("LunarLander-v3")
            .max_episode_steps(None)
            .build()
            .unwrap();
        let mut seen: [f32; 8] = env
            .reset(3)
            .unwrap()
            .as_slice::<f32>()
            .unwrap()
            .try_into()
            .unwrap();
        let last = loop {
            assert!(seen[0].abs() < 1.0, "it goes on at {}", seen[0]);
            // leans to the side `side`, and keeps the height
            let turn = (-0.3 * side - seen[4]) * 0.5 - seen[5];
            let engine = match () {
                () if seen[3] < 0.0 => 2,
                () if turn < -0.05 => 3,
                () if turn > 0.05 => 1,
                () => 0,
            };
            let step = env.step(&Value::Int(engine)).unwrap();
            seen = step
                .observation
                .as_slice::<f32>()
                .unwrap()
                .try_into()
                .unwrap();
            if step.done() {
                break step;
            }
        };
        assert!(
            seen[0] * side >= 1.0 && seen[6..] == [0.0; 2],
            "it leaves in the air: {seen:?}"
        );
        assert_eq!(
            (last.terminated, last.truncated, last.reward),
            (true, false, -100.0)
        );
    }
}

/// Version 2 draws the wind from a separate generator, so at wind power 0 the episode equals an
/// episode without wind. Version 3 draws the wind and then the engines' dispersion from one
/// generator.
#[test]
fn wind_draws_from_the_episode_since_version_3() {
    for (id, is_aside) in [("LunarLander-v2", true), ("LunarLander-v3", false)] {
        let calm = |wind: bool| {
            let env = builder(id).arg("enable_wind", wind).arg("wind_power", 0.0);
            after(
                &mut env.arg("turbulence_power", 0.0).build().unwrap(),
                &Value::Int(2),
                20,
            )
        };
        assert_eq!(calm(true) == calm(false), is_aside, "{id}");
    }
}

/// An episode that starts without wind has no position in the pattern of gusts, until wind blows.
#[test]
fn gusts_have_a_position_from_the_first_wind_on() {
    let mut lander = LunarLander::new(lunar_lander::Config::default()).unwrap();
    let position = |lander: &LunarLander| {
        let stored = serde_json::to_value(lander.snapshot().unwrap()).unwrap();
        stored["episode"]["wind_idx"].as_i64()
    };
    lander.reset(1).unwrap();
    assert_eq!(position(&lander), None);
    lander.set_argument("enable_wind", json!(true)).unwrap();
    lander
        .step(&lunar_lander::Action::Fire(lunar_lander::Engine::Off))
        .unwrap();
    assert_eq!(position(&lander), Some(1));
    lander.reset(1).unwrap();
    assert!(position(&lander).is_some_and(|position| position != 0));
}

#[test]
fn arguments_that_are_set_are_checked_as_those_of_a_new_environment() {
    let mut lander = LunarLander::new(lunar_lander::Config::default()).unwrap();
    let mut car = CarRacing::new(car_racing::Config::default()).unwrap();
    for (name, value) in [
        ("gravity", json!(0.5)),
        ("gravity", json!(-12.0)),
        ("wind_power", json!(1e7)),
        ("turbulence_power", json!(-1e7)),
        ("continuous", json!(true)),
        ("gravty", json!(-3.0)),
    ] {
        assert!(
            lander.set_argument(name, value.clone()).is_err(),
            "{name} = {value}"
        );
    }
    assert_eq!(
        *lander.config(),
        lunar_lander::Config::default(),
        "what is refused changes nothing"
    );
    lander.set_argument("gravity", json!(-3.0)).unwrap();
    assert_eq!(lander.config().gravity, -3.0);
    assert!(
        car.set_argument("lap_complete_percent", json!({"$float": "nan"}))
            .is_err()
    );
    assert!(car.set_argument("physics", json!("box2d")).is_err());
    car.set_argument("lap_complete_percent", json!(0.5))
        .unwrap();
    assert_eq!(car.config().lap_complete_percent, 0.5);
}

/// Motors reach their full power and cost at 1.
#[test]
fn a_walkers_motors_end_at_one() {
    let mut env = builder("BipedalWalker-v3")
        .disable_env_checker(true)
        .build()
        .unwrap();
    let ends = after(&mut env, &Value::from([1.0_f32, -1.0, 1.0, -1.0]), 20);
    assert_eq!(
        after(&mut env, &Value::from([2.0_f32, -9.0, 1.5, -1e6]), 20),
        ends
    );
    assert_ne!(
        after(&mut env, &Value::from([0.9_f32, -1.0, 1.0, -1.0]), 20),
        ends
    );
}

/// The gas is clipped to the range 0 to 1. Gymnasium clips neither steering nor brake.
#[test]
fn a_cars_gas_ends_at_one() {
    let after = |gas: f32| {
        let mut car = CarRacing::new(car_racing::Config::default()).unwrap();
        car.reset_state(&5.into()).unwrap();
        for _ in 0..30 {
            car.step_state(&[0.0, gas, 0.0].into()).unwrap();
        }
        serde_json::to_value(car.state()).unwrap()
    };
    assert_eq!(after(40.0), after(1.0));
    assert_eq!(after(-40.0), after(0.0));
    assert_ne!(after(0.5), after(1.0));
}

/// Drives a car without images for at most `most` steps. Returns the outcome of the step that ends
/// the episode.
fn drive(
    car: &mut CarRacing,
    most: usize,
    mut pedals: impl FnMut(&CarRacing, usize) -> [f32; 3],
) -> Option<Outcome> {
    (0..most)
        .map(|step| car.step_state(&pedals(car, step).into()).unwrap())
        .find(Outcome::done)
}

/// The playfield ends on all four sides.
#[test]
fn a_car_may_leave_the_field_on_no_side() {
    const FIELD: f64 = 2000.0 / 6.0; // m, from the middle to each side
    let mut sides = [0; 4];
    for turn in 0..12 {
        let mut car = CarRacing::new(car_racing::Config::default()).unwrap();
        car.reset_state(&3.into()).unwrap();
        let mut inside = true;
        let last = drive(&mut car, 3000, |car, step| {
            let [x, y, ..] = car.state().unwrap().hull;
            inside &= x.abs() <= FIELD && y.abs() <= FIELD;
            assert!(inside, "turn {turn}: it goes on at {x}, {y}");
            // a slow turn whose duration depends on the run, then straight on
            if step < 25 * turn {
                [0.6, 0.05, 0.0]
            } else {
                [0.0, 0.1, 0.0]
            }
        });
        let last = last.expect("it leaves");
        assert_eq!(
            (last.terminated, last.truncated, last.reward),
            (true, false, -100.0),
            "turn {turn}"
        );
        let [x, y, ..] = car.state().unwrap().hull;
        let beyond = [x > FIELD, x < -FIELD, y > FIELD, y < -FIELD];
        assert_eq!(
            beyond.iter().filter(|beyond| **beyond).count(),
            1,
            "turn {turn}: {x}, {y}"
        );
        sides
            .iter_mut()
            .zip(beyond)
            .for_each(|(side, beyond)| *side += usize::from(beyond));
    }
    assert!(
        !sides.contains(&0),
        "right, left, top and bottom: {sides:?}"
    );
}

/// A lap counts if more than the share `lap_complete_percent` of the tiles was visited. Version 2
/// truncates where version 3 terminates, and has no info.
#[test]
fn a_lap_needs_more_than_its_share() {
    let ends = |id: &str, percent: f64| {
        let mut env = builder(id)
            .arg("lap_complete_percent", percent)
            .build()
            .unwrap();
        env.reset(0).unwrap();
        let step = env.step(&Value::from([0.0_f32, 0.3, 0.0])).unwrap();
        (
            step.terminated,
            step.truncated,
            env.info_map().get("lap_finished").cloned(),
        )
    };
    let (tiles, visited) = {
        let mut car = CarRacing::new(car_racing::Config::default()).unwrap();
        car.reset_state(&0.into()).unwrap();
        (
            car.track().unwrap().len(),
            car.state().unwrap().tiles_visited,
        )
    };
    // the car starts on several tiles, one of which is the first of the track
    let share = |count: usize| count as f64 / tiles as f64;
    let goes_on = (false, false, None);
    let count = (0..)
        .find(|count| ends("CarRacing-v3", share(*count)) == goes_on)
        .expect("a share");
    assert!((1..=visited).contains(&count), "{count} of {visited}");
    let less = share(count).next_down();
    assert_eq!(
        ends("CarRacing-v3", less),
        (true, false, Some(Value::Bool(true)))
    );
    assert_eq!(ends("CarRacing-v2", less), (false, true, None));
    assert_eq!(ends("CarRacing-v2", share(count)), goes_on);
}

/// A car at the start that has visited some tiles, but not the first, with this share for a lap: in its next step the wheels
/// come onto the tiles beneath them, of which only the first is new.
fn before_the_first_tile(version: u32, visited: usize, percent: f64) -> CarRacing {
    /// Says that no bodies touch.
    fn lift(json: &mut Json) {
        match json {
            Json::Object(entries) => {
                if let Some(touching) = entries.get_mut("touching") {
                    *touching = json!(false);
                }
                entries.values_mut().for_each(lift);
            }
            Json::Array(items) => items.iter_mut().for_each(lift),
            _ => (),
        }
    }
    let mut car = CarRacing::with_version(car_racing::Config::default(), version).unwrap();
    car.reset_state(&0.into()).unwrap();
    let mut stored = json!(car.snapshot().unwrap());
    let episode = &mut stored["episode"];
    let tiles = episode["visited"].as_array_mut().unwrap();
    // (all tiles at the start, at either end of the list, but the first)
    let n = tiles.len();
    for (i, tile) in tiles.iter_mut().enumerate() {
        *tile = json!(i > 0 && (i <= visited - 10 || i >= n - 10));
    }
    episode["tile_visited_count"] = json!(visited);
    episode["lap_complete_percent"] = json!(percent);
    // the tiles of the start were paid for
    episode["reward"] = json!(0.0);
    lift(&mut episode["world"]);
    car.restore(&serde_json::from_value(stored).unwrap())
        .unwrap();
    car
}

/// The tile that is entered counts, whatever share a lap needs, and is paid for.
#[test]
fn the_first_tile_ends_a_lap_together_with_those_before() {
    for version in [2, 3] {
        for visited in [30, 100, 200] {
            let step = |percent: f64| {
                let mut car = before_the_first_tile(version, visited, percent);
                let tiles = car.track().unwrap().len() as f64;
                let outcome = car.step_state(&[0.0; 3].into()).unwrap();
                assert_eq!(car.state().unwrap().tiles_visited, visited + 1);
                let reward = 1000.0 / tiles - 0.1;
                assert!((outcome.reward - reward).abs() < 1e-9, "{outcome:?}");
                outcome.done()
            };
            let car = before_the_first_tile(version, visited, 0.5);
            let tiles = car.track().unwrap().len() as f64;
            let share = (visited + 1) as f64 / tiles;
            for (percent, ends) in [
                (share, false),
                (share.next_down(), true),
                (visited as f64 / tiles, true),
                ((visited + 2) as f64 / tiles, false),
                (0.0, true),
                (1.0, false),
            ] {
                assert_eq!(step(percent), ends, "{visited} of {tiles}, {percent}");
            }
        }
    }
}

/// Each step pays for the tiles that it visits, and costs 0.1; the first also pays for those of the reset.
#[test]
fn each_new_tile_is_paid_for_in_its_step() {
    for seed in [0, 1] {
        let mut car = CarRacing::new(car_racing::Config::default()).unwrap();
        car.reset_state(&seed.into()).unwrap();
        let (tiles, mut before) = (car.track().unwrap().len() as f64, 0);
        let mut paid = 0;
        for _ in 0..150 {
            let outcome = car.step_state(&[0.0, 0.3, 0.0].into()).unwrap();
            let now = car.state().unwrap().tiles_visited;
            let expected = (now - before) as f64 * 1000.0 / tiles - 0.1;
            assert!(
                (outcome.reward - expected).abs() < 1e-9,
                "{outcome:?}, {before} to {now}"
            );
            paid += usize::from(now > before);
            before = now;
        }
        assert!(paid > 5, "{paid}");
    }
}

/// If `lap_complete_percent` is above 1, the episode ends with the last tile.
#[test]
fn a_lap_is_over_when_every_tile_was_visited() {
    let config = car_racing::Config {
        lap_complete_percent: 2.0,
        ..Default::default()
    };
    let mut car = CarRacing::new(config).unwrap();
    car.reset_state(&0.into()).unwrap();
    let track: Vec<[f64; 2]> = car
        .track()
        .unwrap()
        .iter()
        .map(|point| [point.x, point.y])
        .collect();
    let (mut at, mut total) = (0, 0.0);
    let mut steps = 0;
    let last = (0..8000).find_map(|_| {
        let [x, y, angle, vx, vy, _] = car.state().unwrap().hull;
        let distance = |i: &usize| {
            let [px, py] = track[(at + i) % track.len()];
            (px - x).hypot(py - y)
        };
        at = (at
            + (0..20)
                .min_by(|a, b| distance(a).total_cmp(&distance(b)))
                .unwrap())
            % track.len();
        let [tx, ty] = track[(at + 4) % track.len()];
        let error = f64::atan2(-(tx - x), ty - y) - angle;
        let error = error.sin().atan2(error.cos());
        let gas = if vx.hypot(vy) < 25.0 { 0.2 } else { 0.0 };
        let outcome = car
            .step_state(&[(-1.5 * error).clamp(-1.0, 1.0) as f32, gas, 0.0].into())
            .unwrap();
        (total, steps) = (total + outcome.reward, steps + 1);
        outcome.done().then_some(outcome)
    });
    let last = last.expect("the lap ends");
    assert_eq!((last.terminated, last.truncated), (true, false));
    // the return is 1000 for all tiles (the first step pays for the tiles that the reset visits),
    // less 0.1 per step
    let missing = 1000.0 - 0.1 * f64::from(steps) - total;
    assert!(missing.abs() < 1e-6, "{total} in {steps} steps");
}

/// With `randomize: false`, the first colours come from a copy of the generator, so the track is
/// the same.
#[test]
fn colours_of_the_start_change_no_track() {
    let track = |domain_randomize: bool, reset: Reset| {
        let config = car_racing::Config {
            domain_randomize,
            ..Default::default()
        };
        let mut car = CarRacing::new(config).unwrap();
        car.reset_state(&reset).unwrap();
        car.track()
            .unwrap()
            .iter()
            .map(|point| [point.x, point.y])
            .collect::<Vec<_>>()
    };
    let plain = track(false, Reset::from(4));
    assert!(track(true, Reset::from(4).option("randomize", false)) == plain);
    assert!(
        track(true, Reset::from(4)) != plain,
        "colours are drawn before the track"
    );
    assert!(track(false, Reset::from(4).option("randomize", true)) == plain);
}

/// A reset that draws no colours keeps the colours of the last episode.
#[test]
fn colours_stay_where_none_are_drawn() {
    let config = car_racing::Config {
        domain_randomize: true,
        ..Default::default()
    };
    let mut car = CarRacing::new(config).unwrap();
    let mut colors = |reset: Reset| {
        car.reset_state(&reset).unwrap();
        json!(car.snapshot().unwrap())["episode"]["colors"].clone()
    };
    let first = colors(Reset::from(1));
    assert!(first["road"].is_array(), "{first}");
    assert_eq!(colors(Reset::from(2).option("randomize", false)), first);
    let second = colors(Reset::from(2));
    assert_ne!(second, first);
    assert_eq!(colors(Reset::from(3).option("randomize", false)), second);
}

/// A snapshot whose count of visited tiles differs from its list of tiles is an error.
#[test]
fn a_count_of_tiles_that_is_not_theirs_is_refused() {
    let mut car = CarRacing::new(car_racing::Config::default()).unwrap();
    car.reset_state(&0.into()).unwrap();
    let before = car.snapshot().unwrap();
    let count = car.state().unwrap().tiles_visited;
    assert!(count > 0);
    for (other, fits) in [(count, true), (count - 1, false), (count + 1, false)] {
        let mut stored = json!(before);
        assert_eq!(stored["episode"]["tile_visited_count"], count);
        stored["episode"]["tile_visited_count"] = other.into();
        let stored = serde_json::from_value(stored).unwrap();
        assert_eq!(car.restore(&stored).is_ok(), fits, "{other} for {count}");
        assert_eq!(car.snapshot().unwrap(), before);
    }
}

/// A restored lander simulates exhaust only if it renders, whether or not the snapshot's lander
/// did.
#[test]
fn exhaust_is_there_for_who_renders() {
    let lander = |renders: bool| {
        let mut lander = LunarLander::new(lunar_lander::Config::default()).unwrap();
        if renders {
            lander.frames_drawn(0);
        }
        lander.reset(5).unwrap();
        lander.step(&lunar_lander::Engine::Main.into()).unwrap();
        lander
    };
    let exhaust = |lander: &LunarLander| {
        let stored = json!(lander.snapshot().unwrap());
        !stored["episode"]["exhaust"].is_null()
    };
    for from in [false, true] {
        for to in [false, true] {
            let (source, mut target) = (lander(from), lander(to));
            assert_eq!(exhaust(&source), from);
            target.restore(&source.snapshot().unwrap()).unwrap();
            assert_eq!(exhaust(&target), to, "from {from} to {to}");
        }
    }
}

/// Without wind, every id of version 2 plays like the id of version 3.
#[test]
fn versions_of_a_lander_fall_alike() {
    let fall = |id: &str| after(&mut make(id).unwrap(), &Value::Int(0), 30);
    assert_eq!(fall("LunarLander-v2"), fall("LunarLander-v3"));
}
