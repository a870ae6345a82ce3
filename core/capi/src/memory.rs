//! The caller's memory: checks of pointers, objects, and blocks that are divided.

use crate::status::Status;

/// Refuses a pointer that is null or misaligned.
fn check<T>(pointer: *const T) -> Result<(), Status> {
    if pointer.is_null() {
        return Err(Status::NullPointer);
    }
    if !pointer.is_aligned() {
        return Err(Status::Misaligned);
    }
    Ok(())
}

/// Checks a pointer to one element and borrows the element.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to a `T` that nobody changes meanwhile.
pub unsafe fn shared<'a, T>(pointer: *const T) -> Result<&'a T, Status> {
    check(pointer)?;
    // SAFETY: not null, aligned, and the caller vouches for the rest.
    Ok(unsafe { &*pointer })
}

/// Refuses a pointer that is null or misaligned, and a size that memory cannot have.
fn check_count<T>(pointer: *const T, count: usize) -> Result<(), Status> {
    check(pointer)?;
    let fits = count.checked_mul(size_of::<T>()).is_some_and(|size| isize::try_from(size).is_ok());
    if fits { Ok(()) } else { Err(Status::TooMany) }
}

/// Checks a pointer to `count` elements and borrows them. The pointer of an empty list is not looked at.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to `count` elements that nobody changes meanwhile.
pub unsafe fn list<'a, T>(pointer: *const T, count: usize) -> Result<&'a [T], Status> {
    if count == 0 {
        return Ok(&[]);
    }
    check_count(pointer, count)?;
    // SAFETY: not null, aligned, not longer than memory, and the caller vouches for the rest.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// Destination of results: the pointer is checked first, the results are written last.
pub struct Results<T> {
    pointer: *mut T,
    count: usize,
}

impl<T: Copy> Results<T> {
    /// Checks a pointer to room for `count` results.
    ///
    /// # Safety
    /// A pointer that is neither null nor misaligned may be written to, `count` times.
    pub unsafe fn new(pointer: *mut T, count: usize) -> Result<Self, Status> {
        check_count(pointer, count)?;
        Ok(Self { pointer, count })
    }

    /// Writes the result of an index; does nothing if the index is beyond the last.
    pub fn write_at(&self, index: usize, result: T) {
        if index < self.count {
            // SAFETY: `new` was told that there is room for `count`.
            unsafe { self.pointer.add(index).write(result) };
        }
    }

    /// Writes results from the first index on.
    pub fn write(&self, results: impl IntoIterator<Item = T>) {
        results.into_iter().enumerate().for_each(|(index, result)| self.write_at(index, result));
    }
}

/// Object of this library in memory of a public, opaque type. A tag before the object tells that it has been made.
#[repr(C)]
pub struct Tagged<T> {
    tag: u64,
    object: T,
}

impl<T> Tagged<T> {
    /// Tag of the type. Types of different sizes have different tags, so a wrong cast is likely to be detected.
    const TAG: u64 = 0x6f69_6e6f_6721_0000 | size_of::<T>() as u64;

    /// Makes an object in `place`.
    ///
    /// # Safety
    /// A `place` that is neither null nor misaligned points to memory of the type `Public` that only this call uses.
    pub unsafe fn write<Public>(place: *mut Public, object: impl FnOnce() -> Result<T, Status>) -> Result<(), Status> {
        const { assert!(size_of::<Self>() <= size_of::<Public>() && align_of::<Self>() <= align_of::<Public>()) };
        check(place)?;
        let tagged = Self { tag: Self::TAG, object: object()? };
        // SAFETY: not null and aligned; the assertion says that it fits; the caller vouches for the memory.
        unsafe { place.cast::<Self>().write(tagged) };
        Ok(())
    }

    /// Object that has been made in `place`.
    ///
    /// # Safety
    /// A `place` that is neither null nor misaligned points to readable memory of the type `Public` that nobody changes
    /// meanwhile.
    pub unsafe fn get<'a, Public>(place: *const Public) -> Result<&'a T, Status> {
        const { assert!(size_of::<Self>() <= size_of::<Public>() && align_of::<Self>() <= align_of::<Public>()) };
        check(place)?;
        // SAFETY: not null and aligned; the tag is the first field of what `write` has written.
        if unsafe { place.cast::<u64>().read() } != Self::TAG {
            return Err(Status::NotMade);
        }
        // SAFETY: the tag shows that `write` has written an object here.
        Ok(unsafe { &(*place.cast::<Self>()).object })
    }
}

/// Block of the caller's memory from which arrays are taken.
pub struct Block {
    next: *mut u8,
    /// Bytes from `next` on.
    remaining: usize,
}

impl Block {
    /// Checks a pointer to `size` bytes.
    ///
    /// # Safety
    /// A pointer that is not null may be written to and read from over `size` bytes, by nobody else meanwhile.
    pub unsafe fn new(pointer: *mut u8, size: usize) -> Result<Self, Status> {
        check_count(pointer, size)?;
        Ok(Self { next: pointer, remaining: size })
    }

    /// Takes an array of `count` elements; `element` gives the element of each index.
    pub fn take<'a, T: Copy>(&mut self, count: usize, element: impl Fn(usize) -> T) -> Result<&'a mut [T], Status> {
        let gap = self.next.align_offset(align_of::<T>());
        let size = count.checked_mul(size_of::<T>()).and_then(|size| size.checked_add(gap)).ok_or(Status::Memory)?;
        self.remaining = self.remaining.checked_sub(size).ok_or(Status::Memory)?;
        // SAFETY: `remaining` shows that so many bytes follow.
        let array = unsafe { self.next.add(gap) }.cast::<T>();
        for index in 0..count {
            // SAFETY: aligned by the gap, and within the array.
            unsafe { array.add(index).write(element(index)) };
        }
        // SAFETY: the array ends here.
        self.next = unsafe { array.add(count) }.cast();
        // SAFETY: initialised above, and nobody else gets this array.
        Ok(unsafe { core::slice::from_raw_parts_mut(array, count) })
    }
}

/// Bytes that suffice to take `count` elements from a block, whatever its alignment; `None` if they exceed memory.
pub const fn room_for<T>(count: usize) -> Option<usize> {
    match count.checked_mul(size_of::<T>()) {
        Some(size) => size.checked_add(align_of::<T>() - 1),
        None => None,
    }
}
