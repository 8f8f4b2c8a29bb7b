//! The process that loads the library of an FMU. It reads an opening and runs from its standard input, and answers each on what was its standard output.

use std::fs::{File, OpenOptions};
use std::io::BufReader;
use std::os::fd::AsFd;
use std::os::unix::fs::FileExt;
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, channel};

use nix::sys::resource::{Resource, setrlimit};
use nix::unistd::dup2_stdout;

use crate::message::{Answer, Opening, Run, read, write};
use crate::simulation::simulate;
use crate::slave::{instantiate, load};

/// Status of a child whose parent says nothing that it understands.
const MISUNDERSTOOD: u8 = 2;

/// Runs the child until its parent closes the pipe. What the FMU prints goes to standard error.
#[must_use]
pub fn serve() -> ExitCode {
    match answer_all() {
        Ok(()) => ExitCode::SUCCESS,
        Err(_) => ExitCode::from(MISUNDERSTOOD),
    }
}

fn answer_all() -> std::io::Result<()> {
    let mut requests = BufReader::new(File::from(std::io::stdin().as_fd().try_clone_to_owned()?));
    let mut answers = File::from(std::io::stdout().as_fd().try_clone_to_owned()?);
    // From here on a print of the FMU cannot end up between two answers.
    dup2_stdout(std::io::stderr())?;
    let opening: Opening = read(&mut requests)?;
    limit(opening.memory)?;
    let clock = OpenOptions::new().write(true).open(&opening.clock)?;
    let library = match load(&opening.library) {
        Ok(library) => library,
        Err(what) => return write(&mut answers, &Answer::Refused(what)),
    };
    write(&mut answers, &Answer::Opened)?;
    let runs = runs(requests)?;
    while let Ok(run) = runs.recv() {
        let mut slave = match instantiate(
            &library,
            opening.version,
            &opening.name,
            &opening.token,
            &opening.resources,
        ) {
            Ok(slave) => slave,
            Err(what) => {
                write(&mut answers, &Answer::Refused(what))?;
                continue;
            }
        };
        let answer = simulate(&mut *slave, &run, &mut |time_s| {
            // Without a clock the line about a fall lacks a time, and nothing else.
            let _ = clock.write_all_at(&time_s.to_le_bytes(), 0);
        });
        match answer {
            Ok(outputs) => {
                drop(slave);
                write(&mut answers, &Answer::Outputs(outputs))?;
            }
            Err(what) => {
                // After a fatal error not even its end may be asked for; the parent takes another child.
                std::mem::forget(slave);
                write(&mut answers, &Answer::Refused(what))?;
            }
        }
    }
    Ok(())
}

/// The runs as they come, read beside the simulation: a child whose parent is gone ends at once, even in a step that does not.
fn runs(mut requests: BufReader<File>) -> std::io::Result<Receiver<Run>> {
    let (send, receive) = channel();
    std::thread::Builder::new().name("requests".into()).spawn(move || {
        while let Ok(run) = read::<Run>(&mut requests) {
            if send.send(run).is_err() {
                break;
            }
        }
        leave();
    })?;
    Ok(receive)
}

/// Ends the process without the destructors of the library, which may be in the middle of a step.
fn leave() -> ! {
    #[allow(
        unsafe_code,
        reason = "the only end of a process that runs nothing of a foreign library"
    )]
    // SAFETY: it does not return and reads nothing.
    unsafe {
        nix::libc::_exit(0)
    }
}

/// No memory without end, and no image of it on the disk when it falls.
fn limit(memory: u64) -> std::io::Result<()> {
    setrlimit(Resource::RLIMIT_CORE, 0, 0)?;
    #[cfg(target_os = "linux")]
    setrlimit(Resource::RLIMIT_AS, memory, memory)?;
    #[cfg(not(target_os = "linux"))]
    let _ = memory;
    Ok(())
}
