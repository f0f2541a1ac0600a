//! Arrays and single values from a host's memory. Counts are checked before a slice is made of them.

use std::mem::MaybeUninit;

use bytemuck::AnyBitPattern;

use crate::error::{Result, invalid};

/// A host's array of `count` elements, of which `most` are taken at most. NULL is no array if the count is 0.
pub(super) unsafe fn slice<'a, T: AnyBitPattern>(
    name: &str,
    pointer: *const T,
    count: u64,
    most: usize,
) -> Result<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    if count > most as u64 || count > isize::MAX as u64 / size_of::<T>().max(1) as u64 {
        return invalid!("{name}: {count} are announced; at most {most} are taken");
    }
    check(name, pointer)?;
    // SAFETY: not NULL, aligned, no larger than the address space; the host has that many elements, of which any bits do.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count as usize) })
}

/// As [`slice`], or `None` for NULL whatever the count.
pub(super) unsafe fn optional_slice<'a, T: AnyBitPattern>(
    name: &str,
    pointer: *const T,
    count: usize,
) -> Result<Option<&'a [T]>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the host's promise is passed on.
    unsafe { slice(name, pointer, count as u64, count) }.map(Some)
}

/// `N` numbers.
pub(super) unsafe fn array<T: AnyBitPattern, const N: usize>(
    name: &str,
    pointer: *const T,
) -> Result<[T; N]> {
    // SAFETY: the host's promise is passed on.
    let values = unsafe { slice(name, pointer, N as u64, N) }?;
    Ok(std::array::from_fn(|at| values[at]))
}

/// Checks the bytes that a host states an array to have against `expected` elements; `whose` says whose they are.
pub(super) fn check_bytes<T>(name: &str, size: u64, expected: usize, whose: &str) -> Result<()> {
    let needed = (expected as u64).saturating_mul(size_of::<T>() as u64);
    if size != needed {
        return invalid!("{name}: {size} bytes are given; {whose} {needed}");
    }
    Ok(())
}

/// Where a result goes. Written at the end, when nothing can fail any more.
pub(super) unsafe fn output<'a, T>(name: &str, pointer: *mut T) -> Result<&'a mut MaybeUninit<T>> {
    check(name, pointer)?;
    // SAFETY: not NULL, aligned; the host has room for one.
    Ok(unsafe { &mut *pointer.cast::<MaybeUninit<T>>() })
}

/// Where `count` results go; NULL for none of them.
pub(super) unsafe fn outputs<'a, T>(
    name: &str,
    pointer: *mut T,
    count: usize,
) -> Result<&'a mut [MaybeUninit<T>]> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(name, pointer)?;
    if count > isize::MAX as usize / size_of::<T>().max(1) {
        return invalid!("{name}: {count} are more than memory holds");
    }
    // SAFETY: not NULL, aligned, no larger than the address space; the host has room for `count`.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer.cast::<MaybeUninit<T>>(), count) })
}

/// Fills what [`outputs`] gave.
pub(super) fn fill<T>(out: &mut [MaybeUninit<T>], values: impl IntoIterator<Item = T>) {
    out.iter_mut()
        .zip(values)
        .for_each(|(to, value)| *to = MaybeUninit::new(value));
}

/// Checks that a pointer points somewhere, and is aligned.
fn check<T>(name: &str, pointer: *const T) -> Result<()> {
    if pointer.is_null() {
        return invalid!("{name} is NULL");
    }
    if !pointer.is_aligned() {
        return invalid!(
            "{name} is {pointer:p}, which is no multiple of {}",
            align_of::<T>()
        );
    }
    Ok(())
}

/// A flag that is 0 or 1.
pub(super) fn flag(name: &str, value: u32) -> Result<bool> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => invalid!("{name} {value} is neither 0 nor 1"),
    }
}

/// Bits of which only those of `known` may be set.
pub(super) fn flags(name: &str, value: u32, known: u32) -> Result<u32> {
    if value & !known != 0 {
        return invalid!("{name} {value:#x} has unknown bits ({:#x})", value & !known);
    }
    Ok(value)
}

/// A field that has no meaning yet.
pub(super) fn reserved(name: &str, value: u32) -> Result<()> {
    if value != 0 {
        return invalid!("{name}.reserved is {value}; it must be 0");
    }
    Ok(())
}
