"""What models and results call themselves."""


class Labels:
    """For readers of files whose root says it."""

    @property
    def title(self):
        """Title of the model: str."""
        return self.attribute("/", "title")

    @property
    def length_unit(self):
        """Label of the length unit, such as "mm", or "unspecified": str."""
        return self.attribute("/", "length_unit")
