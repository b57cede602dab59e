//! No seam through an effect: shapes that abut under one effect, beside their complement, or across a
//! group's border, held against the analytic area of every region at many angles and offsets.

use toon_raster::{Options, Pixmap, Renderer, Scene, Settings, Viewport};

const SIDE: u32 = 12;

/// 8-bit levels that a premultiplied component may be off by: half a level of rounding, once in colour and
/// once in alpha, and a quarter in the mean.
const TOLERANCE: f64 = 1.25;

fn render(body: &str) -> Pixmap {
    let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' width='{SIDE}' height='{SIDE}'>{body}</svg>");
    let scene = Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing");
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    let mut renderer = Renderer::new(Settings { threads: 1, ..Settings::default() }).expect("a renderer");
    renderer.render(&scene, &Viewport::fit(&scene, SIDE, SIDE)).expect("a picture")
}

type Point = (f64, f64);

/// A straight border across the picture. A point is inside where its distance is not negative.
#[derive(Clone, Copy)]
struct Border {
    a: f64,
    b: f64,
    c: f64,
}

impl Border {
    /// Turned by an angle in degrees, `off` pixels from the picture's middle.
    fn new(degrees: f64, off: f64) -> Border {
        let (b, a) = degrees.to_radians().sin_cos();
        let middle = f64::from(SIDE) / 2.0;
        Border { a, b, c: -(a + b) * middle - off }
    }

    fn distance(self, (x, y): Point) -> f64 {
        self.a * x + self.b * y + self.c
    }

    fn reversed(self) -> Border {
        Border { a: -self.a, b: -self.b, c: -self.c }
    }

    /// Path data of the half of a large square that lies inside, as coordinates which both halves share.
    fn half(self) -> String {
        let far = 40.0;
        let square = [(-far, -far), (far, -far), (far, far), (-far, far)];
        let corners = cut(&square, self);
        let points: Vec<String> = corners.iter().map(|(x, y)| format!("{x:.4} {y:.4}")).collect();
        format!("M{}z", points.join("L"))
    }
}

/// The part of a convex polygon on a border's inside. The crossing is found from the same end whichever
/// way the border runs.
fn cut(polygon: &[Point], border: Border) -> Vec<Point> {
    let mut inside = Vec::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (dp, dq) = (border.distance(p), border.distance(q));
        if dp >= 0.0 {
            inside.push(p);
        }
        if (dp >= 0.0) != (dq >= 0.0) {
            let t = dp / (dp - dq);
            inside.push((p.0 + (q.0 - p.0) * t, p.1 + (q.1 - p.1) * t));
        }
    }
    inside
}

fn area(polygon: &[Point]) -> f64 {
    let next = |i: usize| polygon[(i + 1) % polygon.len()];
    0.5 * (0..polygon.len()).map(|i| polygon[i].0 * next(i).1 - next(i).0 * polygon[i].1).sum::<f64>()
}

/// Premultiplied, 0 ..= 1.
type Color = [f64; 4];

/// The mean over one pixel, where the colour depends only on the sides of some borders.
fn truth(
    pixel: Vec<Point>,
    borders: &[Border],
    sides: &mut Vec<bool>,
    color: &dyn Fn(&[bool]) -> Color,
) -> Color {
    let Some((&border, rest)) = borders.split_first() else {
        return color(sides).map(|v| v * area(&pixel));
    };
    let mut sum = [0.0; 4];
    for (side, border) in [(true, border), (false, border.reversed())] {
        sides.push(side);
        let part = truth(cut(&pixel, border), rest, sides, color);
        sides.pop();
        (0..4).for_each(|i| sum[i] += part[i]);
    }
    sum
}

/// Renders a drawing made of the two halves at a border, at many angles and offsets, and holds it against
/// the colour of each side of this border, and of a second one that lies across.
#[track_caller]
fn assert_exact(drawing: impl Fn(&str, &str, &str) -> String, color: impl Fn(&[bool]) -> Color) {
    assert_exact_within(TOLERANCE, drawing, color);
}

