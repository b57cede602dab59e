//! Takes inputs and output as named, makes the plan of a sequence: which frames there are and where they
//! go. Files by pattern (`f.####.svg`, `f_%04d.svg`, `f*.svg`) or folder are sorted as people count.

use super::places::{self, Pattern, Source, Target, Wanted};
use super::values::Format;
use std::path::{Path, PathBuf};

/// Where frames come from.
#[derive(Debug)]
pub enum Origin {
    /// One drawing, at one time after another.
    Animated(Source),
    /// One drawing each.
    Files(Vec<Numbered>),
}

/// A drawing, and the number in its name if it was found by one.
pub type Numbered = (Option<u64>, Source);

impl Origin {
    /// For messages.
    pub fn name(&self) -> String {
        match self {
            Origin::Animated(source) => source.name(),
            Origin::Files(files) => files.first().map_or_else(String::new, |(_, source)| source.name()),
        }
    }
}

/// Where frames go.
#[derive(Debug)]
pub enum Destination {
    /// Each to a file with its number.
    Numbered(Pattern),
    /// Each to a file of this folder, called like its drawing.
    Folder(PathBuf),
    /// All to one.
    One(Target),
}

/// A sequence's inputs; `None` if they are plain files.
///
/// # Errors
/// One line, when nothing is found.
pub fn expand(paths: &[PathBuf]) -> Result<Option<Vec<Numbered>>, String> {
    let mut all = Vec::new();
    let mut expanded = false;
    for path in paths {
        let found = if path.is_dir() {
            listed(path, |name| drawing(name).then_some(None))?
        } else if path.exists() || path.as_os_str() == "-" {
            all.push((None, Source::from_argument(path)));
            continue;
        } else if let (Some(pattern), Some(folder)) = (Pattern::find(path, 2), path.parent()) {
            let in_folder = |name: &str| folder.join(name).to_str().and_then(|p| pattern.number(p)).map(Some);
            listed(folder, in_folder)?
        } else if let Some(glob) =
            path.file_name().and_then(|n| n.to_str()).filter(|n| n.contains(['*', '?']))
        {
            listed(path.parent().unwrap_or(Path::new("")), |name| matches(glob, name).then_some(None))?
        } else {
            all.push((None, Source::from_argument(path)));
            continue;
        };
        if found.is_empty() {
            return Err(match path.is_dir() {
                true => format!("no .svg or .svgz in {}", path.display()),
                false => format!("no file matches {}", path.display()),
            });
        }
        expanded = true;
        all.extend(found);
    }
    Ok(expanded.then_some(all))
}

/// Files of a folder whose names `number` knows, as people count them.
fn listed(folder: &Path, number: impl Fn(&str) -> Option<Option<u64>>) -> Result<Vec<Numbered>, String> {
    let at = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries =
        std::fs::read_dir(at).map_err(|e| format!("the folder {} cannot be read: {e}", at.display()))?;
    let mut found: Vec<(Option<u64>, String)> = entries
        .filter_map(|entry| {
            let entry = entry.ok().filter(|entry| !entry.path().is_dir())?;
            let name = entry.file_name().into_string().ok()?;
            Some((number(&name)?, name))
        })
        .collect();
    found.sort_by(|(a, x), (b, y)| a.cmp(b).then_with(|| natural(x).cmp(&natural(y))).then_with(|| x.cmp(y)));
    found.dedup_by(|(a, _), (b, _)| a.is_some() && a == b);
    Ok(found.into_iter().map(|(number, name)| (number, Source::File(folder.join(name)))).collect())
}

fn drawing(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    !name.starts_with('.') && (name.ends_with(".svg") || name.ends_with(".svgz"))
}

/// What a name sorts by: its runs of digits are numbers.
fn natural(name: &str) -> Vec<(String, u128)> {
    let mut parts = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (text, after) = rest.split_at(digits);
        let end = after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
        parts.push((text.to_lowercase(), after[..end].parse().unwrap_or(u128::MAX)));
        rest = &after[end..];
    }
    parts
}

