//! Takes the bytes of an SVG or svgz, makes the tree that usvg parses from it.
//!
//! Promises: bounded memory and time whatever the bytes are (see [`Limits`] and `guard`), no panic,
//! no stack overflow, no network access, no files besides fonts and the images that the drawing names;
//! fonts are asked for only if the drawing has text. Images are not decoded here.

mod arcs;
mod decode;
mod guard;
mod images;
mod links;
mod selectors;
mod unread;

pub(crate) use arcs::has_far_arc;
pub(crate) use links::Styled;
pub(crate) use selectors::check as check_selectors;

use crate::{Error, Options, Warning};
use std::borrow::Cow;
use std::sync::{Arc, Mutex, OnceLock};
use usvg::roxmltree;

/// Namespace of SVG elements.
const SVG_NAMESPACE: &str = "http://www.w3.org/2000/svg";

/// Nesting (elements inside elements, `use` followed) up to which the caller's stack is enough.
/// usvg needs some 2 KiB a level when optimised and 10 KiB when not; threads have 2 MiB.
const SHALLOW: usize = 64;

/// Stack for drawings nested deeper than [`SHALLOW`]; usvg itself refuses more than 1,024 levels.
/// The pages are touched only as far as the nesting goes.
const DEEP_STACK: usize = 128 << 20;

/// How often links in circles are looked for and cut. One round finds them all unless several of
/// them lead to a group around an element which another link led to before.
const ROUNDS: usize = 8;

/// How much a drawing may ask for before it is refused.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Limits {
    /// Bytes of the XML text, after unpacking and with its entities replaced.
    pub bytes: u64,
    /// Elements, counting an element again for each `use`, marker, pattern or mask that draws it.
    pub elements: u64,
}

impl Default for Limits {
    /// 256 MiB of text, a million elements.
    fn default() -> Self {
        Limits { bytes: 256 << 20, elements: 1_000_000 }
    }
}

/// Where fonts come from. Nothing is loaded before the first drawing that has text; then once, for
/// all drawings read with the same options.
pub struct FontSource {
    load: Box<dyn Fn() -> usvg::fontdb::Database + Send + Sync>,
    loaded: OnceLock<Arc<usvg::fontdb::Database>>,
}

impl FontSource {
    /// Fonts come from `load`, called at most once.
    pub fn new(load: impl Fn() -> usvg::fontdb::Database + Send + Sync + 'static) -> FontSource {
        FontSource { load: Box::new(load), loaded: OnceLock::new() }
    }

    /// The fonts of the system.
    pub fn system() -> FontSource {
        FontSource::new(|| {
            let mut fonts = usvg::fontdb::Database::new();
            fonts.load_system_fonts();
            fonts
        })
    }

    /// No font: text is left out.
    pub fn none() -> FontSource {
        FontSource::new(usvg::fontdb::Database::new)
    }

    fn database(&self) -> Arc<usvg::fontdb::Database> {
        self.loaded.get_or_init(|| Arc::new((self.load)())).clone()
    }
}

impl Default for FontSource {
    fn default() -> Self {
        FontSource::system()
    }
}

/// Parses an SVG or svgz (known by its first bytes) in UTF-8, UTF-16 or declared Latin-1.
///
/// # Errors
/// [`Error::Parse`] when the bytes are not SVG, [`Error::Size`] when the drawing has no size,
/// [`Error::Limit`] when it asks for more than the options' [`Limits`].
pub fn tree_from_bytes(bytes: &[u8], options: &Options) -> Result<usvg::Tree, Error> {
    tree_and_warnings(bytes, options).map(|(tree, _)| tree)
}

/// The same, and what is not in the tree because no font for it was found.
///
/// # Errors
/// As [`tree_from_bytes`].
pub fn tree_and_warnings(bytes: &[u8], options: &Options) -> Result<(usvg::Tree, Vec<Warning>), Error> {
    let unmatched = Mutex::default();
    let (tree, mut warnings) = read_tree(bytes, options, &unmatched)?;
    warnings.extend(unmatched.into_inner().unwrap_or_default());
    Ok((tree, warnings))
}

