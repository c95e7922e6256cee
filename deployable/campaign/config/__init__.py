"""What a user asks for: a YAML file, checked, completed and resolved into typed sections, once.

`loader` reads YAML, `read` finds by `models` what is wrong, `scene_checks` what needs the scene;
`resolve` fills in what is left open, `check` orders them; `sections` are the result."""
