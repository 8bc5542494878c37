//! What a solve may use, and what ends it at once.
//!
//! A piece of work that may last says how many multiplications it is about to take ([`spend`]), and what takes memory whose
//! size a request sets says how many bytes ([`take`]), before it begins. Where the solve has been cancelled or would go
//! past a bound, the call does not return: the stack unwinds to where the solve was entered ([`Budget::during`]), which
//! answers with the [`Breach`]. So no caller in between can take "cancelled" for "singular" and try something else. The
//! unwinding begins without a panic's message (`std::panic::resume_unwind`), as a query of an incremental compiler does that
//! has become stale.
//!
//! Bytes are the sizes of what is held, summed as it is taken and given back: not what the system counts, so that the
//! same request ends at the same place on every machine. Outside [`Budget::during`] nothing is bounded.

use crate::resources::cancel::CancelFlag;
use std::cell::{Cell, RefCell};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

#[cfg(panic = "abort")]
compile_error!("a cancelled solve unwinds: build with panic = \"unwind\"");

/// Bounds of one solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bounds {
    /// Bytes that it may hold at a time.
    pub memory: u64,
    /// Entries of one triangular factor.
    pub factor_entries: u64,
    /// Multiplications of one sparse factorisation.
    pub factor_work: u64,
}

impl Default for Bounds {
    fn default() -> Self {
        Self { memory: 4 << 30, factor_entries: 100_000_000, factor_work: 1_000_000_000_000 }
    }
}

/// What ended a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Breach {
    Cancelled,
    /// So many bytes would be held.
    Memory {
        asked: u64,
        allowed: u64,
    },
    /// A factor would have so many entries.
    FactorEntries {
        asked: u64,
        allowed: u64,
    },
    /// A factorisation would take so many multiplications.
    FactorWork {
        asked: u64,
        allowed: u64,
    },
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cancelled => f.write_str("cancelled"),
            Self::Memory { asked, allowed } => {
                write!(f, "it would hold {asked} bytes; at most {allowed} are allowed (--max-memory)")
            }
            Self::FactorEntries { asked, allowed } => write!(
                f,
                "the factors of its stiffness would have {asked} entries; at most {allowed} are allowed \
                 (--max-factor-entries)"
            ),
            Self::FactorWork { asked, allowed } => write!(
                f,
                "a factorisation of its stiffness would take {asked} multiplications; at most {allowed} are allowed \
                 (--max-factor-work)"
            ),
        }
    }
}

/// What is held, against what may be.
#[derive(Debug)]
struct Account {
    bounds: Bounds,
    held: AtomicU64,
    /// A bifurcation point is being located.
    is_locating: AtomicBool,
}

/// Of one solve; copies share the account.
#[derive(Debug, Clone)]
pub struct Budget {
    cancel: CancelFlag,
    account: Arc<Account>,
}

thread_local! {
    static CURRENT: RefCell<Option<Budget>> = const { RefCell::new(None) };
    static LARGEST_PIECE: Cell<u64> = const { Cell::new(0) };
    static LOOKS: Cell<u64> = const { Cell::new(0) };
    static CANCELLED_AT: Cell<u64> = const { Cell::new(u64::MAX) };
}

impl Budget {
    pub fn new(cancel: CancelFlag, bounds: Bounds) -> Self {
        Self {
            cancel,
            account: Arc::new(Account { bounds, held: AtomicU64::new(0), is_locating: AtomicBool::new(false) }),
        }
    }

    /// With the account of the solve under way on this thread, or one of its own where there is none.
    pub fn under_way(cancel: CancelFlag) -> Self {
        match current() {
            Some(Self { account, .. }) => Self { cancel, account },
            None => Self::new(cancel, Bounds::default()),
        }
    }

    /// Whether the solve is just now locating a bifurcation point.
    pub fn is_locating_bifurcation(&self) -> bool {
        self.account.is_locating.load(Ordering::Relaxed)
    }

    /// Does a piece of work within these bounds.
    ///
    /// # Errors
    /// What ended it before its time.
    pub fn during<T>(&self, work: impl FnOnce() -> T) -> Result<T, Breach> {
        let _restored = Restored(CURRENT.replace(Some(self.clone())));
        // What the work was changing is given up by who asked for it, or ended.
        catch_unwind(AssertUnwindSafe(work)).map_err(|unwound| match unwound.downcast::<Breach>() {
            Ok(breach) => *breach,
            Err(panic) => resume_unwind(panic),
        })
    }
}

/// The budget that was in force before, put back even by a panic.
struct Restored(Option<Budget>);

impl Drop for Restored {
    fn drop(&mut self) {
        CURRENT.set(self.0.take());
    }
}

fn current() -> Option<Budget> {
    CURRENT.with_borrow(Clone::clone)
}

/// Ends the solve under way.
pub fn end(breach: Breach) -> ! {
    resume_unwind(Box::new(breach))
}

/// Looks at the flag before work of so many multiplications.
pub fn spend(multiplications: usize) {
    let multiplications = multiplications as u64;
    if LARGEST_PIECE.get() < multiplications {
        LARGEST_PIECE.set(multiplications);
    }
    let look = LOOKS.get() + 1;
    LOOKS.set(look);
    let is_cancelled = |budget: &Budget| look >= CANCELLED_AT.get() || budget.cancel.is_cancelled();
    if CURRENT.with_borrow(|budget| budget.as_ref().is_some_and(is_cancelled)) {
        end(Breach::Cancelled);
    }
}

