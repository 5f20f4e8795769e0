//! The memory budget: what a run may take, and the one sentence where its input needs more.

use gnomon_core::Result;
pub use gnomon_core::size::Size;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The budget where nothing less is allowed: 8 GiB.
const MOST: u64 = 8 << 30;

static BUDGET: OnceLock<u64> = OnceLock::new();

/// Sets the budget of this process, once and before anything is read.
pub fn set(budget: Size) {
    let _ = BUDGET.set(budget.0);
}

/// Bytes that this process may take: what [`set`] says, else the lesser of 8 GiB and half of what its
/// control groups (both versions), the address-space limit and the machine allow.
#[must_use]
pub fn budget() -> u64 {
    *BUDGET.get_or_init(|| allowed().map_or(MOST, |most| MOST.min(most / 2)))
}

/// Refuses a need beyond the budget; `knob` says what makes it less.
///
/// # Errors
/// [`gnomon_core::Error::BadInput`] with the need, the budget and the knob.
pub fn check(place: &str, need: u64, knob: &str) -> Result<()> {
    Size(budget()).afford(place, Size(need), knob)
}

/// The least of all limits that the system states, if it states one.
fn allowed() -> Option<u64> {
    let read = |path: &Path| fs::read_to_string(path).ok();
    let own = read(Path::new("/proc/self/cgroup")).unwrap_or_default();
    let groups = group_files(&own).into_iter().filter_map(|path| read(&path)?.trim().parse().ok());
    let limits = read(Path::new("/proc/self/limits")).and_then(|text| address_space(&text));
    let machine = read(Path::new("/proc/meminfo")).and_then(|text| total(&text));
    groups.chain(limits).chain(machine).min()
}

/// The files that may state a limit: of the own groups and of every group around them.
fn group_files(own: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for line in own.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(group)) = (parts.next(), parts.next()) else { continue };
        let (root, name) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            list if list.split(',').any(|c| c == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => continue,
        };
        let group = Path::new(group.trim_start_matches('/'));
        files.extend(group.ancestors().map(|group| Path::new(root).join(group).join(name)));
    }
    files
}

/// `Max address space  512000000  unlimited  bytes`: the soft limit.
fn address_space(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// `MemTotal:  8000000 kB`, in bytes.
fn total(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_found_in_the_words_of_the_system() {
        let files = group_files("0::/a/b\n3:cpu:/x\n2:cpuset,memory:/m\nbroken");
        let expected = [
            "/sys/fs/cgroup/a/b/memory.max",
            "/sys/fs/cgroup/a/memory.max",
            "/sys/fs/cgroup/memory.max",
            "/sys/fs/cgroup/memory/m/memory.limit_in_bytes",
            "/sys/fs/cgroup/memory/memory.limit_in_bytes",
        ];
        assert_eq!(files, expected.map(PathBuf::from));
        let limits = "Limit  Soft\nMax address space         512000000    unlimited    bytes\n";
        assert_eq!(address_space(limits), Some(512_000_000));
        assert_eq!(address_space("Max address space  unlimited  unlimited  bytes"), None);
        assert_eq!(total("MemFree: 1 kB\nMemTotal:        2048 kB\n"), Some(2 << 20));
    }

    #[test]
    fn a_need_beyond_the_budget_is_one_sentence_with_the_knob() {
        assert!(check("a.png", 1, "").is_ok());
        let error = check("--map 8192", u64::MAX / 2, "lower --map").unwrap_err();
        let text = error.to_string();
        assert!(text.contains("needs") && text.contains("the budget is"), "{text}");
        assert!(text.ends_with("lower --map, or raise --max-memory"), "{text}");
        assert_eq!(error.exit_code(), 2);
    }
}
