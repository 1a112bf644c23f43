//! Fits that outlive their process.
//!
//! [`fit`] writes the state of a [`FitRun`] to a [`Store`] every few seconds and goes on from what it finds there. A
//! folder beside the output ([`Folder`]) is one such store; a service may keep states elsewhere.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use ltc_table::{TableError, digest::digest, files::write_atomically};
use serde::{Deserialize, Serialize};

use crate::{FitError, FitRun, FitSpec, FitState, Fitted, Observer, Plan};

/// What every checkpoint begins with; its number changes with the meaning of [`FitState`].
const MAGIC: &str = "ltc-fit checkpoint 2 ";

/// Keeps one checkpoint of one fit.
pub trait Store {
    /// The checkpoint, if there is one.
    ///
    /// # Errors
    /// When there is one that cannot be read.
    fn load(&self) -> Result<Option<Vec<u8>>, TableError>;

    /// Replaces it; a kill at any moment leaves the old one or the new one.
    ///
    /// # Errors
    /// When it cannot be written.
    fn save(&self, bytes: &[u8]) -> Result<(), TableError>;

    /// Removes it.
    ///
    /// # Errors
    /// When there is one that cannot be removed.
    fn clear(&self) -> Result<(), TableError>;
}

/// How a fit is kept.
pub struct Checkpoints<'a> {
    /// Where.
    pub store: &'a dyn Store,
    /// What names the program: only checkpoints of the same program are gone on from, since another may fit otherwise.
    pub program: &'a str,
    /// How often; stages' ends are always kept.
    pub every: Duration,
}

/// What [`fit`] has to say besides its progress.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// It goes on from a checkpoint.
    Resumed {
        /// The stage that it was in; `None` when all was done.
        stage: Option<&'static str>,
    },
    /// There is a checkpoint that is of no use; the fit starts anew.
    Ignored {
        /// Why.
        reason: String,
    },
    /// A checkpoint could not be written; the fit goes on.
    NotSaved {
        /// Why.
        reason: String,
    },
}

impl core::fmt::Display for Notice {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Resumed { stage: Some(stage) } => write!(f, "going on from a checkpoint ({stage})"),
            Self::Resumed { stage: None } => write!(f, "going on from a checkpoint (all stages done)"),
            Self::Ignored { reason } => write!(f, "a checkpoint is ignored: {reason}"),
            Self::NotSaved { reason } => write!(f, "no checkpoint could be written: {reason}"),
        }
    }
}

/// Fits a table, from its checkpoint if there is one. The result is the same to the last bit, however often the fit was
/// interrupted. The checkpoint stays until [`Store::clear`]: whoever has put the table in its place calls that.
///
/// # Errors
/// As [`crate::fit`]. When the observer stops the fit, its state is kept first.
pub fn fit(
    plan: &Plan<'_>,
    checkpoints: &Checkpoints<'_>,
    observer: Observer<'_>,
    notice: &dyn Fn(Notice),
) -> Result<Fitted, FitError> {
    /// Least time between two checkpoints, in units of what writing one takes: large tables are kept less often.
    const PATIENCE: u32 = 20;
    let keeper = Keeper { plan, checkpoints, notice };
    let mut run = keeper.start();
    let mut stage = run.stage();
    let mut last = Instant::now();
    let mut wait = checkpoints.every;
    loop {
        let more = run.advance(observer);
        if last.elapsed() >= wait || run.stage() != stage || more.is_err() {
            let start = Instant::now();
            keeper.save(&run);
            (last, stage) = (Instant::now(), run.stage());
            wait = checkpoints.every.max(PATIENCE * (last - start));
        }
        if !more? {
            return run.finish();
        }
    }
}

/// A checkpoint's content.
#[derive(Serialize, Deserialize)]
struct Checkpoint<S, T> {
    program: String,
    spec: S,
    state: T,
}

struct Keeper<'a> {
    plan: &'a Plan<'a>,
    checkpoints: &'a Checkpoints<'a>,
    notice: &'a dyn Fn(Notice),
}

