//! Our own JSON files carry the digest of their text, so that a changed or foreign one is told apart.

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::found::digest;

/// The value as JSON text whose last member, `digest`, is the SHA-256 of the text before it.
pub(super) fn seal(value: &impl Serialize) -> Vec<u8> {
    let text = serde_json::to_string_pretty(value).expect("a record is JSON");
    let body = text.strip_suffix("\n}").expect("a record is an object of members");
    let own = digest(body.as_bytes());
    format!("{body},\n  \"digest\": \"{own}\"\n}}\n").into_bytes()
}

/// The value, where `bytes` are exactly what [`seal`] makes of it.
pub(super) fn unseal<T: Serialize + DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let value: T = serde_json::from_slice(bytes).ok()?;
    (seal(&value) == bytes).then_some(value)
}
