#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| oleo_fuzz::blf(bytes));
