//! Worlds as text, and stored worlds: every part of one that no episode has is refused.

use std::collections::BTreeSet;

use gym_core::render::{RenderMode, Rendered};
use gym_core::{BoxEnv, Env, EnvExt, Space, Value, builder, make, registry};
use gym_minigrid::{Cell, Color, Kind, Pos, State, World};
use serde_json::{Value as Json, json};

/// Tasks with targets, places, boxes with something in them, an object that is carried from the start, and
/// instructions of each kind.
const IDS: [&str; 9] = [
    "MiniGrid-Fetch-5x5-N2-v0",
    "MiniGrid-PutNear-6x6-N2-v0",
    "MiniGrid-ObstructedMaze-1Dlh-v0",
    "BabyAI-GoToObj-v0",
    "BabyAI-OpenDoor-v0",
    "BabyAI-PickupLoc-v0",
    "BabyAI-PutNextS5N2Carrying-v0",
    "BabyAI-OpenTwoDoors-v0",
    "BabyAI-MoveTwoAcrossS5N2-v0",
];

/// Changes of a part of a stored world, each with its path.
fn damages(json: &Json, key: &str, path: &str, found: &mut Vec<(String, Json)>) {
    match json {
        Json::Object(entries) if entries.len() == 2 && entries.contains_key("x") => {
            let far = [
                json!({"x": 300, "y": 1}),
                json!({"x": 1, "y": 300}),
                json!({"x": -2, "y": 1}),
            ];
            found.extend(far.map(|place| (path.to_owned(), place)));
        }
        Json::Object(entries) => {
            for (key, json) in entries {
                damages(json, key, &format!("{path}/{key}"), found);
            }
        }
        Json::Array(items) => {
            let ends = BTreeSet::from([0, items.len().saturating_sub(1)]);
            for (at, json) in ends.into_iter().filter_map(|at| Some((at, items.get(at)?))) {
                damages(json, key, &format!("{path}/{at}"), found);
            }
        }
        Json::Number(number) => {
            // of a cell, the lowest byte is the kind, then four bits of colour and of state, and the object's number
            let number = number.as_u64().unwrap_or(0);
            let others = match key {
                "cells" | "targets" | "carrying" | "pending" | "content" | "before" => vec![
                    number & !0xff,
                    number & !0xff | 10,
                    number & !0xf00 | 6 << 8,
                    number & !0xf000 | 3 << 12,
                    number & 0xffff | 60_000 << 16,
                ],
                "objects" => vec![60_000],
                "direction" => vec![4],
                "max_steps" => vec![0],
                "width" | "height" => vec![0, number + 1],
                _ => Vec::new(),
            };
            found.extend(others.iter().map(|other| (path.to_owned(), json!(other))));
        }
        _ => {}
    }
}

#[test]
fn every_part_of_a_stored_world_is_checked() {
    let (mut paths, mut count) = (BTreeSet::new(), 0);
    for id in IDS {
        let mut env = make(id).unwrap();
        for seed in 0..4 {
            env.reset(seed).unwrap();
            // (a state that is shown has begun: nothing is pending)
            let stored = serde_json::to_value(env.snapshot().unwrap()).unwrap();
            let state = world(&stored).clone();
            let mut found = Vec::new();
            damages(&state, "", "", &mut found);
            for (path, other) in found {
                let mut damaged = state.clone();
                *damaged.pointer_mut(&path).unwrap() = other.clone();
                let inspected = env.inspect_mut().unwrap();
                assert!(
                    inspected.set_state(damaged).is_err(),
                    "{id}: {path} {other}"
                );
                paths.insert(path.replace(|c: char| c.is_ascii_digit(), ""));
                count += 1;
            }
            let after = serde_json::to_value(env.snapshot().unwrap()).unwrap();
            assert_eq!(after, stored, "{id}");
            env.inspect_mut().unwrap().set_state(state).unwrap();
        }
    }
    assert!(paths.len() > 15 && count > 500, "{count}: {paths:#?}");
}

/// The world in a snapshot, which wrappers surround by lists.
fn world(stored: &Json) -> &Json {
    let mut inner = stored;
    while inner.is_array() {
        inner = &inner[0];
    }
    &inner["episode"]["world"]
}

