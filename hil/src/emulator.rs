//! A firmware image on an emulated board: QEMU's `netduinoplus2`, which has the STM32F405 of the vehicle's board but no CAN
//! controller. The image (built with the feature `slcan`) speaks CAN as text over its first USART, which is connected to this process
//! by a pair of sockets.
//!
//! The emulator ends with the value that stands for it, in every case; if this process is killed, the kernel ends the emulator
//! (`setpriv --pdeathsig`, where that program exists).

use std::io::Read;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::bus::{Bus, BusError, SerialLine};
use crate::sync::is_sync;

const EMULATOR: &str = "qemu-system-arm";
/// Longest time from the start of the emulator to the image's first frame.
const PATIENCE: Duration = Duration::from_secs(30);

/// Why no image runs.
#[derive(Debug, thiserror::Error)]
pub enum EmulatorError {
    /// The emulator is not installed.
    #[error("--firmware needs {EMULATOR}, which is not on the PATH: install the package qemu-system-arm")]
    NoEmulator,
    /// The file is no image for the board.
    #[error("{path}: {reason}; give the ELF file of `cargo build --release --features slcan` in firmware/")]
    Image {
        /// Path of the image, as given.
        path: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The emulator could not be started.
    #[error("{EMULATOR} cannot be started: {0}")]
    Start(std::io::Error),
    /// The image does not speak.
    #[error("{path}: the image sends nothing within {} s ({said}); it must be built with --features slcan", PATIENCE.as_secs())]
    Silent {
        /// Path of the image, as given.
        path: String,
        /// What the emulator said, in one line.
        said: String,
    },
    /// The line to the emulator failed.
    #[error(transparent)]
    Bus(#[from] BusError),
}

/// A board that runs an image.
#[derive(Debug)]
pub struct Emulator {
    child: Child,
    bus: SerialLine,
}

impl Emulator {
    /// Starts the image of a file, and waits until it speaks.
    ///
    /// # Errors
    /// There is no emulator, the file is no image, or the image does not speak.
    pub fn start(image: &Path) -> Result<Self, EmulatorError> {
        let path = image.display().to_string();
        check(image).map_err(|reason| EmulatorError::Image {
            path: path.clone(),
            reason,
        })?;
        let emulator = program(EMULATOR).ok_or(EmulatorError::NoEmulator)?;
        let (ours, theirs) = UnixStream::pair().map_err(EmulatorError::Start)?;
        ours.set_nonblocking(true).map_err(EmulatorError::Start)?;
        let mut command = match program("setpriv") {
            Some(setpriv) => {
                let mut command = Command::new(setpriv);
                command.args(["--pdeathsig", "KILL"]).arg(emulator);
                command
            }
            None => Command::new(emulator),
        };
        command
            .args(["-machine", "netduinoplus2", "-display", "none", "-monitor", "none"])
            // The socket is the standard input of the emulator.
            .args(["-chardev", "socket,id=can,fd=0", "-serial", "chardev:can", "-kernel"])
            .arg(image)
            .stdin(Stdio::from(std::os::fd::OwnedFd::from(theirs)))
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let child = command.spawn().map_err(EmulatorError::Start)?;
        // The command keeps the other end of the line open.
        drop(command);
        let mut started = Self {
            child,
            bus: SerialLine::over(ours.into(), format!("the emulated board of {path}")),
        };
        if !started.has_spoken()? {
            let said = started.last_words();
            return Err(EmulatorError::Silent { path, said });
        }
        Ok(started)
    }

    /// The board's bus.
    pub fn bus(&mut self) -> &mut SerialLine {
        &mut self.bus
    }

    /// Waits for the frame by which the image says that it is ready.
    fn has_spoken(&mut self) -> Result<bool, EmulatorError> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.bus.receive(left) {
                Ok(Some(frame)) if is_sync(&frame) => return Ok(true),
                Ok(Some(_)) => {}
                Ok(None) | Err(BusError::Closed { .. }) => return Ok(false),
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Ends the emulator; returns the first line that it has written.
    fn last_words(&mut self) -> String {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let mut said = String::new();
        if let Some(mut errors) = self.child.stderr.take() {
            let _ = errors.read_to_string(&mut said);
        }
        said.lines().next().unwrap_or("the emulator says nothing").to_owned()
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Whether a file is an executable for a 32-bit Arm processor.
fn check(image: &Path) -> Result<(), String> {
    let mut head = [0_u8; 20];
    let mut file = std::fs::File::open(image).map_err(|error| format!("cannot be read: {error}"))?;
    file.read_exact(&mut head)
        .map_err(|_| "is too short for an image".to_owned())?;
    // ELF, 32 bit, little-endian; EM_ARM.
    match (&head[..6], &head[18..]) {
        (b"\x7fELF\x01\x01", [40, 0]) => Ok(()),
        _ => Err("is no ELF file for an Arm processor".to_owned()),
    }
}

/// A program on the PATH.
fn program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path)
        .map(|folder| folder.join(name))
        .find(|file| file.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_image_is_refused_in_one_line() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            path
        };
        for (path, expected) in [
            (folder.path().join("absent"), "cannot be read"),
            (file("short", b"\x7fELF"), "too short"),
            (file("text", &[b'x'; 100]), "no ELF file for an Arm"),
            (std::env::current_exe().unwrap(), "no ELF file for an Arm"),
        ] {
            let text = Emulator::start(&path).unwrap_err().to_string();
            assert!(text.contains(expected) && text.lines().count() == 1, "{text}");
        }
    }
}
