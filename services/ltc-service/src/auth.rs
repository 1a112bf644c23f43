//! Who asks, and what they may.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::extract::FromRequestParts;
use axum::http::{HeaderMap, header, request::Parts};
use ltc_store::{Metadata, Scope, Secret, StoreError, Token};

use crate::{ApiError, AppState};

/// How long a list of tokens is believed: a token that was revoked stops to work after that.
const BELIEVED: Duration = Duration::from_secs(1);
/// How long tokens that were good stay so while the store does not answer.
const WITHOUT_STORE: Duration = Duration::from_secs(30);

/// Tokens by id.
type Known = Arc<HashMap<String, Token>>;

/// The tokens of the store, as they were a moment ago.
#[derive(Debug, Default)]
pub(crate) struct Tokens {
    list: Mutex<Option<(Instant, Known)>>,
    reading: tokio::sync::Mutex<()>,
}

/// A client with a good token.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Caller {
    /// The token's public name.
    pub id: String,
    scopes: Vec<Scope>,
}

impl Caller {
    fn of(token: &Token) -> Self {
        Self { id: token.id.clone(), scopes: token.scopes.iter().copied().collect() }
    }

    /// # Errors
    /// [`ApiError::Forbidden`] unless the token has the scope.
    pub(crate) fn must(&self, scope: Scope) -> Result<(), ApiError> {
        if self.scopes.contains(&scope) { Ok(()) } else { Err(ApiError::Forbidden { scope }) }
    }
}

impl Tokens {
    /// Who sent these headers; `None` without a token. `guess` is asked before anything is said or done about a token that is
    /// not good.
    ///
    /// # Errors
    /// [`ApiError::Unauthenticated`] for a token that is not good; what `guess` says.
    pub(crate) async fn caller(
        &self,
        headers: &HeaderMap,
        metadata: &dyn Metadata,
        guess: impl FnOnce() -> Result<(), ApiError>,
    ) -> Result<Option<Caller>, ApiError> {
        let secret = match presented(headers) {
            Ok(None) => return Ok(None),
            Ok(Some(secret)) => secret,
            Err(error) => return guess().and(Err(error)),
        };
        let mut tokens = self.younger_than(BELIEVED);
        if tokens.is_none() {
            tokens = Some(self.read(metadata, BELIEVED).await?);
        }
        let open =
            |tokens: &Known| tokens.get(secret.id()).filter(|token| secret.opens(token)).map(Caller::of);
        if let Some(caller) = tokens.as_ref().and_then(open) {
            return Ok(Some(caller));
        }
        guess()?;
        // It may have been made a moment ago.
        let caller = open(&self.read(metadata, Duration::ZERO).await?);
        let reason = "the token is unknown, expired or revoked";
        caller.map(Some).ok_or(ApiError::Unauthenticated { reason, presented: true })
    }

    /// How many there are.
    pub(crate) async fn count(&self, metadata: &dyn Metadata) -> Result<usize, StoreError> {
        Ok(self.read(metadata, BELIEVED).await?.len())
    }

    /// A list that is younger than `age`: one reads, and others wait for what it finds.
    async fn read(&self, metadata: &dyn Metadata, age: Duration) -> Result<Known, StoreError> {
        let _reading = self.reading.lock().await;
        if let Some(list) = self.younger_than(age) {
            return Ok(list);
        }
        match metadata.tokens().await {
            Ok(tokens) => {
                let list: Known = Arc::new(tokens.into_iter().map(|t| (t.id.clone(), t)).collect());
                *self.list.lock().unwrap_or_else(PoisonError::into_inner) =
                    Some((Instant::now(), Arc::clone(&list)));
                Ok(list)
            }
            Err(error) => self.younger_than(WITHOUT_STORE).ok_or(error),
        }
    }

    fn younger_than(&self, age: Duration) -> Option<Known> {
        let list = self.list.lock().unwrap_or_else(PoisonError::into_inner);
        list.as_ref().filter(|(read, _)| read.elapsed() < age).map(|(_, list)| Arc::clone(list))
    }
}

