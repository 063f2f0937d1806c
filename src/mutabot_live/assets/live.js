/* The campaign under way: how far it is, stop, and newer data as they come. */
"use strict";
(() => {
  const { h, say, legible, duration } = mutabot;
  const GONE = "Nobody serves this page any more: the command has ended, or the way to its machine is cut. `mutabot report --html DIR` writes the whole report, to be opened from disk.";
  let state = null;
  let heard = 0; // when the state came
  let shown = -1; // the version of the data that are drawn
  let next = 0;
  let timer = null;
  let isAway = false; // the stream is cut
  let isGone = false; // for good
  mutabot.live = true;
  mutabot.missing = GONE;

  const bar = h("progress", { max: 1, "aria-label": "How far the campaign is" });
  const text = h("p", { class: "live-text" }, "…");
  const line = h("p", { class: "live-line" });
  const stop = h("button", { type: "button", id: "live-stop", onclick: ask }, "Stop …");
  const notes = h("ul", { class: "plain small" });
  const notesBox = h("details", { class: "live-notes", hidden: true }, h("summary", null, "Notes"), notes);
  const box = h("section", { class: "live", id: "live", "aria-label": "The campaign under way" },
    h("div", { class: "live-how" }, text, line), h("div", { class: "live-tools" }, stop), bar, notesBox);
  document.querySelector(".top").after(box);

  const source = new EventSource("events");
  source.addEventListener("state", (event) => {
    const before = state;
    state = JSON.parse(event.data);
    heard = performance.now();
    isAway = false;
    draw();
    if (state.ended && !(before && before.ended)) { next = 0; say(ending()); }
    plan();
  });
  source.addEventListener("note", (event) => {
    notes.append(h("li", null, JSON.parse(event.data)));
    notesBox.hidden = false;
    notesBox.querySelector("summary").textContent = `Notes: ${notes.children.length}`;
  });
  source.addEventListener("open", () => { isAway = false; draw(); });
  source.addEventListener("error", () => {
    isAway = true;
    if ((state && state.ended) || source.readyState === EventSource.CLOSED) { source.close(); isGone = true; }
    draw();
  });
  setInterval(draw, 1000);

  const ending = () => state.ended === "complete" ? "The campaign is complete." : `The campaign has ended: ${legible(state.ended)}.`;

  function left() {
    if (state.left === null) return "";
    const seconds = Math.max(0, state.left - (performance.now() - heard) / 1000);
    return seconds < 1.5 ? "about a second left" : `about ${seconds < 100 ? `${Math.round(seconds)} s` : duration(seconds)} left`;
  }

  function draw() {
    if (!state) { if (isGone) text.textContent = GONE; return; }
    const count = state.total === null ? (state.done ? String(state.done) : "") : `${state.done.toLocaleString("en")} of ${state.total.toLocaleString("en")}`;
    const parts = state.ended ? [ending(), isGone ? "Its command has ended: what was not opened here is in `mutabot report --html DIR`." : "Close this page, and the command ends."]
      : [legible(state.stage || "Beginning"), count, left()];
    text.textContent = parts.filter(Boolean).join(state.ended ? " " : " · ");
    line.textContent = isAway && !state.ended ? "The connection is lost; trying again …" : state.ended ? "" : legible(state.line);
    if (state.ended || state.total) { bar.max = state.ended ? 1 : state.total; bar.value = state.ended ? 1 : state.done; } else bar.removeAttribute("value");
    bar.hidden = Boolean(state.ended);
    stop.hidden = Boolean(state.ended);
    stop.disabled = isAway;
    box.dataset.state = state.ended ? (state.ended === "complete" ? "complete" : "ended") : "running";
    const wait = !mutabot.campaign && document.querySelector("main .wait");
    if (wait) wait.textContent = state.ended ? "The campaign ended before it had a plan; there is nothing to show." : "The tests run on the original first. The report fills in as soon as the mutants are planned.";
  }

  /** Ask for newer data, as often as the campaign can do with. */
  function plan() {
    if (timer || !state || shown >= state.version) return;
    timer = setTimeout(refresh, Math.max(0, next - performance.now()));
  }
  async function refresh() {
    mutabot.forget("campaign");
    try {
      const data = await mutabot.load("campaign", "data/campaign.js");
      shown = data ? data.version : -1;
    } catch { /* what was there stays; the stream says whether the server is away */ }
    timer = null;
    next = performance.now() + 1000 * state.every;
    if (!state.ended || (mutabot.campaign && shown < state.version && !isAway)) plan();
  }

  async function command(name) {
    try {
      const answer = await fetch(name, { method: "POST", referrerPolicy: "same-origin" });
      if (!answer.ok) say(`That was refused: ${await answer.text()}`);
    } catch { isAway = true; draw(); }
  }

  function ask() {
    const dialog = h("dialog", { "aria-labelledby": "stop-title", onclose: (event) => {
      if (event.target.returnValue === "stop") command("stop");
      event.target.remove();
    } }, h("h2", { id: "stop-title" }, "Stop the campaign?"),
      h("p", null, "Like Ctrl-C: what was found is kept, and ", h("code", null, "mutabot run"), " goes on from there. The command ends, and with it this page."),
      h("form", { method: "dialog", class: "live-tools" }, h("button", { value: "" }, "Let it run"), h("button", { value: "stop", class: "live-danger" }, "Stop it")));
    document.body.append(dialog);
    dialog.showModal();
  }
})();
