//! Memory that is left, from Linux's own accounts.

use std::fmt;
use std::fs::read_to_string;
use std::path::{Path, PathBuf};

use crate::Bytes;

/// The memory that is left, and who says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Left {
    /// Bytes of the machine: free, or free for the asking, with the swap that there is.
    Machine(usize),
    /// Bytes of the control group that the process is in, such as a container or a job of a batch system.
    Group(usize),
    /// The address space that the process may have (`ulimit -v`).
    AddressSpace {
        /// The limit, bytes.
        limit: usize,
        /// Bytes of it that are taken.
        taken: usize,
    },
    /// The allocator refused, and nobody says why.
    Unknown,
}

impl Left {
    /// The less of what the machine and the control group have.
    pub fn of_machine() -> Option<Self> {
        let machine = read_to_string("/proc/meminfo").ok().and_then(|text| available(&text)).map(Self::Machine);
        [machine, of_group().map(Self::Group)].into_iter().flatten().min_by_key(|left| left.bytes())
    }

    /// The rest of the address space.
    pub(crate) fn of_process() -> Self {
        let limit = read_to_string("/proc/self/limits").ok().and_then(|text| address_space(&text));
        let taken = read_to_string("/proc/self/status").ok().and_then(|text| kilobytes(&text, "VmSize:"));
        match (limit, taken) {
            (Some(limit), Some(taken)) => Self::AddressSpace { limit, taken },
            _ => Self::Unknown,
        }
    }

    /// Bytes, where they are known.
    pub fn bytes(&self) -> Option<usize> {
        match *self {
            Self::Machine(bytes) | Self::Group(bytes) => Some(bytes),
            Self::AddressSpace { limit, taken } => Some(limit.saturating_sub(taken)),
            Self::Unknown => None,
        }
    }
}

impl fmt::Display for Left {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Machine(bytes) => write!(f, "{} left on this machine", Bytes(bytes)),
            Self::Group(bytes) => write!(f, "{} left in the control group of this process", Bytes(bytes)),
            Self::AddressSpace { limit, taken } => {
                let left = Bytes(limit.saturating_sub(taken));
                write!(f, "{left} left of the {} of address space that this process may have (ulimit -v)", Bytes(limit))
            }
            Self::Unknown => write!(f, "more than is left"),
        }
    }
}

/// The number after a key, of lines such as "VmSize:  1234 kB", in bytes.
fn kilobytes(text: &str, key: &str) -> Option<usize> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse::<usize>().ok()?.checked_mul(1024)
}

/// From /proc/meminfo.
fn available(text: &str) -> Option<usize> {
    Some(kilobytes(text, "MemAvailable:")?.saturating_add(kilobytes(text, "SwapFree:").unwrap_or(0)))
}

/// The soft limit, from /proc/self/limits.
fn address_space(text: &str) -> Option<usize> {
    text.lines().find_map(|line| line.strip_prefix("Max address space"))?.split_whitespace().next()?.parse().ok()
}

/// The least that is left in the control group and those that it is in. Version 2, and version 1's memory controller.
fn of_group() -> Option<usize> {
    let groups = read_to_string("/proc/self/cgroup").ok()?;
    let left = |line: &str| {
        let (controllers, path) = line.split_once(':')?.1.split_once(':')?;
        let (root, limit, used) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max", "memory.current"),
            "memory" => ("/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes"),
            _ => return None,
        };
        let folder: PathBuf = Path::new(root).join(path.trim_start_matches('/'));
        let number = |file: PathBuf| read_to_string(file).ok()?.trim().parse::<usize>().ok();
        folder
            .ancestors()
            .take_while(|folder| folder.starts_with(root))
            .filter_map(|folder| {
                // Files that are only cached are given up when memory is wanted.
                let cached = read_to_string(folder.join("memory.stat")).ok().and_then(|text| inactive_files(&text));
                let used = number(folder.join(used))?.saturating_sub(cached.unwrap_or(0));
                Some(number(folder.join(limit))?.saturating_sub(used))
            })
            .min()
    };
    groups.lines().filter_map(left).min()
}

/// From a memory.stat.
fn inactive_files(text: &str) -> Option<usize> {
    let line = |key: &str| text.lines().find_map(|line| line.strip_prefix(key)?.trim().parse().ok());
    line("total_inactive_file ").or_else(|| line("inactive_file "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accounts_are_read() {
        let meminfo = "MemTotal:  24000 kB\nMemFree:  1000 kB\nMemAvailable:  2000 kB\nSwapFree:  500 kB\n";
        assert_eq!(available(meminfo), Some(2500 * 1024));
        assert_eq!(available("MemTotal: 1 kB"), None);
        let limits = "Limit Soft Limit Hard Limit Units\nMax address space  512000000  unlimited  bytes\n";
        assert_eq!(address_space(limits), Some(512_000_000));
        assert_eq!(address_space("Max address space  unlimited  unlimited  bytes\n"), None);
        assert_eq!(inactive_files("anon 5\ninactive_file 70\n"), Some(70));
        assert_eq!(inactive_files("inactive_file 70\ntotal_inactive_file 90\n"), Some(90));
    }

    #[test]
    fn words_say_who_has_set_the_limit() {
        let words = Left::AddressSpace { limit: 500_000_000, taken: 180_000_000 }.to_string();
        assert_eq!(words, "320 MB left of the 500 MB of address space that this process may have (ulimit -v)");
        assert!(Left::Machine(2_500_000_000).to_string().contains("2.5 GB left on this machine"));
    }
}
