"""`kilter mcp`: the questions of kilter as tools for agents, over the Model Context Protocol."""
