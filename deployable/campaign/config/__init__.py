"""What a user asks for: a YAML file, checked, completed and resolved into typed sections, once.

`loader` reads YAML, `schema_checks` and `scene_checks` find what is wrong, `accuracy` and the
schema fill in what is absent, `check` puts them in order; `sections` are what comes out of it.
"""
