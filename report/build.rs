//! Packs the drawing library where the program is to hold it packed (feature `packed`).

#[cfg(feature = "packed")]
#[path = "src/page/packing.rs"]
mod packing;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/page/packing.rs");
    #[cfg(feature = "packed")]
    {
        let file = std::path::Path::new(&std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR")).join("plotly.js.gz");
        std::fs::write(file, packing::packed_library()).expect("the folder of the build can be written");
    }
}
