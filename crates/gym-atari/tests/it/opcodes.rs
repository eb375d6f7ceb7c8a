//! A program for each opcode. Its RAM (results, flags and cycles) is compared with ale-py 0.12.1's.

use gym_atari::{Ale, games};

use crate::lcg::Lcg;

/// The modes by opcode: `i` implied, `#` immediate, `z` zero page, with `x` and `y` indexed, `a`
/// absolute, with `X` and `Y` indexed, `(` and `)` indirect with pre- and post-indexing, `*`
/// indirect, `r` relative. `P`, `Q` and `R` are `X`, `Y` and `)` that write.
const MODES: &[u8; 256] = b"\
    i(i(zzzzi#i#aaaar)iRxxxxiYiQXXPP\
    a(i(zzzzi#i#aaaar)iRxxxxiYiQXXPP\
    i(i(zzzzi#i#aaaar)iRxxxxiYiQXXPP\
    i(i(zzzzi#i#*aaar)iRxxxxiYiQXXPP\
    #(#(zzzzi#i#aaaarRiRxxyyiQiQPPQQ\
    #(#(zzzzi#i#aaaar)i)xxyyiYiYXXYY\
    #(#(zzzzi#i#aaaar)iRxxxxiYiQXXPP\
    #(#(zzzzi#i#aaaar)iRxxxxiYiQXXPP";

/// Accumulator, X, Y, status and memory before the opcode.
const CASES: [[u8; 5]; 6] = [
    [0x00, 0x00, 0x00, 0x00, 0x00],
    [0x7f, 0x01, 0x02, 0x01, 0x80],
    [0x80, 0x98, 0x91, 0x40, 0xff],
    [0x99, 0x03, 0x04, 0x09, 0x55],
    [0x55, 0x98, 0x91, 0x08, 0x47],
    [0xff, 0x04, 0x05, 0xc3, 0x01],
];

const BRK: u8 = 0x00;
const JSR: u8 = 0x20;
const PLP: u8 = 0x28;
const RTI: u8 = 0x40;
const JMP: u8 = 0x4c;
const RTS: u8 = 0x60;
const PLA: u8 = 0x68;
const JMP_INDIRECT: u8 = 0x6c;
/// The opcodes `TXS`, `TAS` and `LAS`, which set the stack pointer. The stack must stay in RAM.
const STACK_POINTER: [u8; 3] = [0x9a, 0x9b, 0xbb];

