//! Opens the page of `toon-raster compare --report` in a real browser and uses it: the slider moves,
//! the table sorts, nothing is loaded, nothing is complained about.
//!
//! It runs where a Chromium is found (`CHROMIUM`, or one of the usual names on the path), and says by
//! name that it is skipped elsewhere. The browser is spoken to in its own protocol over two pipes
//! (`--remote-debugging-pipe`), so that no port and no driver is needed.
#![cfg(unix)]

use serde_json::{json, Value};
use std::collections::VecDeque;
use std::fs::{self, File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

/// For one answer of the browser, or for the page to do what an event asks for, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// How often the page is tried before it is called broken.
const ATTEMPTS: usize = 3;

const DRAWING: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="160" height="120">
    <rect width="160" height="120" fill="#fff"/><path d="M8 8H120L8 100z" fill="#36c"/>
    <circle cx="110" cy="70" r="33.3" fill="#e82"/><path d="M4 109L152 116" stroke="#000" stroke-width=".3"/></svg>"##;

fn browser() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os("CHROMIUM") {
        return Some(named.into());
    }
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];
    std::env::split_paths(&path).flat_map(|dir| names.map(|name| dir.join(name))).find(|file| file.is_file())
}

/// A folder that is gone at the end.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A page in a browser.
struct Page {
    child: Child,
    commands: File,
    messages: Receiver<Value>,
    session: String,
    last_id: u64,
    /// What came unasked.
    events: VecDeque<Value>,
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Page {
    fn open(browser: &Path, folder: &Path) -> Page {
        let [to, from] = ["to", "from"].map(|name| folder.join(name));
        assert!(Command::new("mkfifo").args([&to, &from]).status().unwrap().success());
        let script = r#"exec "$1" --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run \
            --user-data-dir="$2" --remote-debugging-pipe 3<"$3" 4>"$4""#;
        let child = Command::new("sh")
            .args(["-c", script, "sh"])
            .args([browser, &folder.join("profile"), &to, &from])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let commands = OpenOptions::new().write(true).open(&to).unwrap();
        let answers = BufReader::new(File::open(&from).unwrap());
        let (send, messages) = mpsc::channel();
        std::thread::spawn(move || {
            for message in answers.split(0) {
                let Ok(message) = message else { break };
                if send.send(serde_json::from_slice(&message).unwrap()).is_err() {
                    break;
                }
            }
        });
        let session = String::new();
        let mut page = Page { child, commands, messages, session, last_id: 0, events: VecDeque::new() };
        let target = page.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        page.session = page.call("Target.attachToTarget", attach)["sessionId"].as_str().unwrap().to_string();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            page.call(&format!("{domain}.enable"), json!({}));
        }
        page
    }

    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.last_id += 1;
        let mut command = json!({ "id": self.last_id, "method": method, "params": parameters });
        if !self.session.is_empty() {
            command["sessionId"] = json!(self.session);
        }
        let mut bytes = serde_json::to_vec(&command).unwrap();
        bytes.push(0);
        self.commands.write_all(&bytes).unwrap();
        loop {
            let message = self
                .messages
                .recv_timeout(PATIENCE)
                .expect("the browser answers (CHROMIUM names another one)");
            if message["id"] == self.last_id {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].clone();
            }
            self.events.push_back(message);
        }
    }

    fn size(&mut self, width: u32, height: u32) {
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", metrics);
    }

    /// The value of a script expression; promises are waited for.
    fn value(&mut self, expression: &str) -> Value {
        let parameters = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let result = self.call("Runtime.evaluate", parameters);
        assert!(result["exceptionDetails"].is_null(), "{expression}: {}", result["exceptionDetails"]);
        result["result"]["value"].clone()
    }

    /// Waits until it is so.
    #[track_caller]
    fn wait_for(&mut self, expression: &str) {
        self.soon(|page| page.value(expression), |value| *value == true);
    }

    /// Waits until what is looked at is so: the browser handles an event when it will. Gives what is seen then.
    #[track_caller]
    fn soon(&mut self, look: impl Fn(&mut Page) -> Value, is_so: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let seen = look(self);
            if is_so(&seen) {
                return seen;
            }
            assert!(start.elapsed() < PATIENCE, "never so, at last {seen}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    fn mouse(&mut self, kind: &str, x: f64, y: f64) {
        let button = if kind == "mouseMoved" { "none" } else { "left" };
        let event = json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": 1, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// The middle of an element, on the screen.
    fn middle(&mut self, selector: &str) -> (f64, f64) {
        // Two frames later the screen shows what was scrolled to, so that a click there meets it.
        let script = format!(
            "(async () => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
             const frame = () => new Promise(requestAnimationFrame); await frame(); await frame(); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        );
        let at = self.value(&script);
        (at[0].as_f64().unwrap(), at[1].as_f64().unwrap())
    }

    fn click(&mut self, selector: &str) {
        let (x, y) = self.middle(selector);
        self.mouse("mousePressed", x, y);
        self.mouse("mouseReleased", x, y);
    }

    /// What the viewer shows.
    fn picture(&mut self) -> Value {
        self.value("document.getElementById('canvas').toDataURL()")
    }

    /// The same when it is another one.
    #[track_caller]
    fn picture_other_than(&mut self, before: &Value) -> Value {
        self.soon(Page::picture, |picture| picture != before)
    }

    /// Names in the first column of the table, from the top.
    fn order(&mut self) -> Value {
        self.value("[...document.querySelectorAll('#table tbody tr td:first-child')].map((cell) => cell.textContent)")
    }

    #[track_caller]
    fn is_ordered(&mut self, names: [&str; 2]) {
        self.soon(Page::order, |order| *order == json!(names));
    }

    fn complaints(&mut self) -> Vec<String> {
        let wanted = |event: &Value| match event["method"].as_str() {
            Some("Runtime.exceptionThrown" | "Log.entryAdded") => true,
            Some("Runtime.consoleAPICalled") => {
                ["error", "warning"].contains(&event["params"]["type"].as_str().unwrap_or(""))
            }
            Some("Network.requestWillBeSent") => {
                let url = event["params"]["request"]["url"].as_str().unwrap_or("");
                !(url.starts_with("data:") || url.starts_with("file:") && url.ends_with("/index.html"))
            }
            _ => false,
        };
        self.events.iter().filter(|event| wanted(event)).map(Value::to_string).collect()
    }
}

/// The page of a comparison, and its folder.
fn report(folder: &Path) -> String {
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join("in.svg"), DRAWING).unwrap();
    let arguments = [
        "compare",
        "in.svg",
        "--methods",
        "exact,none",
        "--runs",
        "3",
        "--pan",
        "2",
        "--no-cache",
        "--report",
        ".",
    ];
    let program =
        Command::new(env!("CARGO_BIN_EXE_toon-raster")).current_dir(folder).args(arguments).output();
    assert!(program.unwrap().status.success());
    format!("file://{}", fs::canonicalize(folder.join("index.html")).unwrap().display())
}

