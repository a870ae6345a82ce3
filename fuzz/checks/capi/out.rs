//! Memory for results that shows whether it has been written.

use goniochrome_capi::status::Status;
use std::mem::MaybeUninit;

const UNTOUCHED: u8 = 0xa5;

/// Memory for some results, and for one more that no call may write.
pub struct Out<T>(Box<[MaybeUninit<T>]>);

impl<T> Out<T> {
    pub fn new(count: usize) -> Self {
        let mut places = Box::new_uninit_slice(count + 1);
        // SAFETY: bytes of the slice itself.
        unsafe { places.as_mut_ptr().cast::<u8>().write_bytes(UNTOUCHED, size_of_val(&*places)) };
        Self(places)
    }

    pub fn pointer(&mut self) -> *mut T {
        self.0.as_mut_ptr().cast()
    }

    pub fn object(&self) -> *const T {
        self.0.as_ptr().cast()
    }

    fn is_untouched(places: &[MaybeUninit<T>]) -> bool {
        // SAFETY: `new` has written all bytes.
        let bytes = unsafe { std::slice::from_raw_parts(places.as_ptr().cast::<u8>(), size_of_val(places)) };
        bytes.iter().all(|byte| *byte == UNTOUCHED)
    }

    /// Whether the call succeeded. Checks that it wrote nothing if it failed, and never beyond the end.
    pub fn succeeded(&self, status: Status) -> bool {
        let (spare, places) = self.0.split_last().expect("one more");
        assert!(Self::is_untouched(std::slice::from_ref(spare)), "written beyond the end");
        assert!(status == Status::Ok || Self::is_untouched(places), "written in spite of {status:?}");
        status == Status::Ok
    }

    /// The results of a call that succeeded.
    pub fn results(&self) -> &[T] {
        let (_, places) = self.0.split_last().expect("one more");
        // SAFETY: any bytes are valid numbers, and `new` has written all.
        unsafe { std::slice::from_raw_parts(places.as_ptr().cast(), places.len()) }
    }
}
