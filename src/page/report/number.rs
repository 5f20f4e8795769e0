//! Number text: shortest round-trip for files, a few significant digits for people.

/// The shortest decimal that reads back to the same `f64`; `NaN`, `inf`, `-inf`; `.` in every
/// locale. Scientific below 10⁻⁵ and from 10¹⁶ on.
#[must_use]
pub fn shortest(value: f64) -> String {
    let size = value.abs();
    if value.is_finite() && size != 0.0 && !(1e-5..1e16).contains(&size) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// `value` to `digits` significant digits in plain text: `0.00345`, `1.96e-7`, `123457`.
///
/// Rounded from the exact decimal expansion, half to even; trailing zeros go; an integer part is
/// never rounded to fewer digits than it has, up to six.
#[must_use]
pub fn significant(value: f64, digits: u8) -> String {
    match Decimal::new(value, digits) {
        // Of -0 people see 0.
        None => shortest(value + 0.0),
        Some(decimal) if decimal.is_positional() => decimal.positional(),
        Some(decimal) => format!("{}e{}", decimal.mantissa(), decimal.exponent),
    }
}

/// As [`significant`], with powers of ten as people write them: `1.96×10⁻⁷`.
#[must_use]
pub fn pretty(value: f64, digits: u8) -> String {
    match Decimal::new(value, digits) {
        Some(decimal) if !decimal.is_positional() => {
            format!("{}×10{}", decimal.mantissa(), superscript(decimal.exponent))
        }
        _ => significant(value, digits),
    }
    .replace('-', "−")
    .replace("inf", "∞")
}

/// A fraction as per cent: `percent(0.1234, 3)` is `12.3 %`.
#[must_use]
pub fn percent(fraction: f64, digits: u8) -> String {
    format!("{}\u{a0}%", significant(fraction * 100.0, digits))
}

/// An integer in groups of three, parted by a narrow no-break space from five digits on.
#[must_use]
pub fn grouped(value: i64) -> String {
    let text = value.unsigned_abs().to_string();
    let sign = if value < 0 { "−" } else { "" };
    if text.len() < 5 {
        return format!("{sign}{text}");
    }
    let groups: Vec<_> = text.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy).collect();
    format!("{sign}{}", groups.join("\u{202f}"))
}

/// An integer in superscript characters: `⁻⁶`.
#[must_use]
pub fn superscript(value: i32) -> String {
    let raise = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
    };
    value.to_string().chars().map(raise).collect()
}

/// A rounded decimal: sign, significant digits without trailing zeros, exponent of the first.
struct Decimal {
    negative: bool,
    digits: String,
    exponent: i32,
}

impl Decimal {
    /// `None` where there is nothing to lay out: zero, infinities, NaN.
    fn new(value: f64, digits: u8) -> Option<Self> {
        if value == 0.0 || !value.is_finite() {
            return None;
        }
        // Integer parts up to six digits stay whole.
        let whole = if value.abs() < 999_999.5 { format!("{:.0}", value.abs()).len() } else { 0 };
        let kept = whole.max(usize::from(digits.max(1)));
        let text = format!("{:.*e}", kept - 1, value.abs());
        let (mantissa, exponent) = text.split_once('e')?;
        let digits = mantissa.replace('.', "").trim_end_matches('0').to_string();
        Some(Self { negative: value < 0.0, digits, exponent: exponent.parse().ok()? })
    }

    fn is_positional(&self) -> bool {
        (-4..6).contains(&self.exponent)
    }

    fn sign(&self) -> &'static str {
        if self.negative { "-" } else { "" }
    }

    fn mantissa(&self) -> String {
        let (first, rest) = self.digits.split_at(1);
        let point = if rest.is_empty() { "" } else { "." };
        format!("{}{first}{point}{rest}", self.sign())
    }

    fn positional(&self) -> String {
        if self.exponent < 0 {
            let zeros = "0".repeat(self.exponent.unsigned_abs() as usize - 1);
            return format!("{}0.{zeros}{}", self.sign(), self.digits);
        }
        let whole = self.exponent.unsigned_abs() as usize + 1;
        let padded = format!("{:0<whole$}", self.digits);
        let (integer, fraction) = padded.split_at(whole);
        let point = if fraction.is_empty() { "" } else { "." };
        format!("{}{integer}{point}{fraction}", self.sign())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_for_people() {
        let cases = [
            (0.00345, 3, "0.00345"),
            (0.001_968_6, 2, "0.002"),
            (1.2345e-7, 3, "1.23e-7"),
            (123_456.7, 3, "123457"),
            (1_234_567.0, 3, "1.23e6"),
            (999_999.9, 3, "1e6"),
            (-0.5, 3, "-0.5"),
            (100.0, 3, "100"),
            (9.999, 3, "10"),
            (0.0, 3, "0"),
            (-0.0, 3, "0"),
            (f64::INFINITY, 3, "inf"),
            (f64::NAN, 3, "NaN"),
        ];
        for (value, digits, text) in cases {
            assert_eq!(significant(value, digits), text, "{value:e} to {digits} digits");
        }
        assert_eq!(pretty(-1.9686e-7, 3), "−1.97×10⁻⁷");
        assert_eq!(pretty(-0.5, 3), "−0.5");
        assert_eq!(percent(0.1234, 3), "12.3\u{a0}%");
        assert_eq!(grouped(-1_234_567), "−1\u{202f}234\u{202f}567");
        assert_eq!(superscript(-1203), "⁻¹²⁰³");
    }

    #[test]
    fn shortest_text_reads_back() {
        for bits in (0..u64::MAX).step_by(0x0000_4321_8765_4321) {
            let value = f64::from_bits(bits);
            let read: f64 = shortest(value).parse().unwrap();
            assert!(read.to_bits() == bits || value.is_nan(), "{value:e} read back as {read:e}");
        }
    }
}
