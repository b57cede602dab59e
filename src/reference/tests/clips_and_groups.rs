//! Clip-paths are geometry, groups are composited apart.

use super::*;

#[test]
fn a_clip_beside_its_complement_leaves_no_seam() {
    let body = "<clipPath id='a'><path d='M0 0H3.3L4.6 8H0z'/></clipPath>
        <clipPath id='b'><path d='M8 0H3.3L4.6 8H8z'/></clipPath>
        <rect width='8' height='8' fill='#fff'/>
        <rect width='8' height='8' fill='#c00' clip-path='url(#a)'/>
        <rect width='8' height='8' fill='#c00' clip-path='url(#b)'/>";
    for pixel in truth(8, 8, body).premultiplied() {
        assert_near(pixel[0], 204.0, 1e-9);
        assert_near(pixel[1], 0.0, 1e-9);
    }
}

#[test]
fn a_clips_children_are_united_and_each_keeps_its_own_rule() {
    let body = "<clipPath id='c'><path d='M0 0H.5V1H0z'/>
        <path clip-rule='evenodd' d='M0 0H1V1H0zM0 .5H1V1H0z'/></clipPath>
        <rect width='1' height='1' clip-path='url(#c)'/>";
    assert_near(alpha(&truth(1, 1, body), 0, 0), 0.75, 1e-12);
}

#[test]
fn clips_on_clips_intersect_whether_on_the_clip_or_on_its_child() {
    let on_clip = "<clipPath id='a'><path d='M0 0H.5V1H0z'/></clipPath>
        <clipPath id='b' clip-path='url(#a)'><path d='M0 0H1V.5H0z'/></clipPath>
        <rect width='1' height='1' clip-path='url(#b)'/>";
    assert_near(alpha(&truth(1, 1, on_clip), 0, 0), 0.25, 1e-12);
    let on_child = "<clipPath id='a'><path d='M0 0H.5V1H0z'/></clipPath>
        <clipPath id='b'><path d='M0 0H1V.5H0z' clip-path='url(#a)'/>
        <path d='M.75 .5H1V1H.75z'/></clipPath>
        <rect width='1' height='1' clip-path='url(#b)'/>";
    assert_near(alpha(&truth(1, 1, on_child), 0, 0), 0.375, 1e-12);
}

#[test]
fn nested_clipped_groups_intersect() {
    let body = "<clipPath id='a'><path d='M0 0H.5V1H0z'/></clipPath>
        <clipPath id='b'><path d='M0 0H1V.5H0z'/></clipPath>
        <g clip-path='url(#a)'><g clip-path='url(#b)'><rect width='1' height='1'/></g></g>";
    assert_near(alpha(&truth(1, 1, body), 0, 0), 0.25, 1e-12);
}

#[test]
fn a_clip_in_units_of_the_bounding_box_scales_with_it() {
    let body = "<clipPath id='a' clipPathUnits='objectBoundingBox'><path d='M0 0H.5V1H0z'/></clipPath>
        <rect x='1' y='1' width='4' height='2' clip-path='url(#a)'/>";
    assert_near(area(&truth(6, 4, body)), 4.0, 1e-6);
}

#[test]
fn a_clip_with_nothing_in_it_hides_all() {
    let body = "<clipPath id='a'/><rect width='1' height='1' clip-path='url(#a)'/>";
    assert_eq!(area(&truth(1, 1, body)), 0.0);
}

#[test]
fn a_group_fades_as_one_and_its_children_do_not_shine_through() {
    let children = "<path fill='#f00' d='M0 0H2V1H0z'/><path fill='#00f' d='M1 0H3V1H1z'/>";
    let t = truth(3, 1, &format!("<g opacity='.5'>{children}</g>"));
    for (pixel, wanted) in t.premultiplied().iter().zip([[127.5, 0.0], [0.0, 127.5], [0.0, 127.5]]) {
        assert_near(pixel[0], wanted[0], 1e-4);
        assert_near(pixel[2], wanted[1], 1e-4);
        assert_near(pixel[3], 127.5, 1e-4);
    }
}

#[test]
fn faded_groups_nest() {
    let body = "<rect width='1' height='1' fill='#fff'/>
        <g opacity='.5'><g opacity='.5'><path d='M0 0H.5V1H0z'/></g><path d='M.5 0H1V1H.5z'/></g>";
    let t = truth(1, 1, body);
    assert_near(t.premultiplied()[0][0], 255.0 * (0.5 * 0.75 + 0.5 * 0.5), 1e-4);
}

#[test]
fn opacity_composites_within_each_region_before_areas_mix() {
    let body = "<path fill='#f00' d='M0 0H.5V1H0z'/>
        <path fill='#00f' fill-opacity='.5' d='M0 0H1V.5H0z'/>";
    let t = truth(1, 1, body);
    assert_near(t.premultiplied()[0][0], 255.0 * (0.25 + 0.25 * 0.5), 1e-4);
    assert_near(t.premultiplied()[0][2], 255.0 * 0.5 * 0.5, 1e-4);
    assert_near(t.premultiplied()[0][3], 255.0 * (0.5 + 0.25 * 0.5), 1e-4);
}

#[test]
fn what_an_opaque_shape_in_a_clipped_group_hides_ends_where_the_clip_does() {
    let body = "<rect width='2' height='1' fill='#f00'/>
        <clipPath id='a'><path d='M0 0H1.5V1H0z'/></clipPath>
        <g clip-path='url(#a)'><rect width='2' height='1' fill='#00f'/></g>";
    let t = truth(2, 1, body);
    assert_eq!(t.premultiplied()[0], [0.0, 0.0, 255.0, 255.0]);
    assert_near(t.premultiplied()[1][0], 127.5, 1e-9);
    assert_near(t.premultiplied()[1][2], 127.5, 1e-9);
}

#[test]
fn text_is_left_to_usvg_and_an_empty_drawing_is_empty() {
    assert_eq!(area(&truth(2, 2, "<g/>")), 0.0);
}

#[test]
fn the_census_names_what_is_left_out_wherever_it_is_drawn() {
    let body = "<filter id='f'><feGaussianBlur stdDeviation='1'/></filter>
        <mask id='m'><rect id='blurred' width='9' height='9' fill='#fff' filter='url(#f)'/></mask>
        <pattern id='p' width='3' height='3' patternUnits='userSpaceOnUse'>
        <rect width='1' height='1' filter='url(#f)'/></pattern>
        <pattern id='q' width='.01' height='.01' patternUnits='userSpaceOnUse'>
        <rect width='.005' height='1' filter='url(#f)'/></pattern>
        <linearGradient id='g'><stop/><stop offset='1' stop-color='red'/></linearGradient>
        <rect width='9' height='9' mask='url(#m)'/>
        <rect width='9' height='9' fill='url(#p)'/>
        <rect id='fine' width='9' height='9' fill='url(#q)'/>
        <rect width='9' height='9' style='mix-blend-mode:multiply'/>
        <rect width='9' height='9' fill='url(#g)'/>";
    let tree = tree(9, 9, body);
    let mut found: Vec<_> =
        super::super::unsupported(&tree).into_iter().map(|u| (u.kind, u.element, u.count)).collect();
    found.sort();
    let wanted = [("filters", "blurred", 2), ("patterns of very many tiles", "fine", 1)];
    assert_eq!(found, wanted.map(|(kind, id, count)| (kind, id.to_owned(), count)));
    assert!(super::super::has_gradients(&tree));
    assert!(super::super::edges_are_straight(&tree));
}
