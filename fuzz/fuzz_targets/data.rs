//! The target `data` for `cargo fuzz`.

#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| gym_fuzz::targets::data(input));
