//! The console's bus: which chip answers each address.

use std::marker::PhantomData;

use crate::cartridge::{Cartridge, Kind};
use crate::cpu::{Bus, Ready};
use crate::riot::Riot;
use crate::screen::Screen;
use crate::tia::Tia;

/// The processor's bus while a frame runs. `CASE` is the known part of the instruction's address:
/// see [`case`].
pub(crate) struct Wires<'a, K, const CASE: u8> {
    chips: &'a mut Chips,
    cartridge: &'a mut Cartridge,
    /// Whether `CASE` does not cover the instruction. The instruction then has no effect.
    pub(crate) missed: bool,
    kind: PhantomData<K>,
}

/// What the decoder knows of an instruction's address, and of the pointer that the instruction
/// reads.
pub(crate) mod case {
    /// Nothing is known.
    pub(crate) const ANY: u8 = 0;
    /// The address is in RAM.
    pub(crate) const RAM: u8 = 1;
    /// The address is in ROM, where reads have no side effect.
    pub(crate) const ROM: u8 = 2;
    /// The pointer is in RAM. If another address is neither in RAM nor in the ROM without side
    /// effects, the instruction misses.
    pub(crate) const MEMORY: u8 = 3;
    /// The address is a register of the TIA: this value plus the register's number, below 64.
    pub(crate) const TIA: u8 = 0x40;
    /// Like `TIA`; if the write may change pixels, the instruction misses.
    pub(crate) const TIA_UNSEEN: u8 = 0x80;
}

impl<'a, K, const CASE: u8> Wires<'a, K, CASE> {
    #[inline(always)]
    pub(crate) fn new(chips: &'a mut Chips, cartridge: &'a mut Cartridge) -> Self {
        Self {
            chips,
            cartridge,
            missed: false,
            kind: PhantomData,
        }
    }
}

/// The console without the processor and the cartridge.
#[derive(Clone, Debug)]
pub(crate) struct Chips {
    pub(crate) riot: Riot,
    pub(crate) tia: Tia,
    pub(crate) screen: Screen,
    pub(crate) frame_ended: bool,
    /// Whether the frame began in an earlier call.
    pub(crate) continued: bool,
}

/// Whether the cartridge answers `address`.
#[inline(always)]
fn is_cartridge(address: u16) -> bool {
    address & 0x1000 != 0
}

/// Whether the RIOT's RAM answers `address`.
#[inline(always)]
fn is_ram(address: u16) -> bool {
    address & 0x1280 == 0x0080
}

/// Whether the RIOT answers `address`, which neither the cartridge nor the RAM does.
fn is_riot(address: u16) -> bool {
    address & 0x0280 == 0x0280
}

impl Chips {
    /// Reads from any chip except the cartridge; `bus` is the last byte on the bus.
    #[inline(never)]
    fn read(&mut self, address: u16, cycle: u64, bus: u8) -> u8 {
        if is_ram(address) {
            return self.riot.ram[usize::from(address & 0x7f)];
        }
        if is_riot(address) {
            return self.riot.read(address, cycle);
        }
        self.tia.read(address, cycle, &mut self.screen) | bus & 0x3f
    }

    #[inline(never)]
    fn write_any_register(&mut self, address: u16, value: u8, cycle: u64) -> Ready {
        self.write_tia(address, value, cycle)
    }

    #[inline(always)]
    fn write_tia(&mut self, address: u16, value: u8, cycle: u64) -> Ready {
        let ready = self.tia.write(address, value, cycle, &mut self.screen);
        if matches!(ready, Ready::Return(_)) {
            self.frame_ended = true;
        }
        ready
    }
}

impl<K: Kind, const CASE: u8> Bus for Wires<'_, K, CASE> {
    #[inline(always)]
    fn read(&mut self, address: u16, cycle: u64, bus: u8) -> u8 {
        if CASE == case::ROM {
            K::peek(self.cartridge, address)
        } else if CASE == case::RAM || is_ram(address) {
            self.chips.riot.ram[usize::from(address & 0x7f)]
        } else if CASE == case::MEMORY {
            self.missed |= !is_cartridge(address) || address & 0x0fff >= K::PLAIN;
            K::peek(self.cartridge, address)
        } else if is_cartridge(address) {
            K::read(self.cartridge, address, bus)
        } else {
            self.chips.read(address, cycle, bus)
        }
    }

    #[inline(always)]
    fn read_pointer(&mut self, address: u8, cycle: u64, bus: u8) -> u8 {
        if CASE == case::MEMORY {
            self.chips.riot.ram[usize::from(address & 0x7f)]
        } else {
            self.read(u16::from(address), cycle, bus)
        }
    }

    #[inline(always)]
    fn write(&mut self, address: u16, value: u8, cycle: u64) -> Ready {
        let register = u16::from(CASE & 0x3f);
        if CASE >= case::TIA_UNSEEN {
            let ready = self.chips.tia.write_unseen(register, value, cycle);
            self.missed = ready.is_none();
            return ready.unwrap_or(Ready::Now);
        } else if CASE >= case::TIA {
            return self.chips.write_tia(register, value, cycle);
        } else if CASE == case::MEMORY {
            self.missed |= !is_ram(address);
            if !self.missed {
                self.chips.riot.ram[usize::from(address & 0x7f)] = value;
            }
        } else if CASE == case::RAM || is_ram(address) {
            self.chips.riot.ram[usize::from(address & 0x7f)] = value;
        } else if is_cartridge(address) {
            K::write(self.cartridge, address, value);
        } else if is_riot(address) {
            self.chips.riot.write(address, value, cycle);
        } else {
            return self.chips.write_any_register(address, value, cycle);
        }
        Ready::Now
    }

    /// Returns the four bytes from `address` on; `None` for `case::ROM`, which marks a branch that
    /// cannot end a waiting loop.
    #[inline(always)]
    fn program(&self, address: u16) -> Option<[u8; 4]> {
        if CASE == case::ROM {
            None
        } else {
            self.cartridge.four_bytes(address)
        }
    }

    fn steady(&self, address: u16, cycle: u64) -> Option<(u8, u64)> {
        let riot = !is_cartridge(address) && !is_ram(address) && is_riot(address);
        if riot {
            self.chips.riot.steady(address, cycle)
        } else {
            None
        }
    }
}
