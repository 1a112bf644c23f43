//! What was used when, and what has to go.

use std::collections::{BTreeMap, HashMap};

/// Keys with their sizes, in the order of their last use.
#[derive(Default)]
pub(super) struct Recent {
    clock: u64,
    order: BTreeMap<u64, String>,
    keys: HashMap<String, (u64, u64)>,
    bytes: u64,
}

impl Recent {
    /// Notes that a key was used now, and how many bytes it has.
    pub(super) fn used(&mut self, key: &str, size: u64) {
        self.forget(key);
        self.clock += 1;
        self.order.insert(self.clock, key.to_owned());
        self.keys.insert(key.to_owned(), (self.clock, size));
        self.bytes += size;
    }

    /// Forgets a key.
    pub(super) fn forget(&mut self, key: &str) {
        if let Some((at, size)) = self.keys.remove(key) {
            self.order.remove(&at);
            self.bytes -= size;
        }
    }

    /// The keys that have to go, least recently used first, for no more than `limit` bytes to be left; they are forgotten.
    pub(super) fn evict(&mut self, limit: u64) -> Vec<String> {
        let mut gone = Vec::new();
        while self.bytes > limit
            && let Some((_, key)) = self.order.first_key_value()
        {
            let key = key.clone();
            self.forget(&key);
            gone.push(key);
        }
        gone
    }

    /// Keys and sizes, least recently used first.
    pub(super) fn list(&self) -> Vec<(String, u64)> {
        self.order
            .values()
            .map(|key| (key.clone(), self.keys.get(key).map_or(0, |(_, size)| *size)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_unused_goes_first() {
        let mut recent = Recent::default();
        for key in ["a", "b", "c"] {
            recent.used(key, 10);
        }
        recent.used("a", 10);
        recent.used("b", 5);
        assert_eq!(recent.list(), [("c".to_owned(), 10), ("a".to_owned(), 10), ("b".to_owned(), 5)]);
        assert!(recent.evict(25).is_empty());
        assert_eq!(recent.evict(14), ["c", "a"]);
        recent.forget("b");
        assert!(recent.evict(0).is_empty() && recent.list().is_empty());
    }
}
