//! Takes two colours, makes the one that a group of a blend mode leaves (Compositing and Blending 1).

use super::Colour;
use usvg::BlendMode;

/// Red, green and blue without alpha, each 0..=1.
type Rgb = [f64; 3];

/// `front` over `back`, both premultiplied; where they overlap their colours meet by `mode`.
pub(super) fn blended(mode: BlendMode, front: Colour, back: Colour) -> Colour {
    if mode == BlendMode::PlusLighter {
        return std::array::from_fn(|c| (front[c] + back[c]).min(1.0));
    }
    let (front_alpha, back_alpha) = (front[3], back[3]);
    let mixed = if front_alpha > 0.0 && back_alpha > 0.0 {
        mix(mode, straight(back), straight(front))
    } else {
        [0.0; 3]
    };
    let colour = |c: usize| {
        front[c] * (1.0 - back_alpha) + back[c] * (1.0 - front_alpha) + front_alpha * back_alpha * mixed[c]
    };
    [colour(0), colour(1), colour(2), front_alpha + back_alpha * (1.0 - front_alpha)]
}

fn straight([r, g, b, a]: Colour) -> Rgb {
    [r / a, g / a, b / a].map(|c| c.clamp(0.0, 1.0))
}

/// B(cb, cs) of the specification.
fn mix(mode: BlendMode, back: Rgb, front: Rgb) -> Rgb {
    match mode {
        BlendMode::Hue => with_luminosity(with_saturation(front, saturation(back)), luminosity(back)),
        BlendMode::Saturation => with_luminosity(with_saturation(back, saturation(front)), luminosity(back)),
        BlendMode::Color => with_luminosity(front, luminosity(back)),
        BlendMode::Luminosity => with_luminosity(back, luminosity(front)),
        _ => std::array::from_fn(|c| mix_channel(mode, back[c], front[c])),
    }
}

fn mix_channel(mode: BlendMode, back: f64, front: f64) -> f64 {
    let screen = |a: f64, b: f64| a + b - a * b;
    let hard_light = |back: f64, front: f64| {
        if front <= 0.5 {
            back * 2.0 * front
        } else {
            screen(back, 2.0 * front - 1.0)
        }
    };
    match mode {
        BlendMode::Multiply => back * front,
        BlendMode::Screen => screen(back, front),
        BlendMode::Overlay => hard_light(front, back),
        BlendMode::Darken => back.min(front),
        BlendMode::Lighten => back.max(front),
        BlendMode::ColorDodge if back == 0.0 => 0.0,
        BlendMode::ColorDodge if front == 1.0 => 1.0,
        BlendMode::ColorDodge => (back / (1.0 - front)).min(1.0),
        BlendMode::ColorBurn if back == 1.0 => 1.0,
        BlendMode::ColorBurn if front == 0.0 => 0.0,
        BlendMode::ColorBurn => 1.0 - ((1.0 - back) / front).min(1.0),
        BlendMode::HardLight => hard_light(back, front),
        BlendMode::SoftLight if front <= 0.5 => back - (1.0 - 2.0 * front) * back * (1.0 - back),
        BlendMode::SoftLight => {
            let lighter = if back <= 0.25 { ((16.0 * back - 12.0) * back + 4.0) * back } else { back.sqrt() };
            back + (2.0 * front - 1.0) * (lighter - back)
        }
        BlendMode::Difference => (back - front).abs(),
        BlendMode::Exclusion => back + front - 2.0 * back * front,
        BlendMode::Normal
        | BlendMode::PlusLighter
        | BlendMode::Hue
        | BlendMode::Saturation
        | BlendMode::Color
        | BlendMode::Luminosity => front,
    }
}

fn luminosity([r, g, b]: Rgb) -> f64 {
    0.3 * r + 0.59 * g + 0.11 * b
}

fn least(colour: Rgb) -> f64 {
    colour.into_iter().fold(f64::INFINITY, f64::min)
}

fn most(colour: Rgb) -> f64 {
    colour.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

fn saturation(colour: Rgb) -> f64 {
    most(colour) - least(colour)
}

/// The colour moved to a luminosity, and towards grey of that until it is one.
fn with_luminosity(colour: Rgb, wanted: f64) -> Rgb {
    let by = wanted - luminosity(colour);
    let mut colour = colour.map(|c| c + by);
    let (least, most) = (least(colour), most(colour));
    if least < 0.0 {
        colour = colour.map(|c| wanted + (c - wanted) * wanted / (wanted - least));
    }
    if most > 1.0 {
        colour = colour.map(|c| wanted + (c - wanted) * (1.0 - wanted) / (most - wanted));
    }
    colour
}

/// The colour stretched from 0 to a saturation; a grey becomes black.
fn with_saturation(colour: Rgb, wanted: f64) -> Rgb {
    let (least, range) = (least(colour), saturation(colour));
    colour.map(|c| if range > 0.0 { (c - least) / range * wanted } else { 0.0 })
}
