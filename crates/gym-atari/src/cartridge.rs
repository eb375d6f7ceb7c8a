//! Cartridges: the ROM, and the bank switching of ROMs larger than the 4096 addresses.
//!
//! The schemes are those of Kevin Horton's "Cart Information" (1997), under his names.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::dpc::{self, Dpc};

/// How a cartridge maps its ROM to the processor's addresses `$1000` to `$1FFF`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Scheme {
    /// 2K, mirrored once.
    Rom2K,
    /// 4K.
    Rom4K,
    /// Two banks of 4K; an access to `$1FF8` or `$1FF9` selects the bank.
    F8,
    /// `F8` with 128 bytes of RAM: its write port is at `$1000`, its read port at `$1080`.
    F8SC,
    /// Four banks of 4K; an access to `$1FF6` to `$1FF9` selects the bank.
    F6,
    /// `F6` with RAM as in `F8SC`.
    F6SC,
    /// Parker Brothers: four windows of 1K. An access to `$1FE0` to `$1FF7` selects one of eight 1K
    /// slices for one of the first three windows.
    E0,
    /// Activision: two banks of 4K. Addresses with bit 13 set are in the first bank, the others in
    /// the second.
    FE,
    /// Pitfall II: `F8` with a chip at `$1000` to `$107F` that fetches data from its own 2K.
    Dpc,
}

impl Scheme {
    /// Every scheme.
    pub const ALL: [Self; 9] = [
        Self::Rom2K,
        Self::Rom4K,
        Self::F8,
        Self::F8SC,
        Self::F6,
        Self::F6SC,
        Self::E0,
        Self::FE,
        Self::Dpc,
    ];

    /// Returns the likely scheme of an unknown ROM of this size, if any.
    pub fn of_size(bytes: usize) -> Option<Self> {
        match bytes {
            0 => None,
            1..=2048 => Some(Self::Rom2K),
            2049..=4096 => Some(Self::Rom4K),
            8192 => Some(Self::F8),
            // the data, optionally followed by 255 random bytes
            10240..=10495 => Some(Self::Dpc),
            16384 => Some(Self::F6),
            _ => None,
        }
    }

    /// Returns the size of the ROM in bytes.
    fn size(self) -> usize {
        match self {
            // 2K are mirrored
            Self::Rom2K | Self::Rom4K => 4096,
            Self::F8 | Self::F8SC | Self::E0 | Self::FE => 8192,
            Self::Dpc => 8192 + dpc::DATA,
            Self::F6 | Self::F6SC => 16384,
        }
    }

    fn has_ram(self) -> bool {
        matches!(self, Self::F8SC | Self::F6SC)
    }
}

/// The bytes of the largest ROM.
pub(crate) const ROM: usize = 0x4000;

/// The first address (of the lower 12 bits) that may select a bank.
const FIRST_HOTSPOT: u16 = 0x0fe0;

/// A ROM and the banks that the processor sees.
#[derive(Clone, Debug)]
pub struct Cartridge {
    /// The ROM, padded with zeros to the largest size.
    pub(crate) rom: Arc<[u8; ROM]>,
    banks: Banks,
    /// Whether an access may have selected a bank since [`take_switched`](Self::take_switched).
    switched: bool,
}

/// The state of a cartridge, apart from its ROM.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Banks {
    scheme: Scheme,
    /// The offset in the ROM at which each window of 1K starts.
    windows: [u16; 4],
    #[serde(with = "crate::bytes")]
    ram: [u8; 128],
    dpc: Dpc,
}

impl Cartridge {
    /// Makes a cartridge at power-on. A ROM that is too short for its scheme is repeated, one that
    /// is too long is truncated, an empty one reads as zeros.
    pub fn new(rom: &[u8], scheme: Scheme) -> Self {
        let mut whole = [0; ROM];
        for (byte, &value) in whole[..scheme.size()].iter_mut().zip(rom.iter().cycle()) {
            *byte = value;
        }
        let banks = Banks {
            scheme,
            windows: [0; 4],
            ram: [0; 128],
            dpc: Dpc::new(),
        };
        let mut cartridge = Self {
            rom: Arc::new(whole),
            banks,
            switched: false,
        };
        cartridge.reset();
        cartridge
    }

    /// Selects the power-on banks and clears the RAM. The chip of `Dpc` keeps its state.
    pub fn reset(&mut self) {
        self.banks.ram = [0; 128];
        match self.banks.scheme {
            Scheme::Rom2K | Scheme::Rom4K | Scheme::F6 | Scheme::F6SC | Scheme::FE => {
                self.banks.select(0);
            }
            Scheme::F8 | Scheme::F8SC | Scheme::Dpc => self.banks.select(1),
            Scheme::E0 => self.banks.windows = [4 << 10, 5 << 10, 6 << 10, 7 << 10],
        }
    }

    /// Returns the selected banks and the cartridge's RAM.
    pub fn banks(&self) -> &Banks {
        &self.banks
    }

