//! Which pages there are, and what each shows.

use std::ops::Range;

/// One environment: a source file, under one or more names.
pub(super) struct Page {
    /// Of the file.
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    /// Names in ids that belong here, whatever their version and namespace.
    pub(super) ids: &'static [&'static str],
    pub(super) source: &'static str,
    /// Where the types are.
    pub(super) module: &'static str,
    /// The enum of discrete actions, if there is one.
    pub(super) actions: Option<&'static str>,
    /// What the good policy is.
    pub(super) heuristic: &'static str,
    pub(super) clip: Clip,
}

/// What the GIF shows.
pub(super) struct Clip {
    pub(super) id: &'static str,
    pub(super) seeds: Range<u64>,
    /// Every n-th state is a frame.
    pub(super) every: u32,
    /// Frames at most.
    pub(super) frames: u32,
    pub(super) size: (u32, u32),
}

/// In the order of the book.
pub(super) const PAGES: [Page; 12] = [
    Page {
        name: "cartpole",
        title: "CartPole",
        ids: &["CartPole"],
        source: "crates/gym-classic/src/cartpole.rs",
        module: "classic::cartpole",
        actions: Some("enum Action"),
        heuristic: "pushes to the side that a weighted sum of the four numbers calls for",
        clip: Clip { id: "CartPole-v1", seeds: 3..4, every: 3, frames: 60, size: (300, 200) },
    },
    Page {
        name: "mountain-car",
        title: "MountainCar",
        ids: &["MountainCar"],
        source: "crates/gym-classic/src/mountain_car.rs",
        module: "classic::mountain_car",
        actions: Some("enum Action"),
        heuristic: "drives right while the velocity lies between two curves over the position, else left",
        clip: Clip { id: "MountainCar-v0", seeds: 0..1, every: 2, frames: 80, size: (300, 200) },
    },
    Page {
        name: "mountain-car-continuous",
        title: "MountainCarContinuous",
        ids: &["MountainCarContinuous"],
        source: "crates/gym-classic/src/mountain_car_continuous.rs",
        module: "classic::mountain_car_continuous",
        actions: None,
        heuristic: "drives along with the velocity, with force 0.4",
        clip: Clip { id: "MountainCarContinuous-v0", seeds: 0..1, every: 3, frames: 100, size: (300, 200) },
    },
    Page {
        name: "pendulum",
        title: "Pendulum",
        ids: &["Pendulum"],
        source: "crates/gym-classic/src/pendulum.rs",
        module: "classic::pendulum",
        actions: None,
        heuristic: "adds energy until the pole is near the top, then holds it there with a PD controller",
        clip: Clip { id: "Pendulum-v1", seeds: 5..6, every: 2, frames: 80, size: (200, 200) },
    },
    Page {
        name: "acrobot",
        title: "Acrobot",
        ids: &["Acrobot"],
        source: "crates/gym-classic/src/acrobot.rs",
        module: "classic::acrobot",
        actions: Some("enum Action"),
        heuristic: "pushes the lower link along with its own motion",
        clip: Clip { id: "Acrobot-v1", seeds: 5..6, every: 1, frames: 100, size: (200, 200) },
    },
    Page {
        name: "lunar-lander",
        title: "LunarLander",
        ids: &["LunarLander", "LunarLanderContinuous"],
        source: "crates/gym-box2d/src/lunar_lander.rs",
        module: "box2d::lunar_lander",
        actions: Some("enum Engine"),
        heuristic: "is Gymnasium's own controller, `lunar_lander::heuristic`",
        clip: Clip { id: "LunarLander-v3", seeds: 0..1, every: 4, frames: 100, size: (300, 200) },
    },
    Page {
        name: "bipedal-walker",
        title: "BipedalWalker",
        ids: &["BipedalWalker", "BipedalWalkerHardcore"],
        source: "crates/gym-box2d/src/bipedal_walker.rs",
        module: "box2d::bipedal_walker",
        actions: None,
        heuristic: "is Gymnasium's own controller, `bipedal_walker::Heuristic`; it falls in most episodes",
        clip: Clip { id: "BipedalWalker-v3", seeds: 0..1, every: 4, frames: 100, size: (300, 200) },
    },
    Page {
        name: "car-racing",
        title: "CarRacing",
        ids: &["CarRacing"],
        source: "crates/gym-box2d/src/car_racing/mod.rs",
        module: "box2d::car_racing",
        actions: Some("enum Drive"),
        heuristic: "steers towards a point of the track ahead at a moderate speed; it reads the track from the environment, not from the picture, and finishes no lap within the limit",
        clip: Clip { id: "CarRacing-v3", seeds: 1..2, every: 6, frames: 60, size: (300, 200) },
    },
    Page {
        name: "blackjack",
        title: "Blackjack",
        ids: &["Blackjack"],
        source: "crates/gym-toytext/src/blackjack.rs",
        module: "toytext::blackjack",
        actions: Some("enum Action"),
        heuristic: "is the basic strategy of Sutton and Barto's figure 5.2",
        clip: Clip { id: "Blackjack-v1", seeds: 0..12, every: 1, frames: 24, size: (192, 188) },
    },
    Page {
        name: "cliff-walking",
        title: "CliffWalking",
        ids: &["CliffWalking", "CliffWalkingSlippery"],
        source: "crates/gym-toytext/src/cliff_walking.rs",
        module: "toytext::cliff_walking",
        actions: Some("enum Action"),
        heuristic: "is the best one, found by value iteration over the transition table",
        clip: Clip { id: "CliffWalking-v1", seeds: 0..1, every: 1, frames: 40, size: (384, 128) },
    },
    Page {
        name: "frozen-lake",
        title: "FrozenLake",
        ids: &["FrozenLake", "FrozenLake8x8"],
        source: "crates/gym-toytext/src/frozen_lake.rs",
        module: "toytext::frozen_lake",
        actions: Some("enum Action"),
        heuristic: "is the best one, found by value iteration over the transition table",
        clip: Clip { id: "FrozenLake-v1", seeds: 12..13, every: 1, frames: 40, size: (192, 192) },
    },
    Page {
        name: "taxi",
        title: "Taxi",
        ids: &["Taxi"],
        source: "crates/gym-toytext/src/taxi.rs",
        module: "toytext::taxi",
        actions: Some("enum Action"),
        heuristic: "is the best one, found by value iteration over the transition table",
        clip: Clip { id: "Taxi-v4", seeds: 0..3, every: 1, frames: 40, size: (268, 228) },
    },
];
