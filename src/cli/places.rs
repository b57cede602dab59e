//! Takes inputs and output as named, makes the plan: which input goes where, in which format.
//!
//! Promises: every output of a plan is another file, and none is an input.

use super::values::Format;
use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Where a drawing comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    Stdin,
    File(PathBuf),
}

impl Source {
    /// `-` is standard input.
    pub fn from_argument(argument: &Path) -> Source {
        if is_dash(argument) {
            Source::Stdin
        } else {
            Source::File(argument.to_path_buf())
        }
    }

    /// For messages.
    pub fn name(&self) -> String {
        match self {
            Source::Stdin => "standard input".to_string(),
            Source::File(path) => path.display().to_string(),
        }
    }

    /// What a file made from it is called, without extension.
    pub fn stem(&self) -> String {
        match self {
            Source::Stdin => "stdin".to_string(),
            Source::File(path) => {
                path.file_stem().unwrap_or(OsStr::new("out")).to_string_lossy().into_owned()
            }
        }
    }
}

/// Where a picture goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    Stdout,
    File(PathBuf),
}

impl Target {
    /// For messages.
    pub fn name(&self) -> String {
        match self {
            Target::Stdout => "standard output".to_string(),
            Target::File(path) => path.display().to_string(),
        }
    }
}

/// The output as the user named it.
pub enum Wanted {
    /// The second of two positional arguments: one file, whatever its name looks like.
    Beside(PathBuf),
    /// By `-o`: a file, a folder or a pattern.
    Named(PathBuf),
    /// By `-c`.
    Stdout,
}

/// Who goes where.
#[derive(Debug)]
pub struct Plan {
    pub tasks: Vec<(Source, Target)>,
    pub format: Format,
    /// To be made if it is not there.
    pub folder: Option<PathBuf>,
}

/// Makes the plan.
///
/// # Errors
/// One line, when two inputs would get the same output, an output is an input, or the format is unknown.
pub fn plan(
    inputs: &[PathBuf],
    wanted: Wanted,
    format: Option<Format>,
    start_number: u64,
) -> Result<Plan, String> {
    let sources: Vec<Source> = inputs.iter().map(|path| Source::from_argument(path)).collect();
    if sources.iter().filter(|s| **s == Source::Stdin).count() > 1 {
        return Err("standard input can be read only once".to_string());
    }
    let plan = match wanted {
        Wanted::Stdout => to_stdout(sources, format),
        Wanted::Beside(path) | Wanted::Named(path) if is_dash(&path) => to_stdout(sources, format),
        Wanted::Beside(path) => to_file(sources, path, format)?,
        Wanted::Named(path) => match Pattern::find(&path, sources.len()) {
            Some(pattern) => to_pattern(sources, &pattern, &path, format, start_number)?,
            None if names_folder(&path) => to_folder(sources, path, format.unwrap_or(Format::Png))?,
            None if sources.len() == 1 => to_file(sources, path, format)?,
            None => {
                return Err(format!(
                    "{} is one file for {} inputs (end it with / for a folder, or use a pattern such as shot.####.png)",
                    path.display(),
                    sources.len()
                ))
            }
        },
    };
    refuse_inputs_as_outputs(&plan)?;
    Ok(plan)
}

fn is_dash(path: &Path) -> bool {
    path.as_os_str() == "-"
}

pub fn names_folder(path: &Path) -> bool {
    path.is_dir() || path.as_os_str().to_string_lossy().ends_with(std::path::is_separator)
}

fn to_stdout(sources: Vec<Source>, format: Option<Format>) -> Plan {
    let tasks = sources.into_iter().map(|source| (source, Target::Stdout)).collect();
    Plan { tasks, format: format.unwrap_or(Format::Png), folder: None }
}

fn to_file(sources: Vec<Source>, path: PathBuf, format: Option<Format>) -> Result<Plan, String> {
    if path.is_dir() {
        return to_folder(sources, path, format.unwrap_or(Format::Png));
    }
    let format = format_of(&path, format)?;
    let tasks = sources.into_iter().map(|source| (source, Target::File(path.clone()))).collect();
    Ok(Plan { tasks, format, folder: None })
}

fn to_folder(sources: Vec<Source>, folder: PathBuf, format: Format) -> Result<Plan, String> {
    let mut seen: HashMap<String, String> = HashMap::new();
    let mut tasks = Vec::with_capacity(sources.len());
    for source in sources {
        let file = format!("{}.{}", source.stem(), format.extension());
        if let Some(other) = seen.insert(file.clone(), source.name()) {
            return Err(format!(
                "{other} and {} would both become {} (use a pattern such as shot.####.png)",
                source.name(),
                folder.join(file).display()
            ));
        }
        tasks.push((source, Target::File(folder.join(file))));
    }
    Ok(Plan { tasks, format, folder: Some(folder) })
}

