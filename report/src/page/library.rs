//! The drawing library, which is in a page once.

use std::io::Write;
use std::sync::OnceLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use plotly::Plot;

/// plotly.js, packed with gzip, as the page's script unpacks it: a third of its 4.7 MB. Packed once a process.
pub(super) fn library() -> &'static str {
    static PACKED: OnceLock<String> = OnceLock::new();
    PACKED.get_or_init(|| {
        let mut gzip = GzEncoder::new(Vec::new(), Compression::new(6));
        // Writing to memory does not fail.
        let packed = gzip
            .write_all(drawing_library().as_bytes())
            .and_then(|()| gzip.finish());
        format!(
            "<script type=\"text/plain\" id=\"library\">{}</script>\n",
            STANDARD.encode(packed.unwrap_or_default())
        )
    })
}

/// The source of plotly.js. The crate gives it as a script element and appends MathJax, 2 MB that nothing here needs.
pub(super) fn drawing_library() -> String {
    let scripts = Plot::offline_js_sources();
    let source = scripts.split_once("</script>").map_or("", |(first, _)| first);
    source.split_once('>').map_or("", |(_, source)| source).to_owned()
}
