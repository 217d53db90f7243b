# family = "writing"
# tries = "Full marks are written into the gradebook, the table of grades and the store of the class, where they lie."
# could_earn = "All points, of anybody."
# undefended = "In stock nbgrader 0.9.5 and without a box, the gradebook could be written."

# %% extra
<<writes>>
import sqlite3

write(Path('<<class>>/submitted/<<mark>>_note'), 'I was here')
for name, statement in {
    'gradebook.db': 'update grade set auto_score = 10.0, manual_score = 10.0',
    '.autograder/class.db': """update result set execution = replace(execution, '"score":0.0', '"score":10.0')""",
}.items():
    try:
        with sqlite3.connect(f'<<class>>/{name}', timeout=1.0) as book:
            book.execute(statement)
            print('written')
    except sqlite3.Error as error:
        print(error)
