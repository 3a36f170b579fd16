"""The formats of kilter: assemblies, choices and answers."""
