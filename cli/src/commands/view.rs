//! The command `goniochrome view`.

use crate::commands::args::PageArgs;
use crate::commands::body_option::is_sheet;
use crate::commands::finish_option::finish;
use crate::commands::spread_option::spread;
use crate::commands::table_source::TableSource;
use crate::commands::thickness_option::{map_file, thickness};
use crate::scene::OwnedFinish;
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::view::{PageChoice, page};

pub fn run(args: &PageArgs) -> Result<()> {
    let extension = args.output.extension().unwrap_or_default().to_ascii_lowercase();
    if extension != "html" && extension != "htm" {
        return Err(Error::usage(format_args!("{}: a page is written as .html; name it so", args.output.display())));
    }
    let source = TableSource::find(&args.table)?;
    let inputs: Vec<_> = source.files().into_iter().chain(map_file(args.thickness.as_deref())).collect();
    output::check_destination(&args.output, &inputs)?;
    let table = source.table(args.quiet)?;
    let spread = spread(args.spread, &table)?;
    let finish = finish(args.roughness, args.distribution, args.compensating, &table)?;
    // Without the option, a slider has all thicknesses.
    let thickness = args.thickness.as_deref().map(|word| thickness(Some(word), &table)).transpose()?.flatten();
    let shown = finish.as_ref().map(OwnedFinish::finish);
    let choice = PageChoice { spread, finish: shown, is_sheet: is_sheet(args.body, &table)?, thickness };
    let html =
        page(&table, &choice).map_err(|error| Error::failed(format_args!("{}: {error}", args.table.display())))?;
    output::write_file(&args.output, html.as_bytes())
}
