//! Byte ranges, RFC 9110, section 14.

use std::ops::Range;

/// What a `Range` header asks of a representation.
#[derive(Debug, PartialEq)]
pub(crate) enum Part {
    /// All of it: there is no range, or none that this service serves.
    Whole,
    /// These bytes; not empty, within the length.
    Bytes(Range<usize>),
    /// Bytes that it does not have.
    Unsatisfiable,
}

/// Reads a `Range` header for a representation of `length` bytes.
///
/// One range is served: `bytes=FIRST-LAST`, `bytes=FIRST-` or `bytes=-COUNT`. Several ranges, another unit and what is
/// malformed are answered with the whole, as the RFC allows.
pub(crate) fn part(header: &str, length: usize) -> Part {
    let Some((unit, ranges)) = header.split_once('=') else { return Part::Whole };
    if !unit.trim().eq_ignore_ascii_case("bytes") {
        return Part::Whole;
    }
    let mut ranges = ranges.split(',').map(str::trim).filter(|range| !range.is_empty());
    let (Some(range), None) = (ranges.next(), ranges.next()) else { return Part::Whole };
    match range.split_once('-').map(|(first, last)| (position(first), position(last))) {
        Some((Position::None, Position::At(count))) => suffix(count, length),
        Some((Position::At(first), Position::None)) => between(first, usize::MAX, length),
        Some((Position::At(first), Position::At(last))) if first <= last => between(first, last, length),
        _ => Part::Whole,
    }
}

enum Position {
    None,
    At(usize),
    Malformed,
}

/// Digits alone; a number that does not fit is beyond every representation anyway.
fn position(text: &str) -> Position {
    if text.is_empty() {
        Position::None
    } else if text.bytes().all(|b| b.is_ascii_digit()) {
        Position::At(text.parse().unwrap_or(usize::MAX))
    } else {
        Position::Malformed
    }
}

fn suffix(count: usize, length: usize) -> Part {
    if count == 0 || length == 0 {
        return Part::Unsatisfiable;
    }
    Part::Bytes(length.saturating_sub(count)..length)
}

fn between(first: usize, last: usize, length: usize) -> Part {
    if first >= length {
        return Part::Unsatisfiable;
    }
    Part::Bytes(first..last.min(length - 1) + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_range_is_served() {
        for (header, expected) in [
            ("bytes=0-0", 0..1),
            ("bytes=2-5", 2..6),
            ("bytes=2-", 2..10),
            ("bytes=-3", 7..10),
            ("bytes=-99", 0..10),
            ("bytes=0-99", 0..10),
            ("bytes=9-99999999999999999999999", 9..10),
            ("BYTES= 1-2 , ", 1..3),
        ] {
            assert_eq!(part(header, 10), Part::Bytes(expected), "{header}");
        }
    }

    #[test]
    fn ranges_outside_are_unsatisfiable() {
        for header in ["bytes=10-", "bytes=10-12", "bytes=99999999999999999999999-", "bytes=-0"] {
            assert_eq!(part(header, 10), Part::Unsatisfiable, "{header}");
        }
        assert_eq!(part("bytes=0-", 0), Part::Unsatisfiable);
        assert_eq!(part("bytes=-1", 0), Part::Unsatisfiable);
    }

    #[test]
    fn what_is_not_one_range_is_passed_over() {
        for header in [
            "",
            "bytes",
            "bytes=",
            "bytes=-",
            "bytes=a-b",
            "bytes=5-2",
            "bytes=0-1,3-4",
            "items=0-1",
            "bytes=+1-2",
            "bytes=1 -2",
            "bytes=0x1-2",
            "bytes=1--2",
        ] {
            assert_eq!(part(header, 10), Part::Whole, "{header}");
        }
    }
}
