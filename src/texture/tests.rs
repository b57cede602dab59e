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

/// Columns of any grey.
fn any_columns(width: u32, height: u32) -> Image {
    image(width, height, |x, _| {
        let v = (x.wrapping_mul(2_654_435_761) >> 24) as u8;
        [v, v, v, 255]
    })
}

/// Transforms that make an image smaller, and the mean difference in 8-bit levels that detail may have, and
/// that columns of one texel may have.
fn ways() -> Vec<(&'static str, Affine, f64, f64)> {
    let scaled = |x: f64, y: f64| Affine::scale_non_uniform(x, y);
    let turned = |degrees: f64, scale: f64| Affine::rotate(degrees.to_radians()) * Affine::scale(scale);
    let skewed = |x: f64, y: f64, scale: f64| Affine::skew(x, y) * Affine::scale(scale);
    vec![
        ("4 times down", scaled(0.25, 0.25), 0.001, 0.001),
        ("3.3 times down", scaled(0.3, 0.3).then_translate((0.4, 0.7).into()), 0.001, 0.001),
        ("a little down", scaled(0.9, 0.9).then_translate((0.4, 0.7).into()), 0.001, 0.001),
        ("down across, up along", scaled(0.2, 1.7), 0.9, 0.001),
        ("mirrored", Affine::new([-0.4, 0.0, 0.0, 0.35, 30.0, 1.0]), 0.001, 0.001),
        ("turned by 30", turned(30.0, 0.4), 0.8, 2.5),
        ("turned by 45", turned(45.0, 0.4), 1.6, 4.2),
        ("turned by 75", turned(75.0, 0.4), 0.4, 1.6),
        ("turned by 230, a little down", turned(230.0, 0.66), 1.3, 14.0),
        ("on its side", turned(90.0, 0.3), 0.001, 0.001),
        ("on its other side", turned(-90.0, 0.3), 0.001, 0.001),
        ("at its size, turned by 30", turned(30.0, 1.0), 1.5, 18.0),
        ("skewed", skewed(0.5, 0.0, 0.3), 0.3, 0.75),
        ("skewed by 2", skewed(2.0, 0.0, 0.5), 0.001, 0.001),
        ("skewed much", skewed(4.0, 0.0, 0.5), 0.001, 0.001),
        ("skewed much and small", skewed(4.0, 0.0, 0.3), 0.1, 0.1),
        ("skewed by 12", skewed(12.0, 0.0, 0.3), 0.1, 0.1),
        ("skewed downward", skewed(0.0, 4.0, 0.5), 1.3, 3.0),
        ("skewed both ways", Affine::skew(0.3, -0.4) * scaled(0.2, 0.6), 0.9, 2.4),
        ("skewed, then turned", turned(30.0, 0.5) * Affine::skew(3.0, 0.0), 0.3, 0.5),
        ("to a hundredth across", scaled(0.01, 1.0), 0.001, 0.001),
        ("turned, then to a 20th across", scaled(0.05, 1.0) * Affine::rotate(0.7), 0.3, 1.5),
        ("to a 20th across and up along, then turned", turned(30.0, 1.0) * scaled(0.05, 3.0), 1.3, 1.0),
    ]
}

/// All pixels that an image touches.
fn around(image: &Image, to_pixels: Affine) -> IntRect {
    IntRect::around(to_pixels.transform_rect_bbox(image.rect().to_rect()))
}

/// Of a pixel's parallelogram in the image: the share of it that lies in the image, and the integral of the
/// image's squares over that.
fn exact(image: &Image, back: Affine, (x, y): (i32, i32)) -> (f64, [f64; 4]) {
    let corners = IntRect::new(x, y, 1, 1).to_rect();
    let corners = [
        (corners.x0, corners.y0),
        (corners.x1, corners.y0),
        (corners.x1, corners.y1),
        (corners.x0, corners.y1),
    ];
    let corners: Vec<Point> = corners.into_iter().map(|corner| back * Point::from(corner)).collect();
    let all = area(&corners);
    let (mut inside, mut sum) = (0.0, [0.0; 4]);
    for row in seen(corners.iter().map(|at| at.y), image.rect().height()) {
        let slab = cut(&cut(&corners, |at| at.y - row as f64), |at| row as f64 + 1.0 - at.y);
        for column in seen(slab.iter().map(|at| at.x), image.rect().width()) {
            let piece = cut(&cut(&slab, |at| at.x - column as f64), |at| column as f64 + 1.0 - at.x);
            let share = area(&piece) / all;
            inside += share;
            sum.iter_mut().zip(image.pixel(column, row)).for_each(|(sum, v)| *sum += share * f64::from(v));
        }
    }
    (inside, sum)
}

