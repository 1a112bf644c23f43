//! Numbers for people.

/// A number in few characters.
pub fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let size = x.abs();
    if (1e-3..1e5).contains(&size) {
        let digits = (2 - size.log10().floor() as i32).clamp(0, 6) as usize;
        let text = format!("{x:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        let text = format!("{x:.2e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_right() {
        let texts = [0.0, 1.0, 0.0723, 98304.0, 123456.0, 6.2e-7, 0.001, 42.04, 1e-13];
        assert_eq!(
            texts.map(short),
            ["0", "1", "0.0723", "98304", "1.23e5", "6.2e-7", "0.001", "42", "1e-13"]
        );
    }
}
