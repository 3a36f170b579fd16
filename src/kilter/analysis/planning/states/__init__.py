"""States of a half-built assembly: parts present, parts held, and whether the state holds."""
