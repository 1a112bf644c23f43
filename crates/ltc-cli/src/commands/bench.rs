//! `ltc bench`

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use anyhow::{Context, Result, bail};
use clap::{Args, Subcommand};
use ltc_benches::study::{self, Plan, Run, Session, Step, StudyError, Thresholds, Verdict};
use ltc_table::Catalogue;
use ltc_table::files::write_atomically;

use super::bench_post::{How, Post};
use crate::progress::Reporter;
use crate::tables::Tables;

/// Measures run time against error on this machine: tables, lookups, integrals, pictures, and forms on the graphics device.
///
/// Writes bench.json, bench.csv, bench.html (one page that needs nothing else), bencher.json (Bencher Metric Format) and
/// github-action-benchmark.json. Compare two runs with `ltc bench compare`; keep their history on a service with `ltc bench post`.
///
/// Example: ltc bench --quick -o /tmp/bench
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Bench {
    #[command(subcommand)]
    command: Option<Command>,
    /// In under a minute, with fewer cases, smaller pictures and wider intervals.
    #[arg(long)]
    quick: bool,
    /// What the graphics device does, and nothing else; fails where there is none.
    #[arg(long)]
    device_only: bool,
    /// Keeps the run in this folder of results, too: JSON, CSV and page, by machine and date.
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
    /// Folder to write to; made if it is not there.
    #[arg(short, long, value_name = "DIR", default_value = "bench")]
    output: PathBuf,
    /// The commit that is measured, for the record; GITHUB_SHA where it is set.
    #[arg(long, value_name = "HASH", env = "GITHUB_SHA")]
    commit: Option<String>,
    /// Prints bench.json, too.
    #[arg(long)]
    json: bool,
    /// Sends the run to the table service at this address, too; see `ltc bench post --help`.
    #[arg(long, value_name = "URL")]
    post: Option<String>,
    #[command(flatten)]
    how: How,
    /// What this program starts itself with to measure times in a process of their own: prints them as JSON, and nothing else.
    #[arg(long, hide = true)]
    session: bool,
}

#[derive(Subcommand)]
enum Command {
    Compare(Compare),
    Post(Post),
}

/// Compares two runs: ratios of times with their intervals, and of errors; fails where something became worse.
///
/// Example: ltc bench compare before/bench.json after/bench.json
#[derive(Args)]
struct Compare {
    /// The run before: a bench.json, or the folder that holds it.
    #[arg(value_name = "A")]
    before: PathBuf,
    /// The run after.
    #[arg(value_name = "B")]
    after: PathBuf,
    /// How much slower counts, in per cent; a difference that the intervals leave open never does.
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0)]
    time_threshold: f64,
    /// How much larger an error or a file counts, in per cent.
    #[arg(long, value_name = "PERCENT", default_value_t = 0.5)]
    error_threshold: f64,
    /// Lists what stayed the same, too.
    #[arg(long)]
    all: bool,
}

impl Bench {
    pub fn run(self, tables: &Tables) -> Result<()> {
        match self.command {
            Some(Command::Compare(compare)) => return compare.run(),
            Some(Command::Post(post)) => return post.run(read),
            None => {}
        }
        let date = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
        let (quick, device_only) = (self.quick, self.device_only);
        let plan = Plan { quick, device_only, date, commit: self.commit.clone() };
        let catalogue = tables.catalogue()?;
        if self.session {
            outln!("{}", serde_json::to_string(&study::session(&plan, &catalogue)?)?);
            return Ok(());
        }
        self.measure(&plan, &catalogue)
    }

