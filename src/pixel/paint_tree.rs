//! Takes what lies over one region of a pixel, front to back, makes the region's colour: sheets go over
//! one another, and groups fade, mask and blend as wholes.
//!
//! A list is flat, with marks where groups start and end:
//!
//! | group | in the list, front to back | gives |
//! |---|---|---|
//! | faded | start, content, end | the content at less opacity |
//! | masked | start, mask, middle, content, end | the content times what the mask shows |
//! | blended | start, source, end, backdrop | the source blended with all behind it in the group around it |
//! | blended | source, backdrop | the same for a source of one colour |
//!
//! A blended group's backdrop ends where the group around it does, and needs no mark.

use super::resolve::NEGLIGIBLE;
use crate::effects::blend;
use crate::effects::layer::Pixel;
use crate::effects::mask;
use crate::scene::paint::Sheet;
use usvg::{BlendMode, MaskType};

/// How a group meets what is around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Composite {
    /// Of the group as a whole, 0 ..= 1.
    pub opacity: f32,
    pub effect: Effect,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Effect {
    /// Painted over what lies behind it.
    Fade,
    /// What comes before the middle is the mask.
    Mask(MaskType),
    Blend(BlendMode),
}

impl Composite {
    pub fn faded(opacity: f32) -> Composite {
        Composite { opacity, effect: Effect::Fade }
    }
}

/// A mask's share of what it masks, 0 ..= 1.
pub(crate) fn shown(kind: MaskType, mask: Sheet) -> f32 {
    let [r, g, b, through] = mask.channels();
    mask::shown(kind, [r, g, b, 1.0 - through])
}

/// A blended source of one colour.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blended {
    sheet: Sheet,
    source: blend::Source,
}

impl Blended {
    pub fn new(mode: BlendMode, sheet: Sheet) -> Blended {
        Blended { sheet, source: blend::Source::new(mode, pixel_of(sheet)) }
    }

    /// The sheet that stands for it and all that lies behind it in its group; `background` is what will be put
    /// behind that, if it is part of the backdrop.
    #[inline]
    pub fn before(&self, behind: Sheet, background: Sheet) -> Sheet {
        let through = self.sheet.through();
        if through >= 1.0 {
            return behind;
        }
        if background.through() < 1.0 {
            return self.before_background(behind, background);
        }
        let mut seen = self.source.before(behind.channels(), 1.0 - behind.through());
        seen[3] = self.source.through(through, behind.through());
        Sheet::from_channels(seen)
    }

    /// Apart, so that the usual way is short.
    #[inline(never)]
    fn before_background(&self, behind: Sheet, background: Sheet) -> Sheet {
        let (through, [r, g, b, alpha]) = (self.sheet.through(), pixel_of(behind.over(background)));
        let seen = self.source.before([r, g, b, alpha], alpha);
        // What, over the backdrop, comes out as what is seen. Of `plus-lighter` it may be more than its alpha.
        let own = [seen[0] - through * r, seen[1] - through * g, seen[2] - through * b, through];
        Sheet::from_channels(own.map(|v| v.max(0.0))).over(behind)
    }
}

fn pixel_of(sheet: Sheet) -> Pixel {
    let [r, g, b, through] = sheet.channels();
    [r, g, b, 1.0 - through]
}

/// A group that is open.
#[derive(Clone, Copy, Debug)]
struct Open {
    /// What stands in front of it.
    before: Sheet,
    part: Part,
    /// As in the tree, of what is around it.
    hidden: bool,
    vague: bool,
}

/// Which part of a group is being painted.
#[derive(Clone, Copy, Debug)]
enum Part {
    Content(Composite),
    /// What a mask shows; `None` when that is not known yet.
    Masked(Option<f32>),
    /// Behind a blended source.
    Backdrop(BlendMode, Sheet),
}

