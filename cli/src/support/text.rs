//! Names and messages that others wrote, made safe to show.
//!
//! A scene, a mesh, a table or a folder may hold any character in its names. Some of them make a terminal move its
//! cursor, change its title or its colours, or turn the order of what stands after them; a document shows something
//! else than its bytes say. Such characters reach no terminal and no document: messages and JSON spell them out,
//! pictures and pages show a space.

use std::fmt::Write;

/// Whether a character acts on the terminal or document instead of being shown: control characters (C0, DEL, C1), line
/// and paragraph separators, and those that turn the direction of writing.
#[must_use]
pub fn is_active(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Text for a terminal: every active character, line ends too, is spelled out, as `\u{1b}`.
#[must_use]
pub fn plain(text: &str) -> String {
    spelled(text, |code| format!("\\u{{{code:x}}}"))
}

/// [`plain`] text in one line: runs of white space become one space.
#[must_use]
pub fn one_line(text: &str) -> String {
    plain(&text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Name as a TOML key: bare if its letters allow, else in quotes with active characters spelled out.
#[must_use]
pub fn toml_key(name: &str) -> String {
    let bare = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_');
    if !name.is_empty() && name.bytes().all(bare) {
        return name.to_owned();
    }
    // JSON's escapes are among those of TOML.
    json(&serde_json::Value::from(name).to_string())
}

/// JSON with every active character within its strings spelled out, as `\u009b`; lines stay lines.
///
/// JSON has to escape U+0000 to U+001F only, and a terminal acts on others too.
#[must_use]
pub fn json(text: &str) -> String {
    let mut lines = text.split('\n').map(|line| spelled(line, |code| format!("\\u{code:04x}")));
    let first = lines.next().unwrap_or_default();
    lines.fold(first, |mut text, line| {
        let _ = write!(text, "\n{line}");
        text
    })
}

/// Text with every active character replaced by its spelling; their codes are below 2¹⁶.
fn spelled(text: &str, spelling: impl Fn(u32) -> String) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        if is_active(c) { safe.push_str(&spelling(c.into())) } else { safe.push(c) }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn active_characters_are_spelled_out_and_others_stay() {
        assert_eq!(
            one_line("a\u{1b}[31mb\u{9b}\u{7f}\u{202e}c é λ 🫧"),
            "a\\u{1b}[31mb\\u{9b}\\u{7f}\\u{202e}c é λ 🫧"
        );
        assert_eq!(one_line(" a\n\tb\u{2028}c\u{85}d "), "a b c d");
        assert_eq!(plain("a\n  b\t"), "a\\u{a}  b\\u{9}");
        let spelled = one_line("\u{0}\u{202a}\u{2066}");
        assert_eq!(one_line(&spelled), spelled);
    }

    #[test]
    fn a_key_is_read_back_as_its_name() {
        assert_eq!(toml_key("N-BK7_2"), "N-BK7_2");
        assert_eq!(toml_key("\u{1b}[31mred"), r#""\u001b[31mred""#);
        for name in ["", "a.b", "é", "\"\\\n\t\u{7f}\u{9b}\u{2028}]"] {
            let line = format!("{} = 1", toml_key(name));
            let table = toml::de::DeTable::parse(&line).unwrap();
            assert_eq!(table.get_ref().keys().map(|key| key.get_ref().as_ref()).collect::<Vec<&str>>(), [name]);
        }
    }

    #[test]
    fn json_means_the_same_and_has_no_active_character_left() {
        let all: String = (0..0x3000).filter_map(char::from_u32).filter(|c| is_active(*c)).collect();
        let value = serde_json::json!({ "name": all, "list": [1, "x"] });
        let text = json(&serde_json::to_string_pretty(&value).unwrap());
        assert!(text.lines().count() > 4 && !text.chars().any(|c| is_active(c) && c != '\n'));
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
