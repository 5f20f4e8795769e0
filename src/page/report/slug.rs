//! Names that people gave, made into ids: the one home of slugs.

/// An id of at most so many bytes: what a page adds to it keeps file names near 100 bytes.
const LONGEST: usize = 72;
/// What the page's templates add to the id of a section or a block.
const ADDED: [&str; 2] = ["caption", "title"];

/// An id for each name, in their order: lower-case ASCII letters, digits and hyphens, never empty, at
/// most about 80 bytes, the same for the same list. A name that is such an id already keeps it.
///
/// `own` are the ids that the page has beside these, `parts` what it appends to them (`curve` stands
/// for `ID-curve…`): ids are unique with all their parts. Only ids and file names are made of them;
/// people read the name itself.
#[must_use]
pub fn slugs<'n>(
    names: impl IntoIterator<Item = &'n str>,
    own: &[&str],
    parts: &[&str],
) -> Vec<String> {
    let mut taken: Vec<String> = Vec::new();
    for name in names {
        let plain = plain(name);
        let free = |id: &String| {
            let others = own.iter().copied().chain(taken.iter().map(String::as_str));
            !others.into_iter().any(|other| clash(id, other, parts))
        };
        let numbered = (2u64..).map(|n| format!("scene{n}-{plain}"));
        let tried = [plain.clone(), format!("scene-{plain}")].into_iter().chain(numbered);
        let id = tried.into_iter().find(free).expect("among all numbers one is free");
        taken.push(id);
    }
    taken
}

/// A name in lower-case ASCII letters, digits and single hyphens.
fn plain(name: &str) -> String {
    let mut id = String::new();
    for c in name.chars().flat_map(char::to_lowercase) {
        match c {
            'a'..='z' | '0'..='9' => id.push(c),
            _ if id.is_empty() || id.ends_with('-') => {}
            _ => id.push('-'),
        }
    }
    id.truncate(LONGEST);
    id.truncate(id.trim_end_matches('-').len());
    if id.is_empty() { "scene".to_string() } else { id }
}

/// Whether two ids are the same, or one is a part of the other.
fn clash(a: &str, b: &str, parts: &[&str]) -> bool {
    let is_part = |part: &str, of: &str| {
        let rest = part.strip_prefix(of).and_then(|rest| rest.strip_prefix('-'));
        rest.is_some_and(|rest| parts.iter().chain(&ADDED).any(|p| rest.starts_with(p)))
    };
    a == b || is_part(a, b) || is_part(b, a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_plain_and_unique() {
        let own = ["overview", "cases", "cases-bias", "upc-acne"];
        let long = "x".repeat(300);
        let names = [
            ("Model", "model"),
            ("my model", "my-model"),
            ("ü", "scene"),
            ("", "scene-scene"),
            ("😀", "scene2-scene"),
            ("model_1", "model-1"),
            ("model.1", "scene-model-1"),
            ("..model..1..", "scene2-model-1"),
            ("Overview", "scene-overview"),
            ("cases", "scene-cases"),
            ("cases-bias", "scene-cases-bias"),
            ("upc", "upc"),
            ("model-curve", "scene-model-curve"),
            ("model-curved", "scene-model-curved"),
            ("model-title", "scene-model-title"),
            ("=cmd|' /C calc'!A0", "cmd-c-calc-a0"),
            (long.as_str(), &"x".repeat(LONGEST)),
        ];
        let ids = slugs(names.iter().map(|n| n.0), &own, &["curve", "map"]);
        for ((name, expected), id) in names.iter().zip(&ids) {
            assert_eq!(id, expected, "{name}");
        }
    }

    #[test]
    fn what_is_an_id_stays_as_it_is() {
        let names = ["book-r8-y7", "book-r8-y7-slant", "upc", "terrain-100000"];
        assert_eq!(slugs(names, &["upc-acne", "cases"], &["map", "curve"]), names);
    }
}
