//! TOML values with their key and place, so that every error can name both.

use std::borrow::Cow;
use std::fmt::Display;

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::diagnostics::{SourceText, nearest};
use crate::support::error::{Error, Result};

/// Value of a scene file.
#[derive(Clone)]
pub(super) struct TomlItem<'a> {
    source: SourceText<'a>,
    /// Name in messages: the key.
    key: Cow<'a, str>,
    value: &'a Spanned<DeValue<'a>>,
}

/// Table of a scene file.
#[derive(Clone)]
pub(super) struct TomlTable<'a> {
    source: SourceText<'a>,
    /// Name in messages, such as `[stack]`.
    name: String,
    offset: usize,
    table: &'a DeTable<'a>,
}

impl<'a> TomlItem<'a> {
    /// Error at this value.
    pub fn refuse(&self, message: impl Display) -> Error {
        self.source.refuse(self.value.span().start, format_args!("{}: {message}", self.key))
    }

    pub fn key(&self) -> &str {
        &self.key
    }

    /// Number, finite or not; `None` for other values.
    fn any_number(&self) -> Option<f64> {
        match self.value.get_ref() {
            DeValue::Float(x) => x.as_str().parse().ok(),
            DeValue::Integer(x) if x.radix() == 10 => x.as_str().parse().ok(),
            #[expect(clippy::cast_precision_loss, reason = "a length or an index in hexadecimal is small")]
            DeValue::Integer(x) => i64::from_str_radix(x.as_str(), x.radix()).ok().map(|x| x as f64),
            _ => None,
        }
    }

    /// Value as a finite number.
    pub fn number(&self) -> Result<f64> {
        match self.any_number() {
            Some(x) if x.is_finite() => Ok(x),
            Some(x) => Err(self.refuse(format_args!("{x} is not a finite number"))),
            None => Err(self.refuse(format_args!("expected a number, found {}", self.found()))),
        }
    }

    /// Value as an integer from 0 to `limit`.
    pub fn count(&self, limit: u32) -> Result<u32> {
        let value = match self.value.get_ref() {
            DeValue::Integer(x) => u32::from_str_radix(x.as_str(), x.radix()).ok().filter(|&x| x <= limit),
            _ => None,
        };
        value.ok_or_else(|| self.refuse(format_args!("expected an integer from 0 to {limit}, found {}", self.found())))
    }

    /// Value as true or false.
    pub fn flag(&self) -> Result<bool> {
        match self.value.get_ref() {
            DeValue::Boolean(flag) => Ok(*flag),
            _ => Err(self.refuse(format_args!("expected true or false, found {}", self.found()))),
        }
    }

    /// Line on which the value starts, counted from 1.
    pub fn line(&self) -> u32 {
        self.source.line(self.value.span().start)
    }

    /// Value as a text.
    pub fn text(&self) -> Result<&'a str> {
        self.as_text().ok_or_else(|| self.refuse(format_args!("expected a text in quotes, found {}", self.found())))
    }

    pub fn as_text(&self) -> Option<&'a str> {
        match self.value.get_ref() {
            DeValue::String(text) => Some(text),
            _ => None,
        }
    }

    pub fn is_number(&self) -> bool {
        self.any_number().is_some()
    }

    pub fn as_array(&self) -> Option<Vec<Self>> {
        let each = |array: &'a DeArray<'a>| array.iter().map(|value| Self { value, ..self.clone() }).collect();
        match self.value.get_ref() {
            DeValue::Array(array) => Some(each(array)),
            _ => None,
        }
    }

    /// Value as a list.
    pub fn array(&self) -> Result<Vec<Self>> {
        self.as_array().ok_or_else(|| self.refuse(format_args!("expected a list, found {}", self.found())))
    }

    /// Value as a table, called `name` in messages.
    pub fn table(&self, name: impl Into<String>) -> Result<TomlTable<'a>> {
        match self.value.get_ref() {
            DeValue::Table(table) => {
                Ok(TomlTable { source: self.source, name: name.into(), offset: self.value.span().start, table })
            }
            _ => Err(self.refuse(format_args!("expected a table, found {}", self.found()))),
        }
    }

    /// Description of the value, for messages.
    pub fn found(&self) -> String {
        match self.value.get_ref() {
            DeValue::String(text) => format!("the text {text:?}"),
            DeValue::Integer(x) => x.to_string(),
            DeValue::Float(x) => x.to_string(),
            DeValue::Boolean(x) => x.to_string(),
            DeValue::Datetime(_) => "a date".to_owned(),
            DeValue::Array(array) => format!("a list of {}", array.len()),
            DeValue::Table(_) => "a table".to_owned(),
        }
    }
}

impl<'a> TomlTable<'a> {
    /// Table of the whole file.
    pub fn root(source: SourceText<'a>, table: &'a DeTable<'a>) -> Self {
        Self { source, name: "the scene".to_owned(), offset: 0, table }
    }

    /// Error at the start of this table.
    pub fn refuse(&self, message: impl Display) -> Error {
        self.source.refuse(self.offset, format_args!("{}: {message}", self.name))
    }

    /// Refuses every key that is not known.
    pub fn allow(&self, known: &[&str]) -> Result<()> {
        let unknown = self.table.keys().filter(|key| !known.contains(&key.get_ref().as_ref()));
        // The table is sorted by key; the reader of the message starts at the top of the file.
        let Some(key) = unknown.min_by_key(|key| key.span().start) else { return Ok(()) };
        let name = key.get_ref();
        let near = nearest(name, known.iter().copied());
        let near = near.map_or_else(String::new, |near| format!("; nearest is {near:?}"));
        let known = known.join(", ");
        let message = format!("unknown key {name:?} in {}{near} (known: {known})", self.name);
        Err(self.source.refuse(key.span().start, message))
    }

    /// Value of a key.
    pub fn get(&self, key: &str) -> Option<TomlItem<'a>> {
        let (key, value) = self.table.get_key_value(key)?;
        Some(TomlItem { source: self.source, key: Cow::Borrowed(key.get_ref()), value })
    }

    /// Value of a required key; `remedy` says what to write.
    pub fn require(&self, key: &str, remedy: &str) -> Result<TomlItem<'a>> {
        self.get(key).ok_or_else(|| self.refuse(format_args!("{key:?} is missing; write {remedy}")))
    }

    /// Every entry, in the order of keys.
    pub fn entries(&self) -> impl Iterator<Item = TomlItem<'a>> + use<'a> {
        let source = self.source;
        self.table.iter().map(move |(key, value)| TomlItem {
            source,
            key: Cow::Borrowed(key.get_ref().as_ref()),
            value,
        })
    }
}