#[track_caller]
fn assert_exact_within(
    tolerance: f64,
    drawing: impl Fn(&str, &str, &str) -> String,
    color: impl Fn(&[bool]) -> Color,
) {
    let mut worst = (0.0f64, String::new());
    for (degrees, off) in places() {
        let border = Border::new(degrees, off);
        let across = Border::new(degrees * 0.37 + 71.0, off * 0.5 + 0.21);
        let body = drawing(&border.half(), &border.reversed().half(), &across.half());
        let picture = render(&body);
        for i in 0..SIDE * SIDE {
            let (x, y) = (i % SIDE, i / SIDE);
            let (left, top) = (f64::from(x), f64::from(y));
            let square = vec![(left, top), (left + 1.0, top), (left + 1.0, top + 1.0), (left, top + 1.0)];
            let expected = truth(square, &[border, across], &mut Vec::new(), &color);
            let [r, g, b, a] = picture.pixel(x, y).map(f64::from);
            let found = [r * a / 255.0, g * a / 255.0, b * a / 255.0, a];
            for (found, expected) in found.iter().zip(expected) {
                let off_by = (found - 255.0 * expected).abs();
                if off_by > worst.0 {
                    let expected = 255.0 * expected;
                    worst = (
                        off_by,
                        format!(
                            "{degrees}°, {off} px, pixel ({x}, {y}): {found:.1} is not {expected:.1}\n{body}"
                        ),
                    );
                }
            }
        }
    }
    assert!(worst.0 <= tolerance, "off by {:.2} levels: {}", worst.0, worst.1);
}

/// Angles in degrees and offsets in pixels: along the axes, nearly so, and in between.
fn places() -> Vec<(f64, f64)> {
    let angles = [0.0, 0.7, 14.0, 33.0, 45.0, 62.0, 89.5, 90.0, 117.0, 151.0, 201.0, 263.0, 307.0];
    let offsets = [0.0, 0.13, 0.25, 0.5, 0.71, -1.9];
    angles.iter().flat_map(|&angle| offsets.map(|off| (angle, off))).collect()
}

const RED: Color = [1.0, 0.0, 0.0, 1.0];
const BLUE: Color = [0.0, 0.0, 1.0, 1.0];
const WHITE: Color = [1.0; 4];
const CLEAR: Color = [0.0; 4];

fn mixed(one: Color, other: Color, share: f64) -> Color {
    std::array::from_fn(|i| one[i] * (1.0 - share) + other[i] * share)
}

fn fade(color: Color, share: f64) -> Color {
    color.map(|v| v * share)
}

fn over(front: Color, behind: Color) -> Color {
    std::array::from_fn(|i| front[i] + (1.0 - front[3]) * behind[i])
}

/// A red half beside a blue one.
fn halves(a: &str, b: &str) -> String {
    format!("<path d='{a}' fill='#f00'/><path d='{b}' fill='#00f'/>")
}

fn of_halves(sides: &[bool]) -> Color {
    if sides[0] {
        RED
    } else {
        BLUE
    }
}

const PAPER: &str = "<rect width='12' height='12' fill='#fff'/>";

#[test]
fn shapes_that_abut_under_one_group_opacity_leave_no_seam() {
    assert_exact(
        |a, b, _| format!("{PAPER}<g opacity='.6'>{}</g>", halves(a, b)),
        |sides| mixed(WHITE, of_halves(sides), 0.6),
    );
    assert_exact(
        |a, b, _| format!("<g opacity='.6'>{}</g>", halves(a, b)),
        |sides| fade(of_halves(sides), 0.6),
    );
}

#[test]
fn a_colour_that_ends_in_half_a_level_is_one_colour_in_parts_and_whole() {
    let slanted = |attributes: &str| {
        format!("<path {attributes} d='M2 2L30 2L5 30L2 30z'/><path {attributes} d='M30 2L30 30L5 30z'/>")
    };
    let mut renderers = [false, true].map(|linear| {
        Renderer::new(Settings { linear, threads: 1, ..Settings::default() }).expect("a renderer")
    });
    for percent in 1..100 {
        for color in ["#369", "#07f", "#a1b2c3"] {
            let group = format!("<g opacity='.{percent:02}' fill='{color}'>{}</g>", slanted(""));
            let above = format!(
                "{}<rect width='32' height='32' fill='{color}' opacity='.{percent:02}'/>",
                slanted("fill='#936'")
            );
            let on_paper = format!("<rect width='32' height='32' fill='#fed'/>{group}");
            for body in [group, above, on_paper] {
                let svg =
                    format!("<svg xmlns='http://www.w3.org/2000/svg' width='32' height='32'>{body}</svg>");
                let scene = Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing");
                for renderer in &mut renderers {
                    let picture = renderer.render(&scene, &Viewport::fit(&scene, 32, 32)).expect("a picture");
                    let expected = picture.pixel(4, 4);
                    for (x, y) in (0..26 * 26).map(|i| (3 + i % 26, 3 + i / 26)) {
                        assert_eq!(picture.pixel(x, y), expected, "{body} at {x}, {y}");
                    }
                }
            }
        }
    }
}

