//! Opens and closes groups as a band comes to their shapes, front to back.
//!
//! Most groups are complete when they close, and are painted into the cel around them. Two are not: a mask
//! waits for what it masks, which comes next, in its cel; and a blended group waits for all that comes
//! behind it in the group around it, whose cel keeps it ([`crate::cel`]).

use super::{BandRenderer, Picture};
use crate::cel::{Cel, Rows};
use crate::coverage::Coverage;
use crate::scene::paint::Sheet;
use crate::scene::{GroupId, Role};

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
    /// A mask that is complete.
    Mask,
}

impl OpenGroup {
    pub const PICTURE: OpenGroup = OpenGroup { group: 0, level: 0, state: State::Open };

    fn is_painted(&self) -> bool {
        self.state == State::Open
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
                State::Open if top.level < kept => break,
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
        self.cels[0].resume(picture.around.background, self.coverage.parts(), &mut self.entries);
    }

    /// How many groups of a path, from the picture inwards, shapes can be painted in as it is.
    fn levels_in(&self, path: &[GroupId]) -> usize {
        let painted = self.open.iter().filter(|open| open.is_painted());
        painted.zip(path).take_while(|(open, group)| open.group == **group).count()
    }

    /// Gives a group a cel.
    fn open_group(&mut self, picture: &Picture, new: OpenGroup, rows: &Rows) {
        let depth = self.open.len();
        if self.cels.len() == depth {
            self.cels.push(Cel::new(picture.width));
        }
        let (outer, inner) = self.cels.split_at_mut(depth);
        let scene_group = &picture.scene.groups[new.group as usize];
        match scene_group.role {
            Role::Masked(mask) => {
                let waits = self.open[depth - 1].state == State::Mask && self.open[depth - 1].group == mask;
                let kind = picture.scene.groups[mask as usize].role.mask_type();
                let (mask, parent) = match waits {
                    true => (kind.map(|kind| (&outer[depth - 1], kind)), &outer[depth - 2]),
                    // No shape of the mask meets the band.
                    false => (None, &outer[depth - 1]),
                };
                inner[0].open_behind_mask(mask, parent, scene_group.opacity);
            }
            Role::Mask(_) => {
                inner[0].open_in(&outer[depth - 1], scene_group.opacity);
                inner[0].leave_outside(picture.outlines.masked_by(new.group), rows);
            }
            _ => inner[0].open_in(&outer[depth - 1], scene_group.opacity),
        }
        self.open.push(new);
    }

    /// Closes the group that was opened last, or goes on to what it waits for.
    fn close_last(&mut self, picture: &Picture, rows: &Rows) {
        let depth = self.open.len() - 1;
        let last = self.open[depth];
        if last.is_painted() {
            self.cels[depth].resume(Sheet::CLEAR, self.coverage.parts(), &mut self.entries);
        }
        match (last.state, picture.scene.groups[last.group as usize].role) {
            (State::Open, Role::Mask(_)) => self.open[depth].state = State::Mask,
            (_, role) => self.paint_last(picture, last, role, rows),
        }
    }

    /// Paints the last group, which is complete, into the cel around it.
    fn paint_last(&mut self, picture: &Picture, last: OpenGroup, role: Role, rows: &Rows) {
        let depth = self.open.len() - 1;
        self.open.pop();
        let (outer, inner) = self.cels.split_at_mut(depth);
        let (cel, entries) = (&mut inner[0], &mut self.entries);
        match (last.state, role) {
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
            (_, Role::Blend(mode)) => outer[depth - 1].suspend(cel, mode, rows.count),
            _ => outer[depth - 1].take_group(cel, rows.count, entries),
        }
    }
}
