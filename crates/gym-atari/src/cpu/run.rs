//! Executing instructions: fetching, addressing, and the bus access of each cycle.

use super::instructions::{Access, INSTRUCTIONS, LENGTHS, Mode, Operation};
use super::{Bus, Cpu, Ready, flag};

/// A running processor. Its registers are a copy, so that the compiler can keep them in machine
/// registers.
pub(crate) struct Core<B> {
    pub(crate) cpu: Cpu,
    pub(crate) bus: B,
    /// The number of instructions that may still be executed.
    pub(crate) left: u32,
    /// Whether a write returned [`Ready::Return`], or the processor halted.
    pub(crate) stopped: bool,
}

/// The opcode of `LAX $12`.
const LAX_ZERO_PAGE: u8 = 0xa7;
/// The bytes of a loop that waits for a register, such as `LDA INTIM` and a `BNE` back to `LDA`;
/// and the cycles of one iteration.
const LOOP_BYTES: i8 = 5;
const LOOP_CYCLES: u64 = 7;

impl Cpu {
    /// Executes at most `most` instructions; stops early when a write returns [`Ready::Return`] or
    /// the processor halts. Returns whether it stopped early.
    #[inline(never)]
    pub fn run<B: Bus>(&mut self, bus: B, most: u32) -> bool {
        let mut core = Core {
            cpu: *self,
            bus,
            left: most,
            stopped: false,
        };
        while core.left > 0 {
            core.left -= 1;
            core.step();
        }
        *self = core.cpu;
        core.stopped
    }
}

/// Matches the opcode, with one arm per opcode. The opcode is a constant in each arm, so the
/// compiler removes all other branches on operation and mode.
macro_rules! dispatch {
    ($core:ident, $opcode:ident, $low:ident, $high:ident: $($code:literal)*) => {
        match $opcode { $($code => $core.execute::<$code>($low, $high),)* }
    };
}

impl<B: Bus> Core<B> {
    #[inline(always)]
    #[rustfmt::skip]
    fn step(&mut self) {
        let [opcode, low, high, _] = match self.bus.program(self.cpu.pc) {
            Some(bytes) => bytes,
            None => self.fetch(),
        };
        dispatch!(self, opcode, low, high:
            0x00 0x01 0x02 0x03 0x04 0x05 0x06 0x07 0x08 0x09 0x0a 0x0b 0x0c 0x0d 0x0e 0x0f
            0x10 0x11 0x12 0x13 0x14 0x15 0x16 0x17 0x18 0x19 0x1a 0x1b 0x1c 0x1d 0x1e 0x1f
            0x20 0x21 0x22 0x23 0x24 0x25 0x26 0x27 0x28 0x29 0x2a 0x2b 0x2c 0x2d 0x2e 0x2f
            0x30 0x31 0x32 0x33 0x34 0x35 0x36 0x37 0x38 0x39 0x3a 0x3b 0x3c 0x3d 0x3e 0x3f
            0x40 0x41 0x42 0x43 0x44 0x45 0x46 0x47 0x48 0x49 0x4a 0x4b 0x4c 0x4d 0x4e 0x4f
            0x50 0x51 0x52 0x53 0x54 0x55 0x56 0x57 0x58 0x59 0x5a 0x5b 0x5c 0x5d 0x5e 0x5f
            0x60 0x61 0x62 0x63 0x64 0x65 0x66 0x67 0x68 0x69 0x6a 0x6b 0x6c 0x6d 0x6e 0x6f
            0x70 0x71 0x72 0x73 0x74 0x75 0x76 0x77 0x78 0x79 0x7a 0x7b 0x7c 0x7d 0x7e 0x7f
            0x80 0x81 0x82 0x83 0x84 0x85 0x86 0x87 0x88 0x89 0x8a 0x8b 0x8c 0x8d 0x8e 0x8f
            0x90 0x91 0x92 0x93 0x94 0x95 0x96 0x97 0x98 0x99 0x9a 0x9b 0x9c 0x9d 0x9e 0x9f
            0xa0 0xa1 0xa2 0xa3 0xa4 0xa5 0xa6 0xa7 0xa8 0xa9 0xaa 0xab 0xac 0xad 0xae 0xaf
            0xb0 0xb1 0xb2 0xb3 0xb4 0xb5 0xb6 0xb7 0xb8 0xb9 0xba 0xbb 0xbc 0xbd 0xbe 0xbf
            0xc0 0xc1 0xc2 0xc3 0xc4 0xc5 0xc6 0xc7 0xc8 0xc9 0xca 0xcb 0xcc 0xcd 0xce 0xcf
            0xd0 0xd1 0xd2 0xd3 0xd4 0xd5 0xd6 0xd7 0xd8 0xd9 0xda 0xdb 0xdc 0xdd 0xde 0xdf
            0xe0 0xe1 0xe2 0xe3 0xe4 0xe5 0xe6 0xe7 0xe8 0xe9 0xea 0xeb 0xec 0xed 0xee 0xef
            0xf0 0xf1 0xf2 0xf3 0xf4 0xf5 0xf6 0xf7 0xf8 0xf9 0xfa 0xfb 0xfc 0xfd 0xfe 0xff
        );
    }

