//! Runs the program over every file of some folders, two at a time, each within bounds of time and
//! memory, and prints a table: exit code, time, the one line it said, and what `EXPECT.tsv` beside
//! the file expects. Ends with 1 if any file was answered badly: a crash, a signal, a time-out, more
//! than one line, a half-written file, or a success without a picture.
//!
//!     cargo run --release --example nasty_check -- FOLDER...
//!
//! The program is the one built beside this example, or the one that TOON_RASTER names.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

const SECONDS: u64 = 60;
const KIB: u64 = 2 << 20;
const AT_ONCE: usize = 2;

struct Answer {
    file: PathBuf,
    code: Option<i32>,
    time: Duration,
    said: String,
    faults: Vec<&'static str>,
}

fn main() -> ExitCode {
    let mut files = Vec::new();
    for folder in std::env::args_os().skip(1) {
        collect(Path::new(&folder), &mut files);
    }
    if files.is_empty() {
        eprintln!("usage: nasty_check FOLDER...");
        return ExitCode::from(2);
    }
    files.sort();
    let program = program();
    let scratch = std::env::temp_dir().join(format!("toon-raster-nasty-{}", std::process::id()));
    let queue = Mutex::new(files.into_iter());
    let answers = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for worker in 0..AT_ONCE {
            let (queue, answers, program) = (&queue, &answers, &program);
            let scratch = scratch.join(worker.to_string());
            scope.spawn(move || loop {
                let Some(file) = queue.lock().unwrap().next() else { break };
                let answer = ask(program, file, &scratch);
                answers.lock().unwrap().push(answer);
            });
        }
    });
    let _ = std::fs::remove_dir_all(&scratch);
    print(answers.into_inner().unwrap())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "svg" || e == "svgz") {
            files.push(path);
        }
    }
}

fn program() -> PathBuf {
    std::env::var_os("TOON_RASTER").map(PathBuf::from).unwrap_or_else(|| {
        let example = std::env::current_exe().expect("this program has a path");
        example.parent().and_then(Path::parent).expect("target/PROFILE/examples").join("toon-raster")
    })
}

fn ask(program: &Path, file: PathBuf, scratch: &Path) -> Answer {
    let _ = std::fs::remove_dir_all(scratch);
    std::fs::create_dir_all(scratch).expect("a scratch folder");
    let picture = scratch.join("out.png");
    let started = Instant::now();
    let mut child = Command::new("sh")
        .args(["-c", &format!("ulimit -v {KIB}; exec \"$@\""), "sh"])
        .arg(program)
        .args([&file, &picture])
        .stdin(Stdio::null())
        .stderr(std::fs::File::create(scratch.join("said")).expect("a file"))
        .spawn()
        .expect("the program starts");
    let code = loop {
        if let Some(status) = child.try_wait().expect("the child is ours") {
            break status.code();
        }
        if started.elapsed() > Duration::from_secs(SECONDS) {
            let _ = child.kill();
            let _ = child.wait();
            break Some(-1);
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let time = started.elapsed();
    let said = std::fs::read_to_string(scratch.join("said")).unwrap_or_default();
    std::fs::remove_file(scratch.join("said")).expect("it was made");
    let faults = faults(code, &said, &picture, scratch);
    Answer { file, code, time, said, faults }
}

fn faults(code: Option<i32>, said: &str, picture: &Path, scratch: &Path) -> Vec<&'static str> {
    let errors = said.lines().filter(|line| !line.contains(": warning: ")).count();
    let whole = std::fs::File::open(picture)
        .map_err(|_| ())
        .and_then(|f| png::Decoder::new(std::io::BufReader::new(f)).read_info().map_err(|_| ()))
        .and_then(|mut png| {
            let mut pixels = vec![0; png.output_buffer_size().ok_or(())?];
            png.next_frame(&mut pixels).map_err(|_| ())
        })
        .is_ok();
    let left = std::fs::read_dir(scratch).map_or(0, |entries| entries.count());
    let mut faults = Vec::new();
    match code {
        None => faults.push("died of a signal"),
        Some(-1) => faults.push("took too long"),
        Some(0) if !whole => faults.push("success without a whole picture"),
        Some(0) if errors > 0 => faults.push("success with an error line"),
        Some(0) if left != 1 => faults.push("left another file"),
        Some(0) => {}
        Some(3) if errors != 1 => faults.push("not one line"),
        Some(3) if left != 0 => faults.push("left a file"),
        Some(3) => {}
        Some(_) => faults.push("wrong exit code"),
    }
    if said.contains("panicked") || said.contains("internal error") || said.contains("parser failed") {
        faults.push("panicked");
    }
    faults
}

fn print(mut answers: Vec<Answer>) -> ExitCode {
    answers.sort_by(|a, b| a.file.cmp(&b.file));
    let mut expected: HashMap<PathBuf, String> = HashMap::new();
    let folders: std::collections::BTreeSet<&Path> = answers.iter().filter_map(|a| a.file.parent()).collect();
    for folder in folders {
        let table = std::fs::read_to_string(folder.join("EXPECT.tsv")).unwrap_or_default();
        for (file, expectation) in table.lines().filter_map(|line| line.split_once('\t')) {
            expected.insert(folder.join(file), expectation.to_string());
        }
    }
    println!("{:>4} {:>8}  file | expected | said | faults", "exit", "ms");
    for Answer { file, code, time, said, faults } in &answers {
        let name: PathBuf = file.iter().rev().take(2).collect::<Vec<_>>().into_iter().rev().collect();
        let said = said.lines().map(|l| l.rsplit_once(".svg: ").map_or(l, |(_, what)| what));
        println!(
            "{:>4} {:>8}  {} | {} | {} | {}",
            code.map_or("sig".to_string(), |c| c.to_string()),
            time.as_millis(),
            name.display(),
            expected.get(file).map_or("", String::as_str),
            said.collect::<Vec<_>>().join(" // "),
            faults.join(", ")
        );
    }
    let bad = answers.iter().filter(|a| !a.faults.is_empty()).count();
    let done = answers.iter().filter(|a| a.code == Some(0)).count();
    println!("{} files: {done} rendered, {bad} answered badly", answers.len());
    ExitCode::from(u8::from(bad > 0))
}
