//! `ltc fit`

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use anyhow::{Context, Result, bail};
use clap::Args;
use ltc_fit::checkpoint::{self, Checkpoints, Folder, Store};
use ltc_fit::{Cost, FitError, FitReport, FitSpec, Fitted, Limits, Plan, Progress, spec_file};
use ltc_table::{Added, TableVersion, add_version, files::write_atomically};

use crate::fit_progress::FitProgress;
use crate::interrupt::Watch;
use crate::picture;

/// How often a running fit is kept.
const KEEP_EVERY: Duration = Duration::from_secs(2);

/// Fits a table and writes it as a new version. The same specification gives the same digest, whatever the number of
/// threads and however often the fit was interrupted.
///
/// Nothing is written among the tables before the fit is complete. What is done so far is kept in DIR/.checkpoints every
/// few seconds; after Ctrl-C or a kill the same command goes on from there.
///
/// Example: ltc fit ggx-isotropic -o my-tables
///
/// Example: ltc fit --print-spec ggx-isotropic > mine.toml && ltc fit mine.toml -o my-tables --report my-report
#[derive(Args)]
#[command(verbatim_doc_comment)]
pub struct Fit {
    /// What to fit: the name of a preset, or a TOML file.
    #[arg(value_name = "PRESET|SPEC.toml")]
    what: String,
    /// Folder of tables; the version goes to DIR/NAME/NUMBER.
    #[arg(short, long, value_name = "DIR", required_unless_present = "print_spec")]
    output: Option<PathBuf>,
    /// Prints the whole specification, with comments, and fits nothing.
    #[arg(long)]
    print_spec: bool,
    /// Threads to use; all cores by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Also writes NAME-NUMBER.json (every entry, regions of the draw against the best there is, times) and NAME-NUMBER.png
    /// (a map of the errors) to this folder.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Starts from the beginning even where a checkpoint is found.
    #[arg(long)]
    fresh: bool,
    /// Fits even where more than 4 GiB of memory or a day of one core are expected.
    #[arg(long)]
    no_limits: bool,
    /// Prints the manifest as JSON, and progress as JSON lines on stderr.
    #[arg(long)]
    json: bool,
}

impl Fit {
    pub fn run(self) -> Result<()> {
        let spec = read_spec(&self.what)?;
        if self.print_spec {
            return self.print(&spec);
        }
        let cost = Cost::of(&spec);
        if !self.no_limits {
            cost.check(&Limits::default()).context("too large (--no-limits fits it nevertheless)")?;
        }
        let Some(output) = self.output.as_deref() else { bail!("no folder for the table") };
        for folder in [Some(output), self.report.as_deref()].into_iter().flatten() {
            check_writable(folder)?;
        }
        let plan = Plan::new(spec)?;
        let store = Folder::new(output, &plan);
        if self.fresh {
            store.clear()?;
        }
        let work = Work {
            plan: &plan,
            store: &store,
            watch: Watch::new()?,
            progress: FitProgress::new(&cost, self.json),
        };
        let start = Instant::now();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.map_or(0, usize::from))
            .build()
            .context("cannot start threads")?;
        let fitted = pool.install(|| work.fit())?;
        let report = self.report.is_some().then(|| pool.install(|| work.report(&fitted))).transpose()?;
        work.progress.finish();
        let version = self.publish(&work, output, &fitted)?;
        if let (Some(folder), Some(report)) = (&self.report, &report) {
            write_report(folder, &version, report, &work.progress)?;
        }
        store.clear()?;
        self.tell(&version, report.as_ref(), start.elapsed())
    }

    fn print(&self, spec: &FitSpec) -> Result<()> {
        if self.json {
            outln!("{}", serde_json::to_string_pretty(spec)?);
        } else {
            out!("{}", spec_file::to_toml(spec)?);
        }
        Ok(())
    }

    /// Puts the table in its place.
    fn publish(&self, work: &Work<'_>, output: &Path, fitted: &Fitted) -> Result<TableVersion> {
        let created = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
        let version = ltc_fit::publish(work.plan.spec(), &fitted.table, fitted.errors.clone(), 1, created)?;
        let name = &version.manifest().name;
        match add_version(output, &version)? {
            Added::New { number, folder } => {
                work.progress.say(&format!("{name}: version {number} written to {}", folder.display()));
                Ok(version.numbered(number))
            }
            Added::Known { number } => {
                work.progress.say(&format!("{name}: version {number} is this very table; nothing to write"));
                Ok(TableVersion::read_folder(&output.join(name).join(number.to_string()))?)
            }
        }
    }

    /// The result on stdout.
    fn tell(&self, version: &TableVersion, report: Option<&FitReport>, elapsed: Duration) -> Result<()> {
        if self.json {
            out!("{}", version.manifest_json()?);
            return Ok(());
        }
        let manifest = version.manifest();
        let (seconds, tv) = (elapsed.as_secs_f64(), manifest.errors.standard_draw.tv_mean);
        outln!("{}: mean TV {tv:.4} on unseen queries, {seconds:.1} s, {}", manifest.name, manifest.digest);
        for stage in report.map_or(&[][..], |report| &report.stages) {
            let rate = stage.lobe_samples_per_second / 1e6;
            outln!("  {:<22} {:>7.2} s, {rate:.0} million lobe samples a second", stage.stage, stage.seconds);
        }
        if let Some(report) = report {
            let draw = &report.draw;
            outln!("  the best single LTC at each query: mean TV {:.4}", draw.optimum_tv_mean);
        }
        Ok(())
    }
}

