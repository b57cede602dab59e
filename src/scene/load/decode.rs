//! Takes the bytes of a file, makes the XML text in them: unpacked, in UTF-8, without byte order mark.
//!
//! Promises: never more than the limit in memory, however well the bytes were packed.

use crate::Error;
use std::borrow::Cow;
use std::io::Read;

const GZIP: &[u8] = &[0x1f, 0x8b];

/// The text in `bytes`, unpacked if it was packed, of at most `limit` bytes.
pub(super) fn text(bytes: &[u8], limit: u64) -> Result<Cow<'_, str>, Error> {
    let plain =
        if bytes.starts_with(GZIP) { Cow::Owned(unpack(bytes, limit)?) } else { Cow::Borrowed(bytes) };
    if plain.len() as u64 > limit {
        return Err(too_long(limit));
    }
    if plain.iter().all(u8::is_ascii_whitespace) {
        return Err(Error::Parse("empty: not a byte of SVG in it".to_string()));
    }
    if plain.starts_with(GZIP) {
        return Err(Error::Parse("packed with gzip twice (unpack it once)".to_string()));
    }
    match plain {
        Cow::Borrowed(bytes) => transcode(bytes),
        Cow::Owned(bytes) => transcode(&bytes).map(|text| Cow::Owned(text.into_owned())),
    }
}

fn too_long(limit: u64) -> Error {
    Error::Limit(format!("more than {} MiB of XML", limit >> 20))
}

fn unpack(bytes: &[u8], limit: u64) -> Result<Vec<u8>, Error> {
    let mut plain = Vec::new();
    let mut decoder = flate2::read::GzDecoder::new(bytes);
    match decoder.by_ref().take(limit + 1).read_to_end(&mut plain) {
        Ok(_) if plain.len() as u64 > limit => Err(too_long(limit)),
        Ok(_) => Ok(plain),
        Err(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
            Err(Error::Parse("the svgz is cut off (copy it again)".to_string()))
        }
        Err(e) => Err(Error::Parse(format!("the svgz cannot be unpacked: {e}"))),
    }
}

fn transcode(bytes: &[u8]) -> Result<Cow<'_, str>, Error> {
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => utf8(rest),
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        [b'<', 0, _, 0, ..] => utf16(bytes, u16::from_le_bytes),
        [0, b'<', 0, _, ..] => utf16(bytes, u16::from_be_bytes),
        _ if says_latin1(bytes) => Ok(Cow::Owned(bytes.iter().map(|&byte| byte as char).collect())),
        _ => utf8(bytes),
    }
}

fn utf8(bytes: &[u8]) -> Result<Cow<'_, str>, Error> {
    std::str::from_utf8(bytes).map(Cow::Borrowed).map_err(|e| {
        Error::Parse(format!(
            "byte {} is not UTF-8, and no other encoding is declared (save it as UTF-8)",
            e.valid_up_to()
        ))
    })
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<Cow<'_, str>, Error> {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units)
        .collect::<Result<String, _>>()
        .map(Cow::Owned)
        .map_err(|_| Error::Parse("not valid UTF-16 (save it as UTF-8)".to_string()))
}

/// Whether the XML declaration names Latin-1, whose bytes are the first 256 characters of Unicode.
fn says_latin1(bytes: &[u8]) -> bool {
    let Some(declaration) = bytes.strip_prefix(b"<?xml").and_then(|rest| rest.split(|&b| b == b'>').next())
    else {
        return false;
    };
    let declaration = String::from_utf8_lossy(declaration).to_ascii_lowercase();
    ["iso-8859-1", "latin1", "latin-1", "us-ascii"].iter().any(|name| {
        declaration.contains(&format!("\"{name}\"")) || declaration.contains(&format!("'{name}'"))
    })
}

/// Refuses a document whose entities would swell it beyond `limit` bytes: the parser replaces each
/// reference by the entity's text, and follows up to 255 references inside each.
pub(super) fn check_entities(text: &str, limit: u64) -> Result<(), Error> {
    const REFERENCES_INSIDE: u64 = 255;
    let mut longest = 0;
    let mut nested = false;
    for definition in text.split("<!ENTITY").skip(1) {
        let Some(open) = definition.find(['"', '\'']) else { continue };
        let value = &definition[open + 1..];
        let value = value.split(definition.as_bytes()[open] as char).next().unwrap_or("");
        longest = longest.max(value.len() as u64);
        nested |= value.contains('&');
    }
    if longest == 0 {
        return Ok(());
    }
    let references = text.bytes().filter(|&b| b == b'&').count() as u64;
    let factor = if nested { REFERENCES_INSIDE } else { 1 };
    if references.saturating_mul(longest).saturating_mul(factor) > limit {
        return Err(Error::Limit(format!("its entities may swell it to more than {} MiB", limit >> 20)));
    }
    Ok(())
}
