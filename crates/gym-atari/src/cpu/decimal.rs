//! Arithmetic in binary-coded decimal, as in ale-py: numbers are converted to binary and back, and
//! the flags come from the result. A real 6502 sets the flags differently and has other results for
//! digits above 9.
//!
//! Decimal arithmetic is rare, so its functions take the registers by value: by reference, the
//! compiler would keep them in memory for all other instructions.

use super::Cpu;

/// Converts two BCD digits to a number.
fn from_digits(byte: u8) -> i16 {
    10 * i16::from(byte >> 4) + i16::from(byte & 0x0f)
}

/// Converts the two lowest decimal digits of `number` to BCD.
fn to_digits(number: u8) -> u8 {
    ((number / 10 % 10) << 4) | (number % 10)
}

impl Cpu {
    #[inline(never)]
    pub(super) fn adc_decimal(mut self, value: u8) -> Self {
        let sum = from_digits(self.a) + from_digits(value) + i16::from(self.carry);
        self.carry = sum > 99;
        self.set_decimal(to_digits(sum as u8), value);
        self
    }

    #[inline(never)]
    pub(super) fn sbc_decimal(mut self, value: u8) -> Self {
        let borrow = i16::from(!self.carry);
        let difference = from_digits(self.a) - from_digits(value) - borrow;
        let difference = if difference < 0 {
            difference + 100
        } else {
            difference
        };
        self.carry = i16::from(self.a) >= i16::from(value) + borrow;
        // a difference below -100 needs digits above 9
        let result = if difference < 0 {
            from_digits(difference as u8) as u8
        } else {
            to_digits(difference as u8)
        };
        self.set_decimal(result, value);
        self
    }

    /// Sets the result and all flags except the carry.
    fn set_decimal(&mut self, result: u8, value: u8) {
        self.overflow = (self.a ^ result) & (value ^ result) & 0x80 != 0;
        self.a = self.flags(result);
    }

    /// Applies the decimal correction of `ARR`, after the rotation of `masked` into the
    /// accumulator.
    pub(super) fn arr_decimal(&mut self, masked: u8) {
        self.overflow = (self.a ^ masked) & 0x40 != 0;
        if (masked & 0x0f) + (masked & 0x01) > 5 {
            self.a = (self.a & 0xf0) | (self.a.wrapping_add(6) & 0x0f);
        }
        self.carry = u16::from(masked & 0xf0) + u16::from(masked & 0x10) > 0x50;
        if self.carry {
            self.a = self.a.wrapping_add(0x60);
        }
    }
}
