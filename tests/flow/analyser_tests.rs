use std::path::Path;

use super::uses::Crate;

/// Faults of a crate with these files, of which the first is `lib.rs`.
fn faults(files: &[(&str, &str)]) -> Vec<String> {
    parse(files).faults()
}

fn parse(files: &[(&str, &str)]) -> Crate {
    Crate::read(Path::new(files[0].0), &|wanted| {
        files.iter().find(|(path, _)| Path::new(path) == wanted).map(|(_, text)| text.to_string())
    })
}

#[test]
fn uses_of_modules_above_are_in_order() {
    let files = [
        ("lib.rs", "pub mod a; mod b; pub(crate) mod c;"),
        ("a.rs", "pub struct Item;"),
        ("b.rs", "use crate::a::Item; pub fn f(_: Item) {}"),
        ("c.rs", "pub fn g() { crate::b::f(super::a::Item) }"),
    ];
    assert_eq!(faults(&files), [""; 0]);
    assert_eq!(parse(&files).edges().len(), 3);
}

#[test]
fn every_use_of_a_module_below_is_listed() {
    let found = faults(&[
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", "use crate::{b::{self, Item}, c}; fn f() { b::g(); c::g() }"),
        ("b.rs", "pub struct Item; pub fn g() { crate::c::g() }"),
        ("c.rs", "pub fn g() {}"),
    ]);
    let expected = [
        "a.rs uses crate::b::{Item, g}, declared below a",
        "a.rs uses crate::c::g, declared below a",
        "b.rs uses crate::c::g, declared below b",
    ];
    assert_eq!(found, expected);
}

#[test]
fn paths_in_macros_and_attributes_are_seen() {
    let found = faults(&[
        ("lib.rs", "mod a; mod b;"),
        (
            "a.rs",
            "fn f(x: T) { assert!(x.b::<crate::b::E>() > 1..crate::b::C, \"{}\", [super::b::{D, sub::G}]) }
            #[arg(value_parser = crate::b::parse)] struct S;
            macro_rules! m { ($b:ident) => { $crate::b::m::$b } }",
        ),
        ("b.rs", "pub const C: u8 = 1;"),
    ]);
    assert_eq!(found, ["a.rs uses crate::b::{C, D, E, m, parse, sub}, declared below a"]);
}

#[test]
fn modules_inside_others_have_an_order_too() {
    let found = faults(&[
        ("src/lib.rs", "mod a; mod b;"),
        ("src/a/mod.rs", "mod x; mod y; mod inline { mod z; }"),
        ("src/a/x.rs", "use super::y::f; use super::super::b::g;"),
        ("src/a/y.rs", "pub fn f() { super::inline::z::h() }"),
        ("src/a/inline/z.rs", "pub fn h() {}"),
        ("src/b.rs", "pub mod deep; pub fn g() { deep::f() }"),
        ("src/b/deep.rs", "pub fn f() {}"),
    ]);
    let expected = [
        "src/a/x.rs uses crate::a::y::f, declared below a::x",
        "src/a/x.rs uses crate::b::g, declared below a",
        "src/a/y.rs uses crate::a::inline::z::h, declared below a::y",
    ];
    assert_eq!(found, expected);
}

#[test]
fn re_exports_count_as_uses_of_what_they_lead_to() {
    let found = faults(&[
        ("lib.rs", "mod a; mod b;"),
        ("a/mod.rs", "mod x; mod y; pub use self::y::{Item, f as renamed}; pub use crate::b::*;"),
        ("a/x.rs", "use super::{Item, Other}; use crate::a::renamed; fn f(_: Item, _: Other) { renamed() }"),
        ("a/y.rs", "pub struct Item; pub fn f() {}"),
        ("b.rs", "pub struct Other; pub fn g(_: crate::a::Item) {}"),
    ]);
    let expected = [
        "a/mod.rs uses crate::b, declared below a",
        "a/x.rs uses crate::a::y::{Item, f}, declared below a::x",
        "a/x.rs uses crate::b::Other, declared below a",
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_module_and_one_inside_it_form_no_circle() {
    let (lib, child) = ("mod a;", "use super::Item; pub fn f(_: Item) {}");
    let expected = "a/x.rs uses crate::a::Item, in a/mod.rs, which uses a::x: a circle";
    let found =
        faults(&[("lib.rs", lib), ("a/mod.rs", "mod x; pub struct Item; fn g() { x::f(Item) }"), ("a/x.rs", child)]);
    assert_eq!(found, [expected]);

    // Only passing on what the child defines is no use of it.
    let passes_on = "mod x; pub use x::f; pub struct Item;";
    assert_eq!(faults(&[("lib.rs", lib), ("a/mod.rs", passes_on), ("a/x.rs", child)]), [""; 0]);
    let calls = "mod x; pub use x::f; pub struct Item; fn g() { f(Item) }";
    assert_eq!(faults(&[("lib.rs", lib), ("a/mod.rs", calls), ("a/x.rs", child)]), [expected]);

    let found = faults(&[
        ("lib.rs", lib),
        ("a/mod.rs", "mod x; mod y; pub struct Item; fn g() { y::g() }"),
        ("a/x.rs", "use super::*; pub fn f(_: Item) {}"),
        ("a/y.rs", "pub fn g() { super::x::f(todo()) }"),
    ]);
    assert_eq!(found, ["a/x.rs uses crate::a::Item, in a/mod.rs, which indirectly uses a::x: a circle"]);
}

#[test]
fn tests_documentation_and_other_crates_are_exempt() {
    let found = faults(&[
        ("lib.rs", "mod a; mod b; #[cfg(test)] mod checks;"),
        (
            "a.rs",
            "//! As in [`crate::b`], `crate::b::f()`.
            use ::b::f; use b::b; use std::{fmt, io};
            /// See [`f`](crate::b::f).
            fn h(b: usize) -> usize { b + fmt::f(io::b) }
            impl A { #[cfg(all(test, unix))] fn g() { crate::b::f() } }
            #[cfg(test)] use crate::b::f as g;
            #[cfg(test)] mod more { use crate::b::f; }
            mod a_tests;",
        ),
        ("b.rs", ""),
    ]);
    assert_eq!(found, [""; 0]);
}

#[test]
fn users_of_a_module_and_of_a_package_are_listed() {
    let files = [
        ("lib.rs", "pub mod a; pub mod b; pub mod top;"),
        ("a.rs", "#[derive(clap::ValueEnum)] enum E {}"),
        ("b.rs", "use crate::top::inner::f; fn clap() {}"),
        ("top/mod.rs", "pub mod inner; use clap::Args;"),
        ("top/inner.rs", "pub fn f() { super::g() }"),
    ];
    assert_eq!(parse(&files).users_of("crate::top", &["clap"]), ["b.rs uses crate::top::inner::f", "a.rs uses clap"]);
}
