//! Compares the starts of seeds, and whole episodes of a policy, in the Box2D environments with
//! Gymnasium's. `parity.rs` compares their traces step by step.

use std::f64::consts::PI;

use gym::box2d::{BipedalWalker, CarRacing, LunarLander, bipedal_walker, car_racing, lunar_lander};
use gym::{BoxEnv, Element, EnvExt, Value};
use gym_tests::{Reference, references};
use serde_json::{Value as Json, json};

fn make(json: &Json) -> BoxEnv {
    let id = json["id"].as_str().expect("an id");
    gym::builder(id)
        .args(json["kwargs"].as_object().cloned().unwrap_or_default())
        .build()
        .expect("an environment")
}

/// Compares terrain, helipad and track.
#[test]
fn starts() {
    for Reference { name, json, .. } in references() {
        let Some(start) = json.get("start") else {
            continue;
        };
        let mut env = make(&json);
        env.reset(json["seed"].as_u64().expect("a seed"))
            .expect("a reset");
        if let Some(lander) = env.layer::<LunarLander>() {
            let heights = lander.terrain().expect("reset");
            for (i, edge) in start["smooth_terrain"]
                .as_array()
                .expect("edges")
                .iter()
                .enumerate()
            {
                assert_eq!(edge[1].as_f64(), Some(heights[i]), "{name}: height {i}");
            }
            assert_eq!(
                start["helipad_y"].as_f64(),
                Some(lunar_lander::HELIPAD_Y),
                "{name}"
            );
        } else if let Some(walker) = env.layer::<BipedalWalker>() {
            assert_eq!(&json!(walker.terrain()), &start["terrain_y"], "{name}");
        } else if let Some(car) = env.layer::<CarRacing>() {
            let track = car.track().expect("reset");
            for (i, (p, expected)) in track
                .iter()
                .zip(start["track"].as_array().expect("tiles"))
                .enumerate()
            {
                assert_eq!(
                    json!([p.beta, p.x, p.y]),
                    json!(&expected.as_array().expect("four")[1..]),
                    "{name}"
                );
                // alpha is an arc tangent, which is correctly rounded here, but not always in the C
                // library with which Gymnasium was recorded
                let alpha = expected[0].as_f64().expect("a number");
                assert!(
                    [alpha.next_down(), alpha, alpha.next_up()].contains(&p.alpha),
                    "{name}: tile {i}"
                );
            }
            assert_eq!(start["tiles"].as_u64(), Some(track.len() as u64), "{name}");
        } else {
            panic!("{name}: nothing here knows its start");
        }
    }
}

#[test]
fn outcomes() {
    for Reference { name, json, .. } in references() {
        for episode in json["episodes"].as_array().into_iter().flatten() {
            let seed = episode["seed"].as_u64().expect("a seed");
            let (episode_return, length) = match json["policy"].as_str() {
                Some("follow") => follow(seed),
                Some(policy) => play(&json, policy, seed),
                None => panic!("{name}: no policy"),
            };
            assert_eq!(
                episode["return"].as_f64(),
                Some(episode_return),
                "{name}, seed {seed}"
            );
            assert_eq!(
                episode["length"].as_u64(),
                Some(length),
                "{name}, seed {seed}"
            );
        }
    }
}

/// Plays one episode of a new environment, and returns the return and the length.
fn play(json: &Json, policy: &str, seed: u64) -> (f64, u64) {
    let mut env = make(json);
    let mut actions = env.action_sampler(seed).expect("actions");
    let mut gait = bipedal_walker::Heuristic::default();
    let continuous = json["kwargs"]["continuous"] == true;
    let lander = env.layer::<LunarLander>().is_some();
    let mut heuristic = |observation: &Value| {
        let seen: &[f32] = observation.as_slice().expect("numbers");
        match lander {
            true => {
                lunar_lander::heuristic(seen.try_into().expect("8 numbers"), continuous).to_value()
            }
            false => gait.act(seen.try_into().expect("24 numbers")).to_value(),
        }
    };
    let mut observation = env.reset(seed).expect("a reset");
    let (mut total, mut length) = (0.0, 0);
    loop {
        let action = match policy {
            "random" => actions.sample(),
            "heuristic" => heuristic(&observation),
            other => panic!("nothing here plays the policy `{other}`"),
        };
        let step = env.step(&action).expect("a step");
        total += step.reward;
        length += 1;
        if step.done() {
            return (total, length);
        }
        observation = step.observation;
    }
}

/// Drives a lap towards the track point six tiles ahead.
fn follow(seed: u64) -> (f64, u64) {
    let mut env = CarRacing::new(car_racing::Config::default()).expect("default arguments");
    env.reset_state(&seed.into()).expect("a reset");
    let track: Vec<[f64; 2]> = env
        .track()
        .expect("reset")
        .iter()
        .map(|p| [p.x, p.y])
        .collect();
    let (mut total, mut length, mut i) = (0.0, 0, 0);
    loop {
        let [x, y, angle, vx, vy, _] = env.state().expect("reset").hull;
        let distance = |j: &usize| {
            let [px, py] = track[(i + j) % track.len()];
            (px - x) * (px - x) + (py - y) * (py - y)
        };
        let nearest = (0..40)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("points");
        i = (i + nearest) % track.len();
        let [tx, ty] = track[(i + 6) % track.len()];
        let error = (f64::atan2(-(tx - x), ty - y) - angle + PI).rem_euclid(2.0 * PI) - PI;
        let speed = f64::hypot(vx, vy);
        let pedals = [
            (-1.5 * error).clamp(-1.0, 1.0),
            if speed < 40.0 { 0.4 } else { 0.0 },
            if speed > 60.0 { 0.3 } else { 0.0 },
        ];
        let outcome = env
            .step_state(&pedals.map(|pedal| pedal as f32).into())
            .expect("a step");
        total += outcome.reward;
        length += 1;
        if outcome.done() || length >= 1000 {
            return (total, length);
        }
    }
}
