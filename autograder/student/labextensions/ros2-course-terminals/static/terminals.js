// A button below each block of bash commands in a notebook's text: it opens a terminal of JupyterLab in the notebook's
// folder, in which the commands stand ready to run. Nothing of it is in the notebook, so that the text reads the same
// everywhere. Written as JupyterLab loads it (a container of webpack's module federation: init, then get), so that
// nothing has to be built.
"use strict";
window._JUPYTERLAB = window._JUPYTERLAB || {};
window._JUPYTERLAB["ros2-course-terminals"] = (() => {
  let shared; // the modules that JupyterLab shares, by name and version
  const module_ = async name => (await Object.values(shared[name])[0].get())();

  const COMMANDS = ".jp-MarkdownCell .jp-RenderedMarkdown pre > code.language-bash";
  const PROMPT = "\x1b[?2004h"; // what bash prints when it waits for a line
  const PATIENCE = 5000; // milliseconds until a terminal whose shell prints no such prompt gets the commands

  const STYLE = `
    .ros2-course-terminal { display: block; margin: -4px 0 12px 26px; padding: 3px 12px; cursor: pointer; font-size: 0.9em;
      color: var(--jp-ui-font-color1); background: var(--jp-layout-color1); border: 1px solid var(--jp-border-color1);
      border-radius: 3px; }
    details > .ros2-course-terminal { margin: 6px 0 12px; }
    .ros2-course-terminal:hover { background: var(--jp-layout-color2); }`;

  // The commands of a block as one line: a line's end would run it, and the student presses Enter. A comment is left
  // out, because it would hide the commands behind it.
  const asOneLine = block => block.textContent.split("\n").map(line => line.trim().replace(/^#.*|\s+#[^'"]*$/, ""))
    .filter(line => line).join(" && ");

  // Wait until the shell of a terminal asks for a line.
  function prompted(session) {
    return new Promise(done => {
      const heard = (_, message) => {
        if (message.type === "stdout" && message.content?.join("").includes(PROMPT)) done();
      };
      session.messageReceived.connect(heard);
      setTimeout(done, PATIENCE);
    });
  }

  return {
    init(scope) {
      shared = scope;
    },
    async get() {
      const { INotebookTracker } = await module_("@jupyterlab/notebook");
      const terminals = new Map(); // the terminal of each block, by its notebook and its commands

      // Open the terminal of a block of commands, or go to it, and paste the commands. The student presses Enter.
      async function open(app, panel, key, commands) {
        let terminal = terminals.get(key);
        if (!terminal || terminal.isDisposed) {
          const cwd = panel.context.path.split("/").slice(0, -1).join("/");
          terminal = await app.commands.execute("terminal:create-new", { cwd });
          const beside = [...terminals.values()].find(one => !one.isDisposed);
          app.shell.add(terminal, "main", beside
            ? { ref: beside.id, mode: "split-right" }
            : { ref: panel.id, mode: "split-bottom" });
          terminals.set(key, terminal);
          await prompted(terminal.content.session);
        }
        app.shell.activateById(terminal.id);
        terminal.content.paste(commands);
      }

      function addButtons(app, panel) {
        for (const block of panel.node.querySelectorAll(COMMANDS)) {
          const after = block.parentElement.nextElementSibling;
          if (after?.classList.contains("ros2-course-terminal")) continue;
          const button = document.createElement("button");
          button.className = "ros2-course-terminal";
          button.textContent = "Open in a terminal";
          button.title = "Open a terminal with these commands, ready to run";
          const commands = asOneLine(block);
          button.addEventListener("click", async () => {
            button.disabled = true; // until the commands stand there: a second click would paste them twice
            await open(app, panel, `${panel.id}:${commands}`, commands).finally(() => { button.disabled = false; });
          });
          block.parentElement.after(button);
        }
      }

      const plugin = {
        id: "ros2-course-terminals:buttons",
        autoStart: true,
        optional: [INotebookTracker],
        activate(app, tracker) {
          const style = document.createElement("style");
          style.textContent = STYLE;
          document.head.append(style);
          tracker?.widgetAdded.connect((_, panel) => {
            // JupyterLab draws a cell's text when it comes into view, and again after each change.
            const observer = new MutationObserver(() => addButtons(app, panel));
            observer.observe(panel.node, { childList: true, subtree: true });
            panel.disposed.connect(() => observer.disconnect());
          });
        },
      };
      return () => plugin;
    },
  };
})();