#[test]
fn shapes_that_abut_under_one_clip_leave_no_seam() {
    let color = |sides: &[bool]| if sides[1] { of_halves(sides) } else { WHITE };
    assert_exact(
        |a, b, c| {
            format!(
                "{PAPER}<clipPath id='c'><path d='{c}'/></clipPath><g clip-path='url(#c)'>{}</g>",
                halves(a, b)
            )
        },
        color,
    );
}

#[test]
fn a_clip_beside_its_complement_leaves_no_seam() {
    assert_exact(
        |a, b, _| {
            format!(
                "<clipPath id='a'><path d='{a}'/></clipPath><clipPath id='b'><path d='{b}'/></clipPath>
                <rect width='12' height='12' fill='#f00' clip-path='url(#a)'/>
                <rect width='12' height='12' fill='#00f' clip-path='url(#b)'/>"
            )
        },
        of_halves,
    );
}

#[test]
fn shapes_that_abut_under_one_mask_leave_no_seam() {
    for (paint, share) in [("#fff", 1.0), ("#fff' fill-opacity='.4", 0.4)] {
        assert_exact(
            |a, b, c| {
                format!(
                    "{PAPER}<mask id='m'><path d='{c}' fill='{paint}'/></mask><g mask='url(#m)'>{}</g>",
                    halves(a, b)
                )
            },
            |sides| if sides[1] { mixed(WHITE, of_halves(sides), share) } else { WHITE },
        );
    }
}

#[test]
fn shapes_that_abut_within_a_mask_leave_no_seam() {
    assert_exact(
        |a, b, c| {
            format!(
                "<mask id='m' mask-type='alpha'><path d='{a}'/><path d='{b}'/></mask><g mask='url(#m)'>
                <path d='{c}' fill='#f00'/></g>"
            )
        },
        |sides| if sides[1] { RED } else { CLEAR },
    );
}

#[test]
fn a_mask_beside_its_complement_leaves_no_seam() {
    for kind in ["luminance", "alpha"] {
        assert_exact(
            |a, b, _| {
                format!(
                    "<mask id='a' mask-type='{kind}'><path d='{a}' fill='#fff'/></mask>
                    <mask id='b' mask-type='{kind}'><path d='{b}' fill='#fff'/></mask>
                    <rect width='12' height='12' fill='#f00' mask='url(#a)'/>
                    <rect width='12' height='12' fill='#00f' mask='url(#b)'/>"
                )
            },
            of_halves,
        );
    }
}

#[test]
fn a_mask_on_a_mask_and_its_window_are_exact() {
    assert_exact(
        |a, _, c| {
            format!(
                "<mask id='a' maskUnits='userSpaceOnUse' x='-9' y='-9' width='15.5' height='40'><path d='{a}' fill='#fff'/></mask>
                <mask id='b' mask='url(#a)' maskUnits='userSpaceOnUse' x='-9' y='-9' width='40' height='40'><path d='{c}' fill='#fff' opacity='.5'/></mask>
                <mask id='w' maskUnits='userSpaceOnUse' x='0' y='0' width='12' height='12'><rect width='12' height='12' fill='#fff'/></mask>
                <g mask='url(#w)'><rect width='12' height='12' fill='#f00' mask='url(#b)'/>
                <rect width='12' height='12' fill='#f00' mask='url(#b)' opacity='0'/></g>
                <rect x='6.5' width='6' height='12' fill='#f00' mask='url(#b)' opacity='0'/>
                <clipPath id='k'><rect x='6.5' width='6' height='12'/></clipPath>
                <g clip-path='url(#k)'><path d='{a}' fill='#f00' fill-opacity='.5' clip-path='url(#d)'/></g>
                <clipPath id='d'><path d='{c}'/></clipPath>"
            )
        },
        |sides| if sides[0] && sides[1] { fade(RED, 0.5) } else { CLEAR },
    );
}

