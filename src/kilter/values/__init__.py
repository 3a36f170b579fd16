"""Values that are compared by content, and the names that users guess for their attributes."""

from kilter.values.guesses import Guessable, GuessedAttribute, guarded, meant_word
from kilter.values.value import Value

__all__ = ["Guessable", "GuessedAttribute", "Value", "guarded", "meant_word"]
