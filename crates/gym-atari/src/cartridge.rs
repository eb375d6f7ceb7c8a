//! Cartridges: the program, and the switching of banks that do not fit into the 4096 addresses.
//!
//! The schemes are those of Kevin Horton's "Cart Information" (1997), under his names.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::dpc::{self, Dpc};

/// How a cartridge maps its ROM onto the processor's addresses `$1000` to `$1FFF`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Scheme {
    /// 2K, twice.
    Rom2K,
    /// 4K.
    Rom4K,
    /// Two banks of 4K: an access to `$1FF8` or `$1FF9` selects.
    F8,
    /// `F8` and 128 bytes of RAM: write at `$1000`, read at `$1080`.
    F8SC,
    /// Four banks of 4K: `$1FF6` to `$1FF9`.
    F6,
    /// `F6` and RAM as `F8SC`.
    F6SC,
    /// Parker Brothers: four windows of 1K, of which three choose among eight slices by `$1FE0` to `$1FF7`.
    E0,
    /// Activision: two banks of 4K, the first at addresses with bit 13 and the second at those without.
    FE,
    /// Pitfall II: `F8`, and a chip at `$1000` to `$107F` that fetches data from 2K of its own.
    Dpc,
}

impl Scheme {
    /// Every scheme.
    pub const ALL: [Self; 9] =
        [Self::Rom2K, Self::Rom4K, Self::F8, Self::F8SC, Self::F6, Self::F6SC, Self::E0, Self::FE, Self::Dpc];

    /// The scheme of an unknown ROM, by its size: `None` where no scheme has that size.
    pub fn of_size(bytes: usize) -> Option<Self> {
        match bytes {
            0 => None,
            1..=2048 => Some(Self::Rom2K),
            2049..=4096 => Some(Self::Rom4K),
            8192 => Some(Self::F8),
            // with 255 random numbers behind the data, or without
            10240..=10495 => Some(Self::Dpc),
            16384 => Some(Self::F6),
            _ => None,
        }
    }