/// The same of text, for drawings in which all goes straight: `None` where links would have to be cut, or
/// there is something to warn of.
pub(crate) fn straight_tree(text: &str, options: &Options) -> Result<Option<usvg::Tree>, Error> {
    let xml = parse_xml(text)?;
    let census = guard::check(&xml, options.usvg.style_sheet.as_deref(), &options.limits)?;
    if !census.circles.is_empty() {
        return Ok(None);
    }
    let unmatched = Mutex::default();
    let tree = tree_from_xml(&xml, &census, options, &unmatched)?;
    let clean = unmatched.into_inner().is_ok_and(|warnings| warnings.is_empty());
    Ok(clean.then_some(tree))
}

/// Text whose font families no font matches.
type Unmatched = Mutex<Vec<Warning>>;

/// The tree, and the circles that had to be cut.
fn read_tree(
    bytes: &[u8],
    options: &Options,
    unmatched: &Unmatched,
) -> Result<(usvg::Tree, Vec<Warning>), Error> {
    let mut warnings: Vec<Warning> = Vec::new();
    let mut text = text(bytes, &options.limits)?;
    for _ in 0..ROUNDS {
        let xml = parse_xml(&text)?;
        let census = guard::check(&xml, options.usvg.style_sheet.as_deref(), &options.limits)?;
        if census.circles.is_empty() {
            let tree = tree_from_xml(&xml, &census, options, unmatched)?;
            warnings.extend(census.unread);
            return Ok((tree, warnings));
        }
        note_circles(&xml, &census.circles, &mut warnings);
        text = guard::cut(&text, &census.circles).into();
    }
    Err(Error::Parse("its elements draw each other in circles".to_string()))
}

/// What warnings call an element: its id, or where it stands.
fn name_of(node: &roxmltree::Node) -> String {
    let line = || node.document().text_pos_at(node.range().start).row;
    let place = || format!("the <{}> in line {}", node.tag_name().name(), line());
    node.attribute("id").map_or_else(place, str::to_owned)
}

/// One warning, which names the first element whose link is cut.
fn note_circles(xml: &roxmltree::Document, circles: &[links::Place], warnings: &mut Vec<Warning>) {
    let Some(first) = circles.iter().map(|place| place.bytes.start).min() else { return };
    if let Some(warning) = warnings.first_mut() {
        warning.count += circles.len();
        return;
    }
    let at = xml.descendants().rfind(|node| node.is_element() && node.range().contains(&first));
    let element = at.as_ref().map_or_else(String::new, name_of);
    let kind = "links by which elements draw themselves";
    warnings.push(Warning { kind, element, count: circles.len() });
}

/// The XML text in the bytes, which is of bounded length with its entities replaced.
pub(crate) fn text<'b>(bytes: &'b [u8], limits: &Limits) -> Result<Cow<'b, str>, Error> {
    let text = decode::text(bytes, limits.bytes)?;
    decode::check_entities(&text, limits.bytes)?;
    Ok(text)
}

pub(crate) fn parse_xml(text: &str) -> Result<roxmltree::Document<'_>, Error> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let xml = roxmltree::Document::parse_with_options(text, options)
        .map_err(|e| Error::Parse(format!("not well-formed XML: {e}")))?;
    check_root(&xml)?;
    Ok(xml)
}

fn tree_from_xml(
    xml: &roxmltree::Document,
    census: &guard::Census,
    options: &Options,
    unmatched: &Unmatched,
) -> Result<usvg::Tree, Error> {
    let usvg_options = usvg_options(options, census.has_text, unmatched);
    let parse = || parse_guarded(xml, &usvg_options);
    if census.depth <= SHALLOW {
        return parse();
    }
    std::thread::scope(|scope| {
        std::thread::Builder::new()
            .stack_size(DEEP_STACK)
            .spawn_scoped(scope, parse)?
            .join()
            .unwrap_or_else(|panic| Err(parser_failed(&*panic)))
    })
}

