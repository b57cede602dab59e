//! Against another renderer, sixteen times as large and filtered down. Its 4 x 4 samples become
//! 64 x 64, and its seams and fringes shrink to a sixteenth of a pixel's width: two or three levels.

use super::*;

const TIMES: u32 = 16;

/// The mean of 16 x 16 premultiplied pixels, in levels.
fn filtered_down(tree: &usvg::Tree, width: u32, height: u32) -> Vec<[f64; 4]> {
    let mut large = resvg::tiny_skia::Pixmap::new(width * TIMES, height * TIMES).expect("a size");
    let scale = resvg::tiny_skia::Transform::from_scale(TIMES as f32, TIMES as f32);
    resvg::render(tree, scale, &mut large.as_mut());
    let mut small = vec![[0.0; 4]; (width * height) as usize];
    for (at, pixel) in large.pixels().iter().enumerate() {
        let (x, y) = (at as u32 % large.width() / TIMES, at as u32 / large.width() / TIMES);
        let levels = [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()];
        let sum = &mut small[(y * width + x) as usize];
        for (sum, level) in sum.iter_mut().zip(levels) {
            *sum += f64::from(level) / f64::from(TIMES * TIMES);
        }
    }
    small
}

#[track_caller]
fn assert_agrees(name: &str, width: u32, height: u32, body: &str, most: f64, most_mean: f64) {
    let small = filtered_down(&tree(width, height, body), width, height);
    let truth = truth(width, height, body);
    let (mut worst, mut sum, mut at) = (0.0, 0.0, 0);
    for (number, (pixel, other)) in truth.premultiplied().iter().zip(&small).enumerate() {
        for channel in 0..4 {
            let error: f64 = (pixel[channel] - other[channel]).abs();
            sum += error;
            if error > worst {
                (worst, at) = (error, number as u32);
            }
        }
    }
    let mean = sum / (4.0 * small.len() as f64);
    let (x, y) = (at % width, at / width);
    println!("{name}: mean {mean:.3}, worst {worst:.3} levels at ({x}, {y})");
    assert!(worst < most && mean < most_mean, "{name}: mean {mean}, worst {worst} at ({x}, {y})");
}

#[test]
fn a_face_with_curves_and_strokes_agrees() {
    let body = "<circle cx='24' cy='24' r='20' fill='#fc3'/>
        <circle cx='17' cy='19' r='3.3'/><circle cx='31' cy='19' r='3.3'/>
        <path d='M13 29Q24 41 35 29' fill='none' stroke='#822' stroke-width='2.5' stroke-linecap='round'/>
        <path d='M10 12L18 9' stroke='#333' stroke-width='1.7' fill='none'/>
        <path d='M40 4l3 6l-6-3l7-1l-5 5z' fill='#35c' fill-rule='evenodd'/>";
    assert_agrees("face", 48, 48, body, 2.5, 0.1);
}

#[test]
fn clips_groups_and_opacity_agree() {
    let body = "<clipPath id='c'><circle cx='20' cy='20' r='15'/>
        <path clip-rule='evenodd' d='M2 2H38V38H2zM8 8H32V32H8z'/></clipPath>
        <g clip-path='url(#c)' opacity='.8'><rect width='40' height='40' fill='#27a'/>
        <path d='M0 40L40 0V40z' fill='#e80'/>
        <g transform='rotate(30 20 20)' opacity='.5'><rect x='10' y='10' width='20' height='20'/>
        <rect x='14' y='5' width='12' height='30' fill='#fff'/></g></g>
        <circle cx='32' cy='8' r='7' fill='#0a0' fill-opacity='.4' stroke='#040' stroke-width='1.5'
          stroke-opacity='.6' stroke-dasharray='3 2'/>";
    assert_agrees("clips", 40, 40, body, 2.5, 0.25);
}

#[test]
fn gradients_agree() {
    let body = "<linearGradient id='l' x1='.1' y1='0' x2='.4' y2='.3' spreadMethod='reflect'>
        <stop offset='.2' stop-color='#f40'/><stop offset='.9' stop-color='#06c' stop-opacity='.5'/>
        </linearGradient>
        <radialGradient id='r' fx='.3' fy='.35' gradientTransform='rotate(20) scale(1 .8)'>
        <stop stop-color='#fff'/><stop offset='.6' stop-color='#fb0'/><stop offset='1' stop-color='#421'/>
        </radialGradient>
        <path fill='url(#l)' d='M1 1H39L30 39H4z'/><circle cx='24' cy='22' r='13.5' fill='url(#r)'/>";
    // The worst is the pixel at the focus, where the colour bends within a pixel.
    assert_agrees("gradients", 40, 40, body, 16.0, 0.3);
}
