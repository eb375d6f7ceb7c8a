//! The cells that the agent sees, compared with an implementation like minigrid's `process_vis`.

use gym_core::{Env, EnvExt, builder};
use gym_minigrid::{Pos, World};

/// Whether the agent sees each cell of its view, by column and row.
fn visible(world: &World, size: i32) -> Vec<Vec<bool>> {
    let forward = [
        Pos::new(1, 0),
        Pos::new(0, 1),
        Pos::new(-1, 0),
        Pos::new(0, -1),
    ][usize::from(world.direction)];
    let right = Pos::new(-forward.y, forward.x);
    let corner = world.agent + forward * (size - 1) - right * (size / 2);
    let clear = |i: usize, j: usize| {
        let pos = corner - forward * j as i32 + right * i as i32;
        world.grid.get(pos).see_behind()
    };
    let size = size as usize;
    let mut seen = vec![vec![false; size]; size];
    seen[size / 2][size - 1] = true;
    for j in (0..size).rev() {
        for i in 0..size - 1 {
            if seen[i][j] && clear(i, j) {
                seen[i + 1][j] = true;
                if j > 0 {
                    (seen[i + 1][j - 1], seen[i][j - 1]) = (true, true);
                }
            }
        }
        for i in (1..size).rev() {
            if seen[i][j] && clear(i, j) {
                seen[i - 1][j] = true;
                if j > 0 {
                    (seen[i - 1][j - 1], seen[i][j - 1]) = (true, true);
                }
            }
        }
    }
    seen
}

#[test]
fn bits_see_what_cells_see() {
    for (id, size) in [
        ("MiniGrid-Playground-v0", 3),
        ("MiniGrid-Playground-v0", 7),
        ("MiniGrid-FourRooms-v0", 15),
        ("MiniGrid-MultiRoom-N6-v0", 9),
        ("BabyAI-GoToOpen-v0", 63),
        ("BabyAI-BossLevel-v0", 5),
    ] {
        let mut env = builder(id).arg("agent_view_size", size).build().unwrap();
        let mut actions = env.action_space().sampler(size as u64);
        let mut observation = env.reset(size as u64).unwrap();
        for step in 0..200 {
            let image = observation.get("image").unwrap().as_slice::<u8>().unwrap();
            let kinds: Vec<u8> = image.iter().copied().step_by(3).collect();
            let seen = visible(env.layer::<World>().unwrap(), size).concat();
            let agrees = kinds
                .iter()
                .zip(&seen)
                .all(|(kind, seen)| (*kind > 0) == *seen);
            assert!(agrees, "{id}, step {step}");
            let after = env.step(&actions.sample()).unwrap();
            observation = after.observation;
            if after.terminated || after.truncated {
                observation = env.reset(()).unwrap();
            }
        }
    }
}
