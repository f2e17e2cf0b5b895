"""Files of an output folder: made by the programs, or kept from an earlier call."""
import shlex

from igatools.driver.kept import Kept, hash_of_file, key_of


class OutputFiles:
    def __init__(self, programs, options):
        self.programs, self.options = programs, options
        self.kept = Kept(options.output, not options.fresh)
        self.part_hash = hash_of_file(options.part)
        self.reused = 0

    def made(self, name, program, words, inputs=(), asked=None, settings=()):
        """The report of the program that makes the file `name`, run where no earlier one holds.
        inputs: what it reads, as hashes or keys; asked: number by which a larger one serves as well, passed by `settings`."""
        key = self.key(program, words, inputs)
        found = self.kept.find(name, key, asked or 0)
        if found:
            self.reused += 1
            return found
        self.kept.forget(name)
        found = self.programs.run(program, *words, *settings, "-o", self.options.output / name, "--force")
        self.kept.keep(name, key, found, asked or 0)
        return found

    def holds(self, name, program, words, inputs):
        """Is the file there as such a run would make it?"""
        return self.kept.find(name, self.key(program, words, inputs)) is not None

    def key(self, program, words, inputs):
        return key_of(self.programs.identity(program), *words, *inputs)

    def key_of(self, name):
        """Of a file that was made."""
        return self.kept.entries[name]["key"]

    def command(self, program, words, name):
        """A line that a user may repeat."""
        return shlex.join([program, *map(str, words), "-o", str(self.options.output / name), "--force"])

    def prepare_words(self, *words):
        """Of igaprep for the part."""
        o = self.options
        unit = ["--length-unit", o.length_unit] if o.length_unit else []
        return [o.part, "--degree", o.degree, *unit, *o.igaprep, *words]

    def prepare(self, name, *words):
        """The report of igaprep for a model of the part."""
        return self.made(name, "igaprep", self.prepare_words(*words), [self.part_hash])