impl<'a> Keeper<'a> {
    /// The run to go on with.
    fn start(&self) -> FitRun<'a> {
        let found = match self.checkpoints.store.load() {
            Ok(None) => return FitRun::new(self.plan),
            Ok(Some(bytes)) => self.read(&bytes),
            Err(error) => Err(error.to_string()),
        };
        found.map_or_else(
            |reason| {
                (self.notice)(Notice::Ignored { reason });
                FitRun::new(self.plan)
            },
            |run| {
                (self.notice)(Notice::Resumed { stage: run.stage() });
                run
            },
        )
    }

    fn read(&self, bytes: &[u8]) -> Result<FitRun<'a>, String> {
        let Checkpoint { program, spec, state }: Checkpoint<FitSpec, FitState> = unpack(bytes)?;
        if program != self.checkpoints.program {
            return Err(format!("it was written by another program, {program}"));
        }
        if spec != *self.plan.spec() {
            return Err("it is of another specification".to_owned());
        }
        FitRun::resume(self.plan, state).map_err(|e| e.to_string())
    }

    fn save(&self, run: &FitRun<'_>) {
        let (program, spec) = (self.checkpoints.program.to_owned(), self.plan.spec());
        let saved = pack(&Checkpoint { program, spec, state: run.state() })
            .and_then(|bytes| self.checkpoints.store.save(&bytes));
        if let Err(error) = saved {
            (self.notice)(Notice::NotSaved { reason: error.to_string() });
        }
    }
}

/// A line with the digest of what follows it, and JSON, whose numbers come back to the last bit.
fn pack(checkpoint: &impl Serialize) -> Result<Vec<u8>, TableError> {
    let body = serde_json::to_vec(checkpoint)?;
    let head = format!("{MAGIC}{}\n", digest(&body));
    Ok([head.as_bytes(), &body].concat())
}

fn unpack<T: for<'de> Deserialize<'de>>(bytes: &[u8]) -> Result<T, String> {
    let line = bytes.iter().position(|b| *b == b'\n').ok_or("it is damaged")?;
    let (head, body) = (&bytes[..line], &bytes[line + 1..]);
    let head = core::str::from_utf8(head).map_err(|_| "it is damaged")?;
    let stated = head.strip_prefix(MAGIC).ok_or("it is of another format")?;
    if stated != digest(body) {
        return Err("it is damaged".to_owned());
    }
    serde_json::from_slice(body).map_err(|e| e.to_string())
}

/// A checkpoint in `FOLDER/.checkpoints/DIGEST/state`, hidden beside the output; fits of other specifications have
/// folders of their own.
#[derive(Clone, Debug)]
pub struct Folder {
    all: PathBuf,
    own: PathBuf,
}

impl Folder {
    /// That of a plan whose table goes to `output`. Nothing is made before the first [`Store::save`].
    pub fn new(output: &Path, plan: &Plan<'_>) -> Self {
        let all = output.join(".checkpoints");
        let digest = plan.digest();
        let short: String = digest.trim_start_matches("sha256:").chars().take(16).collect();
        Self { own: all.join(short), all }
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.own
    }

    fn file(&self) -> PathBuf {
        self.own.join("state")
    }

    fn write(&self, bytes: &[u8]) -> Result<(), TableError> {
        fs::create_dir_all(&self.own).map_err(|e| io(&self.own, e))?;
        write_atomically(&self.file(), bytes)
    }
}

fn io(path: &Path, source: io::Error) -> TableError {
    TableError::Io { path: path.display().to_string(), source }
}

impl Store for Folder {
    fn load(&self) -> Result<Option<Vec<u8>>, TableError> {
        match fs::read(self.file()) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(io(&self.file(), error)),
        }
    }

    fn save(&self, bytes: &[u8]) -> Result<(), TableError> {
        /// More fits of one specification than anybody lets end at once.
        const TRIES: usize = 32;
        let mut saved = self.write(bytes);
        for _ in 1..TRIES {
            match saved {
                // Another fit of this specification has ended and taken the folder away meanwhile: it was there, but is
                // no folder when looked at again, or what was to go into it finds it gone.
                Err(TableError::Io { source, .. })
                    if matches!(source.kind(), ErrorKind::NotFound | ErrorKind::AlreadyExists) => {}
                _ => break,
            }
            saved = self.write(bytes);
        }
        saved
    }

    fn clear(&self) -> Result<(), TableError> {
        match fs::remove_dir_all(&self.own) {
            // What another fit of this specification has put there meanwhile is that one's to clear.
            Err(e) if !matches!(e.kind(), ErrorKind::NotFound | ErrorKind::DirectoryNotEmpty) => {
                return Err(io(&self.own, e));
            }
            _ => {}
        }
        // Other fits may have theirs there: only an empty folder goes.
        let _ = fs::remove_dir(&self.all);
        Ok(())
    }
}
