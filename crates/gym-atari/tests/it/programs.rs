//! Programs of our own, assembled here, compared with results of ale-py 0.12.1.

use gym_atari::ale::Settings;
use gym_atari::cartridge::{Cartridge, Scheme};
use gym_atari::console::{Console, Input, switch};
use gym_atari::{Action, Ale, Display, games};

use crate::chips::random_writes;
use crate::lcg::Lcg;
use crate::rom::rom;

/// Plays a ROM as ale-py plays a file named `seaquest.bin`: loaded, and reset once.
pub(crate) fn played(rom: &[u8]) -> Ale {
    let mut ale = Ale::new(games::by_name("seaquest").unwrap(), rom, 0);
    ale.reset();
    ale
}

pub(crate) fn checksum(ale: &Ale) -> u32 {
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

/// No frame ends when a console is switched on, so its first picture is none.
#[test]
fn the_first_picture_of_a_console_is_not_complete() {
    let code = [
        0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, // 255 lines
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, // VSYNC
        0x4c, 0x00, 0xf0, // again
    ];
    let cartridge = Cartridge::new(&rom(&code), Scheme::Rom4K);
    let mut console = Console::new(cartridge, Display::NTSC, [0; 128], 74);
    let is_short = [(); 4].map(|()| {
        console.frame(&Input::default());
        console.is_short()
    });
    assert_eq!(is_short, [true, false, false, false]);
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
