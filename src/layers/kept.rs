//! Takes the layers of one picture, finds them again for the next by what they were made from, where only some
//! tiles are rendered.

use super::is_blend;
use crate::effects::layer::Layer;
use crate::outlines::Outlines;
use crate::scene::print::Print;
use crate::scene::shader::Shader;
use crate::scene::{Scene, Shape};
use crate::tiles::TilePlan;
use std::sync::Arc;

/// Pixels of the layers that are kept from one picture to the next: 512 MB.
const MOST_KEPT: u64 = 1 << 25;

/// Layers of the last picture, by what they were made from.
#[derive(Default)]
pub(crate) struct KeptLayers(Vec<KeptLayer>);

struct KeptLayer {
    print: Print,
    layer: Arc<Layer>,
    opaque: bool,
}

/// What is wanted of the layers where only some tiles are rendered.
pub(crate) struct Wanted<'a> {
    pub plan: &'a TilePlan,
    pub outlines: &'a Outlines<'a>,
    pub kept: &'a mut KeptLayers,
}

impl Wanted<'_> {
    /// Whether each shape's shader will be asked for.
    pub fn shapes(&self, scene: &Scene) -> Vec<bool> {
        let bounds = self.outlines.shapes.iter().map(|outline| outline.bounds);
        let mut wanted: Vec<bool> = bounds.map(|b| b.is_some_and(|b| self.plan.renders(b))).collect();
        // What blends looks at all that lies below it.
        let blends = |(shape, wanted): (&Shape, &bool)| *wanted && is_blend(&shape.paint);
        if let Some(last) = scene.shapes.iter().zip(&wanted).rposition(blends) {
            wanted[..last].fill(true);
        }
        wanted
    }
}

impl KeptLayers {
    pub fn find(&self, print: Print) -> Option<Shader<'static>> {
        let kept = self.0.iter().find(|kept| kept.print == print)?;
        Some(Shader::Layer { layer: kept.layer.clone(), by: (0, 0), opaque: kept.opaque })
    }

    /// Keeps a shader's layer. One tile that repeats is made again.
    pub fn keep(&mut self, print: Print, shader: Shader<'static>) -> Shader<'static> {
        if let Shader::Layer { layer, opaque, .. } = &shader {
            self.0.push(KeptLayer { print, layer: layer.clone(), opaque: *opaque });
        }
        shader
    }

    /// Keeps the layers of a new picture, and as many of those before as there is room for.
    pub fn take(&mut self, new: KeptLayers) {
        let old = std::mem::replace(self, new);
        let is_new = |print: Print| self.0.iter().any(|kept| kept.print == print);
        let mut old: Vec<_> = old.0.into_iter().filter(|kept| !is_new(kept.print)).collect();
        self.0.append(&mut old);
        let mut pixels = 0;
        self.0.retain(|kept| {
            pixels += kept.layer.rect().area();
            pixels <= MOST_KEPT
        });
    }
}
