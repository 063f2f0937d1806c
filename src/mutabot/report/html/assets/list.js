/* All mutants: searched, filtered, sorted, a page at a time. What is asked stands in the address. */
"use strict";
(() => {
  const { h, address, count, empty, marks } = mutabot;
  const PAGE = 50;
  const AT_ONCE = 15; // rows that are drawn before the others, so that typing is never held up
  const SORTS = {
    number: [(one) => one.number, 1], place: [(one) => `${one.file}\n${String(one.line).padStart(7, "0")}`, 1], operator: [(one) => one.operator, 1],
    status: [(one) => marks.ORDER.indexOf(one.status), 1], killed: [(one) => (one.valid ? one.killed / one.valid : 2), 1], deviation: [(one) => (one.survives ? one.deviation : -1), -1],
  };

  const isAsked = (span, asked) => (!asked.file || span.file === asked.file) && (!asked.line || (span.line <= Number(asked.line) && span.end_line >= Number(asked.line)));

  /** The mutants that are asked for, in the order that is asked for. */
  function chosen(asked) {
    const campaign = mutabot.campaign;
    const words = (asked.q || "").toLowerCase().split(/\s+/).filter(Boolean);
    const states = asked.status ? new Set(asked.status.split(",")) : null;
    const test = asked.test !== undefined ? Number(asked.test) : null;
    const found = campaign.mutants.filter((one) =>
      (!states || states.has(one.status)) && (!asked.family || one.family === asked.family) && (!asked.role || one.role === asked.role) &&
      (!asked.operator || one.operator === asked.operator) && one.spans.some((span) => isAsked(span, asked)) &&
      (!asked.end || one.ends.includes(asked.end)) && (!asked.world || (one.survives && one.indistinguishable === (asked.world === "same"))) &&
      (test === null || one.reach.includes(test) || one.kills.some((kill) => kill[0] === test)) &&
      words.every((word) => one.haystack.includes(word)));
    const [key, way] = SORTS[asked.sort] || SORTS.number;
    const turn = asked.down === "1" ? -way : way;
    return found.map((one) => [key(one), one])
      .sort(([a, one], [b, other]) => (a < b ? -turn : a > b ? turn : one.number - other.number)).map(([, one]) => one);
  }
  mutabot.chosen = chosen;

  mutabot.views.set("mutants", (body, parts, asked) => {
    const campaign = mutabot.campaign;
    const state = { ...asked };
    const results = h("div", { id: "results" });
    const resultCount = h("p", { class: "result-count", "aria-live": "polite" });
    const search = h("input", { id: "search", type: "search", placeholder: "Number, place, text …", autocomplete: "off", spellcheck: "false", value: asked.q || "",
      oninput: (event) => { state.q = event.target.value; delete state.page; update(); } });
    const chips = h("div", { class: "chips", role: "group", "aria-label": "Status" });
    const reset = h("button", { type: "button", class: "quiet", onclick: () => { location.hash = address(["mutants"]); } }, "Clear filters");

    function select(name, label, values) {
      if (values.length < 2) return null;
      const id = `by-${name}`;
      return h("div", { class: "field" }, h("label", { for: id }, label),
        h("select", { id, onchange: (event) => { state[name] = event.target.value; delete state.page; update(); } },
          h("option", { value: "" }, "all"), values.map(([value, text]) => h("option", { value, selected: String(state[name]) === value }, text))));
    }
    const named = (values) => [...new Set(values)].sort().map((value) => [value, value]);
    const each = (key) => named(campaign.mutants.map((one) => one[key]));

    const counts = new Map();
    for (const one of campaign.mutants) counts.set(one.status, (counts.get(one.status) || 0) + 1);
    const states = () => new Set((state.status || "").split(",").filter(Boolean));
    for (const name of marks.ORDER.filter((one) => counts.has(one))) {
      chips.append(h("button", { type: "button", class: "chip", "data-status": name, onclick: () => {
        const now = states();
        if (!now.delete(name)) now.add(name);
        state.status = [...now].join(",");
        delete state.page;
        update();
      } }, marks.status(name), h("span", { class: "many" }, counts.get(name))));
    }

    body.append(
      h("h1", { tabindex: "-1" }, "Mutants"),
      h("div", { class: "filters", role: "search", "aria-label": "Filter mutants" },
        h("div", { class: "field wide" }, h("label", { for: "search" }, "Search"), search), chips,
        h("div", { class: "selects" }, select("role", "Role", each("role")), select("family", "Family", each("family")), select("operator", "Operator", each("operator")),
          select("file", "File", named(campaign.files)), select("world", "Survivors by effect", [["differs", "with an effect"], ["same", "no measured effect"]]), select("test", "Reached by", campaign.tests.map((name, index) => [String(index), name])), reset)),
      resultCount, results);

    function update(isFirst) {
      const began = performance.now();
      const found = chosen(state);
      for (const chip of chips.children) chip.setAttribute("aria-pressed", String(states().has(chip.dataset.status)));
      const pages = Math.max(1, Math.ceil(found.length / PAGE));
      const page = Math.min(Math.max(1, Number(state.page) || 1), pages);
      const shown = found.slice(PAGE * (page - 1), PAGE * page);
      const line = state.line && state.file ? ` at ${state.file}:${state.line}` : "";
      resultCount.textContent = mutabot.legible(`${count(found.length, "mutant")}${found.length === campaign.mutants.length ? "" : ` of ${campaign.mutants.length}`}${line}${pages > 1 ? `, page ${page} of ${pages}` : ""}`);
      results.replaceChildren(found.length ? table(shown, state, sort) : empty("No matching mutants.", "Remove a filter or shorten the search text: ",
        h("a", { href: address(["mutants"]) }, "show all mutants"), "."), pager(page, pages));
      reset.hidden = !Object.keys(state).some((name) => !["sort", "down", "page"].includes(name) && state[name]);
      if (!isFirst) history.replaceState(null, "", address(["mutants"], state));
      performance.measure("filter", { start: began, end: performance.now() });
    }
    function sort(name) {
      if ((state.sort || "number") === name) state.down = state.down === "1" ? "" : "1";
      else { state.sort = name; state.down = ""; }
      delete state.page;
      update();
      const button = results.querySelector(`[data-sort="${name}"]`);
      if (button) button.focus();
    }
    function pager(page, pages) {
      if (pages < 2) return "";
      const to = (where, text, off) => h("button", { type: "button", disabled: off, onclick: () => { state.page = String(where); update(); scrollTo(0, 0); results.querySelector("a")?.focus(); } }, text);
      return h("nav", { class: "pager", "aria-label": "Pages of the list" }, to(page - 1, "Previous", page === 1), h("span", null, `${page} of ${pages}`), to(page + 1, "Next", page === pages));
    }
    const keys = (event) => {
      if (event.defaultPrevented || event.target.closest("input, select, textarea, dialog") || !["j", "k"].includes(event.key)) return;
      const links = [...results.querySelectorAll("a.open")];
      const at = links.indexOf(document.activeElement);
      const next = links[at < 0 ? 0 : Math.min(links.length - 1, Math.max(0, at + (event.key === "j" ? 1 : -1)))];
      if (next) { next.focus(); event.preventDefault(); }
    };
    addEventListener("keydown", keys);
    update(true);
    return () => { mutabot.lastAsked = { ...state }; removeEventListener("keydown", keys); };
  });

  function table(shown, state, sort) {
    const current = state.sort || "number";
    const head = (name, text, kind, title) => {
      const down = (SORTS[name][1] === -1) !== (state.down === "1");
      return h("th", { scope: "col", class: kind, title, "aria-sort": current === name ? (down ? "descending" : "ascending") : null },
        h("button", { type: "button", class: "sort", "data-sort": name, onclick: () => sort(name) }, text, h("span", { "aria-hidden": "true" }, current === name ? (down ? " ↓" : " ↑") : "")));
    };
    const letters = new Set(shown.flatMap((one) => [...one.ends]));
    return h("div", null, h("table", { class: "mutants" },
      h("thead", { "data-label": "sort by" }, h("tr", null, head("number", "no.", "n"), head("place", "place"), head("operator", "operator"), h("th", { scope: "col" }, "fault and result"),
        head("status", "rounds"), head("killed", "killed", "n"), head("deviation", "deviation", "n", "largest deviation, in units of the original's own spread"))),
      body(shown)), marks.legend(letters));
  }

  function body(shown) {
    const rows = h("tbody", null, shown.slice(0, AT_ONCE).map(row));
    if (shown.length > AT_ONCE) requestAnimationFrame(() => setTimeout(() => { if (rows.isConnected) rows.append(...shown.slice(AT_ONCE).map(row)); }));
    return rows;
  }

  function row(one) {
    return h("tr", { class: one.survives ? "is-survivor" : null },
      h("td", { class: "n no" }, one.number),
      h("td", { class: "where" }, h("a", { href: address(["source", one.file], { line: String(one.line) }) }, one.place)),
      h("td", { class: "what" }, one.operator, h("small", null, `${one.family} · ${one.role}`)),
      h("td", { class: "does" }, h("a", { class: "open", href: address(["mutant", String(one.number)]) }, one.description), h("p", null, one.why)),
      h("td", { class: "rounds" }, marks.ends(one.ends)),
      h("td", { class: "n rate" }, one.valid ? `${one.killed}/${one.valid}` : "–"),
      h("td", { class: "n far" }, one.survives ? (one.indistinguishable ? "same" : one.deviation ? `${Number(one.deviation.toPrecision(2)).toLocaleString("en")}×` : "–") : ""));
  }
})();
