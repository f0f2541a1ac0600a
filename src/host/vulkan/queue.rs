//! The host's queue: its lock, and the semaphores of a submission.

use ash::vk;

use crate::error::{Result, invalid};

/// The host's lock around its queue. Both functions may be called on any thread, always in turns on one.
pub trait QueueLock: Send + Sync {
    /// Waits until no other thread uses the queue, and keeps them from it.
    fn lock(&self);
    /// Lets other threads use the queue again.
    fn unlock(&self);
}

/// The host's lock, held.
pub(super) struct Held<'a>(Option<&'a dyn QueueLock>);

pub(super) fn hold(lock: Option<&dyn QueueLock>) -> Held<'_> {
    if let Some(lock) = lock {
        lock.lock();
    }
    Held(lock)
}

impl Drop for Held<'_> {
    fn drop(&mut self) {
        if let Some(lock) = self.0 {
            lock.unlock();
        }
    }
}

/// A semaphore of the host's, to wait on or to signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Semaphore {
    /// The host's.
    pub semaphore: vk::Semaphore,
    /// A timeline semaphore's value; `None` for a binary semaphore.
    pub value: Option<u64>,
}

/// The most semaphores of one list.
const MOST: usize = 64;

pub(super) fn validate(name: &str, semaphores: &[Semaphore]) -> Result<()> {
    if semaphores.len() > MOST {
        return invalid!(
            "{} {name}: one submission takes at most {MOST}",
            semaphores.len()
        );
    }
    for (at, semaphore) in semaphores.iter().enumerate() {
        if semaphore.semaphore == vk::Semaphore::null() {
            return invalid!("{name}[{at}]: the semaphore is NULL");
        }
        if semaphores[..at]
            .iter()
            .any(|other| other.semaphore == semaphore.semaphore)
        {
            return invalid!("{name}[{at}]: the semaphore is in the list already");
        }
    }
    Ok(())
}
