//! Filtered groups.

use super::*;

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
