/* Tests × mutants: what each test reaches and kills, and tests that kill nothing. */
"use strict";
(() => {
  const { h, address, count, empty, ink, number } = mutabot;
  const PAGE = 60;

  mutabot.views.set("tests", (body) => {
    const campaign = mutabot.campaign;
    body.append(h("h1", { tabindex: "-1" }, "Tests and the mutants they kill"));
    if (!campaign.tests.length) { body.append(empty("No test is known.", "The campaign ended before its baseline; ", h("code", null, "mutabot check"), " tries the set-up.")); return undefined; }
    const rows = summed(campaign);
    const none = rows.filter((one) => !one.kills);
    body.append(
      h("p", { class: "lead" }, mutabot.isUnderWay(campaign) ? `${rows.length - none.length} of ${count(rows.length, "test")} killed a mutant so far; the others may still do so.`
        : none.length
        ? `${none.length} of ${count(rows.length, "test")} ${none.length === 1 ? "is" : "are"} not known to kill a mutant.`
        : rows.length === 1 ? "The only test kills mutants." : `Each of the ${rows.length} tests kills mutants.`),
      h("p", { class: "hint" }, "A run stops at the first test that kills the mutant, so that other tests that would kill it are not run; ", h("code", null, "mutabot minimal"), " runs every test on every mutant. ",
        "“Alone” counts mutants that no other test is known to kill."));
    const letters = h("ul", { class: "legend" }, [["check", "C", "killed by a check"], ["exception", "X", "killed otherwise"], ["reached", " ", "reached, not killed by it"], ["blank", " ", "not reached"]]
      .map(([kind, letter, words]) => h("li", null, h("span", { class: `mark m-${kind}`, "aria-hidden": "true" }, letter), words)));
    const holder = h("div", null);
    body.append(letters, holder);
    let { order, page } = mutabot.lastTests || { order: "kills", page: 1 };
    const orders = { file: (one) => one.index, reaches: (one) => -one.reaches, kills: (one) => -one.kills, alone: (one) => -one.alone };
    const stop = [];
    function draw() {
      mutabot.lastTests = { order, page };
      const sorted = [...rows].sort((one, other) => orders[order](one) - orders[order](other) || one.index - other.index);
      const pages = Math.ceil(sorted.length / PAGE);
      const head = (name, text, kind) => h("th", { scope: "col", class: kind, "aria-sort": order === name ? (name === "file" ? "ascending" : "descending") : null },
        h("button", { type: "button", class: "sort", onclick: () => { order = name; page = 1; draw(); } }, text, h("span", { "aria-hidden": "true" }, order === name ? " ↓" : "")));
      const shown = sorted.slice(PAGE * (page - 1), PAGE * page);
      holder.replaceChildren(h("div", { class: "scroll", role: "region", tabindex: "0", "aria-label": "Tests × mutants" }, h("table", { class: "matrix" },
        h("thead", { "data-label": "sort by" }, h("tr", null, head("file", "test"), head("reaches", "reaches", "n"), head("kills", "kills", "n"), h("th", { scope: "col", class: "n" }, "by a check"), head("alone", "alone", "n"),
          h("th", { scope: "col" }, `the ${campaign.mutants.length} mutants, in the order of the program`))),
        h("tbody", null, shown.map((one) => line(one, campaign))))),
      pages > 1 ? h("nav", { class: "pager", "aria-label": "Pages of tests" },
        h("button", { type: "button", disabled: page === 1, onclick: () => { page -= 1; draw(); } }, "Previous"), h("span", null, `${page} of ${pages}`),
        h("button", { type: "button", disabled: page === pages, onclick: () => { page += 1; draw(); } }, "Next")) : "");
      paint();
    }
    function paint() { for (const one of holder.querySelectorAll("canvas")) strip(one, rows[Number(one.dataset.test)], campaign); }
    draw();
    addEventListener("theme", paint);
    const watch = new ResizeObserver(paint);
    watch.observe(holder);
    stop.push(() => { removeEventListener("theme", paint); watch.disconnect(); });
    return () => stop.forEach((one) => one());
  });

  function summed(campaign) {
    const rows = campaign.tests.map((name, index) => ({ name, index, reaches: 0, kills: 0, byCheck: 0, alone: 0, cells: new Uint8Array(campaign.mutants.length), odd: new Set(), simulated: null }));
    const byName = new Map(rows.map((row) => [row.name, row]));
    for (const { test, outcome, simulated } of campaign.baseline) {
      if (outcome !== "passed") byName.get(test).odd.add(outcome);
      byName.get(test).simulated = simulated ?? byName.get(test).simulated;
    }
    campaign.mutants.forEach((one, at) => {
      for (const test of one.reach) { rows[test].reaches += 1; rows[test].cells[at] = 1; }
      for (const [test, , byCheck] of one.kills) {
        const row = rows[test];
        if (!row.cells[at]) row.reaches += 1;
        row.kills += 1;
        row.byCheck += byCheck ? 1 : 0;
        row.alone += one.kills.length === 1 ? 1 : 0;
        row.cells[at] = byCheck ? 3 : 2;
      }
    });
    return rows;
  }

  function line(one, campaign) {
    const [file, name] = one.name.includes("::") ? one.name.split(/::(.*)/s) : [null, one.name];
    const canvas = h("canvas", { "data-test": one.index, role: "img", "aria-label": `of ${campaign.mutants.length} mutants it reaches ${one.reaches} and kills ${one.kills}`, height: 22,
      onclick: (event) => {
        const at = Math.floor(campaign.mutants.length * event.offsetX / event.target.clientWidth);
        if (campaign.mutants[at]) location.hash = address(["mutant", String(campaign.mutants[at].number)]);
      },
      onmousemove: (event) => {
        const found = campaign.mutants[Math.floor(campaign.mutants.length * event.offsetX / event.target.clientWidth)];
        event.target.title = found ? mutabot.legible(`${found.number} ${found.description}`) : "";
      } });
    return h("tr", { class: one.kills ? null : "kills-nothing" },
      h("th", { scope: "row" }, file ? h("small", null, mutabot.breakable(file)) : null,
        h("a", { href: address(["mutants"], { test: String(one.index) }) }, mutabot.breakable(name)), one.odd.size ? h("small", null, ` on the original: ${[...one.odd].join(", ")}`) : null,
        one.simulated === null ? null : h("small", null, ` ${number(one.simulated, 3)} s simulated`)),
      h("td", { class: "n" }, one.reaches), h("td", { class: "n" }, one.kills || h("strong", null, "0")), h("td", { class: "n" }, one.byCheck), h("td", { class: "n" }, one.alone),
      h("td", { class: "cells" }, canvas));
  }

  function strip(canvas, row, campaign) {
    const width = Math.max(1, canvas.clientWidth), ratio = devicePixelRatio || 1, height = 22;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const draw = canvas.getContext("2d");
    draw.scale(ratio, ratio);
    const colours = [null, ink("cell-reached"), ink("cell-exception"), ink("cell-check")];
    const cell = width / row.cells.length;
    const gap = cell > 6 ? 1 : 0;
    row.cells.forEach((value, at) => {
      if (!value) return;
      draw.fillStyle = colours[value];
      const low = value === 1 ? height - 6 : value === 2 ? 8 : 1; // height tells as well as colour
      draw.fillRect(at * cell, low, Math.max(0.6, cell - gap), height - low - 1);
    });
  }
})();
