//! Material files of an OBJ, as far as they say that a surface is not opaque.

use super::files::Budget;
use std::collections::BTreeSet;

/// Says which used materials are transparent or cut out; what cannot be read says nothing.
pub(super) fn tell(
    budget: &mut Budget<'_>,
    libraries: &BTreeSet<String>,
    used: &BTreeSet<String>,
    skipped: &mut Vec<String>,
) {
    let texts = libraries.iter().filter_map(|name| budget.resource(name, name).ok());
    let seen: Vec<String> = texts
        .flat_map(|text| see_through(&String::from_utf8_lossy(&text)))
        .filter(|name| used.contains(name))
        .collect();
    if let Some(first) = seen.first() {
        let (count, plural) = (seen.len(), if seen.len() == 1 { "" } else { "s" });
        skipped.push(format!(
            "{count} material{plural} with transparency ('{first}' first): taken as opaque; glTF keeps masks"
        ));
    }
}

/// Names of the materials with `d` below 1, `Tr` above 0 or `map_d`.
fn see_through(text: &str) -> BTreeSet<String> {
    let (mut name, mut found) = (String::new(), BTreeSet::new());
    for line in text.lines() {
        let (word, rest) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
        let number = || rest.trim().parse::<f64>().ok();
        let clear = match word {
            "newmtl" => {
                name = rest.trim().to_string();
                false
            }
            "d" => number().is_some_and(|d| d < 1.0),
            "Tr" => number().is_some_and(|t| t > 0.0),
            "map_d" => true,
            _ => false,
        };
        if clear {
            found.insert(name.clone());
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_that_light_passes_are_found() {
        let text =
            "newmtl a\nd 1\nnewmtl leaf\n map_d x.png\nnewmtl glass\nd 0.3\nnewmtl b\nTr 0\n";
        assert_eq!(see_through(text).into_iter().collect::<Vec<_>>(), ["glass", "leaf"]);
    }
}
