//! `cargo xtask demo`: the main job, from the shipped tables to a picture, on this machine.

use std::fs;
use std::net::SocketAddr;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result};
use serde_json::Value;

use crate::say::say;
use crate::service::Service;
use crate::step::Steps;
use crate::table_copy::TableCopy;
use crate::workspace::{Profile, Workspace};
use crate::{http, listen, process, setup};

/// The table that is fetched, looked up and rendered with.
const TABLE: &str = "ggx-anisotropic";
const SCENE: &str = "examples/scenes/anisotropic-spheres.json";
const LOOKUP: &str =
    "/v1/tables/ggx-anisotropic/versions/latest/lookup?theta=0.7&phi=0.3&alpha_x=0.4&alpha_y=0.1";

/// Runs the whole thread with the service on `listen`; afterwards the service stays up until Ctrl-C, or with `once`
/// is stopped.
pub fn run(workspace: &Workspace, listen: &str, once: bool) -> Result<()> {
    let address = listen::free_address(listen)?;
    let scene = workspace.file(SCENE)?;
    let folder = workspace.target().join("demo");
    let mut steps = Steps::new(6, false);

    steps.step("look for a GPU driver, hardware or software", setup::graphics)?;
    let ltc = steps.step("build ltc, optimised (minutes the first time, seconds later)", || {
        workspace.build_ltc(Profile::Release)
    })?;
    let mut service = steps.step(format_args!("start `ltc serve` on {address}"), || {
        Service::start(&ltc, workspace.root(), address)
    })?;
    let server = service.address();
    let tables = folder.join("tables");
    steps.step(format_args!("fetch {TABLE} over HTTP and check its digest"), || fetch(server, &tables))?;
    steps.step("look up one material and direction over HTTP", || look_up(server))?;
    service.check()?;
    steps.step(format_args!("render {SCENE} with the fetched table"), || {
        render(&ltc, workspace.root(), &scene, &tables, &folder.join("render.png"))
    })?;

    service.check()?;
    let listing = listing(&http::get_json(server, "/v1/tables")?)?;
    say(format_args!("the whole thread ran in {}; tables served:", steps.elapsed()));
    say(listing);
    if once {
        service.stop()?;
        say(format_args!("the service on http://{server} has been stopped (--once)"));
        say(steps.tally(false));
        return Ok(());
    }
    say(format_args!(
        "the service is up on http://{server} (try http://{server}/v1/tables); Ctrl-C stops it"
    ));
    service.stay()?;
    say("stopped");
    Ok(())
}

fn fetch(server: SocketAddr, tables: &Path) -> Result<()> {
    // An older version left there by an earlier demo could be newer by number than the one served now.
    if tables.exists() {
        fs::remove_dir_all(tables).with_context(|| format!("cannot empty {}", tables.display()))?;
    }
    let copy = TableCopy::fetch(server, TABLE, tables)?;
    say(format_args!("    {} bytes, {}, in {}", copy.len, copy.digest, copy.folder.display()));
    Ok(())
}

fn look_up(server: SocketAddr) -> Result<()> {
    let answer = http::get_json(server, LOOKUP)?;
    let lobes = answer["lobes"].as_array().filter(|lobes| !lobes.is_empty());
    lobes.context("the lookup returned no lobes")?;
    say(format_args!("    {LOOKUP}\n    {answer}"));
    Ok(())
}

fn render(ltc: &Path, root: &Path, scene: &Path, tables: &Path, picture: &Path) -> Result<()> {
    let mut command = Command::new(ltc);
    command.current_dir(root).arg("render").arg(scene).arg("--tables").arg(tables).arg("-o").arg(picture);
    process::run(&mut command)?;
    let len = fs::metadata(picture).with_context(|| format!("there is no {}", picture.display()))?.len();
    say(format_args!("    {} ({len} bytes)", picture.display()));
    Ok(())
}

/// `GET /v1/tables` as lines for a person.
fn listing(tables: &Value) -> Result<String> {
    let tables = tables["tables"].as_array().context("GET /v1/tables answered no list of tables")?;
    let line = |table: &Value| {
        let name = table["name"].as_str().context("a table without a name is listed")?;
        let versions = match &table["versions"] {
            Value::Array(versions) => versions.len(),
            _ => 1,
        };
        let plural = if versions == 1 { "" } else { "s" };
        Ok(format!("    {name:<24} latest version {}, {versions} version{plural}", table["latest"]))
    };
    let lines = tables.iter().map(line).collect::<Result<Vec<_>>>()?;
    anyhow::ensure!(!lines.is_empty(), "the service has no tables");
    Ok(lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn lists_what_is_served() {
        let served = json!({"tables": [{"name": "a", "latest": 2, "versions": [1, 2]},
                                       {"name": "b", "latest": 1, "versions": [1]}]});
        let text = listing(&served).expect("two tables");
        let lines: Vec<_> = text.lines().map(str::trim).collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[0].starts_with("a ") && lines[0].ends_with("latest version 2, 2 versions"), "{text}");
        assert!(lines[1].ends_with("latest version 1, 1 version"), "{text}");
    }

    #[test]
    fn a_service_without_tables_is_an_error() {
        for nothing in [json!({"tables": []}), json!({}), json!({"tables": [{"latest": 1}]})] {
            listing(&nothing).expect_err("nothing to list");
        }
    }
}
