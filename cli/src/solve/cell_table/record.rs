//! The record of one incident direction in a checkpoint.

use crate::table::scatter::Energy;
use crate::table::statistics::MeanWithError;

/// Floating-point numbers in an [`Energy`]; its rays are an integer.
const ENERGIES: usize = 8;

/// The part of a table that belongs to one incident direction.
pub(super) struct DirectionRecord<'t> {
    pub values: &'t mut [f32],
    pub error: &'t mut [f32],
    pub energy: &'t mut Energy,
}

impl DirectionRecord<'_> {
    /// The number of bytes that [`DirectionRecord::write`] returns.
    pub fn bytes(places: usize, wavelengths: usize) -> usize {
        places * (wavelengths + 1) * size_of::<f32>() + ENERGIES * size_of::<f64>() + size_of::<u64>()
    }

    /// The bytes for a checkpoint, little endian: energy, values, errors.
    pub fn write(&self) -> Vec<u8> {
        let Energy { reflected, transmitted, absorbed, truncated, imbalance, without_interference, rays } =
            *self.energy;
        let energy: [f64; ENERGIES] = [
            reflected.value,
            reflected.std_error,
            transmitted,
            absorbed,
            truncated,
            imbalance.value,
            imbalance.std_error,
            without_interference,
        ];
        let mut bytes = Vec::with_capacity(Self::bytes(self.error.len(), self.values.len() / self.error.len()));
        bytes.extend(energy.map(f64::to_le_bytes).as_flattened());
        bytes.extend(rays.to_le_bytes());
        bytes.extend(self.values.iter().chain(&*self.error).flat_map(|x| x.to_le_bytes()));
        bytes
    }

    /// Reads the bytes that [`DirectionRecord::write`] returned.
    pub fn read(&mut self, bytes: &[u8]) {
        let (energy, floats) = bytes.split_at((ENERGIES + 1) * size_of::<u64>());
        let (words, _) = energy.as_chunks();
        let number = |i: usize| f64::from_le_bytes(words[i]);
        *self.energy = Energy {
            reflected: MeanWithError { value: number(0), std_error: number(1) },
            transmitted: number(2),
            absorbed: number(3),
            truncated: number(4),
            imbalance: MeanWithError { value: number(5), std_error: number(6) },
            without_interference: number(7),
            rays: u64::from_le_bytes(words[ENERGIES]),
        };
        let (floats, _) = floats.as_chunks();
        let numbers = self.values.iter_mut().chain(&mut *self.error);
        numbers.zip(floats).for_each(|(number, bytes)| *number = f32::from_le_bytes(*bytes));
    }
}
