//! The page of benchmark history. It loads nothing from anywhere, and has no more charts than can be looked at.

use std::fmt::Write;

use ltc_records::{Interval, Verdict};

use super::chart::{COLOURS, change, cut, day, svg, unit, value};
use super::tracks::{History, Measure, Track};
use crate::routes::history::MOST_RUNS;
use crate::routes::index::escaped;

const PAGE: &str = include_str!("page.html");
/// Charts on one page.
const CHARTS: usize = 24;
/// Lines in the list of what became worse.
const LISTED: usize = 40;
/// Characters of a name that are shown.
const SHOWN: usize = 120;

/// What of the history to show.
#[derive(Clone, Debug, Default)]
pub(crate) struct Choice {
    /// Of this series alone.
    pub name: String,
    /// Of this track alone.
    pub machine: String,
    /// What the measure's name must contain.
    pub measure: String,
    /// Only what became worse at some run.
    pub worse: bool,
    /// Runs at or after this time.
    pub since: String,
    /// Runs at most.
    pub limit: u32,
    /// Page of charts, from 1.
    pub page: usize,
}

impl Choice {
    fn wants(&self, measure: &Measure) -> bool {
        let name = format!("{} {}", measure.id, measure.kind).to_lowercase();
        name.contains(&self.measure.to_lowercase()) && (!self.worse || measure.ever_worse())
    }

    /// The same choice as a query, for a link.
    fn query(&self, page: usize) -> String {
        let mut words = vec![format!("limit={}", self.limit), format!("page={page}")];
        for (name, value) in [
            ("name", &self.name),
            ("machine", &self.machine),
            ("measure", &self.measure),
            ("since", &self.since),
        ] {
            if !value.is_empty() {
                words.push(format!("{name}={}", percent_encoded(value)));
            }
        }
        words.extend(self.worse.then(|| "worse=true".to_owned()));
        words.join("&")
    }
}

/// The page.
pub(crate) fn page(mut history: History, choice: &Choice) -> String {
    let known: Vec<(String, String)> =
        history.tracks.iter().map(|track| (track.key.clone(), track.label.clone())).collect();
    if !choice.machine.is_empty() {
        for measure in &mut history.measures {
            measure.lines.retain(|line| history.tracks[line.track].key == choice.machine);
        }
    }
    let mut chosen: Vec<&Measure> =
        history.measures.iter().filter(|m| !m.lines.is_empty() && choice.wants(m)).collect();
    // What needs somebody's attention comes first; the others stay in the order of their names.
    chosen.sort_by_key(|measure| !measure.is_worse(&history.tracks));
    let pages = chosen.len().div_ceil(CHARTS).max(1);
    let at = choice.page.clamp(1, pages);
    let mut charts = String::new();
    for (place, measure) in chosen.iter().enumerate().skip((at - 1) * CHARTS).take(CHARTS) {
        write_figure(&mut charts, &history, measure, place);
    }
    if charts.is_empty() {
        charts.push_str("<p>There is no run that fits.</p>");
    }
    filled(|name| match name {
        "version" => env!("CARGO_PKG_VERSION").to_owned(),
        "form" => form(choice, &known),
        "summary" => summary(&history, choice, chosen.len()),
        "tracks" => tracks(&history, choice),
        "worse" => worse(&history, &chosen, choice, at),
        "pages" => links(choice, at, pages),
        _ => charts.clone(),
    })
}

/// The page with its gaps filled. Gaps are looked for in the page alone, never in what fills them: that was posted by somebody.
fn filled(fill: impl Fn(&str) -> String) -> String {
    let mut parts = PAGE.split("{{");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("}}").unwrap_or((part, ""));
        out.push_str(&fill(name));
        out.push_str(rest);
    }
    out
}