#[test]
fn shapes_that_abut_under_one_blend_mode_leave_no_seam() {
    // Over a yellow half on white.
    let multiply = |one: Color, other: Color| std::array::from_fn(|i| one[i] * other[i]);
    let yellow = [1.0, 1.0, 0.0, 1.0];
    let backdrop = |sides: &[bool]| if sides[1] { yellow } else { WHITE };
    for opacity in [1.0, 0.5] {
        assert_exact(
            |a, b, c| {
                format!(
                    "{PAPER}<path d='{c}' fill='#ff0'/>
                    <g style='mix-blend-mode:multiply' opacity='{opacity}'>{}</g>",
                    halves(a, b)
                )
            },
            |sides| mixed(backdrop(sides), multiply(of_halves(sides), backdrop(sides)), opacity),
        );
    }
}

#[test]
fn shapes_that_abut_and_blend_each_for_itself_leave_no_seam() {
    let difference = |one: Color, other: Color| {
        [0, 1, 2, 3].map(|i| if i == 3 { 1.0 } else { f64::abs(one[i] - other[i]) })
    };
    let style = "style='mix-blend-mode:difference'";
    assert_exact(
        |a, b, c| {
            format!(
                "{PAPER}<path d='{a}' fill='#f00' {style}/><path d='{b}' fill='#00f' {style}/>
                <path d='{c}' fill='#0ff' {style}/>"
            )
        },
        |sides| {
            let below = difference(of_halves(sides), WHITE);
            if sides[1] {
                difference([0.0, 1.0, 1.0, 1.0], below)
            } else {
                below
            }
        },
    );
}

#[test]
fn twenty_blended_groups_are_as_exact_as_one() {
    // More than the closed form takes.
    let thin = "<path d='{c}' fill='#fff' fill-opacity='.9' style='mix-blend-mode:multiply'/>";
    let blended = |c: &str| thin.replace("{c}", c).repeat(20);
    assert_exact(
        |a, b, c| format!("{}{}", halves(a, b), blended(c)),
        |sides| if sides[1] { over(CLEAR, of_halves(sides)) } else { of_halves(sides) },
    );
}

/// Holds a shape that has this attribute, and its neighbour that has not, whichever is in front.
fn assert_neighbours_are_exact(definitions: &str, attribute: &str) {
    for order in [false, true] {
        assert_exact(
            |a, b, _| {
                let grouped = format!("<path d='{a}' fill='#f00' {attribute}/>");
                let plain = format!("<path d='{b}' fill='#00f'/>");
                match order {
                    false => format!("{PAPER}{definitions}{grouped}{plain}"),
                    true => format!("{PAPER}{definitions}{plain}{grouped}"),
                }
            },
            of_halves,
        );
    }
}

#[test]
fn shapes_that_abut_across_the_border_of_a_masked_group_leave_no_seam() {
    let mask = "<mask id='m'><rect x='-9' y='-9' width='30' height='30' fill='#fff'/></mask>";
    assert_neighbours_are_exact(mask, "mask='url(#m)'");
}

#[test]
fn shapes_that_abut_across_the_border_of_a_blended_group_leave_no_seam() {
    assert_neighbours_are_exact("", "style='mix-blend-mode:multiply'");
}

#[test]
fn an_isolated_group_beside_its_neighbour_leaves_no_seam() {
    assert_exact(
        |a, b, c| {
            format!(
                "{PAPER}<g style='isolation:isolate'><path d='{a}' fill='#f00'/>
                <path d='{c}' fill='#0ff' style='mix-blend-mode:screen' clip-path='url(#a)'/></g>
                <clipPath id='a'><path d='{a}'/></clipPath><path d='{b}' fill='#00f'/>"
            )
        },
        |sides| match sides {
            [true, true] => WHITE,
            [true, false] => RED,
            _ => BLUE,
        },
    );
}

/// A gradient of the picture's whole width; and the mean colours of its pixels.
const GRADIENT: &str = "<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='0' x2='12'>
    <stop offset='0' stop-color='#f00'/><stop offset='1' stop-color='#00f'/></linearGradient>";

