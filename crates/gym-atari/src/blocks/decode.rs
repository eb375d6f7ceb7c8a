//! Divides a program into blocks: which instructions a block has, and which function each needs.

use super::{LONGEST, Op, function};
use crate::cartridge::{Cartridge, Kind};
use crate::cpu::instructions::{Access, INSTRUCTIONS, Instruction, LENGTHS, Mode, Operation};
use crate::wires::case;

/// Decodes the block that starts at the address `start`; an empty block if the interpreter must
/// continue.
#[cold]
#[inline(never)]
pub(super) fn decode<K: Kind>(cartridge: &Cartridge, start: u16) -> Box<[Op]> {
    let mut block = vec![];
    let (mut low12, mut at) = (start & 0x0fff, 0);
    while block.len() < LONGEST {
        let byte = |i: u16| K::peek(cartridge, 0x1000 | low12.wrapping_add(i) & 0x0fff);
        let opcode = byte(0);
        let instruction = INSTRUCTIONS[usize::from(opcode)];
        let length = u16::from(LENGTHS[usize::from(opcode)]);
        // the processor reads the byte after a one-byte instruction too
        let end = low12 + length.max(2);
        let window_end = (start & 0x0fff & !(K::WINDOW - 1)) + K::WINDOW;
        if end > window_end.min(K::PLAIN) {
            break;
        }
        let (low, high) = (byte(1), if length == 3 { byte(2) } else { 0 });
        // a loop that waits for the timer: `LDA INTIM` and a `BNE` back to `LDA`
        let waits = low == 0xfb && matches!(byte(length.wrapping_sub(5)), 0x2c | 0xac..=0xae);
        let case = case_of::<K>(instruction, low12 + length, low, high, waits);
        let Some(run) = function::<K>(opcode, case) else {
            break;
        };
        block.push(Op {
            run,
            pc: 0x1000 | low12,
            at,
            low,
            high,
        });
        if ends_block(instruction.operation) {
            break;
        }
        at += cycles(opcode);
        low12 += length;
    }
    block.into()
}

/// Returns the known part of an instruction's address. `next` is the lower 12 bits of the address
/// of the next instruction. `waits` tells whether the instruction is a branch that may end a
/// waiting loop.
fn case_of<K: Kind>(
    Instruction { operation, mode }: Instruction,
    next: u16,
    low: u8,
    high: u8,
    waits: bool,
) -> u8 {
    use Operation::{Adc, Jsr, Pha, Php, Pla, Plp, Rts, Sbc};
    let word = u16::from_le_bytes([low, high]);
    let in_rom = |last: u16| word & 0x1000 != 0 && last & 0x1000 != 0 && last & 0x0fff < K::PLAIN;
    let in_ram = word & 0x1280 == 0x0080;
    match (mode, operation.access()) {
        (_, _) if matches!(operation, Jsr | Rts | Pha | Php | Pla | Plp) => case::MEMORY,
        (Mode::Immediate, _) if matches!(operation, Adc | Sbc) => case::MEMORY,
        (Mode::ZeroPage, _) if low >= 0x80 => case::RAM,
        (Mode::ZeroPage, Access::Write) => case::TIA | low & 0x3f,
        (Mode::Absolute, Access::Read) if in_rom(word) => case::ROM,
        (Mode::AbsoluteX | Mode::AbsoluteY, Access::Read) if in_rom(word.wrapping_add(0xff)) => {
            case::ROM
        }
        (Mode::Absolute, _) if in_ram => case::MEMORY,
        (Mode::AbsoluteX | Mode::AbsoluteY, access) if in_ram || access == Access::Read => {
            case::MEMORY
        }
        (Mode::ZeroPageX | Mode::ZeroPageY, _) if low >= 0x80 => case::MEMORY,
        // both bytes of the pointer are in RAM
        (Mode::IndirectY, _) if (0x80..0xff).contains(&low) => case::MEMORY,
        (Mode::Indirect, _) => case::MEMORY,
        // a taken branch reads from the next instruction's page
        (Mode::Relative, _) if next | 0xff < K::PLAIN && !waits => case::ROM,
        _ => case::ANY,
    }
}

/// Whether an operation ends a block.
pub(super) const fn ends_block(operation: Operation) -> bool {
    use Operation::*;
    matches!(
        operation,
        Bcc | Bcs | Beq | Bmi | Bne | Bpl | Bvc | Bvs | Jmp | Jsr | Rts
    )
}

/// Returns the cycles of an instruction that crosses no page and is not delayed by `RDY`.
pub(super) const fn cycles(opcode: u8) -> u16 {
    let Instruction { operation, mode } = INSTRUCTIONS[opcode as usize];
    let length = LENGTHS[opcode as usize] as u16;
    let fetched = if length < 2 { 2 } else { length };
    let before = match (mode, operation) {
        (_, Operation::Pha | Operation::Php) => return fetched + 1,
        (_, Operation::Pla | Operation::Plp) => return fetched + 2,
        (Mode::ZeroPage | Mode::Absolute, _) => 0,
        (Mode::ZeroPageX | Mode::ZeroPageY, _) => 1,
        (Mode::AbsoluteX | Mode::AbsoluteY, _) => {
            !matches!(operation.access(), Access::Read) as u16
        }
        (Mode::IndirectX, _) => 3,
        (Mode::IndirectY, _) => 2 + !matches!(operation.access(), Access::Read) as u16,
        (Mode::Immediate | Mode::Implied | Mode::Indirect | Mode::Relative, _) => return fetched,
    };
    fetched
        + before
        + if matches!(operation.access(), Access::Modify) {
            3
        } else {
            1
        }
}

/// Whether an instruction can select a bank.
pub(super) const fn may_switch(opcode: u8, case: u8) -> bool {
    use Mode::*;
    let named = matches!(
        INSTRUCTIONS[opcode as usize].mode,
        Absolute | AbsoluteX | AbsoluteY | IndirectX | IndirectY
    );
    named && case == case::ANY
}
