/* Verdicts: a letter, a colour and words each, as on the terminal. */
"use strict";
(() => {
  const { h } = mutabot;
  const LETTERS = {
    C: ["check", "killed by a check"], X: ["exception", "killed by an exception"], S: ["survived", "survived"],
    N: ["uncovered", "not covered"], T: ["timeout", "killed by a timeout"], R: ["refused", "refused by the robot"],
    G: ["refused", "refused by the guard"],
    I: ["invalid", "invalid"], "=": ["idle", "no effect"], U: ["unstable", "unstable"], A: ["idle", "accepted"], E: ["error", "error"], "·": ["unrun", "not run"],
  };
  const STATUS = {
    survived: "S", "not covered": "N", killed: "C", timeout: "T", error: "E", unstable: "U", refused: "R", guarded: "G", invalid: "I", "no effect": "=", accepted: "A", "not run": "·",
  };
  const ORDER = Object.keys(STATUS);
  const MEANING = {
    survived: "at least one round let it through", "not covered": "no test reaches it in at least one round", killed: "every valid round killed it",
    timeout: "it exceeded its time limit in every round", error: "mutabot, a worker or the simulator failed", unstable: "equal runs gave different results",
    refused: "the robot refused the command", guarded: "a guard kept the command from the robot", invalid: "no valid program or command", "no effect": "it changed no value", accepted: "it survived, and that was accepted with a reason", "not run": "not run yet",
  };

  /** The mark of one letter. Its words are its name for those who do not see it. */
  function mark(letter, name) {
    const [kind, words] = LETTERS[letter] || LETTERS["·"];
    return h("span", { class: `mark m-${kind}`, role: "img", "aria-label": name || words, title: name || words }, letter);
  }
  /** The marks of all rounds; runs of equal rounds are said once. */
  function ends(letters) {
    const names = [...letters].map((letter, round) => `round ${round + 1} ${(LETTERS[letter] || ["", "?"])[1]}`);
    const alike = new Set(letters).size === 1 && letters.length > 1;
    const name = alike ? `all ${letters.length} rounds ${LETTERS[letters[0]][1]}` : names.join(", ");
    return h("span", { class: "ends", role: "img", "aria-label": name, title: name },
      [...letters].map((letter) => h("span", { class: `mark m-${(LETTERS[letter] || LETTERS["·"])[0]}` }, letter)));
  }
  /** A status as a mark with its word. */
  const status = (name) => h("span", { class: "status" },
    h("span", { class: `mark m-${LETTERS[STATUS[name]][0]}`, "aria-hidden": "true" }, name === "killed" ? "K" : STATUS[name]), name);
  const legend = (letters) => h("ul", { class: "legend", "aria-label": "What the letters mean" },
    Object.keys(LETTERS).filter((one) => letters.has(one)).map((one) => h("li", null,
      h("span", { class: `mark m-${LETTERS[one][0]}`, "aria-hidden": "true" }, one), LETTERS[one][1])));

  Object.assign(mutabot, { marks: { LETTERS, STATUS, ORDER, MEANING, mark, ends, status, legend } });
})();
