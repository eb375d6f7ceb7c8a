//! Details of the machine that no recorded game depends on, in programs of our own.

use gym_atari::{Action, Ale, games};

use crate::rom::rom;

/// Returns code that waits for the next frame and then jumps to `back`.
fn frame(back: u16) -> Vec<u8> {
    let [low, high] = back.to_le_bytes();
    vec![
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00, // VSYNC
        0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, // 255 lines
        0x4c, low, high,
    ]
}

fn played(rom: &[u8]) -> Ale {
    let mut ale = Ale::new(games::by_name("seaquest").unwrap(), rom, 0);
    ale.reset();
    ale
}

/// `JMP ($F0FF)` reads its high byte from `$F000`: the address stays within its page.
#[test]
fn an_indirect_jump_stays_within_its_page() {
    let mut code = vec![0xea; 0xa00];
    // the first byte of the page is the high byte of the target: $78xx is a mirror of $F8xx
    code[..8].copy_from_slice(&[0x78, 0xd8, 0xa2, 0xff, 0x9a, 0x6c, 0xff, 0xf0]);
    code[0xff..0x101].copy_from_slice(&[0x00, 0xf9]);
    for (at, mark) in [(0x800, 1), (0x900, 2)] {
        let marked = [vec![0xa9, mark, 0x85, 0x90], frame(0xf004 + at as u16)].concat(); // lda #mark; sta $90
        code[at..at + marked.len()].copy_from_slice(&marked);
    }
    assert_eq!(played(&rom(&code)).ram().0[0x10], 1);
}

/// A read of a TIA register drives bits 7 and 6; the other bits come from the last byte on the bus.
#[test]
fn reads_of_the_tia_drive_two_bits() {
    let mut code = vec![
        0xa5, 0x58, 0x85, 0x90, // lda $58 (INPT0); sta $90
        0xa5, 0x4c, 0x85, 0x91, // lda $4c (INPT4); sta $91
        0xad, 0x0e, 0xee, 0x85, 0x92, // lda $ee0e (no register); sta $92
    ];
    code.extend(frame(0xf000));
    assert_eq!(played(&rom(&code)).ram().0[0x10..0x13], [0x18, 0x8c, 0x2e]);
}

/// Returns both triggers as a program reads them in each of six frames. The first trigger is
/// pressed in the second and the fifth frame. `VBLANK` starts as `start`, and the code `before`
/// runs before each read.
fn triggers(start: u8, before: &[u8]) -> [[bool; 6]; 2] {
    let mut code = vec![0x78, 0xd8, 0xa2, 0xff, 0x9a];
    code.extend([0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10, 0xfb]); // clears RAM, so that the game is not over
    code.extend([0xa9, start, 0x85, 0x01]); // lda #start; sta VBLANK
    let again = 0xf000 + code.len() as u16;
    code.extend(before.iter().flat_map(|value| [0xa9, *value, 0x85, 0x01]));
    code.extend([0xa5, 0x3c, 0x85, 0x90, 0xa5, 0x3d, 0x85, 0x91]); // lda INPT4; sta $90; lda INPT5; sta $91
    code.extend(frame(again));
    let mut ale = played(&rom(&code));
    let (noop, fire) = (Action::Noop, Action::Fire);
    let seen = [noop, fire, noop, noop, fire, noop].map(|action| {
        ale.act(action);
        [0x10, 0x11].map(|at| ale.ram().0[at] & 0x80 == 0)
    });
    [0, 1].map(|trigger| seen.map(|pressed| pressed[trigger]))
}

/// While bit 6 of `VBLANK` is set, a trigger stays pressed once it was read as pressed; clearing
/// the bit releases it (Stella Programmer's Guide, INPT4 and INPT5).
#[test]
fn a_latch_holds_a_trigger_until_it_is_cleared() {
    let (pressed, held, idle) = (
        [false, true, false, false, true, false],
        [false, true, true, true, true, true],
        [false; 6],
    );
    assert_eq!(triggers(0x00, &[]), [pressed, idle], "without a latch");
    assert_eq!(
        triggers(0x40, &[]),
        [held, idle],
        "the other trigger has a latch of its own"
    );
    assert_eq!(
        triggers(0x40, &[0x40]),
        [held, idle],
        "set again, it keeps what it holds"
    );
    assert_eq!(triggers(0x40, &[0x00, 0x40]), [pressed, idle]);
}

/// Returns the bytes at `$90` and `$91` in the frame after `code` was executed.
fn left(code: &[u8]) -> [u8; 2] {
    let mut code = code.to_vec();
    code.extend(frame(0xf000));
    let ale = played(&rom(&code));
    [ale.ram().0[0x10], ale.ram().0[0x11]]
}

/// Bit 1 of the address is ignored when the timer is read; an output pin reads as the bit that was
/// written.
#[test]
fn registers_of_the_riot_are_where_they_are_said_to_be() {
    let timer = [
        0xa9, 0x20, 0x8d, 0x96, 0x02, 0xad, 0x84, 0x02, 0x85, 0x90, 0xad, 0x86, 0x02, 0x85, 0x91,
    ];
    assert_eq!(left(&timer), [0x1f; 2]); // TIM64T, and INTIM twice
    let output = [
        0xa9, 0xf0, 0x8d, 0x81, 0x02, 0xa9, 0x5a, 0x8d, 0x80, 0x02, // SWACNT and SWCHA
        0xad, 0x80, 0x02, 0x85, 0x90, 0xad, 0x81, 0x02, 0x85, 0x91,
    ];
    assert_eq!(left(&output), [0x5f, 0xf0]);
}

