//! Where each setting was written, so that a complaint about its value names the file and the line.

use gnomon_core::Error;
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// The places of settings: a line of a file, or the flag that stands above it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Origin {
    places: BTreeMap<String, String>,
}

impl Origin {
    /// The lines of all keys of a TOML text that was parsed before; `place` names it.
    pub(super) fn of(place: &str, text: &str) -> Self {
        let mut origin = Self::default();
        if let Ok(table) = DeTable::parse(text) {
            // Spans lie on a byte; lines are counted once for all of them.
            let starts: Vec<usize> = text.match_indices('\n').map(|(at, _)| at + 1).collect();
            origin.add(place, "", table.get_ref(), &starts);
        }
        origin
    }

    fn add(&mut self, place: &str, path: &str, table: &DeTable<'_>, starts: &[usize]) {
        for (key, value) in table {
            let path = format!("{path}{}", key.get_ref());
            let line = starts.partition_point(|&start| start <= key.span().start) + 1;
            self.places.insert(path.clone(), format!("{place}: line {line}: {path}"));
            if let DeValue::Table(inner) = value.get_ref() {
                self.add(place, &format!("{path}."), inner, starts);
            }
        }
    }

    /// A flag stands above the file's key.
    pub fn override_by(&mut self, key: &str, flag: &str) {
        self.places.insert(key.to_string(), flag.to_string());
    }

    /// `scene.toml: line 3: light.fovy`, the flag, or the key alone where nobody wrote it.
    #[must_use]
    pub fn at(&self, key: &str) -> String {
        self.places.get(key).cloned().unwrap_or_else(|| key.to_string())
    }

    /// The complaint with the place of its key; keys that a reason joins (`light.near/far`) stand
    /// where the first of them was written.
    #[must_use]
    pub fn located(&self, error: Error) -> Error {
        let Error::BadInput { place, reason, fix } = error else { return error };
        let (key, value) = place.split_once(' ').unwrap_or((&place, ""));
        let (path, leaf) = key.rsplit_once('.').unwrap_or(("", key));
        // The box of a projection is what the settings call its width.
        let leaf = if leaf == "ortho" { "width" } else { leaf };
        let mut keys =
            leaf.split('/').map(|leaf| format!("{path}.{leaf}")).chain([key.to_string()]);
        let found = keys.find_map(|key| self.places.get(&key));
        let place =
            found.map_or(place.clone(), |at| format!("{at} {value}").trim_end().to_string());
        Error::BadInput { place, reason, fix }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_on_their_lines() {
        let text = "canvas = [8, 8]\n\n[light]\nfovy = 3\n'near' = 1\n[map]\nsize = 4\n";
        let mut origin = Origin::of("s.toml", text);
        assert_eq!(origin.at("canvas"), "s.toml: line 1: canvas");
        assert_eq!(origin.at("light.fovy"), "s.toml: line 4: light.fovy");
        assert_eq!(origin.at("light.near"), "s.toml: line 5: light.near");
        assert_eq!(origin.at("camera.up"), "camera.up");
        origin.override_by("map.size", "--map");
        assert_eq!(origin.at("map.size"), "--map");
        assert_eq!(
            Origin::of("s.toml", "light.fovy = 3").at("light.fovy"),
            "s.toml: line 1: light.fovy"
        );
        let moved = origin.located(Error::bad_input("light.near/far", "is odd", "mend it"));
        assert_eq!(moved.to_string(), "s.toml: line 5: light.near: is odd; mend it");
        let with_value = origin.located(Error::bad_input("light.fovy 'x'", "is odd", "mend it"));
        assert_eq!(with_value.to_string(), "s.toml: line 4: light.fovy 'x': is odd; mend it");
    }
}
