//! Takes two premultiplied colours, source and backdrop, makes what is seen of them under one of
//! CSS's blend modes (W3C Compositing and Blending Level 1, sections 9 and 10). Pure functions, for
//! feBlend and for the compositor alike; the colours' encoding is the caller's.

use super::layer::Pixel;
use usvg::BlendMode;

/// A colour that is blended with many backdrops.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    /// Premultiplied.
    pixel: Pixel,
    /// Not premultiplied; the fourth component means nothing.
    straight: Pixel,
    seen: Seen,
    /// Do alphas add up, too, as for `plus-lighter`?
    adds: bool,
}

/// What is seen in front of a backdrop, neither of them clear; the fourth component means nothing, that of the backdrop
/// neither: with it, all are one vector. Its alpha comes after it.
type Seen = fn(&Source, Pixel, f32) -> Pixel;

impl Source {
    pub fn new(mode: BlendMode, pixel: Pixel) -> Source {
        macro_rules! by_component {
            ($mixed:expr) => {
                |source, backdrop, alpha| source.separable(backdrop, alpha, $mixed)
            };
        }
        macro_rules! by_color {
            ($mixed:expr) => {
                |source, backdrop, alpha| source.non_separable(backdrop, alpha, $mixed)
            };
        }
        let seen: Seen = match mode {
            BlendMode::Normal => |source, backdrop, _| over(source.pixel, backdrop),
            BlendMode::PlusLighter => {
                |source, backdrop, _| each(|i| least(source.pixel[i] + backdrop[i], 1.0))
            }
            BlendMode::Multiply => by_component!(multiply),
            BlendMode::Screen => by_component!(screen),
            BlendMode::Overlay => by_component!(|s, b| hard_light(b, s)),
            BlendMode::Darken => by_component!(least),
            BlendMode::Lighten => by_component!(most),
            BlendMode::ColorDodge => by_component!(color_dodge),
            BlendMode::ColorBurn => by_component!(color_burn),
            BlendMode::HardLight => by_component!(hard_light),
            BlendMode::SoftLight => by_component!(soft_light),
            BlendMode::Difference => by_component!(|s, b| (s - b).abs()),
            BlendMode::Exclusion => by_component!(|s, b| s + b - 2.0 * s * b),
            BlendMode::Hue => by_color!(|source, backdrop| {
                with_luminosity(with_saturation(source, saturation(backdrop)), luminosity(backdrop))
            }),
            BlendMode::Saturation => by_color!(|source, backdrop| {
                with_luminosity(with_saturation(backdrop, saturation(source)), luminosity(backdrop))
            }),
            BlendMode::Color => {
                by_color!(|source, backdrop| with_luminosity(source, luminosity(backdrop)))
            }
            BlendMode::Luminosity => {
                by_color!(|source, backdrop| with_luminosity(backdrop, luminosity(source)))
            }
        };
        let adds = mode == BlendMode::PlusLighter;
        Source { pixel, straight: straight(pixel, pixel[3]), seen, adds }
    }

    /// The light that passes both, 0 ..= 1, of what passes the source and the backdrop.
    #[inline]
    pub fn through(&self, source: f32, backdrop: f32) -> f32 {
        match self.adds {
            true => most(source + backdrop - 1.0, 0.0),
            false => source * backdrop,
        }
    }

    /// What is seen of it in front of a backdrop whose alpha comes after it; the fourth components mean nothing.
    #[inline]
    pub fn before(&self, backdrop: Pixel, alpha: f32) -> Pixel {
        if self.pixel[3] <= 0.0 {
            return backdrop;
        }
        if alpha <= 0.0 {
            return self.pixel;
        }
        (self.seen)(self, backdrop, alpha)
    }