#[test]
fn shapes_that_abut_under_one_gradient_leave_no_seam() {
    for (degrees, off) in places() {
        let border = Border::new(degrees, off);
        let (a, b) = (border.half(), border.reversed().half());
        let picture =
            render(&format!("{GRADIENT}<path d='{a}' fill='url(#g)'/><path d='{b}' fill='url(#g)'/>"));
        for i in 0..SIDE * SIDE {
            let (x, y) = (i % SIDE, i / SIDE);
            let blue = 255.0 * (f64::from(x) + 0.5) / 12.0;
            let [r, g, b, a] = picture.pixel(x, y);
            let off_by = (f64::from(b) - blue).abs().max((f64::from(r) - 255.0 + blue).abs());
            assert!(
                off_by < 1.0 && g == 0 && a == 255,
                "({x}, {y}) at {degrees}°, {off} px: {r} {g} {b} {a}"
            );
        }
    }
}

#[test]
fn shapes_that_abut_under_one_filter_leave_no_seam() {
    // Red becomes green, blue stays.
    let filter = "<filter id='f' x='-50' y='-50' width='130' height='130' filterUnits='userSpaceOnUse' color-interpolation-filters='sRGB'>
        <feColorMatrix values='0 0 0 0 0  1 0 0 0 0  0 0 1 0 0  0 0 0 1 0'/></filter>";
    let color = |sides: &[bool]| if sides[0] { [0.0, 1.0, 0.0, 1.0] } else { BLUE };
    assert_exact(|a, b, _| format!("{PAPER}{filter}<g filter='url(#f)'>{}</g>", halves(a, b)), color);
    // Each for itself.
    assert_exact(
        |a, b, _| {
            format!("{PAPER}{filter}<path d='{a}' fill='#f00' filter='url(#f)'/><path d='{b}' fill='#00f' filter='url(#f)'/>")
        },
        color,
    );
}

#[test]
fn shapes_that_abut_across_the_border_of_a_filtered_group_leave_no_seam() {
    let filter = "<filter id='f' x='-50' y='-50' width='130' height='130' filterUnits='userSpaceOnUse' color-interpolation-filters='sRGB'>
        <feColorMatrix type='saturate' values='1'/></filter>";
    assert_exact(
        |a, b, _| {
            format!("{PAPER}{filter}<path d='{b}' fill='#00f'/><path d='{a}' fill='#f00' filter='url(#f)'/>")
        },
        of_halves,
    );
    assert_exact(
        |a, b, _| {
            format!("{PAPER}{filter}<path d='{a}' fill='#f00' filter='url(#f)'/><path d='{b}' fill='#00f'/>")
        },
        of_halves,
    );
}

#[test]
fn what_casts_a_shadow_meets_its_neighbour_without_a_seam() {
    // A shadow that falls outside the picture leaves its caster alone.
    let filter = "<filter id='f' x='-50' y='-50' width='130' height='130' filterUnits='userSpaceOnUse'>
        <feDropShadow dx='0' dy='0' stdDeviation='.4' flood-color='#f00'/></filter>";
    assert_exact(
        |a, b, _| {
            format!("{PAPER}{filter}<path d='{a}' fill='#f00' filter='url(#f)'/><path d='{b}' fill='#00f'/>")
        },
        of_halves,
    );
}

#[test]
fn a_hard_stop_is_as_exact_as_an_edge_and_beside_an_edge() {
    assert_exact(
        |a, _, c| {
            // The gradient's vector from a point on the border along its normal.
            let points: Vec<f64> =
                a[1..a.len() - 1].split(['L', ' ']).map(|number| number.parse().expect("a number")).collect();
            let corners: Vec<Point> = points.chunks(2).map(|p| (p[0], p[1])).collect();
            let side = |i: usize| (corners[i], corners[(i + 1) % corners.len()]);
            let inner = |&(p, q): &(Point, Point)| {
                // The one side that is not the large square's.
                (p.0 != q.0 || p.0.abs() < 39.9) && (p.1 != q.1 || p.1.abs() < 39.9)
            };
            let (p, q) = (0..corners.len()).map(side).find(inner).expect("a side");
            let normal = (p.1 - q.1, q.0 - p.0);
            let (x2, y2) = (p.0 + normal.0, p.1 + normal.1);
            let (x1, y1) = (p.0 - normal.0, p.1 - normal.1);
            format!(
                "{PAPER}<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='{x1:.5}' y1='{y1:.5}' x2='{x2:.5}' y2='{y2:.5}'>
                <stop offset='.5' stop-color='#00f'/><stop offset='.5' stop-color='#f00'/></linearGradient>
                <path d='{c}' fill='url(#g)'/>"
            )
        },
        |sides| if sides[1] { of_halves(sides) } else { WHITE },
    );
}