    fn measure(self, plan: &Plan, catalogue: &Catalogue) -> Result<()> {
        let destination = self.post.as_deref().map(|url| self.how.destination(url)).transpose()?;
        let folder = &self.output;
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        let reporter = Reporter::new();
        let observe = |step: Step<'_>| reporter.report(step.stage, step.done, step.total, "");
        let run = study::run(plan, catalogue, &in_a_process_of_its_own, &observe)?;
        reporter.finish();
        let json = serde_json::to_string_pretty(&run)?;
        let (csv, page) = (study::csv(&run), study::page(&run));
        for (name, text) in [
            ("bench.json", &json),
            ("bench.csv", &csv),
            ("bench.html", &page),
            ("bencher.json", &serde_json::to_string_pretty(&study::bencher(&run))?),
            ("github-action-benchmark.json", &serde_json::to_string_pretty(&study::action(&run))?),
        ] {
            write(&folder.join(name), text)?;
        }
        if let Some(results) = &self.keep {
            let folder = results.join(run.machine.slug());
            std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
            let date = run.date.replace(':', "");
            for (kind, text) in [("json", &json), ("csv", &csv), ("html", &page)] {
                write(&folder.join(format!("{date}.{kind}")), text)?;
            }
        }
        for ratio in run.records.iter().filter(|record| record.asked.is_some()) {
            let (Some(found), Some(asked)) = (ratio.ratio, ratio.asked) else { continue };
            let (low, high) = (found.low, found.high);
            eprintln!("{}: {:.3} ({low:.3} to {high:.3}), asked at most {asked}", ratio.id, found.median);
        }
        if self.json {
            outln!("{json}");
        } else {
            let (count, page) = (run.records.len(), folder.join("bench.html"));
            outln!("{count} figures; the page is {}", page.display());
        }
        destination.map_or(Ok(()), |destination| destination.send(&run))
    }
}

impl Compare {
    fn run(self) -> Result<()> {
        for (name, percent) in
            [("--time-threshold", self.time_threshold), ("--error-threshold", self.error_threshold)]
        {
            anyhow::ensure!((0.0..1e6).contains(&percent), "{name} is {percent}, must be 0 or more");
        }
        let thresholds = Thresholds {
            time: self.time_threshold / 100.0,
            error: self.error_threshold / 100.0,
            ..Thresholds::default()
        };
        let comparison = study::compare(&read(&self.before)?, &read(&self.after)?, thresholds);
        for doubt in &comparison.doubts {
            eprintln!("careful: {doubt}");
        }
        if let Some(drift) = comparison.drift {
            eprintln!(
                "the machine as a whole: × {:.3} ({:.3} to {:.3}), and nothing that was timed beside a yardstick is judged by it",
                drift.median, drift.low, drift.high
            );
        }
        let mut worse = 0;
        for change in &comparison.changes {
            let verdict = match change.verdict {
                Verdict::Worse => "WORSE",
                Verdict::Better => "better",
                Verdict::Same if self.all => "same",
                Verdict::Same => continue,
            };
            worse += usize::from(change.verdict == Verdict::Worse);
            let ([old, new], ratio) = (change.values, change.ratio);
            outln!(
                "{verdict:6} {} {}: {old:.4e} → {new:.4e}, × {:.3} ({:.3} to {:.3})",
                change.id,
                change.measure,
                ratio.median,
                ratio.low,
                ratio.high
            );
        }
        for gone in &comparison.gone {
            outln!("GONE   {gone}");
        }
        if !comparison.is_good() {
            bail!("{worse} worse, {} gone, of {}", comparison.gone.len(), comparison.changes.len());
        }
        outln!("nothing worse among {} figures", comparison.changes.len());
        Ok(())
    }
}

/// This program again, with the same arguments, to measure times alone.
fn in_a_process_of_its_own() -> Result<Session, StudyError> {
    let failed = |what: String| StudyError::Session(what);
    let program = std::env::current_exe().map_err(|e| failed(e.to_string()))?;
    let output = std::process::Command::new(program)
        .args(std::env::args_os().skip(1))
        .arg("--session")
        .stdin(std::process::Stdio::null())
        .output()
        .map_err(|e| failed(e.to_string()))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(failed(format!("{}: {}", output.status, said.trim())));
    }
    serde_json::from_slice(&output.stdout).map_err(|e| failed(e.to_string()))
}

fn write(path: &Path, text: &str) -> Result<()> {
    write_atomically(path, text.as_bytes()).with_context(|| format!("cannot write {}", path.display()))
}

fn read(path: &Path) -> Result<Run> {
    let file = if path.is_dir() { path.join("bench.json") } else { path.to_owned() };
    let text = std::fs::read_to_string(&file).with_context(|| format!("cannot read {}", file.display()))?;
    let run: Run = serde_json::from_str(&text)
        .with_context(|| format!("{} is no result of `ltc bench`", file.display()))?;
    anyhow::ensure!(
        run.schema == study::SCHEMA,
        "{} has schema {}; this program knows {}",
        file.display(),
        run.schema,
        study::SCHEMA
    );
    Ok(run)
}
