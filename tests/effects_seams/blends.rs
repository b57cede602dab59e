//! Blend modes.

use super::*;

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

#[test]
fn shapes_that_abut_across_the_border_of_a_blended_group_leave_no_seam() {
    assert_neighbours_are_exact("", "style='mix-blend-mode:multiply'");
}
