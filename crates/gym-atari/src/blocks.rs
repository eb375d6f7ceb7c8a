//! Threaded code: each instruction is decoded once, into a function with an operand that calls the
//! next instruction's function.
//!
//! A block is straight-line code in ROM that ends with a branch or jump. Its functions do the
//! interpreter's work: they are [`Core::execute`], compiled for one opcode and for the known part
//! of its address. The interpreter executes code in RAM, code next to addresses that select banks,
//! and opcodes that games do not use.
//!
//! Within a block, the processor's `cycle`, `pc` and `bus` keep the values from the block's start;
//! each instruction stores its offset from them. Longer operations, such as `WSYNC`, advance the
//! start.

mod decode;

use std::fmt;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

use crate::cartridge::{Any, Cartridge, Fixed, Kind, ROM, Scheme, Switched, Windowed};
use crate::cpu::Cpu;
use crate::cpu::instructions::{INSTRUCTIONS, LENGTHS, Operation};
use crate::cpu::run::Core;
use crate::riot::Riot;
use crate::wires::{Chips, Wires, case};
use decode::{cycles, decode, ends_block, may_switch};

/// The largest number of instructions in a block. Calls of the next function may not be tail calls;
/// then each uses a stack frame.
const LONGEST: usize = 32;

/// The state that each instruction passes to the next.
pub(crate) struct Thread {
    cpu: Cpu,
    /// The number of instructions that may be executed after the block.
    left: u32,
}

impl Thread {
    /// Skips the iterations of a two-instruction waiting loop that has just branched to its start,
    /// except the last iteration.
    #[inline(never)]
    fn wait(&mut self, riot: &Riot, cartridge: &Cartridge) {
        let Self { cpu, left } = self;
        let Some([first, low, high, last]) = cartridge.four_bytes(cpu.pc) else {
            return;
        };
        // a loop of DEX or DEY (3 bytes), or LDA of a register (5 bytes)
        let length = if first == 0xad { 5 } else { 3 };
        // a branch to another page takes an extra cycle
        if cpu.pc & 0xff00 != cpu.pc.wrapping_add(length) & 0xff00 {
            return;
        }
        let most = *left / 2;
        let (rounds, cycles, result) = match (first, low, high, last) {
            (0xca | 0x88, 0xd0 | 0x10, 0xfd, _) => {
                let counter = if first == 0xca {
                    &mut cpu.x
                } else {
                    &mut cpu.y
                };
                // with BNE, the counter is not 0 here, and the last round starts at 1; with BPL, at 0
                let rounds = if low == 0xd0 {
                    counter.wrapping_sub(1)
                } else {
                    *counter
                };
                let rounds = u32::from(rounds).min(most);
                *counter -= rounds as u8;
                (rounds, 5, *counter)
            }
            (0xad, _, _, 0xd0) => {
                // the register was read three cycles before the end of the branch
                let read = cpu.cycle - 3;
                let Some(zero) = riot.zero_from(u16::from_le_bytes([low, high])) else {
                    return;
                };
                let rounds = (zero.saturating_sub(read + 1) / 7).min(u64::from(most)) as u32;
                if rounds > 0 {
                    cpu.a = riot.count(read + 7 * u64::from(rounds));
                }
                (rounds, 7, cpu.a)
            }
            _ => return,
        };
        cpu.flags(result);
        cpu.cycle += cycles * u64::from(rounds);
        *left -= 2 * rounds;
    }
}

type Run = fn(&mut Thread, &mut Chips, &mut Cartridge, &[Op]);

/// A decoded instruction.
pub(crate) struct Op {
    run: Run,
    /// The lower 13 bits of the instruction's address.
    pc: u16,
    /// The cycles from the block's start to the instruction's start.
    at: u16,
    /// The bytes after the opcode.
    low: u8,
    high: u8,
}

/// The decoded instructions of a ROM, shared by all consoles that play it.
pub(crate) struct Blocks {
    scheme: Scheme,
    rom: Arc<[u8; ROM]>,
    /// The block that starts at each byte: see [`Kind::entry`]. A block is decoded when it is first
    /// executed. Its content depends only on the ROM.
    entries: Box<[OnceLock<Box<[Op]>>]>,
}

