//! Details of the machine that no recorded game depends on, on programs of our own.

use gym_atari::{Ale, games};

use crate::rom::rom;

/// Lines until the next frame, then back to an address.
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

/// `JMP ($F0FF)` reads its high byte from `$F000`, as the address does not leave its page.
#[test]
fn an_indirect_jump_stays_within_its_page() {
    let mut code = vec![0xea; 0xa00];
    // the first byte of the page is the high byte of the target: $78xx is $F8xx here
    code[..8].copy_from_slice(&[0x78, 0xd8, 0xa2, 0xff, 0x9a, 0x6c, 0xff, 0xf0]);
    code[0xff..0x101].copy_from_slice(&[0x00, 0xf9]);
    for (at, mark) in [(0x800, 1), (0x900, 2)] {
        let marked = [vec![0xa9, mark, 0x85, 0x90], frame(0xf004 + at as u16)].concat(); // lda #mark; sta $90
        code[at..at + marked.len()].copy_from_slice(&marked);
    }
    assert_eq!(played(&rom(&code)).ram().0[0x10], 1);
}

/// A read of any register of the TIA drives bits 7 and 6; the others are those of the last byte on the bus.
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
