//! Tests of the mode `human`, which need a display, such as that of `xvfb-run --auto-servernum
//! cargo test --package window-tests`.
#![cfg(all(unix, not(target_os = "macos")))]

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use gym_core::canvas::{Canvas, Color};
use gym_core::render::{Frame, Metadata, RenderMode, open_screen};
use gym_core::wrappers::Render;
use gym_core::{Env, EnvExt, Error, Outcome, Reset, Result, Snapshot, Space};
use gym_render as _;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConfigureWindowAux, ConnectionExt, EventMask, ImageFormat, Window,
};
use x11rb::rust_connection::RustConnection;

const FPS: u32 = 50;
const COLOR: Color = Color::rgb(200, 100, 50);
/// More time than any wait needs, even on a slow machine.
const PATIENCE: Duration = Duration::from_secs(10);

/// An environment that shows one colour and never ends.
#[derive(Clone)]
struct Colored;

/// The number of drawings.
static DRAWN: AtomicUsize = AtomicUsize::new(0);

impl Env for Colored {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(1)
    }

    fn action_space(&self) -> Space {
        Space::discrete(1)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        *observation = 0;
        Ok(())
    }

    fn step_into(&mut self, _: &i64, observation: &mut i64) -> Result<Outcome> {
        *observation = 0;
        Ok(Outcome::default())
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get()
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(FPS, (120, 80))
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        DRAWN.fetch_add(1, Ordering::Relaxed);
        canvas.clear(COLOR);
    }

    fn describe(&self) -> String {
        "a colour".into()
    }
}

/// The display, as another program sees it.
struct Display(RustConnection, Window);

impl Display {
    fn open() -> Self {
        let (connection, screen) = RustConnection::connect(None).unwrap();
        let root = connection.setup().roots[screen].root;
        Self(connection, root)
    }

    fn window(&self, title: &str) -> Option<Window> {
        let children = self.0.query_tree(self.1).unwrap().reply().unwrap().children;
        children.into_iter().find(|window| {
            let name =
                self.0
                    .get_property(false, *window, AtomEnum::WM_NAME, AtomEnum::ANY, 0, 100);
            name.unwrap()
                .reply()
                .is_ok_and(|name| name.value == title.as_bytes())
        })
    }

    /// Returns the colour in the middle of a window.
    fn middle(&self, window: Window) -> Option<[u8; 3]> {
        let size = self.0.get_geometry(window).unwrap().reply().ok()?;
        let (x, y) = (size.width as i16 / 2, size.height as i16 / 2);
        let image = self
            .0
            .get_image(ImageFormat::Z_PIXMAP, window, x, y, 1, 1, !0)
            .unwrap();
        let [b, g, r, ..] = image.reply().ok()?.data[..] else {
            return None;
        };
        Some([r, g, b])
    }

    fn resize(&self, window: Window, width: u32, height: u32) {
        let size = ConfigureWindowAux::new().width(width).height(height);
        self.0
            .configure_window(window, &size)
            .unwrap()
            .check()
            .unwrap();
    }

    /// Closes a window as a window manager does for its user.
    fn close(&self, window: Window) {
        let atom = |name: &[u8]| {
            self.0
                .intern_atom(false, name)
                .unwrap()
                .reply()
                .unwrap()
                .atom
        };
        let data = [atom(b"WM_DELETE_WINDOW"), 0, 0, 0, 0];
        let message = ClientMessageEvent::new(32, window, atom(b"WM_PROTOCOLS"), data);
        self.0
            .send_event(false, window, EventMask::NO_EVENT, message)
            .unwrap()
            .check()
            .unwrap();
    }
}

/// Calls `attempt` until it returns `Some`.
fn eventually<T>(what: &str, mut attempt: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(answer) = attempt() {
            return answer;
        }
        assert!(start.elapsed() < PATIENCE, "{what}");
    }
}

/// One test, because all tests of a process share the display.
#[test]
fn a_window_shows_frames_survives_its_user_and_keeps_time() {
    let open = open_screen().unwrap();
    if std::env::var_os("DISPLAY").is_none() {
        let Err(error) = open("gym", (60, 40), 20) else {
            panic!("a window without a display")
        };
        assert!(matches!(error, Error::UnsupportedMode { .. }), "{error}");
        return;
    }

    // keep a connection: a server without connections restarts, and refuses clients meanwhile
    let display = Display::open();

    // frames last their full duration
    let mut screen = open("gym-render test", (60, 40), 20).unwrap();
    let start = Instant::now();
    for shade in 0..11 {
        let mut frame = Frame::new(60, 40).unwrap();
        frame.pixels_mut().fill(20 * shade);
        assert!(screen.show(&frame));
    }
    let elapsed = start.elapsed();
    assert!(elapsed >= Duration::from_millis(499), "{elapsed:?}");
    // a frame of another size is ignored
    assert!(screen.show(&Frame::new(1, 1).unwrap()));
    drop(screen);

    // an environment is visible, before and after a resize
    let mut env = Render::new(Colored, RenderMode::Human).unwrap();
    env.reset(0).unwrap();
    let window = eventually("a window", || display.window("a colour"));
    let mut is_seen = || {
        env.step(&0).unwrap();
        (display.middle(window) == Some([COLOR.r, COLOR.g, COLOR.b])).then_some(())
    };
    eventually("its picture", &mut is_seen);
    display.resize(window, 300, 310);
    eventually("the new size", || {
        let size = display.0.get_geometry(window).unwrap().reply().unwrap();
        ((size.width, size.height) == (300, 310)).then_some(())
    });
    eventually("its picture at another size", &mut is_seen);

    // after the user closes the window, the environment continues, and steps neither draw nor wait
    display.close(window);
    eventually("the end of the window", || {
        env.step(&0).unwrap();
        display.window("a colour").is_none().then_some(())
    });
    // the step that notices the closed window draws once more
    env.step(&0).unwrap();
    let drawn = DRAWN.load(Ordering::Relaxed);
    for _ in 0..FPS {
        env.step(&0).unwrap();
    }
    assert_eq!(DRAWN.load(Ordering::Relaxed), drawn);
}
