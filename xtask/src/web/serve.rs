//! A server of files in a folder, for this machine alone.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::thread;

/// Serves the folder until the program is interrupted.
pub(super) fn serve(folder: &Path, port: u16) -> Result<(), String> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port));
    let listener = listener.map_err(|error| format!("port {port}: {error}; take another with `--port`"))?;
    let port = listener.local_addr().map_err(|error| error.to_string())?.port();
    println!("http://localhost:{port}/ (Ctrl+C ends it)");
    for stream in listener.incoming().flatten() {
        let folder = folder.to_owned();
        // a browser that goes away is no error of the server
        thread::spawn(move || answer(stream, &folder).ok());
    }
    Ok(())
}

fn answer(mut stream: TcpStream, folder: &Path) -> std::io::Result<()> {
    let mut request = BufReader::new(stream.try_clone()?).take(64 * 1024);
    let mut line = String::new();
    request.read_line(&mut line)?;
    let mut header = String::new();
    while request.read_line(&mut header)? > 2 {
        header.clear();
    }
    let (status, kind, body) = match file(&line, folder) {
        Some((kind, body)) => ("200 OK", kind, body),
        None => ("404 Not Found", "text/plain", b"not found\n".to_vec()),
    };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-cache\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    stream.write_all(&body)
}

/// The file that a request line asks for. Names without folders alone: the page has no others.
fn file(line: &str, folder: &Path) -> Option<(&'static str, Vec<u8>)> {
    let path = line.strip_prefix("GET /")?.split([' ', '?']).next()?;
    let name = if path.is_empty() { "index.html" } else { path };
    if name.starts_with('.') || name.contains(['/', '\\', '%']) {
        return None;
    }
    let kind = match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript",
        Some("css") => "text/css",
        _ => "application/octet-stream",
    };
    Some((kind, fs::read(folder.join(name)).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_the_folder_are_served() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        assert!(file("GET /Cargo.toml?x HTTP/1.1\r\n", folder).is_some());
        for path in ["../Cargo.toml", "src/main.rs", "..", "%2e%2e", ".gitignore", "none.html"] {
            assert!(file(&format!("GET /{path} HTTP/1.1\r\n"), folder).is_none(), "{path}");
        }
        assert!(file("POST /Cargo.toml HTTP/1.1\r\n", folder).is_none());
    }
}
