//! The exact method (Catmull 1978): a fragment is the list of its irregular pieces, with its area, and
//! what is seen of it is found by geometry. With every shape crisp it is `none`, the jagged one.

use crate::band::Picture;
use crate::bitmap::Bitmap;
use crate::coverage::{BandPlace, Coverage, Part, Parts, Style, TakeSpans};
use crate::edges::Edge;
use crate::pixel::fragment::{Coverer, Fragment};
use crate::pixel::resolve::{Node, Resolver, Surroundings};
use crate::strips::{Buckets, Piece};
use crate::sweep;
use crate::zlist::{settle_gradients, Entry, Head, ZLists};

/// Fragments as geometry.
pub(crate) struct Exact {
    buckets: Buckets,
    pieces: Vec<Piece>,
    nodes: Nodes,
    coverer: Coverer,
    resolver: Resolver,
}

impl Exact {
    pub fn new(width: u32) -> Exact {
        Exact {
            buckets: Buckets::new(width),
            pieces: Vec::new(),
            nodes: Nodes::default(),
            coverer: Coverer::default(),
            resolver: Resolver::default(),
        }
    }
}

/// Formulas over fragments; the number of one is its part.
#[derive(Default)]
pub(crate) struct Nodes(Vec<Node>);

impl Nodes {
    #[inline]
    fn push(&mut self, node: Node) -> u32 {
        self.0.push(node);
        let number = self.0.len() as u32 - 1;
        debug_assert_ne!(number, u32::WHOLE);
        number
    }
}

fn lists<'a>(entries: &'a [Entry<u32>], nodes: &'a Nodes, pieces: &'a [Piece]) -> ZLists<'a> {
    ZLists { entries, nodes: &nodes.0, pieces }
}

impl Parts for Nodes {
    type Fragment = Fragment;
    type Part = u32;

    #[inline(always)]
    fn keep(&mut self, fragment: Fragment) -> u32 {
        self.push(Node::Leaf(fragment))
    }

    fn both(&mut self, a: u32, b: u32) -> u32 {
        self.push(Node::And(a, b))
    }

    fn either(&mut self, a: u32, b: u32) -> u32 {
        self.push(Node::Or(a, b))
    }
}

impl Coverage for Exact {
    type Parts = Nodes;

    fn start(&mut self, picture: &Picture) {
        self.pieces.clear();
        self.nodes.0.clear();
        self.resolver.has_clips = !picture.scene.clips.is_empty();
        self.resolver.has_groups = picture.scene.groups.len() > 1;
        self.resolver.has_shaders = !picture.around.shaders.is_empty();
    }

    fn parts(&mut self) -> &mut Nodes {
        &mut self.nodes
    }

    #[inline(always)]
    fn add(&mut self, edge: &Edge, place: BandPlace, _: Style, finished: &Bitmap) {
        self.buckets.add(edge, place, finished, &mut self.pieces);
    }

    #[inline(always)]
    fn row(
        &mut self,
        row: usize,
        columns: (usize, usize),
        _: BandPlace,
        style: Style,
        take: &mut impl TakeSpans<Nodes>,
    ) {
        let Exact { buckets, pieces, coverer, nodes, .. } = self;
        sweep::row(buckets, (row, columns), style, (coverer, pieces), nodes, take);
    }

    #[inline]
    fn resolve(
        &mut self,
        head: Head,
        entries: &mut [Entry<u32>],
        (x, y): (u32, u32),
        around: &Surroundings,
    ) -> [u8; 4] {
        let Exact { nodes, pieces, resolver, .. } = self;
        let mut mean = lists(entries, nodes, pieces).resolve_simply(head, around, resolver);
        if mean.is_none() && resolver.has_shaders {
            settle_gradients(head, entries, (x, y), around);
            mean = lists(entries, nodes, pieces).resolve_simply(head, around, resolver);
        }
        let lists = lists(entries, nodes, pieces);
        if mean.is_none() && resolver.has_groups {
            mean = lists.few_in_groups(head, around, resolver);
        }
        let mean = mean.unwrap_or_else(|| {
            lists.read(head, resolver);
            resolver.resolve(x, y, pieces, around)
        });
        mean.to_rgba8(around.linear)
    }

    fn take_counts(&mut self) -> Vec<(&'static str, u64)> {
        let counts = std::mem::take(&mut self.resolver.counts);
        vec![
            ("pixels_one_fragment", counts.one_fragment),
            ("pixels_tiled", counts.tiled),
            ("pixels_of_few", counts.few),
            ("pixels_along_borders", counts.along_borders),
            ("pixels_split", counts.split),
            ("pixels_sampled", counts.sampled),
            ("fragments_cleaned", std::mem::take(&mut self.coverer.cleaned)),
            ("fragments_sampled", std::mem::take(&mut self.coverer.sampled)),
            ("split_nodes", self.resolver.take_nodes()),
        ]
    }
}
