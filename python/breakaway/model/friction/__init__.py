"""What a friction law answers: its curve, its force over a period, its force under imposed motion.

In come joints, out go arrays. No equation of a law stands here: the core computes, for any law.
"""
