/* The files that have mutants as a tree of folders, with the scores of each. */
"use strict";
(() => {
  const { h, address, count, percent } = mutabot;

  /** The mean over rounds of the share of valid mutants that were killed, as the overview has it; null if none was valid. */
  function score(mutants, rounds) {
    const shares = [];
    for (let round = 0; round < rounds; round += 1) {
      const letters = mutants.map((one) => one.ends[round]), killed = letters.filter((one) => "CXT".includes(one)).length;
      const valid = killed + letters.filter((one) => "SN".includes(one)).length;
      if (valid) shares.push(killed / valid);
    }
    return shares.length ? shares.reduce((sum, share) => sum + share, 0) / shares.length : null;
  }

  /** Scores of some mutants, those of each family and role by themselves, and how many survived. */
  function figures(mutants) {
    const groups = [...Map.groupBy(mutants.filter((one) => one.status !== "accepted"), (one) => `${one.family} · ${one.role}`)];
    const scores = groups.map(([name, those]) => [h("b", null, percent(score(those, mutabot.campaign.rounds), 0)), groups.length > 1 ? ` ${name}` : " killed"]);
    const idle = mutants.filter((one) => one.status === "not covered").length, alive = mutants.filter((one) => one.survives).length - idle;
    const counts = [count(mutants.length, "mutant"), alive && count(alive, "survivor"), idle && `${idle} not covered`];
    return h("small", null, scores.map((one, index) => [index ? ", " : "", one]), scores.length ? " · " : "", counts.filter(Boolean).join(", "));
  }

  /** Folders within a folder by name, and its files; folders that hold a single folder share its row. */
  function branch(files, depth) {
    const inside = Map.groupBy(files, ({ parts }) => parts[depth]);
    return [...inside].sort(([one], [other]) => one.localeCompare(other)).map(([name, those]) => {
      if (those[0].parts.length === depth + 1) return { name, file: those[0].file, mutants: those[0].mutants };
      const within = branch(those, depth + 1);
      if (within.length === 1 && within[0].within) return { ...within[0], name: `${name}/${within[0].name}` };
      return { name, within, mutants: [...new Set(those.flatMap((one) => one.mutants))] };
    });
  }

  function rows(branches, current) {
    return h("ul", null, branches.map((one) => h("li", null, one.within
      ? h("details", { open: true }, h("summary", null, h("span", { class: "name" }, mutabot.breakable(`${one.name}/`)), figures(one.mutants)), rows(one.within, current))
      : h("a", { href: address(["source", one.file]), "aria-current": one.file === current ? "page" : null }, h("span", { class: "name" }, mutabot.breakable(one.name)), figures(one.mutants)))));
  }

  /** The tree; of a single file there is none. */
  mutabot.fileTree = (campaign, current) => {
    if (campaign.files.length < 2) return "";
    const inFile = (file) => campaign.mutants.filter((one) => one.spans.some((span) => span.file === file));
    const files = campaign.files.map((file) => ({ file, parts: file.split("/"), mutants: inFile(file) }));
    return h("nav", { class: "files", "aria-label": "Files" }, rows(branch(files, 0), current));
  };
})();
