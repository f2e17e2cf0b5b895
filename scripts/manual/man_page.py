"""A manual page from what a program prints with --help."""
import re

SECTIONS = {"Example": "EXAMPLES", "Examples": "EXAMPLES", "Exit codes": "EXIT STATUS"}


def escaped(text):
    """Text that roff prints as it stands."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return re.sub(r"^\.", r"\\&.", text, flags=re.MULTILINE)


def entry_text(entry):
    bold = ", ".join(f"\\fB{escaped(name)}\\fR" for name in entry.names)
    value = f" \\fI{escaped(entry.value)}\\fR" if entry.value else ""
    return f".TP\n{bold}{value}\n{escaped(entry.text) or '.'}\n"


def paragraph(lines):
    """Indented lines stand as they are; others flow."""
    out, as_is = [".PP"], False
    for line in lines:
        if line.startswith("  ") != as_is:
            as_is = not as_is
            out.append(".nf" if as_is else ".fi")
        out.append(escaped(line))
    return "\n".join(out + ([".fi"] if as_is else [])) + "\n"


def notes_text(notes, heading):
    """Paragraphs; `heading` makes a section's first line from its name."""
    out = ""
    in_notes = False
    for block in re.split(r"\n\s*\n|\n(?=Exit codes: )", notes):
        lines = block.split("\n")
        found = re.match(r"(Examples?|Exit codes|[A-Z][a-z]+(?=:$)):\s*", lines[0])
        if found:
            out += heading(SECTIONS.get(found[1], found[1].upper()))
            lines = ([lines[0][found.end():]] if lines[0][found.end():] else []) + lines[1:]
        elif not in_notes:
            out += heading("NOTES")
        in_notes = not found
        out += paragraph(lines)
    return out


def options_text(command, heading):
    out = ""
    for name, entries in [("Arguments", command.arguments), *command.options]:
        if entries:
            out += heading(name) + "".join(entry_text(entry) for entry in entries)
    return out


def synopsis(command):
    name, _, rest = command.usage.partition(command.name)
    return f".PP\n\\fB{escaped(command.name)}\\fR{escaped(rest)}\n"


def summary(command):
    """The first clause, for the line that apropos lists."""
    first = re.split(r"[:.;](\s|$)", command.description)[0]
    return first[:1].lower() + first[1:]


def section(name):
    return f".SH {name}\n"


def subsection(name):
    return f".SS {name}\n"


def bold_line(name):
    return f".PP\n\\fB{escaped(name)}\\fR\n"


def man_page(program, version, others):
    """roff of manual section 1. `others`: names of the other programs."""
    out = f".\\\" Made by scripts/manual from {program.name} --help.\n"
    out += f'.TH {program.name.upper()} 1 "" "iga\\-trimmed\\-solids {version}" "User Commands"\n'
    out += section("NAME") + f"{escaped(program.name)} \\- {escaped(summary(program))}\n"
    out += section("SYNOPSIS") + "".join(synopsis(one) for one in (program.commands or [program]))
    out += section("DESCRIPTION") + escaped(program.description) + "\n"
    if program.arguments or program.options:
        out += section("OPTIONS") + options_text(program, subsection)
    if program.commands:
        out += section("COMMANDS")
        for command in program.commands:
            out += subsection(escaped(command.name)) + escaped(command.description) + ".\n"
            out += options_text(command, bold_line)
            out += notes_text(command.notes, bold_line) if command.notes else ""
    out += notes_text(program.notes, section) if program.notes else ""
    others = ", ".join(f"\\fB{escaped(name)}\\fR(1)" for name in others)
    return out + section("SEE ALSO") + others + "\n"
