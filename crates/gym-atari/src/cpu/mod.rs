//! The processor: a 6507, which is a 6502 without interrupt lines and with 13 address lines.
//!
//! The processor does not depend on the machine. Each access of its [`Bus`] takes one cycle, in the
//! order of the real chip, including dummy reads: some of them switch a cartridge's banks.
//!
//! Source: MCS6500 Microcomputer Family Programming Manual (MOS Technology, 1976) for the
//! documented instructions.

mod decimal;
pub(crate) mod instructions;
pub(crate) mod run;

use serde::{Deserialize, Serialize};

use instructions::Operation;

/// The bus of the processor. Each access takes one cycle. `cycle` is the number of cycles from
/// power-on to the end of the access, `bus` the byte of the previous access.
pub trait Bus {
    /// Reads a byte.
    fn read(&mut self, address: u16, cycle: u64, bus: u8) -> u8;

    /// Reads a byte of a pointer in page 0.
    #[inline(always)]
    fn read_pointer(&mut self, address: u8, cycle: u64, bus: u8) -> u8 {
        self.read(u16::from(address), cycle, bus)
    }

    /// Writes a byte.
    fn write(&mut self, address: u16, value: u8, cycle: u64) -> Ready;

    /// Returns the four bytes from `address` on, if they never change and reading them has no side
    /// effect.
    #[inline(always)]
    fn program(&self, _address: u16) -> Option<[u8; 4]> {
        None
    }

    /// Returns the value of a read of `address` at `cycle`, and the cycle up to which reads return
    /// it without side effects; `None` if unknown.
    fn steady(&self, _address: u16, _cycle: u64) -> Option<(u8, u64)> {
        None
    }
}

/// When the processor continues after a write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ready {
    /// Immediately.
    Now,
    /// After this number of cycles: the line `RDY` halts the processor.
    After(u32),
    /// After this number of cycles; [`Cpu::run`] then returns.
    Return(u32),
}

/// The bits of the status register's flags.
mod flag {
    pub(super) const C: u8 = 1 << 0;
    pub(super) const Z: u8 = 1 << 1;
    pub(super) const I: u8 = 1 << 2;
    pub(super) const D: u8 = 1 << 3;
    pub(super) const B: u8 = 1 << 4;
    /// Unused; reads as 1.
    pub(super) const UNUSED: u8 = 1 << 5;
    pub(super) const V: u8 = 1 << 6;
    pub(super) const N: u8 = 1 << 7;
}

/// The registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cpu {
    /// The cycles since power-on.
    pub cycle: u64,
    /// The byte that was last on the bus.
    pub(crate) bus: u8,
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
    /// The result that determines N and Z: Z from its lower 8 bits, N from bits 7 and 15. `BIT` and
    /// `PLP` use bit 15 to set N independently of Z.
    result: u16,
}

impl Cpu {
    /// Makes a processor whose program counter is `pc`.
    pub fn new(pc: u16) -> Self {
        Self {
            cycle: 0,
            bus: 0,
            pc,
            a: 0,
            x: 0,
            y: 0,
            s: 0xff,
            carry: false,
            interrupt_disable: false,
            decimal: false,
            overflow: false,
            result: 1,
        }
    }

    /// Returns the status register, as `PHP` pushes it.
    #[inline(always)]
    pub fn status(&self) -> u8 {
        let bit = |set: bool, bit: u8| if set { bit } else { 0 };
        bit(self.is_negative(), flag::N)
            | bit(self.overflow, flag::V)
            | flag::UNUSED
            | flag::B
            | bit(self.decimal, flag::D)
            | bit(self.interrupt_disable, flag::I)
            | bit(self.is_zero(), flag::Z)
            | bit(self.carry, flag::C)
    }

    #[inline(always)]
    fn set_status(&mut self, p: u8) {
        self.overflow = p & flag::V != 0;
        self.decimal = p & flag::D != 0;
        self.interrupt_disable = p & flag::I != 0;
        self.result = u16::from(p & flag::N) << 8 | u16::from(!p & flag::Z);
        self.carry = p & flag::C != 0;
    }

    /// Sets N and Z from `value`; returns `value`.
    #[inline(always)]
    pub(crate) fn flags(&mut self, value: u8) -> u8 {
        self.result = u16::from(value);
        value
    }

    /// Returns the flag D.
    #[inline(always)]
    pub(crate) fn is_decimal(&self) -> bool {
        self.decimal
    }

    /// Returns the flag N.
    #[inline(always)]
    fn is_negative(&self) -> bool {
        self.result & 0x8080 != 0
    }

    /// Returns the flag Z.
    #[inline(always)]
    fn is_zero(&self) -> bool {
        self.result & 0x00ff == 0
    }

    #[inline(always)]
    fn compare(&mut self, register: u8, value: u8) {
        self.carry = register >= value;
        self.flags(register.wrapping_sub(value));
    }

    #[inline(always)]
    fn adc(&mut self, value: u8) {
        if self.decimal {
            *self = self.adc_decimal(value);
        } else {
            self.adc_binary(value);
        }
    }

    #[inline(always)]
    fn sbc(&mut self, value: u8) {
        if self.decimal {
            *self = self.sbc_decimal(value);
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

    /// Executes `ARR`: `AND`, then a rotation with special flags.
    #[inline(never)]
    fn arr(mut self, value: u8) -> Self {
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
        self
    }

    /// Executes an operation that reads a byte.
    #[inline(always)]
    fn with_value(&mut self, operation: Operation, value: u8) {
        match operation {
            Operation::Adc => self.adc(value),
            Operation::And => self.a = self.flags(self.a & value),
            Operation::Bit => {
                self.overflow = value & 0x40 != 0;
                self.result = u16::from(value & flag::N) << 8 | u16::from(self.a & value);
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
            Operation::Arr => *self = self.arr(value),
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
            _ => {} // an undocumented NOP reads and ignores its operand
        }
    }

    /// Returns the byte that a store writes.
    #[inline(always)]
    fn stored(&mut self, operation: Operation, address: u16) -> u8 {
        // the four unstable stores write `register & (high byte of the address + 1)`
        let high = ((address >> 8) as u8).wrapping_add(1);
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

    /// Executes an operation that modifies memory or the accumulator; returns the new byte.
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
}