/// Returns a program that executes an opcode in all cases and stores its results from `$C0` on: A,
/// X, Y, status, stack pointer, memory and timer.
fn program(opcode: u8) -> Vec<u8> {
    let mode = MODES[usize::from(opcode)];
    let mut code = vec![
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10, 0xfb,
    ]; // clears RAM
    let (mut indirect, mut interrupt) = (0u16, 0u16);
    for (result, [mut a, mut x, y, status, mut memory]) in (0xc0..).step_by(8).zip(CASES) {
        if STACK_POINTER.contains(&opcode) {
            (a, x, memory) = (a | 0xf0, x | 0xf0, memory | 0xf0);
        }
        // the last two cases cross into the next page
        let target: u16 = match mode {
            b'X' | b'Y' | b')' if x > 0x90 => 0xf702,
            b'P' | b'Q' | b'R' if x > 0x90 => 0x0184,
            _ => 0x00a8,
        };
        let cell = if target < 0x0200 { target as u8 } else { 0xa8 };
        let pointer = if matches!(mode, b')' | b'R') {
            target.wrapping_sub(y.into())
        } else {
            target
        };
        let [low, high] = pointer.to_le_bytes();
        // ldx #$FF; txs; lda #memory; sta cell
        code.extend([0xa2, 0xff, 0x9a, 0xa9, memory, 0x85, cell]);
        code.extend([0xa9, low, 0x85, 0xa0, 0xa9, high, 0x85, 0xa1]); // the pointer at $A0
        let pulled = match opcode {
            PLP | PLA => 3,
            RTS => 6,
            RTI => 9,
            _ => 0,
        };
        let here = 0xf000 + code.len() as u16 + pulled + 15;
        let after = here
            + match mode {
                b'i' => 1,
                b'a' | b'X' | b'Y' | b'P' | b'Q' | b'*' => 3,
                _ => 2,
            };
        let push = |byte: u8| [0xa9, byte, 0x48]; // lda #byte; pha
        match opcode {
            PLP | PLA => code.extend(push(memory)),
            RTS => {
                let [low, high] = (after - 1).to_le_bytes();
                code.extend([push(high), push(low)].concat());
            }
            RTI => {
                let [low, high] = after.to_le_bytes();
                code.extend([push(high), push(low), push(memory)].concat());
            }
            _ => {}
        }
        code.extend(push(status));
        code.extend([
            0xa2, x, 0xa0, y, 0xa9, 0xff, 0x8d, 0x94, 0x02, 0xa9, a, 0x28,
        ]); // registers, TIM1T, plp
        let absolute = |address: u16| {
            let [low, high] = address.to_le_bytes();
            vec![opcode, low, high]
        };
        code.extend(match mode {
            b'i' => vec![opcode],
            b'#' => vec![opcode, memory],
            b'z' => vec![opcode, cell],
            b'x' => vec![opcode, cell.wrapping_sub(x)],
            b'y' => vec![opcode, cell.wrapping_sub(y)],
            b'(' => vec![opcode, 0xa0u8.wrapping_sub(x)],
            b')' | b'R' => vec![opcode, 0xa0],
            b'r' => vec![opcode, 0x02, 0xe6, 0xbf], // branches over inc $BF
            b'*' => absolute(0xf7f0),
            b'a' if matches!(opcode, JSR | JMP) => absolute(after),
            b'a' => absolute(target),
            b'X' | b'P' => absolute(target.wrapping_sub(x.into())),
            _ => absolute(target.wrapping_sub(y.into())),
        });
        // php; sta; lda INTIM; sta
        code.extend([0x08, 0x85, result, 0xad, 0x84, 0x02, 0x85, result + 6]);
        // stx; sty; pla; sta
        code.extend([0x86, result + 1, 0x84, result + 2, 0x68, 0x85, result + 3]);
        // tsx; stx; lda cell; sta; cld
        code.extend([0xba, 0x86, result + 4, 0xa5, cell, 0x85, result + 5, 0xd8]);
        // these opcodes jump through a vector
        match opcode {
            BRK => interrupt = after,
            JMP_INDIRECT => indirect = after,
            _ => continue,
        }
        break;
    }
    let mut rom = frames_of_255_lines(code, interrupt);
    let table = [0x12, 0x34, 0x9a, 0xc7, 0x01, 0xfe, 0x80, 0x7f];
    rom[0x700..0x710].copy_from_slice(&[table, table].concat());
    rom[0x7f0..0x7f2].copy_from_slice(&indirect.to_le_bytes());
    rom
}

/// Returns a ROM with `code`, followed by frames of 255 lines.
fn frames_of_255_lines(mut code: Vec<u8>, interrupt: u16) -> Vec<u8> {
    let [low, high] = (0xf000 + code.len() as u16).to_le_bytes();
    code.extend([
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00,
    ]); // VSYNC
    code.extend([0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, 0x4c, low, high]);
    let mut rom = vec![0xea; 4096];
    rom[..code.len()].copy_from_slice(&code);
    let [low, high] = interrupt.to_le_bytes();
    rom[0xffc..].copy_from_slice(&[0x00, 0xf0, low, high]);
    rom
}

#[test]
fn opcodes_do_what_they_do_in_ale_py() {
    for opcode in 0..=255 {
        let mut ale = Ale::new(games::by_name("seaquest").unwrap(), &program(opcode), 0);
        ale.reset();
        let ram = ale.ram().0;
        assert_eq!(
            crc32fast::hash(ram),
            EXPECTED[usize::from(opcode)],
            "opcode {opcode:02x}: {ram:02x?}"
        );
    }
}

/// Returns a program with 56 sums or differences of random bytes; the program stores the
/// accumulator and the status of each.
fn decimal_program(opcode: u8, seed: u32) -> Vec<u8> {
    let mut random = Lcg(seed);
    let mut below = |n: u16| random.below(n) as u8;
    // clears RAM; sed
    let mut code = vec![
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10, 0xfb, 0xf8,
    ];
    for result in (0x80..0xf0).step_by(2) {
        let (a, value, carry) = (below(256), below(256), [0x18, 0x38][usize::from(below(2))]);
        // clv; clc or sec; lda #a; adc or sbc #value
        code.extend([0xb8, carry, 0xa9, a, opcode, value]);
        code.extend([0x08, 0x85, result, 0x68, 0x85, result + 1]); // php; sta; pla; sta
    }
    code.push(0xd8);
    frames_of_255_lines(code, 0)
}

