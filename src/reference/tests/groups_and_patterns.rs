//! Tiles, masks and blend modes, by areas and formulas.

use super::*;

#[test]
fn a_pattern_begins_where_it_says_and_is_cut_at_its_tiles_and_its_shape() {
    // Bars 1 wide, 4 apart from 1.5 on; the content reaches beyond the tile, which is as wide as it.
    let body = "<pattern id='p' x='1.5' width='4' height='9' patternUnits='userSpaceOnUse'>
        <rect width='1' height='9'/><rect x='4' width='2' height='9'/></pattern>
        <rect x='.25' width='9' height='2' fill='url(#p)'/>";
    let t = truth(10, 2, body);
    let wanted = [0.0, 0.5, 0.5, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0];
    for (x, wanted) in wanted.into_iter().enumerate() {
        assert_near(alpha(&t, x as u32, 0), wanted, 1e-6);
    }
}

#[test]
fn a_tiles_edge_and_its_shapes_are_one_in_a_pixel() {
    // Shape and bars end at .25: what is black there is all that is black.
    let body = "<pattern id='p' width='.5' height='9' patternUnits='userSpaceOnUse'>
        <rect width='.25' height='9'/></pattern><path d='M0 0H.25V1H0z' fill='url(#p)'/>";
    assert_near(alpha(&truth(1, 1, body), 0, 0), 0.25, 1e-6);
}

#[test]
fn turned_tiles_cover_all_and_leave_no_seams() {
    let body = "<pattern id='p' width='1.3' height='2.1' patternUnits='userSpaceOnUse'
        patternTransform='rotate(23) skewX(20)'><rect width='1.3' height='2.1' fill='#c84'/></pattern>
        <rect x='1' y='1' width='6' height='6' fill='url(#p)'/>";
    let t = truth(8, 8, body);
    assert_near(area(&t), 36.0, 1e-4);
    assert_near(t.straight(3, 3)[0], 204.0, 1e-4);
}

#[test]
fn a_pattern_fades_as_one_and_paints_strokes_and_patterns() {
    let body = "<pattern id='q' width='2' height='2' patternUnits='userSpaceOnUse'>
        <rect width='2' height='2'/><rect width='1' height='2' fill='#fff'/></pattern>
        <pattern id='p' width='4' height='4' patternUnits='userSpaceOnUse'>
        <rect width='4' height='4' fill='url(#q)'/></pattern>
        <path d='M0 2H8' stroke='url(#p)' stroke-width='2' stroke-opacity='.5'/>";
    let t = truth(8, 4, body);
    for x in 0..8 {
        assert_near(t.premultiplied()[8 + x][0], if x % 2 == 0 { 127.5 } else { 0.0 }, 1e-4);
        assert_near(t.premultiplied()[8 + x][3], 127.5, 1e-4);
    }
    assert_near(area(&t), 8.0, 1e-4);
}

#[test]
fn a_mask_shows_by_light_or_by_alpha_within_its_rectangle() {
    let masked = |kind: &str, fill: &str, more: &str| {
        format!(
            "<mask id='m' mask-type='{kind}' maskUnits='userSpaceOnUse' x='0' y='0' width='1' height='.5' {more}>
            <rect width='2' height='2' fill='{fill}' fill-opacity='.5'/></mask>
            <mask id='half' maskUnits='userSpaceOnUse' x='0' y='0' width='.5' height='1'>
            <rect width='9' height='9' fill='#fff'/></mask>
            <rect width='1' height='1' mask='url(#m)'/>"
        )
    };
    let shown = |body: &str| alpha(&truth(1, 1, body), 0, 0);
    assert_near(shown(&masked("luminance", "#fff", "")), 0.25, 1e-6);
    assert_near(shown(&masked("luminance", "#0f0", "")), 0.25 * 0.7154, 1e-6);
    assert_near(shown(&masked("luminance", "#000", "")), 0.0, 1e-6);
    assert_near(shown(&masked("alpha", "#000", "")), 0.25, 1e-6);
    assert_near(shown(&masked("alpha", "#000", "mask='url(#half)'")), 0.125, 1e-6);
}

