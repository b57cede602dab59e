//! Known answers: values of the drawings in `samples/anim` at times, worked out by hand from SMIL 3.0,
//! SVG 1.1 and CSS Animations 1.

use super::Timeline;
use crate::Options;
use usvg::roxmltree::Document;

fn timeline(sample: &str) -> Timeline {
    let file = format!("{}/samples/anim/{sample}.svg", env!("CARGO_MANIFEST_DIR"));
    Timeline::read(&std::fs::read(file).unwrap(), &Options::default()).unwrap()
}

/// The value of an attribute or of a property in `style`, of the element with this id.
fn value(document: &str, id: &str, name: &str) -> String {
    let xml = Document::parse(document).unwrap();
    let node = xml.descendants().find(|node| node.attribute("id") == Some(id)).unwrap();
    let style = node.attribute("style").unwrap_or_default().split(';');
    let declared = style.rev().find_map(|d| d.split_once(':').filter(|(n, _)| n.trim() == name));
    declared.map(|(_, value)| value.trim()).or(node.attribute(name)).unwrap_or_default().to_string()
}

/// Fails unless the value is as expected, numbers within a millionth.
fn assert_values(sample: &str, name: &str, expected: &[(&str, f64, &str)]) {
    let timeline = timeline(sample);
    for &(id, time, expected) in expected {
        let found = value(&timeline.document_at(time), id, name);
        assert!(alike(&found, expected), "{sample} #{id} {name} at {time}: '{found}' is not '{expected}'");
    }
}

fn alike(found: &str, expected: &str) -> bool {
    let words = |text: &str| -> Vec<String> {
        text.split([' ', ',', '(', ')']).filter(|w| !w.is_empty()).map(str::to_string).collect()
    };
    let (a, b) = (words(found), words(expected));
    a.len() == b.len()
        && a.iter().zip(&b).all(|(a, b)| match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() < 1e-6,
            _ => a == b,
        })
}

#[test]
fn from_to_by_values_and_their_sums() {
    assert_values(
        "values",
        "x",
        &[
            ("from-to", 0.0, "20"),
            ("from-to", 1.0, "35"),
            ("from-to", 4.0, "10"),
            ("to", 1.0, "20"),
            ("by", 1.0, "20"),
            ("from-by", 1.0, "30"),
            ("sum", 2.0, "20"),
            ("accumulate", 0.5, "10"),
            ("accumulate", 1.5, "30"),
            ("accumulate", 2.5, "50"),
            ("accumulate", 9.0, "60"),
            ("sandwich", 1.0, "10"),
            ("sandwich", 3.0, "34"),
            ("removed", 0.5, "10"),
            ("removed", 2.0, "50"),
            ("removed", 3.0, "10"),
            ("frozen", 9.0, "80"),
        ],
    );
    assert_values(
        "values",
        "fill",
        &[("set", 0.9, "#336"), ("set", 1.0, "rgb(255,255,255)"), ("set", 3.0, "#336")],
    );
}

#[test]
fn key_times_splines_and_modes_share_out_the_time() {
    assert_values(
        "pace",
        "cx",
        &[
            ("linear", 1.0, "15"),
            ("linear", 3.0, "45"),
            ("discrete", 0.9, "10"),
            ("discrete", 1.0, "20"),
            ("discrete", 2.5, "70"),
            // 60 in 6 s: 10 a second.
            ("paced", 2.0, "30"),
            ("key-times", 1.5, "15"),
            ("key-times", 3.5, "45"),
            ("spline", 2.0, "40"),
            ("discrete-times", 1.9, "10"),
            ("discrete-times", 3.5, "20"),
            ("discrete-times", 3.7, "70"),
            // In error, so without effect.
            ("wrong", 2.0, "10"),
        ],
    );
    assert_eq!(timeline("pace").not_evaluated().as_deref(), Some("<animate> with wrong keyTimes"));
}

#[test]
fn transforms_replace_or_add_to_what_is_there() {
    assert_values(
        "transforms",
        "transform",
        &[
            ("rotate", 1.0, "rotate(45 50 50)"),
            ("replace", 1.0, "scale(1.5 1.5)"),
            ("replace", 2.0, "translate(5 5)"),
            ("sum", 1.0, "translate(60 60) scale(1 2)"),
            ("stacked", 1.0, "translate(20 0) skewX(10)"),
            ("turns", 2.5, "rotate(225 0 0)"),
        ],
    );
    assert_values("transforms", "gradientTransform", &[("gradient", 0.5, "rotate(90 .5 .5)")]);
}

