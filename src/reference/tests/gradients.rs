//! Gradients, by integrals in closed form.

use super::*;

const ALPHA: &str = "<stop stop-color='#fff' stop-opacity='0'/><stop offset='1' stop-color='#fff'/>";

/// A gradient in user units.
fn gradient(kind: &str, place: &str, stops: &str) -> String {
    format!("<{kind}Gradient id='g' gradientUnits='userSpaceOnUse' {place}>{stops}</{kind}Gradient>")
}

fn painted(kind: &str, place: &str, stops: &str, shape: &str) -> String {
    gradient(kind, place, stops) + shape
}

/// From black to white without a way between.
fn jump(offset: f64) -> String {
    format!("<stop offset='{offset}'/><stop offset='{offset}' stop-color='#fff'/>")
}

#[test]
fn a_jump_weighs_what_lies_before_and_after_it() {
    let shape = "<rect width='4' height='4' fill='url(#g)'/>";
    for (place, at) in [("x1='0' x2='4'", (2, 1)), ("x1='0' x2='0' y1='0' y2='4'", (1, 2))] {
        let body = painted("linear", place, &jump(0.5625), shape);
        assert_near(truth(4, 4, &body).straight(at.0, at.1)[0], 255.0 * 0.75, 1e-3);
    }
    let body = painted("linear", "x1='0' x2='4' y2='4'", &jump(0.5), shape);
    let t = truth(4, 4, &body);
    assert_near(t.straight(2, 1)[0], 127.5, 1e-3);
    assert_near(t.straight(1, 1)[0], 0.0, 1e-3);
}

#[test]
fn a_shapes_edge_and_a_jump_part_a_pixel_in_three() {
    let body = "<rect width='1' height='1' fill='#00f'/>".to_owned()
        + &painted("linear", "x1='0' x2='1'", &jump(0.25), "<path d='M0 0H.5V1H0z' fill='url(#g)'/>");
    let t = truth(1, 1, &body);
    assert_near(t.straight(0, 0)[0], 255.0 * 0.25, 1e-4);
    assert_near(t.straight(0, 0)[2], 255.0 * 0.75, 1e-4);
}

#[test]
fn colours_that_fade_are_averaged_times_their_alpha() {
    // Red and alpha both are t: the mean of t t over a pixel is 1/3.
    let stops = "<stop stop-opacity='0'/><stop offset='1' stop-color='#f00'/>";
    let body = painted("linear", "x1='0' x2='1'", stops, "<rect width='1' height='1' fill='url(#g)'/>");
    let t = truth(1, 1, &body);
    assert_near(t.premultiplied()[0][0], 255.0 / 3.0, 1e-6);
    assert_near(t.premultiplied()[0][3], 127.5, 1e-6);
}

#[test]
fn one_gradient_over_another_is_composited_before_the_pixel_is_averaged() {
    // White and opaque where the one below is black: no black is left.
    let upper = "<linearGradient id='h' gradientUnits='userSpaceOnUse' x1='0' x2='1'>
        <stop offset='.5' stop-color='#fff'/><stop offset='.5' stop-opacity='0'/></linearGradient>";
    let shapes = "<rect width='1' height='1' fill='url(#g)'/><rect width='1' height='1' fill='url(#h)'/>";
    let body = upper.to_owned() + &painted("linear", "x1='0' x2='1'", &jump(0.5), shapes);
    assert_near(truth(1, 1, &body).straight(0, 0)[0], 255.0, 1e-4);
}

#[test]
fn a_fan_of_alpha_sums_to_its_volume() {
    // Alpha grows from 0 in the middle to 1 at a distance of 4: the missing part is a cone.
    let shape = "<rect width='10' height='10' fill='url(#g)'/>";
    let t = truth(10, 10, &painted("radial", "cx='5' cy='5' r='4'", ALPHA, shape));
    assert_near(area(&t), 100.0 - std::f64::consts::PI * 16.0 / 3.0, 1e-3);
}

#[test]
fn a_disk_by_a_jump_has_the_area_of_a_disk() {
    let shape = "<rect width='10' height='10' fill='url(#g)'/>";
    let stops = "<stop offset='.5' stop-color='#fff'/><stop offset='.5' stop-opacity='0'/>";
    let t = truth(10, 10, &painted("radial", "cx='5.3' cy='4.9' r='6.2' fx='5' fy='6'", stops, shape));
    assert_near(area(&t), std::f64::consts::PI * 3.1 * 3.1, 1e-3);
}

#[test]
fn beyond_a_cone_there_is_no_colour() {
    // Its half angle is that of the circle of radius 4 seen from 8 away: 30 degrees.
    let shape = "<rect width='6' height='8' fill='url(#g)'/>";
    let stops = "<stop/><stop offset='1' stop-color='#fff'/>";
    let t = truth(6, 8, &painted("radial", "cx='8' cy='4' r='4' fx='0' fy='4'", stops, shape));
    assert_near(area(&t), 36.0 / 3f64.sqrt(), 1e-3);
}

