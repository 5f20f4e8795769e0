//! JSON fields that know where they stand, so that every complaint names file and place.

use crate::{Error, Result, input};
use glam::{DVec3, Mat4};
use serde_json::Value;
use std::path::Path;

/// A JSON value with its file and path.
#[derive(Clone, Debug)]
pub(super) struct Field<'a> {
    place: String,
    value: &'a Value,
}

/// A file's bytes.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>> {
    input::read_or_stdin(path, input::DATA)
}

/// Reads and parses a JSON file.
pub(super) fn read(path: &Path) -> Result<Value> {
    parse(path, &bytes(path)?)
}

/// Parses the bytes of the JSON file at `path`.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Value> {
    serde_json::from_slice(bytes)
        .map_err(|e| Error::bad_input(path.display().to_string(), e.to_string(), "give valid JSON"))
}

impl<'a> Field<'a> {
    pub(super) fn root(path: &Path, value: &'a Value) -> Self {
        Self { place: format!("{}:", path.display()), value }
    }

    /// File and path, as complaints name it.
    pub(super) fn place(&self) -> String {
        self.place.clone()
    }

    /// A complaint about this field.
    pub(super) fn bad(&self, reason: impl Into<String>, fix: impl Into<String>) -> Error {
        Error::bad_input(self.place.clone(), reason, fix)
    }

    /// The member `name`; `None` where absent or null.
    pub(super) fn optional(&self, name: &str) -> Option<Self> {
        let value = self.value.get(name).filter(|v| !v.is_null())?;
        Some(Field { place: self.inside(name), value })
    }

    /// Where the member `name` stands: `file: a.b.c`.
    fn inside(&self, name: &str) -> String {
        let separator = if self.place.ends_with(':') { " " } else { "." };
        format!("{}{separator}{name}", self.place)
    }

    /// The member `name`.
    pub(super) fn get(&self, name: &str) -> Result<Self> {
        self.optional(name)
            .ok_or_else(|| Error::bad_input(self.inside(name), "is missing", "add the field"))
    }

    pub(super) fn items(&self) -> Result<Vec<Self>> {
        let list = self.value.as_array().ok_or_else(|| self.bad("is no list", "give a list"))?;
        let item = |(i, value)| Field { place: format!("{}[{i}]", self.place), value };
        Ok(list.iter().enumerate().map(item).collect())
    }

    pub(super) fn members(&self) -> Result<Vec<(&'a str, Self)>> {
        let map = self.value.as_object().ok_or_else(|| self.bad("is no object", "give one"))?;
        let member = |(name, value): (&'a String, &'a Value)| {
            (name.as_str(), Field { place: self.inside(name), value })
        };
        Ok(map.iter().map(member).collect())
    }

    pub(super) fn text(&self) -> Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.bad("is no text", "give a string"))
    }

    /// A string, a number or a truth value as text.
    pub(super) fn plain(&self) -> Result<String> {
        match self.value {
            Value::String(text) => Ok(text.clone()),
            Value::Number(_) | Value::Bool(_) => Ok(self.value.to_string()),
            Value::Null | Value::Array(_) | Value::Object(_) => {
                Err(self.bad("is a list or an object", "give a word, a number, true or false"))
            }
        }
    }

    pub(super) fn flag(&self) -> Result<bool> {
        self.value.as_bool().ok_or_else(|| self.bad("is neither true nor false", "give one"))
    }

    pub(super) fn number(&self) -> Result<f64> {
        let number = self.value.as_f64().filter(|x| x.is_finite());
        number.ok_or_else(|| self.bad("is no finite number", "give a number"))
    }

    /// A number that is meant as f32: the f32 nearest to it, refused where that overflows.
    pub(super) fn float(&self) -> Result<f32> {
        let x = self.number()? as f32;
        if x.is_finite() { Ok(x) } else { Err(self.bad("overflows f32", "give a smaller number")) }
    }

    /// A whole number in 1..=limit.
    pub(super) fn count(&self, limit: u32) -> Result<u32> {
        let n = self.value.as_u64().filter(|&n| n >= 1 && n <= u64::from(limit));
        n.map(|n| n as u32)
            .ok_or_else(|| self.bad(format!("is no whole number from 1 to {limit}"), "give one"))
    }

    pub(super) fn floats(&self) -> Result<Vec<f32>> {
        self.items()?.iter().map(Field::float).collect()
    }

    /// Exactly `N` numbers.
    pub(super) fn array<const N: usize>(&self) -> Result<[f32; N]> {
        let floats = self.floats()?;
        let len = floats.len();
        floats.try_into().map_err(|_| self.bad(format!("has {len} numbers"), format!("give {N}")))
    }

    pub(super) fn point(&self) -> Result<DVec3> {
        let items = self.items()?;
        if items.len() != 3 {
            return Err(self.bad(format!("has {} numbers", items.len()), "give 3"));
        }
        Ok(DVec3::new(items[0].number()?, items[1].number()?, items[2].number()?))
    }

    /// A column-major 4×4 matrix.
    pub(super) fn matrix(&self) -> Result<Mat4> {
        Ok(Mat4::from_cols_array(&self.array()?))
    }

    /// A member of a closed set under the word that the layout uses for it.
    pub(super) fn word<T: Copy>(&self, words: &[(&str, T)]) -> Result<T> {
        let text = self.text()?;
        let found = words.iter().find(|(word, _)| *word == text);
        found.map(|&(_, value)| value).ok_or_else(|| {
            let known = words.iter().map(|(word, _)| *word).collect::<Vec<_>>().join("', '");
            self.bad(format!("'{text}' is not known"), format!("use one of '{known}'"))
        })
    }
}
