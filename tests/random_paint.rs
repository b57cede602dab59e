//! Random small scenes of every kind of paint and group: the picture is the truth, within a level.

#[path = "support/random_scene.rs"]
mod random_scene;
mod support;

use random_scene::{Kinds, RandomScene};
use toon_raster::reference::{self, Difference};
use toon_raster::{Renderer, Scene, Settings, Viewport};

const SIZE: u32 = 48;

/// The most that a channel may be off: half a level is rounding.
const MOST: f64 = 1.0;

/// The same of gradients over one another: of one that fades by up to 8 levels a pixel the mean is laid over borders.
const MOST_OF_FADES: f64 = 1.25;

#[track_caller]
fn assert_true(kinds: Kinds, seeds: std::ops::Range<u64>) {
    let most = if kinds.gradients > 1 { MOST_OF_FADES } else { MOST };
    for (seed, Difference { max, worst, .. }, svg) in differences(kinds, seeds) {
        assert!(max <= most, "seed {seed} is {max:.2} levels off in {worst:?}: {svg}");
    }
}

/// How far the pictures of some scenes are off.
fn differences(kinds: Kinds, seeds: std::ops::Range<u64>) -> impl Iterator<Item = (u64, Difference, String)> {
    seeds.map(move |seed| {
        let svg = RandomScene::new(seed, kinds, SIZE).svg();
        let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).expect("valid SVG");
        assert!(reference::unsupported(&tree).is_empty(), "the truth draws all of {svg}");
        let scene = Scene::from_tree(&tree).expect("a scene");
        let viewport = Viewport::fit(&scene, SIZE, SIZE);
        let truth = reference::render(&tree, &viewport, &reference::Options::default()).expect("a truth");
        let picture = Renderer::new(Settings::default())
            .expect("settings")
            .render(&scene, &viewport)
            .expect("a picture");
        (seed, truth.compare(&picture), svg)
    })
}

#[test]
fn flat_shapes_in_faded_and_clipped_groups_are_true() {
    assert_true(Kinds { opacity: true, clips: true, ..Kinds::default() }, 0..24);
}

#[test]
fn masks_and_blend_modes_are_true() {
    assert_true(Kinds { opacity: true, clips: true, masks: true, blends: true, ..Kinds::default() }, 0..24);
}

#[test]
fn stacks_of_blended_shapes_are_true() {
    assert_true(Kinds { opacity: true, stack: 16, ..Kinds::default() }, 0..24);
}

#[test]
fn patterns_of_flat_shapes_are_true() {
    assert_true(Kinds { opacity: true, clips: true, patterns: true, ..Kinds::default() }, 0..24);
}

#[test]
fn a_gradient_over_flat_shapes_is_true() {
    assert_true(Kinds { gradients: 1, clips: true, ..Kinds::default() }, 0..24);
}

#[test]
fn gradients_over_one_another_are_true() {
    assert_true(Kinds { gradients: 3, clips: true, ..Kinds::default() }, 0..24);
}

#[test]
fn gradients_over_masks_and_blend_modes_are_true() {
    assert_true(Kinds { gradients: 2, opacity: true, masks: true, blends: true, ..Kinds::default() }, 0..24);
}
