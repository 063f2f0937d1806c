/* Operators × verdicts. */
"use strict";
(() => {
  const { h, address, empty, marks, percent } = mutabot;

  mutabot.views.set("operators", (body) => {
    const campaign = mutabot.campaign;
    body.append(h("h1", { tabindex: "-1" }, "Operators and verdicts"), h("p", { class: "lead" }, "Outcomes over all rounds. A number leads to the mutants that have such an outcome."));
    if (!campaign.mutants.length) { body.append(empty("No operator acted.", "The campaign planned no mutant.")); return; }
    const rows = new Map();
    for (const one of campaign.mutants) {
      const key = `${one.family}\n${one.operator}\n${one.role}`;
      if (!rows.has(key)) rows.set(key, { ...one, mutants: 0, letters: {} });
      const row = rows.get(key);
      row.mutants += 1;
      for (const end of one.ends) {
        const letter = one.status === "accepted" ? "A" : end; // in no score, whatever its rounds say
        row.letters[letter] = (row.letters[letter] || 0) + 1;
      }
    }
    const used = Object.keys(marks.LETTERS).filter((letter) => [...rows.values()].some((row) => row.letters[letter]));
    body.append(h("div", { class: "scroll", role: "region", tabindex: "0", "aria-label": "Operators and verdicts" }, h("table", { class: "operators" },
      h("thead", null, h("tr", null, h("th", { scope: "col" }, "operator"), h("th", { scope: "col" }, "role"), h("th", { scope: "col", class: "n" }, "mutants"),
        h("th", { scope: "col", class: "n" }, "killed"), used.map((letter) => h("th", { scope: "col", class: "n" }, marks.mark(letter))))),
      h("tbody", null, [...rows.values()].map((row) => line(row, used, campaign))))), marks.legend(new Set(used)));
  });

  function line(row, used, campaign) {
    const total = Object.values(row.letters).reduce((sum, one) => sum + one, 0);
    const killed = ["C", "X", "T"].reduce((sum, letter) => sum + (row.letters[letter] || 0), 0);
    const valid = killed + ["S", "N"].reduce((sum, letter) => sum + (row.letters[letter] || 0), 0);
    return h("tr", null,
      h("th", { scope: "row" }, h("a", { href: address(["mutants"], { operator: row.operator, role: row.role }) }, row.operator), h("small", null, row.family, campaign.operators[row.operator] ? [": ", mutabot.coded(campaign.operators[row.operator])] : null)),
      h("td", null, row.role), h("td", { class: "n" }, row.mutants), h("td", { class: "n" }, valid ? percent(killed / valid, 0) : "–"),
      used.map((letter) => {
        const found = row.letters[letter] || 0;
        const cell = h("td", { class: `n cell c-${marks.LETTERS[letter][0]}${found ? "" : " is-none"}`, "data-letter": letter }, found
          ? h("a", { href: address(["mutants"], { operator: row.operator, role: row.role, ...(letter === "A" ? { status: "accepted" } : { end: letter }) }), "aria-label": `${found} ${marks.LETTERS[letter][1]}` }, found)
          : h("span", { class: "none" }, "·"));
        if (found) cell.style.setProperty("--share", String(Math.round(100 * found / total)));
        return cell;
      }));
  }
})();
