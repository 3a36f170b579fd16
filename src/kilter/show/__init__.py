"""Pictures of an assembly and its answers: figures, films and one offline HTML page; no physics."""
