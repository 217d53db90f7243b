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

-- query: progress
-- The progress in each submission that changed between attempts, the greatest improvement first. Only attempts with the
-- same version of the course as the last attempt are used, because other attempts are not comparable.
WITH course_of AS (
    SELECT student, assignment, course, max(number) FROM attempt GROUP BY student, assignment
), judged AS (
    SELECT number, student, assignment, json_extract(CAST(made_from AS TEXT), '$.handed_in') AS handed_in,
        (SELECT total(json_extract(value, '$.score')) FROM json_each(CAST(report AS TEXT))) AS score,
        (SELECT total(json_extract(value, '$.max_score')) FROM json_each(CAST(report AS TEXT))) AS max_score
    FROM attempt JOIN course_of USING (student, assignment, course)
    WHERE json_valid(CAST(made_from AS TEXT)) AND json_valid(CAST(report AS TEXT))
), progress AS (
    SELECT student, assignment, count(DISTINCT handed_in) AS attempts, min(number) AS first, max(number) AS last
    FROM judged GROUP BY student, assignment HAVING attempts > 1
)
SELECT progress.student, progress.assignment, attempts, before.score, after.score, after.max_score
FROM progress JOIN judged AS before ON before.number = first JOIN judged AS after ON after.number = last
ORDER BY before.score - after.score, progress.student, first;
