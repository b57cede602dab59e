//! Takes clip-paths as geometry, answers whether a place lies inside them.

/// How a shape stands to a region: the region lies outside it, is cut by it, or lies inside it.
/// Ordered, so that "and" is the lesser and "or" the greater.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Cover {
    #[default]
    Outside,
    Cut,
    Inside,
}

/// A clip-path at one place: the union of its shapes, and inside another clip-path if it has one.
pub(super) struct Clip {
    pub(super) shapes: Vec<ClipShape>,
    pub(super) within: Option<u32>,
}

/// One shape of a clip-path, itself cut by the clip-paths of the elements it stands in.
pub(super) struct ClipShape {
    pub(super) geometry: u32,
    pub(super) within: Vec<u32>,
}

/// All the clip-paths of a drawing.
#[derive(Default)]
pub(super) struct Clips {
    pub(super) all: Vec<Clip>,
}

impl Clips {
    /// How clip-path `clip` stands to a region of which `covers` gives each geometry's standing.
    pub(super) fn cover(&self, clip: u32, covers: &[Cover]) -> Cover {
        let clip = &self.all[clip as usize];
        let outer = clip.within.map_or(Cover::Inside, |outer| self.cover(outer, covers));
        if outer == Cover::Outside {
            return outer;
        }
        let mut union = Cover::Outside;
        for shape in &clip.shapes {
            let mut cover = covers[shape.geometry as usize];
            for &inner in &shape.within {
                if cover <= union {
                    break;
                }
                cover = cover.min(self.cover(inner, covers));
            }
            union = union.max(cover);
            if union == Cover::Inside {
                break;
            }
        }
        outer.min(union)
    }

    /// Calls `need` with each geometry which cuts the region and has a say in clip-path `clip`.
    pub(super) fn cutting(&self, clip: u32, covers: &[Cover], need: &mut impl FnMut(u32)) {
        let clip = &self.all[clip as usize];
        if let Some(outer) = clip.within {
            self.cutting(outer, covers, need);
        }
        for shape in &clip.shapes {
            let cover = covers[shape.geometry as usize];
            if cover == Cover::Outside {
                continue;
            }
            if cover == Cover::Cut {
                need(shape.geometry);
            }
            for &inner in &shape.within {
                self.cutting(inner, covers, need);
            }
        }
    }
}
