//! Stored episodes in which one part is another.
//!
//! After an intended change, store what is taken with
//! `GYM_UPDATE_KEPT=1 cargo test --package gym-box2d --test it damaged`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use gym_box2d as _;
use gym_core::{Env, EnvExt, Snapshot, make};
use gym_testing::kept;
use serde_json::{Value as Json, json};

/// What takes the place of a part.
fn others() -> impl Iterator<Item = Json> {
    let numbers = [json!(99), json!(1e30)];
    numbers
        .into_iter()
        .chain([json!(null), json!(true), json!(false), json!([])])
}

/// The first and the last place of the parts of each name.
fn places(stored: &Json, name: &str, found: &mut BTreeMap<String, [String; 2]>) {
    fn visit(json: &Json, place: &str, name: &str, found: &mut BTreeMap<String, [String; 2]>) {
        match json {
            Json::Array(items) if !items.is_empty() => {
                for (i, item) in items.iter().enumerate() {
                    visit(item, &format!("{place}/{i}"), name, found);
                }
            }
            Json::Object(parts) => {
                for (part, json) in parts {
                    visit(
                        json,
                        &format!("{place}/{part}"),
                        &format!("{name} {part}"),
                        found,
                    );
                }
            }
            _ => {
                let places = found.entry(name.to_owned());
                let [_, last] = places.or_insert_with(|| [(); 2].map(|()| place.to_owned()));
                place.clone_into(last);
            }
        }
    }
    visit(stored, "", name, found);
}

/// A part that is not there, a number that no episode has, and a part of another kind are refused. What
/// may be another is told, and such an episode goes on.
#[test]
fn what_may_be_another_in_a_stored_episode_is_known() {
    let mut told = String::new();
    // a lander that flies, and a walker and a car on the ground
    for id in ["LunarLander-v3", "BipedalWalker-v3", "CarRacing-v3"] {
        tell(id, &mut told);
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    kept(&folder.join("tests/it/damaged.txt"), &told);
}

fn tell(id: &str, told: &mut String) {
    let mut env = make(id).unwrap();
    env.reset(3).unwrap();
    let mut actions = env.action_sampler(0).unwrap();
    for _ in 0..20 {
        env.step(&actions.sample()).unwrap();
    }
    let stored = serde_json::to_value(env.snapshot().unwrap()).unwrap();
    let mut found = BTreeMap::new();
    places(&stored, id, &mut found);
    for (name, places) in found {
        let mut taken = BTreeSet::new();
        for (place, other) in places
            .iter()
            .flat_map(|place| others().map(move |o| (place, o)))
        {
            let mut damaged = stored.clone();
            let part = damaged.pointer_mut(place).unwrap();
            if *part == other {
                continue;
            }
            *part = other.clone();
            let snapshot = serde_json::from_value::<Snapshot>(damaged).unwrap();
            if env.restore(&snapshot).is_ok() {
                taken.insert(other.to_string());
                for _ in 0..2 {
                    let _ = env.step(&actions.sample());
                }
            }
        }
        *told += &format!("{name}: {}\n", Vec::from_iter(taken).join(" "));
    }
}