impl fmt::Debug for Blocks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Blocks")
            .field("scheme", &self.scheme)
            .finish_non_exhaustive()
    }
}

/// The blocks of all existing consoles.
static KNOWN: Mutex<Vec<Weak<Blocks>>> = Mutex::new(Vec::new());

impl Blocks {
    /// Returns the blocks of a cartridge's ROM.
    pub(crate) fn of(cartridge: &Cartridge) -> Arc<Self> {
        let (scheme, rom) = (cartridge.scheme(), Arc::clone(&cartridge.rom));
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|blocks| blocks.strong_count() > 0);
        let mut shared = known.iter().filter_map(Weak::upgrade);
        if let Some(blocks) = shared.find(|blocks| blocks.scheme == scheme && blocks.rom == rom) {
            return blocks;
        }
        let entries = match scheme {
            Scheme::Rom2K | Scheme::Rom4K => 0x1000,
            Scheme::F8 => 0x2000,
            Scheme::F6 => 0x4000,
            Scheme::E0 => 0x8000,
            // other schemes are not decoded
            Scheme::F8SC | Scheme::F6SC | Scheme::FE | Scheme::Dpc => 0,
        };
        let blocks = Arc::new(Self {
            scheme,
            rom,
            entries: (0..entries).map(|_| OnceLock::new()).collect(),
        });
        known.push(Arc::downgrade(&blocks));
        blocks
    }
}

/// Executes at most `most` instructions; stops early when a frame ends or the processor halts.
pub(crate) fn run(
    cpu: &mut Cpu,
    chips: &mut Chips,
    cartridge: &mut Cartridge,
    blocks: &Blocks,
    most: u32,
) {
    match cartridge.scheme() {
        Scheme::Rom2K | Scheme::Rom4K => run_blocks::<Fixed>(cpu, chips, cartridge, blocks, most),
        Scheme::F8 | Scheme::F6 => run_blocks::<Switched>(cpu, chips, cartridge, blocks, most),
        Scheme::E0 => run_blocks::<Windowed>(cpu, chips, cartridge, blocks, most),
        Scheme::F8SC | Scheme::F6SC | Scheme::FE | Scheme::Dpc => {
            interpret(cpu, chips, cartridge, most);
        }
    }
}

/// Interprets at most `most` instructions; returns whether a frame's end or a halt stopped it
/// early.
#[inline(never)]
fn interpret(cpu: &mut Cpu, chips: &mut Chips, cartridge: &mut Cartridge, most: u32) -> bool {
    cpu.run(Wires::<Any, { case::ANY }>::new(chips, cartridge), most)
}

fn run_blocks<K: Kind>(
    cpu: &mut Cpu,
    chips: &mut Chips,
    cartridge: &mut Cartridge,
    blocks: &Blocks,
    most: u32,
) {
    let mut thread = Thread {
        cpu: *cpu,
        left: most,
    };
    while thread.left > 0 {
        let pc = thread.cpu.pc;
        let entry = if pc & 0x1000 == 0 {
            None
        } else {
            blocks.entries.get(K::entry(cartridge, pc))
        };
        let block = entry.map_or(&[][..], |block| {
            block.get_or_init(|| decode::<K>(cartridge, pc))
        });
        match block {
            // the interpreter executes the last instruction, because only the interpreter updates
            // the byte on the bus
            [first, ..] if block.len() < thread.left as usize => {
                thread.left -= block.len() as u32;
                (first.run)(&mut thread, chips, cartridge, block);
                if thread.cpu.pc == pc {
                    thread.wait(&chips.riot, cartridge);
                }
            }
            _ => {
                thread.left -= 1;
                if interpret(&mut thread.cpu, chips, cartridge, 1) {
                    break;
                }
            }
        }
    }
    *cpu = thread.cpu;
}

