//! One child, as the parent sees it.

use std::fs::File;
use std::io::{BufReader, Read};
use std::os::unix::fs::FileExt;
use std::os::unix::process::ExitStatusExt;
use std::path::PathBuf;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use serde::Serialize;

use crate::message::{Answer, Opening, read, write};

/// How many characters of what a child prints are shown: its last words.
const LAST_WORDS: usize = 200;

/// How a child ended that gave no answer.
#[derive(Debug, Clone, PartialEq)]
pub struct End {
    /// How, as a clause without a subject: "was ended by signal 6 (SIGABRT)".
    pub how: String,
    /// Time that the simulation had reached, s; `None` before it began.
    pub reached_s: Option<f64>,
    /// What to do about it.
    pub what_to_do: &'static str,
}

/// What to do about an FMU that falls: it is not for us to mend.
pub const ASK_ITS_TOOL: &str = "simulate it with these inputs in the tool that wrote it";

/// A child.
pub struct Worker {
    process: Child,
    requests: Option<ChildStdin>,
    answers: Receiver<std::io::Result<Answer>>,
    words: Option<JoinHandle<String>>,
    clock: PathBuf,
}

impl Worker {
    /// Starts a child and has it load the library.
    pub fn start(mut command: Command, opening: &Opening, limit: Duration) -> Result<Self, End> {
        let failed = |error: std::io::Error| End {
            how: format!("cannot be started in a process of its own: {error}"),
            reached_s: None,
            what_to_do: "close other programs, or make room in the folder of temporary files",
        };
        // Nothing is reached yet.
        std::fs::write(&opening.clock, f64::NAN.to_le_bytes()).map_err(failed)?;
        let mut process = (command.stdin(Stdio::piped()))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(failed)?;
        let (requests, answers, words) = (process.stdin.take(), process.stdout.take(), process.stderr.take());
        let mut worker = Self {
            process,
            requests,
            answers: listen(answers),
            words: words.map(|words| std::thread::spawn(|| last_words(words))),
            clock: opening.clock.clone(),
        };
        match worker.ask(opening, limit)? {
            Answer::Refused(how) => Err(End {
                how,
                reached_s: None,
                what_to_do: "install what it needs beside itself, or export it for this platform",
            }),
            _ => Ok(worker),
        }
    }

    /// Sends a request and waits for the answer.
    pub fn ask(&mut self, request: &impl Serialize, limit: Duration) -> Result<Answer, End> {
        // A child that has fallen does not listen; its end is told below.
        if let Some(requests) = &mut self.requests {
            let _ = write(requests, request);
        }
        match self.answers.recv_timeout(limit) {
            Ok(Ok(answer)) => Ok(answer),
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => Err(self.fallen()),
            Err(RecvTimeoutError::Timeout) => {
                let _ = self.process.kill();
                Err(End {
                    how: format!("did not finish within {} s and was ended", limit.as_secs_f64()),
                    reached_s: self.reached_s(),
                    what_to_do: "raise run.limit_s in the map if the FMU needs longer",
                })
            }
        }
    }

    fn fallen(&mut self) -> End {
        // Whatever it still does, it does not answer any more.
        self.requests = None;
        let how = self.process.wait().map_or_else(|error| error.to_string(), in_words);
        let words = self
            .words
            .take()
            .and_then(|words| words.join().ok())
            .unwrap_or_default();
        End {
            how: if words.is_empty() {
                how
            } else {
                format!("{how}, saying {words:?}")
            },
            reached_s: self.reached_s(),
            what_to_do: ASK_ITS_TOOL,
        }
    }

    fn reached_s(&self) -> Option<f64> {
        let mut bytes = [0; 8];
        File::open(&self.clock).ok()?.read_exact_at(&mut bytes, 0).ok()?;
        Some(f64::from_le_bytes(bytes)).filter(|time| time.is_finite())
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Answers as they come. A pipe cannot be read with a limit of time; a channel can.
fn listen(answers: Option<ChildStdout>) -> Receiver<std::io::Result<Answer>> {
    let (send, receive) = channel();
    std::thread::spawn(move || {
        let Some(answers) = answers else { return };
        let mut answers = BufReader::new(answers);
        loop {
            let answer = read(&mut answers);
            let last = answer.is_err();
            if send.send(answer).is_err() || last {
                return;
            }
        }
    });
    receive
}

/// The end of what a child prints, in one line.
fn last_words(mut words: ChildStderr) -> String {
    let (mut kept, mut piece) = (Vec::new(), [0; 1024]);
    while let Ok(count @ 1..) = words.read(&mut piece) {
        kept.extend_from_slice(&piece[..count]);
        // In bytes, of which a character has up to four.
        kept.drain(..kept.len().saturating_sub(4 * LAST_WORDS));
    }
    let text = String::from_utf8_lossy(&kept).into_owned();
    let line: Vec<char> = text.split_whitespace().collect::<Vec<_>>().join(" ").chars().collect();
    line[line.len().saturating_sub(LAST_WORDS)..].iter().collect()
}

fn in_words(status: ExitStatus) -> String {
    match (status.signal(), status.code()) {
        (Some(signal), _) => match nix::sys::signal::Signal::try_from(signal) {
            Ok(named) => format!("was ended by signal {signal} ({named})"),
            Err(_) => format!("was ended by signal {signal}"),
        },
        (None, code) => format!("ended its process with exit status {}", code.unwrap_or_default()),
    }
}
