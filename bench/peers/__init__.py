"""The paper's extraction loop in other people's tools, beside ours."""