/// Composites one region after the other.
#[derive(Debug)]
pub(crate) struct PaintTree {
    front: Sheet,
    /// Is nothing that comes next in the innermost group seen, whatever `front` is?
    hidden: bool,
    /// Does `front` stand in for a colour that is not known yet?
    vague: bool,
    open: Vec<Open>,
}

impl Default for PaintTree {
    fn default() -> Self {
        PaintTree::behind(Sheet::CLEAR)
    }
}

impl PaintTree {
    /// Behind a sheet.
    pub fn behind(front: Sheet) -> PaintTree {
        PaintTree { front, hidden: false, vague: false, open: Vec::new() }
    }

    /// Starts anew.
    #[inline]
    pub fn clear(&mut self) {
        (self.front, self.hidden, self.vague) = (Sheet::CLEAR, false, false);
        self.open.clear();
    }

    /// Would nothing be seen of what comes next?
    #[inline]
    pub fn is_hidden(&self) -> bool {
        self.front.through() < NEGLIGIBLE || self.hidden
    }

    /// Has nothing been painted yet, nor a group started?
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.front == Sheet::CLEAR && self.open.is_empty()
    }

    /// Would nothing be seen of whatever comes?
    #[inline]
    pub fn is_done(&self) -> bool {
        self.is_hidden() && self.open.is_empty()
    }

    #[inline]
    pub fn paint(&mut self, sheet: Sheet) {
        self.front = self.front.over(sheet);
    }

    /// Paints a sheet with nothing behind it in the innermost group.
    #[inline]
    pub fn knock_out(&mut self, sheet: Sheet) {
        self.paint(sheet);
        self.hidden = true;
    }

    /// Paints a sheet that lets no less light through than one not known yet.
    pub fn paint_vaguely(&mut self, least: Sheet) {
        self.paint(least);
        self.vague = true;
    }

    pub fn start(&mut self, composite: Composite) {
        self.push(Part::Content(composite), false);
    }

    /// Goes on behind a blended source.
    #[inline]
    pub fn blend(&mut self, mode: BlendMode, source: Sheet) {
        if source.through() < 1.0 {
            self.push(Part::Backdrop(mode, source), false);
        }
    }

    #[inline]
    fn push(&mut self, part: Part, hidden: bool) {
        let hidden = hidden || self.is_hidden();
        self.open.push(Open { before: self.front, part, hidden: self.hidden, vague: self.vague });
        (self.front, self.hidden, self.vague) = (Sheet::CLEAR, hidden, false);
    }

    /// Goes back to what stands before the innermost group, and gives its part.
    fn pop(&mut self) -> Part {
        let open = self.open.pop().expect("groups end after they start");
        (self.front, self.hidden) = (open.before, open.hidden);
        self.vague |= open.vague;
        open.part
    }

    /// Between a mask and what it masks.
    pub fn middle(&mut self) {
        self.end_backdrops(Sheet::CLEAR);
        let (mask, vague) = (self.front, self.vague);
        let Part::Content(Composite { opacity, effect: Effect::Mask(kind) }) = self.pop() else {
            unreachable!("only masks have a middle");
        };
        let share = (!vague).then(|| opacity * shown(kind, mask));
        self.push(Part::Masked(share), share == Some(0.0));
    }

    pub fn end(&mut self) {
        self.end_backdrops(Sheet::CLEAR);
        let inner = self.front;
        match self.pop() {
            Part::Content(Composite { opacity, effect: Effect::Blend(mode) }) => {
                let source = inner.faded(opacity);
                match self.vague {
                    true => self.push(Part::Backdrop(mode, source), false),
                    false => self.blend(mode, source),
                }
            }
            Part::Content(Composite { opacity, .. }) => self.paint(inner.faded(opacity)),
            Part::Masked(Some(share)) => self.paint(inner.faded(share)),
            // Nothing is known of it but that it may be seen.
            Part::Masked(None) => {}
            Part::Backdrop(..) => unreachable!("they have been ended"),
        }
    }

    /// Ends the backdrops that go as far as the group around them.
    fn end_backdrops(&mut self, background: Sheet) {
        while let Some(&Open { part: Part::Backdrop(mode, source), .. }) = self.open.last() {
            let behind = self.front;
            self.pop();
            self.paint(Blended::new(mode, source).before(behind, background));
        }
    }

    /// The colour, before a background.
    pub fn over(&mut self, background: Sheet) -> Sheet {
        self.end_backdrops(background);
        debug_assert!(self.open.is_empty(), "groups end");
        self.front.over(background)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [f32; 3] = [1.0, 0.0, 0.0];
    const WHITE: [f32; 3] = [1.0; 3];

    fn assert_near(found: Sheet, expected: [f32; 4]) {
        let near = found.channels().iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(near, "{found:?} is not {expected:?}");
    }

    #[test]
    fn a_backdrop_ends_with_the_group_around_its_source() {
        let multiply = Composite { opacity: 1.0, effect: Effect::Blend(BlendMode::Multiply) };
        let picture = |grouped: bool| {
            let mut tree = PaintTree::behind(Sheet::CLEAR);
            if grouped {
                tree.start(Composite::faded(1.0));
            }
            tree.start(multiply);
            tree.paint(Sheet::new(WHITE, 1.0));
            tree.end();
            assert!(!tree.is_hidden(), "a source hides nothing, however opaque");
            if grouped {
                tree.end();
            }
            tree.paint(Sheet::new(RED, 1.0));
            tree.over(Sheet::CLEAR)
        };
        assert_near(picture(false), [1.0, 0.0, 0.0, 0.0]);
        assert_near(picture(true), [1.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn a_knock_out_hides_what_lies_behind_it_in_its_own_group() {
        let mut tree = PaintTree::behind(Sheet::CLEAR);
        tree.start(Composite::faded(0.5));
        tree.knock_out(Sheet::new(WHITE, 0.5));
        assert!(tree.is_hidden() && !tree.is_done());
        tree.end();
        assert!(!tree.is_hidden());
        tree.knock_out(Sheet::new(RED, 0.5));
        assert!(tree.is_done());
        assert_near(tree.over(Sheet::CLEAR), [0.25 + 0.75 * 0.5, 0.25, 0.25, 0.75 * 0.5]);
    }

    #[test]
    fn a_background_is_a_backdrop_and_counts_once() {
        let mut tree = PaintTree::behind(Sheet::CLEAR);
        tree.start(Composite { opacity: 1.0, effect: Effect::Blend(BlendMode::Multiply) });
        tree.paint(Sheet::new(WHITE, 0.5));
        tree.end();
        assert_near(tree.over(Sheet::new(RED, 0.5)), [0.25 + 0.25 + 0.25, 0.25, 0.25, 0.25]);
    }

    #[test]
    fn a_mask_fades_what_follows_it_and_a_black_one_hides_it() {
        let masked = |gray: f32| {
            let mut tree = PaintTree::behind(Sheet::CLEAR);
            tree.start(Composite { opacity: 0.5, effect: Effect::Mask(MaskType::Luminance) });
            tree.paint(Sheet::new([gray; 3], 1.0));
            tree.middle();
            let hidden = tree.is_hidden();
            tree.paint(Sheet::new(RED, 1.0));
            tree.end();
            (tree.over(Sheet::CLEAR), hidden)
        };
        assert_near(masked(0.5).0, [0.25, 0.0, 0.0, 0.75]);
        assert!(masked(0.0).1 && !masked(0.5).1);
    }

    #[test]
    fn a_mask_not_known_yet_hides_neither_its_content_nor_what_lies_behind() {
        let mut tree = PaintTree::behind(Sheet::CLEAR);
        tree.start(Composite { opacity: 1.0, effect: Effect::Mask(MaskType::Alpha) });
        tree.paint_vaguely(Sheet::CLEAR);
        tree.middle();
        assert!(!tree.is_hidden());
        tree.paint(Sheet::new(RED, 1.0));
        tree.end();
        assert!(!tree.is_done());
    }
}
