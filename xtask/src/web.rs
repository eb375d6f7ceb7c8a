//! `cargo xtask web`: the gallery, the environments in the browser, as a folder of static files or
//! as one file.

mod serve;
mod test;

use std::ffi::{OsStr, OsString};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::process::Command;

use base64::Engine;
use serde_json::{Map, Value as Json, json};

use crate::{cargo, collision, files, root, say, target_dir};

const TARGET: &str = "wasm32-unknown-unknown";
const USAGE: &str = "\
Builds the gallery: a page that runs the environments in the browser

Usage: cargo xtask web [OPTIONS]

Options:
      --out FOLDER    Where to put the files; by default target/web
      --single        Also writes gallery.html there: the whole page in one file, which a double click opens
      --serve         Shows the page at http://localhost:8000 until it is interrupted
      --port NUMBER   Another port, for --serve
      --test          Tests the page in a Chromium without display, and the one file of --single
      --traces FOLDER Replays the recorded traces in that folder too, for --test
      --small         Classic control and toy text alone: quick to build, for work on the page
      --robot         The page of the reader's own robots alone, also as one file, robot.html; by default to target/web-robot
      --plugin PATH   A gallery of the environments of the crate in that folder, which links them and gym-web
  -h, --help          Print help";

#[derive(Debug, Default, PartialEq)]
struct Options {
    out: Option<PathBuf>,
    single: bool,
    serve: bool,
    port: Option<u16>,
    small: bool,
    test: bool,
    traces: Option<PathBuf>,
    plugin: Option<PathBuf>,
    robot: bool,
    help: bool,
}

impl Options {
    fn parse(arguments: &[OsString]) -> Result<Self, String> {
        let mut options = Self::default();
        let mut arguments = arguments.iter();
        while let Some(argument) = arguments.next() {
            let mut value = || {
                arguments
                    .next()
                    .ok_or(format!("`{}` needs a value", argument.display()))
            };
            match argument.to_str() {
                Some("--single") => options.single = true,
                Some("--serve") => options.serve = true,
                Some("--small") => options.small = true,
                Some("--robot") => options.robot = true,
                Some("--test") => options.test = true,
                Some("--traces") => options.traces = Some(value()?.into()),
                Some("-h" | "--help") => options.help = true,
                Some("--out") => options.out = Some(value()?.into()),
                Some("--plugin") => options.plugin = Some(value()?.into()),
                Some("--port") => {
                    let port = value()?;
                    let number = port.to_str().and_then(|port| port.parse().ok());
                    options.port = Some(number.ok_or(format!(
                        "`--port {}` is not a port",
                        port.to_string_lossy().escape_debug()
                    ))?);
                }
                _ => {
                    return Err(format!(
                        "unexpected argument `{}`\n\n{USAGE}",
                        argument.to_string_lossy().escape_debug()
                    ));
                }
            }
        }
        Ok(options)
    }
}

/// Runs the command.
pub(crate) fn web(arguments: &[OsString]) -> Result<(), String> {
    let options = Options::parse(arguments)?;
    if options.help {
        return say(format_args!("{USAGE}"));
    }
    check_target()?;
    let feature = match (options.small, options.robot) {
        (_, true) => "compiled",
        (true, false) => "small",
        _ => "families",
    };
    let module = build(options.plugin.as_deref(), feature)?;
    let folder = if options.robot { "web-robot" } else { "web" };
    let out = options.out.unwrap_or_else(|| target_dir().join(folder));
    let page = Page::read(&module, options.plugin.is_none() && !options.robot)?;
    page.write(&out)?;
    say(format_args!(
        "{}: {} files, {} kB",
        out.display(),
        page.files.len(),
        page.size() / 1000
    ))?;
    let single = if options.single || options.robot {
        Some(page.in_one_file()?)
    } else {
        None
    };
    if let Some(text) = &single {
        let name = if options.robot {
            "robot.html"
        } else {
            "gallery.html"
        };
        let path = out.join(name);
        files::write(&path, text.as_bytes())?;
        say(format_args!("{}: {} kB", path.display(), text.len() / 1000))?;
    }
    if options.test {
        test::test(&out, single.as_deref(), options.traces.as_deref())?;
    }
    if options.serve {
        let (listener, port) = serve::listen(options.port.unwrap_or(8000))?;
        say(format_args!("http://localhost:{port}/ (Ctrl+C ends it)"))?;
        serve::serve(
            &listener,
            &serve::Site {
                page: out,
                folders: Vec::new(),
                posts: None,
            },
        );
    }
    Ok(())
}

/// Returns an error with the remedy if the compiler has no standard library for the target.
fn check_target() -> Result<(), String> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(&rustc)
        .args(["--print", "target-libdir", "--target", TARGET])
        .output();
    let output = output.map_err(|error| format!("{} cannot be run: {error}", rustc.display()))?;
    let folder = String::from_utf8_lossy(&output.stdout);
    if output.status.success() && Path::new(folder.trim()).is_dir() {
        return Ok(());
    }
    Err(format!(
        "the compiler has no standard library for {TARGET}. With rustup: `rustup target add {TARGET}`. Without, install your \
         system's package of it (Fedora: rust-std-static-{TARGET}; Arch: rust-wasm); on Debian run .ci/web-setup, which says more"
    ))
}

