//! Packs the drawing library. A part of the build script too, where the program holds it packed.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use plotly::Plot;

/// plotly.js, packed with gzip, as the page's script unpacks it: a third of its 4.7 MB.
pub fn packed_library() -> Vec<u8> {
    let mut gzip = GzEncoder::new(Vec::new(), Compression::new(6));
    // Writing to memory does not fail.
    let packed = gzip
        .write_all(drawing_library().as_bytes())
        .and_then(|()| gzip.finish());
    packed.unwrap_or_default()
}

/// The source of plotly.js. The crate gives it as a script element and appends MathJax, 2 MB that nothing here needs.
pub fn drawing_library() -> String {
    let scripts = Plot::offline_js_sources();
    let source = scripts.split_once("</script>").map_or("", |(first, _)| first);
    source.split_once('>').map_or("", |(_, source)| source).to_owned()
}
