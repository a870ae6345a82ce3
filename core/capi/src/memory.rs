//! The caller's memory: pointers that are checked before they are followed, and objects in it.

use crate::status::Status;

fn check<T>(pointer: *const T) -> Result<(), Status> {
    if pointer.is_null() {
        return Err(Status::NullPointer);
    }
    if !pointer.is_aligned() {
        return Err(Status::Misaligned);
    }
    Ok(())
}

/// What a pointer points to.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to a `T` that nobody changes meanwhile.
pub unsafe fn shared<'a, T>(pointer: *const T) -> Result<&'a T, Status> {
    check(pointer)?;
    // SAFETY: not null, aligned, and the caller vouches for the rest.
    Ok(unsafe { &*pointer })
}

fn check_count<T>(pointer: *const T, count: usize) -> Result<(), Status> {
    check(pointer)?;
    let fits = count.checked_mul(size_of::<T>()).is_some_and(|size| isize::try_from(size).is_ok());
    if fits { Ok(()) } else { Err(Status::TooMany) }
}

/// `count` elements; any pointer will do for none.
///
/// # Safety
/// As for [`shared`], for each element.
pub unsafe fn list<'a, T>(pointer: *const T, count: usize) -> Result<&'a [T], Status> {
    if count == 0 {
        return Ok(&[]);
    }
    check_count(pointer, count)?;
    // SAFETY: not null, aligned, not longer than memory, and the caller vouches for the rest.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// Where results go: checked at once, written at the end.
pub struct Results<T> {
    pointer: *mut T,
    count: usize,
}

impl<T: Copy> Results<T> {
    /// Room for `count` results.
    ///
    /// # Safety
    /// A pointer that is neither null nor misaligned may be written to, `count` times.
    pub unsafe fn new(pointer: *mut T, count: usize) -> Result<Self, Status> {
        check_count(pointer, count)?;
        Ok(Self { pointer, count })
    }

    /// Writes one result; nothing beyond the last.
    pub fn write_at(&self, place: usize, result: T) {
        if place < self.count {
            // SAFETY: `new` was told that there is room for `count`.
            unsafe { self.pointer.add(place).write(result) };
        }
    }

    /// Writes the results from the first.
    pub fn write(&self, results: impl IntoIterator<Item = T>) {
        results.into_iter().enumerate().for_each(|(place, result)| self.write_at(place, result));
    }
}

/// An object of this library in memory of a published type, behind a mark that says it is there.
#[repr(C)]
pub struct Made<T> {
    mark: u64,
    object: T,
}

impl<T> Made<T> {
    /// Different for types of different size, so that a mistaken cast is likely to be seen.
    const MARK: u64 = 0x6f69_6e6f_6721_0000 | size_of::<T>() as u64;

    /// Makes an object in `place`.
    ///
    /// # Safety
    /// `place` points to memory of the type `Published`, which only this call uses.
    pub unsafe fn make<Published>(
        place: *mut Published,
        object: impl FnOnce() -> Result<T, Status>,
    ) -> Result<(), Status> {
        const { assert!(size_of::<Self>() <= size_of::<Published>() && align_of::<Self>() <= align_of::<Published>()) };
        check(place)?;
        let made = Self { mark: Self::MARK, object: object()? };
        // SAFETY: not null and aligned; the assertion says that it fits; the caller vouches for the memory.
        unsafe { place.cast::<Self>().write(made) };
        Ok(())
    }

    /// The object that was made in `place`.
    ///
    /// # Safety
    /// `place` points to readable memory of the type `Published` that nobody changes meanwhile.
    pub unsafe fn of<'a, Published>(place: *const Published) -> Result<&'a T, Status> {
        const { assert!(size_of::<Self>() <= size_of::<Published>() && align_of::<Self>() <= align_of::<Published>()) };
        check(place)?;
        // SAFETY: not null and aligned; the mark is the first field of what `make` has written.
        if unsafe { place.cast::<u64>().read() } != Self::MARK {
            return Err(Status::NotMade);
        }
        // SAFETY: the mark says that `make` has written an object here.
        Ok(unsafe { &(*place.cast::<Self>()).object })
    }
}

/// A block of the caller's memory from which pieces are taken.
pub struct Block {
    next: *mut u8,
    left: usize,
}

impl Block {
    /// All of the memory.
    ///
    /// # Safety
    /// A pointer that is not null may be written to and read from over `size` bytes, by nobody else meanwhile.
    pub unsafe fn new(pointer: *mut u8, size: usize) -> Result<Self, Status> {
        check_count(pointer, size)?;
        Ok(Self { next: pointer, left: size })
    }

    /// Takes `count` elements, each set by `element`.
    pub fn take<'a, T: Copy>(&mut self, count: usize, element: impl Fn(usize) -> T) -> Result<&'a mut [T], Status> {
        let gap = self.next.align_offset(align_of::<T>());
        let size = count.checked_mul(size_of::<T>()).and_then(|size| size.checked_add(gap)).ok_or(Status::Memory)?;
        self.left = self.left.checked_sub(size).ok_or(Status::Memory)?;
        // SAFETY: `left` says that so much follows.
        let piece = unsafe { self.next.add(gap) }.cast::<T>();
        for place in 0..count {
            // SAFETY: aligned by the gap, and within the piece.
            unsafe { piece.add(place).write(element(place)) };
        }
        // SAFETY: the piece ends here.
        self.next = unsafe { piece.add(count) }.cast();
        // SAFETY: initialised above, and nobody else gets this piece.
        Ok(unsafe { core::slice::from_raw_parts_mut(piece, count) })
    }
}

/// Bytes that suffice to take `count` elements from a block, wherever it lies.
pub const fn room_for<T>(count: usize) -> Option<usize> {
    match count.checked_mul(size_of::<T>()) {
        Some(size) => size.checked_add(align_of::<T>() - 1),
        None => None,
    }
}