/// Executes the first instruction of `ops`, then the others. The function is compiled for a `CASE`.
/// If the case does not cover the instruction, the function executes the instruction with the case
/// `AGAIN`.
///
/// Rare work is done in the function for `AGAIN`, which is called last: any earlier call would make
/// each instruction save registers.
#[inline(never)]
fn step<K: Kind, const OPCODE: u8, const CASE: u8, const AGAIN: u8>(
    thread: &mut Thread,
    chips: &mut Chips,
    cartridge: &mut Cartridge,
    ops: &[Op],
) {
    let [
        Op {
            pc, at, low, high, ..
        },
        rest @ ..,
    ] = ops
    else {
        return;
    };
    let operation = const { INSTRUCTIONS[OPCODE as usize].operation };
    let ends = const { ends_block(INSTRUCTIONS[OPCODE as usize].operation) };
    let Cpu {
        pc: start,
        bus: byte,
        cycle,
        ..
    } = thread.cpu;
    if CASE != AGAIN
        && matches!(operation, Operation::Adc | Operation::Sbc)
        && thread.cpu.is_decimal()
    {
        return step::<K, OPCODE, AGAIN, AGAIN>(thread, chips, cartridge, ops);
    }
    let mut core = Core {
        cpu: thread.cpu,
        bus: Wires::<K, CASE>::new(chips, cartridge),
        left: thread.left,
        stopped: false,
    };
    core.cpu.cycle = cycle + u64::from(*at);
    if ends {
        core.cpu.pc = start & 0xe000 | pc;
    }
    core.execute::<OPCODE>(*low, *high);
    let Core {
        mut cpu,
        left,
        stopped,
        bus: Wires { missed, .. },
    } = core;
    if CASE != AGAIN && missed {
        return step::<K, OPCODE, AGAIN, AGAIN>(thread, chips, cartridge, ops);
    }
    if ends {
        thread.cpu = cpu;
        thread.left = left;
        return;
    }
    let switched =
        K::PLAIN < 0x1000 && const { may_switch(OPCODE, CASE) } && cartridge.take_switched();
    if !stopped
        && !switched
        && let [next, ..] = rest
    {
        cpu.cycle -= u64::from(*at) + const { cycles(OPCODE) as u64 };
        (cpu.pc, cpu.bus) = (start, byte);
        thread.cpu = cpu;
        return (next.run)(thread, chips, cartridge, rest);
    }
    cpu.pc = (start & 0xe000 | pc).wrapping_add(const { LENGTHS[OPCODE as usize] as u16 });
    thread.cpu = cpu;
    thread.left = if stopped {
        0
    } else {
        thread.left + rest.len() as u32
    };
}

/// Matches `$opcode` with the functions of the listed opcodes, compiled for a case.
macro_rules! functions {
    ($kind:ident, $opcode:ident, $case:expr, $again:expr, $($code:literal)*) => {
        match $opcode {
            $($code => Some(step::<$kind, $code, { $case }, { $again }>),)*
            _ => None,
        }
    };
    // `STA`, `STX` and `STY` to the listed registers
    (store $kind:ident, $opcode:ident, $case:expr, $register:ident, $($code:literal)*) => {
        match $register {
            $($code => functions!($kind, $opcode, $case | $code, case::ANY, 0x84 0x85 0x86),)*
            _ => None,
        }
    };
}

