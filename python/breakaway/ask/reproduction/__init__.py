"""The paper reproduced: its tables and figures from our equations, and where they disagree."""
