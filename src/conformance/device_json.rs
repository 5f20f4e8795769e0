//! A device profile out of what the page's "Measure this GPU" panel copied.

use super::json::{self, Field};
use crate::Result;
use crate::depth::DepthFormat;
use crate::device::{Device, DeviceProfile, FIELDS, OffsetUnit};
use crate::raster::probe::OffsetProbe;
use crate::report::{Cell, Column, Table};
use serde_json::{Value, json};
use std::path::Path;

/// The panel's schema.
const SCHEMA: &str = "gnomon-device-1";
/// What the panel writes where no rule explains what it saw.
const UNKNOWN: &str = "unknown";
/// The unit r is measured to a 1024th of itself.
const UNIT_TOLERANCE: f64 = 1.0 / 1024.0;

/// A device as a reader measured it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredDevice {
    /// What the browser calls it.
    pub renderer: String,
    /// Its profile; fields that were not measured are those of `ideal`.
    pub device: Device,
    /// Names of those fields.
    pub missing: Vec<&'static str>,
    /// Every unit of polygon offset that explains what was measured; the profile has the first.
    pub offset_units: Vec<OffsetUnit>,
}

/// Reads the JSON that the panel copied.
///
/// # Errors
/// [`crate::Error::Read`] for the file; [`crate::Error::BadInput`], naming file and field, where it is
/// no JSON, of another schema, or says what no profile can have.
pub fn read(path: &Path) -> Result<MeasuredDevice> {
    from_value(path, &json::read(path)?)
}

/// Profiles from the file's bytes; `path` names it in complaints.
///
/// # Errors
/// [`crate::Error::BadInput`] as [`read`].
pub fn parse(path: &Path, bytes: &[u8]) -> Result<MeasuredDevice> {
    from_value(path, &json::parse(path, bytes)?)
}

fn from_value(path: &Path, value: &Value) -> Result<MeasuredDevice> {
    let root = Field::root(path, value);
    let schema = root.get("schema")?;
    if schema.text()? != SCHEMA {
        let reason = format!("is '{}', not '{SCHEMA}'", schema.text()?);
        return Err(schema.bad(reason, "copy the JSON of a report's panel 'Measure this GPU'"));
    }
    let given = root.get("device")?;
    known_names(&given)?;
    let mut measured = MeasuredDevice {
        renderer: root.optional("renderer").map_or(Ok("unnamed"), |f| f.text())?.to_string(),
        device: DeviceProfile::Ideal.device(),
        missing: Vec::new(),
        offset_units: Vec::new(),
    };
    for field in FIELDS {
        let text = given.optional(field.name).map(|f| f.plain()).transpose()?;
        match text.filter(|text| text != UNKNOWN) {
            None => measured.missing.push(field.name),
            Some(text) => field.set(&mut measured.device, &text).map_err(|choices| {
                let place = given.optional(field.name).unwrap_or_else(|| given.clone());
                place.bad(format!("'{text}' is not known"), format!("use {choices}"))
            })?,
        }
    }
    if measured.missing.contains(&"offset_unit") {
        measured.infer_offset_unit(&root)?;
    }
    Ok(measured)
}

/// A misspelt field would silently stay ideal.
fn known_names(device: &Field<'_>) -> Result<()> {
    for (name, field) in device.members()? {
        if !FIELDS.iter().any(|known| known.name == name) {
            let names: Vec<_> = FIELDS.iter().map(|known| known.name).collect();
            let fix = format!("use {}", names.join(", "));
            return Err(field.bad("is no field of a device profile", fix));
        }
    }
    Ok(())
}

impl MeasuredDevice {
    /// The panel does not name the unit: every one whose probe gives the measured r in all formats.
    fn infer_offset_unit(&mut self, root: &Field<'_>) -> Result<()> {
        let Some(offsets) = root.optional("polygon_offset") else { return Ok(()) };
        let mut measured = Vec::new();
        for format in [DepthFormat::Unorm16, DepthFormat::Unorm24, DepthFormat::F32] {
            if let Some(probe) = offsets.optional(format.name()) {
                measured.push((format, probe.get("r")?.number()?));
            }
        }
        let explains = |unit: &&OffsetUnit| {
            let device = Device { offset_unit: **unit, ..self.device };
            !measured.is_empty()
                && measured.iter().all(|&(format, r)| {
                    let predicted = OffsetProbe::of(&device, format).r;
                    (predicted - r).abs() <= UNIT_TOLERANCE * predicted.abs()
                })
        };
        self.offset_units = OffsetUnit::ALL.iter().filter(explains).copied().collect();
        if let Some(&unit) = self.offset_units.first() {
            self.device.offset_unit = unit;
            self.missing.retain(|name| *name != "offset_unit");
        }
        Ok(())
    }

    /// The two known profiles that agree with the measured fields most, the nearest first.
    #[must_use]
    pub fn nearest(&self) -> [DeviceProfile; 2] {
        let mut profiles = DeviceProfile::ALL.to_vec();
        profiles.sort_by_key(|profile| self.differing(*profile).len());
        [profiles[0], profiles[1]]
    }

    /// Measured fields in which a known profile differs.
    #[must_use]
    pub fn differing(&self, profile: DeviceProfile) -> Vec<&'static str> {
        let known = profile.device();
        let measured = FIELDS.iter().filter(|field| !self.missing.contains(&field.name));
        measured.filter(|f| f.get(&known) != f.get(&self.device)).map(|f| f.name).collect()
    }

    /// Field by field beside the two nearest known profiles.
    #[must_use]
    pub fn table(&self) -> Table {
        let nearest = self.nearest();
        let names = ["field", "this device", "measured", nearest[0].name(), nearest[1].name()];
        let column = |name: &str| Column { name: name.to_string(), ..Column::default() };
        let row = |field: &crate::device::Field| {
            let own = field.get(&self.device);
            let measured = if self.missing.contains(&field.name) { "no: as ideal" } else { "yes" };
            let beside = nearest.map(|profile| {
                let known = field.get(&profile.device());
                Cell::from(if known == own { known } else { format!("{known} (differs)") })
            });
            let own: Vec<Cell> = vec![field.name.into(), own.into(), measured.into()];
            own.into_iter().chain(beside).collect()
        };
        Table {
            id: "device".to_string(),
            caption: String::new(),
            columns: names.map(column).into(),
            rows: FIELDS.iter().map(row).collect(),
        }
    }

    /// What the table does not say, a sentence each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![format!("{}:", self.renderer)];
        for profile in self.nearest() {
            let differing = self.differing(profile);
            let text = if differing.is_empty() { "nothing".into() } else { differing.join(", ") };
            notes.push(format!("differs from {profile} in {text}."));
        }
        if !self.missing.is_empty() {
            notes.push(format!("Not measured, taken from ideal: {}.", self.missing.join(", ")));
        }
        if self.offset_units.len() > 1 {
            let units: Vec<_> = self.offset_units.iter().map(|unit| unit.name()).collect();
            notes.push(format!("Units of polygon offset that explain it: {}.", units.join(", ")));
        }
        notes
    }

    /// The profile as JSON.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let fields: serde_json::Map<_, _> =
            FIELDS.iter().map(|f| (f.name.to_string(), json!(f.get(&self.device)))).collect();
        json!({
            "renderer": self.renderer,
            "profile": fields,
            "not_measured": self.missing,
            "nearest": self.nearest().map(DeviceProfile::name),
        })
    }
}
