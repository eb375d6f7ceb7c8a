//! Live windows.

use std::cell::RefCell;
use std::fmt;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use gym_core::inventory;
use gym_core::render::{Frame, Screen, ScreenProvider};
use gym_core::{Error, Result};
use minifb::{InputCallback, Key, MouseButton, MouseMode, ScaleMode, WindowOptions};

/// How often per second a window polls for input.
const UPDATES: usize = 60;

inventory::submit! {
    ScreenProvider { open: |title, size, fps| Ok(Box::new(Live::open(title, size, fps)?)) }
}

/// A window that shows frames and reads keys.
///
/// It can be resized; frames are scaled to it with their aspect ratio. The thread that opened the
/// window must call [`show`](Self::show) or [`update`](Self::update) often enough.
pub struct Window {
    window: minifb::Window,
    /// The pixels of the shown frame: 0x00RRGGBB.
    pixels: Vec<u32>,
    size: (usize, usize),
    pressed: Pressed,
}

/// The pointer of a window, such as a mouse.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pointer {
    /// Its place in pixels of the frame, from the top left; it can be outside.
    pub at: [f64; 2],
    /// Whether the left button is down.
    pub left: bool,
    /// Whether the middle button is down.
    pub middle: bool,
    /// Whether the right button is down.
    pub right: bool,
    /// Steps of the wheel since the last update, away from the user.
    pub wheel: f64,
}

/// The keys pressed since the last query, including those that were released before the next poll.
#[derive(Clone, Default)]
struct Pressed(Rc<RefCell<Vec<Key>>>);

impl InputCallback for Pressed {
    fn add_char(&mut self, _: u32) {}

    fn set_key_state(&mut self, key: Key, is_down: bool) {
        let mut keys = self.0.borrow_mut();
        if is_down && !keys.contains(&key) {
            keys.push(key);
        }
    }
}

impl Window {
    /// Opens a window for frames of this size.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] if there is no display.
    pub fn open(title: &str, size: (u32, u32)) -> Result<Self> {
        let size = (size.0 as usize, size.1 as usize);
        let options = WindowOptions {
            resize: true,
            scale_mode: ScaleMode::AspectRatioStretch,
            ..WindowOptions::default()
        };
        let mut window = minifb::Window::new(title, size.0, size.1, options)
            .map_err(|error| no_window(&error))?;
        window.set_target_fps(UPDATES);
        window.set_background_color(232, 232, 232);
        let pressed = Pressed::default();
        window.set_input_callback(Box::new(pressed.clone()));
        Ok(Self {
            window,
            pixels: vec![0; size.0 * size.1],
            size,
            pressed,
        })
    }

    /// Shows a frame; ignores a frame of another size.
    pub fn show(&mut self, frame: &Frame) {
        if (frame.width() as usize, frame.height() as usize) == self.size {
            let (pixels, _) = frame.pixels().as_chunks();
            for (shown, &[r, g, b]) in self.pixels.iter_mut().zip(pixels) {
                *shown = u32::from_be_bytes([0, r, g, b]);
            }
        }
        self.update();
    }

    /// Handles input, and shows the last frame again. Waits until a sixtieth of a second has passed
    /// since the last call.
    pub fn update(&mut self) {
        if self
            .window
            .update_with_buffer(&self.pixels, self.size.0, self.size.1)
            .is_err()
        {
            self.window.update();
        }
    }

    /// Whether the user has not closed the window.
    pub fn is_open(&self) -> bool {
        self.window.is_open()
    }

    /// Gives the frames that are shown from now on the window's size, and returns it.
    pub fn fit(&mut self) -> (u32, u32) {
        let (width, height) = self.window.get_size();
        self.size = (width.max(1), height.max(1));
        self.pixels.resize(self.size.0 * self.size.1, 0);
        (self.size.0 as u32, self.size.1 as u32)
    }

    /// The pointer at the last update.
    pub fn pointer(&self) -> Pointer {
        let is_down = |button| self.window.get_mouse_down(button);
        let (x, y) = self
            .window
            .get_mouse_pos(MouseMode::Pass)
            .unwrap_or_default();
        let wheel = self.window.get_scroll_wheel().unwrap_or_default().1;
        // frames are in the middle, with their aspect ratio
        let (width, height) = self.window.get_size();
        let sides = [(width, self.size.0), (height, self.size.1)];
        let [across, down] = sides.map(|(window, frame)| window as f64 / frame.max(1) as f64);
        let scale = across.min(down).max(f64::MIN_POSITIVE);
        let place = |at: f32, (window, frame): (usize, usize)| {
            (f64::from(at) - (window as f64 - frame as f64 * scale) / 2.0) / scale
        };
        Pointer {
            at: [place(x, sides[0]), place(y, sides[1])],
            left: is_down(MouseButton::Left),
            middle: is_down(MouseButton::Middle),
            right: is_down(MouseButton::Right),
            wheel: f64::from(wheel),
        }
    }

