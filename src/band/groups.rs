//! Opens and closes groups as a band comes to their shapes, front to back.
//!
//! Most groups are complete when they close, and are painted into the cel around them. Two are not: a mask
//! waits for what it masks, which comes next; and a blended group waits for all that comes behind it in
//! the group around it. Each waits in its cel, and what it waits for gets another one.

use super::{BandRenderer, Picture};
use crate::cel::{Cel, Rows};
use crate::coverage::Coverage;
use crate::edges::BAND_ROWS;
use crate::scene::paint::Sheet;
use crate::scene::{GroupId, Role};

/// Pixels of the cels of blended groups that wait at once: 50 MB. Beyond, they are put in z-lists, which is
/// slower.
const MOST_WAITING_PIXELS: usize = 1 << 21;

/// A group, or a part of one, that has a cel.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenGroup {
    group: GroupId,
    /// Groups around it.
    level: usize,
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Shapes are painted in it.
    Open,
    /// The same, behind the blended group that waits before it.
    Backdrop,
    /// A blended group that is complete.
    Source,
    /// A mask that is complete.
    Mask,
}

impl OpenGroup {
    pub const PICTURE: OpenGroup = OpenGroup { group: 0, level: 0, state: State::Open };

    fn is_painted(&self) -> bool {
        matches!(self.state, State::Open | State::Backdrop)
    }
}

impl<C: Coverage> BandRenderer<C> {
    /// Opens and closes groups until `group` is the innermost.
    pub(super) fn enter_group(&mut self, picture: &Picture, group: GroupId, rows: &Rows) {
        if self.open.last().is_some_and(|top| top.group == group && top.is_painted()) {
            return;
        }
        let path = picture.scene.group_path(group);
        let kept = self.levels_in(&path);
        let next = path.get(kept).map(|&next| picture.scene.groups[next as usize].role);
        while let Some(top) = self.open.last() {
            let is_wanted = top.level == kept && next == Some(Role::Masked(top.group));
            match top.state {
                State::Mask if is_wanted => break,
                State::Open | State::Backdrop if top.level < kept => break,
                _ => self.close_last(picture, rows),
            }
        }
        for (level, &group) in path.iter().enumerate().skip(kept) {
            self.open_group(picture, OpenGroup { group, level, state: State::Open }, rows);
        }
    }

    /// Closes all but the picture.
    pub(super) fn close_all(&mut self, picture: &Picture, rows: &Rows) {
        while self.open.len() > 1 {
            self.close_last(picture, rows);
        }
    }

    /// How many groups of a path, from the picture inwards, shapes can be painted in as it is.
    fn levels_in(&self, path: &[GroupId]) -> usize {
        let mut above = usize::MAX;
        for open in self.open.iter().rev().filter(|open| open.is_painted()) {
            if open.level < above {
                if path.get(open.level) == Some(&open.group) {
                    return open.level + 1;
                }
                above = open.level;
            }
        }
        unreachable!("the picture is open")
    }

    /// Gives a group a cel.
    fn open_group(&mut self, picture: &Picture, new: OpenGroup, rows: &Rows) {
        let depth = self.open.len();
        if self.cels.len() == depth {
            self.cels.push(Cel::new(picture.width));
        }
        let (outer, inner) = self.cels.split_at_mut(depth);
        let scene_group = &picture.scene.groups[new.group as usize];
        match (new.state, scene_group.role) {
            // Before it lies the source, and before that the cel in which both will end.
            (State::Backdrop, _) => inner[0].open_in(&outer[depth - 2], 1.0),
            (_, Role::Masked(mask)) => {
                let waits = self.open[depth - 1].state == State::Mask && self.open[depth - 1].group == mask;
                let kind = picture.scene.groups[mask as usize].role.mask_type();
                let (mask, parent) = match waits {
                    true => (kind.map(|kind| (&outer[depth - 1], kind)), &outer[depth - 2]),
                    // No shape of the mask meets the band.
                    false => (None, &outer[depth - 1]),
                };
                inner[0].open_behind_mask(mask, parent, scene_group.opacity);
            }
            (_, Role::Mask(_)) => {
                inner[0].open_in(&outer[depth - 1], scene_group.opacity);
                inner[0].leave_outside(picture.outlines.masked_by(new.group), rows);
            }
            _ => inner[0].open_in(&outer[depth - 1], scene_group.opacity),
        }
        self.open.push(new);
    }

    /// Closes the group that was opened last, or goes on to what it waits for.
    fn close_last(&mut self, picture: &Picture, rows: &Rows) {
        let groups = &picture.scene.groups;
        let depth = self.open.len() - 1;
        let last = self.open[depth];
        let role = groups[last.group as usize].role;
        match (last.state, role) {
            (State::Open, Role::Mask(_)) => self.open[depth].state = State::Mask,
            (State::Open, Role::Blend(_)) if self.may_wait(picture) => {
                self.open[depth].state = State::Source;
                let group = groups[last.group as usize].parent;
                let backdrop = OpenGroup { group, level: last.level - 1, state: State::Backdrop };
                self.open_group(picture, backdrop, rows);
            }
            _ => self.paint_last(picture, last, role, rows),
        }
    }

    /// May one more blended group wait for its backdrop?
    fn may_wait(&self, picture: &Picture) -> bool {
        let waiting = self.open.iter().filter(|open| open.state == State::Source).count();
        let pixels_of_one = 2 * picture.width as usize * BAND_ROWS as usize;
        waiting < (MOST_WAITING_PIXELS / pixels_of_one).clamp(2, 32)
    }

    /// Paints the last group, which is complete, into the cel around it.
    fn paint_last(&mut self, picture: &Picture, last: OpenGroup, role: Role, rows: &Rows) {
        let depth = self.open.len() - 1;
        self.open.pop();
        let (outer, inner) = self.cels.split_at_mut(depth);
        let (cel, entries) = (&mut inner[0], &mut self.entries);
        match (last.state, role) {
            (State::Backdrop, _) => {
                let source = self.open.pop().expect("it waited");
                let Role::Blend(mode) = picture.scene.groups[source.group as usize].role else {
                    unreachable!("only blended groups wait for a backdrop");
                };
                let background = if last.level == 0 { picture.around.background } else { Sheet::CLEAR };
                let (outer, source) = outer.split_at_mut(depth - 1);
                outer[depth - 2].take_blended(&source[0], cel, mode, background, rows.count, entries);
            }
            // What it masks has been painted, or was nowhere to be seen.
            (State::Mask, _) => {}
            (_, Role::Masked(mask)) => {
                let kind = picture.scene.groups[mask as usize].role.mask_type();
                if let (Some(kind), Some(OpenGroup { state: State::Mask, .. })) = (kind, self.open.last()) {
                    self.open.pop();
                    let (outer, mask) = outer.split_at_mut(depth - 1);
                    outer[depth - 2].take_masked((&mask[0], cel), kind, rows.count, entries);
                }
            }
            (_, Role::Blend(mode)) => outer[depth - 1].take_source(cel, mode, rows.count, entries),
            _ => outer[depth - 1].take_group(cel, rows.count, entries),
        }
    }
}
