"""Groups of parts: rigid groups, clusters, supports, and separation of bodies.

- `rigid_groups`: parts that fixed joints tie, as a single body
- `clusters`: free parts that contacts join
- `bearing`: the parts that bear a part
- `separation`: exact separation of displaced parts
- `parting_planes`: planes that separate displaced parts
"""
