//! Runs random bytes as programs, and stores and restores a console repeatedly: `soak [SECONDS]
//! [RESTORES]`.

use std::time::{Duration, Instant};

use gym_atari::Display;
use gym_atari::cartridge::{Cartridge, Scheme};
use gym_atari::console::{Console, Input};

fn main() {
    let mut numbers = std::env::args()
        .skip(1)
        .filter_map(|n| n.parse::<u64>().ok());
    let (seconds, restores) = (
        numbers.next().unwrap_or(10),
        numbers.next().unwrap_or(1_000_000),
    );

    let mut state = 1u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as u8
    };
    let (start, mut programs, mut frames) = (Instant::now(), 0u64, 0u64);
    let mut console = None;
    while start.elapsed() < Duration::from_secs(seconds) {
        let rom: Vec<u8> = (0..16384).map(|_| random()).collect();
        let scheme = Scheme::ALL[programs as usize % Scheme::ALL.len()];
        let mut seen = Console::new(
            Cartridge::new(&rom, scheme),
            Display::NTSC,
            [random(); 128],
            random(),
        );
        let mut unseen = seen.clone();
        for _ in 0..8 {
            let input = Input {
                port_a: random(),
                charge: [Some(900); 4],
                ..Input::default()
            };
            seen.frame(&input);
            unseen.frame_unseen(&input);
            frames += 2;
        }
        assert_eq!(
            seen.ram(),
            unseen.ram(),
            "program {programs}: a frame that is not seen plays otherwise"
        );
        programs += 1;
        console = Some(seen);
    }
    println!("{programs} random programs, {frames} frames in {seconds} s");

    let Some(mut console) = console else { return };
    let start = Instant::now();
    for _ in 0..restores {
        let state = console.state();
        assert!(console.set_state(&state), "a console refuses its own state");
    }
    let each = start.elapsed().as_nanos() as f64 / restores as f64;
    println!("{restores} times stored and restored, {each:.0} ns each");
    let start = Instant::now();
    for _ in 0..restores / 10 {
        console = std::hint::black_box(console.clone());
    }
    let each = start.elapsed().as_nanos() as f64 / (restores / 10).max(1) as f64;
    println!(
        "{} clones, pictures included, {each:.0} ns each",
        restores / 10
    );
}
