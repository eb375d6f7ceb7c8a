//! The processor: a 6507, which is a 6502 without interrupt lines and with 13 address lines.
//!
//! It knows nothing of the machine around it. Each access of its [`Bus`] takes one cycle, in the order of the real
//! chip, reads of no use included: some of them switch the banks of a cartridge.
//!
//! Source: MCS6500 Microcomputer Family Programming Manual (MOS Technology, 1976) for what is documented.

mod decimal;
mod instructions;

use std::marker::PhantomData;

use serde::{Deserialize, Serialize};

use instructions::{Access, INSTRUCTIONS, Mode, Operation};

/// What the processor is wired to. Each call takes one cycle.
pub trait Bus {
    /// Reads a byte.
    fn read(&mut self, address: u16) -> u8;
    /// Writes a byte.
    fn write(&mut self, address: u16, value: u8);
    /// Lets a cycle pass without an access.
    fn idle(&mut self);
}

/// Flags of the status register, by their bit.
mod flag {
    pub(super) const C: u8 = 1 << 0;
    pub(super) const Z: u8 = 1 << 1;
    pub(super) const I: u8 = 1 << 2;
    pub(super) const D: u8 = 1 << 3;
    pub(super) const B: u8 = 1 << 4;
    /// Has no name; reads as 1.
    pub(super) const UNUSED: u8 = 1 << 5;
    pub(super) const V: u8 = 1 << 6;
    pub(super) const N: u8 = 1 << 7;
}

/// The registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cpu {
    /// The program counter.
    pub pc: u16,
    /// The accumulator.
    pub a: u8,
    /// Index X.
    pub x: u8,
    /// Index Y.
    pub y: u8,
    /// The stack pointer, into page 1.
    pub s: u8,
    carry: bool,
    interrupt_disable: bool,
    decimal: bool,
    overflow: bool,
    /// The last result: its bit 7 is the flag N.
    negative: u8,
    /// The last result: the flag Z is set where it is 0.
    zero: u8,
}

impl Cpu {
    /// A processor that starts at `pc`.
    pub fn new(pc: u16) -> Self {
        Self {
            pc,
            a: 0,
            x: 0,
            y: 0,
            s: 0xff,
            carry: false,
            interrupt_disable: false,
            decimal: false,
            overflow: false,
            negative: 0,
            zero: 1,
        }
    }

    /// Executes one instruction.
    #[inline]
    pub fn step<B: Bus>(&mut self, bus: &mut B) {
        let opcode = self.fetch(bus);
        Handlers::<B>::BY_OPCODE[usize::from(opcode)](self, bus);
    }

    /// The status register, as `PHP` pushes it.
    pub fn status(&self) -> u8 {
        let bit = |set: bool, bit: u8| if set { bit } else { 0 };
        (self.negative & flag::N)
            | bit(self.overflow, flag::V)
            | flag::UNUSED
            | flag::B
            | bit(self.decimal, flag::D)
            | bit(self.interrupt_disable, flag::I)
            | bit(self.zero == 0, flag::Z)
            | bit(self.carry, flag::C)
    }

    fn set_status(&mut self, p: u8) {
        self.negative = p & flag::N;
        self.overflow = p & flag::V != 0;
        self.decimal = p & flag::D != 0;
        self.interrupt_disable = p & flag::I != 0;
        self.zero = !p & flag::Z;
        self.carry = p & flag::C != 0;
    }

    #[inline(always)]
    fn fetch(&mut self, bus: &mut impl Bus) -> u8 {
        let byte = bus.read(self.pc);
        self.pc = self.pc.wrapping_add(1);
        byte
    }

    #[inline(always)]
    fn push(&mut self, bus: &mut impl Bus, value: u8) {
        bus.write(0x100 | u16::from(self.s), value);
        self.s = self.s.wrapping_sub(1);
    }

    #[inline(always)]
    fn pull(&mut self, bus: &mut impl Bus) -> u8 {
        self.s = self.s.wrapping_add(1);
        bus.read(0x100 | u16::from(self.s))
    }

