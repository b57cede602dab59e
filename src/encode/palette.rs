//! Takes colours and how often each is seen, makes a palette: all of them where they fit. Where they do
//! not, the colours of large flat areas keep their place exactly, and the rest is cut by the median
//! (Heckbert, *Color Image Quantization for Frame Buffer Display*, 1982).

use std::collections::HashMap;

type Color = [u8; 3];

/// Colours and which of them stands for which.
pub(super) struct Palette {
    pub colors: Vec<Color>,
    index: HashMap<Color, u8>,
}

/// A colour seen in at least this share of the pixels is flat art's own.
const FLAT_SHARE: f64 = 1.0 / 512.0;

impl Palette {
    /// A palette of at most `most` colours, 2 ..= 256, for these pixels.
    pub(super) fn new(pixels: impl Iterator<Item = Color>, most: usize) -> Palette {
        let mut counts: HashMap<Color, u64> = HashMap::new();
        let mut total = 0;
        // Neighbours are mostly alike: they are counted together.
        let mut run: Option<(Color, u64)> = None;
        for pixel in pixels {
            total += 1;
            match &mut run {
                Some((color, length)) if *color == pixel => *length += 1,
                _ => {
                    if let Some((color, length)) = run.replace((pixel, 1)) {
                        *counts.entry(color).or_default() += length;
                    }
                }
            }
        }
        if let Some((color, length)) = run {
            *counts.entry(color).or_default() += length;
        }
        let mut seen: Vec<(Color, u64)> = counts.into_iter().collect();
        seen.sort_unstable();
        let colors = match seen.len() <= most {
            true => seen.iter().map(|(color, _)| *color).collect(),
            false => reduced(&seen, total, most),
        };
        let index = seen.iter().map(|(color, _)| (*color, nearest(&colors, *color))).collect();
        Palette { colors, index }
    }

    /// The number of a colour it was made for.
    pub(super) fn index(&self, color: Color) -> u8 {
        self.index[&color]
    }
}

fn reduced(seen: &[(Color, u64)], total: u64, most: usize) -> Vec<Color> {
    let mut order: Vec<(Color, u64)> = seen.to_vec();
    order.sort_by_key(|&(color, count)| (std::cmp::Reverse(count), color));
    let flat =
        order.iter().take(most / 2).take_while(|(_, count)| *count as f64 >= FLAT_SHARE * total as f64);
    let flat = flat.count();
    let mut colors: Vec<Color> = order[..flat].iter().map(|(color, _)| *color).collect();
    let mut boxes = vec![order.split_off(flat)];
    while boxes.len() < most - flat {
        let worst = boxes.iter().enumerate().max_by(|a, b| spread(a.1).1.total_cmp(&spread(b.1).1));
        let Some((at, _)) = worst.filter(|(_, members)| members.len() > 1) else { break };
        let mut members = boxes.swap_remove(at);
        let axis = spread(&members).0;
        members.sort_by_key(|(color, _)| (color[axis], *color));
        let half = members.iter().map(|(_, count)| count).sum::<u64>() / 2;
        let mut sum = 0;
        let cut = members.iter().position(|(_, count)| {
            sum += count;
            sum > half
        });
        let above = members.split_off(cut.unwrap_or(0).clamp(1, members.len() - 1));
        boxes.push(members);
        boxes.push(above);
    }
    colors.extend(boxes.iter().filter(|members| !members.is_empty()).map(|members| mean(members)));
    colors
}

/// The channel in which colours differ most, and by how much all together do.
fn spread(members: &[(Color, u64)]) -> (usize, f64) {
    let mut sums = [0.0; 3];
    let mut squares = [0.0; 3];
    let mut weight = 0.0;
    for (color, count) in members {
        let count = *count as f64;
        weight += count;
        for channel in 0..3 {
            let value = f64::from(color[channel]);
            sums[channel] += count * value;
            squares[channel] += count * value * value;
        }
    }
    let variances: [f64; 3] = std::array::from_fn(|c| squares[c] - sums[c] * sums[c] / weight.max(1.0));
    let axis = (0..3).max_by(|&a, &b| variances[a].total_cmp(&variances[b])).unwrap_or(0);
    (axis, if members.len() > 1 { variances[axis] } else { -1.0 })
}

fn mean(members: &[(Color, u64)]) -> Color {
    let weight: u64 = members.iter().map(|(_, count)| count).sum();
    std::array::from_fn(|c| {
        let sum: u64 = members.iter().map(|(color, count)| u64::from(color[c]) * count).sum();
        ((sum + weight / 2) / weight) as u8
    })
}

fn nearest(colors: &[Color], color: Color) -> u8 {
    let distance = |other: &Color| {
        let [r, g, b] = std::array::from_fn(|c| i32::from(other[c]) - i32::from(color[c]));
        // Eyes see green best and blue least.
        3 * r * r + 4 * g * g + 2 * b * b
    };
    colors.iter().enumerate().min_by_key(|(_, other)| distance(other)).map_or(0, |(at, _)| at as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_that_fit_are_exact() {
        let pixels: Vec<Color> = (0..=255).map(|n| [n, 255 - n, n / 2]).collect();
        let palette = Palette::new(pixels.iter().copied(), 256);
        assert!(pixels.iter().all(|&color| palette.colors[palette.index(color) as usize] == color));
    }

    #[test]
    fn flat_areas_stay_exact_when_the_rest_is_cut() {
        let ramp = (0..4000_u32).map(|n| [n as u8, (n >> 4) as u8, (n * 7) as u8]);
        let flat = std::iter::repeat_n([1, 2, 3], 1000).chain(std::iter::repeat_n([250, 128, 7], 500));
        let pixels: Vec<Color> = flat.chain(ramp).collect();
        let palette = Palette::new(pixels.iter().copied(), 255);
        assert!(palette.colors.len() <= 255);
        for color in [[1, 2, 3], [250, 128, 7]] {
            assert_eq!(palette.colors[palette.index(color) as usize], color);
        }
        let far = pixels.iter().map(|&color| {
            let near = palette.colors[palette.index(color) as usize];
            (0..3).map(|c| color[c].abs_diff(near[c])).max().unwrap()
        });
        assert!(far.map(f64::from).sum::<f64>() / pixels.len() as f64 <= 16.0);
    }
}
