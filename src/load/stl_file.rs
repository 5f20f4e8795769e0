//! STL, binary and as text: triangles on their own, flat, wound as they are written; normals of the file
//! are not needed and not trusted.

use super::files::Budget;
use super::{LoadedScene, repair};
use glam::Vec3;
use gnomon_core::{Error, Result};

/// Bytes before the triangles of a binary STL, and of each.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;
/// Bytes in memory for each byte of a text: `vertex 0 0 0` gives a corner.
const GROWTH: u64 = 4;

/// Triangles that a binary STL says that it has.
fn count(bytes: &[u8]) -> Option<usize> {
    let count: &[u8; 4] = bytes.get(HEADER - 4..)?.first_chunk()?;
    Some(u32::from_le_bytes(*count) as usize)
}

/// Whether a binary STL is as long as its triangles are. A name that begins with `solid` says nothing.
fn is_binary(bytes: &[u8]) -> bool {
    let long = |count: usize| count.checked_mul(TRIANGLE)?.checked_add(HEADER);
    count(bytes).and_then(long).is_some_and(|length| length == bytes.len())
}

fn is_text(bytes: &[u8]) -> bool {
    let head = bytes.get(..bytes.len().min(1024)).unwrap_or_default();
    head.trim_ascii_start().starts_with(b"solid") && !head.contains(&0)
}

/// Whether a file without a name for it is an STL.
pub(super) fn is_stl(bytes: &[u8]) -> bool {
    is_binary(bytes) && bytes.len() > HEADER || is_text(bytes)
}

pub(super) fn read(place: &str, bytes: &[u8], mut budget: Budget<'_>) -> Result<LoadedScene> {
    let solids = match (is_binary(bytes), is_text(bytes)) {
        (true, _) => vec![("solid".to_string(), binary(bytes))],
        (false, true) => {
            budget.memory(place, (bytes.len() as u64).saturating_mul(GROWTH))?;
            text(place, bytes)?
        }
        (false, false) => {
            let held = bytes.len().saturating_sub(HEADER) / TRIANGLE;
            let reason = match count(bytes) {
                Some(count) => format!("says {count} triangles and holds {held}"),
                None => "is neither a binary nor a text STL".to_string(),
            };
            return Err(Error::bad_input(place, reason, "export it again"));
        }
    };
    let mut scene = LoadedScene::default();
    for (i, (name, corners)) in solids.into_iter().enumerate().filter(|(_, (_, c))| !c.is_empty()) {
        let at = format!("{place}: solid {i} '{name}'");
        budget.vertices(&at, corners.len() as u64)?;
        budget.indices(&at, corners.len() as u64)?;
        budget.memory(&at, corners.len() as u64 * 28)?;
        let indices = (0..corners.len() as u32).collect();
        let given = (corners, indices);
        let mesh = repair::mesh(&at, given, Vec3::splat(0.8), &budget, &mut scene.notes)?;
        scene.parts.push(super::Part::drawn(format!("{name}#{i}"), mesh));
    }
    Ok(scene)
}

/// Corners of all triangles.
fn binary(bytes: &[u8]) -> Vec<Vec3> {
    let (triangles, _) = bytes.get(HEADER..).unwrap_or_default().as_chunks::<TRIANGLE>();
    let corners = triangles.iter().filter_map(|t| t.get(12..48));
    let corners = corners.flat_map(|c| c.as_chunks::<12>().0).map(|corner| {
        let (words, _) = corner.as_chunks::<4>();
        let mut axes = words.iter().map(|word| f32::from_le_bytes(*word));
        let mut axis = || axes.next().unwrap_or(f32::NAN);
        Vec3::new(axis(), axis(), axis())
    });
    corners.collect()
}

/// Corners of every solid by its name.
fn text(place: &str, bytes: &[u8]) -> Result<Vec<(String, Vec<Vec3>)>> {
    let mut solids: Vec<(String, Vec<Vec3>)> = Vec::new();
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let bad = |reason: String| {
            let place = format!("{place}: line {}", i + 1);
            Err(Error::bad_input(place, reason, "export the STL again"))
        };
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match (words.next().map(<[u8]>::to_ascii_lowercase).as_deref(), solids.last_mut()) {
            (Some(b"solid"), _) => {
                let name = words.next().map_or("solid".into(), String::from_utf8_lossy);
                solids.push((name.into_owned(), Vec::new()));
            }
            (Some(b"vertex"), Some((_, corners))) => {
                let mut axis = || std::str::from_utf8(words.next()?).ok()?.parse::<f32>().ok();
                match axis().zip(axis()).zip(axis()) {
                    Some(((x, y), z)) => corners.push(Vec3::new(x, y, z)),
                    None => return bad("a vertex has no three numbers".into()),
                }
            }
            (Some(b"endloop"), Some((_, corners))) if !corners.len().is_multiple_of(3) => {
                return bad("a facet has no three vertices".into());
            }
            _ => {}
        }
    }
    Ok(solids)
}
