//! Other programs: started, waited for, and never left behind.
//!
//! Each runs in a process group of its own, without standard input. What it starts in turn (cargo starts compilers and
//! tests) is in the same group, so one signal ends all of it, whether Ctrl-C came from a terminal or from `kill`.

use std::io::Read as _;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, anyhow, bail};

use crate::interrupt;
use crate::say::say;

/// How often a wait looks up.
const TICK: Duration = Duration::from_millis(30);
/// How long a program that was asked to end may take before it is ended.
const GRACE: Duration = Duration::from_secs(10);
/// How long what it started may take after it.
const GRACE_FOR_THE_REST: Duration = Duration::from_secs(3);

/// A program that was started, with everything it starts. Dropping it stops it.
pub struct Running {
    child: Child,
    name: String,
    ended: Option<ExitStatus>,
}

impl Running {
    /// Starts `command`; its output goes where the command says (by default to ours).
    pub fn start(command: &mut Command) -> Result<Self> {
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        let name = shown(command);
        // Mesa's device-select layer complains on stderr where no desktop runs, and we choose the device ourselves.
        command.env("NODEVICE_SELECT", "1");
        let child = command.stdin(Stdio::null()).spawn().with_context(|| format!("cannot start `{name}`"))?;
        Ok(Self { child, name, ended: None })
    }

    /// Its exit status once it has ended, without waiting.
    pub fn poll(&mut self) -> Result<Option<ExitStatus>> {
        if self.ended.is_none() {
            self.ended = self.child.try_wait().with_context(|| format!("lost sight of `{}`", self.name))?;
        }
        Ok(self.ended)
    }

    /// Waits until it ends. When an end is asked for meanwhile, stops it and reports that.
    pub fn wait(&mut self) -> Result<ExitStatus> {
        loop {
            if let Some(status) = self.poll()? {
                interrupt::check()?;
                return Ok(status);
            }
            if interrupt::pending() {
                self.stop()?;
                return Err(interrupt::Interrupted.into());
            }
            std::thread::sleep(TICK);
        }
    }

    /// Asks the whole group to end and waits for it; after [`GRACE`], or at a second Ctrl-C, ends it by force,
    /// which is an error.
    pub fn stop(&mut self) -> Result<ExitStatus> {
        if let Some(status) = self.poll()? {
            return Ok(status);
        }
        interrupt::take();
        self.signal(Signal::Ask);
        let asked = Instant::now();
        while asked.elapsed() < GRACE && !interrupt::pending() {
            if let Some(status) = self.poll()? {
                self.end_the_rest();
                return Ok(status);
            }
            std::thread::sleep(TICK);
        }
        self.signal(Signal::End);
        self.ended = Some(self.child.wait().with_context(|| format!("cannot end `{}`", self.name))?);
        bail!("`{}` did not stop when asked and was ended by force", self.name)
    }

    /// After the first of the group has ended: gives the others, who had the same signal, a moment to tidy up.
    fn end_the_rest(&mut self) {
        let start = Instant::now();
        while start.elapsed() < GRACE_FOR_THE_REST && self.group_lives() {
            std::thread::sleep(TICK);
        }
        if self.group_lives() {
            self.signal(Signal::End);
        }
    }

    #[cfg(unix)]
    fn group(&self) -> Option<rustix::process::Pid> {
        i32::try_from(self.child.id()).ok().and_then(rustix::process::Pid::from_raw)
    }

    #[cfg(unix)]
    fn group_lives(&self) -> bool {
        self.group().is_some_and(|group| rustix::process::test_kill_process_group(group).is_ok())
    }

    #[cfg(unix)]
    fn signal(&mut self, signal: Signal) {
        let signal = match signal {
            Signal::Ask => rustix::process::Signal::INT,
            Signal::End => rustix::process::Signal::KILL,
        };
        if let Some(group) = self.group() {
            // That it is gone already is what was wanted.
            let _ = rustix::process::kill_process_group(group, signal);
        }
    }

    /// Other systems have no groups, and no gentle way that the standard library knows.
    #[cfg(not(unix))]
    fn group_lives(&self) -> bool {
        false
    }

    #[cfg(not(unix))]
    fn signal(&mut self, _signal: Signal) {
        let _ = self.child.kill();
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if self.ended.is_none() {
            let _ = self.stop();
        }
    }
}

