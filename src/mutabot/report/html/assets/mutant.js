/* One mutant: what the robot did first, then where and what it is, who looked, and how each round ended. */
"use strict";
(() => {
  const { h, address, amount, between, count, number, empty, marks } = mutabot;
  const AROUND = 3, CHECKS = 40, LINES = 6;

  mutabot.views.set("mutant", (body, parts) => {
    const campaign = mutabot.campaign;
    const one = campaign.byNumber.get(Number(parts[0]));
    if (!one) {
      body.append(h("h1", { tabindex: "-1" }, "No such mutant"), empty(`There is no mutant ${parts[0] || ""} in this report.`, campaign.mutants.length
        ? `They are numbered ${campaign.mutants[0].number} to ${campaign.mutants[campaign.mutants.length - 1].number}. ` : "", h("a", { href: address(["mutants"]) }, "Show the list")));
      return undefined;
    }
    const order = mutabot.chosen(mutabot.lastAsked || {});
    const where = order.indexOf(one);
    const [before, after] = [where > 0 ? order[where - 1] : null, where >= 0 ? order[where + 1] : null];
    const [upper, lower] = survivorsBeside(one, campaign);
    const step = (to, text, key) => !to && !text ? null : to ? h("a", { href: address(["mutant", String(to.number)]), "aria-keyshortcuts": key }, text) : h("span", { class: "off" }, text);
    body.append(
      h("div", { class: "beside" },
        h("nav", { "aria-label": "Mutants beside this one" }, h("a", { href: address(["mutants"], mutabot.lastAsked) }, "All mutants"),
          step(before, "← Previous", "p"), h("span", null, where >= 0 ? `${where + 1} of ${order.length}` : ""), step(after, "Next →", "n")),
        upper || lower ? h("nav", { "aria-label": "Survivors beside this one in the source" }, h("span", null, "Survivors in the source:"),
          step(upper, upper && `↑ ${upper.number} in ${upper.place}`, "Shift+P"), step(lower, lower && `↓ ${lower.number} in ${lower.place}`, "Shift+N")) : null),
      h("h1", { tabindex: "-1" }, h("span", { class: "number" }, `${one.number} `), one.description),
      h("p", { class: "under" }, marks.status(one.status), one.ends.length > 1 ? h("span", null, "rounds ", marks.ends(one.ends)) : null, h("span", { class: "place" }, one.place, one.function ? ` in ${one.function}` : ""), h("span", null, `${one.operator} (${one.family}, ${one.role})`)),
      h("p", { class: "story big" }, mutabot.breakable(one.why)));
    const holder = h("div", null, h("p", { class: "wait" }, "The mutant is being read …"));
    body.append(holder);
    const stops = [];
    let gone = false;
    const keys = (event) => {
      if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.target.closest("input:not([type=range]):not([type=checkbox]), select, dialog")) return;
      const to = { n: after, p: before, N: lower, P: upper }[event.key];
      if (to) location.hash = address(["mutant", String(to.number)]);
    };
    addEventListener("keydown", keys);
    stops.push(() => removeEventListener("keydown", keys));
    mutabot.load(`mutant ${one.number}`, `data/mutants/${one.number}.js`).then((page) => { if (!gone) draw(holder, one, whole(one, page), stops); },
      (error) => { holder.replaceChildren(empty("This mutant cannot be shown.", error.message)); });
    return () => { gone = true; stops.forEach((stop) => stop()); };
  });

  /** The survivors before and after a mutant in the order of the source, the program's files first. */
  function survivorsBeside(one, campaign) {
    const rank = (each) => [campaign.files.indexOf(each.file), each.line, each.span.column, each.number];
    const order = (a, b) => { const [x, y] = [rank(a), rank(b)]; const at = x.findIndex((each, index) => each !== y[index]); return at < 0 ? 0 : x[at] - y[at]; };
    const found = campaign.mutants.filter((each) => each.survives && each.status !== "not covered" && each !== one).sort(order);
    const next = found.findIndex((each) => order(each, one) > 0);
    return next < 0 ? [found[found.length - 1] || null, null] : [found[next - 1] || null, found[next]];
  }

  const NOTHING = { test: null, exception: null, message: null, place: null, away: {}, example: null, divergence: [], gaps: [], indistinguishable: null, repeats: 0, beside: null, kills: [], diverged: [], looked: [] };
  const ALIKE = { at: null, what: "", story: "", apart: [], measurements: [], fault: null, example: null };
  /** The data of the page, with what they leave out where nothing is to be said. */
  function whole(one, page) {
    const { recordings, without } = mutabot.taken(`recordings ${one.number}`) || { recordings: [], without: 0 };
    const rounds = page.rounds.map((outcome) => outcome.verdict ? { ...NOTHING, ...outcome, diverged: (outcome.diverged || []).map((each) => ({ ...ALIKE, ...each })) } : null);
    return { ...page, rounds, recordings, withoutRecordings: without };
  }

  function draw(holder, one, page, stops) {
    const { seen, events } = robot(one, page, stops);
    holder.replaceChildren(seen, film(page.film), suggestion(page), h("div", { class: "columns" }, excerpt(one, page), facts(one, page)),
      events, looked(one, page), rounds(one, page));
  }

  /** How many characters stand before a column, which counts bytes of UTF-8 from 1. */
  const characters = (line, column) => new TextDecoder().decode(new TextEncoder().encode(line).slice(0, column - 1)).length;

  function excerpt(one, page) {
    const section = h("section", { "aria-labelledby": "there" }, h("h2", { id: "there" }, "Source location"));
    mutabot.load("sources", "data/sources.js").then((sources) => {
      for (const span of one.spans) section.append(...lines(span, new Map(sources).get(span.file), one.spans.length > 1));
      if (page.change) section.append(h("p", null, `At first, the ${one.role} ${page.change}`, page.effect_place ? [" (", page.effect_place, ")"] : null, "."));
    }, (error) => section.append(h("p", null, error.message)));
    return section;
  }

  /** The lines around a place; with its name where there are others. */
  function lines(span, text, isNamed) {
    if (text === undefined) return [empty(`The text of ${isNamed ? span.file : "this file"} was not written down.`)];
    const all = text.split("\n");
    const from = Math.max(1, span.line - AROUND), to = Math.min(all.length, span.end_line + AROUND);
    const box = h("div", { class: "code small" });
    for (let at = from; at <= to; at += 1) {
      const line = all[at - 1];
      const inside = at >= span.line && at <= span.end_line;
      const a = at === span.line ? characters(line, span.column) : line.search(/\S|$/), b = at === span.end_line ? characters(line, span.end_column) : line.length;
      box.append(h("div", { class: `line${inside ? " marked" : ""}` }, h("span", { class: "at" }, at), h("code", null, inside ? [line.slice(0, a), h("mark", null, line.slice(a, b)), line.slice(b)] : line || " ")));
    }
    const whole = isNamed ? `The whole of ${span.file}` : "The whole file";
    return [box, h("p", null, h("a", { class: "more", href: address(["source", span.file], { line: String(span.line) }) }, whole))];
  }

  function facts(one, page) {
    const rows = [["id", h("code", null, page.id)],
      one.operation ? ["operation", one.operation + (page.pattern ? `, command ${mutabot.command(page.pattern)}` : "")] : null,
      one.operation ? ["quantity", one.quantity ? `${one.quantity}${page.meaning ? `: ${["kind", "axis", "unit", "frame"].map((name) => page.meaning[name]).filter(Boolean).join(", ")}` : ""}` : "the call as a whole"] : null,
      ["operator", h("span", null, `${one.operator}${one.variant ? ` (${one.variant})` : ""}`, mutabot.campaign.operators[one.operator] ? h("small", null, mutabot.coded(mutabot.campaign.operators[one.operator])) : null)],
      ["killed", `in ${one.killed} of ${count(one.valid, "valid round")}${page.kill_rate.interval ? `; 95 % interval ${between(page.kill_rate.interval)}` : ""}`],
      ["reached by", one.reach.length ? h("ul", { class: "plain" }, one.reach.slice(0, 6).map((test) => h("li", null, h("code", null, mutabot.breakable(mutabot.campaign.tests[test])))), one.reach.length > 6 ? h("li", null, `and ${one.reach.length - 6} more tests`) : null) : "no test"],
      one.earlier || one.outdated ? ["note", "some of these results are from an earlier campaign"] : null];
    return h("section", { "aria-labelledby": "facts" }, h("h2", { id: "facts" }, "What it is"), h("dl", { class: "facts" }, rows.filter(Boolean).map(([name, value]) => [h("dt", null, name), h("dd", null, value)])));
  }

  // What the robot did

  /** The view of what the robot did, and what goes below the source: its commands, readings and contacts. */
  function robot(one, page, stops) {
    const events = h("section", { "aria-labelledby": "events" });
    const head = h("div", { class: "head" }, h("h2", { id: "robot" }, "What the robot did"));
    const section = h("section", { class: "robot", "aria-labelledby": "robot" }, head);
    if (!page.recordings.length) {
      const isRobot = mutabot.campaign.mutants.some((each) => each.operation) || page.withoutRecordings || page.rounds.some((outcome) => outcome && outcome.diverged.length);
      if (one.status === "not covered" || !isRobot) return { seen: "", events: "" };
      section.append(nothingRecorded(one, page));
      return { seen: section, events: "" };
    }
    const holder = h("div", null);
    const label = (found) => `round ${found.round + 1} · ${found.test.replace(/^.*::/, "")}`;
    if (page.recordings.length > 1) {
      head.append(h("div", null, h("label", { for: "recording", class: "unseen" }, "Round and test"),
        h("select", { id: "recording", onchange: (event) => show(Number(event.target.value)) }, page.recordings.map((found, index) => h("option", { value: index }, label(found))))));
    } else head.append(h("p", { class: "hint" }, label(page.recordings[0])));
    if (page.withoutRecordings) section.append(h("p", { class: "hint" }, `${count(page.withoutRecordings, "further recording")} had no room in this report; `, h("code", null, `mutabot show ${one.number}`), " prints what they recorded."));
    section.append(holder);
    let stop = [];
    stops.push(() => stop.forEach((each) => each()));
    async function show(index) {
      stop.forEach((each) => each());
      stop = [];
      const found = page.recordings[index];
      try {
        const usual = found.original === null ? null : mutabot.recordings.recording(await mutabot.load(`original ${found.original}`, `data/originals/${found.original}.js`));
        if (!section.isConnected) return;
        pair(holder, events, one, page, found, usual, mutabot.recordings.recording(found), stop);
      } catch (error) { holder.replaceChildren(empty("The recording cannot be shown.", error.message)); events.replaceChildren(); }
    }
    show(0);
    return { seen: section, events };
  }

  /** The film that was made of it, where it found room. */
  function film(found) {
    if (!found) return "";
    const where = `round ${found.round + 1} · ${found.test.replace(/^.*::/, "")}`;
    return h("section", { class: "film", "aria-labelledby": "film" }, h("div", { class: "head" }, h("h2", { id: "film" }, "Film"), h("p", { class: "hint" }, where)),
      found.file ? h("video", { src: found.file, controls: true, loop: true, muted: true, playsinline: true, preload: "metadata", "aria-label": `Original and mutant beside each other, ${where}` })
        : h("p", { class: "hint" }, `The film of ${(found.size / 1e6).toFixed(1)} MB had no room in this report.`));
  }

  function nothingRecorded(one, page) {
    if (page.withoutRecordings) return empty("There was no room for its recordings.", "The report holds those of the survivors with the largest deviation first. ", h("code", null, `mutabot show ${one.number}`), " prints what they recorded.");
    if (page.rounds.some((outcome) => outcome && outcome.diverged.length)) return empty("Its recordings were not kept.", "There was no room for them (", h("code", null, "evidence"), " in the configuration sets it), or their file was deleted. ", h("code", null, `mutabot show ${one.number}`), " prints what they recorded.");
    if (one.indistinguishable) return empty("The robot did the same as in the original.", "Nothing that was recorded, read or returned differs; there are no two paths to show.");
    if (!one.valid && !["refused", "guarded"].includes(one.status)) return empty("Nothing to show.", `This mutant was not counted: ${marks.MEANING[one.status]}.`);
    const where = page.rounds.some((outcome) => outcome && outcome.divergence.length) ? "What differs otherwise is listed below, by round. " : "";
    if (!mutabot.campaign.recorded) return empty("Nothing was recorded in this campaign.", where, "Recording is off (", h("code", null, "evidence = 0"), " in the configuration), or the file of recordings was deleted.");
    return empty(where ? "No recorded movement differs." : "Apart from the fault, no recorded command, reading or movement differs.", where, feed());
  }

  /** What makes movements visible. */
  const feed = () => ["Movements and contacts are recorded where the simulator has a feed (", h("code", null, "mutabot.api.processes.Feed"),
    "), as mutabot's own cells do. docs/evidence.md shows how to add one, also with ROS."];

  function pair(holder, events, one, page, found, usual, mutant, stop) {
    const ends = [usual, mutant].map((each) => (each ? Math.max(each.end || 0, ...each.calls.map((call) => call.ended || 0), 0) : 0));
    const outcome = page.rounds[found.round];
    const diverged = outcome && outcome.diverged.find((each) => each.test === found.test);
    const [farthest] = diverged ? [...diverged.measurements, ...diverged.apart].filter((each) => typeof each.at === "number").sort((each, other) => other.deviation - each.deviation) : [];
    const begin = farthest ? farthest.at : diverged && diverged.at !== null ? diverged.at : mutant.fault;
    const clock = new mutabot.recordings.Clock(Math.max(...ends), begin ?? Math.max(...ends));
    const named = (each) => each && [...each.tracks.values()].some((track) => track.times.length);
    holder.replaceChildren();
    if (diverged && diverged.story && !one.why.includes(diverged.story)) holder.append(h("p", { class: "story" }, diverged.story));
    const first = diverged && diverged.what ? h("p", null, h("strong", null, "First difference"), diverged.at !== null ? ` at ${diverged.at.toFixed(1)} s${diverged.is_simulated ? "" : " of the wall clock"}: ` : ": ", diverged.what) : "";
    const drawn = h("div", { class: "drawn-world" });
    if (named(mutant) || named(usual)) {
      const worlds = [usual && { name: "original", recording: usual, ink: () => mutabot.ink("original"), width: 1.6, dash: [6, 3] }, { name: "mutant", recording: mutant, ink: () => mutabot.ink("mutant"), width: 2.2, dash: [] }].filter(Boolean);
      const made = mutabot.scene(worlds, clock);
      stop.push(made.stop);
      drawn.append(h("div", { class: "world" }, key(usual), made.canvas, made.controls));
      drawn.append(h("div", { class: "multiples" }, mutabot.charts(usual, mutant, clock, diverged ? diverged.apart : [])));
      holder.append(slider(clock, mutant, made.canvas, stop), drawn);
    } else holder.append(h("p", { class: "hint" }, feed()));
    holder.append(first);
    events.replaceChildren(h("h2", { id: "events" }, "Commands, readings and contacts"), mutabot.timeline.lanes(usual, mutant, clock), mutabot.timeline.table(usual, mutant, clock, fault(one, diverged)), apart(diverged));
    if (mutant.problems.length) events.append(h("p", { class: "hint" }, `Not recorded: ${mutant.problems.join("; ")}`));
    if (!mutant.simulated) events.append(h("p", { class: "hint" }, "Times are of the wall clock: the vocabulary names no simulated clock."));
  }

  /** What the fault sends or reads in place of the program's value, when it acts first in this test. */
  function fault(one, diverged) {
    const [before, after] = (diverged && diverged.example) || [];
    const isValue = one.quantity && after !== undefined;
    return { name: isValue ? one.quantity : null, value: after, isSkipped: !one.quantity && Array.isArray(after) && !after.length,
      text: isValue ? `${one.quantity} ${value(after, one.unit, [before, after])} instead of ${value(before, one.unit, [before, after])}` : one.description };
  }

  const key = (usual) => h("ul", { class: "legend" }, usual ? h("li", null, h("span", { class: "swatch of-original", "aria-hidden": "true" }), "original") : null,
    h("li", null, h("span", { class: "swatch of-mutant", "aria-hidden": "true" }), "mutant"), h("li", null, h("span", { class: "swatch fault", "aria-hidden": "true" }), "moment of the fault"));

  function slider(clock, mutant, canvas, stop) {
    const range = h("input", { type: "range", min: 0, max: clock.end, step: "any", "aria-label": "Moment", oninput: (event) => clock.set(Number(event.target.value)) });
    const output = h("output", null);
    clock.on((time) => { range.value = time; range.setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`); output.textContent = `${time.toFixed(2)} s`; });
    let playing = 0;
    const button = h("button", { type: "button", class: "play", onclick: () => play() }, "Play");
    function play() {
      if (playing) { cancelAnimationFrame(playing); playing = 0; button.textContent = "Play"; return; }
      if (clock.time >= clock.end - 1e-6) clock.set(0);
      button.textContent = "Pause";
      let last = performance.now();
      const next = (now) => {
        clock.set(clock.time + (now - last) / 1000);
        last = now;
        if (clock.time >= clock.end) { playing = 0; button.textContent = "Play"; } else playing = requestAnimationFrame(next);
      };
      playing = requestAnimationFrame(next);
    }
    const keys = (event) => {
      if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input:not([type=range]), select, dialog")) return;
      const by = { "[": -0.1, "]": 0.1, "{": -1, "}": 1 }[event.key];
      if (by) { clock.set(clock.time + by); event.preventDefault(); }
      if (event.key === " " && event.target === canvas) { play(); event.preventDefault(); }
    };
    addEventListener("keydown", keys);
    stop.push(() => { removeEventListener("keydown", keys); cancelAnimationFrame(playing); });
    const to = (time, text) => time === null || time === undefined ? null : h("button", { type: "button", onclick: () => clock.set(time) }, text);
    const track = h("div", { class: "range" }, range);
    if (mutant.fault !== null && mutant.fault !== undefined && clock.end) {
      const flag = h("span", { class: "fault-mark", "aria-hidden": "true" });
      flag.style.left = `${100 * mutant.fault / clock.end}%`;
      track.append(flag);
    }
    return h("div", { class: "slider", role: "group", "aria-label": "Moment that is shown" }, button, track, output, to(mutant.fault, "To the fault"), to(clock.end, "To the end"));
  }

  function apart(diverged) {
    if (!diverged || !(diverged.apart.length || diverged.measurements.length)) return "";
    const known = (found, unit) => found === null || found === undefined ? "–" : amount(found, unit);
    const units = (one) => `${(one.deviation ?? 0) < 0.01 ? 0 : number(one.deviation, 2)}×`;
    const table = (title, names, rows) => rows.length ? h("div", null, h("h3", null, title), h("div", { class: "scroll", role: "region", tabindex: "0", "aria-label": title }, h("table", null,
      h("thead", null, h("tr", null, names.map((name, index) => h("th", { scope: "col", class: index ? "n" : null }, name || h("span", { class: "unseen" }, "what"))))),
      h("tbody", null, rows.map(([name, ...cells]) => h("tr", null, h("th", { scope: "row" }, name), cells.map((cell) => h("td", { class: "n" }, cell)))))))) : null;
    return h("div", { class: "measured" },
      table("What was measured", ["", "mutant", "original", "at", "deviation"], diverged.measurements.map((one) => [`${one.name} of ${one.thing}`, known(one.value, one.unit), known(one.original, one.unit), one.at === null || one.at === undefined ? "–" : `${number(one.at, 3)} s`, one.unit === "s" ? "–" : units(one)])),
      table("How far apart", ["", "first", "largest", "at", "at the end", "off its path", "deviation"], diverged.apart.map((one) => [one.name, `${number(one.first, 3)} s`, amount(one.largest, one.unit), `${number(one.at, 3)} s`, amount(one.final, one.unit), known(one.aside, one.unit), units(one)])),
      h("p", { class: "hint" }, "Deviation: the difference in units of the original's own spread over seeds in this test, or of 1 mm, 0.5 deg, 0.01 m/s or a hundredth of a value's range where that is less. A turn on the way only counts a tenth."));
  }

  // Who looked, suggestion, rounds

  function looked(one, page) {
    const section = h("section", { "aria-labelledby": "looked" }, h("h2", { id: "looked" }, "Checks that ran"));
    const outcome = page.rounds.find((each) => each && each.looked.length);
    if ((!one.survives && one.status !== "accepted") || one.status === "not covered") return "";
    if (!outcome) {
      section.append(empty("It is not known what the tests checked.", "Checks are seen where pytest rewrites assertions; this journal holds none for this mutant."));
      return section;
    }
    section.append(h("p", { class: "hint" }, `Round ${outcome.round}: each check, the values that it compared or was passed, and by how much it held. Checks that ran before the tests' process reached the fault are not listed.`));
    const [story] = outcome.diverged; // the test of the story comes first
    outcome.looked.toSorted((test, other) => other.acted - test.acted || (story ? (other.test === story.test) - (test.test === story.test) : 0)).forEach((test, index) => section.append(checked(one, { checks: [], ...test }, index === 0)));
    return section;
  }

  function checked(one, test, isOpen) {
    const many = test.checks.length + test.more;
    const conclusion = !test.acted ? "the mutant changed nothing in it" : !many ? "no check was seen after the fault; assertions that pytest does not rewrite are not seen"
      : `${count(many, "check")} held`;
    if (!test.acted || !test.checks.length) return h("p", null, h("code", null, mutabot.breakable(test.test)), `: ${conclusion}`);
    return h("details", { class: "test-box", open: isOpen }, h("summary", null, h("code", null, mutabot.breakable(test.test)), `: ${conclusion}`),
      h("div", { class: "scroll", role: "region", tabindex: "0", "aria-label": `Checks of ${test.test}` }, h("table", { class: "checks" },
        h("thead", null, h("tr", null, h("th", { scope: "col" }, "place"), h("th", { scope: "col" }, "check"), h("th", { scope: "col" }, "with"), h("th", { scope: "col", class: "n" }, "to spare"))),
        h("tbody", null, test.checks.slice(0, CHECKS).map(({ place, text, seen, spare, times }) => h("tr", null,
          h("td", null, place.replace(/^.*\//, "")), h("td", null, h("code", null, text), times > 1 ? h("small", null, `${times} times, the nearest to fail`) : null),
          h("td", null, seen ? h("code", null, seen) : "–"), h("td", { class: "n" }, number(spare, 3))))))),
      many > CHECKS ? h("p", { class: "hint" }, `and ${count(many - CHECKS, "more check")}; `, h("code", null, `mutabot show ${one.number} --json`), " has those that were kept.") : null);
  }

  function suggestion(page) {
    const found = page.suggestion;
    if (!found && !page.next) return "";
    if (!found) return h("section", { "aria-labelledby": "suggestion" }, h("h2", { id: "suggestion" }, "What to do"), h("p", null, mutabot.coded(page.next)));
    return h("section", { class: "suggestion", "aria-labelledby": "suggestion" }, h("h2", { id: "suggestion" }, "A check that would catch it"), found.test ? h("p", null, "In ", h("code", null, found.test), ":") : null,
      h("pre", { tabindex: "0" }, h("code", null, found.code)), h("ul", { class: "plain" }, (found.notes || []).map((note) => h("li", null, mutabot.coded(note)))));
  }

  function rounds(one, page) {
    const section = h("section", { "aria-labelledby": "rounds" }, h("h2", { id: "rounds" }, "Rounds"));
    const alike = new Map();
    page.rounds.forEach((outcome, round) => {
      const like = outcome ? JSON.stringify([one.ends[round], outcome.test, outcome.exception, outcome.place, (outcome.message || "").replace(/-?\d+(\.\d+)?(e-?\d+)?/g, "0"), outcome.divergence.map((line) => line.replace(/-?\d+(\.\d+)?(e-?\d+)?/g, "0"))]) : "";
      alike.set(like, [...(alike.get(like) || []), round]);
    });
    for (const those of alike.values()) section.append(round(one, page, those));
    return section;
  }

  /** The first value and the one in its place, in the test of the story. */
  const first = (outcome) => outcome && ((outcome.diverged[0] && outcome.diverged[0].example) || outcome.example);

  function round(one, page, those) {
    const outcome = page.rounds[those[0]];
    const letter = one.ends[those[0]];
    const head = h("h3", { class: "round" }, marks.mark(letter), ` Round${those.length > 1 ? "s" : ""} ${those.map((each) => each + 1).join(", ")}: ${marks.LETTERS[letter][1]}`);
    if (!outcome) return h("div", null, head, h("p", null, "Not run yet."));
    const values = one.operation && !one.quantity ? [] : those.map((each) => [each, first(page.rounds[each])]).filter(([, pair]) => pair && pair.length === 2);
    return h("div", { class: "round-box" }, head,
      outcome.test ? h("p", null, "in ", h("code", null, outcome.test), outcome.place ? [" at ", h("code", null, outcome.place)] : null) : null,
      outcome.message ? h("pre", { tabindex: "0", "aria-label": "What the test said" }, `${outcome.exception ? `${outcome.exception.replace(/^.*:/, "")}: ` : ""}${outcome.message.trimEnd()}`) : null,
      outcome.kills.length > 1 ? h("p", null, "Also killed by ", outcome.kills.slice(1).map(({ test, by }, index) => [index ? ", " : "", h("code", null, test), ` (${by})`])) : null,
      outcome.divergence.length || outcome.gaps.length ? h("ul", { class: "plain" }, outcome.divergence.slice(0, LINES).map((line) => h("li", null, mutabot.breakable(line))), outcome.divergence.length > LINES ? h("li", null, `and ${count(outcome.divergence.length - LINES, "more difference")}`) : null, outcome.gaps.map((line) => h("li", null, `not compared: ${line}`))) : null,
      values.length ? h("div", { class: "scroll", role: "region", tabindex: "0", "aria-label": "Values" }, h("table", { class: "values" }, h("thead", null, h("tr", null, ["round", "first value", "in its place"].map((name, index) => h("th", { scope: "col", class: "n" }, name)))),
        h("tbody", null, values.map(([each, pair]) => h("tr", null, h("td", { class: "n" }, each + 1), pair.map((found) => h("td", { class: "n" }, value(found, one.unit, pair)))))))) : null,
      h("p", { class: "hint" }, [`acted at ${outcome.acted} of ${count(outcome.hits, "hit")}`, `${count(outcome.tests, "test")} run`, outcome.indistinguishable && "no measured difference",
        `${number(outcome.wall, 2)} s`, outcome.confirmed === false ? "not confirmed by the whole suite" : null, outcome.repeats ? `re-run ${count(outcome.repeats, "time")} with the same result` : null, outcome.beside ? `re-run alone, because beside others it exceeded the wall clock: ${outcome.beside}` : null, ...Object.entries(outcome.away).map(([why, many]) => `left ${count(many, "call")} unchanged: ${why}`)].filter(Boolean).join(" · ")));
  }
  /** Digits with which both values of a pair differ, as in the terminal. */
  const digits = ([before, after]) => (typeof before === "number" && typeof after === "number" && number(before, 6) === number(after, 6) ? 12 : 6);
  const value = (found, unit, pair) => `${typeof found === "number" ? number(found, digits(pair)) : String(found)}${unit && typeof found === "number" ? ` ${unit}` : ""}`;
})();
