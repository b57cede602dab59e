//! argv -> [`Job`], and what each job does. Nothing here is part of the library.
//!
//! | module | takes → makes |
//! |---|---|
//! | [`args`] | argv → [`Job`], or one line on what is wrong with it |
//! | [`values`] | the text of one option → its value |
//! | [`fonts`] | font options → where fonts come from |
//! | [`places`] | inputs and output as named → who goes where |
//! | [`input`] | one input → its bytes, then its tree |
//! | [`size`] | size options, drawing → viewport |
//! | [`render`] | the render job: every input to its place |
//! | [`sequence`] | inputs and output of a sequence as named → frames and where they go |
//! | [`frames`] | the frames job: a sequence to its files, or to one |
//! | [`movie`] | frames → one file of them, in any format |
//! | [`ffmpeg`] | frames → MP4, WebM or WebP by that program |
//! | [`output`] | encoded bytes → a whole file or none |
//! | [`temporary`] | the place of a file to be → a hidden file beside it, which never outlives the work |
//! | [`query`] | the query job: ids and boxes |
//! | [`compare_args`] | argv of `compare` → its job |
//! | [`compare`] | the compare job: every method on every input, to a table, JSON and a page |
//! | [`explain_args`] | argv of `explain` → its job |
//! | [`explain`] | the explain job: what drawings call for, what will run and what it costs |
//! | [`parser_log`] | what the SVG parser logs → warnings |
//! | [`report`] | what is said on standard error, and exit codes |
//! | [`perf`] | times → a table or JSON |
//!
//! A new job is a new arm of [`Job`], a file beside `query.rs` and a line in `main.rs`.

pub mod args;
pub mod compare;
pub mod compare_args;
pub mod explain;
pub mod explain_args;
pub mod ffmpeg;
pub mod fonts;
pub mod frames;
pub mod input;
pub mod movie;
pub mod output;
pub mod painting;
pub mod parser_log;
pub mod perf;
pub mod places;
pub mod query;
pub mod render;
pub mod report;
pub mod sequence;
pub mod size;
pub mod temporary;
pub mod values;
pub mod view;

/// What the user asked for.
pub enum Job {
    /// Drawings to pictures.
    Render(render::RenderJob),
    /// An animated drawing, or many drawings, to frames.
    Frames(Box<frames::FramesJob>),
    /// Ids and boxes of one drawing, on standard output.
    Query(query::QueryJob),
    /// Every method on some drawings: error and time.
    Compare(Box<compare::CompareJob>),
    /// What some drawings call for, on standard output.
    Explain(Box<explain::ExplainJob>),
    /// The font faces that would be used, on standard output.
    ListFonts(fonts::FontOptions),
    /// A completion script, on standard output.
    Completions(clap_complete::Shell),
    /// Help or version, on standard output.
    Print(String),
}