    /// Changes the title.
    pub fn set_title(&mut self, title: &str) {
        self.window.set_title(title);
    }

    /// Returns the names of the keys that are down or were pressed since the last call, such as
    /// `Left`, `Space`, `A` or `1`.
    pub fn keys(&mut self) -> Vec<String> {
        let mut keys = self.window.get_keys();
        keys.extend(self.pressed.0.take());
        keys.sort_by_key(|key| *key as usize);
        keys.dedup();
        keys.iter().map(|key| name(&format!("{key:?}"))).collect()
    }
}

/// Returns the label of the key whose name in minifb is `key`: `1` for `Key1`.
fn name(key: &str) -> String {
    match key.strip_prefix("Key") {
        Some(digit) if digit.len() == 1 => digit.to_owned(),
        _ => key.to_owned(),
    }
}

impl fmt::Debug for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Window")
            .field("size", &self.size)
            .finish_non_exhaustive()
    }
}

fn no_window(reason: &dyn fmt::Display) -> Error {
    Error::UnsupportedMode {
        target: "this system".into(),
        mode: "human".into(),
        reason: format!(
            "no window could be opened ({reason}): is there a display? `rgb_array` needs none"
        ),
    }
}

/// A window on its own thread. The window responds while the environment is busy, and the
/// environment never waits longer than the duration of a frame.
struct Live {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    /// The time of the next frame, and the duration of a frame.
    due: Instant,
    period: Duration,
}

struct Shared {
    /// The newest frame, until the window's thread takes it.
    frame: Mutex<Option<Frame>>,
    open: AtomicBool,
}

impl Live {
    fn open(title: &str, size: (u32, u32), fps: u32) -> Result<Self> {
        if cfg!(target_os = "macos") {
            return Err(no_window(&"macOS has windows on the main thread only"));
        }
        let shared = Arc::new(Shared {
            frame: Mutex::new(None),
            open: AtomicBool::new(true),
        });
        let (answer, opened) = mpsc::channel();
        let (theirs, title) = (shared.clone(), title.to_owned());
        let thread = thread::Builder::new()
            .name("gym window".into())
            .spawn(move || serve(&title, size, &theirs, &answer))
            .map_err(|error| no_window(&error))?;
        opened
            .recv()
            .map_err(|_| no_window(&"the window's thread ended"))??;
        let period = Duration::from_secs(1) / fps.max(1);
        Ok(Self {
            shared,
            thread: Some(thread),
            due: Instant::now(),
            period,
        })
    }
}

/// Opens the window, reports the result to `answer`, and shows frames until either side closes it.
fn serve(title: &str, size: (u32, u32), shared: &Shared, answer: &Sender<Result<()>>) {
    // sending fails only if the receiver was dropped
    match Window::open(title, size) {
        Err(error) => drop(answer.send(Err(error))),
        Ok(mut window) => {
            let _ = answer.send(Ok(()));
            while window.is_open() && shared.open.load(Ordering::Relaxed) {
                let frame = shared
                    .frame
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .take();
                match frame {
                    Some(frame) => window.show(&frame),
                    None => window.update(),
                }
            }
        }
    }
    shared.open.store(false, Ordering::Relaxed);
}

impl Screen for Live {
    fn show(&mut self, frame: &Frame) -> bool {
        // a thread that panicked has not set `open` to false
        let alive = self
            .thread
            .as_ref()
            .is_some_and(|thread| !thread.is_finished());
        if !alive || !self.shared.open.load(Ordering::Relaxed) {
            return false;
        }
        let now = Instant::now();
        thread::sleep(self.due.saturating_duration_since(now));
        // after a pause, count the frames' times from now
        self.due = self.due.max(now) + self.period;
        *self
            .shared
            .frame
            .lock()
            .unwrap_or_else(PoisonError::into_inner) = Some(frame.clone());
        true
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.shared.open.store(false, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // if the thread panicked, the window is closed too
            let _ = thread.join();
        }
    }
}
