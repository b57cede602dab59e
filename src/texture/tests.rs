use super::*;

fn image(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Image {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Image::new(width, height, places.flat_map(|(x, y)| pixel(x, y)).collect())
}

/// Columns of white and black.
fn columns(width: u32, height: u32) -> Image {
    image(width, height, |x, _| if x.is_multiple_of(2) { [255; 4] } else { [0, 0, 0, 255] })
}

/// Fine and coarse detail, and holes.
fn detailed(width: u32, height: u32) -> Image {
    image(width, height, |x, y| {
        let alpha = if (x / 9 + y / 7).is_multiple_of(3) { (x * 5) as u8 } else { 255 };
        [(x * 7) as u8, ((x * x + y * y) / 90) as u8, ((x ^ y) * 3) as u8, alpha]
    })
}

/// Transforms that make an image smaller, and the mean difference in 8-bit levels that detail may have.
fn ways() -> Vec<(&'static str, Affine, f64)> {
    let turned = |degrees: f64, scale: f64| Affine::rotate(degrees.to_radians()) * Affine::scale(scale);
    vec![
        ("4 times down", Affine::scale(0.25), 0.001),
        ("3.3 times down", Affine::scale(0.3).then_translate((0.4, 0.7).into()), 0.8),
        ("a little down", Affine::scale(0.9).then_translate((0.4, 0.7).into()), 0.5),
        ("down across, up along", Affine::scale_non_uniform(0.2, 1.7), 2.0),
        ("mirrored", Affine::new([-0.4, 0.0, 0.0, 0.35, 30.0, 1.0]), 0.8),
        ("turned by 30", turned(30.0, 0.4), 1.0),
        ("turned by 45", turned(45.0, 0.4), 1.8),
        ("turned by 75", turned(75.0, 0.4), 0.5),
        ("turned by 230, a little down", turned(230.0, 0.66), 2.8),
        ("on its side", turned(90.0, 0.3), 1.1),
        ("on its other side", turned(-90.0, 0.3), 1.1),
        ("at its size, turned by 30", turned(30.0, 1.0), 1.6),
        ("skewed", Affine::skew(0.5, 0.0) * Affine::scale(0.3), 0.8),
        ("skewed much", Affine::skew(4.0, 0.0) * Affine::scale(0.5), 1.0),
        ("skewed both ways", Affine::skew(0.3, -0.4) * Affine::scale_non_uniform(0.2, 0.6), 1.2),
    ]
}

/// All pixels that an image touches.
fn around(image: &Image, to_pixels: Affine) -> IntRect {
    IntRect::around(to_pixels.transform_rect_bbox(image.rect().to_rect()))
}

/// Of 16 x 16 points of a pixel, those in the image, and what they add up to.
fn points(image: &Image, back: Affine, (x, y): (i32, i32)) -> (f64, [f64; 4]) {
    let (mut inside, mut sum) = (0.0, [0.0; 4]);
    for i in 0..256 {
        let (dx, dy) = (f64::from(i % 16) + 0.5, f64::from(i / 16) + 0.5);
        let at = back * Point::new(f64::from(x) + dx / 16.0, f64::from(y) + dy / 16.0);
        if image.rect().to_rect().contains(at) {
            let pixel = image.pixel(at.x as usize, at.y as usize);
            sum.iter_mut().zip(pixel).for_each(|(sum, v)| *sum += f64::from(v));
            inside += 1.0;
        }
    }
    (inside, sum)
}

#[test]
fn an_image_made_smaller_is_near_the_mean_of_many_points_of_each_pixel() {
    let image = detailed(120, 100);
    for (name, to_pixels, bound) in ways() {
        let rect = around(&image, to_pixels);
        let layer = drawn(&image, to_pixels, rect, false);
        let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0);
        for y in rect.y()..rect.bottom() {
            for x in rect.x()..rect.right() {
                let (inside, points) = points(&image, to_pixels.inverse(), (x, y));
                // As much of the pixel as the image covers.
                for (found, points) in layer.pixel(x, y).into_iter().zip(points) {
                    let off = (f64::from(found) * inside - points).abs() * 255.0 / 256.0;
                    (sum, worst) = (sum + off, worst.max(off));
                    count += if inside > 0.0 { 1 } else { 0 };
                }
            }
        }
        let mean = sum / f64::from(count);
        println!("{name}: {mean:.3}, at worst {worst:.1}");
        assert!(mean < bound, "{name}: {mean}");
    }
}

#[test]
fn an_opaque_white_image_is_so_up_to_its_edges_and_a_pixel_beyond() {
    let image = image(60, 50, |_, _| [255; 4]);
    for (name, to_pixels, _) in ways() {
        let whole = around(&image, to_pixels).grown(1, 1);
        let part = IntRect::new(whole.x() + 3, whole.y() + 2, 7, 5);
        for rect in [whole, part] {
            let layer = drawn(&image, to_pixels, rect, false);
            let seen = image.rect().to_rect();
            for y in rect.y()..rect.bottom() {
                for x in rect.x()..rect.right() {
                    let pixel = IntRect::new(x, y, 1, 1).to_rect().inflate(0.5, 0.5);
                    let at = to_pixels.inverse() * pixel.center();
                    // The nearest point of the image, brought back, lies within the pixel's reach.
                    let nearest = to_pixels * at.clamped(seen);
                    if pixel.contains(nearest) {
                        let found = layer.pixel(x, y);
                        let white = found.iter().all(|v| (v - 1.0).abs() < 1e-4) && found[3] == 1.0;
                        assert!(white, "{name}: {found:?} at {x}, {y}");
                    }
                }
            }
        }
    }
}

