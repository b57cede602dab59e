//! How drawings are read, and what is shown of them: what all jobs have in common that make pictures or plan
//! them.

use super::parser_log;
use super::places::Source;
use super::report::{self, Failure, Voice};
use super::size::{self, Fit, Part};
use std::path::{Path, PathBuf};
use toon_raster::scene::load;
use toon_raster::{usvg, Options, Scene, Settings, Viewport, Warning};

/// A way to look at drawings.
pub struct View {
    pub options: Options,
    /// Where relative links start from; `None` for each drawing's own folder.
    pub resources_dir: Option<PathBuf>,
    pub fit: Fit,
    pub part: Part,
    pub max_pixels: u64,
    pub settings: Settings,
    pub voice: Voice,
}

/// A drawing as it is seen.
pub struct Seen {
    pub scene: Scene,
    pub viewport: Viewport,
    /// What is warned of besides [`Scene::warnings`]: texts that no font matches.
    pub unmatched: Vec<Warning>,
}

impl View {
    /// Reads what links are relative to from where a drawing is.
    pub fn stand_at(&mut self, source: &Source) {
        self.options.usvg.resources_dir = self.resources_dir.clone().or_else(|| folder_of(source));
    }

    /// Parses a drawing, and warns of what of it is not drawn.
    ///
    /// # Errors
    /// What is wrong with it, or with its size.
    pub fn open(&mut self, source: &Source, bytes: &[u8]) -> Result<Seen, Failure> {
        self.stand_at(source);
        self.see(bytes, &source.name())
    }

    /// The same for a drawing that goes by another name, from where one stands.
    ///
    /// # Errors
    /// As [`View::open`].
    pub fn see(&self, bytes: &[u8], name: &str) -> Result<Seen, Failure> {
        parser_log::begin();
        let (tree, unmatched) = load::tree_and_warnings(bytes, &self.options)?;
        let viewport = size::viewport(&tree, &self.part, self.fit, self.max_pixels)?;
        let scene = self.scene(&tree)?;
        warn(name, &scene, &unmatched, self.voice);
        Ok(Seen { scene, viewport, unmatched })
    }

    /// What of a tree is drawn.
    ///
    /// # Errors
    /// When it cannot be.
    pub fn scene(&self, tree: &usvg::Tree) -> Result<Scene, Failure> {
        Ok(match &self.part {
            Part::Element { id, .. } => Scene::from_element(tree, id)?,
            Part::Page | Part::Drawing => Scene::from_tree(tree)?,
        })
    }

    /// Has no pixel of the pictures any transparency?
    pub fn is_opaque(&self) -> bool {
        self.settings.background.is_some_and(|color| color[3] == 255)
    }
}

/// Warns of what of a drawing is not drawn, and of what the parser said of it.
pub fn warn(name: &str, scene: &Scene, unmatched: &[Warning], voice: Voice) {
    report::warnings(name, scene.warnings(), voice);
    report::warnings(name, unmatched, voice);
    parser_log::tell(name);
}

/// Where relative links of a drawing start from.
pub fn folder_of(source: &Source) -> Option<PathBuf> {
    match source {
        Source::Stdin => None,
        Source::File(path) => std::fs::canonicalize(path).ok()?.parent().map(Path::to_path_buf),
    }
}
