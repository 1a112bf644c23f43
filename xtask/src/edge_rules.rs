//! The table of which crates may not depend on which, and why.
//!
//! A rule is about what a crate compiles for whoever uses it: normal and build dependencies, direct or not, with all
//! features, on any of the platforms that [`crate::edges`] names. What its tests alone need is exempt, and listed.

use crate::graph::Graph;

/// One rule.
#[derive(Debug, Clone, Copy)]
pub enum Rule {
    /// `from` reaches none of `targets`; `ltc-*` stands for every other crate of the workspace.
    Never { from: &'static str, targets: &'static [&'static str] },
    /// `from` reaches nothing but `allowed`.
    Only { from: &'static str, allowed: &'static [&'static str] },
    /// Of the workspace's crates, `from` names none but `allowed` in its manifest.
    OursOnly { from: &'static str, allowed: &'static [&'static str] },
    /// No crate of the workspace but `by` reaches `target`.
    OnlyBy { target: &'static str, by: &'static [&'static str] },
}

/// The crates that may see the whole workspace.
const TOPS: &[&str] = &["ltc-cli", "ltc-tests", "ltc-benches", "xtask"];

/// The rules of this workspace.
pub const RULES: &[Rule] = &[
    // The mathematics is for everybody: whoever takes it takes nothing else.
    Rule::Only { from: "ltc-core", allowed: &["glam", "libm", "fearless_simd"] },
    // An oracle shares no code with what it judges.
    Rule::Never { from: "ltc-reference", targets: &["ltc-*", "wgpu", "axum", "tokio"] },
    // Whoever wants only lookups compiles no GPU stack, no web server and no thread pool.
    Rule::Never { from: "ltc-table", targets: &["wgpu", "axum", "tokio", "rayon"] },
    Rule::OursOnly { from: "ltc-table", allowed: &["ltc-core"] },
    // The shipped tables are data and its reader.
    Rule::OursOnly { from: "ltc-tables", allowed: &["ltc-table"] },
    Rule::Never { from: "ltc-tables", targets: &["wgpu", "axum", "tokio", "rayon"] },
    // The service reads what benches wrote without compiling them.
    Rule::OursOnly { from: "ltc-records", allowed: &[] },
    Rule::Never { from: "ltc-service", targets: &["ltc-benches"] },
    // Lines are understood without a GPU, so that fuzzers build fast.
    Rule::OursOnly { from: "ltc-lines", allowed: &["ltc-core", "ltc-table"] },
    // Fitting runs on machines without a GPU, and in workers without a server.
    Rule::Never { from: "ltc-fit", targets: &["wgpu", "axum", "tokio"] },
    // Shading takes tables as they are, wherever they come from.
    Rule::Never {
        from: "ltc-shade-gpu",
        targets: &["axum", "tokio", "ltc-fit", "ltc-reference", "ltc-service"],
    },
    Rule::Never { from: "ltc-render", targets: &["axum", "tokio", "ltc-fit", "ltc-service"] },
    // What is kept is kept without a server and without a fit; fits run in workers without a server.
    Rule::OursOnly { from: "ltc-store", allowed: &["ltc-core", "ltc-table"] },
    Rule::Never { from: "ltc-store", targets: &["wgpu", "axum", "ltc-fit"] },
    Rule::Never { from: "ltc-refit", targets: &["wgpu", "axum"] },
    // The service runs where there is no GPU.
    Rule::Never { from: "ltc-service", targets: &["wgpu", "ltc-shade-gpu", "ltc-render"] },
    // The ends of the graph stay ends.
    Rule::OnlyBy { target: "ltc-service", by: TOPS },
    // Whoever only fetches tables compiles no server and no fitter.
    Rule::OursOnly { from: "ltc-client", allowed: &["ltc-table"] },
    Rule::Never { from: "ltc-client", targets: &["wgpu", "axum", "tokio", "rayon"] },
    Rule::OnlyBy { target: "ltc-cli", by: TOPS },
    // Every command of the README compiles this crate first.
    Rule::Never { from: "xtask", targets: &["wgpu", "axum", "tokio"] },
];

/// What a check found.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// Broken rules, each with the chain that breaks it; and rules that watch nothing.
    pub broken: Vec<String>,
    /// What would break a rule if it were not for tests alone.
    pub exempt: Vec<String>,
}

impl Rule {
    /// Holds `graph` against this rule.
    pub fn check(&self, graph: &Graph, findings: &mut Findings) {
        if let Some(name) = self.names().into_iter().find(|name| !known(graph, name)) {
            findings
                .broken
                .push(format!("a rule names {name}, which nothing here uses: mend the table of rules"));
            return;
        }
        for from in self.subjects(graph) {
            for chain in graph.reach(from).iter().filter(|chain| self.forbids(graph, chain)) {
                let (end, chain) = (chain[chain.len() - 1], chain.join(" → "));
                findings.broken.push(format!("{from} must not depend on {end}: {chain}"));
            }
            for chain in graph.dev_reach(from).iter().filter(|chain| self.forbids(graph, chain)) {
                let note = format!("the tests of {from} alone use {}", chain[1]);
                if !findings.exempt.contains(&note) {
                    findings.exempt.push(note);
                }
            }
        }
    }

    /// The crates whose dependencies the rule is about.
    fn subjects<'a>(&self, graph: &'a Graph) -> Vec<&'a str> {
        let is_subject = |member: &&str| match *self {
            Self::Never { from, .. } | Self::Only { from, .. } | Self::OursOnly { from, .. } => {
                *member == from
            }
            Self::OnlyBy { target, by } => *member != target && !by.contains(member),
        };
        graph.members().filter(is_subject).collect()
    }

    /// Whether the end of `chain`, which has at least two links, may not be reached from its beginning in this way.
    fn forbids(&self, graph: &Graph, chain: &[&str]) -> bool {
        let end = chain[chain.len() - 1];
        match *self {
            Self::Never { from, targets } => targets.iter().any(|target| match *target {
                "ltc-*" => end.starts_with("ltc-") && end != from,
                target => end == target,
            }),
            Self::Only { allowed, .. } => !allowed.contains(&end),
            Self::OursOnly { allowed, .. } => {
                chain.len() == 2 && graph.is_member(end) && !allowed.contains(&end)
            }
            Self::OnlyBy { target, .. } => end == target,
        }
    }

    /// The crates that have to exist for the rule to mean anything.
    fn names(&self) -> Vec<&'static str> {
        match *self {
            Self::Never { from, targets } => [&[from], targets].concat(),
            Self::Only { from, .. } => vec![from],
            Self::OursOnly { from, allowed } => [&[from], allowed].concat(),
            Self::OnlyBy { target, .. } => vec![target],
        }
    }
}

fn known(graph: &Graph, name: &str) -> bool {
    name == "ltc-*" || if name.starts_with("ltc-") { graph.is_member(name) } else { graph.has(name) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::tests::metadata;

    fn check(rules: &[Rule], edges: &[(&str, &str, Option<&str>)]) -> Findings {
        let graph = Graph::from_metadata(&metadata(edges)).expect("well formed");
        let mut findings = Findings::default();
        rules.iter().for_each(|rule| rule.check(&graph, &mut findings));
        findings
    }

    /// A small workspace that keeps every rule below; each test plants one edge more.
    const GOOD: &[(&str, &str, Option<&str>)] = &[
        ("ltc-core", "glam", None),
        ("ltc-table", "ltc-core", None),
        ("ltc-reference", "glam", None),
        ("ltc-service", "ltc-table", None),
        ("ltc-service", "axum", None),
        ("ltc-gpu", "wgpu", None),
        ("ltc-cli", "ltc-service", None),
    ];
    const SMALL: &[Rule] = &[
        Rule::Only { from: "ltc-core", allowed: &["glam"] },
        Rule::Never { from: "ltc-table", targets: &["wgpu", "axum"] },
        Rule::Never { from: "ltc-reference", targets: &["ltc-*"] },
        Rule::OursOnly { from: "ltc-table", allowed: &["ltc-core"] },
        Rule::OnlyBy { target: "ltc-service", by: &["ltc-cli"] },
    ];

    fn with(edges: &[(&'static str, &'static str, Option<&'static str>)]) -> Findings {
        check(SMALL, &[GOOD, edges].concat())
    }

    #[test]
    fn a_good_workspace_passes() {
        assert_eq!(with(&[]), Findings::default());
    }

    #[test]
    fn a_planted_edge_is_caught() {
        for (edges, said) in [
            (&[("ltc-core", "serde", None)][..], "ltc-core must not depend on serde: ltc-core → serde"),
            (&[("ltc-table", "wgpu", None)], "ltc-table must not depend on wgpu: ltc-table → wgpu"),
            (
                &[("ltc-table", "x", None), ("x", "axum", Some("build"))],
                "ltc-table must not depend on axum: ltc-table → x → axum",
            ),
            (
                &[("ltc-reference", "ltc-core", None)],
                "ltc-reference must not depend on ltc-core: ltc-reference → ltc-core",
            ),
            (
                &[("ltc-table", "ltc-gpu2", None)],
                "ltc-table must not depend on ltc-gpu2: ltc-table → ltc-gpu2",
            ),
            (
                &[("ltc-gpu", "ltc-service", None)],
                "ltc-gpu must not depend on ltc-service: ltc-gpu → ltc-service",
            ),
        ] {
            assert!(with(edges).broken.contains(&said.to_owned()), "{said}: {:?}", with(edges));
        }
    }

    #[test]
    fn what_only_tests_use_is_exempt_and_listed() {
        let findings = with(&[("ltc-table", "x", Some("dev")), ("x", "wgpu", None)]);
        assert_eq!(findings.broken, [""; 0]);
        assert_eq!(findings.exempt, ["the tests of ltc-table alone use x"]);
    }

    #[test]
    fn a_rule_that_watches_nothing_is_reported() {
        let rule = Rule::Never { from: "ltc-table", targets: &["wpgu"] };
        assert!(check(&[rule], GOOD).broken[0].contains("wpgu"));
        let rule = Rule::OnlyBy { target: "ltc-servce", by: TOPS };
        assert!(check(&[rule], GOOD).broken[0].contains("ltc-servce"));
    }
}
