//! The window of `cargo xtask mjcf FILE --window`, used by its user's hands: events of the pointer and
//! of the keyboard, and the pixels that follow.
//!
//! This program is the command too: it starts itself with the command's arguments.

use std::process::ExitCode;

#[cfg(not(all(unix, not(target_os = "macos"))))]
fn main() {}

#[cfg(all(unix, not(target_os = "macos")))]
fn main() -> ExitCode {
    if std::env::args().nth(1).as_deref() == Some("mjcf") {
        return gym_cli::main(env!("CARGO_MANIFEST_DIR"));
    }
    if std::env::var_os("DISPLAY").is_none() {
        return hands::without_a_display();
    }
    hands::use_each();
    ExitCode::SUCCESS
}

#[cfg(all(unix, not(target_os = "macos")))]
mod hands {
    use std::process::{Child, Command, ExitCode};
    use std::time::{Duration, Instant};

    use x11rb::connection::Connection;
    use x11rb::protocol::xproto::{
        AtomEnum, BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConfigureWindowAux, ConnectionExt as _,
        ImageFormat, KEY_PRESS_EVENT, KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT, Window,
    };
    use x11rb::protocol::xtest::ConnectionExt as _;
    use x11rb::rust_connection::RustConnection;

    /// More time than any wait needs, even on a slow machine.
    const PATIENCE: Duration = Duration::from_secs(60);

    const ROBOT: &str = r#"<mujoco model="arm"><worldbody><geom type="plane" size="2 2 1"/>
        <body name="ball" pos="0 0 0.25"><freejoint/><geom size="0.25"/></body>
        <body pos="0.8 0 0.6"><joint name="hinge" axis="0 1 0" damping="1"/><geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.05"/></body></worldbody>
        <actuator><motor name="pull" joint="hinge" ctrlrange="-2 2"/></actuator></mujoco>"#;

    fn start() -> Child {
        let path = std::env::temp_dir().join(format!("window-{}.xml", std::process::id()));
        std::fs::write(&path, ROBOT).unwrap();
        let mut program = Command::new(std::env::current_exe().unwrap());
        program
            .arg("mjcf")
            .arg(path)
            .args(["--window", "--size", "1280x720"]);
        program.spawn().unwrap()
    }

    /// Without a display, the command says what is missing.
    pub(crate) fn without_a_display() -> ExitCode {
        let code = start().wait().unwrap().code();
        assert_eq!(code, Some(1));
        ExitCode::SUCCESS
    }

    /// The display, with hands.
    struct Hands {
        display: RustConnection,
        root: Window,
        window: Window,
    }

    impl Hands {
        fn fake(&self, kind: u8, detail: u8, [x, y]: [i16; 2]) {
            let sent = self
                .display
                .xtest_fake_input(kind, detail, 0, self.root, x, y, 0);
            sent.unwrap().check().unwrap();
        }

        /// Moves the pointer in the window.
        fn point(&self, [x, y]: [i16; 2]) {
            let place = self
                .display
                .translate_coordinates(self.window, self.root, x, y);
            let place = place.unwrap().reply().unwrap();
            self.fake(MOTION_NOTIFY_EVENT, 0, [place.dst_x, place.dst_y]);
            // a frame
            std::thread::sleep(Duration::from_millis(60));
        }

        fn press(&self, button: u8) {
            self.fake(BUTTON_PRESS_EVENT, button, [0; 2]);
            std::thread::sleep(Duration::from_millis(120));
        }

        fn release(&self, button: u8) {
            self.fake(BUTTON_RELEASE_EVENT, button, [0; 2]);
            std::thread::sleep(Duration::from_millis(60));
        }

        fn drag(&self, button: u8, places: [[i16; 2]; 2]) {
            self.point(places[0]);
            self.press(button);
            self.point(places[1]);
            std::thread::sleep(Duration::from_millis(60));
            self.release(button);
        }

