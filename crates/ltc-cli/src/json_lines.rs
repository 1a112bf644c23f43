//! JSON lines in, JSON lines out: a bad line gives `{"error": …}` in its place and the run goes on.

use std::io::{BufRead, BufWriter, Write};

use anyhow::{Context, Result};
use serde::Serialize;

/// Reads stdin line by line, passing over empty lines, and writes `answer`'s result for each.
///
/// Answers are flushed whenever no further line is at hand, so that a program may wait for each.
pub fn run<T: Serialize>(mut answer: impl FnMut(&str) -> Result<T, String>) -> Result<()> {
    let mut input = std::io::BufReader::new(std::io::stdin());
    let mut output = BufWriter::new(std::io::stdout().lock());
    let mut bytes = Vec::new();
    loop {
        if !input.buffer().contains(&b'\n') {
            output.flush()?;
        }
        bytes.clear();
        if input.read_until(b'\n', &mut bytes).context("cannot read stdin")? == 0 {
            output.flush()?;
            return Ok(());
        }
        // Bytes that are no UTF-8 become replacement characters, which no JSON number or name has.
        let line = String::from_utf8_lossy(&bytes);
        if !line.trim().is_empty() {
            let json = match answer(&line) {
                Ok(value) => serde_json::to_value(value)?,
                Err(error) => serde_json::json!({ "error": error }),
            };
            writeln!(output, "{json}")?;
        }
    }
}
