//! Ctrl-C must not leave half a result behind. The default action of the signal ends the process without running
//! destructors, so the folders being staged are listed here and removed by the handler.
//!
//! A command that can end early on purpose (the real-time loop) holds a [`Graceful`]: the first Ctrl-C then only asks, and
//! the command finishes, reports what it has and commits; a second one ends it.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, Once};

static STAGED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
static HANDLER: Once = Once::new();
static GRACEFUL: AtomicUsize = AtomicUsize::new(0);
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Exit status after Ctrl-C: 128 + SIGINT, as shells report it.
const INTERRUPTED: i32 = 130;

/// Installs the handler, once. Called by [`crate::OutputDirectory::stage`] and [`Graceful::begin`]; `main` need not.
pub fn install() {
    HANDLER.call_once(|| {
        // Fails only where the program has a handler of its own, whose business it then is.
        let _ = ctrlc::set_handler(on_signal);
    });
}

fn on_signal() {
    if GRACEFUL.load(Ordering::SeqCst) > 0 && !REQUESTED.swap(true, Ordering::SeqCst) {
        return;
    }
    // Waits for a commit in progress: files are renamed all or none.
    for folder in staged().drain(..) {
        let _ = std::fs::remove_dir_all(folder);
    }
    std::process::exit(INTERRUPTED);
}

/// The folders to remove, behind a lock that a commit holds while it renames.
pub(crate) fn staged() -> MutexGuard<'static, Vec<PathBuf>> {
    STAGED.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

pub(crate) fn forget(folders: &mut Vec<PathBuf>, folder: &Path) {
    folders.retain(|other| other != folder);
}

/// While one lives, the first Ctrl-C (or SIGTERM) only sets [`Graceful::requested`].
#[derive(Debug)]
pub struct Graceful(());

impl Graceful {
    /// Takes over the first Ctrl-C until dropped.
    pub fn begin() -> Self {
        install();
        GRACEFUL.fetch_add(1, Ordering::SeqCst);
        Self(())
    }

    /// Whether the user asked to stop. The call is cheap enough for every tick.
    pub fn requested(&self) -> bool {
        REQUESTED.load(Ordering::Relaxed)
    }
}

impl Drop for Graceful {
    fn drop(&mut self) {
        GRACEFUL.fetch_sub(1, Ordering::SeqCst);
    }
}
