//! What the command line asks for.

use std::fmt;

/// The help text.
pub const USAGE: &str = "\
The chores of this workspace.

cargo xtask test [--fast]                everything that has to pass: set-up, formatting, dependency edges, lints,
                                         tests, doc tests, docs, checks by outside readers
                                         (--fast leaves out the last three)
cargo xtask demo [--once] [--listen A]   the whole thread: builds ltc, serves the tables on A (127.0.0.1:8787 unless
                                         told otherwise), fetches one, looks it up, renders with it, and stays up
                                         until Ctrl-C (--once stops by itself)
cargo xtask setup                        puts in place what this machine lacks for the GPU parts and their tests
cargo xtask edges                        checks which crates may not depend on which
cargo xtask tables                       fits and verifies the tables in tables/ anew (takes long)

Example: cargo xtask demo --once --listen 127.0.0.1:0";

/// Where the demo listens unless told otherwise.
pub const DEFAULT_LISTEN: &str = "127.0.0.1:8787";

/// One chore and its options.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Chore {
    /// Prints [`USAGE`].
    Help,
    /// Everything that has to pass; `fast` leaves out what is slow and seldom breaks.
    Test { fast: bool },
    /// A driver for the GPU parts.
    Setup,
    /// Who may not depend on whom.
    Edges,
    /// The whole thread, once or until Ctrl-C, on the address `listen`.
    Demo { once: bool, listen: String },
    /// The shipped tables, anew.
    Tables,
}

/// Why a command line was not understood.
#[derive(Debug, PartialEq, Eq)]
pub enum BadArgs {
    /// No chore of this name.
    UnknownChore(String),
    /// This chore has no such option.
    UnknownOption { chore: String, option: String },
    /// The option stands there without its value.
    MissingValue(&'static str),
}

impl fmt::Display for BadArgs {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownChore(chore) => write!(out, "no chore is called '{chore}'"),
            Self::UnknownOption { chore, option } => write!(out, "'{chore}' has no option '{option}'"),
            Self::MissingValue(option) => write!(out, "'{option}' needs a value"),
        }
    }
}

/// Reads the arguments after the program's name. No arguments at all ask for help.
pub fn parse(words: impl IntoIterator<Item = String>) -> Result<Chore, BadArgs> {
    let mut words = words.into_iter();
    let Some(chore) = words.next() else { return Ok(Chore::Help) };
    let (mut fast, mut once, mut listen) = (false, false, DEFAULT_LISTEN.to_owned());
    while let Some(word) = words.next() {
        match (chore.as_str(), word.as_str()) {
            (_, "--help" | "-h") => return Ok(Chore::Help),
            ("test", "--fast") => fast = true,
            ("demo", "--once") => once = true,
            ("demo", "--listen") => listen = words.next().ok_or(BadArgs::MissingValue("--listen"))?,
            ("demo", option) if option.starts_with("--listen=") => {
                listen = option.trim_start_matches("--listen=").to_owned();
            }
            _ => return Err(BadArgs::UnknownOption { chore, option: word }),
        }
    }
    match chore.as_str() {
        "help" | "--help" | "-h" => Ok(Chore::Help),
        "test" => Ok(Chore::Test { fast }),
        "setup" => Ok(Chore::Setup),
        "edges" => Ok(Chore::Edges),
        "demo" => Ok(Chore::Demo { once, listen }),
        "tables" => Ok(Chore::Tables),
        _ => Err(BadArgs::UnknownChore(chore)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> Result<Chore, BadArgs> {
        parse(line.split_whitespace().map(str::to_owned))
    }

    #[test]
    fn reads_every_chore() {
        let listen = DEFAULT_LISTEN.to_owned();
        assert_eq!(parsed(""), Ok(Chore::Help));
        assert_eq!(parsed("test"), Ok(Chore::Test { fast: false }));
        assert_eq!(parsed("test --fast"), Ok(Chore::Test { fast: true }));
        assert_eq!(parsed("demo --once"), Ok(Chore::Demo { once: true, listen: listen.clone() }));
        assert_eq!(
            parsed("demo --listen [::1]:9"),
            Ok(Chore::Demo { once: false, listen: "[::1]:9".into() })
        );
        assert_eq!(parsed("demo --listen=h:9"), Ok(Chore::Demo { once: false, listen: "h:9".into() }));
        assert_eq!(parsed("demo --help"), Ok(Chore::Help));
        assert_eq!(parsed("tables"), Ok(Chore::Tables));
    }

    #[test]
    fn refuses_what_it_does_not_know() {
        let unknown = |chore: &str, option: &str| {
            Err(BadArgs::UnknownOption { chore: chore.to_owned(), option: option.to_owned() })
        };
        assert_eq!(parsed("tset"), Err(BadArgs::UnknownChore("tset".to_owned())));
        assert_eq!(parsed("test --once"), unknown("test", "--once"));
        assert_eq!(parsed("demo now"), unknown("demo", "now"));
        assert_eq!(parsed("demo --listen"), Err(BadArgs::MissingValue("--listen")));
    }
}
