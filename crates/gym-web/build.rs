//! Link arguments of the WebAssembly module.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_FAMILY").is_ok_and(|family| family == "wasm") {
        // Exported, the constructors that register the environments run when `start` calls them. Otherwise the linker puts a
        // call of all of them into each function that it exports.
        println!("cargo::rustc-cdylib-link-arg=--export=__wasm_call_ctors");
    }
}
