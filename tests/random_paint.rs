//! Random small scenes of every kind of paint and group: the picture is the truth, within a level.

#[path = "support/random_scene.rs"]
mod random_scene;

use random_scene::{Kinds, RandomScene};
use toon_raster::reference;
use toon_raster::{Renderer, Scene, Settings, Viewport};

const SIZE: u32 = 48;

/// The most that a channel may be off: half a level is rounding.
const MOST: f64 = 1.0;

#[track_caller]
fn assert_true(kinds: Kinds, seeds: std::ops::Range<u64>) {
    for seed in seeds {
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
        let off = truth.compare(&picture);
        assert!(off.max <= MOST, "seed {seed} is {:.2} levels off at {:?}: {svg}", off.max, off.worst);
    }
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
fn patterns_of_flat_shapes_are_true() {
    assert_true(Kinds { opacity: true, clips: true, patterns: true, ..Kinds::default() }, 0..24);
}

#[test]
fn a_gradient_over_flat_shapes_is_true() {
    assert_true(Kinds { gradient: true, clips: true, ..Kinds::default() }, 0..24);
}
