//! Readable names: naga numbers every variable of a module (`lobe_1`, `lobe_2`, …), although each stands in a function of
//! its own.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use naga::{Module, TypeInner};

/// A word of the text, and where.
struct Word {
    at: Range<usize>,
    /// After a dot: a member's name.
    member: bool,
}

/// The text with the names of the WGSL wherever no other name of the function, or of the module, is in the way.
pub fn readable(text: &str, module: &Module) -> String {
    let mut known = Names::of(module);
    known.all = words(text).into_iter().map(|word| text[word.at].to_owned()).collect();
    let mut result = String::with_capacity(text.len());
    for part in parts(text) {
        let local = known.locals_of(part);
        result.push_str(&renamed(part, |name, member| {
            if !member && let Some(new) = local.get(name) {
                return Some(new.clone());
            }
            known.digit_ended(name)
        }));
    }
    result
}

#[derive(Default)]
struct Names {
    /// Of variables, arguments and `let`s.
    locals: BTreeSet<String>,
    /// Of functions and types.
    others: BTreeSet<String>,
    /// Of members of structures.
    members: BTreeSet<String>,
    /// Every word of the text.
    all: BTreeSet<String>,
}

impl Names {
    fn of(module: &Module) -> Self {
        let mut names = Self::default();
        for (_, function) in module.functions.iter() {
            names.others.extend(function.name.clone());
            names.locals.extend(function.arguments.iter().filter_map(|a| a.name.clone()));
            names.locals.extend(function.local_variables.iter().filter_map(|v| v.1.name.clone()));
            names.locals.extend(function.named_expressions.values().cloned());
        }
        for (_, ty) in module.types.iter() {
            names.others.extend(ty.name.clone());
            if let TypeInner::Struct { members, .. } = &ty.inner {
                names.members.extend(members.iter().filter_map(|m| m.name.clone()));
            }
        }
        names
    }

    /// naga puts `_` behind a name that ends with a digit, and behind a keyword.
    fn digit_ended(&self, name: &str) -> Option<String> {
        let base = name.strip_suffix('_')?;
        let free = base.ends_with(|c: char| c.is_ascii_digit()) && !self.all.contains(base);
        let known = self.others.contains(base) || self.members.contains(base);
        (free && known).then(|| base.to_owned())
    }

    /// New names for the local names of one function.
    fn locals_of(&self, function: &str) -> BTreeMap<String, String> {
        let used: BTreeSet<&str> =
            words(function).into_iter().filter(|w| !w.member).map(|w| &function[w.at]).collect();
        let mut taken: BTreeSet<String> = BTreeSet::new();
        let mut map = BTreeMap::new();
        // In the order of their numbers, not of the alphabet.
        let mut candidates: Vec<(&str, &str, u32)> = used.iter().filter_map(|name| numbered(name)).collect();
        candidates.sort_by_key(|(_, base, number)| (*base, *number));
        for (name, base, _) in candidates {
            let ends_with_digit = base.ends_with(|c: char| c.is_ascii_digit());
            let is_keyword = !ends_with_digit && self.all.contains(&format!("{base}_"));
            let free = !used.contains(base) && !taken.contains(base) && !is_keyword;
            if free && self.locals.contains(base) && !self.others.contains(base) {
                taken.insert(base.to_owned());
                map.insert(name.to_owned(), base.to_owned());
            }
        }
        map
    }
}

/// `lobe_12` is the twelfth `lobe`, `p0_` the first `p0`.
fn numbered(name: &str) -> Option<(&str, &str, u32)> {
    let (base, number) = name.rsplit_once('_')?;
    let number = if number.is_empty() { 0 } else { number.parse().ok()? };
    (!base.is_empty()).then_some((name, base, number))
}

/// Cuts the text before each line that stands at the margin and is no closing brace: a function is then one part.
fn parts(text: &str) -> Vec<&str> {
    let mut cuts = vec![0];
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if line.starts_with(|c: char| c.is_ascii_alphabetic() || c == '#') && at > 0 {
            cuts.push(at);
        }
        at += line.len();
    }
    cuts.push(text.len());
    cuts.windows(2).map(|pair| &text[pair[0]..pair[1]]).collect()
}

fn words(text: &str) -> Vec<Word> {
    let bytes = text.as_bytes();
    let is_word = |b: u8| b.is_ascii_alphanumeric() || b == b'_';
    let mut list = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        if !is_word(bytes[at]) {
            at += 1;
            continue;
        }
        let length = bytes[at..].iter().take_while(|b| is_word(**b)).count();
        if !bytes[at].is_ascii_digit() {
            list.push(Word { at: at..at + length, member: at > 0 && bytes[at - 1] == b'.' });
        }
        at += length;
    }
    list
}

fn renamed(text: &str, new_name: impl Fn(&str, bool) -> Option<String>) -> String {
    let mut result = String::with_capacity(text.len());
    let mut done = 0;
    for word in words(text) {
        if let Some(new) = new_name(&text[word.at.clone()], word.member) {
            result.push_str(&text[done..word.at.start]);
            result.push_str(&new);
            done = word.at.end;
        }
    }
    result.push_str(&text[done..]);
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn module() -> Module {
        let wgsl = "
            struct LtcPair { p0: f32, x: f32 }
            fn ltc_a2(lobe: f32, half: f32) -> LtcPair { return LtcPair(lobe, half); }
            fn ltc_b(lobe: f32, half: f32, lobe_1: f32) -> f32 { return lobe * half * lobe_1; }";
        super::super::parse(wgsl).unwrap().0
    }

    #[test]
    fn numbers_go_where_nothing_is_in_the_way() {
        let raw = "LtcPair ltc_a2_(float lobe, float half_) {\n    return LtcPair(lobe, half_);\n}\n\
                   float ltc_b(float lobe_1, float half_1) {\n    return ltc_a2_(lobe_1, half_1).p0_;\n}\n";
        let clean = "LtcPair ltc_a2(float lobe, float half_) {\n    return LtcPair(lobe, half_);\n}\n\
                     float ltc_b(float lobe, float half_1) {\n    return ltc_a2(lobe, half_1).p0;\n}\n";
        assert_eq!(readable(raw, &module()), clean);
    }

    #[test]
    fn two_of_one_name_stay_apart() {
        let raw = "float ltc_b(float lobe_1, float lobe_2) {\n    return lobe_1 * lobe_2;\n}\n";
        let clean = "float ltc_b(float lobe, float lobe_2) {\n    return lobe * lobe_2;\n}\n";
        assert_eq!(readable(raw, &module()), clean);
        let taken = "float ltc_b(float lobe, float lobe_2) {\n    return lobe * lobe_2;\n}\n";
        assert_eq!(readable(taken, &module()), taken);
    }
}
