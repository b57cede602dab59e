//! The program `toon-raster`: argv -> job -> exit code.
#![forbid(unsafe_code)]

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::report::silence_panics();
    match cli::args::job(std::env::args_os()) {
        Ok(cli::Job::Render(job)) => cli::render::run(job),
        Ok(cli::Job::Compare(job)) => cli::compare::run(*job),
        Ok(cli::Job::Explain(job)) => cli::explain::run(*job),
        Ok(cli::Job::Frames(job)) => cli::frames::run(*job),
        Ok(cli::Job::Query(job)) => cli::query::run(job),
        Ok(cli::Job::ListFonts(fonts)) => cli::fonts::list(&fonts),
        Ok(cli::Job::Completions(shell)) => cli::args::completions(shell),
        Ok(cli::Job::Print(text)) => cli::report::print(&text),
        Err(usage) => cli::report::usage(&usage),
    }
}
