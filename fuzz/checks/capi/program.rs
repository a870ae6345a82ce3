//! Bytes as a program of calls: each operation is a letter, each argument the next byte.

/// The bytes of a program that are still to be read.
pub struct Program<'a>(pub &'a [u8]);

impl<'a> Program<'a> {
    pub fn next(&mut self) -> Option<u8> {
        let (&first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(first)
    }

    /// The next byte; 0 beyond the end.
    pub fn byte(&mut self) -> u8 {
        self.next().unwrap_or(0)
    }

    /// A whole number from 0 to `n` − 1.
    pub fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }

    /// The next `n` bytes, or fewer at the end.
    pub fn bytes(&mut self, n: usize) -> &'a [u8] {
        let (head, rest) = self.0.split_at(n.min(self.0.len()));
        self.0 = rest;
        head
    }

    /// A number in the range, in 250 steps, or one of five that are out of range.
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        match self.byte() {
            255 => f64::NAN,
            254 => f64::INFINITY,
            253 => -1.0,
            252 => f64::MIN_POSITIVE,
            251 => 1e300,
            step => low + (high - low) * f64::from(step) / 250.0,
        }
    }

    /// The fault in the pointers of a call, by the next byte. A dot or a digit stands for none. The `n`-th letter from
    /// @ makes the `n`-th pointer NULL, the `n`-th letter from H misaligns it.
    pub fn faults(&mut self) -> Faults {
        let code = self.byte();
        let place = (code & 0xc0 == 0x40).then_some(usize::from(code & 7));
        Faults { place, misaligned: code & 8 != 0, seen: 0, hit: false }
    }
}

/// A fault in one pointer of a call, or none.
pub struct Faults {
    place: Option<usize>,
    misaligned: bool,
    seen: usize,
    hit: bool,
}

impl Faults {
    /// No fault.
    pub fn none() -> Self {
        Self { place: None, misaligned: false, seen: 0, hit: false }
    }

    /// A pointer that the call needs.
    pub fn pass<T>(&mut self, pointer: *const T) -> *const T {
        let here = self.place == Some(self.seen);
        self.seen += 1;
        match (here, self.misaligned) {
            (false, _) => pointer,
            (true, false) => {
                self.hit = true;
                std::ptr::null()
            }
            (true, true) if align_of::<T>() > 1 => {
                self.hit = true;
                pointer.cast::<u8>().wrapping_add(1).cast()
            }
            (true, true) => pointer,
        }
    }

    pub fn pass_mut<T>(&mut self, pointer: *mut T) -> *mut T {
        self.pass(pointer.cast_const()).cast_mut()
    }

    /// The pointer to a list, which the call needs unless the list is empty.
    pub fn list<T>(&mut self, list: &[T]) -> *const T {
        let before = self.hit;
        let pointer = self.pass(list.as_ptr());
        self.hit = before || (self.hit && !list.is_empty());
        pointer
    }

    /// Whether the call must be refused.
    pub fn hit(&self) -> bool {
        self.hit
    }
}
