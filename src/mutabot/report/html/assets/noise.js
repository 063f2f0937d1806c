/* The noise that was drawn: by how much each reading was moved, round by round. */
"use strict";
(() => {
  const { h, svg, address, number, empty, marks } = mutabot;

  mutabot.views.set("noise", (body) => {
    const found = mutabot.campaign.mutants.filter((one) => one.drawn);
    body.append(h("h1", { tabindex: "-1" }, "Noise that was drawn"));
    if (!found.length) { body.append(empty("No noise was planted.", "The operator noise acts on positions, distances and angles that the program or its tests read; none was in the plan.")); return; }
    body.append(h("p", { class: "lead" }, "What the operator noise added to a reading where it first acted, one mark per round. Each mutant and round has a generator of its own: the same seed draws the same noise."));
    body.append(h("div", { class: "scroll", role: "region", tabindex: "0", "aria-label": "Noise" }, h("table", { class: "noise" },
      h("thead", null, h("tr", null, ["no.", "reading", "added, by round", "read in round 1", "with noise", "rounds"].map((name, index) => h("th", { scope: "col", class: [0, 3, 4].includes(index) ? "n" : null }, name)))),
      h("tbody", null, found.map((one) => line(one, most(found, one.unit)))))));
  });

  /** The largest that was drawn in this unit: one scale for all that can be compared. */
  const most = (found, unit) => Math.max(...found.filter((one) => one.unit === unit).flatMap((one) => one.drawn.map(([, before, after]) => Math.abs(after - before))), 1e-12);

  function line(one, most) {
    const drawn = one.drawn.map(([round, before, after]) => [round, after - before, before, after]);
    const unit = one.unit ? ` ${one.unit}` : "";
    const told = drawn.map(([round, by]) => `round ${round + 1} ${number(by, 3)}${unit}`).join(", ");
    return h("tr", null,
      h("td", { class: "n" }, h("a", { href: address(["mutant", String(one.number)]), "aria-label": `mutant ${one.number}` }, one.number)),
      h("th", { scope: "row" }, one.description, h("small", null, one.place)),
      h("td", null, drawn.length ? svg("svg", { class: "drawn", viewBox: "0 0 220 34", role: "img", "aria-label": told },
        svg("line", { class: "axis", x1: 6, x2: 214, y1: 18, y2: 18 }), svg("line", { class: "axis", x1: 110, x2: 110, y1: 6, y2: 24 }),
        drawn.map(([round, by]) => svg("circle", { class: "dot", cx: 110 + 100 * by / most, cy: 18, r: 4 }, svg("title", null, `round ${round + 1}: ${number(by, 3)}${unit}`))),
        svg("text", { x: 6, y: 33 }, `−${number(most, 2)}${unit}`), svg("text", { x: 214, y: 33, "text-anchor": "end" }, `+${number(most, 2)}${unit}`)) : "it never acted"),
      h("td", { class: "n" }, drawn.length ? `${number(drawn[0][2], 4)}${unit}` : ""), h("td", { class: "n" }, drawn.length ? `${number(drawn[0][3], 4)}${unit}` : ""),
      h("td", null, marks.ends(one.ends)));
  }
})();
