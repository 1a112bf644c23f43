//! How often one client may ask.

use std::hash::Hash;
use std::net::IpAddr;
use std::num::NonZeroU32;

use governor::clock::{Clock, DefaultClock};
use governor::{DefaultKeyedRateLimiter, Quota, RateLimiter};

use crate::ApiError;
use crate::settings::Limits;

/// Whom requests are counted by.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Client {
    /// A token's id.
    Token(String),
    /// An address; IPv6 by its /64, since a client has many of those.
    Address(IpAddr),
    /// Unknown: the router is asked without a connection.
    Nobody,
}

impl Client {
    pub(crate) fn of_address(address: Option<IpAddr>) -> Self {
        match address {
            None => Self::Nobody,
            Some(IpAddr::V6(v6)) if v6.to_ipv4_mapped().is_none() => {
                let [a, b, c, d, ..] = v6.segments();
                Self::Address(std::net::Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0).into())
            }
            Some(other) => Self::Address(other.to_canonical()),
        }
    }
}

/// The rates of all clients.
pub(crate) struct Rates {
    reads: Option<DefaultKeyedRateLimiter<Client>>,
    writes: Option<DefaultKeyedRateLimiter<Client>>,
    clock: DefaultClock,
}

impl std::fmt::Debug for Rates {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Rates { .. }")
    }
}

/// Bursts of writes, in seconds of their rate.
const WRITE_BURST: u32 = 5;

fn limiter<K: Clone + Eq + Hash>(per_second: u32, burst: u32) -> Option<DefaultKeyedRateLimiter<K>> {
    let per_second = NonZeroU32::new(per_second)?;
    let burst = NonZeroU32::new(burst)?;
    Some(RateLimiter::keyed(Quota::per_second(per_second).allow_burst(burst)))
}

impl Rates {
    pub(crate) fn new(limits: &Limits) -> Self {
        let Limits { reads_per_second: reads, writes_per_second: writes, .. } = *limits;
        Self {
            reads: limiter(reads, reads),
            writes: limiter(writes, writes.saturating_mul(WRITE_BURST)),
            clock: DefaultClock::default(),
        }
    }

    /// # Errors
    /// [`ApiError::RateLimited`].
    pub(crate) fn read(&self, client: impl FnOnce() -> Client) -> Result<(), ApiError> {
        self.check(self.reads.as_ref(), client)
    }

    /// # Errors
    /// [`ApiError::RateLimited`].
    pub(crate) fn write(&self, client: impl FnOnce() -> Client) -> Result<(), ApiError> {
        self.check(self.writes.as_ref(), client)
    }

    fn check(
        &self,
        limiter: Option<&DefaultKeyedRateLimiter<Client>>,
        client: impl FnOnce() -> Client,
    ) -> Result<(), ApiError> {
        let Some(limiter) = limiter else { return Ok(()) };
        limiter.check_key(&client()).map_err(|not_until| {
            let seconds = not_until.wait_time_from(self.clock.now()).as_secs() + 1;
            ApiError::RateLimited { seconds }
        })
    }

    /// Forgets clients that have not asked for a while: there may be many over the months.
    pub(crate) fn forget(&self) {
        for limiter in [&self.reads, &self.writes].into_iter().flatten() {
            limiter.retain_recent();
            limiter.shrink_to_fit();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn client(text: &str) -> Client {
        Client::of_address(Some(text.parse().unwrap()))
    }

    #[test]
    fn each_client_has_its_own_rate() {
        let rates = Rates::new(&Limits { reads_per_second: 2, writes_per_second: 1, ..Limits::default() });
        let (one, other) = (client("192.0.2.1"), client("192.0.2.2"));
        for _ in 0..2 {
            rates.read(|| one.clone()).unwrap();
        }
        assert!(matches!(rates.read(|| one.clone()), Err(ApiError::RateLimited { seconds: 1.. })));
        rates.read(|| other.clone()).unwrap();
        for _ in 0..WRITE_BURST {
            rates.write(|| one.clone()).unwrap();
        }
        assert!(rates.write(|| one).is_err());
        rates.write(|| other).unwrap();
        rates.forget();
    }

    #[test]
    fn no_limit_is_no_limit() {
        let rates = Rates::new(&Limits { reads_per_second: 0, writes_per_second: 0, ..Limits::default() });
        for _ in 0..10_000 {
            rates.read(|| Client::Nobody).unwrap();
            rates.write(|| Client::Nobody).unwrap();
        }
    }

    #[test]
    fn addresses_of_one_network_are_one_client() {
        assert_eq!(client("2001:db8::1"), client("2001:db8::ffff:2"));
        assert_ne!(client("2001:db8::1"), client("2001:db8:0:1::1"));
        assert_eq!(client("::ffff:192.0.2.1"), client("192.0.2.1"));
    }
}
