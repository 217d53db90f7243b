"""The types of the messages between the autograder's processes. A message is a line of JSON.

Promises: whatever arrives is checked against its type before a program uses it; nothing that is sent can be executed.
Names: ``json_lines.Lines``, ``judge_messages``, ``run_messages``, ``workspace_messages``
Imports: ``verdict``.
Takes: lines of JSON on a Unix socket, from processes that need not be trusted.
Gives: frozen records, or ``NotUnderstood``.
"""
