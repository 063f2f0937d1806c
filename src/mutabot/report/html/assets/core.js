/* What all pages stand on: data, elements, addresses. Texts of programs only ever become text nodes. */
"use strict";
const mutabot = (() => {
  const taken = new Map();
  const waiting = new Map();
  const views = new Map();

  /** Called by the data's scripts. */
  function take(name, text) {
    taken.set(name, JSON.parse(text));
    if (name === "campaign") mutabot.start(taken.get(name));
  }

  /** Data by name, loaded as a script from a file when it is wanted first. */
  function load(name, file) {
    if (taken.has(name)) return Promise.resolve(taken.get(name));
    return new Promise((resolve, reject) => {
      const script = waiting.get(name) || document.createElement("script");
      script.addEventListener("load", () => { waiting.delete(name); script.remove(); resolve(taken.get(name)); });
      script.addEventListener("error", () => {
        waiting.delete(name);
        script.remove();
        reject(new Error(mutabot.missing || `The file ${file} is missing beside this page. Copy the whole folder, or write the report again.`));
      });
      if (waiting.has(name)) return;
      waiting.set(name, script);
      script.src = file;
      document.head.append(script);
    });
  }

  /** Forget data of which there may be newer ones. */
  function forget(...beginnings) {
    for (const name of [...taken.keys()]) if (beginnings.some((one) => name.startsWith(one))) taken.delete(name);
  }

  const ODD = /[\u061c\u200b-\u200f\u202a-\u202e\u2060-\u2069\ufeff]/g;
  /** A text in which signs that hide, or turn the order of others, are shown by their numbers. */
  const legible = (text) => String(text).replace(ODD, (sign) => `⟨U+${sign.charCodeAt(0).toString(16).toUpperCase().padStart(4, "0")}⟩`);

  const SVG = "http://www.w3.org/2000/svg";
  function fill(element, attributes, children) {
    for (const [name, value] of Object.entries(attributes || {})) {
      if (value === null || value === undefined || value === false) continue;
      if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
      else element.setAttribute(name, value === true ? "" : legible(value));
    }
    add(element, children);
    return element;
  }
  function add(element, children) {
    for (const child of children) {
      if (child === null || child === undefined || child === false) continue;
      if (Array.isArray(child)) add(element, child);
      else element.append(child instanceof Node ? child : legible(child));
    }
  }
  /** An element with attributes and children; texts are texts. */
  const h = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
  const svg = (tag, attributes, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);

  /** The address of a page: its parts, and what it is asked. */
  function address(parts, asked) {
    const query = new URLSearchParams(Object.entries(asked || {}).filter(([, value]) => value !== "" && value !== null && value !== undefined));
    const text = query.toString();
    return `#/${parts.map(encodeURIComponent).join("/")}${text ? `?${text}` : ""}`;
  }
  function here() {
    const [path, query] = location.hash.replace(/^#\/?/, "").split(/\?(.*)/s);
    let parts;
    try { parts = path.split("/").filter(Boolean).map(decodeURIComponent); } catch { parts = ["unknown"]; }
    return { parts, asked: Object.fromEntries(new URLSearchParams(query || "")) };
  }

  const percent = (share, digits = 1) => share === null || share === undefined ? "–" : `${(100 * share).toFixed(digits)} %`;
  const between = (ends) => ends ? `${Math.round(100 * ends.low)}–${Math.round(100 * ends.high)} %` : "";
  const count = (number, one, many) => `${number.toLocaleString("en")} ${number === 1 ? one : many || `${one}s`}`;
  /** A number in at most so many digits that count, as people write it. */
  function number(value, digits = 4) {
    if (value === null || value === undefined) return "–";
    if (typeof value !== "number") return String(value);
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-4 || size >= 1e7)) return value.toExponential(2).replace(/^-/, "−");
    return String(Number(value.toPrecision(digits))).replace("-", "−");
  }
  /** A length or another amount with its unit; short lengths in mm. */
  function amount(value, unit) {
    if (value === null || value === undefined) return "–";
    if (unit !== "m" || Math.abs(value) >= 0.1) return `${number(value, 3)}${unit ? ` ${unit}` : ""}`;
    return Math.abs(value) < 5e-5 ? "0 mm" : `${number(1000 * value, 2)} mm`;
  }
  function duration(seconds) {
    if (typeof seconds !== "number") return "";
    if (seconds < 100) return `${seconds.toFixed(1)} s`;
    return seconds < 6000 ? `${(seconds / 60).toFixed(1)} min` : `${(seconds / 3600).toFixed(1)} h`;
  }
  const say = (text) => { document.getElementById("said").textContent = text; };

  /** The colour that a name of the style sheet has now, for what draws by itself. */
  function ink(name) {
    const probe = h("span", { class: "unseen" });
    probe.style.color = `var(--${name})`;
    document.body.append(probe);
    const found = getComputedStyle(probe).color;
    probe.remove();
    return found;
  }

  /** A text in which code stands between backticks, as in the terminal. */
  const coded = (text) => text.split("`").map((part, index) => index % 2 ? h("code", null, part) : part);
  /** A name that may break after the signs that join its words. */
  const breakable = (name) => legible(name).split(/(?<=[_:/.])(?=[^_:/.])/).flatMap((part) => [part, h("wbr")]);

  /** What a page says where there is nothing to show. */
  const empty = (title, ...children) => h("div", { class: "empty" }, h("p", { class: "empty-title" }, title), h("p", null, children));

  return { take, load, forget, taken: (name) => taken.get(name), h, svg, add, address, here, percent, between, count, number, amount, duration, say, ink, empty, legible, breakable, coded, views };
})();
