//! Programs of our own, assembled here, compared with results of ale-py 0.12.1.

use gym_atari::ale::Settings;
use gym_atari::cartridge::{Cartridge, Scheme};
use gym_atari::console::{Console, Input, switch};
use gym_atari::{Action, Ale, Display, games};

use crate::lcg::Lcg;
use crate::rom::rom;

/// Plays a ROM as ale-py plays a file named `seaquest.bin`: loaded, and reset once.
fn played(rom: &[u8]) -> Ale {
    let mut ale = Ale::new(games::by_name("seaquest").unwrap(), rom, 0);
    ale.reset();
    ale
}

fn checksum(ale: &Ale) -> u32 {
    crc32fast::hash(ale.picture().as_flattened())
}

/// A playfield with a colour and a pattern, and a frame counter.
#[test]
fn a_playfield_and_a_counter() {
    let code: Vec<u8> = "78d8a2ff9aa9009500cad0fba90e8508a9848509a9a5850ea9028500850285028502a9008500e680a2ff8502cad0fb4c18f0"
        .as_bytes()
        .chunks(2)
        .map(|digits| u8::from_str_radix(std::str::from_utf8(digits).unwrap(), 16).unwrap())
        .collect();
    let mut ale = played(&rom(&code));
    assert_eq!(ale.ram().0[0], 67);
    assert!(ale.ram().0[1..].iter().all(|&byte| byte == 0));
    assert_eq!(checksum(&ale), 0x2ce8_d529);
    ale.act(Action::Right);
    assert_eq!(ale.ram().0[0], 68);
}

/// RAM survives a power cycle; only loading the ROM restores its first content.
#[test]
fn memory_outlasts_a_reset() {
    let code = [
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xe6, 0x90, // inc $90: starts
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, // VSYNC
        0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, // 255 lines
        0x4c, 0x07, 0xf0,
    ];
    let starts = |ale: &Ale| ale.ram().0[0x10];
    let mut ale = Ale::new(games::by_name("seaquest").unwrap(), &rom(&code), 0);
    assert_eq!(starts(&ale), 187);
    for expected in [188, 189, 190] {
        ale.reset();
        assert_eq!(starts(&ale), expected);
    }
    // load, and reset once
    ale.reload(0);
    assert_eq!(starts(&ale), 188);
}

/// The console's switches as a program reads them, from the 57th frame on: four idle frames, RESET,
/// SELECT until a RAM byte shows the mode, RESET. The program increments this byte each time that
/// SELECT is pressed.
#[test]
fn switches_are_pressed_as_by_ale_py() {
    let program = |shows: u8| {
        rom(&[
            0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10,
            0xfb, // clears RAM
            0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, // VSYNC
            0xad, 0x82, 0x02, 0xa8, 0x45, 0xfe, 0x84,
            0xfe, // lda SWCHB; tay; eor $fe; sty $fe
            0x29, 0x02, 0xf0, 0x07, 0x98, 0x29, 0x02, 0xd0,
            0x02, // skips the inc unless SELECT was just pressed
            0xe6, shows, // inc
            0xe6, 0xff, 0xa5, 0xff, 0x38, 0xe9,
            0x38, // inc $ff: frames; lda $ff; sec; sbc #56
            0x90, 0x08, 0xc9, 0x40, 0xb0,
            0x04, // bcc; cmp #64; bcs: skip the sta unless A < 64
            0xaa, 0x98, 0x95, 0xa0, // tax; tya; sta $a0,x
            0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, // 255 lines
            0x4c, 0x0e, 0xf0,
        ])
    };
    for (game, shows, mode, expected) in [
        ("seaquest", 0xfd, 0, "....RRRRRRRR"),
        ("tennis", 0x80, 0, "....RRRRRRRRRRRR"),
        ("tennis", 0x80, 2, "....RRRRSS.SS.RRRRRRRR"),
        ("alien", 0x81, 3, "....RRRRS.S.S.RRRRRRRR"),
        ("gopher", 0xd3, 2, "....RRRRRRRRSSSSS.SSSSS.RRRRRRRR."),
        (
            "berzerk",
            0x80,
            2,
            "....RRRR....................SS.SS.RRRRRRRR",
        ),
    ] {
        let mut ale = Ale::new(games::by_name(game).unwrap(), &program(shows), 0);
        ale.configure(Settings {
            mode: Some(mode),
            ..Settings::default()
        });
        ale.reset();
        let written = ale.ram().0[0x20..0x60]
            .iter()
            .take_while(|&&switches| switches != 0);
        let switches = written.map(|switches| match *switches {
            switch::IDLE => '.',
            0x3e => 'R',
            0x3d => 'S',
            _ => '?',
        });
        assert_eq!(
            switches.collect::<String>(),
            expected,
            "{game}, mode {mode}"
        );
    }
}

