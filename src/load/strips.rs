//! Strips and fans as lists of triangles, all with the winding of the first.

/// Corners i, i+1, i+2 of a strip, every second triangle turned; triangles that repeat a corner only
/// join strips and are left out.
pub(super) fn strip(corners: &[u32]) -> Vec<u32> {
    let triangle = |(i, &[a, b, c]): (usize, &[u32; 3])| match i % 2 {
        0 => [a, b, c],
        _ => [b, a, c],
    };
    let triangles = corners.array_windows::<3>().enumerate().map(triangle);
    triangles.filter(|&[a, b, c]| a != b && b != c && c != a).flatten().collect()
}

/// The first corner of a fan with every pair of neighbours after it.
pub(super) fn fan(corners: &[u32]) -> Vec<u32> {
    let Some((&first, rest)) = corners.split_first() else { return Vec::new() };
    rest.array_windows::<2>().flat_map(|&[a, b]| [first, a, b]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_second_triangle_of_a_strip_is_turned() {
        assert_eq!(strip(&[0, 1, 2, 3]), [0, 1, 2, 2, 1, 3]);
        assert_eq!(strip(&[0, 1, 2, 2, 4, 4, 5, 6]), [0, 1, 2, 5, 4, 6], "joined by repeats");
        assert!(strip(&[0, 1]).is_empty() && fan(&[]).is_empty() && fan(&[1, 2]).is_empty());
        assert_eq!(fan(&[7, 1, 2, 3]), [7, 1, 2, 7, 2, 3]);
    }
}
