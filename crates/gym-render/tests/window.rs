//! The mode `human`, where there is a display to show it.
#![cfg(feature = "human")]

use std::time::{Duration, Instant};

use gym_core::Error;
use gym_core::render::{Frame, open_screen};
use gym_render as _;

/// One test, since all tests of a process share the display.
#[test]
fn a_window_shows_frames_at_their_rate() {
    let open = open_screen().unwrap();
    let opened = open("gym-render test", (60, 40), 20);
    if std::env::var_os("DISPLAY").is_none() && cfg!(all(unix, not(target_os = "macos"))) {
        let Err(error) = opened else { panic!("a window without a display") };
        assert!(matches!(error, Error::UnsupportedMode { .. }), "{error}");
        return;
    }
    let Ok(mut screen) = opened else { return };
    let start = Instant::now();
    for shade in 0..11 {
        let mut frame = Frame::new(60, 40);
        frame.pixels_mut().fill(20 * shade);
        assert!(screen.show(&frame));
    }
    let elapsed = start.elapsed();
    assert!(elapsed >= Duration::from_millis(499), "{elapsed:?}");
    // a frame of another size is left out
    assert!(screen.show(&Frame::new(1, 1)));
    drop(screen);
}
