"""The workbench: the page of `kilter view`, backed by an assembly that the user changes by clicks.

`actions` are the changes that a user makes to the choices about a file, and `history` keeps them
with undo and redo. A process of its own answers questions about the present choices (`worker`,
`live_assembly`). `session` connects history, worker and the open pages, and `server` serves them.
`messages`, `uploads` and `connections` verify the data that arrives.
"""
