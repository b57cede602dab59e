//! Clips and masks.

use super::*;

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
fn shapes_that_abut_across_the_border_of_a_masked_group_leave_no_seam() {
    let mask = "<mask id='m'><rect x='-9' y='-9' width='30' height='30' fill='#fff'/></mask>";
    assert_neighbours_are_exact(mask, "mask='url(#m)'");
}
