//! What the handlers share.

use std::sync::Arc;

use axum::body::Bytes;
use ltc_table::{Catalogue, TableVersion};

use crate::cache::Cache;
use crate::compute::Compute;
use crate::etag::ETag;
use crate::representation::Tagged;
use crate::variant::VariantKey;
use crate::{ApiError, Limits, Variant};

/// Tables, limits, and the cache of encoded tables. Clones share everything.
#[derive(Clone, Debug)]
pub struct AppState(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    catalogue: Catalogue,
    limits: Limits,
    compute: Compute,
    variants: Cache<VariantKey>,
}

impl AppState {
    /// A state that serves these tables.
    pub fn new(catalogue: Catalogue, limits: Limits) -> Self {
        let variants = Cache::new(limits.cache_bytes);
        Self(Arc::new(Shared { catalogue, limits, compute: Compute::new(), variants }))
    }

    pub(crate) fn catalogue(&self) -> &Catalogue {
        &self.0.catalogue
    }

    pub(crate) fn limits(&self) -> &Limits {
        &self.0.limits
    }

    pub(crate) fn compute(&self) -> &Compute {
        &self.0.compute
    }

    /// The bytes of a variant: the payload as it is, or encoded once and then from the cache.
    pub(crate) async fn encoded(
        &self,
        version: &Arc<TableVersion>,
        variant: Variant,
    ) -> Result<Tagged, ApiError> {
        if variant.is_payload() {
            let etag = ETag::of_digest(&version.manifest().digest);
            return Ok(Tagged { bytes: Bytes::from_owner(Payload(Arc::clone(version))), etag });
        }
        let key = variant.key(version);
        if let Some(known) = self.0.variants.get(&key) {
            return Ok(known);
        }
        let (shared, version) = (Arc::clone(&self.0), Arc::clone(version));
        let encode = move || {
            // Whoever waited for a processor may find that the one before it did the work.
            if let Some(known) = shared.variants.get(&key) {
                return Ok(known);
            }
            let encoded = Tagged::new(variant.encode(&version)?);
            shared.variants.insert(key, encoded.clone());
            Ok(encoded)
        };
        self.0.compute.run(encode).await?
    }
}

/// Lends a version's payload to responses without copying it.
struct Payload(Arc<TableVersion>);

impl AsRef<[u8]> for Payload {
    fn as_ref(&self) -> &[u8] {
        self.0.payload()
    }
}
