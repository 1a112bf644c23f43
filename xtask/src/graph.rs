//! Which package needs which, read from `cargo metadata`.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use anyhow::{Context as _, Result};
use serde_json::Value;

/// What a package needs, by package id.
#[derive(Debug, Default)]
struct Package {
    name: String,
    /// To be built and run; build scripts' needs count, for whoever uses the package compiles them too.
    needs: Vec<String>,
    /// For its own tests, examples and benches alone.
    dev_needs: Vec<String>,
}

/// The packages of a workspace and all that they need, on every platform.
#[derive(Debug)]
pub struct Graph {
    packages: BTreeMap<String, Package>,
    members: BTreeMap<String, String>,
}

/// A chain of package names, each of which needs the next.
pub type Path<'a> = Vec<&'a str>;

impl Graph {
    /// Reads what `cargo metadata --format-version 1` printed.
    pub fn from_metadata(metadata: &Value) -> Result<Self> {
        let mut packages = BTreeMap::new();
        for package in list(metadata, "packages")? {
            let name = text(package, "name")?.to_owned();
            packages.insert(text(package, "id")?.to_owned(), Package { name, ..Package::default() });
        }
        for node in list(&metadata["resolve"], "nodes")? {
            let package = packages.get_mut(text(node, "id")?).context("a node is no package")?;
            for need in list(node, "deps")? {
                let (id, kinds) = (text(need, "pkg")?, list(need, "dep_kinds")?);
                if kinds.iter().any(|kind| kind["kind"] != "dev") {
                    package.needs.push(id.to_owned());
                }
                if kinds.iter().any(|kind| kind["kind"] == "dev") {
                    package.dev_needs.push(id.to_owned());
                }
            }
        }
        let mut members = BTreeMap::new();
        for id in list(metadata, "workspace_members")? {
            let id = id.as_str().context("a workspace member is no text")?;
            members.insert(packages.get(id).context("a member is no package")?.name.clone(), id.to_owned());
        }
        Ok(Self { packages, members })
    }

    /// The names of the workspace's own packages.
    pub fn members(&self) -> impl Iterator<Item = &str> {
        self.members.keys().map(String::as_str)
    }

    /// Whether the workspace has a package `name` of its own.
    pub fn is_member(&self, name: &str) -> bool {
        self.members.contains_key(name)
    }

    /// Whether anything at all needs a package `name`, or the workspace has it.
    pub fn has(&self, name: &str) -> bool {
        self.packages.values().any(|package| package.name == name)
    }

    /// A shortest chain from the member `from` to each package that it needs, directly or not.
    pub fn reach(&self, from: &str) -> Vec<Path<'_>> {
        self.members.get(from).map_or_else(Vec::new, |id| self.search(id, |package| &package.needs))
    }

    /// As [`Graph::reach`], for what `from` needs for its tests alone.
    pub fn dev_reach(&self, from: &str) -> Vec<Path<'_>> {
        self.members.get(from).map_or_else(Vec::new, |id| self.search(id, |package| &package.dev_needs))
    }

    /// The chains from `start`, breadth first; `first` chooses the edges of the start, all others are `needs`.
    fn search(&self, start: &str, first: impl Fn(&Package) -> &Vec<String>) -> Vec<Path<'_>> {
        let Some(package) = self.packages.get(start) else { return Vec::new() };
        let mut seen = BTreeSet::from([start]);
        let mut queue: VecDeque<_> =
            first(package).iter().map(|id| (id, vec![package.name.as_str()])).collect();
        let mut chains = Vec::new();
        while let Some((id, mut chain)) = queue.pop_front() {
            if !seen.insert(id) {
                continue;
            }
            let Some(package) = self.packages.get(id) else { continue };
            chain.push(&package.name);
            queue.extend(package.needs.iter().map(|need| (need, chain.clone())));
            chains.push(chain);
        }
        chains
    }
}

fn list<'a>(value: &'a Value, key: &str) -> Result<&'a Vec<Value>> {
    value[key].as_array().with_context(|| format!("cargo's metadata has no list '{key}'"))
}

fn text<'a>(value: &'a Value, key: &str) -> Result<&'a str> {
    value[key].as_str().with_context(|| format!("cargo's metadata has no text '{key}'"))
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use serde_json::json;

    /// Metadata in cargo's form for edges `(from, to, kind)`; those whose name starts with `ltc-` are members.
    pub fn metadata(edges: &[(&str, &str, Option<&str>)]) -> Value {
        let names: BTreeSet<_> = edges.iter().flat_map(|&(from, to, _)| [from, to]).collect();
        let id = |name: &str| format!("path+file:///w/{name}#0.1.0");
        let node = |name: &str| {
            let deps: Vec<_> = edges
                .iter()
                .filter(|edge| edge.0 == name)
                .map(|&(_, to, kind)| json!({"pkg": id(to), "dep_kinds": [{"kind": kind, "target": null}]}))
                .collect();
            json!({"id": id(name), "deps": deps})
        };
        json!({
            "packages": names.iter().map(|name| json!({"name": name, "id": id(name)})).collect::<Vec<_>>(),
            "workspace_members": names.iter().filter(|n| n.starts_with("ltc-")).map(|n| id(n)).collect::<Vec<_>>(),
            "resolve": {"nodes": names.iter().map(|name| node(name)).collect::<Vec<_>>()},
        })
    }

    #[test]
    fn follows_needs_but_not_the_tests_of_others() {
        let edges = [
            ("ltc-a", "b", None),
            ("b", "c", Some("build")),
            ("c", "b", None),
            ("b", "unseen", Some("dev")),
            ("ltc-a", "d", Some("dev")),
            ("d", "e", None),
        ];
        let graph = Graph::from_metadata(&metadata(&edges)).expect("well formed");
        assert_eq!(graph.reach("ltc-a"), [vec!["ltc-a", "b"], vec!["ltc-a", "b", "c"]]);
        assert_eq!(graph.dev_reach("ltc-a"), [vec!["ltc-a", "d"], vec!["ltc-a", "d", "e"]]);
        assert_eq!(graph.members().collect::<Vec<_>>(), ["ltc-a"]);
        assert!(graph.has("unseen") && !graph.has("f") && graph.reach("f").is_empty());
    }

    #[test]
    fn what_is_no_metadata_is_an_error() {
        Graph::from_metadata(&json!({})).expect_err("no packages");
        Graph::from_metadata(&json!({"packages": [], "workspace_members": ["x"], "resolve": {"nodes": []}}))
            .expect_err("a member without a package");
    }
}