#[test]
fn nothing_shows_through_an_empty_mask_and_what_lies_behind_it_stays() {
    let body = "<mask id='m'><path d='M0 0H.5V1H0z' fill='#fff'/></mask>
        <rect width='2' height='1' fill='#f00'/><rect width='2' height='1' fill='#00f' mask='url(#m)'/>";
    let t = truth(2, 1, body);
    assert_near(t.straight(0, 0)[2], 127.5, 1e-4);
    assert_near(t.straight(1, 0)[0], 255.0, 1e-4);
}

#[test]
fn colours_blend_where_shapes_overlap_before_areas_mix() {
    let body = "<path d='M0 0H.5V1H0z' fill='#808080'/>
        <rect width='1' height='1' fill='#0ff' style='mix-blend-mode:multiply'/>";
    let t = truth(1, 1, body);
    assert_near(t.straight(0, 0)[0], 0.0, 1e-4);
    assert_near(t.straight(0, 0)[1], 0.5 * 128.0 + 0.5 * 255.0, 1e-4);
}

#[test]
fn an_isolated_group_is_its_own_backdrop() {
    let blended = "<rect width='1' height='1' fill='#fff' style='mix-blend-mode:difference'/>";
    let level = |group: &str| {
        let body = format!("<rect width='1' height='1' fill='#fff'/><g {group}>{blended}</g>");
        truth(1, 1, &body).straight(0, 0)[0]
    };
    assert_near(level(""), 0.0, 1e-4);
    assert_near(level("style='isolation:isolate'"), 255.0, 1e-4);
}

/// Of every mode, over an opaque backdrop: 40% and 80% (in red and green) with 60% and 20%.
#[test]
fn every_mode_is_its_formula() {
    let soft = |b: f64, s: f64| {
        if s <= 0.5 {
            b - (1.0 - 2.0 * s) * b * (1.0 - b)
        } else {
            b + (2.0 * s - 1.0) * (b.sqrt() - b)
        }
    };
    let formulas: [(&str, [f64; 2]); 12] = [
        ("multiply", [0.24, 0.16]),
        ("screen", [0.76, 0.84]),
        ("overlay", [0.48, 0.68]),
        ("darken", [0.4, 0.2]),
        ("lighten", [0.6, 0.8]),
        ("color-dodge", [1.0, 1.0]),
        ("color-burn", [0.0, 0.0]),
        ("hard-light", [0.52, 0.32]),
        ("soft-light", [soft(0.4, 0.6), soft(0.8, 0.2)]),
        ("difference", [0.2, 0.6]),
        ("exclusion", [0.52, 0.68]),
        ("plus-lighter", [1.0, 1.0]),
    ];
    for (mode, wanted) in formulas {
        let body = format!(
            "<rect width='1' height='1' fill='#66cc00'/>
            <rect width='1' height='1' fill='#993300' style='mix-blend-mode:{mode}'/>"
        );
        let t = truth(1, 1, &body);
        for (level, wanted) in t.straight(0, 0).into_iter().zip(wanted) {
            assert_near(level, 255.0 * wanted, 1e-3);
        }
    }
}

#[test]
fn the_modes_of_whole_colours_keep_luminosity_and_saturation_as_they_say() {
    let luminosity = |[r, g, b, _]: [f64; 4]| 0.3 * r + 0.59 * g + 0.11 * b;
    let saturation = |[r, g, b, _]: [f64; 4]| r.max(g).max(b) - r.min(g).min(b);
    let (back, front) = ([128.0, 96.0, 112.0, 255.0], [112.0, 144.0, 128.0, 255.0]);
    let blended = |mode: &str| {
        let body = format!(
            "<rect width='1' height='1' fill='rgb(128,96,112)'/>
            <rect width='1' height='1' fill='rgb(112,144,128)' style='mix-blend-mode:{mode}'/>"
        );
        truth(1, 1, &body).straight(0, 0)
    };
    for (mode, light, colourful) in [
        ("hue", back, back),
        ("saturation", back, front),
        ("color", back, front),
        ("luminosity", front, back),
    ] {
        let found = blended(mode);
        assert_near(luminosity(found), luminosity(light), 1e-3);
        assert_near(saturation(found), saturation(colourful), 1e-3);
    }
}