/// Returns the function of `opcode`, compiled for `case`.
#[rustfmt::skip]
fn function<K: Kind>(opcode: u8, case: u8) -> Option<Run> {
    let function: Option<Run> = match case {
        case::RAM => functions!(K, opcode, case::RAM, case::ANY,
            0x05 0x06 0x24 0x25 0x26 0x45 0x46 0x65 0x66 0x84 0x85 0x86
            0xa4 0xa5 0xa6 0xc4 0xc5 0xc6 0xe4 0xe5 0xe6),
        case::ROM => functions!(K, opcode, case::ROM, case::ANY,
            0x0d 0x2c 0x2d 0x4d 0x6d 0xac 0xad 0xae 0xcc 0xcd 0xec 0xed
            0x19 0x1d 0x39 0x3d 0x59 0x5d 0x79 0x7d 0xb9 0xbc 0xbd 0xbe 0xd9 0xdd 0xf9 0xfd
            0x10 0x30 0x50 0x70 0x90 0xb0 0xd0 0xf0),
        case::MEMORY => functions!(K, opcode, case::MEMORY, case::ANY,
            0x08 0x0d 0x0e 0x11 0x15 0x16 0x19 0x1d 0x1e
            0x20 0x28 0x2c 0x2d 0x2e 0x31 0x35 0x36 0x39 0x3d 0x3e
            0x48 0x4d 0x4e 0x51 0x55 0x56 0x59 0x5d 0x5e
            0x60 0x68 0x69 0x6c 0x6d 0x6e 0x71 0x75 0x76 0x79 0x7d 0x7e
            0x8c 0x8d 0x8e 0x91 0x94 0x95 0x96 0x99 0x9d
            0xac 0xad 0xae 0xb1 0xb4 0xb5 0xb6 0xb9 0xbc 0xbd 0xbe
            0xcc 0xcd 0xce 0xd1 0xd5 0xd6 0xd9 0xdd 0xde
            0xe9 0xec 0xed 0xee 0xf1 0xf5 0xf6 0xf9 0xfd 0xfe),
        case::TIA.. => store::<K>(opcode, case & 0x3f),
        _ => None,
    };
    // the documented opcodes except BRK and RTI
    function.or(functions!(K, opcode, case::ANY, case::ANY,
        0x01 0x05 0x06 0x08 0x09 0x0a 0x0d 0x0e 0x10 0x11 0x15 0x16 0x18 0x19 0x1d 0x1e
        0x20 0x21 0x24 0x25 0x26 0x28 0x29 0x2a 0x2c 0x2d 0x2e
        0x30 0x31 0x35 0x36 0x38 0x39 0x3d 0x3e
        0x41 0x45 0x46 0x48 0x49 0x4a 0x4c 0x4d 0x4e 0x50 0x51 0x55 0x56 0x58 0x59 0x5d 0x5e
        0x60 0x61 0x65 0x66 0x68 0x69 0x6a 0x6c 0x6d 0x6e 0x70 0x71 0x75 0x76 0x78 0x79 0x7d 0x7e
        0x81 0x84 0x85 0x86 0x88 0x8a 0x8c 0x8d 0x8e 0x90 0x91 0x94 0x95 0x96 0x98 0x99 0x9a 0x9d
        0xa0 0xa1 0xa2 0xa4 0xa5 0xa6 0xa8 0xa9 0xaa 0xac 0xad 0xae
        0xb0 0xb1 0xb4 0xb5 0xb6 0xb8 0xb9 0xba 0xbc 0xbd 0xbe
        0xc0 0xc1 0xc4 0xc5 0xc6 0xc8 0xc9 0xca 0xcc 0xcd 0xce
        0xd0 0xd1 0xd5 0xd6 0xd8 0xd9 0xdd 0xde
        0xe0 0xe1 0xe4 0xe5 0xe6 0xe8 0xe9 0xea 0xec 0xed 0xee
        0xf0 0xf1 0xf5 0xf6 0xf8 0xf9 0xfd 0xfe))
}

