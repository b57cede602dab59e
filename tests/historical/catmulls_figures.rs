//! Catmull's figures: what shows that should not.

use super::*;

#[test]
fn catmulls_hidden_colour_does_not_show() {
    // His figure 1: a quarter green, a quarter black, half blue, and red behind them all.
    for method in [Method::Exact, Method::Beam] {
        let picture = render_by(method, &sample("catmull-pixel.svg"));
        assert_eq!(picture.pixel(0, 0), [0, 64, 128, 255], "{method}");
    }
    for method in [Method::Area, Method::Cone, Method::TinySkia] {
        let [red, ..] = render_by(method, &sample("catmull-pixel.svg")).pixel(0, 0);
        assert!(red > 15, "{method} shows no red: {red}");
    }
}

#[test]
fn nothing_shines_through_beside_catmulls_black_line() {
    // His figure 6: a black line over the border of two colours, on a green table.
    let document = svg(
        12,
        9,
        &[
            rect(0.0, 0.0, 12.0, 9.0, "#0f0"),
            rect(0.0, 0.0, 6.5, 9.0, "#f00"),
            rect(6.5, 0.0, 12.0, 9.0, "#00f"),
            rect(6.25, 0.0, 6.75, 9.0, "#000"),
        ]
        .concat(),
    );
    for method in [Method::Exact, Method::Beam] {
        assert_levels(render_by(method, &document).pixel(6, 4), [63.75, 0.0, 63.75, 255.0], 0.6);
    }
    // Half red, then half blue over that, then half black: and a quarter of the green is left of it.
    assert_levels(render_by(Method::Area, &document).pixel(6, 4), [31.9, 31.9, 63.75, 255.0], 1.0);
}