#[test]
fn the_slider_moves_the_table_sorts_and_nothing_complains() {
    let Some(browser) = browser() else {
        eprintln!("SKIPPED the_slider_moves_the_table_sorts_and_nothing_complains: no Chromium found");
        return;
    };
    // A browser hands events on when it will, so one look too early is no fault of the page; a page that
    // is broken fails every time.
    let is_right = |attempt| std::panic::catch_unwind(|| try_the_page(&browser, attempt)).is_ok();
    assert!((0..ATTEMPTS).any(is_right), "the page failed {ATTEMPTS} times, as told above");
}

fn try_the_page(browser: &Path, attempt: usize) {
    let name = format!("toon-raster-browser-{}-{attempt}", std::process::id());
    let folder = Folder(std::env::temp_dir().join(name));
    let url = report(&folder.0);
    let mut page = Page::open(browser, &folder.0);
    page.size(1280, 900);
    page.call("Page.navigate", json!({ "url": url }));
    page.wait_for(
        "document.readyState === 'complete' && document.querySelectorAll('#table tbody tr').length === 2",
    );
    page.wait_for("document.querySelectorAll('#spots button').length > 0");

    the_slider_moves(&mut page);
    zoom_and_modes_change_the_picture(&mut page);
    the_table_sorts(&mut page);
    the_plot_has_its_measures(&mut page);
    it_fits_small_and_dark_screens(&mut page);

    assert_eq!(page.complaints(), Vec::<String>::new());
}