    #[inline(always)]
    fn read(&mut self, address: u16) -> u8 {
        self.cpu.cycle += 1;
        self.cpu.bus = self.bus.read(address, self.cpu.cycle, self.cpu.bus);
        self.cpu.bus
    }

    /// Makes a dummy read.
    #[inline(always)]
    fn touch(&mut self, address: u16) {
        self.read(address);
    }

    #[inline(always)]
    fn stop(&mut self) {
        self.left = 0;
        self.stopped = true;
    }

    #[inline(always)]
    fn write(&mut self, address: u16, value: u8) {
        self.cpu.cycle += 1;
        self.cpu.bus = value;
        match self.bus.write(address, value, self.cpu.cycle) {
            Ready::Now => {}
            Ready::After(cycles) => self.cpu.cycle += u64::from(cycles),
            Ready::Return(cycles) => {
                self.cpu.cycle += u64::from(cycles);
                self.stop();
            }
        }
    }

    /// Fetches an instruction whose bytes are not all in ROM within one window. If the instruction
    /// has one byte, the processor reads the next byte too. The reads happen at the cycles that
    /// [`execute`](Self::execute) counts.
    #[inline(always)]
    fn fetch(&mut self) -> [u8; 4] {
        let Cpu { pc, cycle, .. } = self.cpu;
        let mut read = |i: u16| {
            self.cpu.bus =
                self.bus
                    .read(pc.wrapping_add(i), cycle + 1 + u64::from(i), self.cpu.bus);
            self.cpu.bus
        };
        let opcode = read(0);
        let low = read(1);
        let high = if LENGTHS[usize::from(opcode)] == 3 {
            read(2)
        } else {
            0
        };
        [opcode, low, high, 0]
    }

    #[inline(always)]
    fn push(&mut self, value: u8) {
        self.write(0x100 | u16::from(self.cpu.s), value);
        self.cpu.s = self.cpu.s.wrapping_sub(1);
    }

    #[inline(always)]
    fn pull(&mut self) -> u8 {
        self.cpu.s = self.cpu.s.wrapping_add(1);
        self.read(0x100 | u16::from(self.cpu.s))
    }

    #[inline(always)]
    fn touch_stack(&mut self) {
        self.touch(0x100 | u16::from(self.cpu.s));
    }

    #[inline(always)]
    fn push_pc(&mut self) {
        let [low, high] = self.cpu.pc.to_le_bytes();
        self.push(high);
        self.push(low);
    }

    #[inline(always)]
    fn pull_pc(&mut self) {
        self.cpu.pc = u16::from_le_bytes([self.pull(), self.pull()]);
    }

    /// Returns the address of an instruction's operand; `low` and `high` are the bytes after the
    /// opcode.
    #[inline(always)]
    fn address(&mut self, mode: Mode, access: Access, low: u8, high: u8) -> u16 {
        let word = u16::from_le_bytes([low, high]);
        match mode {
            Mode::ZeroPage => u16::from(low),
            Mode::ZeroPageX => self.zero_page_indexed(low, self.cpu.x),
            Mode::ZeroPageY => self.zero_page_indexed(low, self.cpu.y),
            Mode::Absolute => word,
            Mode::AbsoluteX => self.indexed(word, self.cpu.x, access),
            Mode::AbsoluteY => self.indexed(word, self.cpu.y, access),
            Mode::IndirectX => {
                let pointer = self.zero_page_indexed(low, self.cpu.x);
                self.zero_page_word(pointer as u8)
            }
            Mode::IndirectY => {
                let base = self.zero_page_word(low);
                self.indexed(base, self.cpu.y, access)
            }
            Mode::Immediate | Mode::Implied | Mode::Indirect | Mode::Relative => 0,
        }
    }

