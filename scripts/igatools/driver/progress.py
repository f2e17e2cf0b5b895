"""What a user sees while programs work: one line for each grid, in a terminal updated in place."""
import sys
import time


class Progress:
    def __init__(self, quiet=False, stream=sys.stderr):
        self.quiet, self.stream = quiet, stream
        self.in_place = not quiet and stream.isatty()
        self.label, self.stage_words, self.began, self.expected = "", "", 0.0, None

    def say(self, text):
        """A line that stays."""
        if not self.quiet:
            self.stream.write(("\r\x1b[K" if self.in_place else "") + text + "\n")
            self.stream.flush()

    def begin(self, label, expected=None):
        """Work that takes a while; `expected` seconds, where there is a guess."""
        self.label, self.stage_words, self.began, self.expected = label, "", time.monotonic(), expected
        self.tick()

    def stage(self, words):
        self.stage_words = words
        self.tick()

    def tick(self):
        if self.in_place:
            self.stream.write("\r\x1b[K" + self.line())
            self.stream.flush()

    def line(self):
        spent = time.monotonic() - self.began
        line = f"{self.label}: {self.stage_words + ', ' if self.stage_words else ''}{spent:.0f} s"
        if self.expected is not None:
            left = self.expected - spent
            line += f", about {left:.0f} s left" if left > 0 else ", longer than expected"
        return line
