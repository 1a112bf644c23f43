//! The parameters of a URL's query, read strictly: what is not understood is refused, never passed over.

use crate::ApiError;

/// Parameters that have not been asked for yet: decoded names, and values as they came.
pub(crate) struct Params(Vec<(String, String)>);

impl Params {
    /// Splits a query, and refuses what cannot be decoded.
    pub(crate) fn parse(query: Option<&str>) -> Result<Self, ApiError> {
        let mut params: Vec<(String, String)> = Vec::new();
        for pair in query.unwrap_or_default().split('&').filter(|pair| !pair.is_empty()) {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            let name = decode(name)
                .ok_or_else(|| ApiError::malformed(None, "the query has a name that cannot be decoded"))?;
            if decode(value).is_none() {
                let reason = format!("{name} has a value that cannot be decoded");
                return Err(ApiError::malformed(Some(&name), reason));
            }
            if params.iter().any(|(known, _)| *known == name) {
                return Err(ApiError::invalid(name, "is given more than once"));
            }
            params.push((name, value.to_owned()));
        }
        Ok(Self(params))
    }

    /// The value of a parameter, if there is one. `+` is a plus: numbers and times have one, and no spaces.
    pub(crate) fn take(&mut self, name: &str) -> Option<String> {
        decode(&self.raw(name)?)
    }

    /// The value of a parameter that is words: `+` is a space, as forms and most clients send it.
    pub(crate) fn words(&mut self, name: &str) -> Option<String> {
        decode(&self.raw(name)?.replace('+', "%20"))
    }

    fn raw(&mut self, name: &str) -> Option<String> {
        let index = self.0.iter().position(|(known, _)| known == name)?;
        Some(self.0.swap_remove(index).1)
    }

    /// The number that a parameter holds, if there is one. May be NaN or infinite: whoever uses it says which
    /// numbers it can use.
    pub(crate) fn number(&mut self, name: &str) -> Result<Option<f64>, ApiError> {
        self.take(name).map(|text| number(name, &text)).transpose()
    }

    /// The number that a parameter must hold.
    pub(crate) fn required_number(&mut self, name: &str) -> Result<f64, ApiError> {
        self.number(name)?.ok_or_else(|| ApiError::invalid(name, "is missing"))
    }

    /// A whole number from 1 to `most`, or `default` where there is none.
    pub(crate) fn count(&mut self, name: &str, default: u32, most: u32) -> Result<u32, ApiError> {
        let Some(text) = self.take(name) else { return Ok(default) };
        let count: Option<u32> = text.parse().ok().filter(|count| (1..=most).contains(count));
        count.ok_or_else(|| {
            ApiError::invalid(name, format!("must be a whole number from 1 to {most}, not {text:?}"))
        })
    }

    /// Refuses what nobody asked for. `known` are the names for the message.
    pub(crate) fn finish(self, known: &[&str]) -> Result<(), ApiError> {
        match self.0.into_iter().next() {
            None => Ok(()),
            Some((name, _)) => {
                let reason = format!("is not known; this path takes {}", known.join(", "));
                Err(ApiError::invalid(name, reason))
            }
        }
    }
}

/// Reads a number.
pub(crate) fn number(field: &str, text: &str) -> Result<f64, ApiError> {
    text.parse().map_err(|_| ApiError::malformed(Some(field), format!("{field} is not a number: {text:?}")))
}

/// Percent-decodes; `None` for a broken escape or what is not UTF-8.
fn decode(text: &str) -> Option<String> {
    let mut bytes = text.bytes();
    let mut out = Vec::with_capacity(text.len());
    while let Some(byte) = bytes.next() {
        if byte == b'%' {
            let mut digit = || char::from(bytes.next()?).to_digit(16);
            let (high, low) = (digit()?, digit()?);
            out.push((high * 16 + low) as u8);
        } else {
            out.push(byte);
        }
    }
    String::from_utf8(out).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params(query: &str) -> Result<Params, ApiError> {
        Params::parse(Some(query))
    }

    #[test]
    fn parameters_are_decoded() {
        let mut params = params("alpha=0.1%2e.0%2E5&&theta=1e+0&%63=m").unwrap();
        assert_eq!(params.take("alpha").unwrap(), "0.1..0.5");
        assert_eq!(params.number("theta").unwrap(), Some(1.0));
        assert_eq!(params.take("c").unwrap(), "m");
        assert_eq!(params.take("c"), None);
        let mut words = self::params("name=ltc+b%2Bc%20d&since=2026-11-23T10:00:00+01:00").unwrap();
        assert_eq!(words.words("name").unwrap(), "ltc b+c d");
        assert_eq!(words.take("since").unwrap(), "2026-11-23T10:00:00+01:00");
        assert!(params.finish(&[]).is_ok());
        assert!(Params::parse(None).unwrap().finish(&[]).is_ok());
    }

    #[test]
    fn broken_escapes_are_malformed() {
        for query in ["a=%", "a=%4", "a=%zz", "a=%ff", "%=1", "a=%+1"] {
            assert!(matches!(params(query), Err(ApiError::Malformed { .. })), "{query}");
        }
    }

    #[test]
    fn doubles_unknowns_and_gaps_are_invalid() {
        assert!(matches!(params("a=1&a=1"), Err(ApiError::Invalid { field, .. }) if field == "a"));
        let error = params("a=1").unwrap().finish(&["b", "c"]).unwrap_err();
        assert_eq!(error.to_string(), "a is not known; this path takes b, c");
        assert!(matches!(params("").unwrap().required_number("a"), Err(ApiError::Invalid { .. })));
        assert!(matches!(params("a=").unwrap().number("a"), Err(ApiError::Malformed { .. })));
        assert!(params("a=NaN").unwrap().required_number("a").unwrap().is_nan());
    }
}
