# family = "forging"
# tries = "The kernel sends messages that are none: without signature, with content of every wrong type, JSON nested a thousand times, replies before their time on the socket of replies."
# could_earn = "A grader that stumbles over them, in the hope that this is a pass, or that the batch ends."
# undefended = "What has not the form of a message is dropped."

# %% extra
import threading
import time

kernel = get_ipython().kernel
deep = []
for _ in range(900):
    deep = [deep]
ODD = (None, 1, "x", [], {"a": deep}, {"execution_state": ["idle"]}, {"name": {}, "text": ["x", 1], "data": {"text/plain": {"a": 1}}},
       {"status": None, "payload": {"source": 1}, "ename": 1, "evalue": [], "traceback": "x"}, {"text": "\ud800"})


def forge(until=time.monotonic() + 6.0):
    while time.monotonic() < until:
        time.sleep(0.05)
        for kind in ("stream", "execute_result", "display_data", "update_display_data", "error", "status", "execute_reply", "clear_output"):
            for content in ODD:
                try:
                    message = kernel.session.msg(kind, {}, parent=kernel.get_parent("shell"))
                    message["content"] = content
                    kernel.session.send(kernel.iopub_socket, message)
                except Exception:
                    pass
        for stream in (getattr(kernel, "shell_stream", None), getattr(kernel, "control_stream", None)):
            try:
                ident = kernel.get_parent("shell") and kernel._parent_ident.get("shell")
                kernel.session.send(stream, "execute_reply", {"status": "ok", "execution_count": 1}, parent=kernel.get_parent("shell"), ident=ident)
                stream.socket.send_multipart([b"", b"<IDS|MSG>", b"no signature", b"{}", b"{}", b"{}", b"{"])
            except Exception:
                pass


threading.Thread(target=forge, daemon=True).start()