/// Double Dunk's menu selects its modes by actions that may stick. The program has the current line
/// in `$b0`, which DOWN increments, and the options in `$80`, which RIGHT toggles.
#[test]
fn a_menu_is_gone_through_as_by_ale_py() {
    let mut code = vec![
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10,
        0xfb, // clears RAM
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, // VSYNC
        0xad, 0x80, 0x02, 0xa8, 0x45, 0xfe, 0x84, 0xfe, 0x85,
        0xfd, // SWCHA in Y, the changed bits in $fd
        0x29, 0x20, 0xf0, 0x07, 0x98, 0x29, 0x20, 0xd0, 0x02, 0xe6,
        0xb0, // inc $b0 if DOWN was just pressed
        0xa5, 0xfd, 0x10, 0x0c, 0x98, 0x30, 0x09, // if RIGHT was just pressed:
        0xa6, 0xb0, 0xbd, 0x00, 0xf2, 0x45, 0x80, 0x85,
        0x80, // ldx $b0; lda $f200,x; eor $80; sta $80
        0xe6, 0xff, 0xa5, 0xff, 0x38, 0xe9, 0x38, 0x90, 0x13, 0xc9, 0x3f, 0xb0,
        0x0f, // frames 56 to 118:
        0xaa, 0xad, 0x82, 0x02, 0x29, 0x03, 0x85, 0xfc, 0x98, 0x29, 0xf0, 0x05, 0xfc, 0x95,
        0xb1, // sta $b1,x
        0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, // 255 lines
        0x4c, 0x0e, 0xf0,
    ];
    code.resize(0x202, 0xea);
    code.extend([0x08, 0x10, 0x04, 0x20]);
    for (mode, seed, repeat_action_probability, expected, frame_number) in [
        (0, 0, 0.0, "....RRRRS.v.v.v.v.v.RRRR^.RRRR^", 26),
        (5, 0, 0.0, "....RRRRS.v.v.>.v.v.>.v.RRRR^.RRRR^", 30),
        (15, 0, 0.0, "....RRRRS.v.v.>.v.>.v.>.v.>.RRRR^.RRRR^", 34),
        (5, 3, 0.25, "....RRRRS.v.v.>>v.vv>.v.RRRR^.RRRR^", 36),
        (5, 4, 0.5, "....RRRRS.v.vvv.>.....vvv.vv>.vvRRRR^^RRRR^", 56),
        (
            10,
            7,
            0.5,
            "....RRRRS.....vvvvvvvvv.......v.....v.>...vvv.vv>>RRRR..RRRR^",
            76,
        ),
    ] {
        let mut ale = Ale::new(games::by_name("double_dunk").unwrap(), &rom(&code), 0);
        ale.configure(Settings {
            mode: Some(mode),
            repeat_action_probability,
            ..Settings::default()
        });
        ale.reload(seed);
        let written = ale.ram().0[0x31..0x70]
            .iter()
            .take_while(|&&seen| seen != 0);
        let seen = written.map(|seen| match *seen {
            0xf3 => '.',
            0xf2 => 'R',
            0xf1 => 'S',
            0xd3 => 'v',
            0x73 => '>',
            0xe3 => '^',
            _ => '?',
        });
        assert_eq!(
            seen.collect::<String>(),
            expected,
            "mode {mode}, seed {seed}"
        );
        assert_eq!(ale.frame_number(), frame_number, "mode {mode}, seed {seed}");
    }
}

/// Adventure holds SELECT for a random time, and plays a frame after each press. The program counts
/// frames in `$ff` and presses in `$dd`.
#[test]
fn select_is_held_at_random_as_by_ale_py() {
    let program = rom(&[
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10,
        0xfb, // clears RAM
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, // VSYNC
        0xad, 0x82, 0x02, 0xa8, 0x45, 0xfe, 0x84, 0xfe, // lda SWCHB; tay; eor $fe; sty $fe
        0x29, 0x02, 0xf0, 0x07, 0x98, 0x29, 0x02, 0xd0, 0x02, 0xe6,
        0xdd, // inc $dd if SELECT was just pressed
        0xe6, 0xff, 0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, 0x4c, 0x0e, 0xf0, // 255 lines
    ]);
    for (seed, mode, repeat_action_probability, frame_number, frames) in [
        (0, 1, 0.0, 4, 187),
        (1, 1, 0.0, 4, 188),
        (2, 2, 0.25, 8, 32),
    ] {
        let mut ale = Ale::new(games::by_name("adventure").unwrap(), &program, 0);
        ale.configure(Settings {
            mode: Some(mode),
            repeat_action_probability,
            ..Settings::default()
        });
        ale.reload(seed);
        assert_eq!(
            (ale.frame_number(), ale.ram().0[0x7f]),
            (frame_number, frames),
            "seed {seed}"
        );
    }
}

