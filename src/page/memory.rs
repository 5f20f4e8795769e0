//! The memory budget: what a run may take, and the one sentence where its input needs more.

use gnomon_core::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::OnceLock;

/// The budget where nothing less is allowed: 8 GiB.
const MOST: u64 = 8 << 30;

static BUDGET: OnceLock<u64> = OnceLock::new();

/// An amount of memory in bytes; as text a number with an optional unit: `512MiB`, `4G`, `1.5GiB`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Size(pub u64);

impl FromStr for Size {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let bad = |reason: &str| {
            Error::bad_input(format!("'{text}'"), reason, "give an amount such as 512MiB or 4GiB")
        };
        let digits = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
        let (number, unit) = text.split_at(digits);
        let number: f64 = number.parse().map_err(|_| bad("is no amount of memory"))?;
        let unit = match unit.trim().to_ascii_lowercase().as_str() {
            "" | "b" => 0,
            "k" | "kb" | "kib" => 10,
            "m" | "mb" | "mib" => 20,
            "g" | "gb" | "gib" => 30,
            "t" | "tb" | "tib" => 40,
            _ => return Err(bad("has no unit known here")),
        };
        let bytes = number * (1u64 << unit) as f64;
        let fits = (1.0..9e18).contains(&bytes);
        if fits { Ok(Self(bytes as u64)) } else { Err(bad("is no amount that can be kept to")) }
    }
}

impl std::fmt::Display for Size {
    /// In GiB or MiB, rounded up, so that what is needed is never said too small.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let tenths = |unit: u64| (u128::from(self.0) * 10).div_ceil(u128::from(unit)) as f64 / 10.0;
        match self.0 {
            0..=1023 => write!(f, "{} bytes", self.0),
            1024..0x10_0000 => write!(f, "{:.1} KiB", tenths(1 << 10)),
            0x10_0000..0x4000_0000 => write!(f, "{:.1} MiB", tenths(1 << 20)),
            _ => write!(f, "{:.1} GiB", tenths(1 << 30)),
        }
    }
}

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
/// [`Error::BadInput`] with the need, the budget and the knob.
pub fn check(place: &str, need: u64, knob: &str) -> Result<()> {
    let budget = budget();
    if need <= budget {
        return Ok(());
    }
    let reason = format!("needs {}, the budget is {}", Size(need), Size(budget));
    Err(Error::bad_input(place, reason, format!("{knob}, or raise --max-memory")))
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
    fn amounts_are_read_with_their_units() {
        let bytes = |text: &str| text.parse::<Size>().map(|s| s.0);
        for (text, expected) in [
            ("4096", 4096),
            ("1k", 1024),
            ("512MiB", 512 << 20),
            ("1.5 GiB", 3 << 29),
            ("8G", MOST),
        ] {
            assert_eq!(bytes(text).expect(text), expected, "{text}");
        }
        for text in ["", "G", "-1", "0", "1.2.3G", "4 apples", "99999999999T", "nan"] {
            let error = bytes(text).expect_err(text);
            assert!(error.to_string().contains("512MiB") && error.exit_code() == 2, "{error}");
        }
        assert_eq!(
            (Size(3 << 29).to_string(), Size(1 << 20).to_string()),
            ("1.5 GiB".into(), "1.0 MiB".into())
        );
        assert_eq!(Size((3 << 29) + 1).to_string(), "1.6 GiB", "never said too small");
    }

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
