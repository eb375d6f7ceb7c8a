//! Arguments that are possible, and the words of those that are not.

use gym_core::{Env, EnvExt, Error, builder, make, registry};
use serde_json::json;

#[test]
fn bad_arguments_are_refused() {
    for (id, name, value, reason) in [
        (
            "MiniGrid-Empty-5x5-v0",
            "size",
            json!(2),
            "the grid has 2 by 2 cells",
        ),
        (
            "MiniGrid-Empty-5x5-v0",
            "size",
            json!(4_000_000_000_u32),
            "from 3 to 255",
        ),
        (
            "MiniGrid-Empty-5x5-v0",
            "agent_view_size",
            json!(8),
            "agent_view_size is 8: it is an odd",
        ),
        (
            "MiniGrid-Empty-5x5-v0",
            "max_steps",
            json!(0),
            "at least one step",
        ),
        (
            "MiniGrid-Empty-5x5-v0",
            "tile_size",
            json!(0),
            "tile_size is 0",
        ),
        (
            "MiniGrid-Empty-5x5-v0",
            "tile_size",
            json!(1_000_000),
            "tile_size is 1000000",
        ),
        (
            "MiniGrid-Empty-5x5-v0",
            "agent_start_dir",
            json!(4),
            "agent_start_dir is 4",
        ),
        (
            "MiniGrid-LavaCrossingS9N1-v0",
            "size",
            json!(8),
            "size is 8: it is an odd number",
        ),
        (
            "MiniGrid-LavaCrossingS9N1-v0",
            "obstacle_type",
            json!("water"),
            "unknown variant",
        ),
        (
            "MiniGrid-KeyCorridorS3R1-v0",
            "obj_type",
            json!("wall"),
            "`key`, `ball` or `box`",
        ),
        (
            "MiniGrid-MultiRoom-N6-v0",
            "maxRoomSize",
            json!(3),
            "from 4 to 255",
        ),
        (
            "MiniGrid-PutNear-6x6-N2-v0",
            "numObjs",
            json!(1),
            "at least 2",
        ),
        (
            "BabyAI-GoToLocal-v0",
            "room_size",
            json!(2),
            "rooms of size 2",
        ),
        (
            "BabyAI-OpenDoorsOrderN2-v0",
            "num_doors",
            json!(5),
            "from 2 to 4",
        ),
    ] {
        let error = builder(id)
            .arg(name, value)
            .build()
            .unwrap_err()
            .to_string();
        assert!(error.contains(reason), "{id}: {error}");
    }
}

/// A reset without room for an object or the agent is an error. (In minigrid, the reset never
/// ends.)
#[test]
fn a_grid_without_room_is_an_error() {
    for (id, name, value) in [
        ("MiniGrid-Fetch-5x5-N2-v0", "numObjs", json!(9)),
        ("MiniGrid-GoToObject-6x6-N2-v0", "numObjs", json!(19)),
        ("MiniGrid-Empty-5x5-v0", "agent_start_pos", json!([0, 0])),
        ("BabyAI-GoToLocal-v0", "num_dists", json!(60)),
        ("BabyAI-OpenDoor-v0", "num_rows", json!(1)),
    ] {
        let mut env = builder(id).arg(name, value).build().unwrap();
        let error = env.reset(0).unwrap_err().to_string();
        assert!(error.contains("invalid argument"), "{id}: {error}");
    }
}

#[test]
fn a_level_that_cannot_be_says_what_would_help() {
    for (id, name, value, says) in [
        (
            "BabyAI-GoToLocal-v0",
            "num_dists",
            0,
            "there is nothing to choose from; set `num_dists` to 1",
        ),
        (
            "MiniGrid-Dynamic-Obstacles-8x8-v0",
            "size",
            3,
            "no free place was found; set `n_obstacles` to 0, or `size` to 4",
        ),
        (
            "MiniGrid-Fetch-5x5-N2-v0",
            "numObjs",
            10,
            "no level fits the arguments; set `numObjs` to 8, or `size` to 6",
        ),
        (
            "MiniGrid-RedBlueDoors-6x6-v0",
            "size",
            2,
            "from 3 to 255 each are possible; set `size` to 3",
        ),
    ] {
        let made = builder(id).arg(name, value).build();
        let error = made.and_then(|mut env| env.reset(0)).unwrap_err();
        assert!(error.to_string().ends_with(says), "{id}: {error}");
    }
}

