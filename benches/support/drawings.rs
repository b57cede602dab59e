//! Takes the command line's choice, makes parsed drawings; nothing here is timed.

use super::scenes::{self, Drawing};
use super::vello::Commands;
use resvg::usvg;
use std::io;
use std::path::{Path, PathBuf};
use toon_raster::Scene;

/// One drawing, in the form that each renderer wants.
pub struct Prepared {
    pub name: String,
    pub tree: usvg::Tree,
    pub scene: Scene,
    pub commands: Commands,
}

/// The generated scenes, or the files of `folder`; only those whose name contains one of `names`, or
/// all when there are none.
pub fn chosen(folder: Option<&Path>, names: &[String]) -> io::Result<Vec<Prepared>> {
    let mut options = usvg::Options::default();
    let drawings = match folder {
        Some(folder) => {
            options.fontdb_mut().load_system_fonts();
            from_folder(folder)?
        }
        None => scenes::all(),
    };
    let wanted = |d: &Drawing| names.is_empty() || names.iter().any(|n| d.name.contains(n.as_str()));
    Ok(drawings.into_iter().filter(wanted).filter_map(|d| prepare(d, &options)).collect())
}

fn prepare(drawing: Drawing, options: &usvg::Options) -> Option<Prepared> {
    let name = drawing.name;
    let tree =
        usvg::Tree::from_data(&drawing.svg, options).map_err(|e| eprintln!("{name}: left out: {e}")).ok()?;
    let scene = Scene::from_tree(&tree).map_err(|e| eprintln!("{name}: left out: {e}")).ok()?;
    let commands = Commands::from_tree(&tree);
    if !commands.left_out().is_empty() {
        eprintln!("{name}: vello_cpu is not given its {}", commands.left_out().join(", "));
    }
    Some(Prepared { name, tree, scene, commands })
}

/// Every .svg and .svgz under `folder`, sorted by path.
fn from_folder(folder: &Path) -> io::Result<Vec<Drawing>> {
    let mut files = Vec::new();
    list(folder, &mut files)?;
    files.sort();
    files
        .into_iter()
        .map(|file| {
            let name = file.strip_prefix(folder).unwrap_or(&file).display().to_string();
            Ok(Drawing { name, svg: std::fs::read(&file)? })
        })
        .collect()
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else if path.extension().is_some_and(|e| e == "svg" || e == "svgz") {
            files.push(path);
        }
    }
    Ok(())
}
