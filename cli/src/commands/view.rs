//! The command `goniochrome view`.

use crate::commands::args::PageArgs;
use crate::commands::film_option::is_sheet;
use crate::commands::finish_option::finish;
use crate::commands::spread_option::spread;
use crate::commands::table_source::TableSource;
use crate::scene::OwnedFinish;
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::note;
use crate::view::page;

pub fn run(args: &PageArgs) -> Result<()> {
    let extension = args.output.extension().unwrap_or_default().to_ascii_lowercase();
    if extension != "html" && extension != "htm" {
        return Err(Error::usage(format_args!("{}: a page is written as .html; name it so", args.output.display())));
    }
    let source = TableSource::find(&args.table)?;
    output::check_destination(&args.output, &source.files())?;
    let table = source.table(args.quiet)?;
    let spread = spread(args.spread, &table)?;
    let finish = finish(args.roughness, args.distribution, &table)?;
    let shown = finish.as_ref().map(OwnedFinish::finish).filter(|finish| finish.alpha().is_some());
    if finish.is_some() && shown.is_none() {
        note(
            args.quiet,
            format_args!(
                "{}: the page opens with a mirror, without the table's distribution of normals; --roughness makes it rough",
                args.output.display()
            ),
        );
    }
    let is_sheet = is_sheet(args.body, &table)?;
    let html = page(&table, spread, shown, is_sheet)
        .map_err(|error| Error::failed(format_args!("{}: {error}", args.table.display())))?;
    output::write_file(&args.output, html.as_bytes())
}
