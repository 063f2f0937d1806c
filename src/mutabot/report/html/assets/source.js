/* The program's text with its mutants in the margin, and survivors under their lines. */
"use strict";
(() => {
  const { h, address, count, empty, marks } = mutabot;
  const MARKS = 4;
  let opened = null; // an address that is drawn again, with newer data, stays where the reader is
  const LETTER = (one) => one.status === "killed" ? (one.ends.includes("C") ? "C" : "X") : marks.STATUS[one.status];

  mutabot.views.set("source", (body, parts, asked) => {
    const campaign = mutabot.campaign;
    const file = parts.length ? parts.join("/") : campaign.files[0];
    body.append(h("h1", { tabindex: "-1" }, file ? file : "Source"));
    if (!file) { body.append(empty("There is no source to show.", "The campaign planned no mutant.")); return undefined; }
    const holder = h("div", null, h("p", { class: "wait" }, "The source is being read …"));
    body.append(mutabot.fileTree(campaign, file), holder);
    let gone = false;
    const stops = [];
    const isNew = opened !== location.hash;
    opened = location.hash;
    mutabot.load("sources", "data/sources.js").then((sources) => {
      if (gone) return;
      const [, text, marked] = sources.find(([name]) => name === file) || [];
      holder.replaceChildren(text === undefined
        ? empty("The text of this file was not written down.", "The journal is of an older version of mutabot, or the file could not be read. The mutants are in ",
          h("a", { href: address(["mutants"], { file }) }, "the list"), ".")
        : code(file, text, marked, campaign.mutants.filter((one) => one.spans.some((span) => span.file === file))));
      const wanted = asked.line && document.getElementById(`L${asked.line}`);
      if (wanted) { wanted.classList.add("wanted"); if (isNew) wanted.scrollIntoView({ block: "center" }); }
      stops.push(survivors(holder, wanted, isNew));
    }, (error) => { holder.replaceChildren(empty("The source cannot be shown.", error.message)); });
    return () => { gone = true; stops.forEach((stop) => stop()); opened = location.hash === opened ? opened : null; };
  });

  /** What leads from survivor to survivor, by buttons or keys; the page opens at the first one that differs visibly. */
  function survivors(holder, wanted, isNew) {
    const lines = [...holder.querySelectorAll(".line:has(.alive)")];
    const bar = holder.querySelector(".walk");
    if (!lines.length || !bar) return () => {};
    let now = wanted ? lines.indexOf(wanted) : lines.findIndex((line) => line.classList.contains("has-survivor"));
    if (now < 0 && !wanted) now = 0;
    const where = h("span", { role: "status" });
    const button = (name, by, key) => h("button", { type: "button", "aria-keyshortcuts": key, title: `key ${key}`, onclick: () => go(by) }, name);
    function tell() {
      where.textContent = now < 0 ? count(lines.length, "line with survivors", "lines with survivors") : `Survivors in line ${lines[now].id.slice(1)}, ${now + 1} of ${lines.length}`;
      holder.querySelectorAll(".wanted").forEach((line) => line.classList.remove("wanted"));
      if (now >= 0) lines[now].classList.add("wanted"); else if (wanted) wanted.classList.add("wanted");
    }
    function go(by) {
      const behind = lines.findIndex((line) => wanted && Number(line.id.slice(1)) > Number(wanted.id.slice(1)));
      const from = now >= 0 ? now : (behind < 0 ? lines.length : behind) - (by > 0 ? 1 : 0);
      now = Math.max(0, Math.min(lines.length - 1, from + by));
      tell();
      lines[now].scrollIntoView({ block: "center" });
    }
    const keys = (event) => {
      if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input:not([type=checkbox]), select, dialog")) return;
      if (event.key === "j" || event.key === "k") { go(event.key === "j" ? 1 : -1); event.preventDefault(); }
      const link = event.key === "Enter" && event.target === document.body && now >= 0 && lines[now].querySelector(".alive a");
      if (link) link.click();
    };
    addEventListener("keydown", keys);
    bar.append(h("span", { class: "steps-beside" }, where, button("↑ Previous", -1, "k"), button("↓ Next", 1, "j")));
    tell();
    if (isNew && !wanted && now > 0) lines[now].scrollIntoView({ block: "center" });
    return () => removeEventListener("keydown", keys);
  }

  function code(file, text, marked, mutants) {
    const byLine = new Map();
    for (const one of mutants) {
      const lines = new Set(one.spans.filter((span) => span.file === file).map((span) => span.line));
      for (const line of lines) byLine.set(line, [...(byLine.get(line) || []), one]);
    }
    const box = h("div", { class: "code", role: "list", "aria-label": `${file}, line by line` });
    coloured(text.replace(/\n$/, ""), marked).forEach((line, index) => box.append(row(file, line, index + 1, byLine.get(index + 1) || [])));
    const toggle = h("label", { class: "toggle" }, h("input", { type: "checkbox", checked: true, onchange: (event) => { box.classList.toggle("bare", !event.target.checked); } }), "Survivors under their lines");
    return h("div", null, h("div", { class: "result-count walk" }, toggle), box, marks.legend(new Set(mutants.map(LETTER))),
      mutants.some((one) => one.survives && one.indistinguishable) ? h("p", { class: "hint" }, "Outlined: survived, and nothing that was compared differs from the original.") : "");
  }

  const KINDS = ["string", "comment", "keyword"];
  /** The lines of a text as lists of parts; words of the language, strings and comments are marked. */
  function coloured(text, [pattern, flags]) {
    const lines = [[]];
    const put = (part, kind) => part.split("\n").forEach((piece, index) => {
      if (index) lines.push([]);
      if (piece) lines[lines.length - 1].push(kind ? h("span", { class: kind }, piece) : piece);
    });
    let at = 0;
    for (const found of pattern ? text.matchAll(new RegExp(pattern, flags)) : []) {
      put(text.slice(at, found.index), "");
      put(found[0], KINDS[found.slice(1).findIndex((part) => part !== undefined)]);
      at = found.index + found[0].length;
    }
    put(text.slice(at), "");
    return lines;
  }

  function row(file, line, at, mutants) {
    const sorted = [...mutants].sort((one, other) => Number(other.survives) - Number(one.survives) || other.deviation - one.deviation || one.number - other.number);
    const shown = sorted.slice(0, sorted.length > MARKS ? MARKS - 1 : MARKS);
    const alive = sorted.filter((one) => one.survives);
    const loud = alive.some((one) => !one.indistinguishable);
    return h("div", { class: `line${loud ? " has-survivor" : ""}`, id: `L${at}`, role: "listitem" },
      h("span", { class: "at" }, at),
      h("span", { class: "margin" }, shown.map((one) => h("a", { href: address(["mutant", String(one.number)]), class: `mark m-${one.survives && one.indistinguishable ? "same" : marks.LETTERS[LETTER(one)][0]}`,
        "aria-label": `mutant ${one.number}, ${one.status}: ${one.description}`, title: `${one.number} ${one.status}: ${one.description}` }, LETTER(one))),
      sorted.length > shown.length ? h("a", { class: "rest", href: address(["mutants"], { file, line: String(at) }), "aria-label": `all ${sorted.length} mutants of line ${at}` }, `+${sorted.length - shown.length}`) : null),
      h("code", null, line.length ? line : " "),
      alive.length ? h("ul", { class: `alive${loud ? "" : " calm"}` }, alive.slice(0, 5).map((one) => h("li", null,
        h("a", { href: address(["mutant", String(one.number)]) }, `${one.number}  ${one.description}`), one.indistinguishable ? " nothing differs" : ` ${one.why}`)),
      alive.length > 5 ? h("li", null, h("a", { href: address(["mutants"], { file, line: String(at), status: "survived,not covered" }) }, `and ${count(alive.length - 5, "more survivor")} here`)) : null) : null);
  }
})();
