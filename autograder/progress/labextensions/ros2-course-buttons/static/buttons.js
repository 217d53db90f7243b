// Check, Watch and Next: three commands of JupyterLab, as buttons on a student's cell and on the card of a check. The
// buttons of a card are in its HTML (card.html.j2); they are shown only where these commands are. Written as JupyterLab
// loads it (a container of webpack's module federation: init, then get), so that nothing has to be built.
"use strict";
window._JUPYTERLAB = window._JUPYTERLAB || {};
window._JUPYTERLAB["ros2-course-buttons"] = (() => {
  let shared; // the modules that JupyterLab shares, by name and version
  const module_ = async name => (await Object.values(shared[name])[0].get())();

  const CHECK = /^check\((["'])([^"']+)\1,\s*(.+?)\s*\)\s*$/m;
  const NEXT = /Next: \[[^\]]*\]\(([^)#]+\.ipynb)\)/;
  const NAME = /^[A-Za-z_]\w*$/;

  const SHOWN = `.jp-Notebook .agc .agc-acts { display: flex !important; }`;

  const text = cell => cell.model.sharedModel.getSource();
  const isCheck = cell => cell.model.type === "code" && CHECK.test(text(cell));
  const isStudents = cell =>
    cell.model.type === "code" && Boolean(cell.model.getMetadata("nbgrader")?.solution) && !isCheck(cell);

  // The notebook that is used, as this extension sees it.
  function notebook(app) {
    const panel = app.shell.currentWidget;
    return panel?.content?.widgets && panel.sessionContext ? panel : null;
  }

  // The check of the active cell: the cell itself, or the next check below it.
  function check(panel) {
    const { widgets, activeCellIndex } = panel.content;
    const at = widgets.findIndex((cell, place) => place >= activeCellIndex && isCheck(cell));
    if (at < 0) return null;
    const [, , exercise, subject] = CHECK.exec(text(widgets[at]));
    return { at, exercise, subject };
  }

  // The student's own cells that a check is about: those between the check before it and itself.
  function cellsOf(panel, at) {
    const { widgets } = panel.content;
    const before = widgets.slice(0, at).findLastIndex(isCheck);
    return widgets.map((cell, place) => place).filter(place => place > before && place < at && isStudents(widgets[place]));
  }

  async function goTo(panel, place) {
    panel.content.activeCellIndex = place;
    panel.content.deselectAll();
    await panel.content.scrollToItem(place, "smart");
  }

  const failed = cell => cell.model.outputs.toJSON().some(output => output.output_type === "error");

  return {
    init(scope) {
      shared = scope;
    },
    async get() {
      const { Notification } = await module_("@jupyterlab/apputils");
      const say = message => Notification.info(message, { autoClose: 5000 });

      // Run the student's cells and then the check; stop at a cell that ends with an error, which shows it.
      async function checkNow(app) {
        const panel = notebook(app);
        const found = panel && check(panel);
        if (!found) return say("There is no check below this cell.");
        for (const place of [...cellsOf(panel, found.at), found.at]) {
          await goTo(panel, place);
          await app.commands.execute("notebook:run-cell");
          if (failed(panel.content.widgets[place])) return;
        }
      }

      async function watchOrNot(app) {
        const panel = notebook(app);
        const found = panel && check(panel);
        const kernel = panel?.sessionContext.session?.kernel;
        if (!found || !kernel) return say("There is no check below this cell, or no kernel.");
        if (!NAME.test(found.subject)) return say("What is checked here is a file: it is checked when you run its check.");
        const code = `from autograder.notebook.checking import watched_cells as _watched`;
        const words = `_watched.switch(${JSON.stringify(found.exercise)}, ${found.subject})`;
        const asked = { code, silent: true, store_history: false, user_expressions: { words } };
        const { content } = await kernel.requestExecute(asked).done;
        const said = content.user_expressions?.words?.data?.["text/plain"];
        say(said ?? `Run the cell with ${found.subject} first.`);
      }

      async function next(app) {
        const panel = notebook(app);
        if (!panel) return;
        const { widgets, activeCellIndex } = panel.content;
        const here = check(panel)?.at ?? activeCellIndex;
        const place = widgets.findIndex((cell, at) => at > here && isStudents(cell));
        if (place >= 0) return goTo(panel, place);
        const link = NEXT.exec(widgets.map(text).join("\n"));
        if (!link) return say("This was the last task of the chapter.");
        const folder = panel.context.path.split("/").slice(0, -1);
        app.commands.execute("docmanager:open", { path: [...folder, link[1]].join("/") });
      }

      const plugin = {
        id: "ros2-course-buttons:buttons",
        autoStart: true,
        activate(app) {
          const style = document.createElement("style");
          style.textContent = SHOWN;
          document.head.append(style);
          const add = (name, label, caption, execute) =>
            app.commands.addCommand(`ros2-course:${name}`, { label, caption, execute: () => execute(app) });
          add("check", "Check", "Run the cells of this task, and then its check", checkNow);
          add("watch", "Watch", "Check again whenever the cell is run, or end that", watchOrNot);
          add("next", "Next task", "Go to the next task, here or in the next notebook", next);
        },
      };
      return () => plugin;
    },
  };
})();
