//! Member package `benches`; its contents stand in the folders beside this file.
