//! Signals: ctrl-C, a request to terminate, and the end of the terminal.
//!
//! Before the motion begins there is nothing to lose, and a signal ends the program at once, with the programs that it has
//! started and its temporary files; the processes of SLEPc are ended before. Then the first stops the run at its next row, and another that comes half a
//! second later or more ends the program at once. A shell, a job scheduler and a terminal may send several for one
//! request, only milliseconds apart. Other signals that end a program end it at once, as they do without this.

use std::io;
use std::mem::MaybeUninit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use diagnostic::Kind;
use flexframe::failure::FailureReport;
use flexframe::run::RunProgress;
use signal_hook::consts::{SIGABRT, SIGALRM, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU};
use signal_hook::{iterator, low_level};
use slepc::Stop;
use whole_file::remove_temporaries;

use crate::output;

/// Signals that come sooner after the first belong to it.
const ONE_REQUEST: Duration = Duration::from_millis(500);

/// Signals that end the program as they end any program, once its temporary files are removed. A shell sends them by ctrl-\ and at its
/// limit of processor time, job schedulers and watchdogs for reasons of their own.
const ENDS: [i32; 6] = [SIGQUIT, SIGABRT, SIGXCPU, SIGALRM, SIGUSR1, SIGUSR2];

/// Listens to signals.
#[derive(Clone)]
pub struct Signals {
    /// True if a motion is being computed that can be resumed.
    in_motion: Arc<AtomicBool>,
    /// Asks the motion to stop.
    stop: Arc<AtomicBool>,
    /// Asks SLEPc to stop.
    slepc: Stop,
}

impl Signals {
    /// Begins to listen; `json` is the form in which the end of the program is told.
    pub fn listen(json: bool) -> io::Result<Self> {
        let ours = Self { in_motion: Arc::default(), stop: Arc::default(), slepc: Stop::default() };
        let (in_motion, stop, slepc) = (ours.in_motion.clone(), ours.stop.clone(), ours.slepc.clone());
        let mut signals = iterator::Signals::new([SIGINT, SIGTERM])?;
        // `nohup` has the first ignored.
        for signal in [SIGHUP].iter().chain(&ENDS).filter(|signal| !is_ignored(**signal)) {
            signals.add_signal(*signal)?;
        }
        thread::Builder::new().name("signals".to_owned()).spawn(move || {
            let mut request = Request::default();
            for signal in signals.forever() {
                if ENDS.contains(&signal) {
                    let _none = remove_temporaries();
                    let _ = low_level::emulate_default_handler(signal);
                    low_level::exit(Kind::Stopped.exit_code().into());
                }
                let can_stop = slepc.ask() || in_motion.load(Ordering::SeqCst);
                match request.answer(can_stop, Instant::now()) {
                    Answer::Stop => stop.store(true, Ordering::SeqCst),
                    Answer::Wait => {}
                    Answer::End { told } => {
                        if !told {
                            output::report(&FailureReport::new("stopped", Kind::Stopped.alone()), json);
                        }
                        let _none = remove_temporaries();
                        // Without handlers at exit, which would close files that others are writing.
                        low_level::exit(Kind::Stopped.exit_code().into());
                    }
                }
            }
        })?;
        Ok(ours)
    }

    /// The flag that stops a run.
    pub fn stop(&self) -> Arc<AtomicBool> {
        self.stop.clone()
    }

    /// The stop of SLEPc.
    pub fn slepc(&self) -> &Stop {
        &self.slepc
    }

    /// Hears how far a run is.
    pub fn heard(&self, progress: RunProgress) {
        match progress {
            RunProgress::Motion(0.0) => self.in_motion.store(true, Ordering::SeqCst),
            RunProgress::Motion(1.0) => self.in_motion.store(false, Ordering::SeqCst),
            _ => {}
        }
    }
}

/// True if a signal was ignored when the program began.
fn is_ignored(signal: i32) -> bool {
    let mut action = MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: without a new action it only writes the one there is, of which all bits zero are a value, too.
    unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr());
        action.assume_init().sa_sigaction == libc::SIG_IGN
    }
}

/// The request to stop, of which several signals may tell.
#[derive(Default)]
struct Request {
    first: Option<Instant>,
}

/// Effect of a signal.
#[derive(Debug, PartialEq, Eq)]
enum Answer {
    /// The run is to stop at its next row, or SLEPc.
    Stop,
    /// Nothing more.
    Wait,
    /// The program ends at once.
    End {
        /// True if a signal before has already been answered: there is nothing to say that is not known.
        told: bool,
    },
}

impl Request {
    fn answer(&mut self, can_stop: bool, now: Instant) -> Answer {
        match self.first {
            None if can_stop => {
                self.first = Some(now);
                Answer::Stop
            }
            None => Answer::End { told: false },
            Some(first) if now.duration_since(first) < ONE_REQUEST => Answer::Wait,
            Some(_) => Answer::End { told: true },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_at_once_are_one_request_and_a_later_one_ends_the_program() {
        let start = Instant::now();
        let at = |milliseconds| start + Duration::from_millis(milliseconds);
        let mut request = Request::default();
        assert_eq!(request.answer(true, at(0)), Answer::Stop);
        for soon in [0, 3, 499] {
            assert_eq!(request.answer(true, at(soon)), Answer::Wait);
            // The run may have come to its end in the meantime.
            assert_eq!(request.answer(false, at(soon)), Answer::Wait);
        }
        assert_eq!(request.answer(true, at(500)), Answer::End { told: true });
    }

    #[test]
    fn before_the_motion_there_is_nothing_to_wait_for() {
        assert_eq!(Request::default().answer(false, Instant::now()), Answer::End { told: false });
    }
}
