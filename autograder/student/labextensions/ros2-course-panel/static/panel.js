// The course page in JupyterLab's left side panel. Written as JupyterLab loads it (a container of webpack's module
// federation: init, then get), so that nothing has to be built. The page itself comes from the server.
"use strict";
window._JUPYTERLAB = window._JUPYTERLAB || {};
window._JUPYTERLAB["ros2-course-panel"] = (() => {
  let shared; // the modules that JupyterLab shares, by name and version
  const module_ = async name => (await Object.values(shared[name])[0].get())();

  // A window without room for a notebook beside the panel.
  const narrow = window.matchMedia("(max-width: 999px)");

  // A dialog is never wider than the window: what Validate says of a cell is one long line for each of its own.
  const DIALOGS = `body .jp-Dialog-content { box-sizing: border-box; max-width: min(1000px, 100vw - 16px); }
    body .jp-Dialog-content pre { overflow-wrap: anywhere; white-space: pre-wrap; }`;

  // Where a student writes there is a colored edge. A given cell takes no key, and says so while it has the cursor.
  const CELLS = `.jp-NotebookPanel .jp-Notebook .jp-CodeCell .jp-InputArea .jp-InputArea-editor:not(:has(.jp-mod-readOnly)) {
      border-left: 4px solid var(--jp-success-color1, #2f8f57);
    }
    .jp-Notebook .jp-CodeCell .jp-InputArea-editor:has(.jp-mod-readOnly):focus-within::after {
      content: "Given: run it with Shift+Enter. It cannot be changed; write in the cells with a green edge, or add one with +.";
      display: block; padding: 2px 8px; font-size: 12px;
      color: var(--jp-content-font-color1, #222); background: var(--jp-layout-color2, #eee);
    }`;

  // JupyterLab paints what is of this class in the color of its theme.
  const ICON = `<svg xmlns="http://www.w3.org/2000/svg" width="16" viewBox="0 0 24 24"><g class="jp-icon3" fill="#616161">
    <path d="M5 6h2v12H5zM7 11h10v2H7z"/><circle cx="6" cy="4.5" r="3"/><circle cx="6" cy="19.5" r="3"/><circle cx="18" cy="12" r="3"/>
  </g></svg>`;

  function panel(Widget, LabIcon, base) {
    const frame = document.createElement("iframe");
    frame.title = "Course";
    frame.style.cssText = "border: 0; height: 100%; width: 100%;";
    const widget = new Widget();
    widget.id = "ros2-course-panel";
    widget.title.caption = "Course";
    widget.title.icon = new LabIcon({ name: "ros2-course:map", svgstr: ICON });
    widget.node.style.overflow = "hidden";
    widget.node.append(frame);
    frame.src = `${base}course`;
    return widget;
  }

  function styleThePage() {
    const style = document.createElement("style");
    style.textContent = DIALOGS + CELLS;
    document.head.append(style);
  }

  function actions(app, widget) {
    const opened = path =>
      [...app.shell.widgets("main")].map(one => one.context).filter(context => context?.path === path);
    return {
      isSeen: () => widget.isVisible,
      current: () => app.shell.currentWidget?.context?.path,
      onCurrent: told => app.shell.currentChanged?.connect(told),
      open: path => {
        if (narrow.matches) app.shell.collapseLeft();
        return app.commands.execute("docmanager:open", { path });
      },
      save: path => Promise.all(opened(path).filter(one => one.model.dirty).map(one => one.save())),
      reload: path => Promise.all(opened(path).map(one => one.revert())),
    };
  }

  return {
    init(scope) {
      shared = scope;
    },
    async get() {
      const [{ Widget }, { LabIcon }, { PageConfig }, { ILayoutRestorer }] = await Promise.all(
        ["@lumino/widgets", "@jupyterlab/ui-components", "@jupyterlab/coreutils", "@jupyterlab/application"].map(module_),
      );
      const plugin = {
        id: "ros2-course-panel:panel",
        autoStart: true,
        optional: [ILayoutRestorer],
        activate(app, restorer) {
          const widget = panel(Widget, LabIcon, PageConfig.getBaseUrl());
          styleThePage();
          window.courseInLab = actions(app, widget);
          restorer?.add(widget, widget.id);
          app.shell.add(widget, "left", { rank: 10 });
          // The first time it stands where JupyterLab has the list of files; later, whatever the reader has left there.
          // A narrow window has room for the notebook alone: one click on its icon brings the panel back.
          app.restored.then(() => {
            if (!localStorage.getItem(widget.id) && !narrow.matches) app.shell.activateById(widget.id);
            localStorage.setItem(widget.id, "seen");
            let folded = false;
            const fit = () => {
              if (narrow.matches === folded) return;
              if (narrow.matches && app.shell.leftCollapsed) return;
              folded = narrow.matches;
              folded ? app.shell.collapseLeft() : app.shell.expandLeft();
            };
            fit();
            narrow.addEventListener("change", fit);
          });
        },
      };
      return () => plugin;
    },
  };
})();
