//! The drawing library, which is in a page once.

use std::sync::OnceLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// The element that holds the library, made once a process.
pub(super) fn library() -> &'static str {
    static ELEMENT: OnceLock<String> = OnceLock::new();
    ELEMENT.get_or_init(|| {
        format!(
            "<script type=\"text/plain\" id=\"library\">{}</script>\n",
            STANDARD.encode(packed())
        )
    })
}

/// As the build script packed it.
#[cfg(feature = "packed")]
fn packed() -> &'static [u8] {
    include_bytes!(concat!(env!("OUT_DIR"), "/plotly.js.gz"))
}

#[cfg(not(feature = "packed"))]
fn packed() -> Vec<u8> {
    super::packing::packed_library()
}
