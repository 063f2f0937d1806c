/* Commands, readings and contacts over time, original beside mutant. */
"use strict";
(() => {
  const { h, number } = mutabot;
  const BEFORE = 3, AFTER = 14, LATE = 0.3;
  const text = (value) => typeof value === "number" ? number(value, 5) : String(value);
  const shown = (pairs) => pairs.map(([name, value]) => [name, text(value)]);
  const same = (one, other) => JSON.stringify([shown(one.written), shown(one.read)]) === JSON.stringify([shown(other.written), shown(other.read)]);
  const key = (one) => `${one.operation}\n${one.place}\n${one.pattern}`;

  /** Rows of two events each, beside each other what is the same call; null where one has none. */
  function aligned(one, other) {
    const many = one.length, more = other.length;
    let head = 0;
    while (head < many && head < more && one[head].key === other[head].key) head += 1;
    let tail = 0;
    while (tail < many - head && tail < more - head && one[many - 1 - tail].key === other[more - 1 - tail].key) tail += 1;
    const rows = [];
    for (let index = 0; index < head; index += 1) rows.push([one[index], other[index]]);
    rows.push(...matched(one.slice(head, many - tail), other.slice(head, more - tail)));
    for (let index = tail; index > 0; index -= 1) rows.push([one[many - index], other[more - index]]);
    return rows;
  }
  /** The longest sequence that both have; too long ones are laid side by side as they come. */
  function matched(one, other) {
    if (one.length * other.length > 250000) return Array.from({ length: Math.max(one.length, other.length) }, (_, index) => [one[index] || null, other[index] || null]);
    const best = Array.from({ length: one.length + 1 }, () => new Uint16Array(other.length + 1));
    for (let a = one.length - 1; a >= 0; a -= 1) for (let b = other.length - 1; b >= 0; b -= 1) best[a][b] = one[a].key === other[b].key ? best[a + 1][b + 1] + 1 : Math.max(best[a + 1][b], best[a][b + 1]);
    const rows = [];
    let a = 0, b = 0;
    while (a < one.length || b < other.length) {
      if (a < one.length && b < other.length && one[a].key === other[b].key) { rows.push([one[a], other[b]]); a += 1; b += 1; }
      else if (b >= other.length || (a < one.length && best[a + 1][b] >= best[a][b + 1])) { rows.push([one[a], null]); a += 1; }
      else { rows.push([null, other[b]]); b += 1; }
    }
    return rows;
  }

  /** Calls and contacts of a recording in their order. */
  function events(recording) {
    const calls = recording.calls.map((call, index) => ({ time: call.began, key: key(call), call, index }));
    const moments = recording.moments.map(([time, what, text]) => ({ time, key: `${what}\n${text}`, what, text }));
    return [...calls, ...moments].map((one, index) => [one, index]).sort(([a, i], [b, j]) => (a.time ?? 0) - (b.time ?? 0) || i - j).map(([one]) => one);
  }

  const differs = ([one, other]) => !one || !other || (one.call ? !same(one.call, other.call) : Math.abs((one.time ?? 0) - (other.time ?? 0)) > LATE);
  const name = (call) => call.operation.replace(/^.*:/, "") + (call.pattern ? ` ${mutabot.command(call.pattern)}` : "");
  /** Values in words; those that read otherwise on the other side are marked. */
  const amounts = (pairs, fault, others) => pairs.filter(([what, value]) => value !== 0 || pairs.length === 1 || (fault && what === fault.name))
    .map(([what, value]) => {
      const other = others && others.find(([name]) => name === what);
      return h("span", { class: "amount" }, `${what.replace(/^\./, "")} `, h("b", { class: other && text(other[1]) !== text(value) ? "other" : null }, text(value)));
    });
  /** The values as the fault changed them. */
  const changed = (pairs, fault) => pairs.map(([what, value]) => [what, fault && what === fault.name ? fault.value : value]);

  /** When it happened on its own side; of a mutant also by how much later or earlier than in the original. */
  function moment(one, other, clock, isMutant) {
    if (one.time === null || one.time === undefined) return null;
    const late = isMutant && other && typeof other.time === "number" ? one.time - other.time : 0;
    return h("span", { class: "moment" }, h("button", { type: "button", class: "time", onclick: () => clock.set(one.time), "aria-label": `show ${number(one.time, 4)} s` }, `${number(one.time, 4)} s`),
      Math.abs(late) > LATE ? h("small", null, ` ${late > 0 ? "+" : "−"}${Math.abs(late).toFixed(1)} s`) : null);
  }
  function cell(one, other, fault, isMutant, clock) {
    const side = isMutant ? "mutant" : "original";
    if (!one) return h("td", { class: "gone", "data-side": side }, h("span", { class: "unseen" }, "nothing"), "—");
    const beside = other && other.call;
    const inside = one.call
      ? [h("span", { class: `event ${one.call.role}` }, name(one.call)), " ", isMutant && fault && fault.isSkipped ? h("strong", null, "not sent") : amounts(isMutant ? changed(one.call.written, fault) : one.call.written, fault, beside && beside.written), one.call.read.length ? [" → ", amounts(isMutant ? changed(one.call.read, fault) : one.call.read, fault, beside && beside.read)] : null, h("small", null, one.call.place)]
      : [h("span", { class: "event contact" }, one.what === "touch" ? "touch" : one.what === "part" ? "part" : "note"), " ", one.text];
    return h("td", { "data-side": side }, moment(one, other, clock, isMutant), inside,
      fault && isMutant ? h("p", { class: "acts" }, h("span", { class: "flag" }, "fault"), ` ${fault.text}`) : null);
  }

  function table(original, mutant, clock, fault) {
    const rows = aligned(original ? events(original) : [], events(mutant));
    let first = rows.findIndex(differs);
    const at = rows.findIndex(([, other]) => other && other.call && other.index === mutant.faultyCall);
    if (at >= 0 && (first < 0 || at < first)) first = at;
    const body = h("tbody");
    const box = h("div", { class: "events" });
    const make = ([one, other]) => {
      const faulty = other && other.call && other.index === mutant.faultyCall;
      return h("tr", { class: `${differs([one, other]) ? "differs" : ""}${faulty ? " faulty" : ""}` },
        cell(one, other, faulty ? fault : null, false, clock), cell(other, one, faulty ? fault : null, true, clock));
    };
    const show = (from, to) => body.replaceChildren(...rows.slice(from, to).map(make));
    const from = first < 0 ? 0 : Math.max(0, first - BEFORE), to = first < 0 ? Math.min(rows.length, AFTER) : first + AFTER;
    show(from, to);
    box.append(h("div", { class: "scroll", role: "region", tabindex: "0", "aria-label": "Commands, readings and contacts" }, h("table", null,
      h("thead", null, h("tr", null, h("th", { scope: "col" }, "original"), h("th", { scope: "col" }, "mutant"))), body)));
    if (from > 0 || to < rows.length) {
      const button = h("button", { type: "button", onclick: () => { show(0, rows.length); button.remove(); } }, `Show all ${rows.length} events`);
      box.append(button);
    }
    return box;
  }

  /** Two lanes with the calls as bars and contacts as ticks, on the time of the page. */
  function lanes(original, mutant, clock) {
    const end = clock.end || 1;
    const box = h("div", { class: "lanes" });
    const put = (element, time) => { element.style.left = `${100 * Math.min(1, time / end)}%`; return element; };
    for (const [label, recording, kind] of [["original", original, "of-original"], ["mutant", mutant, "of-mutant"]]) {
      if (!recording) continue;
      const lane = h("div", { class: `lane ${kind}`, role: "img", "aria-label": `${label}: ${recording.calls.length} calls, ${recording.moments.length} contacts and notes` });
      for (const call of recording.calls) {
        if (call.began === null || call.ended === null) continue;
        const bar = put(h("span", { class: `call ${call.role}`, title: `${name(call)} ${number(call.began, 4)}–${number(call.ended, 4)} s` }), call.began);
        bar.style.width = `${100 * Math.max(0, call.ended - call.began) / end}%`;
        if (call.ended - call.began > 0.07 * end) bar.append(name(call).replace(/^\S*\./, ""));
        lane.append(bar);
      }
      for (const [time, what, text] of recording.moments) lane.append(put(h("span", { class: `tick ${what}`, title: `${what} ${text}, ${number(time, 4)} s` }), time));
      box.append(h("div", { class: "lane-row" }, h("span", { class: "lane-name" }, label), lane));
      if (kind === "of-mutant" && mutant.fault !== null && mutant.fault !== undefined) lane.append(put(h("span", { class: "fault-mark", title: `fault at ${number(mutant.fault, 4)} s` }), mutant.fault));
      const cursor = h("span", { class: "cursor" });
      lane.append(cursor);
      clock.on((time) => put(cursor, time));
    }
    return box;
  }

  Object.assign(mutabot, { timeline: { table, lanes } });
})();