    /// Sets N and Z by `value`.
    #[inline(always)]
    fn flags(&mut self, value: u8) -> u8 {
        self.negative = value;
        self.zero = value;
        value
    }

    /// Where an instruction of this mode works, and the address before the index was added.
    #[inline(always)]
    fn address(&mut self, bus: &mut impl Bus, mode: Mode, access: Access) -> Address {
        let plain = |at: u16| Address { at, base: at };
        match mode {
            Mode::Immediate => {
                let at = self.pc;
                self.pc = self.pc.wrapping_add(1);
                plain(at)
            }
            Mode::ZeroPage => plain(u16::from(self.fetch(bus))),
            Mode::ZeroPageX => plain(self.zero_page_indexed(bus, self.x)),
            Mode::ZeroPageY => plain(self.zero_page_indexed(bus, self.y)),
            Mode::Absolute => plain(self.fetch_word(bus)),
            Mode::AbsoluteX => {
                let base = self.fetch_word(bus);
                indexed(bus, base, self.x, access)
            }
            Mode::AbsoluteY => {
                let base = self.fetch_word(bus);
                indexed(bus, base, self.y, access)
            }
            Mode::IndirectX => {
                let pointer = self.zero_page_indexed(bus, self.x);
                plain(zero_page_word(bus, pointer as u8))
            }
            Mode::IndirectY => {
                let pointer = self.fetch(bus);
                let base = zero_page_word(bus, pointer);
                indexed(bus, base, self.y, access)
            }
            Mode::Implied | Mode::Indirect | Mode::Relative => plain(0),
        }
    }

    #[inline(always)]
    fn fetch_word(&mut self, bus: &mut impl Bus) -> u16 {
        u16::from_le_bytes([self.fetch(bus), self.fetch(bus)])
    }

    #[inline(always)]
    fn zero_page_indexed(&mut self, bus: &mut impl Bus, index: u8) -> u16 {
        let base = self.fetch(bus);
        bus.read(u16::from(base));
        u16::from(base.wrapping_add(index))
    }

    /// Takes the branch, or not.
    #[inline(always)]
    fn branch(&mut self, bus: &mut impl Bus, taken: bool) {
        let offset = self.fetch(bus) as i8;
        if taken {
            bus.read(self.pc);
            let target = self.pc.wrapping_add_signed(i16::from(offset));
            if (target ^ self.pc) & 0xff00 != 0 {
                bus.read((self.pc & 0xff00) | (target & 0x00ff));
            }
            self.pc = target;
        }
    }

    #[inline(always)]
    fn compare(&mut self, register: u8, value: u8) {
        self.carry = register >= value;
        self.flags(register.wrapping_sub(value));
    }

    #[inline(always)]
    fn adc(&mut self, value: u8) {
        if self.decimal {
            self.adc_decimal(value);
        } else {
            self.adc_binary(value);
        }
    }

    #[inline(always)]
    fn sbc(&mut self, value: u8) {
        if self.decimal {
            self.sbc_decimal(value);
        } else {
            self.adc_binary(!value);
        }
    }

    #[inline(always)]
    fn adc_binary(&mut self, value: u8) {
        let sum = u16::from(self.a) + u16::from(value) + u16::from(self.carry);
        let result = sum as u8;
        self.overflow = !(self.a ^ value) & (self.a ^ result) & 0x80 != 0;
        self.carry = sum > 0xff;
        self.a = self.flags(result);
    }

    #[inline(always)]
    fn asl(&mut self, value: u8) -> u8 {
        self.carry = value & 0x80 != 0;
        self.flags(value << 1)
    }

    #[inline(always)]
    fn lsr(&mut self, value: u8) -> u8 {
        self.carry = value & 0x01 != 0;
        self.flags(value >> 1)
    }

    #[inline(always)]
    fn rol(&mut self, value: u8) -> u8 {
        let carry = u8::from(self.carry);
        self.carry = value & 0x80 != 0;
        self.flags(value << 1 | carry)
    }