/// A fit under way, and who hears of it.
struct Work<'a> {
    plan: &'a Plan<'a>,
    store: &'a Folder,
    watch: Watch,
    progress: FitProgress,
}

impl Work<'_> {
    fn fit(&self) -> Result<Fitted> {
        let program = program();
        let checkpoints = Checkpoints { store: self.store, program: &program, every: KEEP_EVERY };
        let notice = |notice: checkpoint::Notice| self.progress.say(&notice.to_string());
        checkpoint::fit(self.plan, &checkpoints, &|p| self.observe(&p), &notice).map_err(|e| self.explain(e))
    }

    fn report(&self, fitted: &Fitted) -> Result<FitReport> {
        FitReport::new(self.plan, fitted, &|p| self.observe(&p)).map_err(|e| self.explain(e))
    }

    fn observe(&self, progress: &Progress) -> bool {
        self.progress.report(progress);
        !self.watch.asked()
    }

    fn explain(&self, error: FitError) -> anyhow::Error {
        self.progress.finish();
        match error {
            FitError::Stopped => {
                let place = self.store.path().display();
                let what_now =
                    format!("the same command goes on from here (what is done is kept in {place})");
                self.watch.interrupted(what_now).into()
            }
            other => other.into(),
        }
    }
}

/// A preset by its name, or a file.
fn read_spec(what: &str) -> Result<FitSpec> {
    let path = Path::new(what);
    if FitSpec::PRESETS.contains(&what) || !(path.extension().is_some_and(|e| e == "toml") || path.exists()) {
        return Ok(FitSpec::preset(what)?);
    }
    let text = std::fs::read_to_string(path).with_context(|| what.to_owned())?;
    spec_file::from_toml(&text).with_context(|| what.to_owned())
}

/// Whether files can be made in a folder is known before the work is done, not after.
fn check_writable(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let probe = folder.join(format!(".probe-{}", std::process::id()));
    write_atomically(&probe, b"")?;
    std::fs::remove_file(&probe).with_context(|| probe.display().to_string())
}

/// What names this build of the program: another may fit otherwise, and goes on from no checkpoint of this one.
fn program() -> String {
    let metadata = std::env::current_exe().and_then(std::fs::metadata);
    let build = metadata.map_or_else(
        |_| String::new(),
        |m| {
            let since = |t: SystemTime| t.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_nanos());
            format!(", {} bytes, {}", m.len(), m.modified().map_or(0, since))
        },
    );
    format!("ltc {}{build}", env!("CARGO_PKG_VERSION"))
}

fn write_report(
    folder: &Path,
    version: &TableVersion,
    report: &FitReport,
    progress: &FitProgress,
) -> Result<()> {
    let manifest = version.manifest();
    let stem = format!("{}-{}", manifest.name, manifest.version);
    let (json, png) = (folder.join(format!("{stem}.json")), folder.join(format!("{stem}.png")));
    let title = format!("{} version {}", manifest.name, manifest.version);
    let map = picture::error_map(&title, version.table(), &report.centre_tv);
    write_atomically(&json, (serde_json::to_string(report)? + "\n").as_bytes())?;
    write_atomically(&png, &map.png()?)?;
    progress.say(&format!("report: {} and {}", json.display(), png.display()));
    Ok(())
}
