//! Takes one drawing, prints its ids and boxes as resvg does: `id,x,y,width,height`, in user units.

use super::places::Source;
use super::report::{self, Failure};
use super::{input, render};
use std::process::ExitCode;
use toon_raster::scene::load;
use toon_raster::{usvg, Options};

/// What is asked of which drawing.
pub struct QueryJob {
    pub input: Source,
    /// Every id, or the box of the whole drawing.
    pub all: bool,
    pub options: Options,
}

/// Answers.
pub fn run(job: QueryJob) -> ExitCode {
    let answer = render::on_a_deep_stack(|| report::catching(|| answer(&job)));
    match answer {
        Ok(text) => report::print(&text),
        Err(failure) => {
            report::failure(&job.input.name(), &failure);
            report::exit_code(1, &[failure])
        }
    }
}

fn answer(job: &QueryJob) -> Result<String, Failure> {
    let bytes = input::read(&job.input)?;
    let tree = load::tree_from_bytes(&bytes, &job.options)?;
    if !job.all {
        return Ok(format!("{}\n", format_box(tree.root().abs_layer_bounding_box().to_rect())));
    }
    let mut text = String::new();
    list(tree.root(), &mut text);
    if text.is_empty() {
        return Err(Failure::input("no element has an id"));
    }
    Ok(text)
}

fn list(group: &usvg::Group, text: &mut String) {
    for node in group.children() {
        if !node.id().is_empty() {
            let bounds =
                node.abs_layer_bounding_box().map_or_else(|| node.abs_bounding_box(), |r| r.to_rect());
            *text += &format!("{},{}\n", node.id(), format_box(bounds));
        }
        if let usvg::Node::Group(group) = node {
            list(group, text);
        }
    }
}

fn format_box(bounds: usvg::Rect) -> String {
    let round = |v: f32| (f64::from(v) * 1000.0).round() / 1000.0;
    format!(
        "{},{},{},{}",
        round(bounds.x()),
        round(bounds.y()),
        round(bounds.width()),
        round(bounds.height())
    )
}
