"""Pictures of an assembly and of answers about it: figures, films and one offline HTML page."""
