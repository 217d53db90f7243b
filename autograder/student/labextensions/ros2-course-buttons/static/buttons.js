// Check, Watch and Next: three commands of JupyterLab, as buttons on a student's cell and on the card of a check, which
// after some failures has another one for the worked solution; and Drive, below the picture of the robot. The buttons of a card and of the robot are in their HTML (card.html.j2,
// notebook/live_robot.py); they are shown only where these commands are. Written as JupyterLab loads it (a container of
// webpack's module federation: init, then get), so that nothing has to be built.
"use strict";
window._JUPYTERLAB = window._JUPYTERLAB || {};
window._JUPYTERLAB["ros2-course-buttons"] = (() => {
  let shared; // the modules that JupyterLab shares, by name and version
  const module_ = async name => (await Object.values(shared[name])[0].get())();

  const CHECK = /^check\((["'])([^"']+)\1,\s*(.+?)\s*\)\s*$/m;
  const NEXT = /Next: \[[^\]]*\]\(([^)#]+\.ipynb)\)/;
  const CRASHED = ["autorestarting", "dead"]; // states of a kernel that nobody has ended
  const ENDED = ["restarting", "terminating", ...CRASHED];
  const NAME = /^[A-Za-z_]\w*$/;
  const LAST_HINT = /Hint (\d+) of \1\./g;

  // For each key, meters a second ahead and radians a second to the left.
  const KEYS = { ArrowUp: [0.5, 0], ArrowDown: [-0.5, 0], ArrowLeft: [0, 1.5], ArrowRight: [0, -1.5] };
  const SILENCE = 20; // seconds until it is sure that Validate does not begin
  const SETTLES = 20; // tenths of a second in which a page comes to rest after the end of a cell
  const AGAIN = 300; // milliseconds; the robot obeys a command for a second

  const SHOWN = `
    .jp-Notebook .agc .agc-acts { display: flex !important; }
    .jp-Notebook .ros2-course-drive { display: inline-block !important; margin: 4px 0; padding: 4px 12px; cursor: pointer; }
    .ros2-course-drives .ros2-course-drive { outline: 3px solid var(--jp-brand-color1); }
    .jp-Notebook .ros2-course-not-here { display: none !important; }
    .jp-MarkdownCell .jp-RenderedMarkdown > details + :not(details) { margin-top: 1em; }
    .jp-MarkdownCell .jp-RenderedMarkdown details > pre + :not(.ros2-course-terminal) { margin-top: 1em; }`;
  const NOT_HERE = "given-set-up"; // the grade_id of the cell that sets the course up outside of `./course lab`

  const text = cell => cell.model.sharedModel.getSource();
  const isCheck = cell => cell.model.type === "code" && CHECK.test(text(cell));
  const isStudents = cell =>
    cell.model.type === "code" && Boolean(cell.model.getMetadata("nbgrader")?.solution) && !isCheck(cell);

  // The notebook that is used, as this extension sees it.
  function notebook(app) {
    const panel = app.shell.currentWidget;
    return panel?.content?.widgets && panel.sessionContext ? panel : null;
  }

  // The check of a cell, of the active one if no place is given: the cell itself, or the next check below it.
  function check(panel, from = panel.content.activeCellIndex) {
    const { widgets } = panel.content;
    const at = widgets.findIndex((cell, place) => place >= from && isCheck(cell));
    if (at < 0) return null;
    const [, , exercise, subject] = CHECK.exec(text(widgets[at]));
    return { at, exercise, subject };
  }

  // The places of the cells that a check is about: those between the check before it and itself.
  function taskOf(panel, at) {
    const { widgets } = panel.content;
    const before = widgets.slice(0, at).findLastIndex(isCheck);
    return widgets.map((cell, place) => place).filter(place => place > before && place < at);
  }

  const cellsOf = (panel, at) => taskOf(panel, at).filter(place => isStudents(panel.content.widgets[place]));

  // True if a text cell has a last hint that the student has not opened since the page was loaded. A cell that was never
  // seen is not drawn yet.
  function hasClosedHint(cell) {
    const hints = cell.model.type === "markdown" ? text(cell).match(LAST_HINT) ?? [] : [];
    const opened = [...cell.node.querySelectorAll("details[open] > summary")].filter(one => one.textContent.match(LAST_HINT));
    return opened.length < hints.length;
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
      const [{ Notification }, { INotebookTracker, NotebookActions }, { PageConfig }] = await Promise.all(
        ["@jupyterlab/apputils", "@jupyterlab/notebook", "@jupyterlab/coreutils"].map(module_),
      );
      const say = message => Notification.info(message, { autoClose: 5000 });

      // Run the student's cells and then the check; in a kernel that has started again, first the cells above that
      // these need. Stop at a cell that ends with an error, which shows it.
      async function checkNow(app) {
        const panel = notebook(app);
        const found = panel && check(panel);
        if (!found) return say("There is no check below this cell.");
        const own = [...cellsOf(panel, found.at), found.at];
        const first = await neededFirst(panel, own);
        if (first.length) say("This kernel is new: the cells above that the check needs run first.");
        for (const place of [...first, ...own].sort((a, b) => a - b)) {
          await goTo(panel, place);
          await app.commands.execute("notebook:run-cell");
          if (failed(panel.content.widgets[place])) return;
        }
      }

      // The places of the cells above that have to run before a student's cells and their check.
      async function neededFirst(panel, own) {
        const kernel = panel.sessionContext.session?.kernel;
        if (!kernel) return [];
        const last = own[own.length - 1];
        const code = panel.content.widgets.map((cell, place) => place)
          .filter(place => place <= last && panel.content.widgets[place].model.type === "code");
        const sources = code.map(place => text(panel.content.widgets[place]));
        const asked = `cells_to_run(${JSON.stringify(sources)}, ${JSON.stringify(own.map(place => code.indexOf(place)))})`;
        const said = await ask(kernel, "autograder.student.fresh_kernel", asked);
        return JSON.parse(said ?? "[]").map(place => code[place]);
      }

      // A check ends with its kernel, or when its page is closed: its card must not say for ever that it goes on.
      function endCards(panel, whyOf) {
        for (const [place, cell] of panel.content.widgets.entries()) {
          const outputs = cell.model.type === "code" ? cell.model.outputs : [];
          for (let at = 0; at < outputs.length; at++) {
            const output = outputs.get(at).toJSON();
            const html = [output.data?.["text/html"] ?? ""].flat().join("");
            if (!html.includes("agc-waiting")) continue;
            const page = new DOMParser().parseFromString(html, "text/html");
            const card = page.querySelector(".agc-waiting");
            if (!card) continue;
            const why = whyOf(check(panel, place));
            card.classList.replace("agc-waiting", "agc-over");
            // A card that grows counts the seconds in a notice, and has points and rows that were to come.
            for (const part of card.querySelectorAll(".agc-notice, .agc-badge, .agc-score, .agc-bar, .agc-body")) part.remove();
            card.querySelector(".agc-state").textContent = why;
            card.setAttribute("aria-label", why);
            outputs.set(at, { ...output, data: { "text/html": card.outerHTML, "text/plain": why } });
          }
        }
      }

      // After Shift+Enter the view follows the next cell, so that the head of a card would be above it. A card that fits
      // comes into view as a whole, another one with its head at the top. Who has gone to another cell stays there.
      async function showVerdict(panel, cell) {
        const { content } = panel;
        const isHere = () => [0, 1].includes(content.activeCellIndex - content.widgets.indexOf(cell));
        const view = content.node.querySelector(".jp-WindowedPanel-outer") ?? content.node;
        let goesOn = true; // until the student scrolls, presses a key or clicks
        const end = new AbortController();
        for (const name of ["wheel", "keydown", "pointerdown"])
          window.addEventListener(name, () => { goesOn = false; }, { capture: true, signal: end.signal });
        // JupyterLab draws outputs and moves the view for some time after the end of a cell.
        for (let turn = 0; turn < SETTLES && goesOn && isHere(); turn++) {
          const card = cell.node.querySelector(".agc:not(.agc-waiting)");
          const head = card?.querySelector(".agc-head").getBoundingClientRect();
          const box = view.getBoundingClientRect();
          if (head && (head.top < box.top || head.bottom > box.bottom))
            card.scrollIntoView({ block: card.offsetHeight < box.height ? "nearest" : "start" });
          await new Promise(done => setTimeout(done, 100));
        }
        end.abort();
      }

      // Why a check has no result whose kernel has ended. If the check itself ends it, a third one would, too. Its card
      // may be that of a watched check, below the student's own cell.
      const crashed = new Set(); // the exercises whose check has ended with a crash
      function whyEnded(found, crash) {
        const ended = "The kernel ended during this check";
        const again = crash && crashed.has(found?.exercise);
        if (crash && found) crashed.add(found.exercise);
        if (!again) return `${ended}, so there is no result: check again.`;
        return `${ended} again, so your code ends it. Look at the cell that defines ${found.subject}, and at what `
          + "that code calls: exit(), os._exit(), a call of itself without an end, or a library that crashes.";
      }

      // The cell that does nothing here is not shown, so that the first cell of the text is the first that a student sees.
      function hideSetUp(panel) {
        const hide = () => {
          const { content } = panel;
          const place = content.widgets.findIndex(cell => cell.model.getMetadata("nbgrader")?.grade_id === NOT_HERE);
          if (place < 0) return;
          content.widgets[place].addClass("ros2-course-not-here");
          if (content.activeCellIndex === place) content.activeCellIndex = place + 1;
        };
        Promise.all([panel.context.ready, panel.revealed]).then(hide);
      }

      function endCardsWithKernel(panel) {
        const { context, sessionContext } = panel;
        let crash = false;
        sessionContext.statusChanged.connect((_, status) => {
          crash ||= CRASHED.includes(status);
          // JupyterLab says "restarting" first if a kernel has crashed, too, and "autorestarting" just after.
          if (ENDED.includes(status)) setTimeout(() => {
            endCards(panel, found => whyEnded(found, crash));
            crash = false;
          });
        });
        Promise.all([context.ready, sessionContext.ready]).then(
          () => endCards(panel, () => "The notebook was closed during this check, so there is no result: check again."),
        );
      }

      // What an expression has as its value in a notebook's kernel, where that is a string; nothing where it failed. No
      // name is left in the student's notebook.
      async function ask(kernel, module, call) {
        const words = `__import__("${module}", fromlist=["_"]).${call}`;
        const asked = { code: "", silent: true, store_history: false, user_expressions: { words } };
        const { content } = await kernel.requestExecute(asked).done;
        return content.user_expressions?.words?.data?.["text/plain"]?.slice(1, -1);
      }

      async function watchOrNot(app) {
        const panel = notebook(app);
        const found = panel && check(panel);
        const kernel = panel?.sessionContext.session?.kernel;
        if (!found || !kernel) return say("There is no check below this cell, or no kernel.");
        if (!NAME.test(found.subject)) return say("What is checked here is a file: it is checked when you run its check.");
        const call = `switch(${JSON.stringify(found.exercise)}, ${found.subject})`;
        const said = await ask(kernel, "autograder.notebook.checking.watch_mode", call);
        say(said ?? `Run the cell with ${found.subject} first.`);
      }

      // The worked solution is the last rung of the ladder of hints: it comes after them.
      async function openSolution(app) {
        const panel = notebook(app);
        const found = panel && check(panel);
        const kernel = panel?.sessionContext.session?.kernel;
        if (!found || !kernel) return say("There is no check below this cell, or no kernel.");
        const hint = taskOf(panel, found.at).find(place => hasClosedHint(panel.content.widgets[place]));
        if (hint !== undefined) {
          await goTo(panel, hint);
          return say("Open the last hint of this task first, and try it. Then the worked solution opens.");
        }
        const call = `open_solution(${JSON.stringify(found.exercise)})`;
        say(await ask(kernel, "autograder.notebook.checking.card_display", call) ?? "Run the check again first.");
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

      // Send the arrow keys to the robot, until another key or a click says that something else is wanted.
      let endDriving = null;
      function driveOrNot(app) {
        if (endDriving) return endDriving();
        const kernel = notebook(app)?.sessionContext.session?.kernel;
        if (!kernel) return say("The notebook has no kernel.");
        const pressed = new Set();
        let sends = false, changed = false;
        // One at a time: what waits for a busy kernel would come too late.
        async function send() {
          changed = true;
          if (sends) return;
          sends = true;
          while (changed) {
            changed = false;
            const [ahead, left] = [...pressed].map(key => KEYS[key]).reduce((a, b) => [a[0] + b[0], a[1] + b[1]], [0, 0]);
            const said = await ask(kernel, "autograder.notebook.robot_drivers", `drive(${ahead}, ${left})`).catch(() => "");
            if (said && endDriving) { endDriving(); say(said); }
          }
          sends = false;
        }
        const key = event => {
          if (!(event.key in KEYS)) return event.type === "keydown" && endDriving();
          event.preventDefault();
          event.stopImmediatePropagation(); // JupyterLab would go to another cell
          if (event.repeat) return;
          pressed[event.type === "keydown" ? "add" : "delete"](event.key);
          send();
        };
        const click = event => event.target.closest?.(".ros2-course-drive") || endDriving();
        const again = setInterval(() => pressed.size && send(), AGAIN);
        const away = () => endDriving();
        const listened = { keydown: key, keyup: key, mousedown: click, blur: away };
        endDriving = () => {
          endDriving = null;
          clearInterval(again);
          for (const name in listened) window.removeEventListener(name, listened[name], name !== "blur");
          document.body.classList.remove("ros2-course-drives");
          if (pressed.size) { pressed.clear(); send(); }
        };
        for (const name in listened) window.addEventListener(name, listened[name], name !== "blur");
        document.body.classList.add("ros2-course-drives");
        say("Drive with the arrow keys. Any other key ends it.");
      }

      // Say how far nbgrader's Validate is, which runs the whole notebook in a new kernel.
      async function tellOfValidation(panel) {
        const url = `${PageConfig.getBaseUrl()}course/validation?notebook=${encodeURIComponent(panel.context.path)}`;
        const id = Notification.emit("Validate runs your notebook in a new kernel.", "in-progress", { autoClose: false });
        for (let silent = 0; silent < SILENCE; silent++) {
          await new Promise(done => setTimeout(done, 1000));
          const { at } = await fetch(url).then(answer => answer.json()).catch(() => ({}));
          if (at === undefined) continue; // it has not begun yet, or has ended
          silent = SILENCE - 3;
          const of = panel.content.widgets.length;
          if (at) Notification.update({ id, message: `Validate: cell ${at} of ${of} runs, ${of - at} are left.` });
        }
        Notification.dismiss(id);
      }

      const plugin = {
        id: "ros2-course-buttons:buttons",
        autoStart: true,
        optional: [INotebookTracker],
        activate(app, tracker) {
          NotebookActions.executed.connect((_, { notebook: content, cell }) => {
            const panel = tracker?.find(one => one.content === content);
            if (panel && isCheck(cell)) showVerdict(panel, cell);
          });
          document.addEventListener("click", event => {
            const panel = notebook(app);
            if (panel && event.target.closest?.("jp-button, button")?.textContent.trim() === "Validate") tellOfValidation(panel);
          }, true);
          tracker?.widgetAdded.connect((_, panel) => {
            endCardsWithKernel(panel);
            hideSetUp(panel);
          });
          const style = document.createElement("style");
          style.textContent = SHOWN;
          document.head.append(style);
          const add = (name, label, caption, execute) =>
            app.commands.addCommand(`ros2-course:${name}`, { label, caption, execute: () => execute(app) });
          add("check", "Check", "Run the cells of this task, and then its check", checkNow);
          add("watch", "Watch", "Check again whenever the cell is run, or end that", watchOrNot);
          add("solution", "Open the worked solution", "Show the worked solution on the card of this task", openSolution);
          add("drive", "Drive the robot", "Send the arrow keys to the robot, or end that", driveOrNot);
          add("next", "Next task", "Go to the next task, here or in the next notebook", next);
        },
      };
      return () => plugin;
    },
  };
})();
