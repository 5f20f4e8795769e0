//! Amounts of memory: as text, and the one sentence where something needs more than there is.

use crate::{Error, Result};
use std::str::FromStr;

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

impl Size {
    /// Refuses a need beyond this budget; `knob` says what makes it less.
    ///
    /// # Errors
    /// [`Error::BadInput`] with the need, the budget and the knob.
    pub fn afford(self, place: &str, need: Self, knob: &str) -> Result<()> {
        if need <= self {
            return Ok(());
        }
        let reason = format!("needs {need}, the budget is {self}");
        Err(Error::bad_input(place, reason, format!("{knob}, or raise --max-memory")))
    }
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
            ("8G", 8 << 30),
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
}
