//! The memory-bandwidth bound: a pass that reads and writes the bytes of a step and computes nothing,
//! after the kernels of J. McCalpin's STREAM (1995).

/// Arrays with as many bytes as a step of `n` bodies reads and writes.
pub struct Traffic {
    only_read: Vec<u64>,
    updated: Vec<u64>,
    sum: u64,
}

impl Traffic {
    /// Creates arrays for `n` bodies, with the number of bytes read (including those written) and written per body.
    pub fn new(n: usize, (read, written): (usize, usize)) -> Self {
        let words = |bytes: usize| vec![1_u64; n * bytes / 8];
        Self {
            only_read: words(read - written),
            updated: words(written),
            sum: 0,
        }
    }

    /// Runs one pass.
    pub fn pass(&mut self) {
        let sum = self
            .only_read
            .iter()
            .fold(0, |a: u64, &x| a.wrapping_add(x));
        self.sum = core::hint::black_box(sum);
        let add = core::hint::black_box(1);
        for x in &mut self.updated {
            *x = x.wrapping_add(add);
        }
    }
}
