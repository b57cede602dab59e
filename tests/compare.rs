//! Drives `toon-raster compare` as a user does: the table, the JSON, the page, the cache, what it says
//! when something is wrong.

use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// Two triangles that share a border, a circle, and a thin line.
const DRAWING: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="30">
    <rect width="40" height="30" fill="#fff"/><path d="M2 2H30L2 25z" fill="#36c"/><path d="M30 2V25H2z" fill="#36c"/>
    <circle cx="28" cy="18" r="8.3" fill="#e82"/><path d="M1 27.3L39 29.1" stroke="#000" stroke-width=".3"/></svg>"##;

/// A folder of its own for each test, removed at its end, with the drawing in it.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Folder {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let folder =
            Folder(std::env::temp_dir().join(format!("toon-raster-compare-{}-{count}", std::process::id())));
        fs::create_dir_all(&folder.0).unwrap();
        folder.write("in.svg", DRAWING);
        folder
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.join(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap()
    }

    /// Without a cache unless asked for, few runs.
    fn compare(&self, arguments: &[&str]) -> Output {
        let quick = if arguments.contains(&"--cache") { None } else { Some("--no-cache") };
        self.program(&[&["compare", "--runs", "2"], arguments, quick.as_slice()].concat())
    }

    fn program(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_toon-raster"));
        command.current_dir(&self.0).args(arguments).stdin(Stdio::null()).output().unwrap()
    }

    fn records(&self, arguments: &[&str]) -> Vec<Value> {
        let output = self.compare(&[arguments, &["--json", "-"]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        serde_json::from_slice(&output.stdout).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// One line, this exit code.
#[track_caller]
fn assert_one_line(output: &Output, code: i32, contains: &str) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.contains(contains), "{text}");
}

#[test]
fn the_table_has_a_row_for_each_method_and_says_how_exact_the_reference_is() {
    let folder = Folder::new();
    let output = folder.compare(&["in.svg", "--methods", "exact,none"]);
    assert!(output.status.success());
    let table = stdout(&output);
    for text in ["in.svg: 40 x 30 pixels", "\nexact ", "\nnone ", "rms", "seam", "flip", "reference: "] {
        assert!(table.contains(text), "no {text:?} in {table}");
    }
    assert!(table.lines().all(|line| line.chars().count() <= 120), "{table}");
    assert_eq!(stderr(&output), "", "there is nothing to complain about");
}

#[test]
fn the_json_has_the_documented_fields() {
    let folder = Folder::new();
    let records = folder.records(&["in.svg", "--methods", "exact,none", "-t", "1", "--pan", "2", "--curves"]);
    assert_eq!(records.len(), 2);
    for record in &records {
        assert_eq!(record["input"], "in.svg");
        assert_eq!((&record["width"], &record["height"]), (&40.into(), &30.into()));
        assert_eq!(record["threads"], 1);
        for number in ["parse_ms", "encode_ms"] {
            assert!(record[number].as_f64().unwrap() > 0.0, "{number}");
        }
        assert_eq!(record["raster_ms"]["runs"], 2);
        let [min, median, max] = ["min", "median", "max"].map(|k| record["raster_ms"][k].as_f64().unwrap());
        assert!(0.0 < min && min <= median && median <= max);
        let fields =
            ["mean", "rms", "max", "over_half", "over_1", "over_4", "over_16", "psnr", "ssim", "flip"];
        for field in fields {
            assert!(record["error"][field].is_number(), "{field}");
        }
        assert!(record["reference"]["how"].is_string());
        assert!(record["reference"]["own_error"][0]["max"].as_f64().unwrap() < 0.5);
        assert!(record["seams"]["mean"].is_number());
        assert!(record["pan"]["flicker"].is_number());
        assert!(record["times"]["exact"].as_f64().unwrap() > 0.0);
        assert!(record["failed"].is_null());
    }
    let [exact, none] = &records[..] else { unreachable!() };
    assert_eq!((&exact["method"], &none["method"]), (&"exact".into(), &"none".into()));
    assert!(exact["error"]["max"].as_f64().unwrap() < 1.0, "{}", exact["error"]);
    assert!(none["error"]["max"].as_f64().unwrap() > 50.0, "{}", none["error"]);
    assert!(none["pan"]["flicker"].as_f64() > exact["pan"]["flicker"].as_f64());
    assert!(none["worst"][0]["error"].as_f64().unwrap() > 50.0);
    assert_eq!(exact["curves"][0]["parameter"], "tolerance");
}

#[test]
fn several_drawings_are_compared_and_one_that_fails_does_not_stop_the_others() {
    let folder = Folder::new();
    folder.write("two.svg", DRAWING);
    folder.write("bad.svg", "this is no drawing");
    let arguments = ["in.svg", "bad.svg", "two.svg", "--methods", "exact", "--json", "all.json"];
    let output = folder.compare(&arguments);
    assert_one_line(&output, 1, "bad.svg: ");
    let records: Vec<Value> = serde_json::from_str(&folder.read("all.json")).unwrap();
    let inputs: Vec<&str> = records.iter().map(|r| r["input"].as_str().unwrap()).collect();
    assert_eq!(inputs, ["in.svg", "two.svg"]);
}

#[test]
fn size_runs_and_methods_are_the_users() {
    let folder = Folder::new();
    let records = folder.records(&["in.svg", "-w", "80", "--methods", "none,exact,none", "--runs", "3"]);
    let methods: Vec<&Value> = records.iter().map(|r| &r["method"]).collect();
    assert_eq!(methods, ["none", "exact"], "in the user's order, each once");
    assert_eq!((&records[0]["width"], &records[0]["height"]), (&80.into(), &60.into()));
    assert_eq!(records[0]["raster_ms"]["runs"], 3);
}

#[test]
fn a_method_has_fewer_runs_where_its_time_is_up_and_says_so() {
    let folder = Folder::new();
    let budget = ["--runs", "500", "--budget", "0.05", "-w", "1600", "-t", "1"];
    let records = folder.records(&[&["in.svg", "--methods", "exact"], &budget[..]].concat());
    let runs = records[0]["raster_ms"]["runs"].as_u64().unwrap();
    assert!((1..500).contains(&runs), "{runs}");
    assert_eq!(records[0]["notes"][0], format!("{runs} of 500 runs: more would take longer than 0.05 s"));
}

#[test]
fn the_reference_follows_background_and_linear_light() {
    let folder = Folder::new();
    let records = folder.records(&["in.svg", "--methods", "exact", "--linear", "--background", "#123"]);
    assert!(records[0]["error"]["max"].as_f64().unwrap() < 1.0, "{}", records[0]["error"]);
}

#[test]
fn all_methods_are_compared_by_default_and_one_that_cannot_is_a_row_with_its_reason() {
    let folder = Folder::new();
    let records = folder.records(&["in.svg"]);
    assert_eq!(records.len(), toon_raster::Method::ALL.len());
    for record in &records {
        assert_ne!(record["failed"].is_null(), record["error"].is_null(), "{record}");
    }
}

#[test]
fn another_renderers_picture_is_compared_too() {
    let folder = Folder::new();
    assert!(folder.program(&["in.svg", "other.png", "--aa", "none"]).status.success());
    let records = folder.records(&["in.svg", "--methods", "none", "--against", "other.png"]);
    assert_eq!(records[1]["method"], "other.png");
    assert_eq!(records[1]["against"], true);
    assert_eq!(records[1]["error"], records[0]["error"], "it is the same picture");
    assert!(records[1]["raster_ms"].is_null());
}

#[test]
fn a_picture_of_another_size_is_one_clear_line() {
    let folder = Folder::new();
    assert!(folder.program(&["in.svg", "other.png", "-w", "20"]).status.success());
    let output = folder.compare(&["in.svg", "--methods", "none", "--against", "other.png"]);
    assert_one_line(&output, 3, "other.png has 20 x 15 pixels, the drawing 40 x 30");
}

#[test]
fn what_is_wrong_with_the_command_line_is_one_line() {
    let folder = Folder::new();
    let cases: [(&[&str], &str); 9] = [
        (&[], "<IN>"),
        (&["in.svg", "--methods", "grid:0"], "'grid:0' needs a number from 1 to 32"),
        (&["in.svg", "--methods", "fancy"], "unknown method 'fancy'"),
        (&["in.svg", "--methods", ""], "unknown method ''"),
        (&["in.svg", "--runs", "0"], "--runs"),
        (&["in.svg", "--pan", "1"], "--pan"),
        (&["in.svg", "--budget", "0"], "--budget"),
        (&["in.svg", "in.svg", "--against", "x.png"], "one drawing"),
        (&["-", "in.svg", "-"], "only once"),
    ];
    for (arguments, contains) in cases {
        assert_one_line(&folder.compare(arguments), 2, contains);
    }
}

#[test]
fn files_that_cannot_be_read_are_one_line() {
    let folder = Folder::new();
    assert_one_line(&folder.compare(&["none.svg"]), 3, "none.svg: no such file");
    assert_one_line(&folder.compare(&["in.svg", "--against", "none.png"]), 3, "none.png: no such file");
    assert_one_line(&folder.compare(&["in.svg", "--against", "in.svg"]), 3, "in.svg: not a PNG");
}

#[test]
fn a_place_that_cannot_be_written_to_is_said_before_the_work() {
    let folder = Folder::new();
    for place in [["--json", "nowhere/all.json"], ["--report", "in.svg"]] {
        let output = folder.compare(&["in.svg", "--methods", "none", place[0], place[1]]);
        assert_one_line(&output, 1, place[1]);
        assert_eq!(stdout(&output), "", "no table");
    }
}

#[test]
fn a_reference_is_kept_and_found_again_and_a_damaged_one_is_made_anew() {
    let folder = Folder::new();
    let arguments = ["in.svg", "--methods", "exact", "--cache", "kept"];
    let first = folder.records(&arguments);
    let second = folder.records(&arguments);
    assert_eq!(
        (&first[0]["reference"]["cached"], &second[0]["reference"]["cached"]),
        (&false.into(), &true.into())
    );
    assert_eq!(first[0]["error"], second[0]["error"]);
    for file in fs::read_dir(folder.0.join("kept")).unwrap() {
        fs::write(file.unwrap().path(), b"damaged").unwrap();
    }
    let third = folder.records(&arguments);
    assert_eq!(third[0]["reference"]["cached"], false);
    assert_eq!(first[0]["error"], third[0]["error"]);
    folder.write("in.svg", &DRAWING.replace("#e82", "#e83"));
    assert_eq!(folder.records(&arguments)[0]["reference"]["cached"], false, "another drawing");
}

#[test]
fn the_report_is_one_file_that_loads_nothing() {
    let folder = Folder::new();
    // A name that would break a page which trusts it.
    folder.write("<b>{{data}}&.svg", DRAWING);
    let arguments =
        ["in.svg", "<b>{{data}}&.svg", "--methods", "exact,none", "--report", "page", "--pan", "2"];
    let output = folder.compare(&arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    let files: Vec<_> =
        fs::read_dir(folder.0.join("page")).unwrap().map(|f| f.unwrap().file_name()).collect();
    assert_eq!(files, ["index.html"]);
    let page = folder.read("page/index.html");
    for loader in [
        "http://",
        "https://",
        "src=\"",
        "@import",
        "url(",
        "fetch(",
        "XMLHttpRequest",
        "<link rel=\"stylesheet",
    ] {
        assert!(!page.contains(loader), "the page has {loader}");
    }
    assert!(page.contains("default-src 'none'"), "the browser is told to load nothing");
    assert!(!page.contains("<b>{{data}}"), "names are escaped");
    let (_, rest) = page.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    let (data, _) = rest.split_once("</script>").unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    let names: Vec<&Value> = data["inputs"].as_array().unwrap().iter().map(|input| &input["name"]).collect();
    assert_eq!(names, ["in.svg", "<b>{{data}}&.svg"]);
    let command = data["circumstances"]["command"].as_str().unwrap();
    assert!(command.starts_with("toon-raster compare --runs 2 in.svg"), "{command}");
    for input in data["inputs"].as_array().unwrap() {
        assert!(input["truth"].as_str().unwrap().starts_with("data:image/png;base64,"));
        assert_eq!(input["pictures"].as_array().unwrap().len(), 2);
    }
}

#[test]
fn progress_is_told_as_json_and_ends_where_it_said() {
    let folder = Folder::new();
    let output = folder.compare(&["in.svg", "--methods", "exact,none", "--progress", "json", "--pan", "2"]);
    let told: Vec<Value> = stderr(&output).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let last = told.last().unwrap();
    assert_eq!(last["done"], last["total"]);
    assert_eq!(last["done"].as_u64(), Some(told.len() as u64));
}

#[test]
fn help_names_every_option() {
    let output = Folder::new().program(&["compare", "--help"]);
    assert!(output.status.success());
    for option in [
        "--methods",
        "--width",
        "--runs",
        "--json",
        "--report",
        "--against",
        "--pan",
        "--cache",
        "--no-cache",
    ] {
        assert!(stdout(&output).contains(option), "{option}");
    }
}