    /// Restores banks and RAM. Returns false and changes nothing if `banks` has another scheme.
    pub fn set_banks(&mut self, banks: &Banks) -> bool {
        let last = (self.banks.scheme.size() - 0x400) as u16;
        let fits = banks.scheme == self.banks.scheme
            && banks
                .windows
                .iter()
                .all(|&start| start <= last && start % 0x400 == 0)
            && banks.dpc.is_valid();
        if fits {
            self.banks = banks.clone();
        }
        fits
    }

    /// Reads a byte. Only the lower 12 bits of `address` matter, and bit 13 in `FE`. An address
    /// without a chip reads as `bus`, the last byte on the bus.
    #[inline(always)]
    pub fn read(&mut self, address: u16, bus: u8) -> u8 {
        let low = address & 0x0fff;
        if low >= FIRST_HOTSPOT && self.banks.scheme != Scheme::FE {
            self.banks.hotspot(low);
        } else if low < 0x0100 && self.banks.scheme.has_ram() {
            let cell = usize::from(low & 0x7f);
            if low < 0x80 {
                // a read of the write port writes the byte on the bus to RAM
                self.banks.ram[cell] = bus;
                return bus;
            }
            return self.banks.ram[cell];
        } else if low < dpc::REGISTERS && self.banks.scheme == Scheme::Dpc {
            return self.banks.read_dpc(low, &self.rom[8192..][..dpc::DATA]);
        } else if self.banks.scheme == Scheme::FE {
            self.banks.select(u16::from(address & 0x2000 == 0));
        }
        self.peek(address)
    }

    /// Returns the ROM's byte at `address` in the selected banks.
    #[inline(always)]
    fn peek(&self, address: u16) -> u8 {
        self.rom[self.place(address)]
    }

    /// Returns the offset of `address` in the ROM.
    #[inline(always)]
    fn place(&self, address: u16) -> usize {
        let start = self.banks.windows[usize::from(address >> 10 & 0x03)];
        usize::from(start & 0x3c00 | address & 0x03ff)
    }

    /// Writes a byte.
    #[inline(always)]
    pub fn write(&mut self, address: u16, value: u8) {
        let low = address & 0x0fff;
        if low >= FIRST_HOTSPOT {
            self.banks.hotspot(low);
        } else if low < 0x80 && self.banks.scheme.has_ram() {
            self.banks.ram[usize::from(low)] = value;
        } else if low < dpc::REGISTERS && self.banks.scheme == Scheme::Dpc {
            self.banks.write_dpc(low, value);
        }
    }

    /// Returns the cartridge's scheme.
    pub(crate) fn scheme(&self) -> Scheme {
        self.banks.scheme
    }

    /// Returns the four ROM bytes from `address` on; `None` if the four addresses are not within
    /// one window, where reads have no side effects.
    pub(crate) fn four_bytes(&self, address: u16) -> Option<[u8; 4]> {
        let low = address & 0x0fff;
        let first = match self.banks.scheme {
            Scheme::FE => return None,
            Scheme::F8SC | Scheme::F6SC => 0x0100,
            Scheme::Dpc => dpc::REGISTERS,
            _ => 0,
        };
        let plain = address & 0x1000 != 0
            && (first..FIRST_HOTSPOT - 4).contains(&low)
            && low & 0x03ff <= 0x03fc;
        if plain {
            self.rom[self.place(address)..].first_chunk().copied()
        } else {
            None
        }
    }

    /// Whether an access may have selected a bank since the last call.
    #[inline(always)]
    pub(crate) fn take_switched(&mut self) -> bool {
        std::mem::take(&mut self.switched)
    }

    #[inline(never)]
    fn hotspot(&mut self, address: u16) {
        self.switched = true;
        self.banks.hotspot(address & 0x0fff);
    }
}

/// A kind of cartridge. The processor's code is compiled for each kind.
pub(crate) trait Kind: 'static {
    /// The number of addresses, from the first on, for which no access has a side effect.
    const PLAIN: u16;
    /// The size in bytes of a window: the address range that a bank switch replaces, a bank or a
    /// part of a bank.
    const WINDOW: u16;

    /// Reads a byte; `bus` is the last byte on the bus.
    fn read(cartridge: &mut Cartridge, address: u16, bus: u8) -> u8;

    /// Writes a byte.
    fn write(cartridge: &mut Cartridge, address: u16, value: u8);

    /// Returns the ROM's byte at an address whose reads have no side effect.
    fn peek(cartridge: &Cartridge, address: u16) -> u8;

    /// Returns the index of the block that starts at `address`. The index identifies the byte of
    /// the ROM and the window through which the processor reads the byte.
    fn entry(cartridge: &Cartridge, address: u16) -> usize;
}

/// Any cartridge.
#[derive(Debug)]
pub(crate) enum Any {}

impl Kind for Any {
    const PLAIN: u16 = 0;
    const WINDOW: u16 = 0x1000;

