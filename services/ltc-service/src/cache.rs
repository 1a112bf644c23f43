//! What was made or read once, kept in memory up to a number of bytes.

use std::borrow::Borrow;
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A least-recently-used cache bounded by the bytes it holds.
#[derive(Debug)]
pub(crate) struct Cache<K, V> {
    state: Mutex<State<K, V>>,
    capacity: usize,
}

#[derive(Debug)]
struct State<K, V> {
    entries: HashMap<K, Entry<V>>,
    bytes: usize,
    clock: u64,
}

#[derive(Debug)]
struct Entry<V> {
    value: V,
    cost: usize,
    used: u64,
}

/// What an entry costs besides its bytes, roughly: many tiny entries must count as well.
const ENTRY_BYTES: usize = 512;

impl<K: Clone + Eq + Hash, V: Clone> Cache<K, V> {
    /// A cache of at most `capacity` bytes.
    pub(crate) fn new(capacity: usize) -> Self {
        let state = State { entries: HashMap::new(), bytes: 0, clock: 0 };
        Self { state: Mutex::new(state), capacity }
    }

    /// The value of a key, which is then the most recently used.
    pub(crate) fn get<Q: Eq + Hash + ?Sized>(&self, key: &Q) -> Option<V>
    where
        K: Borrow<Q>,
    {
        let mut state = self.lock();
        state.clock += 1;
        let clock = state.clock;
        let entry = state.entries.get_mut(key)?;
        entry.used = clock;
        Some(entry.value.clone())
    }

    /// Keeps a value of so many bytes, and drops the least recently used until all fit. One larger than the whole cache is not
    /// kept.
    pub(crate) fn insert(&self, key: K, value: V, bytes: usize) {
        let cost = bytes + ENTRY_BYTES;
        if cost > self.capacity {
            return;
        }
        let mut state = self.lock();
        state.remove(&key);
        while state.bytes + cost > self.capacity {
            let oldest = state.entries.iter().min_by_key(|(_, entry)| entry.used).map(|(key, _)| key.clone());
            let Some(oldest) = oldest else { break };
            state.remove(&oldest);
        }
        state.clock += 1;
        state.bytes += cost;
        let used = state.clock;
        state.entries.insert(key, Entry { value, cost, used });
    }

    /// Bytes held now.
    pub(crate) fn bytes(&self) -> usize {
        self.lock().bytes
    }

    /// No change leaves the state half made, so a panic of another holder harms nothing.
    fn lock(&self) -> MutexGuard<'_, State<K, V>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<K: Eq + Hash, V> State<K, V> {
    fn remove(&mut self, key: &K) {
        if let Some(entry) = self.entries.remove(key) {
            self.bytes -= entry.cost;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_recently_used_goes_first() {
        let cache = Cache::new(3 * (100 + ENTRY_BYTES));
        for key in 0..3 {
            cache.insert(key, key, 100);
        }
        assert!(cache.get(&0).is_some());
        cache.insert(3, 3, 100);
        assert!(cache.get(&1).is_none(), "1 was used longest ago");
        for key in [0, 2, 3] {
            assert_eq!(cache.get(&key), Some(key));
        }
    }

    #[test]
    fn the_bound_holds_whatever_is_inserted() {
        let capacity = 10_000;
        let cache = Cache::new(capacity);
        for i in 0..1000_u32 {
            cache.insert(i % 37, (), (i as usize * 7919) % 12_000);
            assert!(cache.bytes() <= capacity);
        }
        let expected: usize = cache.lock().entries.values().map(|e| e.cost).sum();
        assert_eq!(cache.bytes(), expected);
        assert!(expected > 0, "something is kept");
    }

    #[test]
    fn what_is_larger_than_the_cache_displaces_nothing() {
        let cache = Cache::new(1000);
        cache.insert(1, (), 10);
        cache.insert(2, (), 1000);
        assert!(cache.get(&2).is_none());
        assert!(cache.get(&1).is_some());
    }
}
