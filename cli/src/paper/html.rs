//! A static HTML page of figures, in one file without scripts that needs no network.

use crate::plot::escape;

/// A section of the page: figures under one heading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// Heading, as plain text.
    pub heading: String,
    /// Picture files relative to the page, shown side by side where there is room.
    pub images: Vec<String>,
    /// Caption, as trusted HTML: it comes from the program.
    pub caption_html: String,
}

const STYLE: &str = "\
:root{color-scheme:light}\
body{margin:0;background:#f6f6f4;color:#1b1b1f;font:17px/1.6 Charter,'Bitstream Charter','Iowan Old Style',Georgia,serif}\
main{max-width:72rem;margin:0 auto;padding:3rem 1.25rem 5rem}\
h1,h2{font-family:Inter,system-ui,-apple-system,'Segoe UI',sans-serif;line-height:1.25;letter-spacing:-.01em}\
h1{font-size:2rem;margin:0 0 .6rem}\
h2{font-size:1.2rem;margin:3.2rem 0 .8rem}\
p{max-width:44rem;margin:.6rem 0}\
a{color:#0b5c94}\
code{font-size:.88em}\
.images{display:flex;flex-wrap:wrap;gap:1rem}\
.images a{flex:1 1 20rem;min-width:0;max-width:100%;background:#fff;border:1px solid #e2e2de;border-radius:6px;\
padding:.75rem;box-sizing:border-box;display:flex;align-items:center;justify-content:center}\
.images img{display:block;min-width:0;max-width:100%;height:auto}\
figure{margin:0}\
figcaption{max-width:44rem;margin-top:.8rem;color:#44444b}\
@media(max-width:30rem){main{padding:1.5rem .9rem 3rem}h1{font-size:1.6rem}.images a{padding:.3rem}}";

/// The HTML of the page. `title` is plain text, `intro_html` trusted HTML.
#[must_use]
pub fn page(title: &str, intro_html: &str, sections: &[Section]) -> String {
    let title = escape(title);
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n<p>{intro_html}</p>\n"
    );
    for section in sections {
        let heading = escape(&section.heading);
        html.push_str(&format!("<section>\n<h2>{heading}</h2>\n<figure>\n<div class=\"images\">\n"));
        for image in &section.images {
            let (link, name) = (escape(&url(image)), escape(image));
            html.push_str(&format!(
                "<a href=\"{link}\"><img src=\"{link}\" alt=\"{heading}: {name}\" loading=\"lazy\"></a>\n"
            ));
        }
        html.push_str(&format!("</div>\n<figcaption>{}</figcaption>\n</figure>\n</section>\n", section.caption_html));
    }
    html.push_str("</main>\n</body>\n</html>\n");
    html
}

/// Percent-encodes a file name for a relative address.
fn url(file: &str) -> String {
    let mut url = String::with_capacity(file.len());
    for byte in file.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' | b'/' => url.push(char::from(byte)),
            _ => url.push_str(&format!("%{byte:02X}")),
        }
    }
    url
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> String {
        let section = Section {
            heading: "Films & <gaps>".into(),
            images: vec!["fig 4.png".into(), "b.svg".into()],
            caption_html: "<em>physical</em>".into(),
        };
        page("A \"page\"", "Made by <code>goniochrome</code>.", &[section])
    }

    #[test]
    fn text_is_escaped_and_captions_are_kept() {
        let html = sample();
        for part in [
            "<title>A &quot;page&quot;</title>",
            "<h2>Films &amp; &lt;gaps&gt;</h2>",
            "<img src=\"fig%204.png\" alt=\"Films &amp; &lt;gaps&gt;: fig 4.png\"",
            "<a href=\"b.svg\">",
            "<figcaption><em>physical</em></figcaption>",
            "<p>Made by <code>goniochrome</code>.</p>",
        ] {
            assert!(html.contains(part), "{part} is missing");
        }
        assert!(html.find("fig%204.png") < html.find("b.svg"));
    }

    #[test]
    fn the_page_needs_neither_network_nor_script_and_every_tag_is_closed() {
        let html = sample();
        for part in ["http:", "https:", "//", "<script", "@import", "url("] {
            assert!(!html.contains(part), "{part}");
        }
        for tag in ["html", "head", "body", "main", "section", "figure", "figcaption", "div", "h1", "h2", "p", "a"] {
            let open = html.matches(&format!("<{tag}>")).count() + html.matches(&format!("<{tag} ")).count();
            assert!(open > 0 && open == html.matches(&format!("</{tag}>")).count(), "{tag}");
        }
    }
}