/// The token in the headers.
fn presented(headers: &HeaderMap) -> Result<Option<Secret>, ApiError> {
    let mut values = headers.get_all(header::AUTHORIZATION).iter();
    let Some(value) = values.next() else { return Ok(None) };
    let bad = |reason| ApiError::Unauthenticated { reason, presented: true };
    if values.next().is_some() {
        return Err(bad("there is more than one Authorization header"));
    }
    let text = value.to_str().unwrap_or_default();
    let token = text.split_once(' ').filter(|(scheme, _)| scheme.eq_ignore_ascii_case("bearer"));
    let token = token.ok_or(bad("Authorization must be: Bearer, a space, and a token"))?.1.trim();
    Secret::parse(token).map(Some).ok_or(bad("this is not a token of this service"))
}

/// Whether a token is among the headers, good or not.
pub(crate) fn is_presented(headers: &HeaderMap) -> bool {
    headers.contains_key(header::AUTHORIZATION)
}

/// A caller with a scope; taken by handlers before the body is read.
async fn with_scope(parts: &Parts, state: &AppState, scope: Scope) -> Result<Caller, ApiError> {
    let known = parts.extensions.get::<Caller>().cloned();
    let caller = known.ok_or(ApiError::Unauthenticated {
        reason: "this needs a bearer token; ltc token create makes one",
        presented: false,
    })?;
    caller.must(scope)?;
    state.allow_write(&caller.id)?;
    Ok(caller)
}

macro_rules! callers {
    ($($name:ident: $scope:ident, $what:literal;)*) => {$(
        #[doc = $what]
        pub(crate) struct $name(pub Caller);

        impl FromRequestParts<AppState> for $name {
            type Rejection = ApiError;

            async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
                with_scope(parts, state, Scope::$scope).await.map(Self)
            }
        }
    )*};
}

callers! {
    Publisher: Publish, "Whoever may upload tables and move aliases.";
    Refitter: Refit, "Whoever may ask for refits.";
    Benchmarker: Benchmark, "Whoever may post benchmark runs.";
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use axum::http::HeaderValue;
    use ltc_store::MemoryStore;

    use super::*;

    fn headers(value: &str) -> HeaderMap {
        let mut value = HeaderValue::from_str(value).unwrap();
        value.set_sensitive(true);
        HeaderMap::from_iter([(header::AUTHORIZATION, value)])
    }

    async fn add(store: &MemoryStore, scope: Scope) -> Secret {
        let (token, secret) = Secret::generate("test", BTreeSet::from([scope]), None).unwrap();
        store.add_token(token).await.unwrap();
        secret
    }

    #[tokio::test]
    async fn only_good_tokens_are_callers_and_only_for_their_scopes() {
        let store = MemoryStore::default();
        let secret = add(&store, Scope::Refit).await;
        let (_, unknown) = Secret::generate("test", BTreeSet::new(), None).unwrap();
        let tokens = Tokens::default();
        assert_eq!(tokens.caller(&HeaderMap::new(), &store, || Ok(())).await.unwrap(), None);
        for scheme in ["Bearer", "bearer", "BEARER"] {
            let good = headers(&format!("{scheme} {}", secret.reveal()));
            let caller = tokens.caller(&good, &store, || Ok(())).await.unwrap().unwrap();
            assert_eq!(caller.id, secret.id());
            caller.must(Scope::Refit).unwrap();
            assert!(matches!(
                caller.must(Scope::Publish),
                Err(ApiError::Forbidden { scope: Scope::Publish })
            ));
        }
        for bad in [
            format!("Bearer {}", unknown.reveal()),
            format!("Basic {}", secret.reveal()),
            secret.reveal().to_owned(),
            "Bearer".to_owned(),
            "Bearer ".to_owned(),
            String::new(),
        ] {
            let refused = tokens.caller(&headers(&bad), &store, || Ok(())).await;
            assert!(matches!(refused, Err(ApiError::Unauthenticated { presented: true, .. })), "{bad}");
        }
        let mut twice = headers(&format!("Bearer {}", secret.reveal()));
        twice.append(header::AUTHORIZATION, HeaderValue::from_static("Bearer x"));
        assert!(tokens.caller(&twice, &store, || Ok(())).await.is_err());
    }

    #[tokio::test]
    async fn a_revoked_token_stops_to_work() {
        let store = MemoryStore::default();
        let secret = add(&store, Scope::Refit).await;
        let tokens = Tokens::default();
        let headers = headers(&format!("Bearer {}", secret.reveal()));
        assert!(tokens.caller(&headers, &store, || Ok(())).await.unwrap().is_some());
        store.revoke_token(secret.id()).await.unwrap();
        tokio::time::sleep(BELIEVED).await;
        assert!(tokens.caller(&headers, &store, || Ok(())).await.is_err());
    }
}