fn the_slider_moves(page: &mut Page) {
    let before = page.picture();
    let (x, y) = page.middle("#divider");
    page.mouse("mousePressed", x, y);
    for step in 1..=10 {
        page.mouse("mouseMoved", x - 30.0 * f64::from(step), y);
    }
    page.mouse("mouseReleased", x - 300.0, y);
    page.soon(|page| json!(page.middle("#divider").0), |to| (to.as_f64().unwrap() - (x - 300.0)).abs() < 2.0);
    page.picture_other_than(&before);
    let share = |page: &mut Page| {
        page.value("Number(document.getElementById('divider').getAttribute('aria-valuenow'))")
    };
    let before = share(page);
    page.value("document.getElementById('divider').focus()");
    page.call(
        "Input.dispatchKeyEvent",
        json!({ "type": "keyDown", "key": "ArrowRight", "code": "ArrowRight" }),
    );
    page.soon(share, |after| after.as_f64() > before.as_f64());
}

fn zoom_and_modes_change_the_picture(page: &mut Page) {
    let fit = page.picture();
    page.click("#zoom [data-zoom='8']");
    page.wait_for("document.querySelector(\"#zoom [data-zoom='8']\").ariaPressed === 'true'");
    let zoomed = page.picture_other_than(&fit);
    let (x, y) = page.middle("#tag-left");
    page.mouse("mouseMoved", x + 60.0, y + 60.0);
    page.wait_for("document.getElementById('readout').textContent.includes('column')");
    page.click("#spots button");
    page.wait_for("document.querySelector(\"#zoom [data-zoom='16']\").ariaPressed === 'true'");
    page.click("#mode [data-mode='error']");
    page.wait_for("document.querySelector('#look .legend').hidden === false");
    page.picture_other_than(&zoomed);
    page.click("#mode [data-mode='side']");
    page.wait_for("document.getElementById('divider').hidden === true");
    page.click("#mode [data-mode='slider']");
    page.click("#zoom [data-zoom='fit']");
    page.click("#gallery button");
    page.wait_for("document.querySelector(\"#mode [data-mode='error']\").ariaPressed === 'true'");
}

fn the_table_sorts(page: &mut Page) {
    // Column 6 is the root mean square error, by which it is sorted at first.
    let rms = page.value(
        "[...document.querySelectorAll('#table thead button')].findIndex((b) => b.textContent === 'rms') + 1",
    );
    page.is_ordered(["exact", "none"]);
    page.click(&format!("#table thead th:nth-child({rms}) button"));
    page.is_ordered(["none", "exact"]);
    page.wait_for("document.querySelector('#table [aria-sort]').textContent === 'rms'");
    page.click("#table thead th:nth-child(1) button");
    page.is_ordered(["exact", "none"]);
    page.click("#table tbody .name");
    page.wait_for("document.getElementById('left').selectedOptions[0].textContent === 'exact'");
}

fn the_plot_has_its_measures(page: &mut Page) {
    let dots = "document.querySelectorAll('#plot circle').length";
    assert_eq!(page.value(dots), 2);
    let plot = |page: &mut Page| page.value("document.getElementById('plot').innerHTML");
    let before = plot(page);
    page.click("#measure button:nth-child(4)");
    page.soon(plot, |after| *after != before);
    assert_eq!(page.value(dots), 2);
    assert!(page.value("document.querySelectorAll('#curve-plots polyline').length").as_u64() >= Some(1));
    assert_eq!(page.value("document.querySelectorAll('#motion-table tbody tr').length"), 2);
}

fn it_fits_small_and_dark_screens(page: &mut Page) {
    let ground = |page: &mut Page| page.value("getComputedStyle(document.body).backgroundColor");
    let light = ground(page);
    let dark = json!({ "features": [{ "name": "prefers-color-scheme", "value": "dark" }] });
    page.call("Emulation.setEmulatedMedia", dark);
    page.soon(ground, |dark| *dark != light);
    page.click("#theme");
    page.soon(ground, |now| *now == light);
    page.size(390, 800);
    page.wait_for("innerWidth === 390");
    // No sideways scrolling.
    page.wait_for("document.documentElement.scrollWidth <= innerWidth");
}