/// (The real chip differs: digits above 9 have other results, and the flags are computed in another
/// way.)
#[test]
fn decimal_arithmetic_is_ale_pys() {
    for (opcode, expected) in [(0x69, DECIMAL_SUMS), (0xe9, DECIMAL_DIFFERENCES)] {
        for (seed, expected) in (0..).zip(expected) {
            let mut ale = Ale::new(
                games::by_name("seaquest").unwrap(),
                &decimal_program(opcode, seed),
                0,
            );
            ale.reset();
            assert_eq!(
                crc32fast::hash(ale.ram().0),
                expected,
                "opcode {opcode:02x}, seed {seed}"
            );
        }
    }
}

#[rustfmt::skip]
const DECIMAL_SUMS: [u32; 8] = [
    0x8ae4_9259, 0x22b8_4ae3, 0x068e_89b3, 0x1a51_687b,
    0xd352_5b40, 0xf02f_832d, 0x5801_5505, 0x1dc1_5152,
];
#[rustfmt::skip]
const DECIMAL_DIFFERENCES: [u32; 8] = [
    0x23a8_a5e6, 0x0cee_a9e9, 0x8bd7_e892, 0x2f76_db78,
    0x9f21_a335, 0x99bc_0fc3, 0xd49b_a0b7, 0xc3af_ebcd,
];

