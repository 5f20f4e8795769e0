//! Numbers of a TOML file as they are meant: lists of exactly so many, and nothing that is not finite.

use serde::{Deserialize, Deserializer, de::Error};

fn finite<E: Error>(x: f64) -> Result<f64, E> {
    if x.is_finite() { Ok(x) } else { Err(E::custom(format!("{x} is not finite, give a number"))) }
}

fn exactly<T, E: Error, const N: usize>(list: Vec<T>) -> Result<[T; N], E> {
    let count = list.len();
    list.try_into().map_err(|_| E::custom(format!("has {count} numbers, give exactly {N}")))
}

/// A finite number.
pub(super) fn number<'de, D: Deserializer<'de>>(d: D) -> Result<Option<f64>, D::Error> {
    finite(f64::deserialize(d)?).map(Some)
}

/// A number that f32 can hold.
pub(super) fn float<'de, D: Deserializer<'de>>(d: D) -> Result<Option<f32>, D::Error> {
    let x = finite(f64::deserialize(d)?)? as f32;
    if x.is_finite() { Ok(Some(x)) } else { Err(D::Error::custom("overflows f32, give less")) }
}

/// Three finite numbers.
pub(super) fn vector<'de, D: Deserializer<'de>>(d: D) -> Result<Option<[f64; 3]>, D::Error> {
    let list = Vec::<f64>::deserialize(d)?;
    list.iter().try_for_each(|&x| finite(x).map(drop))?;
    exactly(list).map(Some)
}

/// Two whole numbers.
pub(super) fn pair<'de, D: Deserializer<'de>>(d: D) -> Result<Option<[u32; 2]>, D::Error> {
    exactly(Vec::<u32>::deserialize(d)?).map(Some)
}

/// A whole number twice, or two whole numbers.
pub(super) fn size<'de, D: Deserializer<'de>>(d: D) -> Result<Option<[u32; 2]>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged, expecting = "give a whole number of texels, or [width, height]")]
    enum Size {
        Square(u32),
        Sides(Vec<u32>),
    }
    match Size::deserialize(d)? {
        Size::Square(side) => Ok(Some([side; 2])),
        Size::Sides(sides) => exactly(sides).map(Some),
    }
}

#[cfg(test)]
mod tests {
    use crate::config::Settings;

    #[test]
    fn surplus_missing_and_infinite_numbers_name_their_line() {
        for (text, line, word) in [
            ("canvas = [16, 16, 99]", 1, "has 3 numbers, give exactly 2"),
            ("canvas = [16]", 1, "has 1 numbers, give exactly 2"),
            ("[light]\ndirection = [0, -1, 0, 5, 6]", 2, "has 5 numbers, give exactly 3"),
            ("[light]\n\nposition = [0, inf, 0]", 3, "inf is not finite"),
            ("[camera]\nup = [nan, 0, 0]", 2, "NaN is not finite"),
            ("[camera]\nfovy = inf", 2, "inf is not finite"),
            ("[light]\nwidth = -nan", 2, "NaN is not finite"),
            ("[lookup]\nbias = 1e39", 2, "overflows f32"),
            ("[map]\nsize = -4", 2, "whole number"),
            ("[map]\nsize = [1, 2, 3]", 2, "has 3 numbers, give exactly 2"),
        ] {
            let complaint = Settings::parse("s.toml", text).expect_err(text).to_string();
            let place = format!("s.toml: line {line}: ");
            assert!(complaint.starts_with(&place) && complaint.contains(word), "{complaint}");
        }
    }
}
