/* Small charts over time, original and mutant in each: one per number of each track. */
"use strict";
(() => {
  const { h, svg, number } = mutabot;
  const { at, turned } = mutabot.recordings;
  const WIDE = 400, HIGH = 100;

  /** What there is to draw: name, unit, and a function from a row to the number. */
  function measures(one) {
    if (one.kind === "value") return [{ name: one.name, unit: one.unit, of: (row) => row[0], tolerance: null }];
    const start = one.rows[0];
    const found = ["x", "y", "z"].map((axis, index) => ({ name: `${one.name} ${axis}`, unit: "m", of: (row) => row[index], tolerance: 0.002 }));
    if (one.kind === "pose") found.push({ name: `${one.name} turned`, unit: "deg", of: (row) => turned(start, row), tolerance: 1 });
    return found;
  }

  /** All charts of a pair; those in which the two differ come first, the others on demand. */
  function charts(original, mutant, clock, apart) {
    const end = clock.end;
    const made = [];
    for (const one of mutant.tracks.values()) {
      const usual = original && original.tracks.get(one.name);
      if (!one.times.length || one.kind === "line") continue; // lines are only drawn
      for (const measure of measures(usual && usual.times.length ? usual : one)) made.push(chart(one, usual, measure, end, mutant.fault, clock, apart.find((each) => each.name === measure.name)));
    }
    const different = made.filter((one) => one.differs).sort((one, other) => other.share - one.share);
    const same = made.filter((one) => !one.differs);
    const box = h("div", { class: "charts" }, (different.length ? different : same).map((one) => one.element));
    if (different.length) box.append(h("p", { class: "hint" }, "Max. difference: between original and mutant at the same moment, so that a delay counts as well."));
    if (!different.length || !same.length) return box;
    const rest = h("details", null, h("summary", null, `${same.length} more without a difference: ${same.map((one) => one.name).join(", ")}`),
      h("div", { class: "charts" }, same.map((one) => one.element)));
    return h("div", null, box, rest);
  }

  function chart(one, usual, measure, end, fault, clock, known) {
    const lines = [usual, one].map((track) => (track && track.times.length ? points(track, measure, end) : []));
    const values = lines.flat().map(([, value]) => value);
    let low = Math.min(...values), high = Math.max(...values);
    if (high - low < 1e-9) { low -= 0.5; high += 0.5; }
    const [gap, when] = known ? [known.largest, known.at] : usual && usual.times.length ? largest(one, usual, measure) : [0, 0];
    const tolerance = measure.tolerance === null ? 0.02 * (high - low) : measure.tolerance;
    const x = (time) => WIDE * time / (end || 1);
    const y = (value) => 4 + (HIGH - 8) * (1 - (value - low) / (high - low));
    const cursor = svg("line", { class: "cursor", y1: 0, y2: HIGH });
    const drawing = svg("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, preserveAspectRatio: "none", role: "img",
      "aria-label": `${measure.name} over time, in ${measure.unit || "its own unit"}: from ${number(low)} to ${number(high)}; ${gap > tolerance ? `max. difference ${number(gap, 3)} at ${number(when, 3)} s` : "the same in both"}`,
      onclick: (event) => clock.set(end * (event.offsetX / drawing.clientWidth)) },
    low < 0 && high > 0 ? svg("line", { class: "zero", x1: 0, x2: WIDE, y1: y(0), y2: y(0) }) : null,
    fault !== null && fault !== undefined ? svg("line", { class: "fault", x1: x(fault), x2: x(fault), y1: 0, y2: HIGH }) : null,
    lines.map((line, index) => svg("polyline", { class: index ? "of-mutant" : "of-original", points: line.map(([time, value]) => `${x(time).toFixed(1)},${y(value).toFixed(1)}`).join(" ") })), cursor);
    const now = h("span", { class: "now", title: "original → mutant, at the moment shown" });
    clock.on((time) => {
      cursor.setAttribute("x1", x(time));
      cursor.setAttribute("x2", x(time));
      const here = at(one, time), there = usual && at(usual, time);
      now.textContent = `${there ? number(measure.of(there), 3) : "–"} → ${here ? number(measure.of(here), 3) : "–"}${measure.unit ? ` ${measure.unit}` : ""}`;
    });
    const element = h("figure", { class: "chart" },
      h("figcaption", null, h("strong", null, measure.name), measure.unit ? ` ${measure.unit}` : "", now),
      h("div", { class: "plot" }, drawing, h("span", { class: "high" }, number(high, 3)), h("span", { class: "low" }, number(low, 3))),
      gap > tolerance ? h("p", null, `max. difference ${number(gap, 2)}${measure.unit ? ` ${measure.unit}` : ""} at ${number(when, 3)} s`) : h("p", null, usual ? "the same" : "not in the original"));
    return { element, name: measure.name, differs: gap > tolerance || !usual, share: gap / (tolerance || 1) };
  }

  /** The points of a line; between turns of a rod the angle is no straight line, so a few are put between. */
  function points(track, measure, end) {
    const found = [];
    track.times.forEach((time, index) => {
      if (index && measure.unit === "deg") for (let part = 1; part < 4; part += 1) { const between = track.times[index - 1] + part / 4 * (time - track.times[index - 1]); const row = at(track, between); if (row) found.push([between, measure.of(row)]); }
      found.push([time, measure.of(track.rows[index])]);
    });
    const last = track.times[track.times.length - 1];
    if (last < end) found.push([Math.min(last, end), measure.of(track.rows[track.rows.length - 1])]);
    return found;
  }

  /** The largest difference, and when it was first as large, bar what points that were left out can make. */
  function largest(one, usual, measure) {
    const gaps = [...new Set([...one.times, ...usual.times])].sort((a, b) => a - b).map((time) => {
      const here = at(one, time), there = at(usual, time);
      return [here && there ? Math.abs(measure.of(here) - measure.of(there)) : 0, time];
    });
    const most = Math.max(...gaps.map(([gap]) => gap));
    return [most, gaps.find(([gap]) => gap >= 0.98 * most)[1]];
  }

  mutabot.charts = charts;
})();