    #[inline(always)]
    fn zero_page_indexed(&mut self, base: u8, index: u8) -> u16 {
        self.touch(u16::from(base));
        u16::from(base.wrapping_add(index))
    }

    #[inline(always)]
    fn zero_page_word(&mut self, pointer: u8) -> u16 {
        u16::from_le_bytes([
            self.read_pointer(pointer),
            self.read_pointer(pointer.wrapping_add(1)),
        ])
    }

    #[inline(always)]
    fn read_pointer(&mut self, address: u8) -> u8 {
        self.cpu.cycle += 1;
        self.cpu.bus = self.bus.read_pointer(address, self.cpu.cycle, self.cpu.bus);
        self.cpu.bus
    }

    /// Adds an index to an address. The processor first makes a dummy read without the carry into
    /// the high byte, if a page is crossed, and always before a write.
    #[inline(always)]
    fn indexed(&mut self, base: u16, index: u8, access: Access) -> u16 {
        let at = base.wrapping_add(u16::from(index));
        let without_carry = (base & 0xff00) | (at & 0x00ff);
        if access != Access::Read || at != without_carry {
            self.touch(without_carry);
        }
        at
    }

    /// Executes the instruction of an opcode; `low` and `high` are the bytes after it.
    #[inline(always)]
    pub(crate) fn execute<const OPCODE: u8>(&mut self, low: u8, high: u8) {
        let operation = const { INSTRUCTIONS[OPCODE as usize].operation };
        let mode = const { INSTRUCTIONS[OPCODE as usize].mode };
        let length = const { LENGTHS[OPCODE as usize] };
        // a one-byte instruction reads the next byte too
        self.cpu.pc = self.cpu.pc.wrapping_add(u16::from(length));
        self.cpu.cycle += u64::from(length.max(2));
        self.cpu.bus = if length == 3 { high } else { low };
        match (operation, mode) {
            (Operation::Jsr, _) => self.jsr(low),
            (Operation::Jmp, Mode::Absolute) => self.cpu.pc = u16::from_le_bytes([low, high]),
            (Operation::Jmp, _) => self.jump_indirect(u16::from_le_bytes([low, high])),
            (Operation::Bcc, _) => self.branch(!self.cpu.carry, low),
            (Operation::Bcs, _) => self.branch(self.cpu.carry, low),
            (Operation::Beq, _) => self.branch(self.cpu.is_zero(), low),
            (Operation::Bmi, _) => self.branch(self.cpu.is_negative(), low),
            (Operation::Bne, _) => self.branch(!self.cpu.is_zero(), low),
            (Operation::Bpl, _) => self.branch(!self.cpu.is_negative(), low),
            (Operation::Bvc, _) => self.branch(!self.cpu.overflow, low),
            (Operation::Bvs, _) => self.branch(self.cpu.overflow, low),
            (_, Mode::Implied) => self.implied(operation),
            (_, Mode::Immediate) => self.cpu.with_value(operation, low),
            _ => {
                let access = const { INSTRUCTIONS[OPCODE as usize].operation.access() };
                let at = self.address(mode, access, low, high);
                match access {
                    Access::Read => {
                        let value = self.read(at);
                        self.cpu.with_value(operation, value);
                        // one cycle more in ale-py than on the chip
                        self.cpu.cycle += u64::from(OPCODE == LAX_ZERO_PAGE);
                    }
                    Access::Write => {
                        let value = self.cpu.stored(operation, at);
                        self.write(at, value);
                    }
                    Access::Modify => {
                        let value = self.read(at);
                        self.cpu.cycle += 1;
                        let value = self.cpu.modified(operation, value);
                        self.write(at, value);
                    }
                }
            }
        }
    }

    /// Takes the branch if `taken`.
    #[inline(always)]
    fn branch(&mut self, taken: bool, offset: u8) {
        if taken {
            let offset = offset as i8;
            let pc = self.cpu.pc;
            self.touch(pc);
            let target = pc.wrapping_add_signed(i16::from(offset));
            if (target ^ pc) & 0xff00 != 0 {
                self.touch((pc & 0xff00) | (target & 0x00ff));
            } else if offset == -LOOP_BYTES {
                let rounds = self.rounds_without_change(target).min(self.left / 2);
                self.cpu.cycle += LOOP_CYCLES * u64::from(rounds);
                self.left -= 2 * rounds;
            }
            self.cpu.pc = target;
        }
    }

