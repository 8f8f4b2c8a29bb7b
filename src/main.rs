//! The `oleo` command line.
fn main() {}
