//! An HTTP server of the files in a folder, on the loopback address.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::thread;

use crate::files;

/// The served files.
#[derive(Clone, Debug)]
pub(super) struct Site {
    /// The files of the page.
    pub(super) page: PathBuf,
    /// Further folders, by the first part of the URL's path: `("traces", "/somewhere")`.
    pub(super) folders: Vec<(&'static str, PathBuf)>,
    /// Receives the data that a browser posts.
    pub(super) posts: Option<Sender<String>>,
}

/// Returns a listener on `port`, and its port. With 0, the system chooses a free port.
pub(super) fn listen(port: u16) -> Result<(TcpListener, u16), String> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port));
    let listener =
        listener.map_err(|error| format!("port {port}: {error}; take another with `--port`"))?;
    let port = listener
        .local_addr()
        .map_err(|error| error.to_string())?
        .port();
    Ok((listener, port))
}

/// Serves the site until the program ends.
pub(super) fn serve(listener: &TcpListener, site: &Site) {
    for stream in listener.incoming().flatten() {
        let site = site.clone();
        // a browser that closes the connection is no error
        thread::spawn(move || answer(stream, &site).ok());
    }
}

fn answer(mut stream: TcpStream, site: &Site) -> std::io::Result<()> {
    const LONGEST: u64 = 16 << 20;
    let mut request = BufReader::new(stream.try_clone()?.take(LONGEST));
    let mut line = String::new();
    request.read_line(&mut line)?;
    let mut length = 0;
    let mut header = String::new();
    while request.read_line(&mut header)? > 2 {
        if let Some((name, value)) = header.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().unwrap_or(0);
        }
        header.clear();
    }
    let (status, kind, body) = match &site.posts {
        Some(posts) if line.starts_with("POST ") => {
            let mut text = vec![0; length.min(LONGEST as usize)];
            request.read_exact(&mut text)?;
            // the receiver may be gone
            let _ = posts.send(String::from_utf8_lossy(&text).into_owned());
            ("200 OK", "text/plain", Vec::new())
        }
        _ => match file(&line, site) {
            Some((kind, body)) => ("200 OK", kind, body),
            None => ("404 Not Found", "text/plain", b"not found\n".to_vec()),
        },
    };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-cache\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    stream.write_all(&body)
}

/// Returns the file of a request line or, for a folder in `folders`, the names of its files as
/// JSON.
fn file(line: &str, site: &Site) -> Option<(&'static str, Vec<u8>)> {
    let path = line.strip_prefix("GET /")?.split([' ', '?']).next()?;
    let (folder, name) = match path.split_once('/') {
        Some((first, name)) => {
            let folder = site.folders.iter().find(|(other, _)| *other == first);
            (&folder?.1, name)
        }
        None => (&site.page, path),
    };
    if name.is_empty() && path.ends_with('/') {
        let mut names: Vec<String> = super::list(folder)
            .ok()?
            .iter()
            .map(|path| super::file_name(path))
            .collect();
        names.sort();
        return Some((
            "application/json",
            serde_json::json!(names).to_string().into_bytes(),
        ));
    }
    let name = if name.is_empty() { "index.html" } else { name };
    let name = name.replace("%3D", "=").replace("%2C", ",");
    if name.starts_with('.') || name.contains(['/', '\\', '%']) {
        return None;
    }
    let kind = match Path::new(&name)
        .extension()
        .and_then(|extension| extension.to_str())
    {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript",
        Some("css") => "text/css",
        Some("json") => "application/json",
        _ => "application/octet-stream",
    };
    Some((kind, files::read(&folder.join(name)).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_the_folders_are_served() {
        let own = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
        let site = Site {
            page: own.clone(),
            folders: vec![("code", own.join("src"))],
            posts: None,
        };
        for path in ["Cargo.toml?x", "code/main.rs", "code/"] {
            assert!(
                file(&format!("GET /{path} HTTP/1.1\r\n"), &site).is_some(),
                "{path}"
            );
        }
        let hidden = [
            "../Cargo.toml",
            "src/main.rs",
            "..",
            "%2e%2e",
            "code/../Cargo.toml",
            "code/web/serve.rs",
            "none.html",
        ];
        for path in hidden {
            assert!(
                file(&format!("GET /{path} HTTP/1.1\r\n"), &site).is_none(),
                "{path}"
            );
        }
        assert!(file("POST /Cargo.toml HTTP/1.1\r\n", &site).is_none());
    }

    /// Sends a request; returns the head of the answer and its body.
    fn asked(port: u16, request: &[u8]) -> (String, Vec<u8>) {
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        stream.write_all(request).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer
            .windows(4)
            .position(|part| part == b"\r\n\r\n")
            .unwrap();
        let head = String::from_utf8_lossy(&answer[..end]).replace("\r\n", "|");
        (head, answer[end + 4..].to_vec())
    }

    #[test]
    fn an_answer_has_the_kind_and_the_length_of_its_file() {
        let own = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
        let (posts, posted) = std::sync::mpsc::channel();
        let (listener, port) = listen(0).unwrap();
        let site = Site {
            page: own.join("../crates/gym-web/page"),
            folders: vec![("code", own.clone())],
            posts: Some(posts),
        };
        thread::spawn(move || serve(&listener, &site));
        let head = |status: &str, kind: &str, length: usize| {
            format!(
                "HTTP/1.1 {status}|Content-Type: {kind}|Content-Length: {length}|Cache-Control: no-cache|\
                 Connection: close"
            )
        };
        let page = own.join("../crates/gym-web/page");
        for (path, file, kind) in [
            ("", page.join("index.html"), "text/html; charset=utf-8"),
            ("dropped.js?v=1", page.join("dropped.js"), "text/javascript"),
            (
                "code/Cargo.toml",
                own.join("Cargo.toml"),
                "application/octet-stream",
            ),
        ] {
            let body = std::fs::read(file).unwrap();
            let request = format!("GET /{path} HTTP/1.1\r\nHost: x\r\n\r\n");
            let expected = (head("200 OK", kind, body.len()), body);
            assert!(asked(port, request.as_bytes()) == expected, "{path}");
        }
        let missing = asked(port, b"GET /none.html HTTP/1.1\r\n\r\n");
        let expected = (
            head("404 Not Found", "text/plain", 10),
            b"not found\n".to_vec(),
        );
        assert_eq!(missing, expected);
        // a trace is longer than what is read at once
        for length in [0, 3, 300_000] {
            let text = "x".repeat(length);
            let request =
                format!("POST /traces HTTP/1.1\r\ncontent-Length: {length}\r\n\r\n{text}");
            let answer = asked(port, request.as_bytes());
            assert_eq!(answer, (head("200 OK", "text/plain", 0), Vec::new()));
            assert!(posted.recv().unwrap() == text, "{length} bytes");
        }
    }
}
