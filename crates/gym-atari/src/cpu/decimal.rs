//! Arithmetic in binary coded decimal, as the NMOS chip does it, flags of no meaning included.
//!
//! It is rare, and takes the registers by value: by reference it would keep them in memory for all other instructions.

use super::Cpu;

impl Cpu {
    /// Z comes from the binary sum; N and V from the sum whose lower digit alone was adjusted.
    #[inline(never)]
    pub(super) fn adc_decimal(mut self, value: u8) -> Self {
        let (a, b, carry) = (u16::from(self.a), u16::from(value), u16::from(self.carry));
        let mut low = (a & 0x0f) + (b & 0x0f) + carry;
        if low > 9 {
            low = ((low + 6) & 0x0f) + 0x10;
        }
        let mut sum = (a & 0xf0) + (b & 0xf0) + low;
        self.zero = (a + b + carry) as u8;
        self.negative = sum as u8;
        self.overflow = !(a ^ b) & (a ^ sum) & 0x80 != 0;
        if sum > 0x9f {
            sum += 0x60;
        }
        self.carry = sum > 0xff;
        self.a = sum as u8;
        self
    }

    /// All flags come from the binary difference.
    #[inline(never)]
    pub(super) fn sbc_decimal(mut self, value: u8) -> Self {
        let (a, b, borrow) = (i16::from(self.a), i16::from(value), i16::from(!self.carry));
        let mut low = (a & 0x0f) - (b & 0x0f) - borrow;
        if low < 0 {
            low = ((low - 6) & 0x0f) - 0x10;
        }
        let mut difference = (a & 0xf0) - (b & 0xf0) + low;
        if difference < 0 {
            difference -= 0x60;
        }
        self.adc_binary(!value);
        self.a = difference as u8;
        self
    }

    /// The adjustment of `ARR`, after the rotation of `masked` into the accumulator.
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
