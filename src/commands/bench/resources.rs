//! What this process has used so far.

use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeValLike;

use crate::failure::Failure;

/// Processor time of all threads, of the program and of the system on its behalf, s. Unlike the clock it leaves out the time in which other
/// processes had the processor.
pub fn processor_s() -> Result<f64, Failure> {
    let used = getrusage(UsageWho::RUSAGE_SELF)
        .map_err(|error| Failure::new(format!("processor time: the system does not tell it: {error}")))?;
    Ok(1e-6 * (used.user_time() + used.system_time()).num_microseconds() as f64)
}

/// Largest resident memory since the program was started, bytes. Not that of `getrusage`, which is inherited from the process that started
/// this one.
pub fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}

/// Number of processors that this process may use.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Name of the processor, if the system tells it.
pub fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_used_only_grows() {
        let before = processor_s().expect("a time");
        let kept = std::hint::black_box(vec![1_u8; 40_000_000]);
        assert!(processor_s().expect("a time") >= before);
        if let Some(peak) = peak_memory_bytes() {
            assert!(peak as usize >= kept.len(), "{peak}");
        }
        assert!(cores() >= 1);
    }
}
