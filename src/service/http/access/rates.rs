//! Rate limits by address and by token: the generic cell rate algorithm, implemented by `governor`.

use governor::clock::{Clock, DefaultClock};
use governor::{DefaultKeyedRateLimiter, Quota, RateLimiter};
use std::hash::Hash;
use std::net::{IpAddr, Ipv6Addr};
use std::num::NonZeroU32;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// After this many requests, idle addresses and tokens are removed, so that memory is bounded by the number of active ones.
const FORGET_AFTER: u32 = 4096;
/// Length of the IPv6 prefix of one subscriber (RFC 6177).
const SUBSCRIBER: Ipv6Addr = Ipv6Addr::new(0xffff, 0xffff, 0xffff, 0xffff, 0, 0, 0, 0);

/// Requests per second; after an idle second this many may come at once.
#[derive(Debug, Default)]
pub struct Rates {
    addresses: Option<Rate<IpAddr>>,
    tokens: Option<Rate<String>>,
}

impl Rates {
    /// `None`: unlimited.
    pub fn new(an_address: Option<NonZeroU32>, a_token: Option<NonZeroU32>) -> Self {
        Self { addresses: an_address.map(Rate::new), tokens: a_token.map(Rate::new) }
    }

    /// # Errors
    /// The time until the next request from this address is answered.
    pub fn of_address(&self, address: IpAddr) -> Result<(), Duration> {
        self.addresses.as_ref().map_or(Ok(()), |rate| rate.take(&subscriber(address)))
    }

    /// # Errors
    /// The time until the next request with this token is answered.
    pub fn of_token(&self, name: &str) -> Result<(), Duration> {
        self.tokens.as_ref().map_or(Ok(()), |rate| rate.take(&name.to_owned()))
    }
}

/// The key under which an address is counted: an IPv6 subscriber has all addresses of a prefix.
pub fn subscriber(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => IpAddr::V6(address & SUBSCRIBER),
        address => address,
    }
}

struct Rate<Key: Hash + Eq + Clone> {
    limiter: DefaultKeyedRateLimiter<Key>,
    clock: DefaultClock,
    taken: AtomicU32,
}

impl<Key: Hash + Eq + Clone> std::fmt::Debug for Rate<Key> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Rate").field("keys", &self.limiter.len()).finish()
    }
}

impl<Key: Hash + Eq + Clone> Rate<Key> {
    fn new(a_second: NonZeroU32) -> Self {
        let limiter = RateLimiter::dashmap(Quota::per_second(a_second));
        Self { limiter, clock: DefaultClock::default(), taken: AtomicU32::new(0) }
    }

    fn take(&self, key: &Key) -> Result<(), Duration> {
        if self.taken.fetch_add(1, Ordering::Relaxed) % FORGET_AFTER == FORGET_AFTER - 1 {
            self.limiter.retain_recent();
            self.limiter.shrink_to_fit();
        }
        self.limiter.check_key(key).map_err(|early| early.wait_time_from(self.clock.now()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_address_and_each_token_has_a_rate_of_its_own() {
        let five = NonZeroU32::new(5);
        let rates = Rates::new(five, five);
        let answered = |address: &str| (0..20).filter(|_| rates.of_address(address.parse().unwrap()).is_ok()).count();
        assert!((5..8).contains(&answered("192.0.2.1")));
        assert!((5..8).contains(&answered("192.0.2.2")));
        assert!((5..8).contains(&answered("2001:db8::1")));
        assert!(answered("2001:db8::2") < 3, "the same network");
        assert!((5..8).contains(&answered("2001:db8:0:1::1")));
        assert!(answered("::ffff:192.0.2.1") < 3, "the same address written otherwise");
        assert!((5..8).contains(&(0..20).filter(|_| rates.of_token("ann").is_ok()).count()));
        let wait = rates.of_token("ann").unwrap_err();
        assert!(wait <= Duration::from_millis(200), "{wait:?}");
        assert!((0..1000).all(|_| Rates::default().of_address("192.0.2.1".parse().unwrap()).is_ok()));
    }

    #[test]
    fn those_who_have_been_quiet_are_forgotten() {
        let rate = Rate::new(NonZeroU32::new(100_000).unwrap());
        for number in 0..3 * FORGET_AFTER {
            rate.take(&number).unwrap();
            if number == 2 * FORGET_AFTER {
                std::thread::sleep(Duration::from_millis(1));
            }
        }
        assert!(rate.limiter.len() <= 2 * FORGET_AFTER as usize, "{}", rate.limiter.len());
    }
}
