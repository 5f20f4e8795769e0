//! SVG text as plotters writes it, made small: neighbours of one style become one path.
//!
//! plotters writes an element per grid line, dash and point; the figures of a report are mostly those.
//! Only what is painted with full opacity is joined, so that the picture is the same.

use std::fmt::Write;

/// This picture in fewer bytes.
pub(super) fn compact(svg: &str) -> String {
    let mut out = String::with_capacity(svg.len() / 2);
    let mut open = String::new();
    for line in svg.lines() {
        let stroke = stroke(line);
        let style = stroke.as_ref().map_or("", |s| s.0.as_str());
        if style != open {
            if !open.is_empty() {
                out.push_str("\"/>\n");
            }
            if !style.is_empty() {
                let _ = write!(out, "<path fill=\"none\" {style} d=\"");
            }
            open = style.to_string();
        }
        match stroke {
            Some((_, path)) => out.push_str(&path),
            None => plain(&mut out, line),
        }
    }
    out
}

/// Any other line, without what says nothing; the text of a label joins its element.
fn plain(out: &mut String, line: &str) {
    let line = line.replace(" opacity=\"1\"", "").replace(" stroke=\"none\"", "");
    match attribute(&line, "font-size").and_then(|size| Some((size, size.parse::<f64>().ok()?))) {
        Some((long, size)) => out.push_str(&line.replace(long, &format!("{size:.1}"))),
        None => out.push_str(&line),
    }
    if ["<svg", "</"].iter().any(|tag| line.starts_with(tag)) || line.ends_with("/>") {
        out.push('\n');
    }
}

fn attribute<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let start = line.find(&format!(" {name}=\""))? + name.len() + 3;
    line[start..].split('"').next()
}

/// Style and path of an opaque stroke or dot; `None` for anything else.
fn stroke(line: &str) -> Option<(String, String)> {
    if attribute(line, "opacity") != Some("1") {
        return None;
    }
    let text = |name: &str| attribute(line, name);
    let number = |name: &str| text(name)?.parse::<i32>().ok();
    let stroked = || {
        Some(format!("stroke=\"{}\" stroke-width=\"{}\"", text("stroke")?, text("stroke-width")?))
    };
    if line.starts_with("<line ") {
        let ends = [[number("x1")?, number("y1")?], [number("x2")?, number("y2")?]];
        return Some((stroked()?, path(&ends)));
    }
    if line.starts_with("<polyline ") && text("fill") == Some("none") {
        let point = |pair: &str| {
            let (x, y) = pair.split_once(',')?;
            Some([x.parse().ok()?, y.parse().ok()?])
        };
        let points: Option<Vec<[i32; 2]>> = text("points")?.split_whitespace().map(point).collect();
        return Some((stroked()?, path(&points?)));
    }
    if line.starts_with("<circle ") && text("stroke") == Some("none") {
        // A dot is a line of no length with round ends.
        let (fill, width) = (text("fill")?, 2 * number("r")?);
        let style = format!("stroke=\"{fill}\" stroke-width=\"{width}\" stroke-linecap=\"round\"");
        return Some((style, format!("M{} {}h0", number("cx")?, number("cy")?)));
    }
    None
}

/// The polyline through `points`, in steps.
fn path(points: &[[i32; 2]]) -> String {
    let mut text = String::new();
    if let Some([x, y]) = points.first() {
        let _ = write!(text, "M{x} {y}");
    }
    for pair in points.windows(2) {
        let _ = match [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]] {
            [dx, 0] => write!(text, "h{dx}"),
            [0, dy] => write!(text, "v{dy}"),
            [dx, dy] if dy < 0 => write!(text, "l{dx}{dy}"),
            [dx, dy] => write!(text, "l{dx} {dy}"),
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_one_style_are_one_path() {
        let svg = concat!(
            "<svg width=\"9\" height=\"9\">\n",
            "<line opacity=\"1\" stroke=\"#EEE\" stroke-width=\"1\" x1=\"4\" y1=\"1\" x2=\"4\" y2=\"8\"/>\n",
            "<polyline fill=\"none\" opacity=\"1\" stroke=\"#EEE\" stroke-width=\"1\" points=\"1,2 3,2 5,9 6,3 \"/>\n",
            "<polyline fill=\"none\" opacity=\"1\" stroke=\"#111\" stroke-width=\"1\" points=\"0,0 1,1 \"/>\n",
            "<polyline fill=\"none\" opacity=\"0.5\" stroke=\"#111\" stroke-width=\"1\" points=\"0,0 1,1 \"/>\n",
            "<circle cx=\"3\" cy=\"4\" r=\"6\" opacity=\"1\" fill=\"#0072B2\" stroke=\"none\" stroke-width=\"1\"/>\n",
            "<text x=\"5\" y=\"7\" font-size=\"25.806451612903228\" opacity=\"1\">\na label\n</text>\n",
            "</svg>\n",
        );
        let small = concat!(
            "<svg width=\"9\" height=\"9\">\n",
            "<path fill=\"none\" stroke=\"#EEE\" stroke-width=\"1\" d=\"M4 1v7M1 2h2l2 7l1-6\"/>\n",
            "<path fill=\"none\" stroke=\"#111\" stroke-width=\"1\" d=\"M0 0l1 1\"/>\n",
            "<polyline fill=\"none\" opacity=\"0.5\" stroke=\"#111\" stroke-width=\"1\" points=\"0,0 1,1 \"/>\n",
            "<path fill=\"none\" stroke=\"#0072B2\" stroke-width=\"12\" stroke-linecap=\"round\" d=\"M3 4h0\"/>\n",
            "<text x=\"5\" y=\"7\" font-size=\"25.8\">a label</text>\n",
            "</svg>\n",
        );
        assert_eq!(compact(svg), small);
    }
}
