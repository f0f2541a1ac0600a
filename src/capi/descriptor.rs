//! Descriptors: structs that begin with their size, so that they may grow within an ABI version.
//!
//! A field is only ever appended, in a place that no older version had as padding. A program that was built against an
//! older header states the smaller size; what it does not have keeps its default.

use std::mem::size_of;

use crate::error::{Result, invalid};

/// A struct of the C ABI that begins with its size.
///
/// # Safety
/// `#[repr(C)]`; begins with `struct_size: u32`; every bit pattern is valid for every field; every entry of `SIZES` ends
/// at the end of a field.
pub(super) unsafe trait Descriptor: Default {
    /// Its name in C.
    const NAME: &'static str;
    /// Its initialiser in C.
    const INIT: &'static str;
    /// The sizes it has had: one a minor version that appended to it, the newest last.
    const SIZES: &'static [usize] = &[size_of::<Self>()];
}

/// Implements [`Descriptor`] for a struct, and checks at compile time that its last field ends where it does, so that what
/// will be appended lies in no padding.
macro_rules! descriptor {
    // `since` names the fields that earlier versions ended with.
    ($type:ident, $init:literal, $last:ident: $last_type:ty $(, since $older:ident: $older_type:ty)*) => {
        const _: () = assert!(
            std::mem::offset_of!($type, $last) + size_of::<$last_type>() == size_of::<$type>(),
            concat!(stringify!($type), " ends with padding"),
        );
        const _: () = assert!(std::mem::offset_of!($type, struct_size) == 0);
        // SAFETY: `repr(C)` with `struct_size` first, made of integers, floats and raw pointers only; each size ends at a field's end.
        unsafe impl $crate::capi::descriptor::Descriptor for $type {
            const NAME: &'static str = stringify!($type);
            const INIT: &'static str = $init;
            const SIZES: &'static [usize] = &[
                $(std::mem::offset_of!($type, $older) + size_of::<$older_type>(),)*
                size_of::<$type>(),
            ];
        }
    };
}
pub(super) use descriptor;

/// Checks a size that a program has stated.
fn check_size<T: Descriptor>(name: &str, stated: u32) -> Result<usize> {
    let size = stated as usize;
    if T::SIZES.contains(&size) {
        return Ok(size);
    }
    let known = T::SIZES
        .iter()
        .map(usize::to_string)
        .collect::<Vec<_>>()
        .join(", ");
    invalid!(
        "{name}: struct_size {stated} is not that of {} ({known}); begin with {}",
        T::NAME,
        T::INIT
    )
}

/// Copies what a program has given, `name` being what an error calls it; fields that its version lacks have their default.
pub(super) unsafe fn read<T: Descriptor>(name: &str, pointer: *const T) -> Result<T> {
    if pointer.is_null() {
        return invalid!("{name} is NULL");
    }
    // SAFETY: the host points to a descriptor, which begins with its size.
    let stated = unsafe { pointer.cast::<u32>().read_unaligned() };
    let size = check_size::<T>(name, stated)?;
    let mut value = T::default();
    // SAFETY: `size` is at most that of `T` and ends at a field's end; the host has that many bytes, as it states.
    unsafe {
        std::ptr::copy_nonoverlapping(pointer.cast::<u8>(), (&raw mut value).cast::<u8>(), size)
    };
    Ok(value)
}

/// As [`read`] where the pointer may be NULL.
pub(super) unsafe fn read_optional<T: Descriptor>(
    name: &str,
    pointer: *const T,
) -> Result<Option<T>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the pointer is not NULL, and the host's promise is passed on.
    unsafe { read(name, pointer) }.map(Some)
}