/// Skiing has no button: an action with FIRE has no effect, not even its direction. The program
/// stores the stick in `$90` and the button in `$91`.
#[test]
fn illegal_actions_do_nothing() {
    let program = rom(&[
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, // VSYNC
        0xad, 0x80, 0x02, 0x85, 0x90, 0xa5, 0x0c, 0x85, 0x91, 0x4c, 0x00, 0xf0,
    ]);
    let mut ale = Ale::new(games::by_name("skiing").unwrap(), &program, 0);
    for (action, seen) in [
        (Action::Noop, [0xff, 0x8c]),
        (Action::Up, [0xef, 0x8c]),
        (Action::UpFire, [0xff, 0x8c]),
        (Action::Fire, [0xff, 0x8c]),
    ] {
        ale.act(action);
        assert_eq!(ale.ram().0[0x10..0x12], seen, "{action:?}");
    }
}

/// ale-py's `restoreState` does not change whether a frame is unfinished. The program counts in
/// `$91`, between two `WSYNC` and the end of `VSYNC`, and then waits for 30,000 instructions. Of
/// three calls, the first does not end its frame, the second ends it at its first store, and only
/// the third counts.
#[test]
fn an_unfinished_frame_goes_on_after_a_restore() {
    let program = rom(&[
        0xa2, 0x7f, 0xa9, 0x00, 0x95, 0x80, 0xca, 0x10, 0xfb, // clears RAM
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xe6, 0x91, 0xa9, 0x00, 0x85,
        0x00, // VSYNC; inc $91
        0xa2, 0x3a, 0xa0, 0x00, 0x88, 0xd0, 0xfd, 0xca, 0xd0, 0xf8, 0x4c, 0x09, 0xf0,
    ]);
    let mut third = Ale::new(games::by_name("pong").unwrap(), &program, 0);
    let counts = |ale: &mut Ale| {
        let before = ale.ram().0[0x11];
        ale.act(Action::Noop);
        ale.ram().0[0x11] != before
    };
    assert!(
        (0..3).any(|_| counts(&mut third)),
        "one of three calls counts"
    );
    let mut first = third.clone();
    assert!(!counts(&mut first));
    let mut second = first.clone();
    assert!(!counts(&mut second));
    for (place, state, expected) in [
        // the next call from the state `second` counts; in the unfinished frame of `first`, the
        // call ends the frame first and does not count
        (&first, &second, false),
        (&second, &second, true),
        // the next call from the state `first` ends its frame; after the finished frame of
        // `second`, the call starts a frame and counts
        (&first, &first, false),
        (&second, &first, true),
    ] {
        let mut ale = place.clone();
        assert!(ale.set_state_like_ale(&state.state(), true));
        assert_eq!(counts(&mut ale), expected);
    }
}

/// Returns reward, lives and end of the frame after each change of RAM, with a program that does
/// not write to RAM after its start.
fn answers(game: &str, changes: &[&[(usize, u8)]]) -> Vec<(i32, i32, bool)> {
    let program = rom(&[
        0xa9, 0x10, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10, 0xfb, // fills RAM with 16
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, 0x4c, 0x09,
        0xf0, // VSYNC
    ]);
    let mut ale = Ale::new(games::by_name(game).unwrap(), &program, 0);
    let answer = |change: &&[(usize, u8)]| {
        change
            .iter()
            .for_each(|&(index, byte)| ale.ram_mut()[index] = byte);
        let reward = ale.act(Action::Noop);
        (reward, ale.lives(), ale.game_over())
    };
    changes.iter().map(answer).collect()
}