enum Signal {
    Ask,
    End,
}

/// Runs `command` with its output on ours; anything but success is an error that names the command.
pub fn run(command: &mut Command) -> Result<()> {
    let mut running = Running::start(command)?;
    let status = running.wait()?;
    succeeded(&running.name, status)
}

/// As [`run`], and returns what the command wrote to standard output; its standard error goes to ours.
pub fn output(command: &mut Command) -> Result<String> {
    let mut running = Running::start(command.stdout(Stdio::piped()))?;
    let mut pipe = running.child.stdout.take().context("a piped child has a standard output")?;
    // Read beside the wait: a child whose pipe is full would never end.
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        pipe.read_to_string(&mut text).map(|_| text)
    });
    let status = running.wait()?;
    succeeded(&running.name, status)?;
    let text = reader.join().map_err(|_| anyhow!("the reader of `{}` died", running.name))?;
    text.with_context(|| format!("cannot read what `{}` printed", running.name))
}

/// Runs `command` to its end even when an interrupt comes: stopping a package manager half-way would leave the
/// system half-configured. The interrupt is reported afterwards.
pub fn run_to_the_end(command: &mut Command) -> Result<()> {
    let mut running = Running::start(command)?;
    let mut told = false;
    let status = loop {
        if let Some(status) = running.poll()? {
            break status;
        }
        if interrupt::pending() && !told {
            told = true;
            say(format_args!("stopping as soon as `{}` is through", running.name));
        }
        std::thread::sleep(TICK);
    };
    interrupt::check()?;
    succeeded(&running.name, status)
}

/// Whether `command` starts and succeeds; it prints nothing. For asking whether a tool is there.
pub fn works(command: &mut Command) -> bool {
    let silent = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    silent.status().is_ok_and(|status| status.success())
}

fn succeeded(name: &str, status: ExitStatus) -> Result<()> {
    if status.success() { Ok(()) } else { Err(anyhow!("`{name}` ended with {status}")) }
}

/// The command as one would type it, with its program's name in place of its path.
fn shown(command: &Command) -> String {
    let program = std::path::Path::new(command.get_program());
    let program = program.file_name().unwrap_or(command.get_program()).to_string_lossy();
    let args = command.get_args().map(|arg| arg.to_string_lossy());
    std::iter::once(program).chain(args).collect::<Vec<_>>().join(" ")
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    #[test]
    fn tells_success_from_failure() {
        run(&mut shell("exit 0")).expect("true succeeds");
        let cause = run(&mut shell("exit 3")).expect_err("3 is a failure").to_string();
        assert!(cause.contains("sh -c exit 3") && cause.contains('3'), "{cause}");
        let cause = run(&mut Command::new("/no/such-program")).expect_err("nothing to start").to_string();
        assert!(cause.contains("such-program"), "{cause}");
    }

    #[test]
    fn reads_more_than_a_pipe_holds() {
        let text = output(&mut shell("yes 0123456 | head -n 100000")).expect("it ends");
        assert_eq!(text.len(), 800_000);
        output(&mut shell("echo half; exit 1")).expect_err("half an output is none");
    }

    /// The grandchild would hold the pipe open for a minute: that the pipe closes shows that it is gone.
    #[test]
    fn stopping_ends_grandchildren_too() {
        let mut command = shell("sleep 60 & sleep 60");
        let mut running = Running::start(command.stdout(Stdio::piped())).expect("sh starts");
        let mut pipe = running.child.stdout.take().expect("piped");
        assert!(running.poll().expect("alive").is_none());
        let start = Instant::now();
        let status = running.stop().expect("sleep heeds the first signal");
        assert!(!status.success());
        pipe.read_to_end(&mut Vec::new()).expect("closed");
        assert!(start.elapsed() < Duration::from_secs(9), "took {:?}", start.elapsed());
    }

    #[test]
    fn dropping_ends_it() {
        let mut running = Running::start(shell("sleep 60").stdout(Stdio::piped())).expect("sh starts");
        let mut pipe = running.child.stdout.take().expect("piped");
        drop(running);
        let start = Instant::now();
        pipe.read_to_end(&mut Vec::new()).expect("closed");
        assert!(start.elapsed() < Duration::from_secs(9), "took {:?}", start.elapsed());
    }
}
