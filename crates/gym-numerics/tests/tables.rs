//! The tables equal the output of the program that generates them.

#[path = "../examples/tables.rs"]
#[expect(dead_code, reason = "a program has a main function")]
mod tables;

#[test]
fn tables_are_what_their_program_prints() {
    assert!(
        tables::generate() == include_str!("../src/math/tables.rs"),
        "run `examples/tables.rs`"
    );
}
