//! Tests of the page in a real browser, without display.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value as Json;

use super::serve::{Site, listen, serve};
use crate::{files, root, say};

/// The largest duration of all tests.
const LONGEST: Duration = Duration::from_secs(1800);
/// The largest duration of a single test.
const SILENCE: Duration = Duration::from_secs(300);
/// A script for the page as one file. The script opens the test page as soon as the page shows an
/// image, or after a minute.
const SINGLE: &str = r#"<script>
const wait = setInterval(() => {
  const canvas = document.querySelector(".tile canvas");
  const pixels = canvas?.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  const seen = pixels && new Set(new Uint32Array(pixels.buffer)).size > 1;
  const now = Math.round(performance.now());
  if (!seen && now < 60000) return;
  clearInterval(wait);
  location = "TESTS?single=" + (seen ? now : "never");
}, 20);
</script>
"#;

/// Opens the test page in Chromium; with `single`, opens the page as one file first. The test page
/// posts each result, and `{"done": ...}` at the end.
pub(super) fn test(page: &Path, single: Option<&str>, traces: Option<&Path>) -> Result<(), String> {
    let (posts, results) = mpsc::channel();
    let mut folders = vec![
        ("test", root().join("crates/gym-web/tests")),
        ("models", root().join("crates/gym-mujoco/models")),
    ];
    folders.extend(traces.map(|folder| ("traces", folder.to_owned())));
    let site = Site {
        page: page.to_owned(),
        folders,
        posts: Some(posts),
    };
    let (listener, port) = listen(0)?;
    thread::spawn(move || serve(&listener, &site));
    let folder = std::env::temp_dir().join(format!("gym-web-test-{}", std::process::id()));
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut url = format!("http://localhost:{port}/test/test.html");
    if let Some(text) = single {
        let file = folder.join("gallery.html");
        files::write(
            &file,
            (text.to_owned() + &SINGLE.replace("TESTS", &url)).as_bytes(),
        )?;
        url = format!("file://{}", file.display());
    }
    let mut browser = Browser::start(&url, &folder)?;
    let mut failed = 0;
    let start = Instant::now();
    let mut heard = start;
    let outcome = loop {
        match results.recv_timeout(Duration::from_secs(2)) {
            Ok(text) => {
                heard = Instant::now();
                let result: Json =
                    serde_json::from_str(&text).map_err(|error| format!("{text}: {error}"))?;
                if let Some(count) = result["done"].as_u64() {
                    break match failed {
                        0 => say(format_args!("{count} tests passed")),
                        _ => Err(format!("{failed} of {count} tests of the page failed")),
                    };
                }
                let name = result["name"].as_str().unwrap_or_default();
                match result["error"].as_str() {
                    None => {
                        say(format_args!(
                            "ok      {name} {}",
                            result["note"].as_str().unwrap_or_default()
                        ))?;
                    }
                    Some(error) => {
                        say(format_args!("FAILED  {name}: {error}"))?;
                        failed += 1;
                    }
                }
            }
            // (a browser whose state is unknown counts as running)
            Err(RecvTimeoutError::Timeout) if matches!(browser.0.try_wait(), Ok(Some(_))) => {
                break Err("the browser ended before the tests".into());
            }
            Err(RecvTimeoutError::Timeout) if heard.elapsed() > SILENCE => {
                break Err("the page has stopped reporting".into());
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break Err("the server ended".into()),
        }
        if start.elapsed() > LONGEST {
            break Err("the tests take too long".into());
        }
    };
    drop(browser);
    let _ = fs::remove_dir_all(folder);
    outcome
}

/// A browser without display. A drop ends the browser.
struct Browser(Child);

impl Browser {
    fn start(url: &str, profile: &Path) -> Result<Self, String> {
        let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
        for name in names {
            let child = Command::new(name)
                .args([
                    "--headless",
                    "--no-sandbox",
                    "--disable-gpu",
                    "--no-first-run",
                    "--window-size=1280,900",
                ])
                .arg(format!("--user-data-dir={}", profile.display()))
                .arg(url)
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn();
            if let Ok(child) = child {
                return Ok(Self(child));
            }
        }
        Err(format!(
            "no browser was found: install one of {}",
            names.join(", ")
        ))
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // the browser may have ended by itself
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
