-- The last result of each notebook. The column task contains the hash of everything on which the result depends.
CREATE TABLE IF NOT EXISTS result (
    student TEXT, assignment TEXT, notebook TEXT, task TEXT NOT NULL, execution BLOB NOT NULL,
    PRIMARY KEY (student, assignment, notebook)
);
-- The evidence of each notebook, for appeals: packed by exercise, with the executed cells. Evidence is kept for the
-- task whose points are in the gradebook, and for the task that was executed last.
CREATE TABLE IF NOT EXISTS evidence (
    student TEXT, assignment TEXT, notebook TEXT, task TEXT NOT NULL, course TEXT NOT NULL,
    checks BLOB NOT NULL, cells BLOB NOT NULL,
    PRIMARY KEY (student, assignment, notebook, task)
);
-- Each grading of a submission; see the class Attempt. The column entered is 1 if the gradebook contains the results of
-- this attempt: of each submission one attempt at most. Attempts are only added, never changed or removed; only the id of
-- their student, entered and shown may change.
CREATE TABLE IF NOT EXISTS attempt (
    number INTEGER PRIMARY KEY, student TEXT NOT NULL, at TEXT NOT NULL, assignment TEXT NOT NULL,
    made_from TEXT NOT NULL, course TEXT NOT NULL, report BLOB NOT NULL,
    tasks BLOB NOT NULL DEFAULT '{}', scores BLOB NOT NULL DEFAULT '{}', entered INTEGER NOT NULL DEFAULT 0,
    shown TEXT NOT NULL DEFAULT ''
);
CREATE INDEX IF NOT EXISTS attempt_of ON attempt (student);
CREATE INDEX IF NOT EXISTS entered_of ON attempt (student, assignment) WHERE entered;
CREATE TRIGGER IF NOT EXISTS not_removed BEFORE DELETE ON attempt BEGIN SELECT RAISE(ABORT, 'attempts stay'); END;
CREATE TRIGGER IF NOT EXISTS not_changed BEFORE UPDATE OF number, at, assignment, made_from, course, report, tasks, scores
    ON attempt BEGIN SELECT RAISE(ABORT, 'attempts stay'); END;
-- The master from which each source notebook of the class was made; see the class Origin.
CREATE TABLE IF NOT EXISTS origin (
    assignment TEXT PRIMARY KEY, master TEXT NOT NULL, text TEXT NOT NULL, work TEXT NOT NULL
);
-- The cells with points in the source notebooks. They are valid as long as the sources have this fingerprint.
CREATE TABLE IF NOT EXISTS graded_cells (fingerprint TEXT PRIMARY KEY, cells BLOB NOT NULL);