/// The texels in which numbers lie.
fn seen(numbers: impl Iterator<Item = f64>, texels: usize) -> std::ops::Range<usize> {
    let (from, to) = numbers.fold((f64::MAX, 0.0f64), |(from, to), v| (from.min(v), to.max(v)));
    from.max(0.0) as usize..(to.ceil() as usize).min(texels)
}

/// The part of a polygon where a linear function is positive (Sutherland and Hodgman 1974).
fn cut(polygon: &[Point], depth: impl Fn(&Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::new();
    for (i, &to) in polygon.iter().enumerate() {
        let from = polygon[(i + polygon.len() - 1) % polygon.len()];
        let (one, other) = (depth(&from), depth(&to));
        if (one > 0.0) != (other > 0.0) {
            kept.push(from.lerp(to, one / (one - other)));
        }
        if other > 0.0 {
            kept.push(to);
        }
    }
    kept
}

fn area(polygon: &[Point]) -> f64 {
    let last = polygon.last().copied().unwrap_or_default();
    let before = std::iter::once(last).chain(polygon.iter().copied());
    let crosses = before.zip(polygon).map(|(one, other)| one.to_vec2().cross(other.to_vec2()));
    (0.5 * crosses.sum::<f64>()).abs()
}

/// The mean and the largest difference in 8-bit levels between a drawn image and the exact mean of its squares
/// over each pixel, both times how much of the pixel the image covers.
fn off(image: &Image, to_pixels: Affine, nearest: bool) -> (f64, f64) {
    let rect = around(image, to_pixels);
    let layer = drawn(image, to_pixels, rect, nearest);
    let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0);
    for y in rect.y()..rect.bottom() {
        for x in rect.x()..rect.right() {
            let (inside, exact) = exact(image, to_pixels.inverse(), (x, y));
            for (found, exact) in layer.pixel(x, y).into_iter().zip(exact) {
                let off = (f64::from(found) * inside - exact).abs() * 255.0;
                (sum, worst) = (sum + off, worst.max(off));
                count += i32::from(inside > 1e-9);
            }
        }
    }
    (sum / f64::from(count), worst)
}

#[test]
fn an_image_made_smaller_is_near_the_mean_of_its_squares_over_each_pixel() {
    let (detailed, columns, any_columns) = (detailed(120, 100), columns(120, 100), any_columns(120, 100));
    for (name, to_pixels, of_detail, of_columns) in ways() {
        for (image, bound) in [(&detailed, of_detail), (&columns, of_columns), (&any_columns, of_columns)] {
            let (mean, worst) = off(image, to_pixels, false);
            println!("{name}: {mean:.3}, at worst {worst:.1}, up to {bound}");
            assert!(mean < bound, "{name}: {mean}");
        }
    }
}

/// Discs and rings on white, with holes, and fine stripes.
fn drawing(width: u32, height: u32) -> Image {
    image(width, height, |x, y| {
        let (cell, radius) = ((x / 90 * 5 + y / 90 * 3), f64::from(x % 90).hypot(f64::from(y % 90) - 40.0));
        match radius {
            r if r > 60.0 && cell.is_multiple_of(4) => [0; 4],
            r if r > 60.0 => [255; 4],
            r if r > 50.0 => [0, 0, 0, 255],
            _ if cell.is_multiple_of(3) => [(x % 2 * 255) as u8, 200, 60, 255],
            _ => [200, (cell * 31) as u8, 90, 255],
        }
    })
}

