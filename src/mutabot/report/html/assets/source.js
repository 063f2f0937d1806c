/* The program's text with its mutants in the margin, and survivors under their lines. */
"use strict";
(() => {
  const { h, address, empty, marks } = mutabot;
  const MARKS = 7;
  const LETTER = (one) => one.status === "killed" ? (one.ends.includes("C") ? "C" : "X") : marks.STATUS[one.status];

  mutabot.views.set("source", (body, parts, asked) => {
    const campaign = mutabot.campaign;
    const file = parts.length ? parts.join("/") : campaign.files[0];
    body.append(h("h1", { tabindex: "-1" }, file ? file : "Source"));
    if (!file) { body.append(empty("There is no source to show.", "The campaign planned no mutant.")); return undefined; }
    const holder = h("div", null, h("p", { class: "wait" }, "The source is being read …"));
    body.append(mutabot.fileTree(campaign, file), holder);
    let gone = false;
    mutabot.load("sources", "data/sources.js").then((sources) => {
      if (gone) return;
      const text = new Map(sources).get(file);
      holder.replaceChildren(text === undefined
        ? empty("The text of this file was not written down.", "The journal is of an older version of mutabot, or the file could not be read. The mutants are in ",
          h("a", { href: address(["mutants"], { file }) }, "the list"), ".")
        : code(file, text, campaign.mutants.filter((one) => one.file === file)));
      const wanted = asked.line && document.getElementById(`L${asked.line}`);
      if (wanted) { wanted.classList.add("wanted"); wanted.scrollIntoView({ block: "center" }); }
    }, (error) => { holder.replaceChildren(empty("The source cannot be shown.", error.message)); });
    return () => { gone = true; };
  });

  function code(file, text, mutants) {
    const byLine = new Map();
    for (const one of mutants) byLine.set(one.line, [...(byLine.get(one.line) || []), one]);
    const box = h("div", { class: "code", role: "list", "aria-label": `${file}, line by line` });
    coloured(file, text.replace(/\n$/, "")).forEach((line, index) => box.append(row(file, line, index + 1, byLine.get(index + 1) || [])));
    const toggle = h("label", { class: "toggle" }, h("input", { type: "checkbox", checked: true, onchange: (event) => { box.classList.toggle("bare", !event.target.checked); } }), "Survivors under their lines");
    return h("div", null, h("p", { class: "told" }, toggle), box, marks.legend(new Set(mutants.map(LETTER))),
      mutants.some((one) => one.survives && one.indistinguishable) ? h("p", { class: "hint" }, "Outlined: survived, and nothing that was compared differs from the original.") : "");
  }

  const TOKENS = /([rRbBfFuU]{0,2}(?:"""[^]*?"""|'''[^]*?'''|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'))|(#[^\n]*)|\b(and|as|assert|async|await|break|case|class|continue|def|del|elif|else|except|finally|for|from|global|if|import|in|is|lambda|match|nonlocal|not|or|pass|raise|return|try|while|with|yield|None|True|False)\b/g;
  const KINDS = ["string", "comment", "keyword"];
  /** The lines of a text as lists of parts; in Python, words of the language, strings and comments are marked. */
  function coloured(file, text) {
    const lines = [[]];
    const put = (part, kind) => part.split("\n").forEach((piece, index) => {
      if (index) lines.push([]);
      if (piece) lines[lines.length - 1].push(kind ? h("span", { class: kind }, piece) : piece);
    });
    let at = 0;
    for (const found of file.endsWith(".py") ? text.matchAll(TOKENS) : []) {
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
      alive.length > 5 ? h("li", null, h("a", { href: address(["mutants"], { file, line: String(at), status: "survived,not covered" }) }, `and ${alive.length - 5} more survivors here`)) : null) : null);
  }
})();
