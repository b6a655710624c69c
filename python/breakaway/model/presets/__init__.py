"""One TOML file per source of parameters, named for it."""
