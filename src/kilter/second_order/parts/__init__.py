"""Parts in groups, on one another, and apart.

- `rigid_groups`: parts that fixed joints tie, as one body each
- `clusters`: free parts that contacts join
- `bearing`: the parts that bear a part
- `separation`: exact separation of displaced parts
- `parting_planes`: planes that separate displaced parts
"""
