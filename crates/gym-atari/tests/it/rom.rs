/// Returns a 4K ROM whose program `code` starts at `$F000`.
pub(crate) fn rom(code: &[u8]) -> Vec<u8> {
    let mut rom = vec![0xea; 4096];
    rom[..code.len()].copy_from_slice(code);
    rom[4092..].copy_from_slice(&[0x00, 0xf0, 0x00, 0xf0]);
    rom
}