fn form(choice: &Choice, known: &[(String, String)]) -> String {
    let mut machines = "<option value=\"\">all</option>".to_owned();
    for (key, label) in known {
        let selected = if *key == choice.machine { " selected" } else { "" };
        let label = escaped(&cut(label, SHOWN));
        // Writing to a string cannot fail, here and below.
        let _ = write!(machines, "<option value=\"{key}\"{selected}>{label}</option>");
    }
    let field = |name: &str, label: &str, value: &str, hint: &str| {
        format!(
            "<label>{label} <input name=\"{name}\" value=\"{}\" placeholder=\"{hint}\" maxlength=\"128\"></label>\n",
            escaped(value)
        )
    };
    let checked = if choice.worse { " checked" } else { "" };
    format!(
        "{}{}{}<label>machine <select name=\"machine\">{machines}</select></label>\n\
         <label>runs <input name=\"limit\" type=\"number\" min=\"1\" max=\"{}\" value=\"{}\"></label>\n\
         <label><input name=\"worse\" type=\"checkbox\" value=\"true\"{checked}> only what became worse</label>\n",
        field("measure", "measure", &choice.measure, "integral/quad"),
        field("name", "series", &choice.name, "all"),
        field("since", "since", &choice.since, "2026-01-31T00:00:00Z"),
        MOST_RUNS,
        choice.limit,
    )
}

fn summary(history: &History, choice: &Choice, measures: usize) -> String {
    let runs = history.runs.len();
    let mut text = format!("{runs} runs, {measures} measures.");
    if runs as u32 == choice.limit {
        let _ = write!(text, " There may be older runs: ask for more, or with <code>since</code>.");
    }
    if history.strangers > 0 {
        let _ = write!(
            text,
            " {} more are no results of <code>ltc bench</code> and only in <a href=\"v1/benchmarks\">the list</a>.",
            history.strangers
        );
    }
    text
}

/// A row for each track: what its newest run says.
fn tracks(history: &History, choice: &Choice) -> String {
    let mut rows = String::new();
    let shown = |track: &&Track| choice.machine.is_empty() || track.key == choice.machine;
    for (place, track) in history.tracks.iter().enumerate().filter(|(_, track)| shown(track)) {
        let Some(newest) = track.runs.last().map(|run| &history.runs[*run]) else { continue };
        let commit = newest.run.commit.as_deref().unwrap_or("");
        let counts = track.newest.as_ref().map(|comparison| {
            let count = |verdict| comparison.changes.iter().filter(|c| c.verdict == verdict).count();
            [count(Verdict::Worse), count(Verdict::Better), comparison.gone.len()]
        });
        let counts = counts.map_or_else(
            || "<td colspan=\"3\">the first</td>".to_owned(),
            |[worse, better, gone]| {
                let class = if worse + gone > 0 { " class=\"worse\"" } else { "" };
                format!("<td{class}>{worse}</td><td>{better}</td><td>{gone}</td>")
            },
        );
        let load = newest.run.machine.load.filter(|load| *load > 1.0);
        let doubt = load.map(|load| format!(" (busy machine, load {load:.1})")).unwrap_or_default();
        let _ = writeln!(
            rows,
            "<tr><td><span class=\"key t{}\">●</span> {}</td><td>{}</td><td><span class=\"when\">{}</span>{doubt}</td><td><code>{}</code></td>{counts}</tr>",
            place % COLOURS,
            escaped(&cut(&track.label, SHOWN)),
            track.runs.len(),
            escaped(&cut(&newest.at, 24)),
            escaped(&cut(commit, 12)),
        );
    }
    if rows.is_empty() { "<tr><td colspan=\"7\">none</td></tr>".to_owned() } else { rows }
}

/// What is worse in the newest run of a track, and what is gone, with a link to its chart where that is on this page.
fn worse(history: &History, chosen: &[&Measure], choice: &Choice, at: usize) -> String {
    let mut items = Vec::new();
    for (place, measure) in chosen.iter().enumerate() {
        for line in &measure.lines {
            let newest = history.tracks[line.track].runs.last();
            let dot =
                line.dots.last().filter(|dot| Some(&dot.run) == newest && dot.verdict() == Verdict::Worse);
            let Some(dot) = dot else { continue };
            let page = place / CHARTS + 1;
            let link = if page == at {
                format!("#m{place}")
            } else {
                format!("benchmarks?{}#m{place}", escaped(&choice.query(page)))
            };
            let key = line.track % COLOURS;
            items.push(format!(
                "<li><span class=\"key t{key}\">▲</span> <a href=\"{link}\">{}</a>{}</li>",
                escaped(&title(measure)),
                escaped(&change(dot)),
            ));
        }
    }
    for (place, track) in history.tracks.iter().enumerate() {
        let shown = choice.machine.is_empty() || choice.machine == track.key;
        let gone = track.newest.iter().filter(|_| shown).flat_map(|comparison| &comparison.gone);
        let key = place % COLOURS;
        items.extend(gone.map(|gone| {
            format!("<li><span class=\"key t{key}\">∅</span> {}: gone</li>", escaped(&cut(gone, SHOWN)))
        }));
    }
    if items.is_empty() {
        return "<p>Nothing that is chosen here became worse in the newest run of any machine.</p>"
            .to_owned();
    }
    let more = items.len().saturating_sub(LISTED);
    items.truncate(LISTED);
    let more = if more > 0 { format!("<li>and {more} more</li>") } else { String::new() };
    format!("<ul>{}{more}</ul>", items.join("\n"))
}

