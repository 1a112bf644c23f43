//! `ltc token`

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use anyhow::{Context, Result, bail};
use clap::{Args, Subcommand};
use ltc_store::{EmbeddedStore, Metadata, Scope, Secret, Token};
use serde_json::{Value, json};

/// Makes, lists and revokes the tokens that let clients write to a service. None exists by default.
///
/// The commands work beside a running service; it sees what they do at once.
///
/// Example: ltc token create --data DIR --scope publish
#[derive(Args)]
pub struct Tokens {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Create(Create),
    List(List),
    Revoke(Revoke),
}

/// The data folder of a service.
#[derive(Args)]
struct Data {
    /// Data folder of the service.
    #[arg(long = "data", value_name = "DIR", env = "LTC_DATA")]
    folder: PathBuf,
}

/// Makes a token and prints it, once: only a hash of it is kept.
///
/// Example: ltc token create --data DIR --scope refit,publish --label "asset pipeline" --expires 90d
#[derive(Args)]
struct Create {
    #[command(flatten)]
    data: Data,
    /// What it may do: read (where reading is bound to tokens), refit, publish, benchmark.
    #[arg(long = "scope", value_name = "SCOPES", required = true, value_delimiter = ',', value_parser = scope)]
    scopes: Vec<Scope>,
    /// Whose it is, in words.
    #[arg(long, value_name = "TEXT", default_value = "")]
    label: String,
    /// When it ends: a time from now (90d, 12h) or a date (2027-01-31, or RFC 3339 in UTC); never by default.
    #[arg(long, value_name = "WHEN", value_parser = lifetime)]
    expires: Option<Duration>,
    /// Prints the token and what is kept of it as JSON.
    #[arg(long)]
    json: bool,
}

/// Lists the tokens; their secrets are kept nowhere.
///
/// Example: ltc token list --data DIR
#[derive(Args)]
struct List {
    #[command(flatten)]
    data: Data,
    /// Prints JSON.
    #[arg(long)]
    json: bool,
}

/// Ends a token. The service refuses it from then on.
///
/// Example: ltc token revoke --data DIR 0f3a5c771b2e
#[derive(Args)]
struct Revoke {
    #[command(flatten)]
    data: Data,
    /// The token's id: the part between the first two underscores, as `ltc token list` shows it.
    #[arg(value_name = "ID")]
    id: String,
}

impl Tokens {
    pub fn run(self) -> Result<()> {
        let runtime =
            tokio::runtime::Builder::new_current_thread().build().context("cannot start threads")?;
        runtime.block_on(async {
            match self.command {
                Command::Create(command) => command.run().await,
                Command::List(command) => command.run().await,
                Command::Revoke(command) => command.run().await,
            }
        })
    }
}

impl Data {
    /// The store, which is made where it is missing.
    fn open(&self) -> Result<EmbeddedStore> {
        EmbeddedStore::attach(&self.folder).with_context(|| self.folder.display().to_string())
    }

    /// The store, which has to be there.
    fn find(&self) -> Result<EmbeddedStore> {
        if !EmbeddedStore::is_in(&self.folder) {
            bail!("there is no store in {}", self.folder.display());
        }
        self.open()
    }
}

impl Create {
    async fn run(self) -> Result<()> {
        let store = self.data.open()?;
        let (token, secret) = Secret::generate(&self.label, self.scopes.into_iter().collect(), self.expires)?;
        store.add_token(token.clone()).await?;
        if self.json {
            let mut json = as_json(&token);
            json["token"] = secret.reveal().into();
            outln!("{}", serde_json::to_string_pretty(&json)?);
        } else {
            eprintln!("{}; keep it now, it is shown this once:", in_words(&token));
            outln!("{}", secret.reveal());
        }
        Ok(())
    }
}

impl List {
    async fn run(self) -> Result<()> {
        let tokens = self.data.find()?.tokens().await?;
        if self.json {
            let list: Vec<Value> = tokens.iter().map(as_json).collect();
            outln!("{}", serde_json::to_string_pretty(&list)?);
            return Ok(());
        }
        for token in &tokens {
            outln!("{}", in_words(token));
        }
        if tokens.is_empty() {
            eprintln!("no tokens: nobody can write to the service");
        }
        Ok(())
    }
}

impl Revoke {
    async fn run(self) -> Result<()> {
        self.data.find()?.revoke_token(&self.id).await?;
        eprintln!("{} ends", self.id);
        Ok(())
    }
}

fn scope_names(scopes: &BTreeSet<Scope>) -> Vec<&'static str> {
    scopes.iter().map(|scope| scope.name()).collect()
}

fn in_words(token: &Token) -> String {
    let end = match &token.expires {
        Some(end) if token.has_ended() => format!("ended {end}"),
        Some(end) => format!("until {end}"),
        None => "does not end".to_owned(),
    };
    let (id, scopes) = (&token.id, scope_names(&token.scopes).join(","));
    // One line, whatever the label holds.
    let label: String = token.label.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!("{id}  {scopes}  made {}, {end}  {label}", token.created).trim_end().to_owned()
}

fn as_json(token: &Token) -> Value {
    json!({
        "id": token.id,
        "label": token.label,
        "scopes": scope_names(&token.scopes),
        "created": token.created,
        "expires": token.expires,
        "ended": token.has_ended(),
    })
}

fn scope(name: &str) -> Result<Scope, String> {
    Scope::by_name(name.trim()).ok_or_else(|| {
        let known: Vec<&str> = Scope::ALL.iter().map(|scope| scope.name()).collect();
        format!("there is no scope \"{name}\"; there are: {}", known.join(", "))
    })
}

/// From now to a time given either way.
fn lifetime(text: &str) -> Result<Duration, String> {
    if let Ok(duration) = humantime::parse_duration(text) {
        return Ok(duration);
    }
    let date =
        humantime::parse_rfc3339(text).or_else(|_| humantime::parse_rfc3339(&format!("{text}T00:00:00Z")));
    let date =
        date.map_err(|_| "is neither a time from now (90d, 12h) nor a date (2027-01-31)".to_owned())?;
    date.duration_since(SystemTime::now()).map_err(|_| "is over already".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_given_either_way() {
        assert_eq!(lifetime("90d").unwrap(), Duration::from_secs(90 * 86_400));
        assert!(lifetime("2999-01-31").unwrap() > Duration::from_secs(86_400 * 365 * 900));
        assert!(lifetime("2999-01-31T12:00:00Z").unwrap() > lifetime("2999-01-31").unwrap());
        assert_eq!(lifetime("2001-01-01").unwrap_err(), "is over already");
        assert!(lifetime("soon").is_err());
    }

    #[test]
    fn a_token_is_told_on_one_line() {
        let (token, secret) =
            Secret::generate("a\nb\u{7}", [Scope::Publish, Scope::Refit].into(), None).unwrap();
        let told = in_words(&token);
        assert!(told.ends_with("does not end  a b") && told.contains("refit,publish"), "{told:?}");
        assert!(!as_json(&token).to_string().contains(&secret.reveal()[20..]), "no secret");
    }
}
