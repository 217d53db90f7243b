// The course page's own part in the browser. In JupyterLab's side panel, `courseInLab` of the window around it opens,
// saves and reloads notebooks (labextensions/); without it every link is an ordinary one.
"use strict";
(() => {
  const { base, page, token } = document.body.dataset;
  const lab = window.parent === window ? undefined : window.parent.courseInLab;
  const map = document.getElementById("map");
  const said = document.getElementById("said");
  const ask = document.getElementById("ask");
  const EVERY = 3000; // milliseconds between two looks at the journal, while the page is seen

  function followTheme() {
    const seen = window.parent.document.body;
    const set = () => {
      const light = seen.dataset.jpThemeLight;
      if (light) document.documentElement.dataset.theme = light === "true" ? "light" : "dark";
    };
    new MutationObserver(set).observe(seen, { attributeFilter: ["data-jp-theme-light"] });
    set();
  }

  let acting = false; // while an action goes on, its own words are the news

  // Points are told to a screen reader; what an action came to is also seen, until the next click on it or on the map.
  function say(text, seen) {
    said.classList.toggle("spoken", !seen);
    said.textContent = text;
  }

  // The notebook that is open in JupyterLab is marked, and scrolled to when it is opened. A terminal changes nothing.
  let open;
  function markOpen() {
    const path = lab?.current() ?? open;
    for (const link of map.querySelectorAll("a.title")) {
      if (link.dataset.path !== path) {
        link.removeAttribute("aria-current");
        continue;
      }
      link.setAttribute("aria-current", "true");
      if (path !== open) link.closest("li").scrollIntoView({ block: "nearest" });
    }
    open = path;
  }

  const points = () => [...map.querySelectorAll(".sum strong")].map(one => one.textContent).join(", ");

  async function refresh() {
    const answer = await fetch(page, { credentials: "same-origin" });
    if (!answer.ok) return;
    const text = await answer.text();
    const fresh = new DOMParser().parseFromString(text, "text/html").getElementById("map");
    if (!fresh || fresh.innerHTML === refresh.last) return;
    const focused = document.activeElement && document.activeElement.id;
    const before = points();
    refresh.last = fresh.innerHTML;
    map.innerHTML = fresh.innerHTML;
    markOpen();
    // What was begun anew has no button for that any more: its title is beside it.
    const beside = focused && (document.getElementById(focused) || document.getElementById(focused.replace("reset-", "open-")));
    beside?.focus({ preventScroll: true });
    if (points() !== before && !acting) say(`Now ${points()}.`, false);
  }
  refresh.last = map.innerHTML;

  const isSeen = () => document.visibilityState === "visible" && (!lab || lab.isSeen());
  const look = () => { if (isSeen() && !acting) refresh().catch(() => {}); }; // a server that is gone comes back or not

  async function send(method, what, notebook) {
    const answer = await fetch(`${page}/${what}`, {
      method,
      credentials: "same-origin",
      headers: { "Content-Type": "application/json", "X-XSRFToken": token },
      body: JSON.stringify({ notebook }),
    });
    const told = answer.headers.get("Content-Type")?.includes("json") ? await answer.json() : {};
    if (!answer.ok) throw new Error(told.message || `the server said ${answer.status}`);
    return told;
  }

  async function act(action) {
    acting = true;
    let words;
    try {
      words = await action();
    } catch (error) {
      words = `That was not possible: ${error.message}`;
    }
    await refresh().catch(() => {});
    acting = false;
    if (words) say(words, true);
  }

  async function reset(button, name) {
    const path = button.closest("li").querySelector("a.title")?.dataset.path;
    if (path) {
      document.getElementById("ask-title").textContent = `Reset ${button.dataset.title}?`;
      ask.returnValue = "cancel";
      ask.showModal();
      await new Promise(done => ask.addEventListener("close", done, { once: true }));
      document.getElementById(button.id)?.focus();
      if (ask.returnValue !== "reset") return "";
      await lab?.save(path);
    }
    const { copy } = await send("POST", "reset", name);
    if (path) await lab?.reload(path);
    return `${button.dataset.title} is as it was released.` + (copy ? ` Yours is kept: ${copy}` : "");
  }

  async function mark(button, name) {
    await send(button.getAttribute("aria-pressed") === "true" ? "DELETE" : "PUT", "read", name);
  }

  map.addEventListener("click", event => {
    say("", false);
    const link = event.target.closest("a[data-path]");
    const button = event.target.closest("button");
    if (link && lab && !event.ctrlKey && !event.metaKey && !event.shiftKey) {
      event.preventDefault();
      lab.open(link.dataset.path);
    }
    const name = button?.closest("li").dataset.notebook;
    if (button?.matches(".reset")) act(() => reset(button, name));
    if (button?.matches(".read")) act(() => mark(button, name));
  });

  said.addEventListener("click", () => say("", false));
  document.documentElement.classList.toggle("in-panel", Boolean(lab));
  if (lab) {
    followTheme();
    lab.onCurrent(markOpen);
    markOpen();
  }
  for (const kind of ["visibilitychange", "pageshow", "focus"]) {
    (kind === "visibilitychange" ? document : window).addEventListener(kind, look);
  }
  setInterval(look, EVERY);
})();