    #[inline(always)]
    fn ror(&mut self, value: u8) -> u8 {
        let carry = u8::from(self.carry);
        self.carry = value & 0x01 != 0;
        self.flags(value >> 1 | carry << 7)
    }

    /// `ARR`: `AND`, then a rotation with flags of its own.
    fn arr(&mut self, value: u8) {
        let masked = self.a & value;
        let rotated = masked >> 1 | u8::from(self.carry) << 7;
        self.flags(rotated);
        self.a = rotated;
        if self.decimal {
            self.arr_decimal(masked);
        } else {
            self.carry = rotated & 0x40 != 0;
            self.overflow = (rotated ^ rotated << 1) & 0x40 != 0;
        }
    }

    /// Operations that read a byte.
    #[inline(always)]
    fn with_value(&mut self, operation: Operation, value: u8) {
        match operation {
            Operation::Adc => self.adc(value),
            Operation::And => self.a = self.flags(self.a & value),
            Operation::Bit => {
                self.negative = value;
                self.overflow = value & 0x40 != 0;
                self.zero = self.a & value;
            }
            Operation::Cmp => self.compare(self.a, value),
            Operation::Cpx => self.compare(self.x, value),
            Operation::Cpy => self.compare(self.y, value),
            Operation::Eor => self.a = self.flags(self.a ^ value),
            Operation::Lda => self.a = self.flags(value),
            Operation::Ldx => self.x = self.flags(value),
            Operation::Ldy => self.y = self.flags(value),
            Operation::Ora => self.a = self.flags(self.a | value),
            Operation::Sbc => self.sbc(value),
            Operation::Alr => self.a = self.lsr(self.a & value),
            Operation::Anc => {
                self.a = self.flags(self.a & value);
                self.carry = self.a & 0x80 != 0;
            }
            Operation::Ane => self.a = self.flags((self.a | 0xee) & self.x & value),
            Operation::Arr => self.arr(value),
            Operation::Las => {
                self.s &= value;
                self.a = self.flags(self.s);
                self.x = self.s;
            }
            Operation::Lax => {
                self.a = self.flags(value);
                self.x = value;
            }
            Operation::Lxa => {
                self.a = self.flags((self.a | 0xee) & value);
                self.x = self.a;
            }
            Operation::Sbx => {
                let both = self.a & self.x;
                self.compare(both, value);
                self.x = both.wrapping_sub(value);
            }
            _ => {} // NOP reads as well
        }
    }

    /// The byte that an operation writes.
    #[inline(always)]
    fn stored(&mut self, operation: Operation, base: u16) -> u8 {
        // the four unstable ones mix in the address's high byte, plus 1
        let high = ((base >> 8) as u8).wrapping_add(1);
        match operation {
            Operation::Sta => self.a,
            Operation::Stx => self.x,
            Operation::Sty => self.y,
            Operation::Sax => self.a & self.x,
            Operation::Sha => self.a & self.x & high,
            Operation::Shx => self.x & high,
            Operation::Shy => self.y & high,
            _ => {
                // TAS
                self.s = self.a & self.x;
                self.s & high
            }
        }
    }

    /// Operations that change a byte of memory, or the accumulator.
    #[inline(always)]
    fn modified(&mut self, operation: Operation, value: u8) -> u8 {
        match operation {
            Operation::Asl => self.asl(value),
            Operation::Dec => self.flags(value.wrapping_sub(1)),
            Operation::Inc => self.flags(value.wrapping_add(1)),
            Operation::Lsr => self.lsr(value),
            Operation::Rol => self.rol(value),
            Operation::Ror => self.ror(value),
            Operation::Dcp => {
                let result = value.wrapping_sub(1);
                self.compare(self.a, result);
                result
            }
            Operation::Isb => {
                let result = value.wrapping_add(1);
                self.sbc(result);
                result
            }
            Operation::Rla => {
                let result = self.rol(value);
                self.a = self.flags(self.a & result);
                result
            }
            Operation::Rra => {
                let result = self.ror(value);
                self.adc(result);
                result
            }
            Operation::Slo => {
                let result = self.asl(value);
                self.a = self.flags(self.a | result);
                result
            }
            _ => {
                // SRE
                let result = self.lsr(value);
                self.a = self.flags(self.a ^ result);
                result
            }
        }
    }

