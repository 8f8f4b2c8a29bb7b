//! Puts this board's memory map where the linker script of cortex-m-rt finds it, as `memory.x`. (The file has another
//! name, because the linker looks in the workspace's folder first.)

use std::{env, fs, path::PathBuf};

fn main() {
    let folder = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::write(folder.join("memory.x"), include_bytes!("stm32f405.x")).expect("OUT_DIR is writable");
    println!("cargo:rustc-link-search={}", folder.display());
    println!("cargo:rerun-if-changed=stm32f405.x");
}
