//! Takes the text of a frame rate (`24`, `23.976`, `30000/1001`), makes a ratio, and from it the times of
//! frames in whatever unit a format counts.

/// Frames in a number of seconds, in lowest terms, both above zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    /// So many frames …
    pub frames: u32,
    /// … in so many seconds.
    pub seconds: u32,
}

impl Rate {
    /// Frames a second.
    pub fn fps(&self) -> f64 {
        f64::from(self.frames) / f64::from(self.seconds)
    }

    /// When frame `n` is shown, the first being number 0, in seconds.
    pub fn time(&self, n: u64) -> f64 {
        n as f64 * f64::from(self.seconds) / f64::from(self.frames)
    }

    /// The same in whole milliseconds: sums have no drift.
    pub fn milliseconds(&self, n: u64) -> u64 {
        self.units(n, 1000)
    }

    /// The same in hundredths of a second.
    pub fn hundredths(&self, n: u64) -> u64 {
        self.units(n, 100)
    }

    fn units(&self, n: u64, units: u64) -> u64 {
        let (frames, seconds) = (u128::from(self.frames), u128::from(self.seconds));
        ((u128::from(n) * seconds * u128::from(units) + frames / 2) / frames) as u64
    }

    /// How long a frame is shown, as a fraction of 16-bit numbers.
    pub(super) fn delay(&self) -> (u16, u16) {
        match (u16::try_from(self.seconds), u16::try_from(self.frames)) {
            (Ok(seconds), Ok(frames)) => (seconds, frames),
            _ => (self.milliseconds(1).min(u64::from(u16::MAX)) as u16, 1000),
        }
    }
}

impl std::str::FromStr for Rate {
    type Err = String;

    fn from_str(text: &str) -> Result<Rate, String> {
        /// Decimals that count, and the fastest rate.
        const DECIMALS: f64 = 1000.0;
        const FASTEST: f64 = 1000.0;
        let wrong = || {
            format!("must be frames a second above 0 and up to {FASTEST}, such as 24, 23.976 or 30000/1001")
        };
        let ratio = match text.trim() {
            // What television calls by these names.
            "23.976" | "23.98" => Some((24_000, 1001)),
            "29.97" => Some((30_000, 1001)),
            "59.94" => Some((60_000, 1001)),
            text => match text.split_once('/') {
                Some((frames, seconds)) => frames.trim().parse().ok().zip(seconds.trim().parse().ok()),
                None => text
                    .parse::<f64>()
                    .ok()
                    .filter(|fps| (0.0..=FASTEST).contains(fps))
                    .map(|fps| ((fps * DECIMALS).round() as u32, DECIMALS as u32)),
            },
        };
        let (frames, seconds): (u32, u32) = ratio.filter(|&(f, s)| f > 0 && s > 0).ok_or_else(wrong)?;
        if f64::from(frames) / f64::from(seconds) > FASTEST {
            return Err(wrong());
        }
        let divisor = gcd(frames, seconds);
        Ok(Rate { frames: frames / divisor, seconds: seconds / divisor })
    }
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 {
        a
    } else {
        gcd(b, a % b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_ratios() {
        let rate = |text: &str| text.parse::<Rate>().map(|r| (r.frames, r.seconds)).ok();
        assert_eq!(rate("24"), Some((24, 1)));
        assert_eq!(rate("12.5"), Some((25, 2)));
        assert_eq!(rate("23.976"), Some((24_000, 1001)));
        assert_eq!(rate("60/2"), Some((30, 1)));
        for text in ["0", "-1", "0/1", "1/0", "fast", "1e9", "nan", "inf", "", "2000/1"] {
            assert_eq!(rate(text), None, "{text}");
        }
    }

    #[test]
    fn delays_sum_up_without_drift() {
        let rate: Rate = "24".parse().unwrap();
        let delays: Vec<u64> = (0..6).map(|n| rate.hundredths(n + 1) - rate.hundredths(n)).collect();
        assert_eq!(delays, [4, 4, 5, 4, 4, 4]);
        assert_eq!(rate.hundredths(24), 100);
    }
}
