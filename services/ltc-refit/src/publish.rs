//! From a fitted table to a version with an alias.

use ltc_store::{
    Alias, BlobKind, Claim, LATEST, NewVersion, Outcome, StoreError, StoredVersion, VersionState,
};
use ltc_table::TableVersion;
use serde_json::Value;

use crate::refits::Shared;

impl Shared {
    /// Keeps a table: its payload, then its version.
    pub(crate) async fn keep(
        &self,
        claim: &Claim,
        fitted: &TableVersion,
    ) -> Result<StoredVersion, StoreError> {
        let manifest = fitted.manifest();
        let json = serde_json::to_value(manifest).map_err(|e| StoreError::Backend(e.to_string()))?;
        self.blobs.put(BlobKind::Payload, &manifest.digest, fitted.payload()).await?;
        self.hold_latest(claim, &manifest.name, &json).await?;
        let new = NewVersion {
            table: manifest.name.clone(),
            digest: manifest.digest.clone(),
            manifest: json,
            state: VersionState::Published,
            spec_digest: Some(claim.job.request.spec_digest.clone()),
            reason: None,
        };
        Ok(self.metadata.add_version(new, None).await?.0)
    }

    /// Where nobody has set `latest` it is the newest version: a worse one would take it by being there. It is then set to the version
    /// that it is, before the new one is kept.
    async fn hold_latest(&self, claim: &Claim, table: &str, manifest: &Value) -> Result<(), StoreError> {
        let forced = matches!(&claim.job.request.alias, Some((name, true)) if name == LATEST);
        let is_set = |alias: &Alias| alias.table == table && alias.name == LATEST;
        if forced || self.metadata.aliases().await?.iter().any(is_set) {
            return Ok(());
        }
        let versions = self.metadata.versions().await?;
        let newest = versions.into_iter().filter(|v| v.table == table && v.state == VersionState::Published);
        let Some(newest) = newest.max_by_key(|v| v.number) else { return Ok(()) };
        let Some(why) = worse(&newest.manifest, manifest) else { return Ok(()) };
        match self.metadata.move_alias(table, LATEST, newest.number, Some(0)).await {
            Ok(_) => tracing::info!(table, version = newest.number, why, "latest stays"),
            // Somebody has set it meanwhile.
            Err(StoreError::Conflict { .. }) => {}
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Moves the alias that the job is to move, where the version deserves it.
    pub(crate) async fn point(&self, claim: &Claim, version: &StoredVersion) -> Result<Outcome, StoreError> {
        let number = version.number;
        let succeeded = |note: String| Ok(Outcome::Succeeded { version: number, note });
        let Some((name, force)) = &claim.job.request.alias else {
            return succeeded(format!("version {number}"));
        };
        loop {
            let aliases = self.metadata.aliases().await?;
            let there = aliases.into_iter().find(|a| a.table == version.table && a.name == *name);
            let stays = match &there {
                None => None,
                Some(there) if there.number == number => Some("points at it already".to_owned()),
                Some(_) if *force => None,
                Some(there) => self.why_it_stays(there, version).await?,
            };
            if let Some(why) = stays {
                return succeeded(format!("version {number}; the alias \"{name}\" {why}"));
            }
            // Somebody who moves it in between has it looked at anew.
            let revision = there.map_or(0, |there| there.revision);
            match self.metadata.move_alias(&version.table, name, number, Some(revision)).await {
                Ok(_) => {
                    return succeeded(format!("version {number}; the alias \"{name}\" points at it now"));
                }
                Err(StoreError::Conflict { .. }) if version.state == VersionState::Published => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Why an alias is not moved, where it should not be.
    async fn why_it_stays(&self, there: &Alias, new: &StoredVersion) -> Result<Option<String>, StoreError> {
        let old = self.metadata.version(&there.table, there.number).await?;
        let why = worse(&old.manifest, &new.manifest);
        Ok(why.map(|why| format!("stays at version {}: {why}", there.number)))
    }
}

/// Why a version is worse than another one, if it is.
fn worse(old: &Value, new: &Value) -> Option<String> {
    let (old, new) = (tv_mean(old)?, tv_mean(new)?);
    (new > old).then(|| format!("the mean TV of its standard draw is {old:.6}, that of this one {new:.6}"))
}

/// The mean total variation over the standard draw that a manifest states.
fn tv_mean(manifest: &Value) -> Option<f64> {
    manifest["errors"]["standard_draw"]["tv_mean"].as_f64()
}
