//! Cartridges: the program, and the switching of banks that do not fit into the 4096 addresses.
//!
//! The schemes are those of Kevin Horton's "Cart Information" (1997), under his names.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::dpc::{self, Dpc};

/// The way in which a cartridge maps its ROM onto the processor's addresses `$1000` to `$1FFF`.
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
    /// Parker Brothers: four windows of 1K, of which three choose among eight slices by `$1FE0` to
    /// `$1FF7`.
    E0,
    /// Activision: two banks of 4K, the first at addresses with bit 13 and the second at those
    /// without.
    FE,
    /// Pitfall II: `F8`, and a chip at `$1000` to `$107F` that fetches data from 2K of its own.
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

/// The bytes of the largest ROM.
pub(crate) const ROM: usize = 0x4000;

/// From here on an address may select a bank.
const FIRST_HOTSPOT: u16 = 0x0fe0;

/// A ROM and which parts of it the processor sees.
#[derive(Clone, Debug)]
pub struct Cartridge {
    /// The bytes; zeros behind a smaller ROM.
    pub(crate) rom: Arc<[u8; ROM]>,
    banks: Banks,
    /// Whether an access may have selected a bank since [`take_switched`](Self::take_switched).
    switched: bool,
}

/// The state of a cartridge beside its ROM.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Banks {
    scheme: Scheme,
    /// The place in the ROM at which each window of 1K starts.
    windows: [u16; 4],
    #[serde(with = "crate::bytes")]
    ram: [u8; 128],
    dpc: Dpc,
}

impl Cartridge {
    /// The cartridge at power-on. A ROM that is too short for its scheme is repeated to fill it,
    /// one that is too long is cut off, and an empty one reads as zeros.
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

    /// Back to the banks that are selected at power-on; the RAM is cleared, and the chip of `Dpc`
    /// stays as it is.
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

    /// The selected banks and the cartridge's RAM.
    pub fn banks(&self) -> &Banks {
        &self.banks
    }

    /// Selects banks and sets RAM as they were; `false` and no change if they are another scheme's.
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

    /// Reads a byte, of which only the lower 12 bits of the address count, and bit 13 in `FE`. The
    /// byte last seen on the bus is read at addresses without a chip.
    #[inline(always)]
    pub fn read(&mut self, address: u16, bus: u8) -> u8 {
        let low = address & 0x0fff;
        if low >= FIRST_HOTSPOT && self.banks.scheme != Scheme::FE {
            self.banks.hotspot(low);
        } else if low < 0x0100 && self.banks.scheme.has_ram() {
            let cell = usize::from(low & 0x7f);
            if low < 0x80 {
                // a read of the write port stores the byte on the bus
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

    /// The byte of the ROM at an address, in the banks that are selected.
    #[inline(always)]
    fn peek(&self, address: u16) -> u8 {
        self.rom[self.place(address)]
    }

    /// The place of an address in the ROM.
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

    /// The way in which the cartridge maps its ROM.
    pub(crate) fn scheme(&self) -> Scheme {
        self.banks.scheme
    }

    /// The four bytes of the ROM from an address on, if reading them does nothing else:
    /// instructions within one window.
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

/// The behaviour of a kind of cartridge, so that the processor's code is compiled for each kind.
pub(crate) trait Kind: 'static {
    /// The addresses of a bank that do nothing but read, from the first one on.
    const PLAIN: u16;
    /// The bytes of a window: a bank, or a part of it that is selected apart from others.
    const WINDOW: u16;

    /// Reads a byte, while another is on the bus.
    fn read(cartridge: &mut Cartridge, address: u16, bus: u8) -> u8;

    /// Writes a byte.
    fn write(cartridge: &mut Cartridge, address: u16, value: u8);

    /// The byte of the ROM at an address of which a read does nothing else.
    fn peek(cartridge: &Cartridge, address: u16) -> u8;

    /// A number for the byte of the ROM at an address, and for the window that shows it there.
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

    /// The upper half of the registers is not to be read.
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
