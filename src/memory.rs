//! Memory: what is free, and what is in use.

use crate::error::{Error, Result};
use std::fs::read_to_string;

/// Bytes in words.
pub fn in_words(bytes: f64) -> String {
    match bytes {
        _ if bytes < 0.9995e6 => format!("{:.0} kB", bytes / 1e3),
        _ if bytes < 0.9995e9 => format!("{:.0} MB", bytes / 1e6),
        _ => format!("{:.1} GB", bytes / 1e9),
    }
}

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

/// Refuses what takes more memory than is free, before any of it is asked for: a request that the system cannot meet ends the
/// process.
///
/// # Arguments  `what` takes about so many `bytes`, an estimate from above
/// # Errors     `Error::Scene`
pub fn check(what: impl FnOnce() -> String, bytes: f64) -> Result<()> {
    match free() {
        Some(free) if bytes > free => Err(Error::Scene(format!(
            "{} takes about {} of memory; allowed: what is free, {}",
            what(),
            in_words(bytes),
            in_words(free.max(0.0))
        ))),
        Some(_) | None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_in_words() {
        assert_eq!([3.99e3, 2.84e7, 2.84e10].map(in_words), ["4 kB", "28 MB", "28.4 GB"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_told() {
        assert!(free().unwrap() > 1e6 && used().unwrap() > 1e6);
        assert_eq!(check(|| unreachable!(), 1e3), Ok(()));
        let told = check(|| "a thing".into(), 1e18).unwrap_err().to_string();
        let expected = "a thing takes about 1000000000.0 GB of memory; allowed: what is free, ";
        assert!(told.starts_with(expected), "{told}");
    }
}
