//! Programs of our own for single features of the chips, compared with results of ale-py 0.12.1.

use gym_atari::cartridge::{Cartridge, Scheme};
use gym_atari::console::{Console, Input};
use gym_atari::{Action, Display};

use crate::lcg::Lcg;
use crate::rom::rom;

use crate::programs::{checksum, played};

/// Returns a program whose frames write 330 random numbers to random registers at random times.
pub(crate) fn random_writes(seed: u32, registers: &[u8]) -> Vec<u8> {
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
