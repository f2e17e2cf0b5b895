"""Completion of a program's commands and options in bash, from what the program prints with --help."""


def words_of(entries):
    return " ".join(name for entry in entries for name in entry.names)


def case(patterns, words):
    return f'    {patterns}) words="{words}" ;;\n'


def choices_of(command):
    """Cases of the words that may follow an option: "eigen --degree"."""
    last = command.name.rpartition(" ")[2] if " " in command.name else ""
    return "".join(case(" | ".join(f'"{last} {name}"' for name in entry.names), " ".join(entry.choices))
                   for entry in command.every_option() if entry.choices)


def bash_completion(program):
    """A script for bash; file names are completed wherever no option or command is asked for."""
    function = "_" + program.name.replace("-", "_")
    commands = [command.name.rpartition(" ")[2] for command in program.commands]
    find = ""
    if commands:
        find = (f'  local word\n  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do\n    case "$word" in\n'
                f'      {" | ".join(commands)}) command="$word"; break ;;\n    esac\n  done\n')
    choices = "".join(choices_of(command) for command in [program, *program.commands])
    options = case('""', words_of(program.every_option()))
    options += "".join(case(name, words_of(command.every_option())) for name, command in zip(commands, program.commands))
    chosen = f'  case "$command $before" in\n{choices}  esac\n' if choices else ""
    first = f'  [[ -z "$command" && "$current" != -* ]] && words="{" ".join(commands)}"\n' if commands else ""
    return (f"# Completion of {program.name} in bash. Made by scripts/manual from {program.name} --help.\n"
            f"{function}() {{\n"
            f'  local current="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}" command="" words=""\n'
            f'{find}{chosen}'
            f'  [[ -z "$words" && "$current" == -* ]] && case "$command" in\n{options}  esac\n'
            f'{first}'
            f'  COMPREPLY=($(compgen -W "$words" -- "$current"))\n'
            f"}}\n"
            f"complete -o bashdefault -o default -F {function} {program.name}\n")