/// How often this thread has looked at the flag since it began.
pub fn looks() -> u64 {
    LOOKS.get()
}

/// Ends whatever solve this thread is at when it has looked so often, so that a test can break off at a known place.
pub fn cancel_at_look(look: u64) {
    CANCELLED_AT.set(look);
}

/// The flag of the solve under way, for loops too tight for [`spend`] and for libraries that ask back.
pub fn cancel_flag() -> CancelFlag {
    current().map(|budget| budget.cancel).unwrap_or_default()
}

/// The most multiplications that this thread has done since it began without looking at the flag; what a test asks.
pub fn largest_piece() -> u64 {
    LARGEST_PIECE.get()
}

/// Those of the solve under way.
pub fn bounds() -> Bounds {
    current().map_or_else(Bounds::default, |budget| budget.account.bounds)
}

/// As long as this is held, the solve says that it is locating a bifurcation point.
pub struct Locating(Option<(Arc<Account>, bool)>);

impl Drop for Locating {
    fn drop(&mut self) {
        if let Some((account, before)) = self.0.take() {
            account.is_locating.store(before, Ordering::Relaxed);
        }
    }
}

/// Says that the solve under way is locating a bifurcation point.
pub fn locating_bifurcation() -> Locating {
    let account = CURRENT.with_borrow(|budget| budget.as_ref().map(|budget| Arc::clone(&budget.account)));
    Locating(account.map(|account| {
        let before = account.is_locating.swap(true, Ordering::Relaxed);
        (account, before)
    }))
}

/// Refuses a factor that is too large, before anything of its size is taken.
pub fn allow_factor(entries: u64, multiplications: u64) {
    let bounds = CURRENT.with_borrow(|budget| budget.as_ref().map(|budget| budget.account.bounds));
    let Some(Bounds { factor_entries, factor_work, .. }) = bounds else { return };
    if entries > factor_entries {
        end(Breach::FactorEntries { asked: entries, allowed: factor_entries });
    }
    if multiplications > factor_work {
        end(Breach::FactorWork { asked: multiplications, allowed: factor_work });
    }
}

/// Bytes that are held until this is dropped. A copy holds as many more.
#[derive(Debug, Default)]
pub struct Taken {
    bytes: u64,
    account: Option<Arc<Account>>,
}

impl Drop for Taken {
    fn drop(&mut self) {
        if let Some(account) = &self.account {
            account.held.fetch_sub(self.bytes, Ordering::Relaxed);
        }
    }
}

impl Clone for Taken {
    fn clone(&self) -> Self {
        self.account.as_ref().map(|account| account.take(self.bytes)).unwrap_or_default()
    }
}

impl Taken {
    /// Takes memory for so many items more, to be held as long as what is held already.
    pub fn add<T>(&mut self, items: usize) {
        let mut more = take::<T>(items);
        if let Some(account) = more.account.take() {
            self.bytes += more.bytes;
            self.account = Some(account);
        }
    }
}

impl Account {
    fn take(self: &Arc<Self>, bytes: u64) -> Taken {
        let (held, allowed) = (self.held.load(Ordering::Relaxed), self.bounds.memory);
        let asked = held.saturating_add(bytes);
        if asked > allowed {
            end(Breach::Memory { asked, allowed });
        }
        self.held.fetch_add(bytes, Ordering::Relaxed);
        Taken { bytes, account: Some(Arc::clone(self)) }
    }
}

/// Takes memory for so many items of a kind, before it is allocated.
pub fn take<T>(items: usize) -> Taken {
    let bytes = (items as u64).saturating_mul(size_of::<T>() as u64);
    let account = CURRENT.with_borrow(|budget| budget.as_ref().map(|budget| Arc::clone(&budget.account)));
    account.map(|account| account.take(bytes)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_given_back_can_be_taken_again() {
        let budget = Budget::new(CancelFlag::default(), Bounds { memory: 100, ..Bounds::default() });
        let done = budget.during(|| {
            let first = take::<u64>(10);
            drop(first);
            let _second = take::<u64>(12);
            7
        });
        assert_eq!(done, Ok(7));
        let copied = budget.during(|| {
            let first = take::<u8>(60);
            let _copy = first.clone();
        });
        assert_eq!(copied, Err(Breach::Memory { asked: 120, allowed: 100 }));
        // Unwinding gave all of it back.
        assert_eq!(budget.during(|| drop(take::<u8>(100))), Ok(()));
        assert!(budget.during(|| drop(take::<u64>(usize::MAX))).is_err());
    }

    #[test]
    fn a_cancelled_solve_ends_at_its_next_look() {
        let cancel = CancelFlag::default();
        let budget = Budget::new(cancel.clone(), Bounds::default());
        let mut rounds = 0;
        let ended = budget.during(|| {
            loop {
                spend(10);
                rounds += 1;
                if rounds == 3 {
                    cancel.cancel();
                }
            }
        });
        assert_eq!((ended, rounds), (Err::<(), _>(Breach::Cancelled), 3));
        // Outside nothing looks.
        spend(10);
        allow_factor(u64::MAX, u64::MAX);
    }

    #[test]
    fn a_panic_stays_one() {
        let budget = Budget::new(CancelFlag::default(), Bounds::default());
        let caught = catch_unwind(AssertUnwindSafe(|| budget.during(|| resume_unwind(Box::new("a defect")))));
        assert!(caught.is_err_and(|panic| panic.downcast_ref::<&str>() == Some(&"a defect")));
        assert!(current().is_none());
    }
}