#[test]
fn motion_follows_its_path() {
    assert_values(
        "motion",
        "transform",
        &[
            // The road is 120 long: 20 a second.
            ("paced", 2.0, "translate(50 10)"),
            ("paced", 5.0, "translate(90 30)"),
            ("along", 2.0, "translate(50 10)"),
            ("along", 5.0, "translate(90 30) rotate(90)"),
            ("vertices", 1.0, "translate(50 10)"),
            ("vertices", 3.0, "translate(90 30)"),
            ("points", 1.0, "translate(50 80)"),
            ("points", 3.0, "translate(75 80)"),
            ("on-top", 1.0, "translate(20 60) rotate(45)"),
            ("on-top", 9.0, "translate(80 60) rotate(45)"),
            ("back", 1.0, "translate(10 0) rotate(180)"),
        ],
    );
}

#[test]
fn animations_wait_for_each_other() {
    assert_values(
        "sync",
        "x",
        &[
            ("b-rect", 1.4, ""),
            ("b-rect", 2.0, "45"),
            ("b-rect", 2.5, ""),
            ("c-rect", 3.0, "45"),
            ("c-rect", 9.0, "90"),
            ("d-rect", 0.5, "22.5"),
            ("d-rect", 1.5, ""),
            ("d-rect", 4.0, "45"),
            ("d-rect", 4.5, ""),
            ("e-rect", 1.5, "45"),
            ("e-rect", 9.0, "45"),
            ("f-rect", 1.0, ""),
        ],
    );
    let timeline = timeline("sync");
    assert_eq!(timeline.not_evaluated().as_deref(), Some("begin=\"f-rect.click\""));
    assert_eq!(timeline.length().seconds, 4.5);
}

#[test]
fn links_and_visibility_jump() {
    assert_values(
        "frames",
        "href",
        &[("cel", 0.0, "#frame-1"), ("cel", 0.3, "#frame-2"), ("cel", 1.6, "#frame-3")],
    );
    assert_values("frames", "visibility", &[("blink", 0.4, "visible"), ("blink", 0.5, "hidden")]);
    assert_values("frames", "display", &[("layer", 0.4, "none"), ("layer", 0.7, "inline")]);
    let length = timeline("frames").length();
    assert_eq!((length.seconds, length.repeats, length.frames(12.0)), (1.0, true, 12));
}

#[test]
fn colors_paths_and_lists_mix() {
    assert_values(
        "kinds",
        "fill",
        &[("color", 1.0, "rgb(128,0,128)"), ("styled", 1.0, "rgb(128,128,0)"), ("old", 1.0, "rgb(68,68,68)")],
    );
    assert_values("kinds", "stroke-width", &[("styled", 1.0, "3")]);
    assert_values("kinds", "d", &[("shape", 1.0, "M15 50H35V80H15Z")]);
    assert_values("kinds", "points", &[("points", 1.0, "50 50 80 50 60 80")]);
    assert_values("kinds", "stroke-dasharray", &[("dash", 1.0, "6 4")]);
    assert_values("kinds", "y2", &[("dash", 1.0, "85")]);
}

#[test]
fn keyframes_set_properties() {
    let moved = |x: f64| format!("matrix(1 0 0 1 {x} 0)");
    let (at_0, at_15, at_30, at_60) = (moved(0.0), moved(15.0), moved(30.0), moved(60.0));
    assert_values(
        "keyframes",
        "transform",
        &[
            ("slide", 0.5, &at_0),
            ("slide", 2.0, &at_30),
            ("slide", 3.0, &at_60),
            ("slide", 4.0, &at_30),
            ("slide", 9.0, &at_0),
            ("turn", 1.0, "matrix(0 1 -1 0 0 0)"),
            ("steps", 1.9, &at_15),
            ("late", 0.5, &at_15),
        ],
    );
    assert_values("keyframes", "transform-origin", &[("turn", 1.0, "40px 55px")]);
    assert_values("keyframes", "opacity", &[("fade", 1.0, "0.4"), ("fade", 2.0, "0"), ("fade", 3.0, "0.4")]);
    assert_values(
        "keyframes",
        "fill",
        &[("tint", 1.9, "rgb(255,0,0)"), ("tint", 3.0, "rgb(0,128,128)"), ("tint", 4.0, "")],
    );
}