    /// The colour with which the source, painted over the backdrop, comes out as the blend of both; its alpha
    /// is the source's.
    #[inline]
    pub fn own_color(&self, backdrop: Pixel) -> Pixel {
        let alpha = self.pixel[3];
        let blended = self.before(backdrop, backdrop[3]);
        let mut own = each(|i| least(most(blended[i] - (1.0 - alpha) * backdrop[i], 0.0), alpha));
        own[3] = alpha;
        own
    }

    /// Each component by itself.
    #[inline(always)]
    fn separable(&self, backdrop: Pixel, alpha: f32, mixed: impl Fn(f32, f32) -> f32) -> Pixel {
        self.composed(backdrop, alpha, |s, b| each(|i| mixed(s[i], b[i])))
    }

    /// The whole colour at once.
    #[inline(always)]
    fn non_separable(
        &self,
        backdrop: Pixel,
        alpha: f32,
        mixed: impl Fn([f32; 3], [f32; 3]) -> [f32; 3],
    ) -> Pixel {
        self.composed(backdrop, alpha, |[sr, sg, sb, _], [br, bg, bb, _]| {
            let [r, g, b] = mixed([sr, sg, sb], [br, bg, bb]);
            [r, g, b, 0.0]
        })
    }

    /// Source alone, backdrop alone, and where both are, `mixed` of their straight colours.
    #[inline(always)]
    fn composed(&self, backdrop: Pixel, alpha: f32, mixed: impl Fn(Pixel, Pixel) -> Pixel) -> Pixel {
        let own_alpha = self.pixel[3];
        let both = mixed(self.straight, straight(backdrop, alpha));
        let (shared, either) = (own_alpha * alpha, own_alpha + alpha * (1.0 - own_alpha));
        each(|i| {
            let alone = self.pixel[i] * (1.0 - alpha) + backdrop[i] * (1.0 - own_alpha);
            least(most(alone + both[i] * shared, 0.0), either)
        })
    }
}

/// What is seen of `source` in front of `backdrop`.
#[inline]
pub(crate) fn blend(mode: BlendMode, source: Pixel, backdrop: Pixel) -> Pixel {
    let ready = Source::new(mode, source);
    let mut seen = ready.before(backdrop, backdrop[3]);
    seen[3] = 1.0 - ready.through(1.0 - source[3], 1.0 - backdrop[3]);
    seen
}

/// Porter and Duff's `over`.
#[inline]
pub(crate) fn over(source: Pixel, backdrop: Pixel) -> Pixel {
    let through = 1.0 - source[3];
    std::array::from_fn(|i| source[i] + backdrop[i] * through)
}

/// A premultiplied colour of this alpha, not clear, as straight red, green and blue.
#[inline(always)]
fn straight(pixel: Pixel, alpha: f32) -> Pixel {
    each(|i| least(pixel[i] / alpha, 1.0))
}

/// All four components, without a loop.
#[inline(always)]
fn each(component: impl Fn(usize) -> f32) -> Pixel {
    [component(0), component(1), component(2), component(3)]
}

/// The lesser of two numbers. Both are numbers, so that one instruction does it, unlike [`f32::min`].
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b {
        a
    } else {
        b
    }
}

#[inline(always)]
fn most(a: f32, b: f32) -> f32 {
    if a > b {
        a
    } else {
        b
    }
}

fn multiply(s: f32, b: f32) -> f32 {
    s * b
}

fn screen(s: f32, b: f32) -> f32 {
    s + b - s * b
}

fn color_dodge(s: f32, b: f32) -> f32 {
    match (b, s) {
        (0.0, _) => 0.0,
        (_, 1.0) => 1.0,
        _ => least(b / (1.0 - s), 1.0),
    }
}

fn color_burn(s: f32, b: f32) -> f32 {
    match (b, s) {
        (1.0, _) => 1.0,
        (_, 0.0) => 0.0,
        _ => 1.0 - least((1.0 - b) / s, 1.0),
    }
}

