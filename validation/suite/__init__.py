"""The validation suite: cases with a closed form or a published value, their runs, figures and report."""
