//! Takes this machine and this program, makes what a reader must know of them to believe a time.

use serde::Serialize;
use std::ffi::OsString;
use std::time::{SystemTime, UNIX_EPOCH};

/// Under which circumstances figures were taken.
#[derive(Clone, Debug, Serialize)]
pub struct Circumstances {
    /// As the system calls it.
    pub processor: String,
    /// Threads that run at once.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
    /// Programs and their versions.
    pub versions: Vec<(&'static str, &'static str)>,
    /// As it can be typed again.
    pub command: String,
    /// Year, month, day (UTC).
    pub date: String,
}

/// The libraries whose version decides what is measured; a test holds them against the lock file.
const LIBRARIES: [(&str, &str); 3] = [("usvg", "0.49.0"), ("kurbo", "0.13.1"), ("tiny-skia", "0.12.0")];

impl Circumstances {
    /// Here and now.
    pub fn here(command: impl Iterator<Item = OsString>) -> Circumstances {
        let mut versions = vec![("toon-raster", env!("CARGO_PKG_VERSION"))];
        versions.extend(LIBRARIES);
        Circumstances {
            processor: processor(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            versions,
            command: command_line(command),
            date: date(),
        }
    }

    /// In one line.
    pub fn line(&self) -> String {
        let versions: Vec<String> = self.versions.iter().map(|(name, v)| format!("{name} {v}")).collect();
        format!("{}, {} cores, {}; {}", self.processor, self.cores, self.system, versions.join(", "))
    }
}

fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name"));
    name.map_or("unknown processor", |name| name.trim_start_matches([' ', '\t', ':'])).to_string()
}

/// Quoted for a shell where needed; the program by its name alone.
fn command_line(arguments: impl Iterator<Item = OsString>) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=@%+#".contains(c);
    let quoted = arguments.enumerate().map(|(i, argument)| {
        let argument = match i {
            0 => "toon-raster".to_string(),
            _ => argument.to_string_lossy().into_owned(),
        };
        match !argument.is_empty() && argument.chars().all(plain) {
            true => argument,
            false => format!("'{}'", argument.replace('\'', r"'\''")),
        }
    });
    quoted.collect::<Vec<_>>().join(" ")
}

fn date() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    civil((seconds / 86_400) as i64)
}

/// The date of a day since 1 January 1970 (Hinnant, *chrono-Compatible Low-Level Date Algorithms*):
/// years begin in March, so that the odd day comes last.
fn civil(days: i64) -> String {
    let days = days + 719_468;
    let (era, day) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, later) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    format!("{:04}-{month:02}-{day:02}", year + era * 400 + later)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_those_of_the_lock_file() {
        let lock = include_str!("../../../Cargo.lock");
        for (name, version) in LIBRARIES {
            assert!(
                lock.contains(&format!("name = \"{name}\"\nversion = \"{version}\"")),
                "{name} is not {version} any more: change it here"
            );
        }
    }

    #[test]
    fn known_days() {
        assert_eq!(civil(0), "1970-01-01");
        assert_eq!(civil(11_016), "2000-02-29");
        assert_eq!(civil(19_722), "2023-12-31");
    }

    #[test]
    fn a_command_can_be_typed_again() {
        let words = ["/some/where/toon-raster", "compare", "a b.svg", "it's", "-w", "512"];
        let line = command_line(words.into_iter().map(OsString::from));
        assert_eq!(line, r"toon-raster compare 'a b.svg' 'it'\''s' -w 512");
    }
}
