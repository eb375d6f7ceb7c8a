//! Addresses and bits of the registers, from the Stella Programmer's Guide (1979), section "TIA".

/// The bits of an address that select a register for reading.
pub(super) const READ_ADDRESS: u16 = 0x0f;
/// The bits of an address that select a register for writing.
pub(super) const WRITE_ADDRESS: u16 = 0x3f;

macro_rules! addresses {
    ($($name:ident = $address:literal,)*) => {
        $(pub(super) const $name: u16 = $address;)*
    };
}

// read
addresses! {
    CXM0P = 0x00, CXPPMM = 0x07,
    INPT0 = 0x08, INPT3 = 0x0b, INPT4 = 0x0c, INPT5 = 0x0d,
}

// write
addresses! {
    VSYNC = 0x00, VBLANK = 0x01, WSYNC = 0x02,
    NUSIZ0 = 0x04, NUSIZ1 = 0x05,
    COLUP0 = 0x06, COLUP1 = 0x07, COLUPF = 0x08, COLUBK = 0x09,
    CTRLPF = 0x0a, REFP0 = 0x0b, REFP1 = 0x0c,
    PF0 = 0x0d, PF1 = 0x0e, PF2 = 0x0f,
    RESP0 = 0x10, RESP1 = 0x11, RESM0 = 0x12, RESBL = 0x14,
    GRP0 = 0x1b, GRP1 = 0x1c, ENAM0 = 0x1d, ENAM1 = 0x1e, ENABL = 0x1f,
    HMP0 = 0x20, HMBL = 0x24,
    VDELP0 = 0x25, VDELP1 = 0x26, VDELBL = 0x27,
    RESMP0 = 0x28, RESMP1 = 0x29,
    HMOVE = 0x2a, HMCLR = 0x2b, CXCLR = 0x2c,
}

/// The bits of the registers' values.
pub(super) mod bit {
    /// `VSYNC`: vertical sync is on.
    pub(in crate::tia) const SYNC: u8 = 0x02;
    /// `VBLANK`: vertical blank is on.
    pub(in crate::tia) const BLANK: u8 = 0x02;
    /// `VBLANK`: the triggers are latched.
    pub(in crate::tia) const LATCH: u8 = 0x40;
    /// `VBLANK`: the paddles' capacitors are discharged.
    pub(in crate::tia) const DISCHARGE: u8 = 0x80;
    /// `COLUxx`: hue and luminance.
    pub(in crate::tia) const COLOR: u8 = 0xfe;
    /// `CTRLPF`: the right half of the playfield mirrors the left half.
    pub(in crate::tia) const REFLECT_PLAYFIELD: u8 = 0x01;
    /// `CTRLPF`: the halves of the playfield have the players' colours.
    pub(in crate::tia) const SCORE: u8 = 0x02;
    /// `CTRLPF`: the playfield is drawn over the players.
    pub(in crate::tia) const PRIORITY: u8 = 0x04;
    /// `REFPx`: the player is reflected.
    pub(in crate::tia) const REFLECT: u8 = 0x08;
    /// `ENAMx` and `ENABL`: the object is visible.
    pub(in crate::tia) const ENABLE: u8 = 0x02;
    /// `VDELPx` and `VDELBL`: vertical delay is on.
    pub(in crate::tia) const DELAY: u8 = 0x01;
    /// `RESMPx`: the missile is hidden and locked to its player.
    pub(in crate::tia) const LOCK: u8 = 0x02;
    /// `INPTx`: the capacitor is charged, or the trigger is not pressed.
    pub(in crate::tia) const INPUT: u8 = 0x80;
}