/// Returns the function for `STA`, `STX` or `STY` to a register of the TIA.
#[rustfmt::skip]
fn store<K: Kind>(opcode: u8, register: u8) -> Option<Run> {
    // registers whose writes usually change pixels
    let shown: Option<Run> = functions!(store K, opcode, case::TIA, register,
        0x00 0x01 0x06 0x07 0x08 0x09 0x0d 0x0e 0x0f 0x10 0x11 0x12 0x13 0x14 0x1b 0x1c 0x2a 0x2c);
    shown.or(functions!(store K, opcode, case::TIA_UNSEEN, register,
        0x02 0x03 0x04 0x05 0x0a 0x0b 0x0c 0x15 0x16 0x17 0x18 0x19 0x1a 0x1d 0x1e 0x1f
        0x20 0x21 0x22 0x23 0x24 0x25 0x26 0x27 0x28 0x29 0x2b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::instructions::{Instruction, Mode};
    use crate::screen::Screen;
    use crate::tia::{Display, Tia};

    /// A linear congruential generator.
    struct Random(u32);

    impl Random {
        fn below(&mut self, n: u32) -> u32 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (self.0 >> 8) % n
        }

        fn byte(&mut self) -> u8 {
            self.below(256) as u8
        }

        /// Returns an address in RAM, TIA, RIOT or ROM, or one that selects a bank, in a random
        /// mirror.
        fn address(&mut self) -> [u8; 2] {
            let address = match self.below(6) {
                0 => 0x80 + self.below(0x80),
                1 => self.below(0x40),
                2 => 0x280 + self.below(0x18),
                3 => 0x1fe0 + self.below(0x20),
                _ => 0x1000 + self.below(0x1000),
            };
            (address as u16 | (self.below(8) as u16) << 13).to_le_bytes()
        }

        /// Returns instructions of every kind and meaningless bytes.
        fn rom(&mut self) -> Vec<u8> {
            let mut rom = vec![];
            while rom.len() < ROM {
                let opcode = self.byte();
                let Instruction { operation, mode } = INSTRUCTIONS[usize::from(opcode)];
                let rare = matches!(
                    operation,
                    Operation::Jam | Operation::Brk | Operation::Rti | Operation::Txs
                );
                if rare && self.below(40) > 0 {
                    continue;
                }
                rom.push(opcode);
                match mode {
                    Mode::Implied => {}
                    Mode::Relative => rom.push((self.below(24) as u8).wrapping_sub(8)),
                    Mode::Absolute
                        if operation == Operation::Jmp || operation == Operation::Jsr =>
                    {
                        let address = 0x1000 | self.below(0x10000) as u16;
                        rom.extend(address.to_le_bytes());
                    }
                    Mode::Absolute | Mode::AbsoluteX | Mode::AbsoluteY | Mode::Indirect => {
                        rom.extend(self.address());
                    }
                    Mode::Immediate => rom.push(self.byte()),
                    Mode::ZeroPage
                    | Mode::ZeroPageX
                    | Mode::ZeroPageY
                    | Mode::IndirectX
                    | Mode::IndirectY => {
                        let address = self.byte();
                        rom.push(if address < 0x40 {
                            address
                        } else {
                            address | 0x80
                        });
                    }
                }
            }
            rom
        }
    }

    /// Returns the state of the whole console, as text.
    fn state(cpu: &Cpu, chips: &Chips, cartridge: &Cartridge) -> String {
        let tia = serde_json::to_string(&chips.tia).unwrap();
        let picture = crc32fast::hash(chips.screen.picture().as_flattened());
        let Chips {
            riot, frame_ended, ..
        } = chips;
        format!(
            "{cpu:?} {tia} {riot:?} {frame_ended} {:?} {picture}",
            cartridge.banks()
        )
    }

    #[test]
    fn blocks_do_what_the_interpreter_does() {
        let mut decoded = 0;
        for seed in 0..600 {
            let mut random = Random(seed);
            let scheme = [Scheme::Rom4K, Scheme::F8, Scheme::F6, Scheme::E0][seed as usize % 4];
            let mut cartridge = Cartridge::new(&random.rom(), scheme);
            let ram = std::array::from_fn(|_| random.byte());
            let mut chips = Chips {
                riot: Riot::new(ram, random.byte()),
                tia: Tia::new(Display::NTSC),
                screen: Screen::new(),
                frame_ended: false,
                continued: true,
            };
            let mut cpu = Cpu::new(0xf000 | random.below(0x1000) as u16);
            let blocks = Blocks::of(&cartridge);
            let (mut other_cpu, mut other_chips, mut other_cartridge) =
                (cpu, chips.clone(), cartridge.clone());
            for call in 0..60 {
                let most = 1 + random.below(700);
                run(&mut cpu, &mut chips, &mut cartridge, &blocks, most);
                interpret(&mut other_cpu, &mut other_chips, &mut other_cartridge, most);
                assert_eq!(
                    state(&cpu, &chips, &cartridge),
                    state(&other_cpu, &other_chips, &other_cartridge),
                    "program {seed} in {scheme:?}, call {call} of {most} instructions"
                );
                chips.frame_ended = false;
                other_chips.frame_ended = false;
                // jump elsewhere: many programs loop over few instructions
                if random.below(3) == 0 {
                    cpu.pc = random.below(0x10000) as u16;
                    cpu.s = random.byte();
                    (other_cpu.pc, other_cpu.s) = (cpu.pc, cpu.s);
                }
            }
            decoded += blocks
                .entries
                .iter()
                .filter(|block| block.get().is_some())
                .count();
        }
        assert!(decoded > 100_000, "{decoded} blocks were decoded");
    }
}
