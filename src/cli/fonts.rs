//! Takes the font options, makes the library's [`FontSource`]; lists what it would hold.

use super::report;
use std::path::PathBuf;
use std::process::ExitCode;
use toon_raster::usvg::fontdb::{Database, Family, Source};
use toon_raster::FontSource;

#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Fonts (loaded only if the drawing has text)")]
pub struct FontOptions {
    /// Load this font file; may be given several times
    #[arg(long = "use-font-file", value_name = "FILE", value_hint = clap::ValueHint::FilePath)]
    files: Vec<PathBuf>,
    /// Load all fonts in this folder; may be given several times
    #[arg(long = "use-fonts-dir", value_name = "DIR", value_hint = clap::ValueHint::DirPath)]
    dirs: Vec<PathBuf>,
    /// Leave the system's fonts alone
    #[arg(long)]
    skip_system_fonts: bool,
    /// Family where the drawing names none
    #[arg(long, value_name = "FAMILY", default_value = "Times New Roman")]
    pub font_family: String,
    /// Size where the drawing names none
    #[arg(long, value_name = "SIZE", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=192))]
    pub font_size: u32,
    /// What `serif` stands for
    #[arg(long, value_name = "FAMILY", default_value = "Times New Roman")]
    serif_family: String,
    /// What `sans-serif` stands for
    #[arg(long, value_name = "FAMILY", default_value = "Arial")]
    sans_serif_family: String,
    /// What `cursive` stands for
    #[arg(long, value_name = "FAMILY", default_value = "Comic Sans MS")]
    cursive_family: String,
    /// What `fantasy` stands for
    #[arg(long, value_name = "FAMILY", default_value = "Impact")]
    fantasy_family: String,
    /// What `monospace` stands for
    #[arg(long, value_name = "FAMILY", default_value = "Courier New")]
    monospace_family: String,
}

impl FontOptions {
    /// Loads nothing yet.
    pub fn source(&self) -> FontSource {
        let options = self.clone();
        FontSource::new(move || options.load())
    }

    fn load(&self) -> Database {
        let mut fonts = Database::new();
        if !self.skip_system_fonts {
            fonts.load_system_fonts();
        }
        for file in &self.files {
            if let Err(e) = fonts.load_font_file(file) {
                log::warn!("the font file {} cannot be loaded: {e}", file.display());
            }
        }
        for dir in &self.dirs {
            fonts.load_fonts_dir(dir);
        }
        fonts.set_serif_family(&self.serif_family);
        fonts.set_sans_serif_family(&self.sans_serif_family);
        fonts.set_cursive_family(&self.cursive_family);
        fonts.set_fantasy_family(&self.fantasy_family);
        fonts.set_monospace_family(&self.monospace_family);
        fonts
    }
}

/// Prints the generic families and every face, as resvg does.
pub fn list(options: &FontOptions) -> ExitCode {
    let fonts = options.load();
    let generic = [
        ("serif", Family::Serif),
        ("sans-serif", Family::SansSerif),
        ("cursive", Family::Cursive),
        ("fantasy", Family::Fantasy),
        ("monospace", Family::Monospace),
    ];
    let mut text = String::new();
    for (name, family) in generic {
        text += &format!("{name}: {}\n", fonts.family_name(&family));
    }
    for face in fonts.faces() {
        let Source::File(path) = &face.source else { continue };
        let families: Vec<String> = face
            .families
            .iter()
            .map(|(name, language)| {
                format!("{name} ({}, {})", language.primary_language(), language.region())
            })
            .collect();
        text += &format!(
            "{}: '{}', {}, {:?}, {:?}, {:?}\n",
            path.display(),
            families.join("', '"),
            face.index,
            face.style,
            face.weight.0,
            face.stretch
        );
    }
    report::print(&text)
}