    /// Operations on registers, flags and the stack, and jumps.
    #[inline(always)]
    fn implied(&mut self, bus: &mut impl Bus, operation: Operation) {
        bus.read(self.pc);
        match operation {
            Operation::Clc => self.carry = false,
            Operation::Cld => self.decimal = false,
            Operation::Cli => self.interrupt_disable = false,
            Operation::Clv => self.overflow = false,
            Operation::Sec => self.carry = true,
            Operation::Sed => self.decimal = true,
            Operation::Sei => self.interrupt_disable = true,
            Operation::Dex => self.x = self.flags(self.x.wrapping_sub(1)),
            Operation::Dey => self.y = self.flags(self.y.wrapping_sub(1)),
            Operation::Inx => self.x = self.flags(self.x.wrapping_add(1)),
            Operation::Iny => self.y = self.flags(self.y.wrapping_add(1)),
            Operation::Tax => self.x = self.flags(self.a),
            Operation::Tay => self.y = self.flags(self.a),
            Operation::Tsx => self.x = self.flags(self.s),
            Operation::Txa => self.a = self.flags(self.x),
            Operation::Txs => self.s = self.x,
            Operation::Tya => self.a = self.flags(self.y),
            Operation::Pha => self.push(bus, self.a),
            Operation::Php => self.push(bus, self.status()),
            Operation::Pla => {
                self.skip_stack(bus);
                let value = self.pull(bus);
                self.a = self.flags(value);
            }
            Operation::Plp => {
                self.skip_stack(bus);
                let value = self.pull(bus);
                self.set_status(value);
            }
            Operation::Brk => {
                self.pc = self.pc.wrapping_add(1);
                self.push_pc(bus);
                self.push(bus, self.status());
                self.interrupt_disable = true;
                self.pc = u16::from_le_bytes([bus.read(0xfffe), bus.read(0xffff)]);
            }
            Operation::Rti => {
                self.skip_stack(bus);
                let value = self.pull(bus);
                self.set_status(value);
                self.pull_pc(bus);
            }
            Operation::Rts => {
                self.skip_stack(bus);
                self.pull_pc(bus);
                self.fetch(bus);
            }
            Operation::Nop | Operation::Jam => {}
            // the accumulator as operand
            _ => self.a = self.modified(operation, self.a),
        }
    }

    fn skip_stack(&self, bus: &mut impl Bus) {
        bus.read(0x100 | u16::from(self.s));
    }

    fn push_pc(&mut self, bus: &mut impl Bus) {
        let [low, high] = self.pc.to_le_bytes();
        self.push(bus, high);
        self.push(bus, low);
    }

    fn pull_pc(&mut self, bus: &mut impl Bus) {
        self.pc = u16::from_le_bytes([self.pull(bus), self.pull(bus)]);
    }

    fn jsr(&mut self, bus: &mut impl Bus) {
        let low = self.fetch(bus);
        self.skip_stack(bus);
        self.push_pc(bus);
        self.pc = u16::from_le_bytes([low, bus.read(self.pc)]);
    }

    /// `JMP ($12FF)` reads its high byte from `$1200`.
    fn jump_indirect(&mut self, bus: &mut impl Bus) {
        let pointer = self.fetch_word(bus);
        let low = bus.read(pointer);
        let high = bus.read((pointer & 0xff00) | (pointer.wrapping_add(1) & 0x00ff));
        self.pc = u16::from_le_bytes([low, high]);
    }
}

/// An operand's address, and what it was before the index was added.
#[derive(Clone, Copy)]
struct Address {
    at: u16,
    base: u16,
}

