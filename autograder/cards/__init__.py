"""Shows a verdict: as an HTML card in notebooks, and as the same card in plain text in terminals.

Promises: both cards say the same; whatever a student's program said is escaped and shortened.
Names: ``html_rendering``, ``text_rendering.card_text``, ``card_wording``, ``card_content.Solution``
Imports: ``robot``, ``verdict``.
Takes: a verdict (``autograder.verdict``), and nothing of ROS, notebooks or the judge.
Gives: HTML, or lines of text.
"""
