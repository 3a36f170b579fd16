"""Models of the data of each answer: the types of the methods `to_dict`.

Type checkers compare them with the code that writes the answers, and `docs/build_schemas.py` makes
the published schemas from them. No module imports them at run time, since pydantic is slow.
"""
