//! A program that depends only on the core has an empty registry, whose error says so.

#[test]
fn nothing_is_registered() {
    assert!(gym_core::registry::all().is_empty());
    assert_eq!(gym_core::registry::pretty(3), "");
    let error = gym_core::make("CartPole-v1").unwrap_err().to_string();
    assert!(
        error.contains("no crate with environments is linked: add `use gym_classic as _;`"),
        "{error}"
    );
}
