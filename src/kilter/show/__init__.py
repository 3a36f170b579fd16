"""Pictures of an assembly and its answers: arrays, colours, one offline HTML page; no physics."""
