//! A page at an address of this machine alone, for who has the address.
//!
//! Other users of the machine can reach the port, and so can pages of other sites in the browser of the user: the address has a random
//! word in it, and a request whose `Host` is not this address is refused. Each browser has a thread and a limit of time, so that
//! one that is slow keeps nobody waiting.

use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use diagnostic::{Failure, Kind};

/// How often it looks for a browser, and whether it is to stop.
const PAUSE: Duration = Duration::from_millis(50);
/// Time for the head of a request, and for the page.
const HEAD_TIME: Duration = Duration::from_secs(5);
const PAGE_TIME: Duration = Duration::from_secs(60);
/// Longest head of a request.
const LONGEST_HEAD: usize = 16 << 10;
/// Browsers that are answered at the same time.
const BROWSERS: usize = 32;
/// Bytes that are written at once.
const PIECE: usize = 64 << 10;

/// A place at which browsers on this machine find a page.
#[derive(Debug)]
pub struct Served {
    listener: TcpListener,
    port: u16,
    /// The random word of the address.
    word: String,
}

impl Served {
    /// Takes a port of the loopback interface; 0 is one that is free.
    pub fn new(port: u16) -> Result<Self, Failure> {
        let taken = |error| not_taken(port, &error);
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(taken)?;
        listener.set_nonblocking(true).map_err(taken)?;
        let port = listener.local_addr().map_err(taken)?.port();
        let mut random = [0; 16];
        getrandom::fill(&mut random).map_err(|error| taken(io::Error::other(error)))?;
        Ok(Self { listener, port, word: random.iter().map(|byte| format!("{byte:02x}")).collect() })
    }

    /// Its address.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.word)
    }

    /// Gives the page to browsers that ask for it, until it is told to stop.
    pub fn serve(&self, page: String, stop: &AtomicBool) -> Result<(), Failure> {
        let door = Arc::new(Door { page, path: format!("/{}/", self.word), port: self.port });
        while !stop.load(Ordering::Relaxed) {
            match self.listener.accept() {
                Ok((browser, _)) if Arc::strong_count(&door) <= BROWSERS => {
                    let door = door.clone();
                    // A browser that breaks off concerns nobody else; one that has no thread may ask again.
                    let _ = thread::Builder::new().spawn(move || door.answer(&browser));
                }
                Ok(_) => {}
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => sleep(PAUSE),
                Err(error) => return Err(not_taken(self.port, &error)),
            }
        }
        Ok(())
    }
}

/// The error of a port that somebody else has, or may not be had.
fn not_taken(port: u16, error: &io::Error) -> Failure {
    let help = "leave --port out, so that one that is free is taken";
    Kind::Io.alone().help(help).says(format!("port {port} of 127.0.0.1 cannot be taken: {error}"))
}

/// A page and who may have it.
struct Door {
    page: String,
    path: String,
    port: u16,
}

impl Door {
    /// Answers one request.
    fn answer(&self, browser: &TcpStream) -> io::Result<()> {
        browser.set_nonblocking(false)?;
        let head = head(browser)?;
        let mut lines = head.lines();
        let request: Vec<&str> = lines.next().unwrap_or_default().split(' ').collect();
        let host = lines.find_map(|line| {
            let (name, value) = line.split_once(':')?;
            name.eq_ignore_ascii_case("host").then(|| value.trim().to_ascii_lowercase())
        });
        let is_ours =
            |host: String| ["127.0.0.1", "localhost"].iter().any(|ours| host == format!("{ours}:{}", self.port));
        let (status, kind, body) = match request[..] {
            _ if !host.is_some_and(is_ours) => ("403 Forbidden", "text/plain", "this page is for this machine alone"),
            ["GET", path, _] if path == self.path => ("200 OK", "text/html; charset=utf-8", self.page.as_str()),
            ["GET", ..] => {
                ("404 Not Found", "text/plain", "the page is at the address that `flexframe play` has printed")
            }
            _ => ("405 Method Not Allowed", "text/plain", "this page can only be read"),
        };
        let length = body.len();
        let head = format!(
            "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\n\
             Referrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n"
        );
        let until = Instant::now() + PAGE_TIME;
        for piece in [head.as_bytes()].into_iter().chain(body.as_bytes().chunks(PIECE)) {
            browser.set_write_timeout(Some(left(until)?))?;
            (&mut &*browser).write_all(piece)?;
        }
        Ok(())
    }
}