fn hard_light(s: f32, b: f32) -> f32 {
    // Both are made, so that four components are one vector.
    let (dark, light) = (multiply(2.0 * s, b), screen(2.0 * s - 1.0, b));
    if s <= 0.5 {
        dark
    } else {
        light
    }
}

fn soft_light(s: f32, b: f32) -> f32 {
    // All are made, so that four components are one vector.
    let darkened = b - (1.0 - 2.0 * s) * b * (1.0 - b);
    let (cubic, root) = (((16.0 * b - 12.0) * b + 4.0) * b, b.sqrt());
    let lifted = if b <= 0.25 { cubic } else { root };
    let lightened = b + (2.0 * s - 1.0) * (lifted - b);
    if s <= 0.5 {
        darkened
    } else {
        lightened
    }
}

fn luminosity([r, g, b]: [f32; 3]) -> f32 {
    0.3 * r + 0.59 * g + 0.11 * b
}

fn saturation([r, g, b]: [f32; 3]) -> f32 {
    greatest([r, g, b]) - smallest([r, g, b])
}

#[inline(always)]
fn smallest([r, g, b]: [f32; 3]) -> f32 {
    least(least(r, g), b)
}

#[inline(always)]
fn greatest([r, g, b]: [f32; 3]) -> f32 {
    most(most(r, g), b)
}

/// The colour with its luminosity changed, drawn towards grey until it can be shown.
fn with_luminosity(color: [f32; 3], wanted: f32) -> [f32; 3] {
    let step = wanted - luminosity(color);
    let color = color.map(|v| v + step);
    let (smallest, greatest) = (smallest(color), greatest(color));
    let mut scale = 1.0;
    if smallest < 0.0 {
        scale = least(scale, wanted / (wanted - smallest));
    }
    if greatest > 1.0 {
        scale = least(scale, (1.0 - wanted) / (greatest - wanted));
    }
    color.map(|v| wanted + (v - wanted) * scale)
}

