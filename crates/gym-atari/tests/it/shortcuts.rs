//! Compares a console with shortcuts with a console without shortcuts.

use gym_atari::Display;
use gym_atari::cartridge::{Cartridge, Scheme};
use gym_atari::console::{Console, Input};

use crate::lcg::Lcg;
use crate::rom::rom;

const BRANCHES: [u8; 8] = [0xd0, 0x10, 0x30, 0xf0, 0x90, 0xb0, 0x50, 0x70];

fn byte(random: &mut Lcg) -> u8 {
    random.below(256u16) as u8
}

fn one_of<T: Copy>(random: &mut Lcg, choices: &[T]) -> T {
    choices[random.below(choices.len())]
}

/// Returns a program of counting loops and of loops that wait for the timer, with all intervals.
/// Some instructions jump into the middle of a loop or write to RAM.
fn loops(seed: u32) -> Vec<u8> {
    let mut random = Lcg(seed);
    let mut code = vec![];
    while code.len() < 2000 {
        match random.below(8) {
            // ldx #number; ldy #number
            0 | 1 => code.extend([0xa2, byte(&mut random), 0xa0, byte(&mut random)]),
            // dex, dey, inx or iny; branch
            2 | 3 => code.extend([
                one_of(&mut random, &[0xca, 0x88, 0xca, 0x88, 0xe8, 0xc8]),
                one_of(&mut random, &BRANCHES),
                0xfd,
            ]),
            // jmp behind the first instruction of a loop
            4 => {
                let loops: [&[u8]; 4] =
                    [&[0xca], &[0x88], &[0xad, 0x84, 0x02], &[0xae, 0x84, 0x02]];
                let first = one_of(&mut random, &loops);
                let [low, high] =
                    (0xf000 + code.len() as u16 + 3 + first.len() as u16).to_le_bytes();
                code.extend([0x4c, low, high]);
                code.extend(first);
                code.extend([
                    one_of(&mut random, &BRANCHES[..3]),
                    (first.len() as u8 + 2).wrapping_neg(),
                ]);
            }
            // lda #number; sta TIM1T, TIM8T, TIM64T or T1024T
            5 => {
                code.extend([
                    0xa9,
                    byte(&mut random),
                    0x8d,
                    one_of(&mut random, &[0x94, 0x95, 0x96, 0x96, 0x97]),
                    0x02,
                ]);
            }
            // lda, ldx, ldy or bit INTIM; branch
            6 => {
                let load = one_of(&mut random, &[0xad, 0xae, 0xac, 0x2c]);
                code.extend([
                    load,
                    one_of(&mut random, &[0x84, 0x84, 0x85]),
                    0x02,
                    one_of(&mut random, &BRANCHES[..3]),
                    0xfb,
                ]);
            }
            // inc, stx, sty or sta
            _ => {
                let store = one_of(&mut random, &[0xe6, 0x86, 0x84, 0x85]);
                code.extend([store, 0x80 + byte(&mut random) % 128]);
            }
        }
    }
    code.extend([0x4c, 0x00, 0xf0]); // jmp $F000
    rom(&code)
}

/// Returns the state of the console without the state of the cartridge.
fn state(console: &Console) -> serde_json::Value {
    let mut state = serde_json::to_value(console.state()).unwrap();
    state.as_object_mut().unwrap().remove("banks");
    state
}

/// The console with Activision's scheme skips no loop, because each access may select a bank. A
/// frame ends after 25,000 instructions, usually in the middle of a loop.
#[test]
fn skipped_loops_leave_what_they_would() {
    for seed in 0..150 {
        let rom = loops(seed);
        let console = |rom: &[u8], scheme| {
            Console::new(Cartridge::new(rom, scheme), Display::NTSC, [0; 128], 74)
        };
        let mut plain = console(&[&rom[..], &rom[..]].concat(), Scheme::FE);
        let mut skipping = console(&rom, Scheme::Rom4K);
        let mut switched = console(&[&rom[..], &rom[..]].concat(), Scheme::F8);
        for frame in 0..8 {
            for console in [&mut plain, &mut skipping, &mut switched] {
                console.frame(&Input::default());
            }
            assert_eq!(
                state(&plain),
                state(&skipping),
                "program {seed}, frame {frame}"
            );
            assert_eq!(
                state(&plain),
                state(&switched),
                "program {seed}, frame {frame}, in two banks"
            );
        }
    }
}