fn to_pattern(
    sources: Vec<Source>,
    pattern: &Pattern,
    path: &Path,
    format: Option<Format>,
    start_number: u64,
) -> Result<Plan, String> {
    let format = format_of(path, format)?;
    let numbers = start_number..;
    let tasks =
        sources.into_iter().zip(numbers).map(|(source, n)| (source, Target::File(pattern.numbered(n))));
    let tasks = tasks.collect();
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).map(Path::to_path_buf);
    Ok(Plan { tasks, format, folder })
}

pub fn format_of(path: &Path, asked: Option<Format>) -> Result<Format, String> {
    if let Some(format) = asked {
        return Ok(format);
    }
    let is_device = std::fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir());
    match path.extension().and_then(OsStr::to_str) {
        Some(extension) => super::values::format(extension).map_err(|why| {
            format!("the format of {} cannot be told from its name: {why}, or say --format", path.display())
        }),
        None if is_device => Ok(Format::Png),
        None => Err(format!(
            "the format of {} cannot be told from its name (end it with .png, .gif or the like, or say --format)",
            path.display()
        )),
    }
}

fn refuse_inputs_as_outputs(plan: &Plan) -> Result<(), String> {
    for (source, _) in &plan.tasks {
        let Source::File(input) = source else { continue };
        let Ok(input) = input.canonicalize() else { continue };
        for (_, target) in &plan.tasks {
            let Target::File(output) = target else { continue };
            if output.file_name() == input.file_name() && output.canonicalize().is_ok_and(|o| o == input) {
                return Err(format!("{} is an input and would be written over", output.display()));
            }
        }
    }
    Ok(())
}

/// A file name with a place for a number: `####` or `%04d`.
#[derive(Debug, PartialEq, Eq)]
pub struct Pattern {
    before: String,
    digits: usize,
    after: String,
}

impl Pattern {
    /// The last place for a number in `path`; one `#` alone counts only if there are several inputs.
    pub fn find(path: &Path, inputs: usize) -> Option<Pattern> {
        let text = path.to_str()?;
        if let Some(end) = text.rfind('#').map(|at| at + 1) {
            let start = text[..end].trim_end_matches('#').len();
            if end - start > 1 || inputs > 1 {
                return Some(Pattern::split(text, start, end, end - start));
            }
        }
        for (start, _) in text.rmatch_indices('%') {
            let rest = &text[start + 1..];
            let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            if rest[digits..].starts_with('d') {
                let width = rest[..digits].parse().unwrap_or(0).min(20);
                return Some(Pattern::split(text, start, start + 1 + digits + 1, width));
            }
        }
        None
    }

    fn split(text: &str, start: usize, end: usize, digits: usize) -> Pattern {
        Pattern { before: text[..start].to_string(), digits, after: text[end..].to_string() }
    }

    /// The number in a name of this pattern.
    pub fn number(&self, name: &str) -> Option<u64> {
        let digits = name.strip_prefix(&self.before)?.strip_suffix(&self.after)?;
        let exact = digits.len() == self.digits || (digits.len() > self.digits && !digits.starts_with('0'));
        digits.parse().ok().filter(|_| exact && digits.bytes().all(|b| b.is_ascii_digit()))
    }

    /// The name with this number.
    pub fn numbered(&self, number: u64) -> PathBuf {
        PathBuf::from(format!("{}{number:0digits$}{}", self.before, self.after, digits = self.digits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbered(pattern: &str, inputs: usize) -> Option<String> {
        Pattern::find(Path::new(pattern), inputs).map(|p| p.numbered(7).display().to_string())
    }

    #[test]
    fn hashes_and_percent_d_stand_for_a_padded_number() {
        assert_eq!(numbered("shot.####.png", 1).as_deref(), Some("shot.0007.png"));
        assert_eq!(numbered("a/%04d.png", 2).as_deref(), Some("a/0007.png"));
        assert_eq!(numbered("%d.png", 2).as_deref(), Some("7.png"));
        assert_eq!(numbered("c#.png", 2).as_deref(), Some("c7.png"));
    }

    #[test]
    fn a_pattern_knows_the_numbers_of_its_names() {
        let number = |pattern: &str, name: &str| Pattern::find(Path::new(pattern), 2)?.number(name);
        assert_eq!(number("f.####.svg", "f.0012.svg"), Some(12));
        assert_eq!(number("f.####.svg", "f.12345.svg"), Some(12345));
        assert_eq!(number("f.####.svg", "f.12.svg"), None);
        assert_eq!(number("f.####.svg", "f.0012.png"), None);
        assert_eq!(number("f%d.svg", "f7.svg"), Some(7));
    }

    #[test]
    fn a_plain_name_is_no_pattern() {
        assert_eq!(numbered("c#.png", 1), None);
        assert_eq!(numbered("100%.png", 2), None);
        assert_eq!(numbered("a.png", 2), None);
    }
}
