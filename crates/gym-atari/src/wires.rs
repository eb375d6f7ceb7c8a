//! The console's bus: which chip an address is of.

use crate::cartridge::ReadWrite;
use crate::cpu::{Bus, Ready};
use crate::riot::Riot;
use crate::screen::Screen;
use crate::tia::Tia;

/// What the processor sees while a frame runs.
pub(crate) struct Wires<'a, S> {
    pub(crate) chips: Chips<'a>,
    /// The cartridge.
    pub(crate) slot: S,
}

/// All but the cartridge.
pub(crate) struct Chips<'a> {
    pub(crate) riot: &'a mut Riot,
    pub(crate) tia: &'a mut Tia,
    pub(crate) screen: &'a mut Screen,
    /// The byte that was last on the bus.
    pub(crate) data: u8,
    pub(crate) frame_ended: bool,
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

impl Chips<'_> {
    #[inline(never)]
    fn read_register(&mut self, address: u16, cycle: u64) -> u8 {
        if is_riot(address) {
            return self.riot.read(address, cycle);
        }
        let (bits, driven) = self.tia.read(address, cycle, self.screen);
        bits | self.data & !driven
    }

    #[inline(never)]
    fn write_register(&mut self, address: u16, value: u8, cycle: u64) -> Ready {
        if is_riot(address) {
            self.riot.write(address, value, cycle);
            return Ready::Now;
        }
        let ready = self.tia.write(address, value, cycle, self.screen);
        self.frame_ended |= ready == Ready::Return;
        ready
    }
}

impl<S: ReadWrite> Bus for Wires<'_, S> {
    #[inline(always)]
    fn read(&mut self, address: u16, cycle: u64) -> u8 {
        let Self { chips, slot } = self;
        chips.data = if is_cartridge(address) {
            slot.read(address, chips.data)
        } else if is_ram(address) {
            chips.riot.ram[usize::from(address & 0x7f)]
        } else {
            chips.read_register(address, cycle)
        };
        slot.listen(address, chips.data);
        chips.data
    }

    #[inline(always)]
    fn touch(&mut self, address: u16, cycle: u64) {
        if !self.slot.is_plain(address) {
            self.read(address, cycle);
        }
    }

    #[inline(always)]
    fn write(&mut self, address: u16, value: u8, cycle: u64) -> Ready {
        let Self { chips, slot } = self;
        chips.data = value;
        slot.listen(address, value);
        if is_cartridge(address) {
            slot.write(address, value);
        } else if is_ram(address) {
            chips.riot.ram[usize::from(address & 0x7f)] = value;
        } else {
            return chips.write_register(address, value, cycle);
        }
        Ready::Now
    }
}