    #[inline(always)]
    fn read(cartridge: &mut Cartridge, address: u16, bus: u8) -> u8 {
        cartridge.read(address, bus)
    }

    #[inline(always)]
    fn write(cartridge: &mut Cartridge, address: u16, value: u8) {
        cartridge.write(address, value);
    }

    #[inline(always)]
    fn peek(cartridge: &Cartridge, address: u16) -> u8 {
        cartridge.peek(address)
    }

    #[inline(always)]
    fn entry(cartridge: &Cartridge, address: u16) -> usize {
        cartridge.place(address)
    }
}

/// A ROM without banks.
#[derive(Debug)]
pub(crate) enum Fixed {}

impl Kind for Fixed {
    const PLAIN: u16 = 0x1000;
    const WINDOW: u16 = 0x1000;

    #[inline(always)]
    fn read(cartridge: &mut Cartridge, address: u16, _bus: u8) -> u8 {
        Self::peek(cartridge, address)
    }

    #[inline(always)]
    fn write(_cartridge: &mut Cartridge, _address: u16, _value: u8) {}

    #[inline(always)]
    fn peek(cartridge: &Cartridge, address: u16) -> u8 {
        cartridge.rom[usize::from(address & 0x0fff)]
    }

    #[inline(always)]
    fn entry(_cartridge: &Cartridge, address: u16) -> usize {
        usize::from(address & 0x0fff)
    }
}

/// `F8` and `F6`: one bank of several at a time.
#[derive(Debug)]
pub(crate) enum Switched {}

impl Kind for Switched {
    const PLAIN: u16 = 0x0ff6;
    const WINDOW: u16 = 0x1000;

    #[inline(always)]
    fn read(cartridge: &mut Cartridge, address: u16, _bus: u8) -> u8 {
        if address & 0x0fff >= Self::PLAIN {
            cartridge.hotspot(address);
        }
        Self::peek(cartridge, address)
    }

    #[inline(always)]
    fn write(cartridge: &mut Cartridge, address: u16, _value: u8) {
        if address & 0x0fff >= Self::PLAIN {
            cartridge.hotspot(address);
        }
    }

    #[inline(always)]
    fn peek(cartridge: &Cartridge, address: u16) -> u8 {
        cartridge.rom[Self::entry(cartridge, address)]
    }

    #[inline(always)]
    fn entry(cartridge: &Cartridge, address: u16) -> usize {
        usize::from(cartridge.banks.windows[0] & 0x3000 | address & 0x0fff)
    }
}

/// `E0`: four windows.
#[derive(Debug)]
pub(crate) enum Windowed {}

impl Kind for Windowed {
    const PLAIN: u16 = FIRST_HOTSPOT;
    const WINDOW: u16 = 0x0400;

    #[inline(always)]
    fn read(cartridge: &mut Cartridge, address: u16, _bus: u8) -> u8 {
        if address & 0x0fff >= Self::PLAIN {
            cartridge.hotspot(address);
        }
        cartridge.peek(address)
    }

    #[inline(always)]
    fn write(cartridge: &mut Cartridge, address: u16, _value: u8) {
        if address & 0x0fff >= Self::PLAIN {
            cartridge.hotspot(address);
        }
    }

    #[inline(always)]
    fn peek(cartridge: &Cartridge, address: u16) -> u8 {
        cartridge.peek(address)
    }

    #[inline(always)]
    fn entry(cartridge: &Cartridge, address: u16) -> usize {
        usize::from(address & 0x0c00) << 3 | cartridge.place(address) & 0x1fff
    }
}

impl Banks {
    /// Shows a whole bank of 4K.
    fn select(&mut self, bank: u16) {
        let start = bank << 12;
        self.windows = [start, start + 0x400, start + 0x800, start + 0xc00];
    }

    /// Reads a register of the chip. The registers of the upper half can only be written; reads
    /// return 0.
    #[inline(never)]
    fn read_dpc(&mut self, low: u16, data: &[u8]) -> u8 {
        if low < dpc::REGISTERS / 2 {
            self.dpc.read(low, data)
        } else {
            0
        }
    }

    #[inline(never)]
    fn write_dpc(&mut self, low: u16, value: u8) {
        if low >= dpc::REGISTERS / 2 {
            self.dpc.write(low, value);
        }
    }

    fn hotspot(&mut self, low: u16) {
        match (self.scheme, low) {
            (Scheme::F8 | Scheme::F8SC | Scheme::Dpc, 0xff8..=0xff9) => self.select(low - 0xff8),
            (Scheme::F6 | Scheme::F6SC, 0xff6..=0xff9) => self.select(low - 0xff6),
            (Scheme::E0, 0xfe0..=0xff7) => {
                let window = usize::from((low - 0xfe0) >> 3);
                self.windows[window] = (low & 0x07) << 10;
            }
            _ => {}
        }
    }
}
