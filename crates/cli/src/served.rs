//! A page at an address of this machine alone.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::Duration;

use crate::cli_error::CliError;

/// How often it looks for a browser, and whether it is to stop.
const PAUSE: Duration = Duration::from_millis(50);
/// A browser that says nothing for so long is left.
const PATIENCE: Duration = Duration::from_secs(5);
/// Longest head of a request.
const LONGEST_HEAD: u64 = 16 << 10;

/// A place at which browsers on this machine find a page.
#[derive(Debug)]
pub struct Served {
    listener: TcpListener,
    port: u16,
}

impl Served {
    /// Takes a port of the loopback interface; 0 is one that is free.
    pub fn new(port: u16) -> Result<Self, CliError> {
        let taken = |source| CliError::Port { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(taken)?;
        listener.set_nonblocking(true).map_err(taken)?;
        let port = listener.local_addr().map_err(taken)?.port();
        Ok(Self { listener, port })
    }

    /// Its address.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    /// Gives the page to whoever asks for it, until it is told to stop.
    pub fn serve(&self, page: &str, stop: &AtomicBool) -> Result<(), CliError> {
        while !stop.load(Ordering::Relaxed) {
            match self.listener.accept() {
                // A browser that breaks off concerns nobody but itself.
                Ok((browser, _)) => drop(answer(browser, page)),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => sleep(PAUSE),
                Err(source) => return Err(CliError::Port { port: self.port, source }),
            }
        }
        Ok(())
    }
}

/// Answers one request.
fn answer(browser: TcpStream, page: &str) -> io::Result<()> {
    browser.set_nonblocking(false)?;
    browser.set_read_timeout(Some(PATIENCE))?;
    browser.set_write_timeout(Some(PATIENCE))?;
    let mut head = BufReader::new(&browser).take(LONGEST_HEAD);
    let mut request = String::new();
    head.read_line(&mut request)?;
    let mut line = String::new();
    while head.read_line(&mut line)? > 2 {
        line.clear();
    }
    let (status, kind, body) = match request.split(' ').collect::<Vec<_>>()[..] {
        ["GET", "/", _] => ("200 OK", "text/html; charset=utf-8", page),
        ["GET", ..] => ("404 Not Found", "text/plain", "there is one page here: /"),
        _ => ("405 Method Not Allowed", "text/plain", "this page can only be read"),
    };
    let length = body.len();
    write!(
        &browser,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n"
    )?;
    (&browser).write_all(body.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(port: u16, request: &str) -> String {
        let mut browser = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        browser.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        browser.read_to_string(&mut answer).unwrap();
        answer
    }

    #[test]
    fn one_page_is_there_until_it_is_told_to_stop() {
        let (served, stop) = (Served::new(0).unwrap(), AtomicBool::new(false));
        let taken = Served::new(served.port).unwrap_err().to_string();
        assert!(taken.contains(&served.port.to_string()), "{taken}");
        std::thread::scope(|scope| {
            let serving = scope.spawn(|| served.serve("<p>page</p>", &stop));
            let page = asked(served.port, "GET / HTTP/1.1\r\nHost: x\r\n\r\n");
            assert!(page.starts_with("HTTP/1.1 200 OK\r\n") && page.ends_with("\r\n\r\n<p>page</p>"), "{page}");
            assert!(asked(served.port, "GET /other HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 404"));
            assert!(asked(served.port, "POST / HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 405"));
            assert!(asked(served.port, "\r\n\r\n").starts_with("HTTP/1.1 405"));
            drop(TcpStream::connect((Ipv4Addr::LOCALHOST, served.port)).unwrap());
            stop.store(true, Ordering::Relaxed);
            serving.join().unwrap().unwrap();
        });
    }
}
