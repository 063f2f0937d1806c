/* The report as one page with addresses: which view is shown, keys, theme. */
"use strict";
(() => {
  const { h, address, here } = mutabot;
  const PAGES = [["", "Overview"], ["mutants", "Mutants"], ["source", "Source"], ["tests", "Tests"], ["operators", "Operators"]];
  const KEYS = [
    ["/", "search the mutants"], ["j, k", "next and previous mutant of the list, or survivor of the source"], ["Enter", "open it"],
    ["n, p", "on a mutant's page: the next and the previous one of the list; with Shift the next and the previous survivor in the source"],
    ["[, ]", "on a mutant's page: a tenth of a second back and on; with Shift a second"], ["Space", "play and pause, on the 3D view"],
    ["← → ↑ ↓", "on the 3D view: turn it"], ["+ − 0", "on the 3D view: nearer, farther, as at first"],
    ["g then o m s t", "go to overview, mutants, source, tests"], ["?", "this list"],
  ];
  const main = () => document.getElementById("main");
  let campaign = null;
  let cleanUp = null;
  let isFirst = true;

  mutabot.start = (data) => {
    const older = campaign;
    campaign = prepared(data);
    mutabot.campaign = campaign;
    document.getElementById("project").textContent = mutabot.legible(campaign.name || "Mutabot");
    foot();
    if (older) { renew(older); return; }
    addEventListener("hashchange", show);
    show();
    performance.mark("ready");
  };

  addEventListener("DOMContentLoaded", () => {
    if (campaign || mutabot.live) return;
    main().replaceChildren(h("h1", null, "The data of this report are missing"), mutabot.empty("There is no whole data/campaign.js beside this page.",
      "The report was not written to its end, or only a part of its folder was copied. ", h("code", null, "mutabot report --html"), " writes it again."));
  });

  function prepared(data) {
    const numbers = new Map(data.tests.map((name, at) => [name, at]));
    const reaching = new Map(Object.entries(data.reaching.sites).map(([site, tests]) => [site, [...new Set(tests)].map((at) => numbers.get(data.reaching.tests[at]))]));
    data.mutants = data.mutants.map((row) => {
      const one = Object.fromEntries(data.columns.map((name, index) => [name, row[index]]));
      [one.line, one.endLine] = [one.span.line, one.span.end_line];
      one.spans = [one.span, ...one.other_spans]; // a patch stands in several places
      one.place = one.spans.map((span) => span.line ? `${span.file}:${span.line}` : span.file || "–").join(", ");
      one.reach = reaching.get(one.site) || [];
      one.survives = /[SN]/.test(one.ends) && one.status !== "accepted";
      one.haystack = [one.number, one.id, one.place, one.function, one.operator, one.description, one.why].join("\n").toLowerCase();
      return one;
    });
    const programs = data.mutants.filter((one) => one.role === "program");
    data.files = [...new Set([...programs, ...data.mutants].flatMap((one) => one.spans.map((span) => span.file)))]; // the program's first
    data.byNumber = new Map(data.mutants.map((one) => [one.number, one]));
    return data;
  }

  function show(event) {
    if (cleanUp) cleanUp();
    cleanUp = null;
    const { parts, asked } = here();
    if (location.hash === "#main") return;
    const name = parts[0] || "";
    const view = mutabot.views.get(name);
    navigation(name === "mutant" ? "mutants" : name);
    const body = main();
    body.replaceChildren();
    body.className = `view-${name || "overview"}`;
    if (!view) {
      body.append(h("h1", { tabindex: "-1" }, "No such page"), h("p", null, "This address leads nowhere in this report. ", h("a", { href: "#/" }, "Go to the overview."))); 
    } else {
      cleanUp = view(body, parts.slice(1), asked) || null;
    }
    const title = body.querySelector("h1");
    document.title = `${title ? title.textContent : "Report"} · ${mutabot.legible(campaign.name || "Mutabot")}`;
    if (!isFirst && event && !body.contains(document.activeElement)) { scrollTo(0, 0); if (title) title.focus({ preventScroll: true }); }
    isFirst = false;
  }
  mutabot.show = show;

  /** Newer data of the same campaign: what is shown is drawn again, and the reader stays where he is. */
  function renew(older) {
    if (document.querySelector("#nav :active, main :active")) { setTimeout(renew, 100, older); return; } // a click under way would be lost
    const body = main(), active = document.activeElement;
    const within = [body, document.getElementById("nav")].find((one) => one.contains(active));
    const { parts } = here();
    mutabot.forget("mutant ", "recordings ");
    const content = (one) => one && `${one.ends}\n${one.why}`;
    if (parts[0] === "mutant" && content(older.byNumber.get(Number(parts[1]))) === content(campaign.byNumber.get(Number(parts[1])))) return;
    if ((within && active.matches("select")) || (!getSelection().isCollapsed && body.contains(getSelection().anchorNode))) return; // in the midst of a choice
    const key = !within ? null : active.id ? `#${CSS.escape(active.id)}` : active.hasAttribute("href") ? `a[href="${CSS.escape(active.getAttribute("href"))}"]`
      : active.dataset.status ? `[data-status="${CSS.escape(active.dataset.status)}"]` : active.dataset.sort ? `[data-sort="${active.dataset.sort}"]` : null;
    const caret = within && active.matches("input[type=search]") ? [active.selectionStart, active.selectionEnd] : null;
    const open = [...body.querySelectorAll("details")].map((one) => one.open);
    const [x, y] = [scrollX, scrollY];
    body.style.minHeight = `${body.offsetHeight}px`; // rows come a little later
    show();
    body.querySelectorAll("details").forEach((one, index) => { one.open = Boolean(open[index]); });
    const again = key && within.querySelector(key);
    if (again) again.focus({ preventScroll: true });
    if (again && caret) again.setSelectionRange(...caret);
    scrollTo(x, y);
    setTimeout(() => { body.style.minHeight = ""; }, 300);
  }

  function navigation(current) {
    document.getElementById("nav").replaceChildren(h("ul", null, PAGES.map(([path, name]) => h("li", null, h("a", { href: address(path ? [path] : []), "aria-current": path === current ? "page" : null }, name)))));
  }

  function foot() {
    const meta = campaign.meta;
    const when = typeof meta.started === "number" ? new Date(1000 * meta.started) : null;
    const facts = [meta.mutabot && `mutabot ${meta.mutabot}`, meta.python && `Python ${meta.python}`, meta.engine && `engine ${meta.engine}`,
      meta.seed !== undefined && `seed ${meta.seed}`, when && `began ${when.toISOString().slice(0, 16).replace("T", " ")} UTC`];
    document.getElementById("foot").replaceChildren(h("p", null, facts.filter(Boolean).join(" · ")));
  }

  // Theme: as the system has it, until it is chosen
  const THEMES = ["auto", "light", "dark"];
  function theme(name) {
    if (name === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = name;
    const button = document.getElementById("theme");
    button.textContent = `Theme: ${name}`;
    button.setAttribute("aria-label", `Theme: ${name}. Change it`);
    dispatchEvent(new Event("theme"));
  }
  function kept(value) {
    try {
      if (value === undefined) return localStorage.getItem("mutabot-theme");
      localStorage.setItem("mutabot-theme", value);
    } catch { /* a browser that keeps nothing */ }
    return value;
  }
  let now = THEMES.includes(kept()) ? kept() : "auto";
  theme(now);
  document.getElementById("theme").addEventListener("click", () => {
    now = THEMES[(THEMES.indexOf(now) + 1) % THEMES.length];
    kept(now);
    theme(now);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => dispatchEvent(new Event("theme")));

  // Keys
  function help() {
    const dialog = h("dialog", { "aria-labelledby": "keys-title", onclose: (event) => event.target.remove() },
      h("h2", { id: "keys-title" }, "Keys"),
      h("dl", { class: "keys" }, KEYS.map(([key, does]) => [h("dt", null, h("kbd", null, key)), h("dd", null, does)])),
      h("form", { method: "dialog" }, h("button", { type: "submit" }, "Close")));
    document.body.append(dialog);
    dialog.showModal();
  }
  document.getElementById("keys").addEventListener("click", help);
  document.getElementById("skip").addEventListener("click", (event) => { event.preventDefault(); main().focus(); });
  let goes = false;
  addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    const typing = event.target.closest("input:not([type=range]):not([type=checkbox]), select, textarea");
    if (typing) { if (event.key === "Escape") event.target.blur(); return; }
    if (goes) {
      goes = false;
      const path = { o: [], m: ["mutants"], s: ["source"], t: ["tests"] }[event.key];
      if (path) { location.hash = address(path); event.preventDefault(); }
      return;
    }
    if (event.key === "g") goes = true;
    else if (event.key === "?") help();
    else if (event.key === "/") {
      event.preventDefault();
      if (here().parts[0] !== "mutants") { location.hash = address(["mutants"]); setTimeout(() => focusSearch(), 50); } else focusSearch();
    }
  });
  const focusSearch = () => { const box = document.getElementById("search"); if (box) { box.focus(); box.select(); } };
})();
