//! `goniochrome view`.

use std::slice;

use crate::args::PageArgs;
use crate::error::{Error, Result};
use crate::output;
use crate::table_file;
use crate::view::page;

pub fn run(args: &PageArgs) -> Result<()> {
    let extension = args.output.extension().unwrap_or_default().to_ascii_lowercase();
    if extension != "html" && extension != "htm" {
        return Err(Error::usage(format_args!("{}: a page is written as .html; name it so", args.output.display())));
    }
    output::check_destination(&args.output, slice::from_ref(&args.table))?;
    let table = table_file::read(&args.table)?;
    let html = page(&table).map_err(|error| Error::failed(format_args!("{}: {error}", args.table.display())))?;
    output::write_file(&args.output, html.as_bytes())
}