trait Clamped {
    fn clamped(self, rect: kurbo::Rect) -> Self;
}

impl Clamped for Point {
    fn clamped(self, rect: kurbo::Rect) -> Point {
        Point::new(self.x.clamp(rect.x0, rect.x1), self.y.clamp(rect.y0, rect.y1))
    }
}

#[test]
fn a_part_of_the_picture_has_the_pixels_of_the_whole() {
    let image = detailed(90, 70);
    for (name, to_pixels, _) in ways() {
        let rect = around(&image, to_pixels);
        let whole = drawn(&image, to_pixels, rect, false);
        let corner = (rect.x() + rect.width() as i32 / 3, rect.y() + rect.height() as i32 / 3);
        let part = IntRect::new(corner.0, corner.1, 6, 5).intersect(rect);
        let layer = drawn(&image, to_pixels, part, false);
        for y in part.y()..part.bottom() {
            for x in part.x()..part.right() {
                for (one, other) in layer.pixel(x, y).into_iter().zip(whole.pixel(x, y)) {
                    assert!((one - other).abs() < 1e-5, "{name}: {one}, not {other}, at {x}, {y}");
                }
            }
        }
    }
}

#[test]
fn an_image_at_its_own_size_is_itself() {
    let image = detailed(60, 40);
    let layer = Layer::from_rgba8(image.rect(), image.bytes());
    assert_eq!(drawn(&image, Affine::IDENTITY, image.rect(), false), layer);
    assert_eq!(drawn(&image, Affine::IDENTITY, image.rect(), true), layer);
    let rect = IntRect::new(20, -5, 30, 30);
    let moved = drawn(&image, Affine::translate((-7.0, 3.0)), rect, false);
    assert_eq!(moved, layer.moved_over_rect(-7, 3, rect));
}

#[test]
fn stripes_finer_than_a_pixel_are_their_mean() {
    let image = columns(64, 64);
    let small = drawn(&image, Affine::scale(0.125), IntRect::new(0, 0, 8, 8), false);
    for pixel in small.pixels() {
        assert!((pixel[0] - 0.5).abs() < 1e-6, "{pixel:?}");
    }
    // Also where the footprint holds no whole number of stripes: no beat is left in the middle.
    let odd = drawn(&image, Affine::scale(0.03), IntRect::new(0, 0, 2, 2), false);
    assert!((odd.pixel(0, 0)[0] - 0.5).abs() < 0.02, "{:?}", odd.pixel(0, 0));
}

#[test]
fn sums_of_a_very_long_row_do_not_overflow() {
    let image = image(200_000, 1, |x, _| if x.is_multiple_of(2) { [255, 255, 255, 254] } else { [255; 4] });
    let small =
        drawn(&image, Affine::scale_non_uniform(1.0 / 200_000.0, 1.0), IntRect::new(0, 0, 1, 1), false);
    for v in small.pixel(0, 0) {
        assert!((v - 254.5 / 255.0).abs() < 1e-5, "{v}");
    }
}

#[test]
fn an_enlarged_image_lies_between_its_samples_or_repeats_them() {
    let image = columns(2, 1);
    for to_pixels in [Affine::scale(4.0), Affine::rotate(1e-4) * Affine::scale(4.0)] {
        let smooth = drawn(&image, to_pixels, IntRect::new(0, 0, 8, 4), false);
        assert_eq!(smooth.pixel(0, 0)[0], 1.0);
        assert!((smooth.pixel(3, 1)[0] - 0.625).abs() < 1e-3);
    }
    let jagged = drawn(&image, Affine::scale(4.0), IntRect::new(0, 0, 8, 4), true);
    assert_eq!((jagged.pixel(3, 1)[0], jagged.pixel(4, 1)[0]), (1.0, 0.0));
}

#[test]
fn absurd_transforms_end_soon_and_make_pixels() {
    let image = detailed(30, 20);
    let rect = IntRect::new(0, 0, 40, 40);
    for to_pixels in [
        Affine::scale(1e-12),
        Affine::scale(1e-200),
        Affine::scale_non_uniform(1e-12, 1e9),
        Affine::skew(1e9, 0.0),
        Affine::skew(0.5, 1e9),
        Affine::rotate(1.0) * Affine::scale_non_uniform(1e-9, 1e3),
        Affine::rotate(0.5).then_translate((1e15, -1e18).into()),
        Affine::translate((1e300, 0.5)),
    ] {
        for pixel in drawn(&image, to_pixels, rect, false).pixels() {
            let [r, g, b, a] = *pixel;
            assert!((0.0..=1.0).contains(&a) && r.max(g).max(b) <= a && r.min(g).min(b) >= 0.0, "{pixel:?}");
        }
    }
}