fn check_root(xml: &roxmltree::Document) -> Result<(), Error> {
    let root = xml.root_element();
    let tag = root.tag_name();
    if tag.name() != "svg" {
        return Err(Error::Parse(format!("not an SVG: the root element is <{}>", tag.name())));
    }
    match tag.namespace() {
        None | Some(SVG_NAMESPACE) => Ok(()),
        Some(other) => Err(Error::Parse(format!(
            "not an SVG: the root element is in the namespace '{other}' (SVG's is {SVG_NAMESPACE})"
        ))),
    }
}

fn parse_guarded(xml: &roxmltree::Document, options: &usvg::Options) -> Result<usvg::Tree, Error> {
    let parse = std::panic::AssertUnwindSafe(|| usvg::Tree::from_xmltree(xml, options));
    match std::panic::catch_unwind(parse) {
        Ok(Ok(tree)) => Ok(tree),
        Ok(Err(usvg::Error::InvalidSize)) => Err(Error::Size(
            "the drawing has no size (width, height and viewBox must be above zero)".to_string(),
        )),
        Ok(Err(usvg::Error::ElementsLimitReached)) => Err(too_many_elements()),
        Ok(Err(usvg::Error::ParsingFailed(roxmltree::Error::NodesLimitReached))) => Err(too_many_elements()),
        Ok(Err(e)) => Err(Error::Parse(e.to_string())),
        Err(panic) => Err(parser_failed(&*panic)),
    }
}

fn too_many_elements() -> Error {
    Error::Limit("nested deeper than 1,024 levels, or more than a million elements with <use>".to_string())
}

fn parser_failed(panic: &(dyn std::any::Any + Send)) -> Error {
    let why = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no reason given");
    Error::Parse(format!("the SVG parser failed on this drawing: {}", why.lines().next().unwrap_or("")))
}

/// The caller's options for usvg, with fonts if they are needed.
fn usvg_options<'a>(options: &'a Options, has_text: bool, unmatched: &'a Unmatched) -> usvg::Options<'a> {
    let given = &options.usvg;
    let fontdb = fonts(options, has_text);
    usvg::Options {
        resources_dir: given.resources_dir.clone(),
        dpi: given.dpi,
        font_family: given.font_family.clone(),
        font_size: given.font_size,
        languages: given.languages.clone(),
        shape_rendering: given.shape_rendering,
        text_rendering: given.text_rendering,
        image_rendering: given.image_rendering,
        default_size: given.default_size,
        image_href_resolver: images::resolver(options),
        font_resolver: usvg::FontResolver {
            select_font: Box::new(|font, fonts| {
                let found = (given.font_resolver.select_font)(font, fonts);
                if found.is_none() {
                    note_unmatched(font, unmatched);
                }
                found
            }),
            select_fallback: Box::new(|c, used, fonts| (given.font_resolver.select_fallback)(c, used, fonts)),
        },
        fontdb,
        style_sheet: given.style_sheet.clone(),
    }
}

/// The fonts to lay out text with, if there is any.
fn fonts(options: &Options, has_text: bool) -> Arc<usvg::fontdb::Database> {
    let given = &options.usvg.fontdb;
    match has_text && given.is_empty() {
        true => options.fonts.database(),
        false => given.clone(),
    }
}

fn note_unmatched(font: &usvg::Font, unmatched: &Unmatched) {
    let Ok(mut warnings) = unmatched.lock() else { return };
    if let Some(warning) = warnings.first_mut() {
        warning.count += 1;
        return;
    }
    let families: Vec<String> = font.families().iter().map(ToString::to_string).collect();
    let element = format!("text in font-family {}", families.join(", "));
    warnings.push(Warning { kind: "texts without a font", element, count: 1 });
}