/// Copies an array of descriptors, all of one version: `most` at most.
pub(super) unsafe fn read_array<T: Descriptor>(
    name: &str,
    pointer: *const T,
    count: u32,
    most: usize,
) -> Result<Vec<T>> {
    if count == 0 {
        return Ok(Vec::new());
    }
    if count as usize > most {
        return invalid!("{count} {name}: at most {most} are taken");
    }
    if pointer.is_null() {
        return invalid!("{name} is NULL, but {count} are announced");
    }
    // SAFETY: the host points to at least one descriptor, which begins with its size.
    let stride = check_size::<T>(&format!("{name}[0]"), unsafe {
        pointer.cast::<u32>().read_unaligned()
    })?;
    let element = |at: usize| {
        // SAFETY: the host's array has `count` elements of `stride` bytes, and `at` is below `count`.
        let element = unsafe { pointer.cast::<u8>().add(at * stride) };
        let name = format!("{name}[{at}]");
        // SAFETY: the element begins with its size.
        let stated = unsafe { element.cast::<u32>().read_unaligned() };
        if stated as usize != stride {
            return invalid!(
                "{name}: struct_size {stated} differs from that of the first, {stride}"
            );
        }
        // SAFETY: as above; the size is one that `T` has.
        unsafe { read(&name, element.cast::<T>()) }
    };
    (0..count as usize).map(element).collect()
}

/// Fills a struct that a program has initialised: as much of it as its version has.
pub(super) unsafe fn write<T: Descriptor>(name: &str, pointer: *mut T, value: &T) -> Result<()> {
    if pointer.is_null() {
        return invalid!("{name} is NULL");
    }
    // SAFETY: the host points to a descriptor, which begins with its size.
    let size = check_size::<T>(name, unsafe { pointer.cast::<u32>().read_unaligned() })?;
    let skip = size_of::<u32>();
    // SAFETY: the host has `size` bytes, as it states; `value` has no fewer. Its own size stays as the program wrote it.
    unsafe {
        let from = std::ptr::from_ref(value).cast::<u8>().add(skip);
        std::ptr::copy_nonoverlapping(from, pointer.cast::<u8>().add(skip), size - skip);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[repr(C)]
    #[derive(Debug, Clone, Copy, PartialEq)]
    struct Grown {
        struct_size: u32,
        old: u32,
        appended: u64,
    }

    impl Default for Grown {
        fn default() -> Self {
            Self {
                struct_size: size_of::<Self>() as u32,
                old: 0,
                appended: 40,
            }
        }
    }

    /// The size before `appended` was.
    const MINIMUM_SIZE: usize = 8;

    // SAFETY: `repr(C)`, integers only; both sizes end at a field's end.
    unsafe impl Descriptor for Grown {
        const NAME: &'static str = "Grown";
        const INIT: &'static str = "GROWN_INIT";
        const SIZES: &'static [usize] = &[MINIMUM_SIZE, size_of::<Self>()];
    }

    #[test]
    fn an_older_programs_struct_gets_defaults_for_what_it_lacks() {
        let old = [MINIMUM_SIZE as u32, 7];
        // SAFETY: eight bytes, as stated.
        let read: Grown = unsafe { read("grown", old.as_ptr().cast()) }.unwrap();
        assert_eq!((read.old, read.appended), (7, 40));
    }

    #[test]
    fn an_older_programs_array_is_read_by_its_own_stride() {
        let old = [MINIMUM_SIZE as u32, 1, MINIMUM_SIZE as u32, 2];
        // SAFETY: two elements of eight bytes, as stated.
        let read: Vec<Grown> = unsafe { read_array("grown", old.as_ptr().cast(), 2, 10) }.unwrap();
        assert_eq!(
            read.iter().map(|g| (g.old, g.appended)).collect::<Vec<_>>(),
            [(1, 40), (2, 40)]
        );
    }

    #[test]
    fn an_older_programs_struct_is_not_written_beyond_its_end() {
        let mut old = [MINIMUM_SIZE as u32, 1, 77, 78];
        let value = Grown {
            old: 5,
            appended: 6,
            ..Grown::default()
        };
        // SAFETY: sixteen bytes, of which eight are stated.
        unsafe { write("grown", old.as_mut_ptr().cast(), &value) }.unwrap();
        assert_eq!(old, [MINIMUM_SIZE as u32, 5, 77, 78]);
    }

    #[test]
    fn a_size_between_two_versions_is_refused_by_name() {
        let odd = [12u32, 1, 2, 3];
        // SAFETY: sixteen bytes.
        let error = unsafe { read::<Grown>("grown", odd.as_ptr().cast()) }
            .unwrap_err()
            .to_string();
        assert_eq!(
            error,
            "grown: struct_size 12 is not that of Grown (8, 16); begin with GROWN_INIT"
        );
    }
}
