//! Member package `tests`; its contents stand in the folders beside this file.