/// What a level's refusal advises helps: each whole number at its lowest values, for each level.
#[test]
fn the_lowest_values_are_possible_or_the_next_that_are_named() {
    let play = |id: &str, name: &str, value: u64, seed| {
        let made = builder(id).arg(name, value).build();
        made.and_then(|mut env| env.reset(seed))
    };
    let (mut levels, mut refused) = (std::collections::BTreeSet::new(), 0);
    for registration in registry::all() {
        let (id, env) = (registration.id(), make(registration.id()).unwrap());
        let shared = [
            "max_steps",
            "agent_view_size",
            "tile_size",
            "screen_size",
            "agent_start_dir",
        ];
        for argument in registration.arguments().unwrap() {
            let name = argument.name;
            let level = (env.describe(), name);
            if argument.kind != "integer" || shared.contains(&name) || !levels.insert(level) {
                continue;
            }
            for value in 0..4 {
                let Err(error) = play(id, name, value, 0) else {
                    continue;
                };
                refused += 1;
                let error = error.to_string();
                let names = format!("`{name}` to ");
                let Some((_, least)) = error.split_once(&names) else {
                    panic!("{id}, {name} {value}: {error}");
                };
                let digits = least.find(|c: char| !c.is_ascii_digit());
                let least: u64 = least[..digits.unwrap_or(least.len())].parse().unwrap();
                for seed in 0..2 {
                    let helped = play(id, name, least, seed);
                    assert!(helped.is_ok(), "{id}, {name} {value}: {error}; {helped:?}");
                }
            }
        }
    }
    assert!(
        levels.len() > 60 && refused > 60,
        "{refused} {}",
        levels.len()
    );
}

/// Each limit of an argument: the values at its ends are possible, those beyond them are not.
#[test]
fn arguments_are_possible_up_to_their_limits() {
    let any = "MiniGrid-Empty-5x5-v0";
    let door = "MiniGrid-GoToDoor-5x5-v0";
    let maze = "MiniGrid-ObstructedMaze-Full-v1";
    let rooms = "MiniGrid-MultiRoom-N2-S4-v0";
    for (id, name, good, bad) in [
        (any, "size", json!([3, 255]), json!([2, 256])),
        (any, "agent_start_dir", json!([0, 3]), json!([4, -1])),
        (
            any,
            "agent_view_size",
            json!([3, 63]),
            json!([1, 2, 4, 62, 64, 65]),
        ),
        (any, "max_steps", json!([1, 1_000_000]), json!([0, -1])),
        (door, "size", json!([5, 255]), json!([4, 256])),
        (
            "MiniGrid-LavaGapS5-v0",
            "size",
            json!([5, 255]),
            json!([4, 256]),
        ),
        (
            "MiniGrid-LavaCrossingS9N1-v0",
            "size",
            json!([3, 255]),
            json!([2, 8, 256]),
        ),
        (
            "MiniGrid-MemoryS7-v0",
            "size",
            json!([7, 255]),
            json!([5, 8, 257]),
        ),
        (
            "MiniGrid-PutNear-6x6-N2-v0",
            "numObjs",
            json!([2]),
            json!([0, 1]),
        ),
        (rooms, "maxRoomSize", json!([4, 255]), json!([3, 256])),
        (rooms, "minNumRooms", json!([1, 2]), json!([0, 3])),
        (rooms, "maxNumRooms", json!([2, 1000]), json!([1, 1001])),
        (
            "MiniGrid-KeyCorridorS3R1-v0",
            "obj_type",
            json!(["key", "ball", "box"]),
            json!(["door", "wall", "goal"]),
        ),
        (
            maze,
            "agent_room",
            json!([[0, 0], [2, 2]]),
            json!([[3, 0], [0, 3], [1]]),
        ),
        (maze, "num_quarters", json!([1, 4]), json!([0, 5])),
        (maze, "num_rooms_visited", json!([1, 25]), json!([0])),
        (
            "BabyAI-OpenDoorsOrderN2-v0",
            "num_doors",
            json!([2, 4]),
            json!([1, 5]),
        ),
        (
            "BabyAI-PutNextLocal-v0",
            "num_objs",
            json!([2, 18]),
            json!([1, 19]),
        ),
        (
            "BabyAI-PutNextS5N2-v0",
            "objs_per_room",
            json!([1, 9]),
            json!([0, 10]),
        ),
        (
            "BabyAI-MoveTwoAcrossS5N2-v0",
            "objs_per_room",
            json!([2, 9]),
            json!([1, 10]),
        ),
        (
            "BabyAI-GoToObj-v0",
            "room_size",
            json!([4, 255]),
            json!([2, 256]),
        ),
    ] {
        let made = |value: &serde_json::Value| builder(id).arg(name, value.clone()).build();
        for value in good.as_array().unwrap() {
            let made = made(value).map(drop);
            assert!(made.is_ok(), "{id}: {name} {value}: {made:?}");
        }
        for value in bad.as_array().unwrap() {
            let error = made(value)
                .map(drop)
                .expect_err(&format!("{id}: {name} {value}"));
            assert!(matches!(error, Error::InvalidArgument { .. }), "{error:?}");
        }
    }
}
