-- What commands ask about the attempts in a class's store. ClassStore reads each query by its name.

-- query: entered
-- The attempts whose results are in the gradebook.
SELECT student, assignment, at, course, shown, made_from, report, tasks, scores, NULL
FROM attempt WHERE entered ORDER BY number;

-- query: attempts
-- The attempts of a student, each with the key of the attempt before it at the same assignment.
SELECT student, assignment, at, course, shown, made_from, report, tasks, scores,
    lag(made_from) OVER (PARTITION BY assignment ORDER BY number)
FROM attempt WHERE student = ? ORDER BY number;

-- query: last_key
-- The key of the newest attempt of a submission.
SELECT made_from FROM attempt WHERE (student, assignment) = (?, ?) ORDER BY number DESC LIMIT 1;