#[test]
fn what_repeats_many_times_in_a_pixel_is_its_mean_nearly() {
    let shape = "<rect width='2' height='2' fill='url(#g)'/>";
    for x2 in [0.1, 0.002] {
        let place = format!("x1='0' x2='{x2}' spreadMethod='repeat'");
        let viewport = Viewport { width: 2, height: 2, transform: Affine::IDENTITY };
        let tree =
            tree(2, 2, &painted("linear", &place, "<stop/><stop offset='1' stop-color='#fff'/>", shape));
        let t = render(&tree, &viewport, &Options::default()).expect("a picture");
        // It is sampled there, at 64 places along each side.
        assert_near(t.straight(1, 1)[0], 127.5, 0.5);
    }
}

/// Random gradients, one of them half transparent, over a few shapes.
fn scene(dice: &mut Dice) -> String {
    let mut body = String::new();
    for number in 0..3 {
        let mut at = |from: f64, to: f64| dice.real(from, to) as f32;
        let place = match number % 2 {
            0 => format!(
                "x1='{}' y1='{}' x2='{}' y2='{}'",
                at(0.0, 6.0),
                at(0.0, 6.0),
                at(0.0, 6.0),
                at(0.0, 6.0)
            ),
            _ => format!(
                "cx='{}' cy='{}' r='{}' fx='{}' fy='{}' fr='{}'",
                at(2.0, 4.0),
                at(2.0, 4.0),
                at(2.0, 4.0),
                at(2.0, 4.0),
                at(2.0, 4.0),
                at(0.0, 0.5)
            ),
        };
        let kind = ["linear", "radial"][number % 2];
        let spread = ["pad", "repeat", "reflect"][dice.whole(0, 3) as usize];
        let mut stops = String::new();
        for offset in [0.1, 0.4, 0.4, 1.0] {
            let level = dice.whole(0, 256);
            let opacity = if number == 1 { dice.real(0.0, 1.0) } else { 1.0 };
            stops += &format!(
                "<stop offset='{offset}' stop-color='rgb({level},{},0)' stop-opacity='{opacity}'/>",
                255 - level
            );
        }
        let id = format!("id='g{number}'");
        body += &gradient(kind, &format!("{place} spreadMethod='{spread}'"), &stops).replace("id='g'", &id);
        let mut at = || dice.real(0.0, 6.0) as f32;
        body += &format!("<path fill='url(#g{number})' d='M{} {}L{} {}L6 0z'/>", at(), at(), at(), at());
    }
    body
}

#[test]
fn a_pixel_is_the_mean_of_the_sixty_four_within_it() {
    let mut dice = Dice(1978);
    let mut worst: f64 = 0.0;
    for _ in 0..12 {
        let tree = tree(6, 6, &scene(&mut dice));
        let picture = |times: u32| {
            let transform = Affine::scale(times.into());
            let viewport = Viewport { width: 6 * times, height: 6 * times, transform };
            render(&tree, &viewport, &Options::default()).expect("a picture")
        };
        let (small, large) = (picture(1), picture(8));
        for (at, pixel) in small.premultiplied().iter().enumerate() {
            let within = |i: usize| large.premultiplied()[(at / 6 * 8 + i / 8) * 48 + at % 6 * 8 + i % 8];
            for (channel, level) in pixel.iter().enumerate() {
                let mean = (0..64).map(|i| within(i)[channel]).sum::<f64>() / 64.0;
                worst = worst.max((level - mean).abs());
            }
        }
    }
    println!("worst difference from finer pixels: {worst:.4} levels");
    assert!(worst < 0.05, "{worst} levels");
}

#[test]
fn a_jump_that_only_comes_near_the_border_of_a_gradient_is_seen() {
    let shape = "<rect width='8' height='2' fill='url(#g)'/>";
    // Circles of radius 50 that run to the right below y = .2: of the row's pixels a fifth. In the one that ends where
    // the circle of the jump touches that line there is black only between the two.
    let place = "cx='10' cy='-49.8' r='50' fx='0' fy='-49.8' fr='50'";
    let row = truth(8, 2, &painted("radial", place, &jump(0.5), shape)).straight(4, 0);
    let area = |u: f64| 0.5 * (u * (2500.0 - u * u).max(0.0).sqrt() + 2500.0 * (u / 50.0).asin());
    let (from, to) = (2499f64.sqrt(), 50.0);
    let black = (to - from) - (area(to) - area(from));
    assert_near(row[3], 0.2 * 255.0, 1e-3);
    assert_near(row[0], 255.0 * (1.0 - black / 0.2), 0.05);
    // All circles touch x = 2 in the focus, and that of the jump has radius 25: white lies between them.
    let place = "cx='-48' cy='3' r='50' fx='2' fy='3'";
    let pixel = truth(8, 2, &painted("radial", place, &jump(0.5), shape)).straight(1, 1);
    let area = |u: f64| 0.5 * (u * (625.0 - u * u).sqrt() + 625.0 * (u / 25.0).asin());
    let white = 25.0 - (area(2.0) - area(1.0));
    assert_near(pixel[0], 255.0 * white, 1e-2);
}
