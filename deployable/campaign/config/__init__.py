"""What a user asks for: a YAML file, checked, completed and resolved into typed sections, once.

`loader` reads YAML, by `models` pydantic finds what is wrong (`read`), `scene_checks` what needs
the scene; `resolve` fills in what is left open, `check` orders them; `sections` are the result."""
