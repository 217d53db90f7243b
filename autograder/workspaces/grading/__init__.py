"""The grader's side of checks of workspaces: sources come in, builds and programs run in boxes, reports go out."""