#[test]
fn a_drawing_at_rest_is_one_frame() {
    let timeline = Timeline::read(
        b"<svg xmlns='http://www.w3.org/2000/svg' width='1' height='1'/>",
        &Options::default(),
    );
    let timeline = timeline.unwrap();
    assert!(!timeline.is_animated());
    assert_eq!(timeline.length().frames(24.0), 1);
}

#[test]
fn what_is_not_evaluated_is_named_once_with_its_number() {
    let named = |inside: &str| {
        let svg =
            format!("<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><g>{inside}</g></svg>");
        Timeline::read(svg.as_bytes(), &Options::default()).unwrap().not_evaluated().unwrap_or_default()
    };
    for (inside, words) in [
        ("<set attributeName='x' to='1' begin='click'/>", "begin=\"click\""),
        ("<set attributeName='x' to='1' begin='0s' end='accessKey(a)'/>", "end=\"accessKey(a)\""),
        ("<set attributeName='x' to='1' begin='b.end'/>", "begin after 'b', which is no animation"),
        ("<script/><script/>", "<script> (2 times)"),
        (
            "<style>@keyframes k { to { offset-distance: 100% } } g { animation: k 1s }</style>",
            "the property offset-distance in @keyframes",
        ),
        ("<style>@media print { g { animation: k 1s } }</style>", "animations under @media print"),
        ("<style>g { animation-composition: add }</style>", "animation-composition: add"),
        ("<style>@media (prefers-reduced-motion: reduce) { * { animation: none } }</style>", ""),
        ("<style>@media print { g { fill: red } } g { animation: k 1s }</style>", ""),
        ("<set id='a' attributeName='x' to='1'/><set attributeName='y' to='1' begin='a.repeat(1)'/>", ""),
    ] {
        assert_eq!(named(inside), words, "{inside}");
    }
}

#[test]
fn entities_namespaces_and_text_survive_the_template() {
    let svg =
        "<!DOCTYPE svg [<!ENTITY c 'red'>]><s:svg xmlns:s='http://www.w3.org/2000/svg' xmlns:i='urn:i' \
               width='9' height='9'><i:x/><s:text xml:space='preserve' i:y='1' fill='&c;'>a &lt; b&amp;\n \
               <s:tspan>c</s:tspan><s:set attributeName='x' to='&quot;1'/></s:text></s:svg>";
    let document = Timeline::read(svg.as_bytes(), &Options::default()).unwrap().document_at(0.0);
    assert!(document
        .contains("<metadata/><text xml:space=\"preserve\" fill=\"red\" x=\"&quot;1\">a &lt; b&amp;&#10; "));
    assert!(document.ends_with("<tspan>c</tspan><set/></text></svg>"), "{document}");
}

#[test]
fn hostile_animations_end_soon() {
    let many: String = (0..3000)
        .map(|n| {
            format!(
                "<animate id='a{n}' attributeName='x' begin='0;a{}.end-1ms;a{}.begin+1ms' dur='2ms' to='1'/>",
                (n + 1) % 3000,
                (n + 7) % 3000
            )
        })
        .collect();
    for inside in [
        many.as_str(),
        "<animateMotion path='M0 0A1e38 1e38 0 0 1 1 1' dur='1s'/>",
        "<animateMotion path='M0 0L1e308 1e308L-1e308 0' dur='1s'/>",
        "<animate attributeName='x' dur='1e-300s' values=';;;' repeatCount='1e300'/>",
        "<animate attributeName='x' dur='0.000000001s' values='1;2' repeatCount='indefinite'/>",
        "<style>@media } } { @supports { @media { animation } }</style><g/>",
        "<style>@keyframes k { to { rotate: ; scale: 1e308 nan; translate: x\"y } } g { rotate: (; animation: k 1s linear(, 1 2 3) }</style>",
        "<style>@keyframes k { to { rotate: 9turn } } g { animation: k 1s linear(0 nan%, 1e308 -5%, 1) infinite }</style>",
        "<style>@keyframes { a { x</style><g style='animation: \u{e9} 1s'/>",
        "<animate attributeName='' to='1'/><animate attributeName='&lt;' to='1' dur='1s'/>",
    ] {
        let svg =
            format!("<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><g>{inside}</g></svg>");
        if let Ok(timeline) = Timeline::read(svg.as_bytes(), &Options::default()) {
            timeline.document_at(0.5);
            timeline.document_at(1e9);
            timeline.length().frames(1000.0);
        }
    }
}
