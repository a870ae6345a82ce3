use clap::CommandFactory;

use super::*;

#[test]
fn commands_that_have_the_option_ask_for_wavelengths() {
    let parser = CommandLine::command();
    let mut seen = 0;
    for line in [
        "presets",
        "spectrum s",
        "colour s",
        "estimate s -o t.exr",
        "merge p -o t.exr",
        "scatter s",
        "orders s",
        "compare s",
        "sampling s",
        "lookup t.exr --wi 0,0",
        "plot t.exr -o p.png",
        "render t.exr -o p.png",
        "view t.exr -o v.html",
        "figures -o f",
        "export s --to lut -o l.exr",
    ] {
        let words = std::iter::once("goniochrome").chain(line.split(' '));
        let command = CommandLine::try_parse_from(words).expect(line).command;
        let name = line.split(' ').next().expect("a word");
        let own = parser.find_subcommand(name).expect(name);
        let has = own.get_arguments().any(|argument| argument.get_long() == Some("wavelengths"));
        assert_eq!(command.asks_wavelengths(), has, "{name}");
        seen += 1;
    }
    assert_eq!(parser.get_subcommands().filter(|own| own.get_name() != "help").count(), seen);
}

#[test]
fn options_of_commands_that_compute_mean_the_same() {
    let parser = CommandLine::command();
    let help = |name: &str, option: &str| {
        let command = parser.find_subcommand(name).expect(name);
        let argument = command.get_arguments().find(|argument| argument.get_long() == Some(option));
        let argument = argument.unwrap_or_else(|| panic!("{name} has no --{option}"));
        let defaults: Vec<_> = argument.get_default_values().iter().map(|value| value.to_os_string()).collect();
        (argument.get_help().map(ToString::to_string), argument.get_short(), defaults)
    };
    let planar = ["colour", "estimate", "compare", "sampling"];
    let cells = ["scatter", "orders"];
    let same = |option: &str, one: &str, other: &str| {
        assert_eq!(help(one, option), help(other, option), "{one} --{option}");
    };
    for name in planar.into_iter().chain(cells) {
        ["threads", "quiet"].iter().for_each(|option| same(option, name, "spectrum"));
    }
    planar.iter().for_each(|name| same("precision", name, "spectrum"));
    ["precision", "seed", "method", "max-harmonic"].iter().for_each(|option| same(option, "scatter", "orders"));
}