#[test]
fn an_image_read_from_a_level_is_near_the_mean_of_its_squares_over_each_pixel() {
    // Sides that are no multiple of anything.
    let (drawing, detailed) = (drawing(1021, 797), detailed(1021, 797));
    for (name, scale) in [("64", 64.0), ("79", 79.3), ("300", 300.0)] {
        for degrees in [0.0, 25.0, 200.0] {
            let to_pixels = Affine::translate((3.3, 1.6))
                * Affine::rotate(f64::to_radians(degrees))
                * Affine::scale(1.0 / scale);
            for image in [&drawing, &detailed] {
                assert!(levels::level_for(spot(to_pixels.inverse()), image) >= 2);
                let (mean, worst) = off(image, to_pixels, false);
                println!("{name} times down, turned by {degrees}: {mean:.3}, at worst {worst:.1}");
                assert!(mean < 0.6 && worst < 5.0, "{name}, {degrees}: {mean}, {worst}");
            }
        }
    }
}

#[test]
fn what_was_drawn_before_changes_nothing() {
    let (fresh, used) = (drawing(700, 530), drawing(700, 530));
    let scales = [0.004, 0.015, 0.0071, 0.1, 0.0139];
    for scale in scales {
        drawn(&used, Affine::scale(scale), IntRect::new(0, 0, 20, 20), false);
    }
    for scale in scales {
        let place =
            |image: &Image| drawn(&image.clone(), Affine::scale(scale), IntRect::new(0, 0, 20, 20), false);
        assert_eq!(place(&fresh), place(&used), "{scale}");
    }
}

#[test]
fn squares_made_smaller_are_their_exact_mean_also_where_they_are_enlarged_along() {
    let image = detailed(120, 100);
    for to_pixels in [
        Affine::scale_non_uniform(0.01, 1.0),
        Affine::scale_non_uniform(0.07, 3.3).then_translate((0.3, 0.6).into()),
        Affine::scale(0.023),
        Affine::scale_non_uniform(2.7, 0.21) * Affine::rotate(std::f64::consts::FRAC_PI_2),
    ] {
        let (mean, worst) = off(&image, to_pixels, true);
        println!("{to_pixels:?}: {mean:.4}, at worst {worst:.3}");
        assert!(worst < 0.01, "{to_pixels:?}: {mean}, {worst}");
    }
}

#[test]
fn images_of_one_row_or_one_pixel_are_drawn() {
    let row = image(1000, 1, |x, _| if x < 500 { [255; 4] } else { [0, 0, 0, 255] });
    let column = image(1, 1000, |_, y| if y < 500 { [255; 4] } else { [0, 0, 0, 255] });
    for (image, to_pixels) in [
        (&row, Affine::scale_non_uniform(0.01, 10.0)),
        (&column, Affine::scale_non_uniform(10.0, 0.01)),
        (&row, Affine::rotate(0.3) * Affine::scale_non_uniform(0.01, 10.0)),
        (&column, Affine::rotate(0.3) * Affine::scale_non_uniform(10.0, 0.01)),
        (&row, Affine::scale_non_uniform(0.01, 0.1)),
        (&column, Affine::scale_non_uniform(1e-3, 1e-3)),
    ] {
        let (mean, worst) = off(image, to_pixels, false);
        assert!(mean < 0.4 && worst < 9.0, "{to_pixels:?}: {mean}, {worst}");
    }
    let dot = image(1, 1, |_, _| [200, 100, 50, 255]);
    for to_pixels in [Affine::scale(9.0), Affine::rotate(1.0) * Affine::scale(0.3), Affine::skew(5.0, 0.0)] {
        let (_, worst) = off(&dot, to_pixels, false);
        assert!(worst < 0.01, "{to_pixels:?}: {worst}");
    }
}

#[test]
fn an_opaque_white_image_is_so_up_to_its_edges_and_a_pixel_beyond() {
    let image = image(60, 50, |_, _| [255; 4]);
    for (name, to_pixels, ..) in ways() {
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
    for (name, to_pixels, ..) in ways() {
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