    /// The bytes of ROM.
    fn size(self) -> usize {
        match self {
            // 2K repeat
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

/// The bytes of a whole bank.
const BANK: usize = 4096;
/// From here on an address may select a bank.
const FIRST_HOTSPOT: u16 = 0x0fe0;

/// A ROM and which parts of it the processor sees.
#[derive(Clone, Debug)]
pub struct Cartridge {
    rom: Arc<[u8]>,
    banks: Banks,
}

/// The state of a cartridge beside its ROM.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Banks {
    scheme: Scheme,
    /// Where in the ROM each window of 1K starts.
    windows: [u16; 4],
    #[serde(with = "crate::bytes")]
    ram: [u8; 128],
    dpc: Dpc,
}

impl Cartridge {
    /// The cartridge at power-on. A ROM that is too short for its scheme is repeated to fill it, one that is too long is
    /// cut off, and an empty one reads as zeros.
    pub fn new(rom: &[u8], scheme: Scheme) -> Self {
        let rom: Arc<[u8]> = match rom {
            [] => vec![0; scheme.size()].into(),
            _ => rom.iter().copied().cycle().take(scheme.size()).collect(),
        };
        let banks = Banks { scheme, windows: [0; 4], ram: [0; 128], dpc: Dpc::new() };
        let mut cartridge = Self { rom, banks };
        cartridge.reset();
        cartridge
    }

    /// Back to the banks that are selected at power-on; the RAM is cleared, and the chip of `Dpc` stays as it is.
    pub fn reset(&mut self) {
        self.banks.ram = [0; 128];
        match self.banks.scheme {
            Scheme::Rom2K | Scheme::Rom4K | Scheme::F6 | Scheme::F6SC | Scheme::FE => self.banks.select(0),
            Scheme::F8 | Scheme::F8SC | Scheme::Dpc => self.banks.select(1),
            Scheme::E0 => self.banks.windows = [4 << 10, 5 << 10, 6 << 10, 7 << 10],
        }
    }

    /// The selected banks and the cartridge's RAM.
    pub fn banks(&self) -> &Banks {
        &self.banks
    }

    /// Selects banks and sets RAM as they were; `false` and no change if they are another scheme's.
    pub fn set_banks(&mut self, banks: &Banks) -> bool {
        let last = (self.rom.len() - 0x400) as u16;
        let fits = banks.scheme == self.banks.scheme
            && banks.windows.iter().all(|&start| start <= last && start % 0x400 == 0)
            && banks.dpc.is_valid();
        if fits {
            self.banks = banks.clone();
        }
        fits
    }

    /// Reads a byte, of which only the lower 12 bits of the address count, and bit 13 in `FE`. The byte last seen on the bus
    /// is what an address reads that nothing answers.
    #[inline(always)]
    pub fn read(&mut self, address: u16, bus: u8) -> u8 {
        let low = address & 0x0fff;
        if low >= FIRST_HOTSPOT && self.banks.scheme != Scheme::FE {
            self.banks.hotspot(low);
        } else if low < 0x0100 && self.banks.scheme.has_ram() {
            let cell = usize::from(low & 0x7f);
            if low < 0x80 {
                // a read of the write port stores what is on the bus
                self.banks.ram[cell] = bus;
                return bus;
            }
            return self.banks.ram[cell];
        } else if low < dpc::REGISTERS && self.banks.scheme == Scheme::Dpc {
            return self.banks.read_dpc(low, &self.rom[8192..]);
        } else if self.banks.scheme == Scheme::FE {
            self.banks.select(u16::from(address & 0x2000 == 0));
        }
        let start = self.banks.windows[usize::from(low >> 10)];
        self.rom[usize::from(start) + usize::from(low & 0x03ff)]
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

    /// The cartridge as the processor is best wired to it.
    pub(crate) fn slot(&mut self) -> Slot<'_> {
        if self.banks.scheme == Scheme::E0 {
            let Self { rom, banks } = self;
            return Slot::Windowed(Windowed { rom: rom.first_chunk().expect("E0 is 8K"), banks });
        }
        let whole = matches!(self.banks.scheme, Scheme::Rom2K | Scheme::Rom4K | Scheme::F8 | Scheme::F6);
        let start = usize::from(self.banks.windows[0]);
        if !whole || start + BANK > self.rom.len() {
            return Slot::Other(self);
        }
        let Self { rom, banks } = self;
        let bank = rom[start..].first_chunk().expect("a bank is 4K");
        match banks.scheme {
            Scheme::Rom2K | Scheme::Rom4K => Slot::Fixed(Fixed { rom: bank }),
            _ => Slot::Switched(Switched { rom, bank, banks }),
        }
    }
}

/// What the processor sees of a cartridge.
pub(crate) trait ReadWrite {
    /// Reads a byte, while another is on the bus.
    fn read(&mut self, address: u16, bus: u8) -> u8;
    /// Writes a byte.
    fn write(&mut self, address: u16, value: u8);
    /// The byte of the ROM that a read of this address gives, if the read does nothing else.
    fn constant(&self, address: u16) -> Option<u8>;
    /// The four bytes of the ROM from an address on, if reading them does nothing else.
    fn program(&self, address: u16) -> Option<[u8; 4]>;
}

/// Four bytes of a bank, if all of them lie ahead of `end`.
#[inline(always)]
fn four_bytes(bank: &[u8; BANK], address: u16, end: usize) -> Option<[u8; 4]> {
    // addresses beyond 4095 are none of the cartridge's
    let at = usize::from((address & 0x1fff) ^ 0x1000);
    if at <= end - 4 { bank[at..].first_chunk().copied() } else { None }
}

/// A cartridge by what its accesses do, so that the processor runs on code for that alone.
pub(crate) enum Slot<'a> {
    Fixed(Fixed<'a>),
    Switched(Switched<'a>),
    Windowed(Windowed<'a>),
    Other(&'a mut Cartridge),
}

/// A ROM without banks.
pub(crate) struct Fixed<'a> {
    rom: &'a [u8; BANK],
}

impl ReadWrite for Fixed<'_> {
    #[inline(always)]
    fn read(&mut self, address: u16, _bus: u8) -> u8 {
        self.rom[usize::from(address & 0x0fff)]
    }

    #[inline(always)]
    fn write(&mut self, _address: u16, _value: u8) {}

    #[inline(always)]
    fn constant(&self, address: u16) -> Option<u8> {
        (address & 0x1000 != 0).then(|| self.rom[usize::from(address & 0x0fff)])
    }

    #[inline(always)]
    fn program(&self, address: u16) -> Option<[u8; 4]> {
        four_bytes(self.rom, address, BANK)
    }
}

/// `F8` and `F6`: one bank of several at a time.
pub(crate) struct Switched<'a> {
    rom: &'a [u8],
    bank: &'a [u8; BANK],
    banks: &'a mut Banks,
}

impl Switched<'_> {
    #[inline(always)]
    fn access(&mut self, address: u16) {
        if address & 0x0fff >= FIRST_HOTSPOT {
            self.bank = switch(self.rom, self.banks, address);
        }
    }
}

/// The bank that is selected after an access. It is no method, as `self` would have to be in memory then.
#[inline(never)]
fn switch<'a>(rom: &'a [u8], banks: &mut Banks, address: u16) -> &'a [u8; BANK] {
    banks.hotspot(address & 0x0fff);
    let start = usize::from(banks.windows[0]);
    rom[start..].first_chunk().expect("a bank is 4K")
}

