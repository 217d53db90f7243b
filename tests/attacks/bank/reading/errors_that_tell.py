# family = "reading"
# tries = "Checks are asked for what cannot be: paths out of the box, exercises of other names, objects without a text. What the errors say, with the variables of each of their frames, is searched."
# could_earn = "The paths and words that grader and judge have in hand when something goes wrong."
# undefended = "LEAK: an error of the judge's with the path of the class."

# %% extra
import sys

told = ("<<class>>", "<<home>>", "planted" + "-")
for exercise, subject in (
    ("lab_1_2.talker", "../../../../../../<<class>>/gradebook.db"),
    ("<<class>>/source", "/etc/shadow"),
    ("lab_1_2.talker\0", object()),
    ("lab_1_1.dance", "<<home>>/.ssh/id_rsa"),
    ("lab_1_2." * 9_999, None),
):
    try:
        check(exercise, subject)
        continue
    except BaseException as error:
        trace, texts = error.__traceback__, [str(error), *map(str, getattr(error, "__notes__", ()))]
    while trace:
        texts += [repr(value)[:5_000] for name, value in trace.tb_frame.f_locals.items() if trace.tb_frame.f_globals is not globals()]
        trace = trace.tb_next
    for text in texts:
        # What it has asked for itself may be said.
        if any(word in text.replace(str(subject), "").replace(exercise, "") for word in told):
            print("LEAK:", text[:200])
