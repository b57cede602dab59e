//! Rectangles of whole pixels, which end far from where numbers do.

use kurbo::Rect;

/// A rectangle of whole pixels: columns [x, x + width), rows [y, y + height).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct IntRect {
    x: i32,
    y: i32,
    width: u32,
    height: u32,
}

impl IntRect {
    /// No edge of a rectangle lies farther out than this, so sums of two never overflow.
    pub const FARTHEST: i64 = 1 << 28;
    pub const EMPTY: IntRect = IntRect { x: 0, y: 0, width: 0, height: 0 };

    pub fn new(x: i32, y: i32, width: u32, height: u32) -> IntRect {
        let (x, y) = (i64::from(x), i64::from(y));
        IntRect::from_edges(x, y, x + i64::from(width), y + i64::from(height))
    }

    /// Columns [left, right), rows [top, bottom); empty where they are not in this order.
    pub fn from_edges(left: i64, top: i64, right: i64, bottom: i64) -> IntRect {
        let [left, top, right, bottom] =
            [left, top, right, bottom].map(|v| v.clamp(-Self::FARTHEST, Self::FARTHEST));
        if right <= left || bottom <= top {
            return IntRect::EMPTY;
        }
        IntRect { x: left as i32, y: top as i32, width: (right - left) as u32, height: (bottom - top) as u32 }
    }

    /// All pixels that a rectangle touches.
    pub fn around(rect: Rect) -> IntRect {
        // `as` saturates, and takes NaN to 0.
        IntRect::from_edges(
            rect.x0.floor() as i64,
            rect.y0.floor() as i64,
            rect.x1.ceil() as i64,
            rect.y1.ceil() as i64,
        )
    }

    pub fn x(self) -> i32 {
        self.x
    }

    pub fn y(self) -> i32 {
        self.y
    }

    pub fn width(self) -> usize {
        self.width as usize
    }

    pub fn height(self) -> usize {
        self.height as usize
    }

    /// The first column beyond it.
    pub fn right(self) -> i32 {
        self.x + self.width as i32
    }

    /// The first row beyond it.
    pub fn bottom(self) -> i32 {
        self.y + self.height as i32
    }

    pub fn area(self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    pub fn is_empty(self) -> bool {
        self.width == 0
    }

    pub fn intersect(self, other: IntRect) -> IntRect {
        IntRect::from_edges(
            self.x.max(other.x).into(),
            self.y.max(other.y).into(),
            self.right().min(other.right()).into(),
            self.bottom().min(other.bottom()).into(),
        )
    }

    /// The smallest rectangle that holds both.
    pub fn united(self, other: IntRect) -> IntRect {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => other,
            (_, true) => self,
            _ => IntRect::from_edges(
                self.x.min(other.x).into(),
                self.y.min(other.y).into(),
                self.right().max(other.right()).into(),
                self.bottom().max(other.bottom()).into(),
            ),
        }
    }

    /// Moved by whole pixels.
    pub fn moved(self, dx: i32, dy: i32) -> IntRect {
        let (dx, dy) = (i64::from(dx), i64::from(dy));
        IntRect::from_edges(
            i64::from(self.x) + dx,
            i64::from(self.y) + dy,
            i64::from(self.right()) + dx,
            i64::from(self.bottom()) + dy,
        )
    }

    /// Wider by this many columns on either side, higher by this many rows above and below.
    pub fn grown(self, columns: i64, rows: i64) -> IntRect {
        if self.is_empty() {
            return self;
        }
        IntRect::from_edges(
            i64::from(self.x).saturating_sub(columns),
            i64::from(self.y).saturating_sub(rows),
            i64::from(self.right()).saturating_add(columns),
            i64::from(self.bottom()).saturating_add(rows),
        )
    }

    pub fn to_rect(self) -> Rect {
        Rect::new(self.x.into(), self.y.into(), self.right().into(), self.bottom().into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_rectangles_are_cut_or_empty() {
        assert_eq!(IntRect::new(5, 5, 0, 7), IntRect::EMPTY);
        assert!(IntRect::new(i32::MAX, i32::MIN, u32::MAX, u32::MAX).is_empty());
        assert_eq!(IntRect::around(Rect::new(f64::NAN, 0.0, f64::NAN, 1.0)), IntRect::EMPTY);
        assert!(IntRect::around(Rect::new(-1e300, -1e300, 1e300, 1e300)).width() > 1 << 28);
    }
}
