//! What of a drawing is not drawn, or was not read, is said in one line a kind, unless only errors are asked for.

#[path = "support/folder.rs"]
mod folder;

use folder::Folder;
use std::fs;

fn drawing(body: &str) -> Folder {
    let folder = Folder::new();
    let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'>{body}</svg>");
    fs::write(folder.path("in.svg"), svg).unwrap();
    folder
}

/// A line for each of these, in this order, and the picture is made all the same.
#[track_caller]
fn assert_warns(folder: &Folder, warnings: &[&str], arguments: &[&str]) {
    let (code, said) = folder.run(arguments);
    assert_eq!((code, said.lines().count()), (Some(0), warnings.len()), "{said}");
    for (line, warning) in said.lines().zip(warnings) {
        assert!(line.starts_with("toon-raster: in.svg: warning: ") && line.contains(warning), "{said}");
    }
}

#[test]
fn what_is_not_drawn_is_warned_of_once_a_kind_unless_quiet() {
    let folder = drawing(
        "<image id='lost' width='5' height='5' href='none.png'/>
        <image width='5' height='5' href='data:image/png;base64,AAAA'/>
        <text y='8' font-family='none such'>words</text>",
    );
    let warned = [
        "images are not drawn: element 'lost' and 1 more",
        "texts without a font are not drawn: text in font-family",
    ];
    assert_warns(&folder, &warned, &["--skip-system-fonts", "in.svg", "out.png"]);
    folder.make(&["--skip-system-fonts", "-q", "in.svg", "out.png"]);
}

#[test]
fn what_the_parser_cannot_read_is_warned_of_once_a_kind_unless_quiet() {
    let folder = drawing(
        "<style>rect:nth-child(2) { fill: red }</style><rect width='3' height='3' fill='rebeccapurple'/>
        <rect width='3' height='3' fill='rebeccapurple'/><rect width='3' height='3' fill='var(--c, green)'/>
        <rect width='3' height='3' style='transform: translate(0, 5px)'/>",
    );
    let warned = [
        "':nth-child' is not supported",
        "'rebeccapurple'. Fallback to black (and 1 more like it)",
        "transform value: 'translate(0, 5px)'",
    ];
    assert_warns(&folder, &warned, &["in.svg", "out.png"]);
    folder.make(&["-q", "in.svg", "out.png"]);
    let (_, said) = folder.run(&["-v", "in.svg", "out.png"]);
    assert_eq!(said.matches("'rebeccapurple'").count(), 2, "{said}");
}

#[test]
fn shapes_without_a_size_and_keyframes_are_nothing_to_warn_of() {
    let folder = drawing(
        "<style>@keyframes turn { to { transform: rotate(1turn) } }</style>
        <rect width='0' height='3'/><circle r='0'/><ellipse rx='0' ry='2'/><rect width='3' height='3'/>",
    );
    folder.make(&["in.svg", "out.png"]);
}
