//! Starting points of rays: a scrambled low-discrepancy sequence over the unit square.
//!
//! These are the first two dimensions of Sobol's sequence with Owen scrambling by hashing (L. Burley, "Practical
//! Hash-based Owen Scrambling", JCGT 9(4), 2020). Each seed gives an independent, unbiased estimate, so the standard
//! deviation over seeds is the true standard error. The first 2^k points are evenly spread for every k.

/// Point `index` of the sequence `seed`, in [0, 1)².
#[must_use]
pub fn sobol(index: u32, seed: u32) -> [f64; 2] {
    let index = owen(index, hash(seed));
    let x = owen(index.reverse_bits(), hash(seed ^ 0x5bd1_e995));
    let y = owen(second_dimension(index), hash(seed ^ 0x9e37_79b9));
    [x, y].map(|bits| f64::from(bits) / 4_294_967_296.0)
}

/// Second dimension of Sobol's sequence: its direction numbers are Pascal's triangle modulo 2.
///
/// Binomial coefficients are odd where the bits of one number are among those of the other (Lucas), so that each bit is
/// the sum of all bits of the index at places that contain its own: five steps, one for each bit of a place.
fn second_dimension(mut index: u32) -> u32 {
    for (step, without) in [(16, 0x0000_ffff), (8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)] {
        index ^= index >> step & without;
    }
    index.reverse_bits()
}

/// Nested uniform scrambling: a hash of the bits above a bit decides whether it flips.
fn owen(bits: u32, seed: u32) -> u32 {
    let mut x = bits.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// Integer hash of 32 bits.
fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x21f0_aaad);
    x ^= x >> 15;
    x = x.wrapping_mul(0xd35a_2d97);
    x ^ (x >> 15)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::random::Random;

    #[test]
    fn every_elementary_interval_holds_one_point() {
        // In a (0, 2)-sequence each box of area 1/256 contains one of 256 points, whatever its shape.
        for seed in [0, 1, 77] {
            for log_columns in 0..=8u32 {
                let (columns, rows) = (1usize << log_columns, 256usize >> log_columns);
                let mut seen = [false; 256];
                for index in 0..256 {
                    let [x, y] = sobol(index, seed);
                    let index_of_box = (x * columns as f64) as usize * rows + (y * rows as f64) as usize;
                    assert!(!seen[index_of_box], "seed {seed}, {columns} columns");
                    seen[index_of_box] = true;
                }
            }
        }
    }

    #[test]
    fn the_second_dimension_adds_up_the_rows_of_pascals_triangle() {
        for index in [0, 1, 2, 3, 0x0001_0000, 0x8000_0000, 0xdead_beef, u32::MAX] {
            let (mut direction, mut bits) = (1u32 << 31, 0);
            for place in 0..32 {
                bits ^= if index >> place & 1 == 1 { direction } else { 0 };
                direction ^= direction >> 1;
            }
            assert_eq!(second_dimension(index), bits, "{index:x}");
        }
    }

    #[test]
    fn random_numbers_are_uniform() {
        let mut random = Random::new(3, 7);
        let (mut sum, mut squares) = (0.0, 0.0);
        let count = 100_000;
        for _ in 0..count {
            let x = random.next();
            assert!((0.0..1.0).contains(&x));
            sum += x;
            squares += x * x;
        }
        // The standard errors of the mean and of the second moment are 1e-3.
        assert!((sum / f64::from(count) - 0.5).abs() < 5e-3);
        assert!((squares / f64::from(count) - 1.0 / 3.0).abs() < 5e-3);
    }

    #[test]
    fn seeds_differ() {
        assert!((sobol(3, 1)[0] - sobol(3, 2)[0]).abs() > 1e-6);
    }
}
