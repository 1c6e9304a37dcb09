//! Memory: what is free, and what is in use.

use std::fs::read_to_string;

/// A number of kilobytes in a file of lines such as `MemAvailable:  123 kB`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<f64> {
    let line = text.lines().find(|line| line.starts_with(name))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|n| 1024.0 * n)
}

/// Memory that the process has in use \[bytes\], where the system tells.
pub fn used() -> Option<f64> {
    status("VmRSS:")
}

/// What the process says of itself \[bytes\], where the system tells.
fn status(name: &str) -> Option<f64> {
    kilobytes(&read_to_string("/proc/self/status").ok()?, name)
}

/// Memory that is free \[bytes\], where the system tells: of the machine, of the group that the process is in, and of its own
/// address space, the least.
pub fn free() -> Option<f64> {
    let machine = read_to_string("/proc/meminfo").ok().and_then(|text| kilobytes(&text, "MemAvailable:"));
    let number = |file: &str| read_to_string(file).ok()?.trim().parse::<f64>().ok();
    let group = |limit: &str, used: &str| Some(number(limit)? - number(used)?);
    let groups = [
        group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        group("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
    ];
    let space = read_to_string("/proc/self/limits").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("Max address space"))?;
        let limit = line.split_whitespace().nth(3)?.parse::<f64>().ok()?;
        Some(limit - status("VmSize:")?)
    });
    groups.into_iter().chain([machine, space]).flatten().reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_told() {
        assert!(free().unwrap() > 1e6 && used().unwrap() > 1e6);
    }
}