#[test]
fn rewards_that_depend_on_earlier_frames_are_ale_pys() {
    // Casino: a frame without a reward repeats the previous frame's reward
    let start: &[_] = &[
        (0x0c, 0x10),
        (0x15, 0x00),
        (0x1e, 0x00),
        (0x53, 0x70),
        (0x54, 0x00),
    ];
    let given = answers(
        "casino",
        &[
            start,
            &[(0x0c, 0x20)],
            &[(0x53, 0x80), (0x0c, 0x30)],
            &[],
            &[(0x53, 0)],
        ],
    );
    assert_eq!(
        given[1..],
        [
            (1000, 1, false),
            (1000, 1, false),
            (1000, 1, false),
            (0, 1, false)
        ]
    );

    // Haunted House: each change of a decimal number costs a point
    let start: &[_] = &[(0x02, 0), (0x16, 9), (0x19, 0)];
    let given = answers(
        "haunted_house",
        &[
            start,
            &[(0x02, 5)],
            &[],
            &[(0x02, 0x10)],
            &[(0x02, 0x0a)],
            &[(0x19, 0x44)],
        ],
    );
    assert_eq!(
        given[1..],
        [
            (-1, 9, false),
            (0, 9, false),
            (-1, 9, false),
            (0, 9, false),
            (100, 0, true)
        ]
    );

    // Adventure: one life is left at the end
    let start: &[_] = &[(0x39, 0x1c), (0x60, 0)];
    assert_eq!(
        answers("adventure", &[start, &[(0x39, 0x12)]])[1..],
        [(1, 1, true)]
    );
}

/// In a frame in which RAM does not show the lives, the previous number remains.
#[test]
fn lives_that_do_not_count_are_those_of_before() {
    let changes: &[&[(usize, u8)]] = &[
        &[(0x0c, 1), (0x05, 3)],
        &[(0x0c, 0), (0x05, 1)],
        &[(0x0c, 1)],
    ];
    let lives: Vec<_> = answers("beam_rider", changes)
        .iter()
        .map(|&(_, lives, _)| lives)
        .collect();
    assert_eq!(lives, [4, 4, 2]);
}

/// Othello is over once RAM has shown that for 51 consecutive frames.
#[test]
fn an_end_that_takes_time_is_ale_pys() {
    let frames = |bytes: &[(u8, usize)]| {
        let changes: Vec<_> = bytes
            .iter()
            .flat_map(|&(byte, times)| vec![[(0x40, byte)]; times])
            .collect();
        let changes: Vec<_> = changes.iter().map(|change| &change[..]).collect();
        answers("othello", &changes)
            .iter()
            .position(|&(_, _, over)| over)
    };
    assert_eq!(frames(&[(1, 1), (0, 60)]), Some(51));
    assert_eq!(frames(&[(1, 1), (0, 30), (1, 1), (0, 60)]), Some(82));
    assert_eq!(frames(&[(1, 120)]), None);
}

/// ale-py plays a program whose frames have more than 290 lines as PAL; a frame after one with an
/// odd number of lines has no colours.
#[test]
fn long_frames_are_shown_as_by_a_pal_set() {
    let played = |code: &[u8]| {
        let mut ale = Ale::new(games::by_name("keystone_kapers").unwrap(), &rom(code), 0);
        ale.reset();
        ale
    };
    // alternating frames of 312 and 313 lines: a colour after 100 black lines
    let mut ale = played(&[
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0x85, 0x80, // clears $80
        0xe6, 0x80, 0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85,
        0x00, // VSYNC
        0xa9, 0x02, 0x85, 0x01, 0xa9, 0x64, 0x85, 0x81, 0x85, 0x02, 0xc6, 0x81, 0xd0,
        0xfa, // VBLANK, 100 lines
        0xa9, 0x00, 0x85, 0x01, 0xa9, 0x44, 0x85, 0x09, // COLUBK
        0xa9, 0xd1, 0x85, 0x81, 0xa5, 0x80, 0x29, 0x01, 0xf0, 0x04, 0xa9, 0xd2, 0x85,
        0x81, // 209 or 210 lines
        0x85, 0x02, 0xc6, 0x81, 0xd0, 0xfa, 0x4c, 0x09, 0xf0,
    ]);
    for expected in [0x3582_eb98, 0x8735_0d4f, 0x3582_eb98, 0x8735_0d4f] {
        ale.act(Action::Noop);
        assert_eq!((ale.picture().len(), checksum(&ale)), (250, expected));
    }
    // frames of 343 lines, and of 344 lines, which are truncated; one colour per line
    for (lines, expected) in [
        (0x55, [(0x9a60_6451, 69), (0x9a60_6451, 70)]),
        (0x56, [(0x8247_8478, 35), (0xe6a9_4479, 35)]),
    ] {
        let mut ale = played(&[
            0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0x85, 0x80, // clears $80
            0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85,
            0x00, // VSYNC
            0xa0, 0x00, 0xa2, 0x00, 0xa9, 0xff, 0x85, 0x81, 0x8a, 0x0a, 0x85, 0x09, 0xe8, 0x85,
            0x02, 0xc6, 0x81, 0xd0, 0xf5, 0xa9, lines, 0x85, 0x81, 0x8a, 0x0a, 0x85, 0x09, 0xe8,
            0x85, 0x02, 0xc6, 0x81, 0xd0, 0xf5, 0xe6, 0x80, 0x4c, 0x09, 0xf0,
        ]);
        for expected in expected {
            ale.act(Action::Noop);
            assert_eq!((checksum(&ale), ale.ram().0[0]), expected, "{lines:#x}");
        }
    }
}

