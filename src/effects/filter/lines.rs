//! Takes a layer, hands out its rows or its columns, four at a time and side by side, to what works
//! along one axis; puts back what that makes of them. One loop then serves both axes, reads memory in
//! order and fills vector registers. Lines with nothing in them are not handed out.

use crate::effects::layer::Layer;

/// Lines worked on at once.
const TOGETHER: usize = 4;

/// One step along a line: a pixel of each of the four lines.
pub(super) type Step = [f32; TOGETHER * 4];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    X,
    Y,
}

/// Calls `work` on all rows (`Axis::X`) or columns (`Axis::Y`); clear lines must stay clear under it.
pub(super) fn along(layer: &mut Layer, axis: Axis, mut work: impl FnMut(&mut [Step])) {
    let (width, height) = (layer.rect().width(), layer.rect().height());
    // Pixels of one line lie `step` apart, lines `stride` apart.
    let (length, step, lines, stride) = match axis {
        Axis::X => (width, 1, height, width),
        Axis::Y => (height, width, width, 1),
    };
    let mut block: Vec<Step> = vec![[0.0; TOGETHER * 4]; length];
    for first in (0..lines).step_by(TOGETHER) {
        let count = TOGETHER.min(lines - first);
        let mut seen = 0.0f32;
        for (i, to) in block.iter_mut().enumerate() {
            *to = [0.0; TOGETHER * 4];
            for line in 0..count {
                let pixel = layer.pixels()[(first + line) * stride + i * step];
                to[line * 4..line * 4 + 4].copy_from_slice(&pixel);
                seen += pixel[3];
            }
        }
        if seen == 0.0 {
            continue;
        }
        work(&mut block);
        for (i, from) in block.iter().enumerate() {
            for line in 0..count {
                let pixel = &mut layer.pixels_mut()[(first + line) * stride + i * step];
                pixel.copy_from_slice(&from[line * 4..line * 4 + 4]);
            }
        }
    }
}