/// The head of a request.
fn head(mut browser: &TcpStream) -> io::Result<String> {
    let until = Instant::now() + HEAD_TIME;
    let (mut head, mut piece) = (Vec::new(), [0; 1024]);
    while !head.windows(4).any(|end| end == b"\r\n\r\n") {
        browser.set_read_timeout(Some(left(until)?))?;
        match browser.read(&mut piece)? {
            0 => break,
            _ if head.len() > LONGEST_HEAD => return Err(io::ErrorKind::InvalidData.into()),
            count => head.extend_from_slice(&piece[..count]),
        }
    }
    Ok(String::from_utf8_lossy(&head).into_owned())
}

/// The time that is left, which is not zero.
fn left(until: Instant) -> io::Result<Duration> {
    until.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()).ok_or(io::ErrorKind::TimedOut.into())
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
    fn one_page_is_there_for_who_has_its_address_until_it_is_told_to_stop() {
        let (served, stop) = (Served::new(0).unwrap(), AtomicBool::new(false));
        let (port, word) = (served.port, served.word.clone());
        assert_ne!(word, Served::new(0).unwrap().word);
        assert_eq!(served.address(), format!("http://127.0.0.1:{port}/{word}/"));
        let taken = Served::new(port).unwrap_err().to_string();
        assert!(taken.contains(&port.to_string()), "{taken}");
        thread::scope(|scope| {
            let serving = scope.spawn(|| served.serve("<p>page</p>".to_owned(), &stop));
            // Browsers that say nothing, or half of a head, keep nobody waiting.
            let slow: Vec<_> = (0..4)
                .map(|_| {
                    let mut slow = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
                    slow.write_all(b"GET / HT").unwrap();
                    slow
                })
                .collect();
            let head = |path: &str, host: &str| format!("GET {path} HTTP/1.1\r\nhost: {host}\r\n\r\n");
            let ours = format!("127.0.0.1:{port}");
            for host in [ours.clone(), format!("LocalHost:{port}")] {
                let page = asked(port, &head(&format!("/{word}/"), &host));
                assert!(page.starts_with("HTTP/1.1 200 OK\r\n") && page.ends_with("\r\n\r\n<p>page</p>"), "{page}");
            }
            // A name of another site that leads here (DNS rebinding), another port, no host.
            for host in ["evil.example".to_owned(), format!("evil.example:{port}"), "127.0.0.1:1".to_owned()] {
                assert!(asked(port, &head(&format!("/{word}/"), &host)).starts_with("HTTP/1.1 403"));
            }
            assert!(asked(port, &format!("GET /{word}/ HTTP/1.1\r\n\r\n")).starts_with("HTTP/1.1 403"));
            // Another user of this machine has the port, and not the word.
            for path in ["/", "/other", "//", &format!("/{word}"), &format!("/{word}/x")] {
                assert!(asked(port, &head(path, &ours)).starts_with("HTTP/1.1 404"));
            }
            assert!(
                asked(port, &format!("POST /{word}/ HTTP/1.1\r\nHost: {ours}\r\n\r\n")).starts_with("HTTP/1.1 405")
            );
            assert!(asked(port, "\r\n\r\n").starts_with("HTTP/1.1 403"));
            stop.store(true, Ordering::Relaxed);
            serving.join().unwrap().unwrap();
            drop(slow);
        });
    }
}