/// Holds red on the inside of a border, painted by a gradient, against the mean of 128 x 128 points a
/// pixel; `red` is the colour at a point.
#[track_caller]
fn assert_gradient(gradient: &str, red: impl Fn(f64, f64) -> f64) {
    const POINTS: u32 = 128;
    let mut worst = (0.0f64, String::new());
    for (degrees, off) in [(12.0, 0.3), (77.0, -1.3), (130.0, 2.1), (283.0, 0.0)] {
        let border = Border::new(degrees, off);
        let body = format!("{gradient}<path d='{}' fill='url(#g)'/>", border.half());
        let picture = render(&format!("<rect width='12' height='12'/>{body}"));
        for i in 0..SIDE * SIDE {
            let (x, y) = (i % SIDE, i / SIDE);
            let mut sum = 0.0;
            for point in 0..POINTS * POINTS {
                // A lattice by the golden ratio: even along every line, so that edges are exact.
                let count = f64::from(POINTS * POINTS);
                let v = (f64::from(point) * 0.618_033_988_749_894_9).fract();
                let (px, py) = (f64::from(x) + (f64::from(point) + 0.5) / count, f64::from(y) + v);
                if border.distance((px, py)) >= 0.0 {
                    sum += red(px, py) / count;
                }
            }
            let off_by = (f64::from(picture.pixel(x, y)[0]) - 255.0 * sum).abs();
            if off_by > worst.0 {
                let found = picture.pixel(x, y)[0];
                worst = (off_by, format!("({x}, {y}): {found} is not {:.2}\n{body}", 255.0 * sum));
            }
        }
    }
    assert!(worst.0 <= 1.0, "off by {:.2} levels: {}", worst.0, worst.1);
}

#[test]
fn a_gradient_that_turns_within_pixels_is_its_mean_over_what_is_seen() {
    let stops = "<stop offset='.2' stop-color='#f00'/><stop offset='.4' stop-color='#000'/>
        <stop offset='.4' stop-color='#900'/><stop offset='.9' stop-color='#f00' stop-opacity='.2'/>";
    let red = |t: f64| match t {
        t if t < 0.2 => 1.0,
        t if t < 0.4 => 1.0 - (t - 0.2) / 0.2,
        t => {
            let u = ((t - 0.4) / 0.5).min(1.0);
            (0.6 + 0.4 * u) * (1.0 - 0.8 * u)
        }
    };
    for (x2, y2) in [(3.0, 0.0), (0.3, 0.4), (-1.1, 1.7), (0.02, 0.05)] {
        for (spread, spreading) in [
            ("pad", (|t: f64| t.clamp(0.0, 1.0)) as fn(f64) -> f64),
            ("repeat", |t| t - t.floor()),
            ("reflect", |t| 1.0 - (t - 2.0 * (t / 2.0).floor() - 1.0).abs()),
        ] {
            let gradient = format!(
                "<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='6' y1='5.5' x2='{}' y2='{}' spreadMethod='{spread}'>{stops}</linearGradient>",
                6.0 + x2,
                5.5 + y2
            );
            let square = x2 * x2 + y2 * y2;
            assert_gradient(&gradient, |x, y| red(spreading(((x - 6.0) * x2 + (y - 5.5) * y2) / square)));
        }
    }
}

#[test]
fn a_steep_gradient_is_its_mean_over_what_is_seen() {
    let gradient = "<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='1' y1='2' x2='10' y2='8'>
        <stop offset='0' stop-color='#000'/><stop offset='1' stop-color='#f00'/></linearGradient>";
    let square = 81.0 + 36.0;
    assert_gradient(gradient, |x, y| (((x - 1.0) * 9.0 + (y - 2.0) * 6.0) / square).clamp(0.0, 1.0));
}

#[test]
fn the_rings_of_a_radial_gradient_are_their_mean_over_what_is_seen() {
    // Its middle is outside: there rings are no straight lines.
    let gradient = "<radialGradient id='g' gradientUnits='userSpaceOnUse' cx='-20' cy='-17' r='1.7' spreadMethod='repeat'>
        <stop offset='.5' stop-color='#000'/><stop offset='.5' stop-color='#f00'/></radialGradient>";
    assert_gradient(gradient, |x, y| {
        let t = ((x + 20.0).powi(2) + (y + 17.0).powi(2)).sqrt() / 1.7;
        if t - t.floor() < 0.5 {
            0.0
        } else {
            1.0
        }
    });
}
