//! The fields of a device profile by name: read, written and compared as text.

use super::{Device, NearestCoord, OffsetUnit, PlaneSetup, SlopeNorm};
use crate::depth::{DepthFormat, UnormLoad, UnormStore};

/// A value that a field can have, as text.
trait Value: Sized {
    fn read(text: &str) -> Option<Self>;
    fn choices() -> String;
}

/// Fewer than 1 bit is no grid; a GPU has 4 to 8, and 12 still leave room in the edge functions.
const SUBPIXEL_BITS: std::ops::RangeInclusive<u32> = 1..=12;

impl Value for u32 {
    fn read(text: &str) -> Option<Self> {
        text.parse().ok().filter(|bits| SUBPIXEL_BITS.contains(bits))
    }
    fn choices() -> String {
        format!("a whole number from {} to {}", SUBPIXEL_BITS.start(), SUBPIXEL_BITS.end())
    }
}

impl Value for bool {
    fn read(text: &str) -> Option<Self> {
        text.parse().ok()
    }
    fn choices() -> String {
        "true or false".to_string()
    }
}

macro_rules! catalogue_value {
    ($($Set:ty),+) => {
        $(impl Value for $Set {
            fn read(text: &str) -> Option<Self> {
                text.parse().ok()
            }
            fn choices() -> String {
                let names: Vec<_> = Self::ALL.iter().map(|member| member.name()).collect();
                format!("one of {}", names.join(", "))
            }
        })+
    };
}
catalogue_value!(
    PlaneSetup,
    UnormStore,
    UnormLoad,
    DepthFormat,
    NearestCoord,
    SlopeNorm,
    OffsetUnit
);

/// One field of [`Device`].
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Its name in files: that of the struct's field.
    pub name: &'static str,
    get: fn(&Device) -> String,
    set: fn(&mut Device, &str) -> bool,
    choices: fn() -> String,
}

impl Field {
    /// The field's value in a profile.
    #[must_use]
    pub fn get(&self, device: &Device) -> String {
        (self.get)(device)
    }

    /// Sets the field.
    ///
    /// # Errors
    /// What the field can be, where `text` is none of that; the profile is unchanged then.
    pub fn set(&self, device: &mut Device, text: &str) -> Result<(), String> {
        if (self.set)(device, text) { Ok(()) } else { Err((self.choices)()) }
    }
}

macro_rules! fields {
    ($($name:ident: $Value:ty),+ $(,)?) => {
        &[$(Field {
            name: stringify!($name),
            get: |device| device.$name.to_string(),
            set: |device, text| match <$Value as Value>::read(text) {
                Some(value) => {
                    device.$name = value;
                    true
                }
                None => false,
            },
            choices: <$Value as Value>::choices,
        }),+]
    };
}

/// Every field but the profile's own name.
pub const FIELDS: &[Field] = fields! {
    subpixel_bits: u32,
    setup: PlaneSetup,
    store: UnormStore,
    load: UnormLoad,
    depth24: DepthFormat,
    nearest: NearestCoord,
    flush_denormals: bool,
    fma: bool,
    clamp_frag_z: bool,
    slope_norm: SlopeNorm,
    offset_unit: OffsetUnit,
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::DeviceProfile;

    #[test]
    fn a_profile_written_field_by_field_is_the_profile() {
        for profile in DeviceProfile::ALL {
            let whole = profile.device();
            let mut built = Device { profile: *profile, ..DeviceProfile::Ideal.device() };
            for field in FIELDS {
                field.set(&mut built, &field.get(&whole)).expect("its own text");
            }
            assert_eq!(built, whole, "{profile}: FIELDS lacks a field");
        }
    }

    #[test]
    fn what_a_field_cannot_be_is_refused_with_what_it_can() {
        let mut device = DeviceProfile::Ideal.device();
        for (name, text, choice) in
            [("subpixel_bits", "99", "12"), ("fma", "maybe", "true"), ("store", "up", "truncate")]
        {
            let field = FIELDS.iter().find(|field| field.name == name).expect("a field");
            let choices = field.set(&mut device, text).expect_err(name);
            assert!(choices.contains(choice), "{name}: {choices}");
        }
        assert_eq!(device, DeviceProfile::Ideal.device());
    }
}
