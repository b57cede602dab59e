//! The animated samples at given times are what they were when a browser agreed with them: `answers.txt`
//! has the mean colours of 6 x 6 parts of each picture, stored by
//! `cargo run --release --example against_chromium -- samples/anim --answers tests/anim/answers.txt`.

#[path = "support/moments.rs"]
mod moments;

use std::collections::BTreeSet;
use toon_raster::frames::Timeline;
use toon_raster::Options;

/// Levels that rounding and another way of smoothing edges may move the mean of a part by.
const TOLERATED: u8 = 2;

#[test]
fn samples_move_as_they_did_when_chromium_agreed() {
    let answers = include_str!("anim/answers.txt");
    let (mut read, mut wrong): (Option<(&str, Timeline)>, Vec<String>) = (None, Vec::new());
    let mut files = BTreeSet::new();
    for line in answers.lines() {
        let [file, time, expected] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
        files.insert(file);
        if read.as_ref().is_none_or(|(name, _)| *name != file) {
            let bytes = std::fs::read(format!("{}/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap();
            read = Some((file, Timeline::read(&bytes, &Options::default()).unwrap()));
        }
        let (_, timeline) = read.as_ref().unwrap();
        let found = moments::cells(&moments::picture(timeline, time.parse().unwrap()).unwrap());
        let expected = (0..expected.len() / 2).map(|i| u8::from_str_radix(&expected[2 * i..2 * i + 2], 16));
        let expected: Vec<u8> = expected.collect::<Result<_, _>>().unwrap();
        assert_eq!(found.len(), expected.len());
        let off = found.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max().unwrap();
        if off > TOLERATED {
            wrong.push(format!("{file} at {time}: {off} levels"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!(answers.lines().count(), files.len() * moments::TIMES.len());
    assert!(files.len() > 20, "{}", files.len());
}
