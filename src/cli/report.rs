//! What is said on standard error, one line a matter, and the exit codes.

use super::values::ProgressStyle;
use std::io::{self, Write};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use toon_raster::{Error, Warning};

/// Some input of several failed, or a place could not be read or written: trying again may help.
const SOME_FAILED: u8 = 1;
/// The command line is wrong.
const USAGE: u8 = 2;
/// The input can't be rendered: trying again won't help.
const BAD_INPUT: u8 = 3;

/// Why one input did not become a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The input's fault, or that of what was asked of it.
    Input(String),
    /// Reading or writing failed.
    Io(String),
    /// Nothing can be written there, a full disk or a folder without permission: not the next either.
    Place(String),
    /// Nobody reads the output any more: nothing to say, nothing more to do.
    ClosedPipe,
}

impl Failure {
    pub fn input(message: impl Into<String>) -> Failure {
        Failure::Input(message.into())
    }

    pub fn io(message: impl Into<String>) -> Failure {
        Failure::Io(message.into())
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Failure::Input(error.to_string())
    }
}

/// How much is said.
#[derive(Clone, Copy, Debug)]
pub struct Voice {
    pub quiet: bool,
}

/// One line for a failure of the input called `name`.
pub fn failure(name: &str, failure: &Failure) {
    match failure {
        Failure::Input(message) | Failure::Io(message) | Failure::Place(message) => {
            line(&format!("{name}: {message}"))
        }
        Failure::ClosedPipe => {}
    }
}

/// One line a kind for what of the drawing is not drawn.
pub fn warnings(name: &str, warnings: &[Warning], voice: Voice) {
    if voice.quiet {
        return;
    }
    for Warning { kind, element, count } in warnings {
        let others = if *count > 1 { format!(" and {} more", count - 1) } else { String::new() };
        line(&format!("{name}: warning: {kind} are not drawn: {element}{others}"));
    }
}

/// Writes one line to standard error. Whoever closed it does not want to know.
pub fn line(message: &str) {
    let message: String = message.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let _ = writeln!(io::stderr(), "toon-raster: {message}");
}

/// The exit code of a wrong command line, after its line.
pub fn usage(message: &str) -> ExitCode {
    line(message);
    ExitCode::from(USAGE)
}

/// The exit code when `failures` of `inputs` failed.
pub fn exit_code(inputs: usize, failures: &[Failure]) -> ExitCode {
    match failures {
        [] | [Failure::ClosedPipe] => ExitCode::SUCCESS,
        [Failure::Input(_)] if inputs == 1 => ExitCode::from(BAD_INPUT),
        _ => ExitCode::from(SOME_FAILED),
    }
}

/// Prints to standard output; a reader that has left is no error.
pub fn print(text: &str) -> ExitCode {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            line(&format!("standard output cannot be written: {e}"));
            ExitCode::from(SOME_FAILED)
        }
        _ => ExitCode::SUCCESS,
    }
}

/// Turns the message and back trace of a panic off: whoever catches it says one line.
pub fn silence_panics() {
    std::panic::set_hook(Box::new(|_| {}));
}

/// Runs `work`; a panic in it becomes a failure.
pub fn catching<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let why = panic
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| panic.downcast_ref::<&str>().copied())
            .unwrap_or("no reason given");
        Err(Failure::input(format!("internal error, please report it with the drawing: {why}")))
    })
}

/// Tells how many inputs are done.
pub struct Progress {
    style: ProgressStyle,
    total: usize,
    done: usize,
    /// Of those done: nothing was to do.
    skipped: usize,
    started: Instant,
    /// When the bar was last drawn, if it is there.
    drawn: Option<Instant>,
}

impl Progress {
    /// Work shorter than this has no bar.
    const PATIENCE: Duration = Duration::from_secs(1);
    /// Between two drawings of the bar: nobody reads faster.
    const PAUSE: Duration = Duration::from_millis(100);
    const BAR: usize = 30;
    /// Characters of what is being done, so that the bar stays on one line.
    const WORDS: usize = 38;

    pub fn new(style: ProgressStyle, total: usize) -> Progress {
        Progress { style, total, done: 0, skipped: 0, started: Instant::now(), drawn: None }
    }

    /// Says what begins, where the work on one input is known to be long.
    pub fn begin(&mut self, what: &str) {
        if self.style == ProgressStyle::Bar {
            self.draw(what);
        }
    }

    /// One more input is done, without any work.
    pub fn skip(&mut self, name: &str) {
        self.skipped += 1;
        self.tick(name, true);
    }

    /// One more input is done.
    pub fn tick(&mut self, name: &str, ok: bool) {
        self.done += 1;
        let (done, total) = (self.done, self.total);
        match self.style {
            ProgressStyle::None => {}
            ProgressStyle::Json => {
                let name = super::perf::json_string(name);
                let _ =
                    writeln!(io::stderr(), r#"{{"done":{done},"total":{total},"input":{name},"ok":{ok}}}"#);
            }
            ProgressStyle::OpenJd => {
                let share = 100.0 * done as f64 / total as f64;
                let _ =
                    writeln!(io::stderr(), "openjd_progress: {share:.1}\nopenjd_status: {done} of {total}");
            }
            ProgressStyle::Bar if total > 1 && self.is_due() => self.draw(""),
            ProgressStyle::Bar => {}
        }
    }

    fn is_due(&self) -> bool {
        match self.drawn {
            Some(last) => last.elapsed() >= Self::PAUSE,
            None => self.started.elapsed() > Self::PATIENCE,
        }
    }

    fn draw(&mut self, what: &str) {
        let full = Self::BAR * self.done / self.total.max(1);
        let bar: String = (0..Self::BAR).map(|i| if i < full { '#' } else { '.' }).collect();
        let pace = self.pace(self.started.elapsed().as_secs_f64());
        let what: String = what.chars().filter(|c| !c.is_control()).take(Self::WORDS).collect();
        let _ = write!(io::stderr(), "\r[{bar}] {}/{}{pace} {what}\x1b[K", self.done, self.total);
        self.drawn = Some(Instant::now());
    }

    /// The rate and the time left, by the work done in so many seconds.
    fn pace(&self, seconds: f64) -> String {
        let worked = (self.done - self.skipped) as f64;
        if worked == 0.0 {
            return String::new();
        }
        let left = (seconds * (self.total - self.done) as f64 / worked).round() as u64;
        let (hours, minutes, left) = (left / 3600, left / 60 % 60, left % 60);
        let left = match (hours, minutes) {
            (0, 0) => format!("{left} s"),
            (0, _) => format!("{minutes}:{left:02} min"),
            _ => format!("{hours}:{minutes:02} h"),
        };
        format!(", {:.1}/s, {left} left", worked / seconds)
    }

    /// Takes the bar away, before a line or at the end.
    pub fn clear(&mut self) {
        if self.drawn.take().is_some() {
            let _ = write!(io::stderr(), "\r\x1b[K");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_counts_only_what_took_time() {
        let with =
            |total, done, skipped| Progress { done, skipped, ..Progress::new(ProgressStyle::None, total) };
        assert_eq!(with(100, 10, 0).pace(5.0), ", 2.0/s, 45 s left");
        assert_eq!(with(1000, 910, 900).pace(5.0), ", 2.0/s, 45 s left");
        assert_eq!(with(1000, 100, 0).pace(10.0), ", 10.0/s, 1:30 min left");
        assert_eq!(with(100_000, 1, 0).pace(0.5), ", 2.0/s, 13:53 h left");
        assert_eq!(with(100, 40, 40).pace(5.0), "");
    }
}