impl ReadWrite for Switched<'_> {
    #[inline(always)]
    fn read(&mut self, address: u16, _bus: u8) -> u8 {
        self.access(address);
        self.bank[usize::from(address & 0x0fff)]
    }

    #[inline(always)]
    fn write(&mut self, address: u16, _value: u8) {
        self.access(address);
    }

    #[inline(always)]
    fn constant(&self, address: u16) -> Option<u8> {
        let plain = address & 0x1000 != 0 && address & 0x0fff < FIRST_HOTSPOT;
        plain.then(|| self.bank[usize::from(address & 0x0fff)])
    }

    #[inline(always)]
    fn program(&self, address: u16) -> Option<[u8; 4]> {
        four_bytes(self.bank, address, usize::from(FIRST_HOTSPOT))
    }
}

/// `E0`: four windows.
pub(crate) struct Windowed<'a> {
    rom: &'a [u8; 8192],
    banks: &'a mut Banks,
}

impl Windowed<'_> {
    #[inline(always)]
    fn access(&mut self, address: u16) {
        if address & 0x0fff >= FIRST_HOTSPOT {
            self.banks.hotspot(address & 0x0fff);
        }
    }

    /// Where in the ROM an address is.
    #[inline(always)]
    fn place(&self, address: u16) -> usize {
        let start = self.banks.windows[usize::from(address >> 10 & 0x03)];
        usize::from(start & 0x1c00 | address & 0x03ff)
    }
}

impl ReadWrite for Windowed<'_> {
    #[inline(always)]
    fn read(&mut self, address: u16, _bus: u8) -> u8 {
        self.access(address);
        self.rom[self.place(address)]
    }

    #[inline(always)]
    fn write(&mut self, address: u16, _value: u8) {
        self.access(address);
    }

    #[inline(always)]
    fn constant(&self, address: u16) -> Option<u8> {
        let plain = address & 0x1000 != 0 && address & 0x0fff < FIRST_HOTSPOT;
        plain.then(|| self.rom[self.place(address)])
    }

    /// Instructions within one window.
    #[inline(always)]
    fn program(&self, address: u16) -> Option<[u8; 4]> {
        let at = usize::from(address & 0x03ff);
        let plain = address & 0x1000 != 0 && at <= 0x400 - 4 && address & 0x0fff < FIRST_HOTSPOT - 4;
        if plain { self.rom[self.place(address)..].first_chunk().copied() } else { None }
    }
}

impl ReadWrite for &mut Cartridge {
    #[inline(always)]
    fn read(&mut self, address: u16, bus: u8) -> u8 {
        Cartridge::read(self, address, bus)
    }

    #[inline(always)]
    fn write(&mut self, address: u16, value: u8) {
        Cartridge::write(self, address, value);
    }

    fn constant(&self, _address: u16) -> Option<u8> {
        None
    }

    /// Instructions within one window.
    fn program(&self, address: u16) -> Option<[u8; 4]> {
        let low = address & 0x0fff;
        let first = match self.banks.scheme {
            Scheme::FE => return None,
            Scheme::F8SC | Scheme::F6SC => 0x0100,
            Scheme::Dpc => dpc::REGISTERS,
            _ => 0,
        };
        let plain = address & 0x1000 != 0 && (first..FIRST_HOTSPOT - 4).contains(&low);
        let (window, at) = (usize::from(low >> 10), usize::from(low & 0x03ff));
        let slice = self.rom[usize::from(self.banks.windows[window])..].first_chunk::<0x400>()?;
        if plain && at <= slice.len() - 4 { slice[at..].first_chunk().copied() } else { None }
    }
}

impl Banks {
    /// Shows a whole bank of 4K.
    fn select(&mut self, bank: u16) {
        let start = bank << 12;
        self.windows = [start, start + 0x400, start + 0x800, start + 0xc00];
    }

    /// The upper half of the registers is not to be read.
    #[inline(never)]
    fn read_dpc(&mut self, low: u16, data: &[u8]) -> u8 {
        if low < dpc::REGISTERS / 2 { self.dpc.read(low, data) } else { 0 }
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