/// Checksums of RAM.
#[rustfmt::skip]
const EXPECTED: [u32; 256] = [
    0xadf9_ccdb, 0x184c_f467, 0x5e6c_480b, 0x280c_39e0,
    0xd679_ae8a, 0x8c34_6eda, 0x0ccb_6e62, 0xc9f1_37fe,
    0x917d_44da, 0xcf36_bd16, 0x0ef9_0ff7, 0x717b_94dd,
    0xc404_93af, 0x9e49_53ff, 0xc9cc_1a36, 0x0cf6_43aa,
    0x88fa_55b8, 0x7b6c_e739, 0x5e6c_480b, 0x9f69_9d46,
    0xc404_93af, 0x9e49_53ff, 0xc9cc_1a36, 0x0cf6_43aa,
    0x838e_6910, 0x40dd_9155, 0x957b_7d46, 0x0c6a_d592,
    0x8220_b1d6, 0x40dd_9155, 0xc950_8c0e, 0x0c6a_d592,
    0x4c84_c04d, 0x1362_e1b6, 0x5e6c_480b, 0xeb86_f9f7,
    0x6ed5_8db0, 0x871a_7b0b, 0x74fd_22fa, 0x0a7b_f7e9,
    0xca25_cdba, 0xc418_a8c7, 0x3d0d_eb40, 0x717b_94dd,
    0x7ca8_b095, 0x9567_462e, 0xb1fa_56ae, 0xcf7c_83bd,
    0xe47b_2340, 0x009e_d8f6, 0x5e6c_480b, 0x5ce3_5d51,
    0xc404_93af, 0x9567_462e, 0xb1fa_56ae, 0xcf7c_83bd,
    0x2827_c111, 0x3b2f_ae9a, 0x957b_7d46, 0xcfe0_1585,
    0x8220_b1d6, 0x3b2f_ae9a, 0xb166_c096, 0xcfe0_1585,
    0xffe9_8dc7, 0xfbef_be7e, 0x5e6c_480b, 0x5bd9_bec8,
    0xd679_ae8a, 0x6f97_24c3, 0xb784_0641, 0xba24_b0d6,
    0x98cb_08f1, 0x2c95_f70f, 0x0537_a50d, 0x2428_b99b,
    0xd679_ae8a, 0x7dea_19e6, 0x7283_7215, 0x7f23_c482,
    0x3bc0_bda8, 0x70a3_67ed, 0x5e6c_480b, 0x687e_308d,
    0xc404_93af, 0x7dea_19e6, 0x7283_7215, 0x7f23_c482,
    0x957b_7d46, 0x4b12_1181, 0x957b_7d46, 0xfb7d_7859,
    0x8220_b1d6, 0x4b12_1181, 0xf6dd_cece, 0xfb7d_7859,
    0xf5d0_6cf4, 0xb9bd_49b2, 0x5e6c_480b, 0x67ac_a179,
    0xd679_ae8a, 0x2dc5_d30f, 0x6d15_0df6, 0x8651_af67,
    0x9108_6d05, 0x6ec7_00c3, 0x3226_85d4, 0x63a3_c719,
    0x5b77_356a, 0x3fb8_ee2a, 0xa812_79a2, 0x4356_db33,
    0x8de4_68dd, 0xee89_a386, 0x5e6c_480b, 0x540b_2f3c,
    0xc404_93af, 0x3fb8_ee2a, 0xa812_79a2, 0x4356_db33,
    0x564e_d781, 0xd538_d5ea, 0x957b_7d46, 0xc708_67e8,
    0x8220_b1d6, 0xd538_d5ea, 0x2c4c_c579, 0xc708_67e8,
    0x957b_7d46, 0x83b4_d8e6, 0x957b_7d46, 0x7ce4_7c03,
    0xb73d_bf86, 0x17cc_425b, 0x0f70_8ea3, 0xe89c_e6be,
    0x3698_5904, 0x957b_7d46, 0xead3_5447, 0xbed4_d882,
    0xa540_82a3, 0x05b1_7f7e, 0x1d0d_b386, 0xfae1_db9b,
    0xbd01_dfea, 0x9326_5e30, 0x5e6c_480b, 0xebfb_dfb4,
    0xa540_82a3, 0x05b1_7f7e, 0x1d0d_b386, 0xfae1_db9b,
    0xaef5_4bcd, 0xa2da_cb36, 0x36b8_8fe2, 0xc743_79bc,
    0x5f80_66a8, 0xa2da_cb36, 0xda07_4ab2, 0xda07_4ab2,
    0xeb9f_858b, 0xf7da_4e10, 0xeca2_a065, 0x6c12_9688,
    0xa89d_5647, 0x63a2_d4ad, 0xafa0_73a9, 0xea17_3110,
    0xe702_8967, 0x20a0_0761, 0xef3d_13de, 0xa379_5017,
    0xbae0_6b62, 0x71df_e988, 0xbddd_4e8c, 0xea17_3110,
    0xbfba_e849, 0x7c96_9783, 0x5e6c_480b, 0x8b7e_509e,
    0xbae0_6b62, 0x71df_e988, 0xbddd_4e8c, 0xea17_3110,
    0xf074_fc1f, 0x4727_e1ef, 0x3aa0_0478, 0x2148_642e,
    0x372c_5ce1, 0x4727_e1ef, 0x7abb_0ede, 0xb0cf_26f2,
    0x3088_a2d2, 0x1f09_0b55, 0x957b_7d46, 0xa536_1988,
    0x738a_711e, 0x8b71_91e8, 0x876d_9485, 0x44cb_1796,
    0x7f79_f2c2, 0xc873_4224, 0x5b6b_5fcd, 0x98cd_a1bc,
    0x61f7_4c3b, 0x990c_accd, 0x426a_e0d1, 0x81cc_63c2,
    0x88fa_55b8, 0x6afc_5c52, 0x5e6c_480b, 0x0404_20b5,
    0xc404_93af, 0x990c_accd, 0x426a_e0d1, 0x81cc_63c2,
    0xe701_159a, 0x514d_2a3e, 0x957b_7d46, 0x9707_6861,
    0x8220_b1d6, 0x514d_2a3e, 0x54a1_eb72, 0x9707_6861,
    0x3088_a2d2, 0x7a73_95a1, 0x957b_7d46, 0xc3d1_42a8,
    0x738a_711e, 0xee0b_0f1c, 0x9f1d_4077, 0x222c_4cb6,
    0x4058_e099, 0xad09_dcd0, 0x957b_7d46, 0xad09_dcd0,
    0x61f7_4c3b, 0xfc76_3239, 0x5a1a_3423, 0xe72b_38e2,
    0xe47b_2340, 0x3fca_bc9b, 0x5e6c_480b, 0x9751_ba80,
    0xc404_93af, 0xfc76_3239, 0x5a1a_3423, 0xe72b_38e2,
    0xba1b_4655, 0x047b_caf7, 0x957b_7d46, 0x0452_f254,
    0x8220_b1d6, 0x047b_caf7, 0xb963_fe95, 0x0452_f254,
];
