//! Where a tape keeps its numbers while it runs.

use std::mem::MaybeUninit;

/// Registers that an instruction reads and writes, with indices of type `R`.
pub(super) trait Registers<T, R> {
    fn read(&self, register: R) -> T;
    fn write(&mut self, register: R, value: T);
    /// Writes consecutive registers, the first ones of all.
    fn load(&mut self, first: usize, values: &[T]);
}

/// Number of registers that a byte can name.
pub(super) const STACK_REGISTERS: usize = 256;

/// Registers on the stack, none of them initialised.
///
/// Whoever makes one promises that no register is used that is not there, so no access needs a check; and clearing the
/// registers would cost more than running a short model.
pub(super) struct Stack<T, const N: usize> {
    slots: [MaybeUninit<T>; N],
}

impl<T: Copy, const N: usize> Stack<T, N> {
    /// # Safety
    ///
    /// No register may be read before it is written, and none from `N` on may be read or written.
    /// [`Tape`](super::Tape) checks this once for its instructions when it is made.
    #[inline(always)]
    pub unsafe fn new() -> Self {
        Self { slots: [const { MaybeUninit::uninit() }; N] }
    }
}

impl<T: Copy, const N: usize> Registers<T, u8> for Stack<T, N> {
    #[inline(always)]
    fn read(&self, register: u8) -> T {
        // SAFETY: whoever called `new` promised that the register was written before.
        unsafe { self.slots.get_unchecked(register as usize).assume_init() }
    }

    #[inline(always)]
    fn write(&mut self, register: u8, value: T) {
        // SAFETY: as above.
        unsafe { *self.slots.get_unchecked_mut(register as usize) = MaybeUninit::new(value) };
    }

    #[inline(always)]
    fn load(&mut self, first: usize, values: &[T]) {
        for (slot, &value) in self.slots[first..first + values.len()].iter_mut().zip(values) {
            slot.write(value);
        }
    }
}

/// Any number of registers, for models that the stack should not hold.
impl<T: Copy> Registers<T, u16> for Vec<T> {
    #[inline(always)]
    fn read(&self, register: u16) -> T {
        self[register as usize]
    }

    #[inline(always)]
    fn write(&mut self, register: u16, value: T) {
        self[register as usize] = value;
    }

    fn load(&mut self, first: usize, values: &[T]) {
        self[first..first + values.len()].copy_from_slice(values);
    }
}
