//! Encoded tables, kept in memory up to a number of bytes.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::representation::Tagged;

/// A least-recently-used cache bounded by the bytes it holds.
#[derive(Debug)]
pub(crate) struct Cache<K> {
    state: Mutex<State<K>>,
    capacity: usize,
}

#[derive(Debug)]
struct State<K> {
    entries: HashMap<K, Entry>,
    bytes: usize,
    clock: u64,
}

#[derive(Debug)]
struct Entry {
    value: Tagged,
    used: u64,
}

/// What an entry costs besides its bytes, roughly: many tiny entries must count as well.
const ENTRY_BYTES: usize = 512;

fn cost(value: &Tagged) -> usize {
    value.bytes.len() + ENTRY_BYTES
}

impl<K: Clone + Eq + Hash> Cache<K> {
    /// A cache of at most `capacity` bytes.
    pub(crate) fn new(capacity: usize) -> Self {
        let state = State { entries: HashMap::new(), bytes: 0, clock: 0 };
        Self { state: Mutex::new(state), capacity }
    }

    /// The value of a key, which is then the most recently used.
    pub(crate) fn get(&self, key: &K) -> Option<Tagged> {
        let mut state = self.lock();
        state.clock += 1;
        let clock = state.clock;
        let entry = state.entries.get_mut(key)?;
        entry.used = clock;
        Some(entry.value.clone())
    }

    /// Keeps a value, and drops the least recently used until all fit. One larger than the whole cache is not kept.
    pub(crate) fn insert(&self, key: K, value: Tagged) {
        let cost_of_value = cost(&value);
        if cost_of_value > self.capacity {
            return;
        }
        let mut state = self.lock();
        state.remove(&key);
        while state.bytes + cost_of_value > self.capacity {
            let oldest = state.entries.iter().min_by_key(|(_, entry)| entry.used).map(|(key, _)| key.clone());
            let Some(oldest) = oldest else { break };
            state.remove(&oldest);
        }
        state.clock += 1;
        state.bytes += cost_of_value;
        let used = state.clock;
        state.entries.insert(key, Entry { value, used });
    }

    /// No change leaves the state half made, so a panic of another holder harms nothing.
    fn lock(&self) -> MutexGuard<'_, State<K>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<K: Eq + Hash> State<K> {
    fn remove(&mut self, key: &K) {
        if let Some(entry) = self.entries.remove(key) {
            self.bytes -= cost(&entry.value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(byte: u8, len: usize) -> Tagged {
        Tagged::new(vec![byte; len])
    }

    fn bytes(cache: &Cache<u32>) -> usize {
        cache.lock().bytes
    }

    #[test]
    fn the_least_recently_used_goes_first() {
        let cache = Cache::new(3 * (100 + ENTRY_BYTES));
        for key in 0..3 {
            cache.insert(key, value(key as u8, 100));
        }
        assert!(cache.get(&0).is_some());
        cache.insert(3, value(3, 100));
        assert!(cache.get(&1).is_none(), "1 was used longest ago");
        for key in [0, 2, 3] {
            assert_eq!(cache.get(&key).unwrap().bytes[0], key as u8);
        }
    }

    #[test]
    fn the_bound_holds_whatever_is_inserted() {
        let capacity = 10_000;
        let cache = Cache::new(capacity);
        for i in 0..1000_u32 {
            cache.insert(i % 37, value(0, (i as usize * 7919) % 12_000));
            assert!(bytes(&cache) <= capacity);
        }
        let expected: usize = cache.lock().entries.values().map(|e| cost(&e.value)).sum();
        assert_eq!(bytes(&cache), expected);
        assert!(expected > 0, "something is kept");
    }

    #[test]
    fn what_is_larger_than_the_cache_displaces_nothing() {
        let cache = Cache::new(1000);
        cache.insert(1, value(1, 10));
        cache.insert(2, value(2, 1000));
        assert!(cache.get(&2).is_none());
        assert!(cache.get(&1).is_some());
    }
}