/// If RAM never shows the mode, the console stops pressing SELECT.
#[test]
fn a_program_without_modes_starts_as_well() {
    let ale = Ale::new(
        games::by_name("alien").unwrap(),
        &rom(&[0xe6, 0x81, 0xa9, 0x55, 0x85, 0x81, 0x4c, 0x02, 0xf0]),
        0,
    );
    assert_eq!(ale.ram().0[0x01], 0x55);
}

/// Returns a program whose frames write 330 random numbers to random registers at random times.
fn random_writes(seed: u32, registers: &[u8]) -> Vec<u8> {
    let mut random = Lcg(seed);
    let lines = |n: u8| [0xa2, n, 0x85, 0x02, 0xca, 0xd0, 0xfb]; // ldx #n; loop: sta WSYNC; dex; bne loop
    let mut code = vec![
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0x95, 0x00, 0xca, 0xd0, 0xfb,
    ]; // clears all
    let [low, high] = (0xf000 + code.len() as u16).to_le_bytes();
    code.extend([0xa9, 0x02, 0x85, 0x00]); // VSYNC
    code.extend(lines(3));
    code.extend([0xa9, 0x00, 0x85, 0x00]);
    code.extend(lines(40));
    for _ in 0..330 {
        let register = registers[random.below(registers.len())];
        code.extend([0xa9, random.below(256u16) as u8]); // lda #value
        code.extend(vec![0xea; random.below(4)]); // nop
        code.extend([0x85, register]); // sta register
    }
    code.extend([0xe6, 0x80]); // inc $80
    code.extend(lines(160));
    code.extend([0x4c, low, high]); // jmp
    rom(&code)
}

