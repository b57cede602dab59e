//! Takes two frames, makes the smallest rectangle in which they differ.

use crate::Pixmap;

/// Columns [x, x + width) and rows [y, y + height).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Area {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

impl Area {
    /// Where two frames `width` pixels wide differ; `None` if they do not.
    pub(super) fn changed(before: &[u8], after: &[u8], width: usize) -> Option<Area> {
        Area::of(before, after, width, |a, b| a != b)
    }

    /// The smallest rectangle around the pixels for which `differ` holds.
    pub(super) fn of(
        before: &[u8],
        after: &[u8],
        width: usize,
        differ: impl Fn(&[u8; 4], &[u8; 4]) -> bool,
    ) -> Option<Area> {
        let stride = width * Pixmap::BYTES_PER_PIXEL;
        let (mut left, mut right) = (width, 0);
        let (mut top, mut bottom) = (None, 0);
        for (y, (a, b)) in before.chunks_exact(stride).zip(after.chunks_exact(stride)).enumerate() {
            if a == b {
                continue;
            }
            let (a, b) = (a.as_chunks().0, b.as_chunks().0);
            let mut pairs = a.iter().zip(b);
            let Some(first) = pairs.position(|(a, b)| differ(a, b)) else { continue };
            let last = a.iter().zip(b).rposition(|(a, b)| differ(a, b)).unwrap_or(first);
            left = left.min(first);
            right = right.max(last + 1);
            top.get_or_insert(y);
            bottom = y + 1;
        }
        let y = top?;
        Some(Area { x: left, y, width: right - left, height: bottom - y })
    }

    pub(super) fn whole(width: usize, height: usize) -> Area {
        Area { x: 0, y: 0, width, height }
    }

    /// The smallest rectangle around both.
    pub(super) fn with(self, other: Area) -> Area {
        let (x, y) = (self.x.min(other.x), self.y.min(other.y));
        let right = (self.x + self.width).max(other.x + other.width);
        let bottom = (self.y + self.height).max(other.y + other.height);
        Area { x, y, width: right - x, height: bottom - y }
    }

    /// Its rows in a frame `width` pixels wide.
    pub(super) fn rows(self, pixels: &[u8], width: usize) -> impl Iterator<Item = &[u8]> {
        let stride = width * Pixmap::BYTES_PER_PIXEL;
        let (from, to) = (self.x * Pixmap::BYTES_PER_PIXEL, (self.x + self.width) * Pixmap::BYTES_PER_PIXEL);
        pixels.chunks_exact(stride).skip(self.y).take(self.height).map(move |row| &row[from..to])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rectangle_is_as_small_as_can_be() {
        let before = vec![0; 5 * 4 * 4];
        let mut after = before.clone();
        assert_eq!(Area::changed(&before, &after, 5), None);
        for (x, y) in [(3, 1), (1, 2)] {
            after[(y * 5 + x) * 4 + 3] = 9;
        }
        assert_eq!(Area::changed(&before, &after, 5), Some(Area { x: 1, y: 1, width: 3, height: 2 }));
    }
}
