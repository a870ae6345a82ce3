//! goniochrome: how layered and micro-structured surfaces reflect light of each wavelength.
#![no_std]

pub mod cell;
pub mod coherence;
pub mod colour;
pub mod complex;
pub mod interface;
pub mod lanes;
pub mod layers;
pub mod medium;
pub mod stack;
pub mod trace;
pub mod turns;