/// A write at any time of a line becomes visible at the same pixel as in ale-py.
#[test]
fn writes_show_when_they_do_in_ale_py() {
    // colours, graphics, enabling, reflection, vertical delay
    let objects: &[u8] = &[2, 6, 7, 8, 9, 27, 28, 29, 30, 31, 11, 12, 37, 38, 39];
    // motion at all times of a line
    let hmove: &[u8] = &[2, 2, 6, 7, 8, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 42];
    // copies and widths
    let nusiz: &[u8] = &[2, 6, 7, 27, 28, 29, 30, 4, 5];
    // playfield, colours, reflection, priority and score
    let playfield: &[u8] = &[2, 6, 7, 8, 9, 10, 13, 14, 15];
    // positions at all times of a line: of missiles and the ball, and of missiles locked to players
    let positions: &[u8] = &[
        2, 6, 7, 8, 18, 19, 20, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 43,
    ];
    let locked: &[u8] = &[2, 6, 7, 27, 28, 29, 30, 40, 41, 4, 5];
    // positions of players at all times of a line, including the first and the last cycle and the
    // blank
    let players: &[u8] = &[2, 6, 7, 16, 17, 27, 28];
    let resized: &[u8] = &[2, 6, 7, 16, 17, 27, 28, 4, 5];
    let moved: &[u8] = &[2, 2, 6, 7, 16, 17, 27, 28, 32, 33, 42];
    // priorities
    let priorities: &[u8] = &[2, 6, 7, 8, 9, 10, 13, 14, 15, 27, 28, 29, 30, 31];
    let everything: Vec<u8> = [2; 3].into_iter().chain(4..21).chain(27..45).collect();
    let cases = [
        (
            players,
            [
                0x09be_a172,
                0x1f46_23f2,
                0x62ea_9614,
                0x3b32_8d30,
                0x5983_91ad,
                0x8dbf_daa5,
            ],
        ),
        (
            resized,
            [
                0x6431_2e28,
                0x44dd_a63f,
                0x3c65_fe7d,
                0x518f_eb22,
                0x569c_47e3,
                0xb91a_2e7d,
            ],
        ),
        (
            moved,
            [
                0x2c7d_ae13,
                0x00cf_91c6,
                0x63ac_7659,
                0xfaed_e3a9,
                0x4dab_19bd,
                0xb972_5018,
            ],
        ),
        (
            priorities,
            [
                0x865f_07a8,
                0xe53c_755d,
                0xb2fb_d8c8,
                0x0f60_0552,
                0xd96d_274e,
                0x3cf0_3d04,
            ],
        ),
        (
            &everything,
            [
                0x55ec_3062,
                0x253f_60e2,
                0x8b86_2f05,
                0x4b25_6a61,
                0x0423_1e4a,
                0x54e6_69ac,
            ],
        ),
        (
            positions,
            [
                0xa28a_76ab,
                0x89a9_d149,
                0x9d7a_8250,
                0x6c97_c58a,
                0x3559_3352,
                0x8b9d_f49b,
            ],
        ),
        (
            locked,
            [
                0x0d96_4ff4,
                0xe7f5_c9c4,
                0xbf8a_b9c9,
                0x8faf_bf40,
                0x02b2_22f3,
                0xbc81_f9d8,
            ],
        ),
        (
            playfield,
            [
                0x9a98_1527,
                0x8f50_f08b,
                0xf34f_4410,
                0x1ee2_4465,
                0xec64_3a9d,
                0x49e5_935b,
            ],
        ),
        (
            objects,
            [
                0xd65e_0466,
                0x2d1e_5550,
                0x07a1_be42,
                0x8d4e_d54b,
                0xc673_bb73,
                0xfa37_a9d9,
            ],
        ),
        (
            hmove,
            [
                0x90cb_33a4,
                0xb13d_efb2,
                0x9b00_9857,
                0x9002_1e60,
                0xb461_5fcc,
                0x8ce7_7f31,
            ],
        ),
        (
            nusiz,
            [
                0x3539_9903,
                0xa399_9366,
                0x91e1_a5ce,
                0xaa6d_b565,
                0xfec6_8985,
                0x9355_c372,
            ],
        ),
    ];
    for (registers, expected) in cases {
        for (seed, expected) in (0..).zip(expected) {
            let mut ale = played(&random_writes(seed, registers));
            ale.act(Action::Noop);
            assert_eq!(
                checksum(&ale),
                expected,
                "registers {registers:?}, seed {seed}"
            );
        }
    }
}

/// Returns instructions that take `cycles` cycles. `cycles` must be 0 or at least 2.
fn delay(cycles: usize) -> Vec<u8> {
    let bit: &[u8] = if cycles % 2 == 1 { &[0x24, 0x80] } else { &[] };
    [bit, &vec![0xea; (cycles - 3 * (cycles % 2)) / 2]].concat()
}

/// Objects whose position is reset during an `HMOVE` in the same line, in the six cases in which
/// the `HMOVE` still moves them.
#[test]
fn a_move_still_moves_what_starts_anew() {
    let mut code = vec![
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0x95, 0x00, 0xca, 0xd0, 0xfb,
    ]; // clears all
    code.extend([
        0xa9, 0x0e, 0x85, 0x06, 0xa9, 0x4e, 0x85, 0x07, 0xa9, 0x8e, 0x85, 0x08, 0xa9, 0x00, 0x85,
        0x09,
    ]);
    let [low, high] = (0xf000 + code.len() as u16).to_le_bytes();
    code.extend([
        0xa9, 0x02, 0x85, 0x00, 0xa2, 0x03, 0x85, 0x02, 0xca, 0xd0, 0xfb, 0xa9, 0x00, 0x85, 0x00,
    ]); // VSYNC
    code.extend([0xa2, 0x24, 0x85, 0x02, 0xca, 0xd0, 0xfb]); // 36 lines
    for (object, hmove, reset, before) in [
        (2, 3, 23, 46),
        (3, 3, 6, 53),
        (4, 3, 6, 53),
        (4, 3, 9, 54),
        (4, 3, 10, 67),
        (4, 5, 23, 60),
    ] {
        let (resx, enable) = (0x10 + object, 0x1b + object);
        code.extend([0xa9, 0x00, 0x85, 0x20 + object]); // HMxx
        code.extend(if object < 4 {
            [0xa9, 0x00, 0x85, 0x04 + (object & 1)].to_vec()
        } else {
            delay(5)
        });
        code.extend([0xa9, 0x02, 0x85, enable]);
        code.extend(delay(before - 18));
        code.extend([0x85, resx, 0x85, 0x02]);
        code.extend(delay(hmove - 3));
        code.extend([0x85, 0x2a]); // HMOVE
        code.extend(delay(reset - hmove - 3));
        code.extend([
            0x85, resx, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, enable, 0x85, 0x02,
        ]);
    }
    code.extend([0xa2, 0x1e, 0x85, 0x02, 0xca, 0xd0, 0xfb, 0x4c, low, high]);
    let mut ale = played(&rom(&code));
    ale.act(Action::Noop);
    assert_eq!(checksum(&ale), 0xe63a_2174);
}

