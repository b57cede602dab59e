//! Pictures of animated drawings at given times, for `examples/against_chromium.rs`, which holds them
//! against a browser's, and for the test that holds them against what was then stored.

use toon_raster::frames::Timeline;
use toon_raster::{Error, Options, Renderer, Scene, Settings, Viewport};

/// Moments compared, in seconds.
pub const TIMES: [f64; 5] = [0.33, 1.07, 1.6, 2.71, 4.4];
/// Side of a picture, in pixels.
pub const SIDE: usize = 96;
/// Side of a square of pixels whose mean colour is stored.
const CELL: usize = 16;

/// Straight RGBA at one of [`TIMES`]: as large as fits, in the middle of a white square, where a browser puts it.
pub fn picture(timeline: &Timeline, time: f64) -> Result<Vec<u8>, Error> {
    let scene = Scene::from_bytes(timeline.document_at(time).as_bytes(), &Options::default())?;
    let (size, side) = (scene.size(), SIDE as f64);
    let scale = side / size.width.max(size.height);
    let left = 0.5 * (side - scale * size.width);
    let top = 0.5 * (side - scale * size.height);
    let transform = toon_raster::kurbo::Affine::new([scale, 0.0, 0.0, scale, left, top]);
    let viewport = Viewport { width: SIDE as u32, height: SIDE as u32, transform };
    let settings = Settings { background: Some([255; 4]), threads: 1, ..Settings::default() };
    Ok(Renderer::new(settings)?.render(&scene, &viewport)?.data().to_vec())
}

/// Mean colours of its cells, row by row: red, green, blue.
pub fn cells(picture: &[u8]) -> Vec<u8> {
    let mut sums = vec![0_usize; (SIDE / CELL) * (SIDE / CELL) * 3];
    for (at, pixel) in picture.chunks(4).enumerate() {
        let cell = (at / SIDE / CELL) * (SIDE / CELL) + at % SIDE / CELL;
        (0..3).for_each(|c| sums[cell * 3 + c] += usize::from(pixel[c]));
    }
    sums.into_iter().map(|sum| ((sum + CELL * CELL / 2) / (CELL * CELL)) as u8).collect()
}
