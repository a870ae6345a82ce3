//! Tree of the part of YAML that data files use, with line numbers. Aliases are refused, so a file cannot grow.

use saphyr_parser::{Event, Parser, ScalarStyle};

use super::diagnostics::SourceText;
use crate::support::error::Result;

/// Maximum nesting: data files have four levels, and the tree is dropped recursively on the call stack.
const MAX_DEPTH: usize = 64;

/// Value with the line where it starts; for a literal block that is its first row, blank or not.
#[derive(Debug)]
pub(super) struct Node {
    pub line: usize,
    pub value: Value,
}

/// Value of a node.
#[derive(Debug)]
pub(super) enum Value {
    /// Text; `block` if written as a literal block (`|`), row for row.
    Scalar {
        text: String,
        block: bool,
    },
    List(Vec<Node>),
    Map(Vec<(String, Node)>),
}

impl Node {
    /// Value of a key of a map.
    pub fn get(&self, key: &str) -> Option<&Self> {
        match &self.value {
            Value::Map(entries) => entries.iter().find(|(name, _)| name == key).map(|(_, node)| node),
            _ => None,
        }
    }

    /// Text of a scalar.
    pub fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Scalar { text, .. } => Some(text),
            _ => None,
        }
    }
}

/// List or map that is still open; a map holds the key that waits for its value.
struct Open {
    node: Node,
    key: Option<String>,
}

/// Parses the one document of a text.
pub(super) fn parse(source: &SourceText<'_>) -> Result<Node> {
    let mut open: Vec<Open> = Vec::new();
    let mut root = None;
    let mut parser = Parser::new_from_str(source.text);
    while let Some(event) = parser.next_event() {
        let (event, span) = event.map_err(|error| {
            source.refuse_line(error.marker().line(), format_args!("not valid YAML: {}", error.info()))
        })?;
        let line = span.start.line();
        let node = match event {
            Event::Scalar(text, style, ..) => {
                let block = style == ScalarStyle::Literal;
                // The parser places a block at its first row that is not blank.
                let blank = if block { text.chars().take_while(|&c| c == '\n').count() } else { 0 };
                let value = Value::Scalar { text: text.into_owned(), block };
                Node { line: line.saturating_sub(blank), value }
            }
            Event::SequenceStart(..) | Event::MappingStart(..) => {
                if open.len() == MAX_DEPTH {
                    return Err(source.refuse_line(line, format_args!("nested more than {MAX_DEPTH} deep")));
                }
                let is_map = matches!(event, Event::MappingStart(..));
                let value = if is_map { Value::Map(Vec::new()) } else { Value::List(Vec::new()) };
                open.push(Open { node: Node { line, value }, key: None });
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(closed) => closed.node,
                None => continue,
            },
            Event::Alias(_) => {
                return Err(source.refuse_line(line, "YAML aliases (*name) are not allowed; write the value out"));
            }
            Event::DocumentStart(_) if root.is_some() => {
                return Err(source.refuse_line(line, "a second YAML document; keep one in a file"));
            }
            _ => continue,
        };
        match open.last_mut() {
            None => root = Some(node),
            Some(parent) => parent.add(source, node)?,
        }
    }
    root.ok_or_else(|| source.refuse_line(1, "the file is empty"))
}

impl Open {
    fn add(&mut self, source: &SourceText<'_>, node: Node) -> Result<()> {
        match (&mut self.node.value, self.key.take()) {
            (Value::Map(entries), Some(key)) => entries.push((key, node)),
            (Value::Map(entries), None) => {
                let Some(key) = node.text() else {
                    return Err(source.refuse_line(node.line, "a key must be plain text"));
                };
                if entries.iter().any(|(name, _)| name == key) {
                    return Err(source.refuse_line(node.line, format_args!("the key {key:?} is given twice")));
                }
                self.key = Some(key.to_owned());
            }
            (Value::List(items), _) => items.push(node),
            (Value::Scalar { .. }, _) => {}
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        parse(&SourceText { label: "f.yml", text }).unwrap_err().to_string()
    }

    #[test]
    fn a_literal_block_starts_on_the_line_after_its_bar() {
        for newline in ["\n", "\r\n"] {
            let text = ["# c", "A:", "  - b: x", "    c: |", "", "      1 2", "      3 4", "D: 'e'", ""].join(newline);
            let node = parse(&SourceText { label: "f.yml", text: &text }).unwrap();
            let Value::List(items) = &node.get("A").unwrap().value else { panic!("A is a list") };
            let block = items[0].get("c").unwrap();
            assert_eq!((block.line, block.text()), (5, Some("\n1 2\n3 4\n")));
            assert_eq!((node.get("D").unwrap().line, node.get("D").unwrap().text()), (8, Some("e")));
        }
    }

    #[test]
    fn what_could_grow_or_mislead_is_refused_by_line() {
        assert_eq!(refusal("a: &x 1\nb: *x\n"), "f.yml:2: YAML aliases (*name) are not allowed; write the value out");
        assert_eq!(refusal("a: 1\na: 2\n"), "f.yml:2: the key \"a\" is given twice");
        assert!(refusal(&format!("a: {}", "[".repeat(100))).contains("f.yml:1: nested more than 64 deep"));
        assert!(refusal(&"- ".repeat(100)).contains("nested more than 64 deep"));
        assert_eq!(refusal("a: 1\n---\nb: 2\n"), "f.yml:2: a second YAML document; keep one in a file");
        assert_eq!(refusal(""), "f.yml:1: the file is empty");
        assert!(refusal("a: 1\n b: [\n").starts_with("f.yml:2: not valid YAML: "));
    }
}
