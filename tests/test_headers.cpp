// Nothing of its own: the target of this file holds the headers that all tests share, compiled once.
