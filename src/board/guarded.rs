//! What RTIC guards, as the portable tasks see it.

use reflex::tasks::Lock;
use rtic::Mutex;

/// A resource.
pub struct Guarded<M>(pub M);

impl<M: Mutex> Lock for Guarded<M> {
    type Target = M::T;

    fn lock<T>(&mut self, step: impl FnOnce(&mut M::T) -> T) -> T {
        self.0.lock(step)
    }
}

/// A resource that is a reference: the autopilot, which is too large to be moved.
pub struct Piloted<M>(pub M);

impl<P: 'static, M: Mutex<T = &'static mut P>> Lock for Piloted<M> {
    type Target = P;

    fn lock<T>(&mut self, step: impl FnOnce(&mut P) -> T) -> T {
        self.0.lock(|pilot| step(pilot))
    }
}
