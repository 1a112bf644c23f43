//! Times, as they are kept and as they are told.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::StoreError;

/// Microseconds since 1970.
pub(crate) fn now() -> i64 {
    micros(SystemTime::now())
}

/// The same of another time; 0 before 1970.
pub(crate) fn micros(time: SystemTime) -> i64 {
    let since = time.duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since.as_micros()).unwrap_or(i64::MAX)
}

/// RFC 3339 in UTC, with milliseconds.
pub(crate) fn rfc3339(micros: i64) -> String {
    /// The end of the year 9999, beyond which RFC 3339 has no years.
    const LAST: u64 = 253_402_300_799_000_000;
    let micros = u64::try_from(micros).unwrap_or(0).min(LAST);
    humantime::format_rfc3339_millis(UNIX_EPOCH + Duration::from_micros(micros)).to_string()
}

/// Microseconds since 1970 of an RFC 3339 time in UTC.
///
/// # Errors
/// [`StoreError::Conflict`] for anything else.
pub(crate) fn parse(text: &str) -> Result<i64, StoreError> {
    humantime::parse_rfc3339(text).map(micros).map_err(|_| StoreError::Conflict {
        reason: format!("\"{text}\" is not a time: use RFC 3339 in UTC, as 2026-01-31T12:00:00Z"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_come_back_and_nonsense_is_refused() {
        assert_eq!(rfc3339(parse("2026-01-31T12:00:00.25Z").unwrap()), "2026-01-31T12:00:00.250Z");
        assert!(parse("2026-01-31T12:00:00Z").unwrap() < parse("2026-01-31T12:00:00.5Z").unwrap());
        assert_eq!(rfc3339(i64::MAX), "9999-12-31T23:59:59.000Z");
        for odd in ["", "now", "2026-13-01T00:00:00Z", "2026-01-31T12:00:00+02:00"] {
            assert!(parse(odd).is_err(), "{odd:?}");
        }
    }
}