/// Adds an index to an address. The processor first reads without the carry into the page: where a page is
/// crossed, and always ahead of a write.
#[inline(always)]
fn indexed(bus: &mut impl Bus, base: u16, index: u8, access: Access) -> Address {
    let at = base.wrapping_add(u16::from(index));
    let without_carry = (base & 0xff00) | (at & 0x00ff);
    if access != Access::Read || at != without_carry {
        bus.read(without_carry);
    }
    Address { at, base }
}

#[inline(always)]
fn zero_page_word(bus: &mut impl Bus, pointer: u8) -> u16 {
    u16::from_le_bytes([bus.read(u16::from(pointer)), bus.read(u16::from(pointer.wrapping_add(1)))])
}

/// Executes the instruction of an opcode that was just fetched. The compiler knows the opcode, so that of
/// all matches on operations and modes only one arm is left.
fn execute<B: Bus, const OPCODE: usize>(cpu: &mut Cpu, bus: &mut B) {
    let operation = const { INSTRUCTIONS[OPCODE].operation };
    let mode = const { INSTRUCTIONS[OPCODE].mode };
    match (operation, mode) {
        (Operation::Jsr, _) => cpu.jsr(bus),
        (Operation::Jmp, Mode::Absolute) => cpu.pc = cpu.fetch_word(bus),
        (Operation::Jmp, _) => cpu.jump_indirect(bus),
        (Operation::Bcc, _) => cpu.branch(bus, !cpu.carry),
        (Operation::Bcs, _) => cpu.branch(bus, cpu.carry),
        (Operation::Beq, _) => cpu.branch(bus, cpu.zero == 0),
        (Operation::Bmi, _) => cpu.branch(bus, cpu.negative & flag::N != 0),
        (Operation::Bne, _) => cpu.branch(bus, cpu.zero != 0),
        (Operation::Bpl, _) => cpu.branch(bus, cpu.negative & flag::N == 0),
        (Operation::Bvc, _) => cpu.branch(bus, !cpu.overflow),
        (Operation::Bvs, _) => cpu.branch(bus, cpu.overflow),
        (_, Mode::Implied) => cpu.implied(bus, operation),
        _ => {
            let access = const { INSTRUCTIONS[OPCODE].operation.access() };
            let Address { at, base } = cpu.address(bus, mode, access);
            match access {
                Access::Read => {
                    let value = bus.read(at);
                    cpu.with_value(operation, value);
                }
                Access::Write => {
                    let value = cpu.stored(operation, base);
                    bus.write(at, value);
                }
                Access::Modify => {
                    let value = bus.read(at);
                    bus.idle();
                    let value = cpu.modified(operation, value);
                    bus.write(at, value);
                }
            }
        }
    }
}

/// [`execute`] for each opcode, on one kind of bus.
struct Handlers<B>(PhantomData<B>);

type Handler<B> = fn(&mut Cpu, &mut B);

/// The 16 opcodes from `$high * 16` on, for each `$high`.
macro_rules! by_opcode {
    ($bus:ident: $($high:literal)*) => { [$(
        execute::<$bus, { $high * 16 }>, execute::<$bus, { $high * 16 + 1 }>,
        execute::<$bus, { $high * 16 + 2 }>, execute::<$bus, { $high * 16 + 3 }>,
        execute::<$bus, { $high * 16 + 4 }>, execute::<$bus, { $high * 16 + 5 }>,
        execute::<$bus, { $high * 16 + 6 }>, execute::<$bus, { $high * 16 + 7 }>,
        execute::<$bus, { $high * 16 + 8 }>, execute::<$bus, { $high * 16 + 9 }>,
        execute::<$bus, { $high * 16 + 10 }>, execute::<$bus, { $high * 16 + 11 }>,
        execute::<$bus, { $high * 16 + 12 }>, execute::<$bus, { $high * 16 + 13 }>,
        execute::<$bus, { $high * 16 + 14 }>, execute::<$bus, { $high * 16 + 15 }>,
    )*] };
}

impl<B: Bus> Handlers<B> {
    const BY_OPCODE: [Handler<B>; 256] = by_opcode!(B: 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15);
}