/// After the timer has reached 0, the timer counts each cycle. A read makes the timer count each
/// interval again.
#[test]
fn a_read_behind_its_end_puts_the_timers_interval_back() {
    let code = [
        0xa9, 0x01, 0x8d, 0x96, 0x02, 0x85, 0x02, 0x85, 0x02, 0x85,
        0x02, // TIM64T, and three lines
        0xad, 0x84, 0x02, 0x85, 0x90, 0xad, 0x84, 0x02, 0x85,
        0x91, // INTIM twice, 7 cycles apart
    ];
    let [first, second] = left(&code);
    assert!(first.wrapping_sub(second) <= 1, "{first} {second}");
}

/// A pulse of `VSYNC` within a line does not end the frame; the frame's last line does.
#[test]
fn a_short_vsync_ends_no_frame() {
    let code = [
        0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10,
        0xfb, // clears RAM, so that the game is not over
        0xe6, 0x90, 0xa9, 0x02, 0x85, 0x00, 0xa9, 0x00, 0x85,
        0x00, // inc $90; VSYNC for 5 cycles
        0xa2, 0x64, 0x85, 0x02, 0xca, 0xd0, 0xfb, // 100 lines
        0x4c, 0x09, 0xf0,
    ];
    let mut ale = played(&rom(&code));
    let before = ale.ram().0[0x10];
    for _ in 0..10 {
        ale.act(Action::Noop);
    }
    assert!(
        matches!(ale.ram().0[0x10].wrapping_sub(before), 28..=30),
        "291 lines, ten times"
    );
}

/// `CXCLR` clears the collisions; objects that still overlap collide again in the same frame.
#[test]
fn collisions_come_back_after_they_were_cleared() {
    let mut code = vec![
        0xa9, 0xff, 0x85, 0x0d, 0x85, 0x0e, 0x85, 0x0f, 0xa9, 0x02, 0x85,
        0x1f, // a playfield and the ball
        0x85, 0x2c, 0xa5, 0x36, 0x85, 0x90, // CXCLR; lda CXBLPF; sta $90
        0xa2, 0x80, 0x85, 0x02, 0xca, 0xd0, 0xfb, // 128 lines
        0xa5, 0x36, 0x85, 0x91, // lda CXBLPF; sta $91
        0x85, 0x2c, 0xa2, 0x10, 0x85, 0x02, 0xca, 0xd0, 0xfb, // CXCLR, and 16 lines
        0xa5, 0x36, 0x85, 0x92,
    ];
    code.extend(frame(0xf000));
    let mut ale = played(&rom(&code));
    for _ in 0..4 {
        ale.act(Action::Noop);
        let seen = [0x10, 0x11, 0x12].map(|at| ale.ram().0[at] & 0x80);
        assert_eq!(seen[1..], [0x80, 0x80]);
    }
}

/// Bit 7 of `VBLANK` discharges the paddles' capacitors. The capacitors charge once the bit is
/// cleared, the more slowly the further a paddle is turned left.
#[test]
fn paddles_charge_from_when_they_are_let_go() {
    let mut code = vec![
        0xa9, 0x05, 0x85, 0xb9, // lda #5; sta $b9: lives
        0xa9, 0x80, 0x85, 0x01, 0x85, 0x02, 0xa9, 0x00, 0x85,
        0x01, // VBLANK: discharges them for a line
        0xa2, 0x00, 0x85, 0x02, 0x24, 0x38, 0x30, 0x05, 0xe8, 0xe0, 0xf0, 0xd0,
        0xf5, // ldx #0; lines until INPT0
        0x86, 0x91, // stx $91
    ];
    code.extend(frame(0xf000));
    let mut ale = Ale::new(games::by_name("breakout").unwrap(), &rom(&code), 0);
    let mut lines = |action| {
        for _ in 0..6 {
            ale.act(action);
        }
        ale.ram().0[0x11]
    };
    let middle = lines(Action::Noop);
    let left = lines(Action::Left);
    let right = (lines(Action::Right), lines(Action::Right)).1;
    assert!(
        0 < right && right < middle && middle < left,
        "{right} {middle} {left}"
    );
}

/// Where the second port's pins are outputs, they read as the bits that were written; directions of the
/// first port do not matter.
#[test]
fn each_port_has_directions_of_its_own() {
    // SWACNT, SWBCNT and SWCHB are written, SWCHB and SWBCNT are read
    let ports = |a: u8, b: u8, value: u8| {
        left(&[
            0xa9, a, 0x8d, 0x81, 0x02, 0xa9, b, 0x8d, 0x83, 0x02, 0xa9, value, 0x8d, 0x82,
            0x02, //
            0xad, 0x82, 0x02, 0x85, 0x90, 0xad, 0x83, 0x02, 0x85, 0x91,
        ])
    };
    let [idle, _] = ports(0x00, 0x00, 0x00);
    for (a, b) in [(0xff, 0x00), (0x00, 0xff), (0x0f, 0xf0), (0xf0, 0x0f)] {
        assert_eq!(ports(a, b, 0x00), [idle & !b, b], "{a:x} {b:x}");
        assert_eq!(ports(a, b, 0xff), [idle, b], "{a:x} {b:x}");
    }
}
