use std::hint::black_box;

use goniochrome::optics::interface::Model;
use goniochrome::optics::stack::{PreparedStack, PreparedStackArrays};
use goniochrome::simd::lanes::Lanes;

use super::{Visit, Work};
use crate::{MAX_PLANES, beetle, group};

/// The closed form of the 20-layer stack at 30 degrees: preparing the stack, and the recursion.
///
/// # Panics
/// If a result is wrong.
pub fn stack<V: Lanes>(visit: Visit<'_>) {
    let stack = beetle();
    let amount = (V::WIDTH * stack.layers.len()) as f64;
    let work = |name| Work { stage: "stack", name, unit: "wavelength·layers", amount };
    stack.with::<V, _>(&group::<V>(), |stack, media| {
        let mut memory = Box::new(PreparedStackArrays::<V, MAX_PLANES>::new());
        visit(&work("prepare"), &mut || {
            black_box(PreparedStack::new(stack, media, black_box(0.5), Model::Physical, memory.memory()).model());
        });
    });
    stack.with_prepared::<V, _>(0.5, &group::<V>(), |prepared| {
        let r = prepared.reflectance(prepared.reflection()).s.lane(0);
        assert!((0.0..1.0).contains(&r));
        visit(&work("reflection"), &mut || {
            black_box(black_box(prepared).reflection());
        });
        visit(&work("response"), &mut || {
            black_box(black_box(prepared).response());
        });
        visit(&work("response and rounding"), &mut || {
            black_box(black_box(prepared).response_and_rounding());
        });
    });
}
