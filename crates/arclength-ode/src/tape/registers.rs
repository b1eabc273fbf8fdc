//! Where a tape keeps its numbers while it runs.

use std::mem::MaybeUninit;

/// Does something for every index, without a loop where there are few: preparing one takes longer than running a short model.
macro_rules! for_few {
    ($count:expr, $index:ident => $body:expr) => {
        match $count {
            0 => {}
            1 => for_few!(@ $index => $body, 0),
            2 => for_few!(@ $index => $body, 0, 1),
            3 => for_few!(@ $index => $body, 0, 1, 2),
            4 => for_few!(@ $index => $body, 0, 1, 2, 3),
            5 => for_few!(@ $index => $body, 0, 1, 2, 3, 4),
            count => {
                for $index in 0..count {
                    $body;
                }
            }
        }
    };
    (@ $index:ident => $body:expr, $($number:literal),*) => {{
        $({
            let $index: usize = $number;
            $body;
        })*
    }};
}
pub(super) use for_few;

/// Registers that an instruction reads and writes, with indices of type `R`.
pub(super) trait Registers<T, R> {
    fn read(&self, register: R) -> T;
    fn write(&mut self, register: R, value: T);
    /// Writes consecutive registers.
    fn load<S: Copy>(&mut self, first: usize, values: &[S], convert: impl Fn(S) -> T);
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
    pub(super) unsafe fn new() -> Self {
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
    fn load<S: Copy>(&mut self, first: usize, values: &[S], convert: impl Fn(S) -> T) {
        let count = values.len();
        let slots = &mut self.slots[first..][..count];
        for_few!(count, index => slots[index].write(convert(values[index])));
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

    fn load<S: Copy>(&mut self, first: usize, values: &[S], convert: impl Fn(S) -> T) {
        for (register, value) in self[first..first + values.len()].iter_mut().zip(values) {
            *register = convert(*value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_register_on_the_stack_holds_what_was_written() {
        for count in 0..=7 {
            // SAFETY: of the eight registers each is read after it was written.
            let mut registers = unsafe { Stack::<f64, 8>::new() };
            let values: Vec<f64> = (0..count).map(f64::from).collect();
            registers.load(0, &values, |value| value);
            registers.write(7, 10.0);
            assert!(values.iter().enumerate().all(|(index, value)| registers.read(index as u8) == *value));
            assert_eq!(registers.read(7), 10.0);
        }
    }

    #[test]
    #[should_panic(expected = "range")]
    fn more_than_there_is_room_for_is_not_loaded() {
        // SAFETY: nothing is read.
        let mut registers = unsafe { Stack::<f64, 8>::new() };
        registers.load(5, &[1.0; 4], |value| value);
    }
}
