//! Output of a program, line by line.

use std::io::{self, Read};
use std::sync::mpsc::SyncSender;
use std::thread;

/// The most bytes of a line; what goes beyond is left out.
const LONGEST: usize = 1 << 20;

/// Where something was said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stream {
    /// Standard output.
    Output,
    /// Standard error.
    Error,
}

/// Sends the lines of a stream, from a thread of its own, which ends with the stream or with whoever listens.
pub(crate) fn listen(
    mut stream: impl Read + Send + 'static,
    kind: Stream,
    send: SyncSender<(Stream, String)>,
) -> io::Result<()> {
    let run = move || {
        let (mut bytes, mut line) = (vec![0; 1 << 16], Vec::new());
        let told = |line: &mut Vec<u8>| {
            let text = String::from_utf8_lossy(line).trim_end().to_owned();
            line.clear();
            send.send((kind, text)).is_ok()
        };
        loop {
            let count = match stream.read(&mut bytes) {
                Ok(0) => break,
                Ok(count) => count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(_) => break,
            };
            for part in bytes[..count].split_inclusive(|byte| *byte == b'\n') {
                let room = LONGEST.saturating_sub(line.len());
                line.extend_from_slice(&part[..part.len().min(room)]);
                if part.ends_with(b"\n") && !told(&mut line) {
                    return;
                }
            }
        }
        if !line.is_empty() {
            told(&mut line);
        }
    };
    thread::Builder::new().name("listener".to_owned()).spawn(run).map(drop)
}