        /// Presses the key of a symbol of the keyboard.
        fn key(&self, symbol: u32) {
            let setup = self.display.setup();
            let (first, last) = (setup.min_keycode, setup.max_keycode);
            let map = self.display.get_keyboard_mapping(first, last - first + 1);
            let map = map.unwrap().reply().unwrap();
            let width = usize::from(map.keysyms_per_keycode);
            let place = map.keysyms.chunks(width).position(|key| key[0] == symbol);
            let key = first + place.expect("the key") as u8;
            self.fake(KEY_PRESS_EVENT, key, [0; 2]);
            std::thread::sleep(Duration::from_millis(60));
            self.fake(KEY_RELEASE_EVENT, key, [0; 2]);
        }

        fn title(&self, window: Window) -> Option<Vec<u8>> {
            let name =
                self.display
                    .get_property(false, window, AtomEnum::WM_NAME, AtomEnum::ANY, 0, 100);
            Some(name.ok()?.reply().ok()?.value)
        }

        /// The pixels of a part of the window.
        fn pixels(&self, [x, y]: [i16; 2], [width, height]: [u16; 2]) -> Vec<u8> {
            let image =
                self.display
                    .get_image(ImageFormat::Z_PIXMAP, self.window, x, y, width, height, !0);
            image.unwrap().reply().unwrap().data
        }

        /// The picture of the model, in a window of 1280 by 720.
        fn picture(&self) -> Vec<u8> {
            self.pixels([0, 0], [960, 720])
        }

        /// The picture once it stands still.
        fn still(&self) -> Vec<u8> {
            let mut last = self.picture();
            eventually("a picture that stands still", || {
                std::thread::sleep(Duration::from_millis(200));
                let now = self.picture();
                let is_still = now == last;
                last = now;
                is_still.then(|| last.clone())
            })
        }

        fn changes(&self, what: &str, from: &[u8]) {
            eventually(what, || (self.picture() != from).then_some(()));
        }

        fn is_named(&self, name: &str) {
            let is_it = || {
                self.title(self.window)
                    .is_some_and(|title| title == name.as_bytes())
            };
            eventually(name, || is_it().then_some(()));
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
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    pub(crate) fn use_each() {
        let (display, screen) = RustConnection::connect(None).unwrap();
        let root = display.setup().roots[screen].root;
        let mut child = start();
        let mut hands = Hands {
            display,
            root,
            window: root,
        };
        hands.window = eventually("the window", || {
            let children = hands.display.query_tree(root).unwrap().reply().unwrap();
            let mut children = children.children.into_iter();
            children.find(|window| hands.title(*window).is_some_and(|title| title == b"arm"))
        });
        let window = hands.window;
        hands.point([100, 100]);
        // the ball lies still and the arm hangs
        let still = hands.still();
        // the last row of buttons before the sliders: the panel begins at 960
        hands.drag(1, [[1120, 228], [1260, 228]]);
        hands.changes("a slider moves the arm", &still);
        hands.drag(3, [[1120, 228], [1120, 228]]);
        // keys and a button
        hands.point([100, 100]);
        hands.key(u32::from(b' '));
        hands.is_named("arm (paused)");
        hands.drag(1, [[980, 111], [980, 111]]);
        hands.is_named("arm");
        hands.still();
        // the camera turns, moves and comes nearer
        for (what, button) in [("turn", 1), ("move", 3), ("move level", 2), ("nearer", 4)] {
            let before = hands.still();
            if button == 4 {
                hands.point([60, 60]);
                hands.press(button);
                hands.release(button);
            } else {
                hands.drag(button, [[60, 60], [120, 90]]);
            }
            hands.changes(what, &before);
        }
        // a window as narrow as a phone
        let size = ConfigureWindowAux::new().width(400).height(800);
        let resized = hands.display.configure_window(window, &size);
        resized.unwrap().check().unwrap();
        eventually("the panel below", || {
            let size = hands.display.get_geometry(window).unwrap().reply().unwrap();
            if (size.width, size.height) != (400, 800) {
                return None;
            }
            let corner = hands.pixels([4, 790], [1, 1]);
            (corner[..3] == [249, 247, 246]).then_some(())
        });
        hands.point([100, 100]);
        hands.key(0xff1b);
        let code = eventually("the end", || child.try_wait().unwrap());
        assert!(code.success(), "{code}");
    }
}