/// Builds the WebAssembly module, of this workspace with a feature, or of a plugin, and returns its
/// path.
fn build(plugin: Option<&Path>, feature: &str) -> Result<PathBuf, String> {
    let mut cargo = Command::new(cargo());
    cargo
        .arg("--config")
        .arg(root().join("crates/gym-web/profile.toml"));
    // `cdylib` is given here, not in the manifest: a second crate type disables link-time
    // optimisation
    cargo.args([
        "rustc",
        "--profile",
        "gallery",
        "--target",
        TARGET,
        "--lib",
        "--crate-type",
        "cdylib",
    ]);
    cargo.arg("--target-dir").arg(target_dir());
    let file = match plugin {
        None => {
            cargo
                .args(["--package", "gym-web", "--manifest-path"])
                .arg(root().join("Cargo.toml"))
                .args(["--no-default-features", "--features", feature]);
            "gym_web.wasm".to_owned()
        }
        Some(folder) => {
            let manifest = folder.join("Cargo.toml");
            cargo.arg("--manifest-path").arg(&manifest);
            format!("{}.wasm", library(&manifest)?)
        }
    };
    // Export the constructors that register the environments, so that the page can call them once.
    // Otherwise the linker inserts a call of all constructors into each exported function. By default
    // the number of each function and address takes five bytes, however small it is.
    cargo.arg("--");
    for argument in [
        "--export=__wasm_call_ctors",
        "--compress-relocations",
        "-O2",
    ] {
        cargo.arg("-C").arg(format!("link-arg={argument}"));
    }
    let status = cargo
        .status()
        .map_err(|error| format!("cargo cannot be run: {error}"))?;
    if !status.success() {
        return Err("the module could not be built".into());
    }
    Ok(target_dir().join(TARGET).join("gallery").join(file))
}

/// Returns the name of the library of the package with the manifest `manifest`.
fn library(manifest: &Path) -> Result<String, String> {
    let at = |error: String| format!("{}: {error}", manifest.display());
    let output = Command::new(cargo())
        .args(["metadata", "--format-version", "1", "--manifest-path"])
        .arg(manifest)
        .output()
        .map_err(|error| at(format!("cargo cannot be run: {error}")))?;
    if !output.status.success() {
        let error = String::from_utf8_lossy(&output.stderr);
        return Err(at(
            collision::explain(&error).unwrap_or_else(|| error.trim().to_owned())
        ));
    }
    let metadata: Json =
        serde_json::from_slice(&output.stdout).map_err(|error| at(error.to_string()))?;
    let path = manifest
        .canonicalize()
        .map_err(|error| at(error.to_string()))?;
    let elements = |json: &Json| json.as_array().cloned().unwrap_or_default();
    let packages = elements(&metadata["packages"]);
    let package = packages
        .iter()
        .find(|package| package["manifest_path"].as_str().map(Path::new) == Some(&path));
    let targets = package.map_or_else(Vec::new, |package| elements(&package["targets"]));
    let library = targets
        .iter()
        .find(|target| elements(&target["kind"]).iter().any(|kind| kind == "lib"));
    library
        .and_then(|library| Some(library["name"].as_str()?.replace('-', "_")))
        .ok_or_else(|| at("it has no library: add src/lib.rs".into()))
}

/// The files of the page, by name.
struct Page {
    files: Vec<(String, Vec<u8>)>,
}

impl Page {
    /// Reads the page's own files and the module; with `docs`, also the book's pages on the
    /// environments.
    fn read(module: &Path, docs: bool) -> Result<Self, String> {
        let mut files = Vec::new();
        for path in list(&root().join("crates/gym-web/page"))? {
            files.push((file_name(&path), files::read(&path)?));
        }
        let mut texts = Map::new();
        if docs {
            for path in list(&root().join("docs/environments"))? {
                if path.extension() == Some(OsStr::new("md"))
                    && path.file_stem() != Some(OsStr::new("README"))
                {
                    let text = String::from_utf8_lossy(&files::read(&path)?).into_owned();
                    texts.insert(
                        file_name(&path).trim_end_matches(".md").to_owned(),
                        text.into(),
                    );
                }
            }
        }
        files.push((
            "docs.json.gz".into(),
            gzip(Json::Object(texts).to_string().as_bytes())?,
        ));
        files.push(("gym.wasm.gz".into(), gzip(&files::read(module)?)?));
        Ok(Self { files })
    }

    fn size(&self) -> usize {
        self.files.iter().map(|(_, bytes)| bytes.len()).sum()
    }

    fn write(&self, folder: &Path) -> Result<(), String> {
        files::create(folder)?;
        self.files
            .iter()
            .try_for_each(|(name, bytes)| files::write(&folder.join(name), bytes))
    }

