/* The overview: scores, what to act on, what is not known. */
"use strict";
(() => {
  const { h, svg, address, percent, between, count, number, duration, empty, marks } = mutabot;
  const SHOWN = 10;

  mutabot.views.set("", (body) => {
    const campaign = mutabot.campaign;
    const survivors = campaign.survivors.map((number) => campaign.byNumber.get(number));
    const graded = (campaign.ladders || []).length;
    const things = [(campaign.mutants.length || !graded) && (campaign.meta.selected_of > campaign.mutants.length ? `${campaign.mutants.length} of ${count(campaign.meta.selected_of, "mutant")}` : count(campaign.mutants.length, "mutant")), graded && count(graded, "ladder")];
    const judging = campaign.mutants.length || !graded
      ? [toActOn(survivors, campaign), h("div", { class: "columns" }, unseen(campaign), outside(campaign))] : [];
    body.append(
      h("h1", { tabindex: "-1" }, `${things.filter(Boolean).join(" and ")} × ${count(campaign.rounds, "round")}`),
      state(campaign),
      scores(campaign),
      untested(campaign),
      ...judging.slice(0, 1),
      ...(graded ? [ladders(campaign)] : []),
      ...judging.slice(1),
      trust(campaign),
    );
  });

  /** What no test reaches of the program, by name. */
  function untested(campaign) {
    const names = Object.entries(campaign.named);
    if (!names.length) return "";
    return h("section", { "aria-labelledby": "untested" }, h("h2", { id: "untested" }, campaign.untested.text || "Calls that no test reaches may be robot calls"),
      names.map(([what, those]) => h("details", null, h("summary", null, `${what}: ${those.length}`),
        h("ul", { class: "plain small" }, those.map((one) => h("li", null, h("code", null, mutabot.breakable(one))))))));
  }

  /** Whether the page is served by the campaign itself: then it says above how far it is. */
  const isUnderWay = (campaign) => Boolean(mutabot.live) && campaign.state === "running";
  mutabot.isUnderWay = isUnderWay;

  function state(campaign) {
    const meta = campaign.meta;
    const complete = campaign.state === "complete" && campaign.done >= campaign.planned;
    const facts = [typeof meta.seconds === "number" && `the last run took ${duration(meta.seconds)}`,
      meta.families && `${meta.families.length > 1 ? "families" : "family"} ${meta.families.join(", ")}`, count(campaign.tests.length, "test"),
      campaign.drawing && `a sample of ${campaign.drawing.size}${campaign.drawing.size.endsWith("%") ? "" : " of each family,"} of ${count(campaign.drawing.selected, "mutant")}`];
    return [
      h("p", { class: "lead" }, complete ? "complete · " : "", facts.filter(Boolean).join(" · ")),
      complete || isUnderWay(campaign) ? null : h("p", { class: "notice" }, h("strong", null, `This campaign is not complete (${campaign.state}): `),
        `${campaign.done} of ${campaign.planned} outcomes are known. `, h("code", null, "mutabot run"), " continues it."),
      campaign.attempt ? h("p", { class: "notice" }, `A later run ended before its first mutant: ${campaign.attempt}`) : null,
    ].flat().reduce((box, one) => { if (one) box.append(one); return box; }, h("div", { class: "state" }));
  }

  function scores(campaign) {
    if (!campaign.groups.length && campaign.ladders && campaign.ladders.length) {
      return empty("Only graded mutants, which have no score.", "The table below shows how large a fault must be before the tests notice.");
    }
    if (!campaign.groups.length) {
      return empty("No mutants were planned.", "No operator of the chosen families fits a call that the tests reach. ",
        h("code", null, "mutabot check"), " says which operations are reached, and ", h("code", null, "mutabot list"), " what could be planned.");
    }
    const head = h("tr", null, ["family · role", "score", "", "check score", "outcomes over all rounds", "mutants"].map((name, index) =>
      h("th", { scope: "col", class: [1, 3, 5].includes(index) ? "n" : null }, name || h("span", { class: "unseen" }, "score with rounds and interval"))));
    return h("section", { "aria-labelledby": "scores" }, h("h2", { id: "scores" }, "Scores"),
      h("div", { class: "scroll", role: "region", tabindex: "0", "aria-label": "Table of scores" },
        h("table", { class: "scores" }, h("thead", null, head), h("tbody", null, campaign.groups.map((one) => group(one))))),
      h("p", { class: "hint" }, "Score: share of valid mutants that were killed, averaged over rounds. Check score: the share killed by an assertion rather than by a crash or robot error. ",
        "Bar: 95 % interval; ticks: single rounds; hollow mark: check score. There is no combined score across families and roles."),
      (campaign.bugs_caught || []).map((text) => h("p", { class: "hint" }, text)));
  }

  function group(one) {
    return h("tr", null,
      h("th", { scope: "row" }, h("a", { href: address(["mutants"], { family: one.family, role: one.role }) }, `${one.family} · ${one.role}`)),
      h("td", { class: "n big" }, percent(one.score), h("small", null, between(one.interval) || (one.score === null ? (Object.values(one.counts).some(Boolean) ? "nothing valid" : "not run yet") : "no interval"))),
      h("td", null, dots(one)),
      h("td", { class: "n" }, percent(one.check_score), h("small", null, between(one.check_interval))),
      h("td", null, bar(one)),
      h("td", { class: "n" }, one.mutants, one.population ? h("small", null, `drawn of ${one.population}`) : null,
        one.accepted ? h("small", null, `${one.accepted} accepted`) : null));
  }

  /** The score's interval, its rounds and the check score on a scale from 0 to 100 %. */
  function dots(one) {
    const x = (share) => 4 + 192 * share;
    const rounds = one.rounds.filter((round) => round.score !== null);
    const scores = rounds.map((round, index) => `round ${index + 1} ${percent(round.score)}`).join(", ");
    return svg("svg", { class: "dots", viewBox: "0 0 200 34", role: "img", "aria-label": `Score ${percent(one.score)}${one.interval ? `, 95 % interval ${between(one.interval)}` : ""}; ${scores}; check score ${percent(one.check_score)}` },
      svg("line", { class: "axis", x1: x(0), x2: x(1), y1: 22, y2: 22 }),
      [0, 0.25, 0.5, 0.75, 1].map((share) => svg("line", { class: "axis", x1: x(share), x2: x(share), y1: 20, y2: 24 })),
      [0, 0.5, 1].map((share) => svg("text", { x: x(share), y: 33, "text-anchor": share === 0 ? "start" : share === 1 ? "end" : "middle" }, 100 * share)),
      one.interval ? svg("rect", { class: "interval", x: x(one.interval.low), width: Math.max(1, x(one.interval.high) - x(one.interval.low)), y: 8, height: 6, rx: 1 }) : null,
      rounds.map((round) => svg("line", { class: "round", x1: x(round.score), x2: x(round.score), y1: 5, y2: 17 })),
      one.check_score !== null ? svg("circle", { class: "check", cx: x(one.check_score), cy: 11, r: 3.6 }) : null,
      one.score !== null ? svg("circle", { class: "mean", cx: x(one.score), cy: 11, r: 4 }) : null);
  }

  const KINDS = [["check", "C", "killed by a check"], ["exception", "X", "by an exception"], ["timeout", "T", "by a timeout"], ["survived", "S", "survived"],
    ["uncovered", "N", "not covered"], ["refused", "R", "refused"], ["guarded", "G", "refused by the guard"], ["invalid", "I", "invalid"], ["idle", "=", "no effect"], ["unstable", "U", "unstable"], ["error", "E", "error"]];
  const NAMES = { timeout: "timeout", survived: "survived", uncovered: "not covered", refused: "refused", guarded: "guarded", invalid: "invalid", idle: "no effect", unstable: "unstable", error: "error" };
  function bar(one) {
    const { counts, by_check: byCheck } = one;
    const parts = KINDS.map(([kind, letter, words]) => [kind, letter, words,
      kind === "check" ? byCheck : kind === "exception" ? counts.killed - byCheck : counts[NAMES[kind]]]).filter((part) => part[3]);
    const total = parts.reduce((sum, part) => sum + part[3], 0) || 1;
    const strip = h("div", { class: "strip", "aria-hidden": "true" });
    for (const [kind, , , found] of parts) {
      const piece = h("span", { class: `m-${kind}` });
      piece.style.flexGrow = found / total;
      strip.append(piece);
    }
    return h("div", { class: "bar" }, strip, h("ul", null, parts.map(([kind, letter, words, found]) => h("li", null,
      h("span", { class: `mark m-${kind}`, "aria-hidden": "true" }, letter), `${found} ${words}`))));
  }

  function toActOn(all, campaign) {
    const survivors = all.filter((one) => one.status !== "not covered"), uncovered = all.filter((one) => one.status === "not covered");
    const idle = uncovered.length, partly = uncovered.filter((one) => one.killed).length;
    const more = idle ? h("p", { class: "hint" }, h("a", { href: address(["mutants"], { status: "not covered" }) }, `${count(idle, "mutant")} not covered`), `, since no test reaches the place${partly ? `${partly === idle ? "" : `; ${partly} of them`} in some round; killed in the others` : ""}`) : null;
    let [loud, calm] = [false, true].map((is) => survivors.filter((one) => one.indistinguishable === is));
    const isRanked = loud.length > 1 && loud.some((one) => one.deviation);
    if (!loud.length && calm.length <= SHOWN) [loud, calm] = [calm, []]; // else nothing would say which faults these are
    calm.sort((one, other) => one.number - other.number);
    const heading = h("h2", { id: "survivors" }, survivors.length ? `${count(survivors.length, "survivor")}${isRanked ? ", largest deviation from the original first" : ""}` : "Survivors");
    if (!survivors.length) {
      const judged = campaign.mutants.some((one) => one.valid && one.status !== "not covered");
      return h("section", null, heading, more, judged
        ? empty(campaign.state === "complete" ? "No survivors." : "No survivors so far.", `The tests noticed every mutant ${idle ? "they reach" : "that was valid"}. The check score above counts those that an assertion killed.`)
        : isUnderWay(campaign) ? empty("Nothing is judged yet.", "A mutant is judged as soon as its tests have run.")
        : empty("Nothing was judged.", "No mutant was valid in any round; the list below says why."));
    }
    const shared = new Set(loud.map((one) => one.why)).size === 1 && loud.length > 1 ? loud[0].why : ""; // said once
    return h("section", { "aria-labelledby": "survivors" }, heading,
      shared ? h("p", { class: "hint" }, `For all of them, ${shared}.`) : null,
      h("ol", { class: "findings" }, loud.slice(0, SHOWN).map((one) => finding(one, shared))),
      calm.length ? h("p", { class: "hint" }, `${count(calm.length, "survivor")} without a measured effect on what the robot did: `, calm.slice(0, 3 * SHOWN).map((one, index) => [index ? ", " : "", h("a", { href: address(["mutant", String(one.number)]) }, one.number)]), calm.length > 3 * SHOWN ? ` and ${calm.length - 3 * SHOWN} more` : null) : null,
      loud.length > SHOWN ? h("p", null, h("a", { class: "more", href: address(["mutants"], { status: "survived", sort: "deviation" }) }, `All ${survivors.length} survivors`)) : null,
      more, campaign.next ? h("p", null, mutabot.coded(campaign.next)) : null);
  }

  function ladders(campaign) {
    const kind = (one, size) => one.all_from !== null && size >= one.all_from ? "all" : one.refused_from !== null && size >= one.refused_from ? "refused" : size <= one.none_up_to ? "none" : "some";
    const words = { none: "no round notices", some: "some rounds notice", all: "all rounds notice", refused: "the robot refuses" };
    return h("section", { "aria-labelledby": "thresholds" }, h("h2", { id: "thresholds" }, "How large a fault must be before the tests notice, the least sensitive first"),
      h("p", { class: "story" }, `${campaign.thresholds}.`),
      h("ul", { class: "legend" }, Object.entries(words).map(([name, text]) => h("li", null, h("span", { class: `step is-${name}`, "aria-hidden": "true" }), text))),
      h("ul", { class: "plain ladders" }, campaign.ladders.map((one) => h("li", null, h("a", { href: address(["source", one.file], { line: String(one.line) }) }, `${one.place} ${one.name}`),
        h("span", { class: "steps", role: "img", "aria-label": one.text }, one.magnitudes.map((size) => h("span", { class: `step is-${kind(one, size)}`, title: `${number(size)} ${one.unit || ""}: ${words[kind(one, size)]}` }))),
        h("small", null, one.text)))),
      campaign.furtherLadders ? h("p", { class: "hint" }, `${count(campaign.furtherLadders, "further ladder")}, more sensitive than these: `, h("code", null, "mutabot thresholds"), " prints all.") : null);
  }

  function finding(one, shared) {
    return h("li", null,
      h("div", { class: "finding-head" }, marks.ends(one.ends), h("a", { href: address(["mutant", String(one.number)]) }, `${one.number}  ${one.description}`),
        h("span", { class: "place" }, one.place, " · ", one.operator)),
      shared ? null : h("p", { class: "story" }, mutabot.breakable(one.why)));
  }

  function unseen(campaign) {
    if (isUnderWay(campaign)) return ""; // a mutant that is still to be run may show that a test notices something
    const none = campaign.tests.map((name, index) => [name, index]).filter(([, index]) => !campaign.mutants.some((one) => one.kills.some((kill) => kill[0] === index)));
    const section = h("section", { "aria-labelledby": "unseen" }, h("h2", { id: "unseen" }, "Gaps: faulty readings that pass, and idle tests"));
    if (!campaign.unlooked.length && !none.length) {
      section.append(h("p", { class: "hint" }, "Every test killed at least one mutant, and some fault of every reading that the tests take was noticed."));
      return section;
    }
    if (campaign.unlooked.length) section.append(h("h3", null, "Readings whose faults no test noticed"), h("ul", { class: "plain" }, campaign.unlooked.map((one) => h("li", null, h("code", null, one)))));
    if (none.length) {
      section.append(h("h3", null, `Tests not known to kill a mutant: ${none.length} of ${campaign.tests.length}`),
        h("ul", { class: "plain" }, none.slice(0, SHOWN).map(([name]) => h("li", null, h("code", null, mutabot.breakable(name))))),
        h("p", { class: "hint" }, "A run stops at the first test that kills the mutant: another test may have come first."),
        h("p", null, h("a", { class: "more", href: address(["tests"]) }, "Tests and the mutants they kill")));
    }
    return section;
  }

  function outside(campaign) {
    const section = h("section", { "aria-labelledby": "outside" }, h("h2", { id: "outside" }, "Not counted in the score"));
    const found = ["accepted", "error", "unstable", "refused", "guarded", "invalid", "no effect", "not run"]
      .map((name) => [name, campaign.mutants.filter((one) => one.status === name).length]).filter(([, many]) => many);
    if (found.length) {
      section.append(h("ul", { class: "plain" }, found.map(([name, many]) => h("li", null,
        h("a", { href: address(["mutants"], { status: name }) }, marks.status(name)), ` ${count(many, "mutant")}: ${marks.MEANING[name]}`))));
    } else section.append(h("p", { class: "hint" }, campaign.done >= campaign.planned ? "Every mutant is counted." : "No mutant is left out of the score so far."));
    if (campaign.withoutEffect.length) section.append(h("h3", null, "Accepted or excluded without an effect"), h("ul", { class: "plain" }, campaign.withoutEffect.map((one) => h("li", null, one))));
    const nothing = "would change nothing";
    const headings = Map.groupBy(campaign.left_out, (one) => one.reason.startsWith(nothing) ? `Left out that ${nothing}` : `Left out: ${one.reason}`);
    for (const [heading, those] of [...headings].sort(([one], [other]) => other.startsWith("Left out that") - one.startsWith("Left out that"))) {
      section.append(h("details", null, h("summary", null, `${heading} (${those.length})`),
        h("ul", { class: "plain small" }, those.slice(0, 50).map((one) => h("li", null, one.description, heading.endsWith(one.reason) ? null : `: ${one.reason}`, " ", h("code", null, one.id))),
          those.length > 50 ? h("li", null, `and ${those.length - 50} more, which `, h("code", null, "mutabot list --all"), " prints") : null)));
    }
    return section;
  }

  function trust(campaign) {
    const lines = [];
    const wrong = campaign.controls.filter((one) => !one.ok);
    if (campaign.controls.length) {
      const both = ["identity", "fatal"].every((name) => campaign.controls.some((one) => one.control === name)) && !isUnderWay(campaign);
      lines.push(wrong.length
        ? h("li", { class: "bad" }, `${count(wrong.length, "control")} failed: `, wrong.map((one) => `${one.control} for ${one.test_file}, ${one.detail}`).join("; "))
        : h("li", null, both ? "Both control mutants behaved correctly: the no-op survived, the crashing one was killed."
          : `${count(campaign.controls.length, "control run")} so far, none of them failed.`));
    }
    if (campaign.flaky.length) lines.push(h("li", { class: "bad" }, `${count(campaign.flaky.length, "unreliable test")} excluded:`, h("ul", null, campaign.flaky.map((one) => h("li", null, one)))));
    if (campaign.confirmed) lines.push(h("li", null, `${campaign.confirmed}.`));
    const verified = campaign.verification;
    if (verified) {
      lines.push(verified.disagreements.length
        ? h("li", { class: "bad" }, `${verified.disagreements.length} of ${verified.checked} outcomes differ in a fresh process:`,
          h("ul", null, verified.disagreements.map(({ number: many, round, first, second }) => h("li", null, h("a", { href: address(["mutant", String(many)]) }, `mutant ${many}`), `, round ${round}: ${first}; re-run: ${second}`))))
        : h("li", null, `Verified: ${count(verified.checked, "outcome")} re-run in fresh processes, all with the same result.`));
    }
    for (const name of ["kills", "survivors"]) {
      const found = campaign.repeats[`false_${name}`];
      if (found) lines.push(h("li", null, `Estimated wrong ${name}: ${number(found.expected, 2)} of ${found.known} (95 % interval ${number(found.low, 2)}–${number(found.high, 2)}), from re-runs.`));
    }
    if (!lines.length) return "";
    return h("section", { "aria-labelledby": "trust" }, h("h2", { id: "trust" }, "Reliability of these results"), h("ul", { class: "plain" }, lines));
  }
})();