fn title(measure: &Measure) -> String {
    format!("{} {}", cut(&measure.id, SHOWN), cut(&measure.kind, 40))
}

fn write_figure(out: &mut String, history: &History, measure: &Measure, place: usize) {
    let words = in_words(history, measure);
    let class = if measure.is_worse(&history.tracks) { " class=\"worse\"" } else { "" };
    let _ = writeln!(
        out,
        "<figure id=\"m{place}\"{class}><figcaption>{} <span class=\"unit\">{}</span></figcaption>\n{}\n\
         <details><summary>Figures</summary><table><thead><tr><th>run</th><th>commit</th><th>{}</th><th>change</th></tr></thead><tbody>",
        escaped(&title(measure)),
        escaped(&unit(measure)),
        svg(history, measure, &words),
        escaped(&unit(measure)),
    );
    for line in &measure.lines {
        for dot in line.dots.iter().rev() {
            let kept = &history.runs[dot.run];
            let _ = writeln!(
                out,
                "<tr><td><span class=\"key t{}\">●</span> {}</td><td><code>{}</code></td><td>{}</td><td>{}</td></tr>",
                line.track % COLOURS,
                escaped(&cut(&kept.at, 20)),
                escaped(&cut(kept.run.commit.as_deref().unwrap_or(""), 12)),
                value(dot.value),
                escaped(change(dot).trim_start_matches(", ")),
            );
        }
    }
    out.push_str("</tbody></table></details></figure>\n");
}

/// What a chart shows, for whoever does not see it.
fn in_words(history: &History, measure: &Measure) -> String {
    let mut words = format!("{} in {}", title(measure), unit(measure));
    for line in &measure.lines {
        let (Some(first), Some(last)) = (line.dots.first(), line.dots.last()) else { continue };
        let text = |dot: &super::tracks::Dot| {
            let Interval { median, .. } = dot.value;
            format!("{} on {}", ltc_records::short(median), day(&history.runs[dot.run].at))
        };
        let marked = line.dots.iter().filter(|dot| dot.verdict() == Verdict::Worse).count();
        let label = cut(&history.tracks[line.track].label, SHOWN);
        let _ = write!(
            words,
            "; {label}: {} runs, {} to {}, worse at {marked}",
            line.dots.len(),
            text(first),
            text(last)
        );
    }
    words
}

fn links(choice: &Choice, at: usize, pages: usize) -> String {
    let link = |page: usize, text: &str| {
        format!("<a href=\"benchmarks?{}\">{text}</a>", escaped(&choice.query(page)))
    };
    let mut words = vec![format!("page {at} of {pages}")];
    words.extend((at > 1).then(|| link(at - 1, "before")));
    words.extend((at < pages).then(|| link(at + 1, "after")));
    words.join(" · ")
}

