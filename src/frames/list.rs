//! Takes the text of a frame list, makes frame numbers in order: `7`, `1-100`, `1..100` (both ends
//! included), every second with `1-100x2` or `1-100:2`, and several of these by commas.

/// Frame numbers, each once, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameList {
    ranges: Vec<Range>,
}

/// first, first + step, … up to last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Range {
    first: u64,
    last: u64,
    step: u64,
}

impl std::str::FromStr for FrameList {
    type Err = String;

    fn from_str(text: &str) -> Result<FrameList, String> {
        let ranges = text.split(',').map(|part| range(part.trim())).collect::<Result<_, _>>()?;
        Ok(FrameList { ranges })
    }
}

impl FrameList {
    /// At least as many as there are numbers: one in two ranges counts twice.
    pub fn count_at_most(&self) -> u64 {
        let count = |range: &Range| ((range.last - range.first) / range.step).saturating_add(1);
        self.ranges.iter().map(count).fold(0, u64::saturating_add)
    }

    /// Whether it has this number.
    pub fn contains(&self, number: u64) -> bool {
        let within =
            |r: &Range| (r.first..=r.last).contains(&number) && (number - r.first).is_multiple_of(r.step);
        self.ranges.iter().any(within)
    }

    /// The numbers. Look at [`FrameList::count_at_most`] before.
    pub fn numbers(&self) -> Vec<u64> {
        let each =
            |range: &Range| (range.first..=range.last).step_by(range.step.try_into().unwrap_or(usize::MAX));
        let mut numbers: Vec<u64> = self.ranges.iter().flat_map(each).collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }
}

fn range(text: &str) -> Result<Range, String> {
    let (ends, step) = match text.split_once(['x', ':']) {
        Some((ends, step)) => (ends, number(step).filter(|&step| step > 0)),
        None => (text, Some(1)),
    };
    let (first, last) = match ends.split_once("..").or_else(|| ends.split_once('-')) {
        Some((first, last)) => (number(first), number(last)),
        None => (number(ends), number(ends)),
    };
    match (first, last, step) {
        (Some(first), Some(last), _) if first > last => {
            Err(format!("{text} runs backwards; write {last}-{first}"))
        }
        (Some(first), Some(last), Some(step)) => Ok(Range { first, last, step }),
        _ => Err("must be frame numbers, such as 7, 1-100, 1-100x2 or 3,5-9".to_string()),
    }
}

fn number(text: &str) -> Option<u64> {
    let text = text.trim();
    text.parse().ok().filter(|_| text.bytes().all(|b| b.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_gives_its_numbers() {
        for (text, numbers) in [
            ("7", vec![7]),
            ("1-4", vec![1, 2, 3, 4]),
            ("1..4", vec![1, 2, 3, 4]),
            ("1-6x2", vec![1, 3, 5]),
            ("2-6:2", vec![2, 4, 6]),
            ("3,5-7", vec![3, 5, 6, 7]),
            ("5-7, 3,6-8", vec![3, 5, 6, 7, 8]),
            ("0001-0003", vec![1, 2, 3]),
        ] {
            assert_eq!(text.parse::<FrameList>().unwrap().numbers(), numbers, "{text}");
        }
    }

    #[test]
    fn what_is_no_list_is_refused() {
        for text in ["", "a", "1-", "-3", "5-2", "1-9x0", "1,,2", "1-5x", "+1", "99999999999999999999"] {
            assert!(text.parse::<FrameList>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_long_list_is_counted_without_being_made() {
        assert_eq!("0-18446744073709551615".parse::<FrameList>().unwrap().count_at_most(), u64::MAX);
    }
}