    fn text(&self, name: &str) -> Result<&str, String> {
        let file = self.files.iter().find(|(other, _)| other == name);
        let (_, bytes) = file.ok_or_else(|| format!("the page has no {name}"))?;
        std::str::from_utf8(bytes).map_err(|error| format!("{name}: {error}"))
    }

    /// Returns the page as one file. In browsers, a page opened as a file cannot load other files,
    /// so the scripts become Blobs.
    fn in_one_file(&self) -> Result<String, String> {
        const START: &str = r##"<script type="module">
const sources = GYM_SINGLE.scripts;
const urls = {};
const url = (name) => (urls[name] ??= URL.createObjectURL(new Blob(
  [sources[name].replace(/from "\.\/([\w.]+)"/g, (_, other) => `from "${url(other)}"`)], { type: "text/javascript" })));
await import(url("app.js"));
</script>"##;
        let mut scripts = Map::new();
        let mut single = Map::new();
        for (name, bytes) in &self.files {
            if name == "worker.js" {
                single.insert(name.clone(), self.text(name)?.into());
            } else if name.ends_with(".js") {
                scripts.insert(name.clone(), self.text(name)?.into());
            } else if name.ends_with(".gz") {
                single.insert(
                    name.clone(),
                    base64::prelude::BASE64_STANDARD.encode(bytes).into(),
                );
            }
        }
        single.insert("scripts".into(), scripts.into());
        // `</script>` in the data would end the script element
        let data = json!(single).to_string().replace("</", "<\\/");
        let parts = [
            (
                r#"<link rel="stylesheet" href="style.css">"#,
                format!("<style>\n{}</style>", self.text("style.css")?),
            ),
            (
                r#"<script type="module" src="app.js"></script>"#,
                format!("<script>globalThis.GYM_SINGLE = {data};</script>\n{START}"),
            ),
        ];
        let mut text = self.text("index.html")?.to_owned();
        for (part, own) in parts {
            if !text.contains(part) {
                return Err(format!("index.html has no `{part}`"));
            }
            text = text.replacen(part, &own, 1);
        }
        Ok(text)
    }
}

/// Compresses slowly and well: each reader downloads the result.
fn gzip(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let options = zopfli::Options {
        iteration_count: NonZero::<u64>::MIN,
        // code changes its kind more often than the 15 times in a megabyte that are the default
        maximum_block_splits: 200,
        ..zopfli::Options::default()
    };
    let mut packed = Vec::new();
    zopfli::compress(options, zopfli::Format::Gzip, bytes, &mut packed)
        .map_err(|error| error.to_string())?;
    Ok(packed)
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// Returns the files in a folder, sorted by name.
fn list(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut paths = files::list(folder)?;
    paths.retain(|path| path.is_file());
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn parse(line: &str) -> Result<Options, String> {
        Options::parse(
            &line
                .split_whitespace()
                .map(OsString::from)
                .collect::<Vec<_>>(),
        )
    }

    #[test]
    fn options_are_read() {
        let expected = Options {
            serve: true,
            port: Some(9000),
            single: true,
            ..Options::default()
        };
        assert_eq!(parse("--serve --port 9000 --single").unwrap(), expected);
        assert!(parse("--port many").unwrap_err().contains("not a port"));
        assert!(parse("--out").unwrap_err().contains("needs a value"));
        assert!(
            parse("--fast")
                .unwrap_err()
                .contains("unexpected argument `--fast`")
        );
    }

    /// What a browser unpacks begins with gzip's header, and ends with the sum and the length of what was packed.
    #[test]
    fn files_are_packed_as_gzip() {
        let packed = gzip(b"123456789").unwrap();
        assert_eq!(packed[..3], [0x1f, 0x8b, 8]);
        let (sum, length) = packed[packed.len() - 8..].split_at(4);
        // the check value of CRC-32
        assert_eq!(
            (sum, length),
            (&0xcbf4_3926u32.to_le_bytes()[..], &[9, 0, 0, 0][..])
        );
    }

    #[test]
    fn the_library_of_a_package_has_a_name() {
        let manifest = |path: &str| root().join(path).join("Cargo.toml");
        assert_eq!(library(&manifest("crates/gym-web")).unwrap(), "gym_web");
        let error = library(&manifest("xtask")).unwrap_err();
        assert!(error.contains("it has no library"), "{error}");
        let error = library(Path::new("/nonexistent/Cargo.toml")).unwrap_err();
        assert!(error.starts_with("/nonexistent/Cargo.toml"), "{error}");
    }

    #[test]
    fn one_file_holds_every_script_of_the_page() {
        let module = std::env::temp_dir().join(format!("module-{}.wasm", std::process::id()));
        fs::write(&module, "</script>").unwrap();
        let page = Page::read(&module, true).unwrap();
        fs::remove_file(&module).unwrap();
        let text = page.in_one_file().unwrap();
        for script in [
            "app.js",
            "engine.js",
            "worker.js",
            "gallery.js",
            "play.js",
            "robot.js",
        ] {
            assert!(text.contains(&format!("\"{script}\":")), "{script}");
        }
        assert!(!text.contains("src=\"app.js\"") && !text.contains("href=\"style.css\""));
    }
}
