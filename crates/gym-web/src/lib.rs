//! The environments as a WebAssembly module without imports, for the gallery in `page/`.
//!
//! A call uses two buffers. JavaScript calls [`input`] for a buffer, writes a request in JSON and,
//! for some requests, bytes after it, and calls [`call`]. The answer in JSON is then at [`output`],
//! and bytes, such as a frame, are at [`attachment`]. [`Session::call`] lists the requests. A call
//! may move the memory, so JavaScript makes its views of the memory anew after each call.
//!
//! `cargo xtask web` builds it as a `cdylib` with link-time optimisation. Without it, the linker
//! drops the registrations of crates that are not called.
//!
//! A panic ends the instance. Its text is at [`panic_text`], and the page starts another instance.
//!
//! The page's JavaScript neither computes nor draws environments. The interface is one function,
//! with JSON and bytes as arguments and results, so there are no generated bindings.

mod describe;
mod episode;
mod learn;
mod linear;
mod player;
#[cfg(feature = "robot")]
mod robot;
mod session;
mod tabular;

use std::cell::RefCell;

pub use session::Session;

#[derive(Default)]
struct Buffers {
    input: Vec<u8>,
    output: Vec<u8>,
    attachment: Vec<u8>,
    session: Session,
}

thread_local! {
    static BUFFERS: RefCell<Buffers> = RefCell::default();
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Stores the text of panics. Call it once, after `__wasm_call_ctors`.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn start() {
    std::panic::set_hook(Box::new(|info| {
        PANIC.with_borrow_mut(|text| *text = info.to_string());
    }));
}

/// Returns the address of a buffer of `length` bytes for a request.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    BUFFERS.with_borrow_mut(|buffers| {
        buffers.input.clear();
        buffers.input.resize(length, 0);
        buffers.input.as_mut_ptr()
    })
}

/// Answers the request, whose first `json` bytes are JSON. Returns the length of the answer.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn call(json: usize) -> usize {
    BUFFERS.with_borrow_mut(
        |Buffers {
             input,
             output,
             attachment,
             session,
         }| {
            let (request, bytes) = input.split_at(json.min(input.len()));
            attachment.clear();
            *output = session.call(request, bytes, attachment);
            output.len()
        },
    )
}

/// Returns the address of the answer.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    BUFFERS.with_borrow(|buffers| buffers.output.as_ptr())
}

/// Returns the address of the bytes of the answer.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn attachment() -> *const u8 {
    BUFFERS.with_borrow(|buffers| buffers.attachment.as_ptr())
}

/// Returns the number of these bytes.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn attachment_length() -> usize {
    BUFFERS.with_borrow(|buffers| buffers.attachment.len())
}

/// Returns the address of the text of the last panic.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn panic_text() -> *const u8 {
    PANIC.with_borrow(|text| text.as_ptr())
}

/// Returns the length of the text of the last panic in bytes.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn panic_length() -> usize {
    PANIC.with_borrow(String::len)
}