/// The colour with its components spread to this saturation, the least of them 0.
fn with_saturation(color: [f32; 3], wanted: f32) -> [f32; 3] {
    let (smallest, range) = (smallest(color), saturation(color));
    if range <= 0.0 {
        return [0.0; 3];
    }
    color.map(|v| (v - smallest) * (wanted / range))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::layer::premultiplied;

    const MODES: [(BlendMode, tiny_skia::BlendMode); 17] = [
        (BlendMode::Normal, tiny_skia::BlendMode::SourceOver),
        (BlendMode::Multiply, tiny_skia::BlendMode::Multiply),
        (BlendMode::Screen, tiny_skia::BlendMode::Screen),
        (BlendMode::Overlay, tiny_skia::BlendMode::Overlay),
        (BlendMode::Darken, tiny_skia::BlendMode::Darken),
        (BlendMode::Lighten, tiny_skia::BlendMode::Lighten),
        (BlendMode::ColorDodge, tiny_skia::BlendMode::ColorDodge),
        (BlendMode::ColorBurn, tiny_skia::BlendMode::ColorBurn),
        (BlendMode::HardLight, tiny_skia::BlendMode::HardLight),
        (BlendMode::SoftLight, tiny_skia::BlendMode::SoftLight),
        (BlendMode::Difference, tiny_skia::BlendMode::Difference),
        (BlendMode::Exclusion, tiny_skia::BlendMode::Exclusion),
        (BlendMode::Hue, tiny_skia::BlendMode::Hue),
        (BlendMode::Saturation, tiny_skia::BlendMode::Saturation),
        (BlendMode::Color, tiny_skia::BlendMode::Color),
        (BlendMode::Luminosity, tiny_skia::BlendMode::Luminosity),
        (BlendMode::PlusLighter, tiny_skia::BlendMode::Plus),
    ];

    /// Colours that meet every branch: ends, halves, equal components, all orders of size.
    fn colors() -> Vec<[u8; 4]> {
        let mut colors = Vec::new();
        for alpha in [0, 90, 255] {
            for [r, g, b] in [
                [0, 0, 0],
                [255, 255, 255],
                [255, 0, 0],
                [30, 200, 120],
                [200, 120, 30],
                [128, 128, 40],
                [60, 60, 60],
            ] {
                colors.push([r, g, b, alpha]);
            }
        }
        colors
    }

    /// Does the colour that is moved to another luminosity get a component below 0, or is it grey,
    /// where tiny-skia divides by 0?
    fn too_dark(mode: BlendMode, source: [u8; 4], backdrop: [u8; 4]) -> bool {
        let color = |c: [u8; 4]| [c[0], c[1], c[2]].map(|v| f32::from(v) / 255.0);
        let (source, backdrop) = (color(source), color(backdrop));
        let (moved, to) = match mode {
            BlendMode::Hue => (with_saturation(source, saturation(backdrop)), backdrop),
            BlendMode::Saturation => (with_saturation(backdrop, saturation(source)), backdrop),
            BlendMode::Color => (source, backdrop),
            BlendMode::Luminosity => (backdrop, source),
            _ => return false,
        };
        let least = moved.iter().fold(1.0f32, |least, &v| least.min(v));
        saturation(moved) == 0.0 || least + luminosity(to) - luminosity(moved) < 0.0
    }

    #[test]
    fn every_mode_agrees_with_tiny_skia_on_every_pair() {
        for (mode, theirs) in MODES {
            for source in colors() {
                for backdrop in colors() {
                    // What tiny-skia 0.12 draws towards grey because it is too dark, it does not: it
                    // asks whether the greatest component is negative, not the least.
                    if too_dark(mode, source, backdrop) {
                        continue;
                    }
                    let mut canvas = tiny_skia::Pixmap::new(1, 1).unwrap();
                    let color = |[r, g, b, a]: [u8; 4]| tiny_skia::Color::from_rgba8(r, g, b, a);
                    canvas.fill(color(backdrop));
                    let mut paint = tiny_skia::Paint {
                        blend_mode: theirs,
                        force_hq_pipeline: true,
                        ..Default::default()
                    };
                    paint.set_color(color(source));
                    let all = tiny_skia::Rect::from_xywh(0.0, 0.0, 1.0, 1.0).unwrap();
                    canvas.fill_rect(all, &paint, tiny_skia::Transform::identity(), None);
                    let unit = |c: [u8; 4]| premultiplied(c.map(|v| f32::from(v) / 255.0));
                    let ours = blend(mode, unit(source), unit(backdrop)).map(|v| v * 255.0);
                    for (ours, &theirs) in ours.iter().zip(canvas.data()) {
                        let off = (ours - f32::from(theirs)).abs();
                        assert!(
                            off < 2.1,
                            "{mode:?} of {source:?} over {backdrop:?}: {ours} is not {theirs}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn greys_take_luminosity_and_give_it() {
        let (white, black, red) = ([1.0; 4], [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(blend(BlendMode::Hue, black, white), white);
        assert_eq!(blend(BlendMode::Luminosity, black, white), black);
        assert_eq!(blend(BlendMode::Color, red, white), white);
        assert_eq!(blend(BlendMode::Saturation, white, red), [0.3, 0.3, 0.3, 1.0]);
        let half_black = [0.0, 0.0, 0.0, 0.5];
        assert_eq!(blend(BlendMode::Hue, half_black, white), white);
    }

    #[test]
    fn a_blended_pixel_is_a_pixel() {
        for (mode, _) in MODES {
            for source in colors() {
                for backdrop in colors() {
                    let unit = |c: [u8; 4]| premultiplied(c.map(|v| f32::from(v) / 255.0));
                    let [r, g, b, a] = blend(mode, unit(source), unit(backdrop));
                    assert!((0.0..=1.0).contains(&a));
                    assert!([r, g, b].iter().all(|v| (0.0..=a + 1e-6).contains(v)), "{mode:?}");
                }
            }
        }
    }
}
