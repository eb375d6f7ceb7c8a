//! The console's bus: which chip an address is of.

use crate::cartridge::ReadWrite;
use crate::cpu::{Bus, Ready};
use crate::riot::Riot;
use crate::screen::Screen;
use crate::tia::Tia;

/// What the processor sees while a frame runs.
pub(crate) struct Wires<'a, S> {
    pub(crate) chips: &'a mut Chips,
    /// The cartridge.
    pub(crate) slot: S,
}

/// What is soldered in: all but the processor and the cartridge.
#[derive(Clone, Debug)]
pub(crate) struct Chips {
    pub(crate) riot: Riot,
    pub(crate) tia: Tia,
    pub(crate) screen: Screen,
    pub(crate) frame_ended: bool,
    /// Whether the frame had begun in the call before.
    pub(crate) continued: bool,
}

/// Whether the cartridge answers an address.
#[inline(always)]
fn is_cartridge(address: u16) -> bool {
    address & 0x1000 != 0
}

/// Whether the RAM of the RIOT answers an address.
#[inline(always)]
fn is_ram(address: u16) -> bool {
    address & 0x1280 == 0x0080
}

/// Whether the RIOT answers an address, of those that neither the cartridge nor the RAM does.
fn is_riot(address: u16) -> bool {
    address & 0x0280 == 0x0280
}

impl Chips {
    /// Reads from anything but the cartridge, where `bus` is what was last on the bus.
    #[inline(never)]
    fn read(&mut self, address: u16, cycle: u64, bus: u8) -> u8 {
        if is_ram(address) {
            return self.riot.ram[usize::from(address & 0x7f)];
        }
        if is_riot(address) {
            return self.riot.read(address, cycle);
        }
        let (bits, driven) = self.tia.read(address, cycle, &mut self.screen);
        bits | bus & !driven
    }

    #[inline(never)]
    fn write_tia(&mut self, address: u16, value: u8, cycle: u64) -> Ready {
        self.tia.write(address, value, cycle, &mut self.screen)
    }
}

impl<S: ReadWrite> Bus for Wires<'_, S> {
    #[inline(always)]
    fn read(&mut self, address: u16, cycle: u64, bus: u8) -> u8 {
        if is_cartridge(address) {
            self.slot.read(address, bus)
        } else if is_ram(address) {
            self.chips.riot.ram[usize::from(address & 0x7f)]
        } else {
            self.chips.read(address, cycle, bus)
        }
    }

    #[inline(always)]
    fn touch(&mut self, address: u16, cycle: u64, bus: u8) -> u8 {
        self.slot.constant(address).unwrap_or_else(|| self.read(address, cycle, bus))
    }

    #[inline(always)]
    fn write(&mut self, address: u16, value: u8, cycle: u64) -> Ready {
        if is_cartridge(address) {
            self.slot.write(address, value);
        } else if is_ram(address) {
            self.chips.riot.ram[usize::from(address & 0x7f)] = value;
        } else if is_riot(address) {
            self.chips.riot.write(address, value, cycle);
        } else {
            let ready = self.chips.write_tia(address, value, cycle);
            if matches!(ready, Ready::Return(_)) {
                self.chips.frame_ended = true;
            }
            return ready;
        }
        Ready::Now
    }

    #[inline(always)]
    fn program(&self, address: u16) -> Option<[u8; 4]> {
        self.slot.program(address)
    }

    fn steady(&self, address: u16, cycle: u64) -> Option<(u8, u64)> {
        let riot = !is_cartridge(address) && !is_ram(address) && is_riot(address);
        if riot { self.chips.riot.steady(address, cycle) } else { None }
    }
}