/// The 70th frame is so long that a write to `WSYNC` ends the frame. The write still waits: the
/// next frame starts with the next line.
#[test]
fn wsync_waits_where_it_ends_a_frame() {
    let mut code = vec![
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0x95, 0x00, 0xca, 0xd0, 0xfb,
    ]; // clears all
    code.extend([
        0xa9, 0x0e, 0x85, 0x06, 0xa9, 0x8e, 0x85, 0x08, 0xa9, 0x02, 0x85, 0x1f, 0xa9, 0x80, 0x85,
        0x1b,
    ]);
    code.extend([
        0xa9, 0x02, 0x85, 0x00, 0xa2, 0x03, 0x85, 0x02, 0xca, 0xd0, 0xfb, 0xa9, 0x00, 0x85, 0x00,
    ]); // VSYNC
    code.extend([0xe6, 0x80, 0xa5, 0x80, 0xc9, 70, 0xf0, 0x0a]); // inc $80; lda $80; cmp #70; beq over the jmp
    code.extend([0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, 0x4c, 0x1c, 0xf0]); // 255 lines
    code.extend([0xa2, 0xfa, 0x85, 0x02, 0xca, 0xd0, 0xfb]); // 250 lines
    code.extend([0xa2, 0x00, 0xca, 0xd0, 0xfd].repeat(3)); // 50 more lines without a write
    code.extend([0xea, 0xa9, 0x44, 0x85, 0x02]);
    code.extend(delay(20));
    code.extend([0x85, 0x10]); // RESP0
    code.extend(delay(11));
    code.extend([0x85, 0x14]); // RESBL
    code.extend([
        0xa2, 0xc8, 0x85, 0x02, 0x8a, 0x85, 0x09, 0xca, 0xd0, 0xf8, 0x4c, 0x1c, 0xf0,
    ]); // a colour a line
    let mut ale = played(&rom(&code));
    ale.act(Action::Noop);
    ale.act(Action::Noop);
    for expected in [0xb284_7573, 0xac22_ec2f, 0xb7d9_283f] {
        ale.act(Action::Noop);
        assert_eq!(checksum(&ale), expected);
    }
}

/// A frame that is not drawn changes everything except the picture like a drawn frame.
#[test]
fn unseen_frames_play_the_same() {
    let rom = random_writes(
        1,
        &[
            2, 4, 5, 6, 7, 8, 9, 10, 13, 14, 15, 16, 17, 18, 19, 20, 27, 28, 29, 30, 31, 42,
        ],
    );
    let console = || {
        Console::new(
            Cartridge::new(&rom, Scheme::Rom4K),
            Display::NTSC,
            [0; 128],
            74,
        )
    };
    let (mut seen, mut unseen) = (console(), console());
    for _ in 0..20 {
        seen.frame(&Input::default());
        unseen.frame_unseen(&Input::default());
    }
    assert_eq!(
        serde_json::to_value(seen.state()).unwrap(),
        serde_json::to_value(unseen.state()).unwrap()
    );
    seen.frame(&Input::default());
    unseen.frame(&Input::default());
    assert_eq!(seen.picture(), unseen.picture());
}

