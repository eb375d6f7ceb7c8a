//! The environments as a WebAssembly module without imports, for the gallery in `page/`.
//!
//! A call goes through two buffers. JavaScript calls [`input`] for a buffer, writes a request in
//! JSON and perhaps bytes behind it, and calls [`call`]. The answer in JSON is then at [`output`];
//! bytes, such as a frame, are at [`attachment`]. [`Session::call`] lists the requests. Memory may
//! move in a call, so JavaScript makes its views of it anew after each.
//!
//! `cargo xtask web` builds it as a `cdylib` with link-time optimisation. Without it, the linker
//! drops the registrations of crates that are not called.
//!
//! A panic traps and ends the instance: its text lies at [`panic_text`], and the page starts
//! another instance.
//!
//! The page's JavaScript neither computes nor draws environments. One call with JSON in and out,
//! and bytes beside it, is the whole interface: there are no generated bindings.

mod describe;
mod episode;
mod learn;
mod linear;
mod player;
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

/// Makes panics leave their text. To be called once, after `__wasm_call_ctors`.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn start() {
    std::panic::set_hook(Box::new(|info| {
        PANIC.with_borrow_mut(|text| *text = info.to_string());
    }));
}

/// Room for a request of that many bytes.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    BUFFERS.with_borrow_mut(|buffers| {
        buffers.input.clear();
        buffers.input.resize(length, 0);
        buffers.input.as_mut_ptr()
    })
}

/// Answers the request, whose first `json` bytes are JSON; gives the length of the answer.
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

/// The address of the answer.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    BUFFERS.with_borrow(|buffers| buffers.output.as_ptr())
}

/// The address of the bytes that came with the answer.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn attachment() -> *const u8 {
    BUFFERS.with_borrow(|buffers| buffers.attachment.as_ptr())
}

/// The number of bytes that came with the answer.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn attachment_length() -> usize {
    BUFFERS.with_borrow(|buffers| buffers.attachment.len())
}

/// The address of the text of the last panic.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn panic_text() -> *const u8 {
    PANIC.with_borrow(|text| text.as_ptr())
}

/// The length in bytes of the text of the last panic.
#[expect(unsafe_code, reason = "JavaScript calls it by name")]
#[unsafe(no_mangle)]
pub extern "C" fn panic_length() -> usize {
    PANIC.with_borrow(String::len)
}
