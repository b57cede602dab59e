//! Groups with opacity, and isolated ones.

use super::*;

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
