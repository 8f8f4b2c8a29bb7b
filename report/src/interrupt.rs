//! Ctrl-C must not leave half a result behind. The default action of a signal ends the process without running
//! destructors, so the folders being staged are listed here and removed by the handler.
//!
//! A command that can end early on purpose (the real-time loop) holds a [`Graceful`]: the first signal then only asks, and
//! the command finishes, reports what it has and commits; a second one ends it. The exit status of an interrupted command is
//! 128 and the number of the signal, as shells report it.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicI32, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, Once};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

static STAGED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
static HANDLER: Once = Once::new();
static GRACEFUL: AtomicUsize = AtomicUsize::new(0);
/// The signal that asked a [`Graceful`] command to end; 0 is none.
static REQUESTED: AtomicI32 = AtomicI32::new(0);

/// What is added to the number of a signal.
const SIGNALLED: i32 = 128;

/// Handles SIGINT, SIGTERM and SIGHUP from now on, once. Called by [`crate::OutputDirectory::stage`] and
/// [`Graceful::begin`]; `main` need not.
pub fn install() {
    HANDLER.call_once(|| {
        // Fails only where no thread can be had; the signals then end the process as they do by default.
        let Ok(mut signals) = Signals::new([SIGINT, SIGTERM, SIGHUP]) else {
            return;
        };
        let _ = std::thread::Builder::new()
            .name("signals".into())
            .spawn(move || signals.forever().for_each(on_signal));
    });
}

fn on_signal(signal: i32) {
    let first = REQUESTED
        .compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst)
        .is_ok();
    if first && GRACEFUL.load(Ordering::SeqCst) > 0 {
        return;
    }
    // Waits for a commit in progress: files are renamed all or none.
    for folder in staged().drain(..) {
        let _ = std::fs::remove_dir_all(folder);
    }
    std::process::exit(SIGNALLED + signal);
}

/// A folder that is removed too if a signal ends the process. Its owner removes it otherwise.
pub fn removes(folder: &Path) {
    install();
    staged().push(folder.to_path_buf());
}

/// The exit status of a command that was asked to end and did: 128 and the number of the signal.
pub fn status() -> Option<u8> {
    let signal = REQUESTED.load(Ordering::SeqCst);
    (signal != 0).then(|| u8::try_from(SIGNALLED + signal).unwrap_or(u8::MAX))
}

/// The folders to remove, behind a lock that a commit holds while it renames.
pub(crate) fn staged() -> MutexGuard<'static, Vec<PathBuf>> {
    STAGED.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

pub(crate) fn forget(folders: &mut Vec<PathBuf>, folder: &Path) {
    folders.retain(|other| other != folder);
}

/// While one lives, the first Ctrl-C (or SIGTERM, SIGHUP) only sets [`Graceful::requested`].
#[derive(Debug)]
pub struct Graceful(());

impl Graceful {
    /// Takes over the first signal until dropped.
    pub fn begin() -> Self {
        install();
        GRACEFUL.fetch_add(1, Ordering::SeqCst);
        Self(())
    }

    /// Whether the user asked to stop. The call is cheap enough for every tick.
    pub fn requested(&self) -> bool {
        REQUESTED.load(Ordering::Relaxed) != 0
    }
}

impl Drop for Graceful {
    fn drop(&mut self) {
        GRACEFUL.fetch_sub(1, Ordering::SeqCst);
    }
}
