//! goniochrome: how layered and micro-structured surfaces reflect light of each wavelength.
#![no_std]

pub mod interface;
pub mod medium;
