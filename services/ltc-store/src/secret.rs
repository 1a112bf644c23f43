//! What a client shows to be let in: `ltc_<id>_<secret>`, the secret 256 random bits in base64url.

use std::collections::BTreeSet;
use std::time::{Duration, SystemTime};

use base64::Engine;
use base64::prelude::BASE64_URL_SAFE_NO_PAD as BASE64;
use sha2::{Digest, Sha256};
use subtle::ConstantTimeEq;

use crate::{Scope, StoreError, Token, TokenHash, clock};

/// What every token begins with, so that scanners for leaked secrets know it.
const PREFIX: &str = "ltc_";
/// Characters of a token's id.
const ID_LENGTH: usize = 12;
/// Characters of a token's secret: 256 bits.
const SECRET_LENGTH: usize = 43;

/// A token in the clear. It is shown once, when it is made; its `Debug` does not show it.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret {
    id: String,
    text: String,
}

impl std::fmt::Debug for Secret {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Secret({}, …)", self.id)
    }
}

impl Secret {
    /// Makes a token: what is kept of it, and what its owner gets. `lifetime` from now, or for ever.
    ///
    /// # Errors
    /// [`StoreError::Backend`] where the system has no random numbers.
    pub fn generate(
        label: &str,
        scopes: BTreeSet<Scope>,
        lifetime: Option<Duration>,
    ) -> Result<(Token, Self), StoreError> {
        let mut random = [0; 32 + ID_LENGTH / 2];
        getrandom::fill(&mut random).map_err(|e| StoreError::Backend(e.to_string()))?;
        let (secret, id) = random.split_at(32);
        let id: String = id.iter().map(|byte| format!("{byte:02x}")).collect();
        let text = format!("{PREFIX}{id}_{}", BASE64.encode(secret));
        let secret = Self { id, text };
        let now = SystemTime::now();
        let expires = lifetime.and_then(|lifetime| now.checked_add(lifetime));
        let token = Token {
            id: secret.id.clone(),
            label: label.to_owned(),
            hash: secret.hash(),
            scopes,
            created: clock::rfc3339(clock::micros(now)),
            expires: expires.map(|time| clock::rfc3339(clock::micros(time))),
        };
        Ok((token, secret))
    }

    /// What a client sent, if it has the form of a token.
    pub fn parse(text: &str) -> Option<Self> {
        let (id, secret) = text.strip_prefix(PREFIX)?.split_once('_')?;
        let hex = id.len() == ID_LENGTH && id.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
        let long = secret.len() == SECRET_LENGTH && BASE64.decode(secret).is_ok();
        (hex && long).then(|| Self { id: id.to_owned(), text: text.to_owned() })
    }

    /// The token's public name.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// The whole of it, for its owner's eyes.
    pub fn reveal(&self) -> &str {
        &self.text
    }

    /// Whether it is `token`, and that has not ended. The time this takes tells nothing about the secret.
    pub fn opens(&self, token: &Token) -> bool {
        let same = self.id == token.id && bool::from(self.hash().0.ct_eq(&token.hash.0));
        same && !token.has_ended()
    }

    fn hash(&self) -> TokenHash {
        TokenHash(Sha256::digest(self.text.as_bytes()).into())
    }
}

impl Token {
    /// Whether its time is over. One whose end cannot be read has ended.
    pub fn has_ended(&self) -> bool {
        let ends = self.expires.as_deref().map(clock::parse);
        ends.is_some_and(|end| end.map_or(true, |end| end <= clock::now()))
    }
}

impl Scope {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Read, Self::Refit, Self::Publish, Self::Benchmark];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Refit => "refit",
            Self::Publish => "publish",
            Self::Benchmark => "benchmark",
        }
    }

    /// The one of that name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scope| scope.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn token(lifetime: Option<Duration>) -> (Token, Secret) {
        Secret::generate("a test", BTreeSet::from([Scope::Refit]), lifetime).unwrap()
    }

    #[test]
    fn a_secret_opens_its_own_token_and_no_other() {
        let ((token, secret), (other, _)) = (token(None), token(None));
        let shown = secret.reveal();
        assert_eq!(shown.len(), PREFIX.len() + ID_LENGTH + 1 + SECRET_LENGTH);
        let parsed = Secret::parse(shown).unwrap();
        assert!(parsed.opens(&token));
        assert!(!parsed.opens(&other));
        // The right id with another secret.
        let forged = Token { id: token.id.clone(), ..other };
        assert!(!parsed.opens(&forged));
        assert!(!format!("{secret:?} {token:?}").contains(&shown[PREFIX.len() + ID_LENGTH + 1..]));
    }

    #[test]
    fn tokens_end() {
        let (ended, secret) = token(Some(Duration::ZERO));
        assert!(ended.has_ended() && !secret.opens(&ended));
        let (fresh, secret) = token(Some(Duration::from_secs(60)));
        assert!(secret.opens(&fresh));
        assert!(Token { expires: Some("some day".to_owned()), ..fresh }.has_ended());
        assert_eq!(token(Some(Duration::MAX)).0.expires, None, "beyond the end of time");
    }

    #[test]
    fn what_is_no_token_is_not_taken_for_one() {
        let (_, secret) = token(None);
        let good = secret.reveal();
        for bad in [
            "",
            "ltc_",
            "ltc__",
            &good[1..],
            &good[..good.len() - 1],
            &format!("{good}A"),
            &good.replace("ltc_", "LTC_"),
            &format!("{}!", &good[..good.len() - 1]),
            &format!(" {good}"),
        ] {
            assert_eq!(Secret::parse(bad), None, "{bad:?}");
        }
    }

    #[test]
    fn scopes_have_the_names_that_they_are_kept_under() {
        for scope in Scope::ALL {
            assert_eq!(serde_json::to_value(scope).unwrap(), scope.name());
            assert_eq!(Scope::by_name(scope.name()), Some(scope));
        }
        assert_eq!(Scope::by_name("admin"), None);
    }
}