    /// Returns the number of further iterations of a waiting loop, which has just branched to its
    /// start, that will read the same value.
    #[inline(always)]
    fn rounds_without_change(&self, start: u16) -> u32 {
        let Cpu {
            a,
            x,
            y,
            overflow,
            result,
            ..
        } = self.cpu;
        let Some([opcode @ (0xad | 0xae | 0xac | 0x2c), low, high, _]) = self.bus.program(start)
        else {
            return 0;
        };
        // the register was read three cycles before the end of the branch
        let last_read = self.cpu.cycle - 3;
        let Some((value, until)) = self.bus.steady(u16::from_le_bytes([low, high]), last_read)
        else {
            return 0;
        };
        // the state may come from a jump to the branch rather than from the loop
        let found = match opcode {
            0xad => a == value && result == u16::from(value), // LDA
            0xae => x == value && result == u16::from(value), // LDX
            0xac => y == value && result == u16::from(value), // LDY
            // BIT
            _ => {
                let bits = u16::from(value & flag::N) << 8 | u16::from(a & value);
                result == bits && overflow == (value & flag::V != 0)
            }
        };
        if found {
            ((until - last_read) / LOOP_CYCLES) as u32
        } else {
            0
        }
    }

    /// Executes operations on registers, flags and stack, and jumps.
    #[inline(always)]
    fn implied(&mut self, operation: Operation) {
        let cpu = &mut self.cpu;
        match operation {
            Operation::Clc => cpu.carry = false,
            Operation::Cld => cpu.decimal = false,
            Operation::Cli => cpu.interrupt_disable = false,
            Operation::Clv => cpu.overflow = false,
            Operation::Sec => cpu.carry = true,
            Operation::Sed => cpu.decimal = true,
            Operation::Sei => cpu.interrupt_disable = true,
            Operation::Dex => cpu.x = cpu.flags(cpu.x.wrapping_sub(1)),
            Operation::Dey => cpu.y = cpu.flags(cpu.y.wrapping_sub(1)),
            Operation::Inx => cpu.x = cpu.flags(cpu.x.wrapping_add(1)),
            Operation::Iny => cpu.y = cpu.flags(cpu.y.wrapping_add(1)),
            Operation::Tax => cpu.x = cpu.flags(cpu.a),
            Operation::Tay => cpu.y = cpu.flags(cpu.a),
            Operation::Tsx => cpu.x = cpu.flags(cpu.s),
            Operation::Txa => cpu.a = cpu.flags(cpu.x),
            Operation::Txs => cpu.s = cpu.x,
            Operation::Tya => cpu.a = cpu.flags(cpu.y),
            Operation::Pha => self.push(self.cpu.a),
            Operation::Php => self.push(self.cpu.status()),
            Operation::Pla => {
                self.touch_stack();
                let value = self.pull();
                self.cpu.a = self.cpu.flags(value);
            }
            Operation::Plp => {
                self.touch_stack();
                let value = self.pull();
                self.cpu.set_status(value);
            }
            Operation::Brk => {
                self.cpu.pc = self.cpu.pc.wrapping_add(1);
                self.push_pc();
                self.push(self.cpu.status());
                self.cpu.interrupt_disable = true;
                self.cpu.pc = u16::from_le_bytes([self.read(0xfffe), self.read(0xffff)]);
            }
            Operation::Rti => {
                self.touch_stack();
                let value = self.pull();
                self.cpu.set_status(value);
                self.pull_pc();
            }
            Operation::Rts => {
                self.touch_stack();
                self.pull_pc();
                self.touch(self.cpu.pc);
                self.cpu.pc = self.cpu.pc.wrapping_add(1);
            }
            Operation::Nop => {}
            // repeats forever: the next call executes the instruction again
            Operation::Jam => {
                self.cpu.pc = self.cpu.pc.wrapping_sub(1);
                self.stop();
            }
            // the operand is the accumulator
            _ => cpu.a = cpu.modified(operation, cpu.a),
        }
    }

    #[inline(always)]
    fn jsr(&mut self, low: u8) {
        self.touch_stack();
        self.push_pc();
        self.cpu.pc = u16::from_le_bytes([low, self.read(self.cpu.pc)]);
    }

    /// `JMP ($12FF)` reads its high byte from `$1200`.
    #[inline(always)]
    fn jump_indirect(&mut self, pointer: u16) {
        let low = self.read(pointer);
        let high = self.read((pointer & 0xff00) | (pointer.wrapping_add(1) & 0x00ff));
        self.cpu.pc = u16::from_le_bytes([low, high]);
    }
}