/// Each byte of the program is the number of its bank.
#[test]
fn banks_follow_accesses() {
    let numbered = |banks: usize, size: usize| {
        let mut rom = vec![0; banks * size];
        rom.chunks_mut(size)
            .enumerate()
            .for_each(|(bank, bytes)| bytes.fill(bank as u8));
        rom
    };
    let mut f8 = Cartridge::new(&numbered(2, 4096), Scheme::F8);
    assert_eq!(f8.read(0x1000, 0), 1, "starts in the last bank");
    f8.read(0x1ff8, 0);
    assert_eq!(f8.read(0x1000, 0), 0);
    f8.write(0x1ff9, 0);
    assert_eq!(f8.read(0x1000, 0), 1, "a write selects as well");

    let mut f6 = Cartridge::new(&numbered(4, 4096), Scheme::F6SC);
    for bank in [3, 0, 2, 1] {
        f6.read(0x1ff6 + bank, 0);
        assert_eq!(f6.read(0x1800, 0), bank as u8);
    }
    f6.write(0x1005, 0x5a);
    assert_eq!(
        f6.read(0x1085, 0),
        0x5a,
        "RAM is read 128 bytes above where it is written"
    );

    let mut e0 = Cartridge::new(&numbered(8, 1024), Scheme::E0);
    let windows =
        |e0: &mut Cartridge| [0x1000, 0x1400, 0x1800, 0x1c00].map(|address| e0.read(address, 0));
    assert_eq!(windows(&mut e0), [4, 5, 6, 7]);
    e0.read(0x1fe2, 0);
    e0.read(0x1fe9, 0);
    e0.read(0x1ff7, 0);
    assert_eq!(windows(&mut e0), [2, 1, 7, 7]);

    let mut small = Cartridge::new(&[7; 2048], Scheme::Rom2K);
    assert_eq!((small.read(0x1000, 0), small.read(0x1fff, 0)), (7, 7));
}

/// Compares reads of the chip in Pitfall II's cartridge, with random counters.
#[test]
fn data_fetchers_give_what_ale_pys_do() {
    for (seed, expected) in (0..).zip([0xa1fd_ae91, 0x62bd_6e45, 0x9377_df05, 0xb5a0_a5f7]) {
        let mut random = Lcg(seed);
        let data: Vec<u8> = (0..2048).map(|_| random.below(256u16) as u8).collect();
        // clear RAM; restart the random number generator
        let mut code = vec![
            0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10, 0xfb,
        ];
        code.extend([0x8d, 0x70, 0x10]);
        for fetcher in 0..5 {
            let counter = random.below(256u16) as u8;
            let top = counter.wrapping_sub(random.below(8u16) as u8);
            let bottom = counter
                .wrapping_sub(8)
                .wrapping_sub(random.below(8u16) as u8);
            let high = random.below(8u16) as u8;
            for (register, value) in [(0x40, top), (0x48, bottom), (0x50, counter), (0x58, high)] {
                code.extend([0xa9, value, 0x8d, register + fetcher, 0x10]); // lda #value; sta register
            }
        }
        for result in 0x80..0xe4 {
            let (fetcher, function) = (random.below(5u16) as u8, random.below(8u16) as u8);
            let fetcher = if function == 0 {
                random.below(4u16) as u8
            } else {
                fetcher
            };
            code.extend([0xad, 8 * function + fetcher, 0x10, 0x85, result]); // lda register; sta result
        }
        let [low, high] = (0xf080 + code.len() as u16).to_le_bytes();
        code.extend([
            0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00,
        ]); // VSYNC
        code.extend([0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, 0x4c, low, high]); // 255 lines
        let mut bank = vec![0xea; 4096];
        bank[0x80..][..code.len()].copy_from_slice(&code);
        bank[0xffc..].copy_from_slice(&[0x80, 0xf0, 0x80, 0xf0]);
        let cartridge = Cartridge::new(
            &[&bank[..], &bank[..], &data[..], &[0; 255][..]].concat(),
            Scheme::Dpc,
        );
        let mut console = Console::new(cartridge, Display::NTSC, [0; 128], 74);
        console.frame(&Input::default());
        assert_eq!(crc32fast::hash(console.ram()), expected, "seed {seed}");
    }
}

/// Meaningless bytes neither panic nor hang, and give the same result twice.
#[test]
fn any_bytes_can_be_played() {
    let mut random = Lcg(7);
    for round in 0..160 {
        let length = [0, 1, 2048, 4096, 8192, 16384, 20000][random.below(7)];
        let rom: Vec<u8> = (0..length).map(|_| random.below(256u16) as u8).collect();
        let scheme = Scheme::ALL[round % Scheme::ALL.len()];
        let play = || {
            let mut console =
                Console::new(Cartridge::new(&rom, scheme), Display::NTSC, [0xa5; 128], 30);
            for frame in 0..6u8 {
                let input = Input {
                    port_a: frame,
                    charge: [Some(900); 4],
                    ..Input::default()
                };
                console.frame(&input);
            }
            (
                *console.ram(),
                crc32fast::hash(console.picture().as_flattened()),
            )
        };
        assert_eq!(play(), play(), "{scheme:?}, round {round}");
    }
}