/// Whether a name is what a pattern with `*` and `?` says.
fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // Where to go on if the last star has to take one more.
    let mut again: Option<(usize, usize)> = None;
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                again = Some((p, n));
                p += 1;
            }
            Some(&c) if c == '?' || c == name[n] => {
                p += 1;
                n += 1;
            }
            _ => match &mut again {
                Some((star, taken)) => {
                    *taken += 1;
                    (p, n) = (*star + 1, *taken);
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|&c| c == '*')
}

/// Where the frames go, and as what.
///
/// # Errors
/// One line, when the place or the format is not one for frames.
pub fn destination(
    origin: &Origin,
    wanted: Wanted,
    format: Option<Format>,
    sheet: bool,
    single: bool,
) -> Result<(Destination, Format, Option<PathBuf>), String> {
    let (destination, format) = place(wanted, format, sheet, single)?;
    if sheet && format != Format::Png {
        return Err("--sheet makes a PNG (name the output .png)".to_string());
    }
    refuse_inputs_as_outputs(origin, &destination)?;
    let folder = match &destination {
        Destination::Folder(folder) => Some(folder.clone()),
        Destination::Numbered(pattern) => pattern.numbered(0).parent().map(Path::to_path_buf),
        Destination::One(_) => None,
    };
    Ok((destination, format, folder.filter(|folder| !folder.as_os_str().is_empty())))
}

fn refuse_inputs_as_outputs(origin: &Origin, destination: &Destination) -> Result<(), String> {
    let Destination::One(Target::File(output)) = destination else { return Ok(()) };
    let Ok(place) = output.canonicalize() else { return Ok(()) };
    let is_it =
        |source: &Source| matches!(source, Source::File(p) if p.canonicalize().is_ok_and(|p| p == place));
    let taken = match origin {
        Origin::Animated(source) => is_it(source),
        Origin::Files(files) => files.iter().any(|(_, source)| is_it(source)),
    };
    match taken {
        true => Err(format!("{} is an input and would be written over", output.display())),
        false => Ok(()),
    }
}

fn place(
    wanted: Wanted,
    format: Option<Format>,
    sheet: bool,
    single: bool,
) -> Result<(Destination, Format), String> {
    let path = match wanted {
        Wanted::Beside(path) | Wanted::Named(path) if path.as_os_str() != "-" => path,
        _ => {
            return match format.or((sheet || single).then_some(Format::Png)) {
                Some(format) if format.is_by_ffmpeg() => {
                    Err(format!("{} is a file (name one; y4m is for pipes)", format.extension()))
                }
                Some(format) if format != Format::Png || sheet || single => {
                    Ok((Destination::One(Target::Stdout), format))
                }
                _ => Err("frames on standard output need --format rgba, y4m, gif or apng".to_string()),
            }
        }
    };
    if let Some(pattern) = Pattern::find(&path, 2) {
        let format = places::format_of(&path, format)?;
        return match format.holds_many() || sheet {
            true => Err(format!(
                "{} is many files, and one {} holds all frames",
                path.display(),
                format.extension()
            )),
            false => Ok((Destination::Numbered(pattern), format)),
        };
    }
    if places::names_folder(&path) {
        let format = format.unwrap_or(Format::Png);
        return match format.holds_many() || sheet {
            true => Err(format!("{} is a folder, and one file holds all frames (name it)", path.display())),
            false => Ok((Destination::Folder(path), format)),
        };
    }
    let format = places::format_of(&path, format)?;
    if format == Format::Png && !sheet && !single {
        return Err(format!(
            "{} is one picture for many frames (use a pattern such as shot.####.png, or .gif, .apng, or --sheet)",
            path.display()
        ));
    }
    Ok((Destination::One(Target::File(path)), format))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_sort_as_people_count() {
        let mut names = ["f10.svg", "f2.svg", "F1.svg", "f2b.svg", "e99.svg"];
        names.sort_by_key(|name| natural(name));
        assert_eq!(names, ["e99.svg", "F1.svg", "f2.svg", "f2b.svg", "f10.svg"]);
    }

    #[test]
    fn stars_and_question_marks_match() {
        for (pattern, name, expected) in [
            ("f*.svg", "f12.svg", true),
            ("f*.svg", "f12.png", false),
            ("f?.svg", "f12.svg", false),
            ("*a*b", "xaabab", true),
            ("*", "", true),
            ("a*a", "a", false),
        ] {
            assert_eq!(matches(pattern, name), expected, "{pattern} {name}");
        }
    }
}