/// The two letters of a cell, as `pprint_grid` of minigrid documents them.
fn letters(cell: Cell) -> String {
    let kind = match cell.kind() {
        Kind::Empty => return "  ".to_owned(),
        Kind::Door if cell.is_door(State::Open) => return "__".to_owned(),
        Kind::Door if cell.is_door(State::Locked) => 'L',
        Kind::Door => 'D',
        Kind::Wall => 'W',
        Kind::Floor => 'F',
        Kind::Key => 'K',
        Kind::Ball => 'A',
        Kind::Box => 'B',
        Kind::Goal => 'G',
        Kind::Lava => 'V',
        other => panic!("{other:?}"),
    };
    let color = match cell.color() {
        Color::Red => 'R',
        Color::Green => 'G',
        Color::Blue => 'B',
        Color::Purple => 'P',
        Color::Yellow => 'Y',
        Color::Grey => 'G',
    };
    [kind, color].iter().collect()
}

fn text(env: &mut BoxEnv) -> String {
    match env.render().unwrap() {
        Rendered::Text(text) => text,
        other => panic!("{other:?}"),
    }
}

/// Row by row, two letters for each cell, and then the mission.
#[test]
fn a_world_as_text_shows_every_cell_in_its_place() {
    let (mut kinds, mut lopsided) = (BTreeSet::new(), 0);
    for registration in registry::all() {
        let id = registration.id();
        let mut env = builder(id).render_mode(RenderMode::Ansi).build().unwrap();
        env.reset(1).unwrap();
        for action in [1, 2, 5] {
            let Space::Discrete(actions) = env.action_space() else {
                panic!("{id}");
            };
            env.step(&Value::Int(action % actions.n())).unwrap();
        }
        let shown = text(&mut env);
        let world = env.layer::<World>().unwrap();
        let arrow = [">>", "VV", "<<", "^^"][usize::from(world.direction)];
        let mut expected = String::new();
        for y in 0..world.grid.height() {
            for x in 0..world.grid.width() {
                let (pos, mirrored) = (Pos::new(x, y), Pos::new(y, x));
                let cell = world.grid.get(pos);
                lopsided += u32::from(cell != world.grid.get(mirrored));
                expected += &if pos == world.agent {
                    arrow.to_owned()
                } else {
                    letters(cell)
                };
                kinds.insert(letters(cell));
            }
            expected.push('\n');
        }
        assert_eq!(shown, expected + &world.mission, "{id}");
    }
    assert!(kinds.len() > 20 && lopsided > 1000, "{lopsided} {kinds:?}");
}

/// A key is named after the action that it means, and there is one for each action of the space.
#[test]
fn keys_are_those_of_the_actions() {
    let names = [
        ("Left", "Left"),
        ("Right", "Right"),
        ("Up", "Forward"),
        ("P", "Pickup"),
        ("D", "Drop"),
        ("Space", "Toggle"),
        ("Enter", "Done"),
    ];
    for registration in registry::all() {
        let env = make(registration.id()).unwrap();
        let Space::Discrete(actions) = env.action_space() else {
            panic!("{}", registration.id());
        };
        let keys = registration.page.keys.unwrap()(&env);
        let expected: Vec<_> = names
            .iter()
            .take(actions.n() as usize)
            .map(|(key, action)| {
                let index = registration
                    .page
                    .actions
                    .iter()
                    .position(|(name, _)| name == action);
                ((*key).to_owned(), json!(index.unwrap()))
            })
            .collect();
        let mut found = keys.actions;
        found.sort_by_key(|(_, action)| action.as_u64());
        assert_eq!(found, expected, "{}", registration.id());
    }
}

/// What an argument without a value is by default is a part of what a snapshot must have.
#[test]
fn sight_through_walls_is_as_the_task_has_it_unless_given() {
    for (id, default) in [
        ("MiniGrid-Empty-5x5-v0", true),
        ("MiniGrid-MultiRoom-N2-S4-v0", false),
    ] {
        let made = |given: Option<bool>| {
            let mut env = builder(id).arg("see_through_walls", given).build().unwrap();
            env.reset(2).unwrap();
            env
        };
        let arguments = |env: &BoxEnv| env.inspect().unwrap().arguments();
        let plain = made(None);
        assert_eq!(
            arguments(&plain)["see_through_walls"],
            json!(default),
            "{id}"
        );
        for given in [default, !default] {
            let mut env = made(Some(given));
            assert_eq!(
                arguments(&env) == arguments(&plain),
                given == default,
                "{id}"
            );
            let restored = env.restore(&plain.snapshot().unwrap());
            assert_eq!(restored.is_ok(), given == default, "{id}: {given}");
        }
    }
}
