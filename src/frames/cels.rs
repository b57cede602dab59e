//! Takes drawings that have much in common, makes their scenes: what of a drawing was in one before is not
//! parsed again. A cel is one element that stands by itself, as its layer of celluloid would.
//!
//! Promises: the scene that the whole drawing makes; bounded memory.

use super::shelf::Shelf;
use super::split::{Role, Split};
use crate::scene::images::Images;
use crate::scene::load;
use crate::scene::parts::{assemble, cut, ScenePart, CUT};
use crate::scene::print::{of_bytes, Print};
use crate::{Options, Scene};
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::sync::Arc;

/// Cels of drawings long ago are dropped when all take more than this, in bytes.
const ROOM: usize = 128 << 20;

/// The cels of drawings made lately.
pub struct Cels {
    shelf: Shelf<ScenePart>,
    images: Arc<Images>,
}

impl Default for Cels {
    fn default() -> Cels {
        Cels { shelf: Shelf::new(ROOM), images: Arc::default() }
    }
}

/// Writes the text at some bytes of a drawing, as it is at the moment.
type Fill<'f> = dyn Fn(Range<usize>, &mut String) + 'f;

impl Cels {
    /// Nothing yet.
    pub fn new() -> Cels {
        Cels::default()
    }

    /// The scene of an SVG or svgz; `None` where it must be parsed whole, be it for what is wrong with it or
    /// there is to warn of.
    pub fn scene(&self, bytes: &[u8], options: &Options) -> Option<Scene> {
        let text = load::text(bytes, &options.limits).ok()?;
        let split = Split::new(&text, options.usvg.style_sheet.as_deref(), &[])?;
        self.of_split(&split, &|bytes, out| out.push_str(&text[bytes]), options)
    }

    /// The scene of a drawing in pieces.
    pub(super) fn of_split(&self, split: &Split, fill: &Fill, options: &Options) -> Option<Scene> {
        let moment = Moment::new(split, fill)?;
        let drawn: Vec<usize> = moment.of_role(Role::Drawn).collect();
        let closures = drawn.iter().map(|&piece| moment.closure(piece)).collect::<Vec<_>>();
        let prints: Vec<Print> =
            drawn.iter().zip(&closures).map(|(&piece, closure)| moment.print(piece, closure)).collect();
        let (mut parts, now) = self.shelf.find(prints.iter().copied().map(Some));
        let missing: Vec<usize> = (0..drawn.len()).filter(|&i| parts[i].is_none()).collect();
        if !missing.is_empty() {
            let pieces = missing.iter().map(|&i| drawn[i]).collect();
            let linked = missing.iter().flat_map(|&i| closures[i].iter().copied()).collect();
            let tree = load::straight_tree(&moment.text(&pieces, &linked), options).ok()??;
            let made = cut(&tree, missing.len(), &self.images).ok()??;
            for (&i, part) in missing.iter().zip(made) {
                parts[i] = Some(Arc::new(part));
            }
            let new = missing.iter().filter_map(|&i| {
                let part = parts[i].as_ref()?;
                Some((prints[i], part.clone(), part.weight()))
            });
            self.shelf.keep(new, now);
        }
        assemble(parts.iter().flatten().map(Arc::as_ref))
    }
}

/// A drawing in pieces, as it is at one moment.
struct Moment<'s> {
    split: &'s Split,
    fill: &'s Fill<'s>,
    /// Of each piece's text.
    prints: Vec<Print>,
    /// Of what holds inside each start tag: the style sheets, and the tags around.
    inside: HashMap<usize, Print>,
    /// What pieces with holes link to now.
    links: HashMap<usize, Vec<usize>>,
}

impl<'s> Moment<'s> {
    fn new(split: &'s Split, fill: &'s Fill<'s>) -> Option<Moment<'s>> {
        let mut links = HashMap::new();
        let mut prints = Vec::with_capacity(split.pieces.len());
        let mut text = String::new();
        for (number, piece) in split.pieces.iter().enumerate() {
            let print = match piece.print {
                Some(print) => print,
                None => {
                    text.clear();
                    fill(piece.bytes.clone(), &mut text);
                    links.insert(number, split.links(&text)?);
                    of_bytes(text.as_bytes())
                }
            };
            prints.push(print);
        }
        let of_role = |role| split.pieces.iter().enumerate().filter(move |(_, piece)| piece.role == role);
        let mut sheets = Print::new(6);
        of_role(Role::StyleSheet).for_each(|(number, _)| sheets.add_print(prints[number]));
        let mut inside = HashMap::new();
        for (number, piece) in of_role(Role::Tag) {
            let mut print = inside.get(&piece.within).copied().unwrap_or(sheets);
            print.add_print(prints[number]);
            inside.insert(number, print);
        }
        Some(Moment { split, fill, prints, inside, links })
    }

    fn of_role(&self, role: Role) -> impl Iterator<Item = usize> + '_ {
        self.split.pieces.iter().enumerate().filter(move |(_, piece)| piece.role == role).map(|(n, _)| n)
    }

    fn links(&self, piece: usize) -> &[usize] {
        self.links.get(&piece).unwrap_or(&self.split.pieces[piece].links)
    }

    /// All pieces that one links to, and those that they link to, but for itself.
    fn closure(&self, piece: usize) -> BTreeSet<usize> {
        let mut closure = BTreeSet::new();
        let mut next = self.links(piece).to_vec();
        while let Some(linked) = next.pop() {
            if linked != piece && closure.insert(linked) {
                next.extend_from_slice(self.links(linked));
            }
        }
        closure
    }

    /// Of all that a piece's scene depends on.
    fn print(&self, piece: usize, closure: &BTreeSet<usize>) -> Print {
        let mut print = Print::new(7);
        for &piece in std::iter::once(&piece).chain(closure) {
            print.add_print(self.inside[&self.split.pieces[piece].within]);
            print.add_print(self.prints[piece]);
        }
        print
    }

    /// A drawing of some pieces, with a cut before each, and those that they link to.
    fn text(&self, drawn: &BTreeSet<usize>, linked: &BTreeSet<usize>) -> String {
        let mut text = String::new();
        for (number, piece) in self.split.pieces.iter().enumerate() {
            let around = match piece.role {
                Role::Tag | Role::StyleSheet => ("", ""),
                Role::Drawn if drawn.contains(&number) => (CUT, ""),
                Role::Linked if linked.contains(&number) => ("", ""),
                Role::Drawn if linked.contains(&number) => ("<defs>", "</defs>"),
                _ => continue,
            };
            text.push_str(around.0);
            (self.fill)(piece.bytes.clone(), &mut text);
            text.push_str(around.1);
        }
        text
    }
}