/// As a value in a query.
fn percent_encoded(text: &str) -> String {
    let plain = |b: &u8| b.is_ascii_alphanumeric() || b"-._~".contains(b);
    text.bytes().map(|b| if plain(&b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

#[cfg(test)]
mod tests {
    use ltc_store::Benchmark;

    use super::super::tracks::tests::posted;
    use super::*;

    fn shown(found: Vec<Benchmark>, choice: Choice) -> String {
        page(History::of(found), &Choice { limit: 60, ..choice })
    }

    /// Times of five runs, of which the last is a fifth slower.
    fn runs() -> Vec<Benchmark> {
        (1..).zip([40.0, 40.5, 40.2, 40.1, 48.3]).map(|(day, time)| posted("a", day, time, 1e-6)).collect()
    }

    #[test]
    fn there_is_a_chart_for_each_measure_and_the_worst_comes_first() {
        let text = shown(runs(), Choice::default());
        assert_eq!(text.matches("<figure").count(), 3);
        assert!(text.contains("<figure id=\"m0\" class=\"worse\"><figcaption>integral/quad time"), "{text}");
        assert!(text.contains("<a href=\"#m0\">integral/quad time</a>, worse: × 1.2"), "{text}");
        assert!(text.contains("5 runs, 3 measures.") && !text.contains("{{") && !text.contains("NaN"));
        for outside in ["http://", "https://", "src=", "<script", "<link", "@import", "url("] {
            assert!(!text.contains(outside), "{outside}");
        }
    }

    #[test]
    fn measures_and_machines_are_chosen() {
        let mut found = runs();
        found.push(posted("other", 9, 80.0, 1e-6));
        let figures = |choice: Choice| {
            let text = shown(found.clone(), choice);
            (text.matches("<figure").count(), text.matches("<circle").count() + text.matches("<path").count())
        };
        assert_eq!(figures(Choice::default()), (3, 18));
        assert_eq!(figures(Choice { measure: "QUAD".into(), ..Choice::default() }), (2, 12));
        assert_eq!(figures(Choice { measure: "quad time".into(), ..Choice::default() }), (1, 6));
        assert_eq!(figures(Choice { worse: true, ..Choice::default() }), (1, 6));
        assert_eq!(figures(Choice { measure: "nothing".into(), ..Choice::default() }), (0, 0));
        let history = History::of(found.clone());
        let machine = history.tracks.iter().find(|t| t.runs.len() == 1).unwrap().key.clone();
        assert_eq!(figures(Choice { machine, ..Choice::default() }), (3, 3));
        assert_eq!(figures(Choice { machine: "none".into(), ..Choice::default() }), (0, 0));
    }

    #[test]
    fn what_was_posted_is_text_and_never_markup() {
        let evil = "</title></svg>\"'><script>alert(1)</script>{{charts}}&";
        let mut found = runs();
        for benchmark in &mut found {
            benchmark.name = evil.to_owned();
            for field in ["date", "tool", "commit"] {
                benchmark.run[field] = evil.into();
            }
            for field in ["cpu", "system", "build", "gpu"] {
                benchmark.run["machine"][field] = evil.into();
            }
            benchmark.run["records"][0]["id"] = evil.into();
            benchmark.run["records"][0]["per"] = evil.into();
            benchmark.run["records"][0]["errors"] = serde_json::json!({ evil: 0.5 });
        }
        found[4].run["records"][1]["id"] = "new".into();
        let choice =
            Choice { name: evil.into(), measure: "script".into(), since: evil.into(), ..Choice::default() };
        let text = shown(found, choice);
        assert!(text.contains("<figure") && text.contains("&lt;script&gt;"));
        for planted in ["<script", "</svg>\"", "'><", "\"'>"] {
            assert!(!text.contains(planted), "{planted}");
        }
        // What looks like a gap of the page is left as it is, and fills nothing.
        assert_eq!(text.matches("<h2>Measures").count(), 1);
        assert!(text.matches("<figure").count() <= 2);
    }

    #[test]
    fn the_page_stays_small_however_much_is_posted() {
        let mut found = runs();
        for benchmark in &mut found {
            let records = (0..3000).map(|i| {
                serde_json::json!({ "id": format!("{}{i:04}", "x".repeat(2000)), "per": "y".repeat(2000), "bytes": i + 1 })
            });
            benchmark.run["records"] = records.collect();
        }
        found[4].run["records"] = serde_json::json!([]);
        let text = shown(found.clone(), Choice::default());
        assert_eq!(text.matches("<figure").count(), CHARTS);
        assert!(text.len() < 200_000, "{} bytes", text.len());
        assert!(text.contains("page 1 of 125") && text.contains("and 2960 more"));
        let last = shown(found, Choice { page: usize::MAX, ..Choice::default() });
        assert!(last.contains("page 125 of 125") && last.contains("page=124"));
    }

    #[test]
    fn numbers_at_the_edge_of_what_a_number_holds_are_drawn() {
        let found = [1e308, 1e-308, 0.0, -1e308, 5e-324].into_iter().zip(1..);
        let found = found.map(|(time, day)| posted("a", day, time, time)).collect();
        let text = shown(found, Choice::default());
        for bad in ["NaN", "inf"] {
            assert!(!text.contains(bad), "{bad}: {text}");
        }
        let nothing = shown(Vec::new(), Choice::default());
        assert!(nothing.contains("There is no run that fits.") && nothing.contains("0 runs"));
    }
}
