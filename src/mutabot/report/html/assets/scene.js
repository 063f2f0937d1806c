/* The world in three dimensions, drawn on a plain canvas: no graphics driver is needed, and it prints.
   What a block hides is drawn faintly, as in a technical drawing, and not left out. */
"use strict";
(() => {
  const { h, ink, number } = mutabot;
  const { at, axes } = mutabot.recordings;
  const FIELD = 0.4; // focal length in multiples of the height is 1 / FIELD
  const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const FACES = [[0, 1], [0, -1], [1, 1], [1, -1], [2, 1], [2, -1]];

  /** A canvas that shows two recordings, and follows a clock. `worlds`: the original first, each with name and ink. */
  function scene(worlds, clock) {
    const blocks = worlds[worlds.length - 1].recording.blocks.map(([name, centre, size, colour]) => ({ name, centre, half: times(size, 0.5), colour }));
    const those = (is) => worlds.map((world) => [...world.recording.tracks.values()].filter((one) => one.times.length && is(one.kind)));
    const things = those((kind) => kind === "pose" || kind === "point"), robots = those((kind) => kind === "line");
    const ROBOT = Symbol("robot");
    const shown = new Set([...things.flat().map((one) => one.name), ROBOT]);
    const bounds = boundsOf(things.flat(), blocks);
    const home = { yaw: yawBeside(robots[robots.length - 1], clock.time), pitch: 0.42, distance: 1.15 * bounds.radius / FIELD, target: bounds.centre };
    const view = { ...home };
    const some = (one, most) => one.rows.filter((_, index) => index % Math.ceil(one.rows.length / most) === 0);
    const points = [...things.flat().flatMap((one) => some(one, 200)), ...robots.flat().flatMap((one) => some(one, 40).flatMap(pointsOf))];
    let isFitted = true; // until the reader comes nearer or moves it, all paths fill the view
    const canvas = h("canvas", { class: "scene", tabindex: "0", role: "application", "aria-roledescription": "3D view",
      "aria-label": "Paths of original and mutant in 3D. Arrow keys turn it, plus and minus zoom, 0 shows it as at first, space plays." });
    let frame = 0;
    const draw = () => { if (!frame) frame = requestAnimationFrame(() => { frame = 0; if (canvas.isConnected) paint(); }); };

    function paint() {
      const width = canvas.clientWidth, height = canvas.clientHeight, ratio = Math.min(3, devicePixelRatio || 1);
      if (!width || !height) return;
      if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio); }
      const pen = canvas.getContext("2d");
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.clearRect(0, 0, width, height);
      const colours = { ink: ink("ink"), muted: ink("muted"), line: ink("line-strong"), block: ink("block"), edge: ink("block-edge"), paper: ink("surface") };
      const unit = parseFloat(getComputedStyle(document.documentElement).fontSize) / 15; // as large as the other text
      Object.assign(colours, { unit, font: `600 ${11 * unit}px system-ui, sans-serif`, small: `500 ${11 * unit}px system-ui, sans-serif` });
      if (isFitted) fit(view, points, width, height);
      const camera = cameraOf(view, width, height);
      drawBlocks(pen, camera, blocks, colours);
      if (shown.has(ROBOT)) worlds.forEach((world, index) => robot(pen, camera, robots[index], blocks, clock.time, world, index < worlds.length - 1));
      nameBlocks(pen, camera, blocks, colours);
      worlds.forEach((world, index) => things[index].filter((one) => shown.has(one.name)).forEach((one) => path(pen, camera, one, world, blocks, clock.time, colours)));
      worlds.forEach((world, index) => things[index].filter((one) => shown.has(one.name)).forEach((one) => body(pen, camera, one, world, clock.time, colours, index)));
      if (worlds.length > 1) things[1].filter((one) => shown.has(one.name)).forEach((one) => ghost(pen, camera, things[0].find((other) => other.name === one.name), one, worlds[0].ink(), clock.time, colours));
      fault(pen, camera, worlds, things, shown, colours);
      corner(pen, camera, height, colours);
    }

    const zoom = (by) => { isFitted = false; view.distance *= by; };
    canvas.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 0.4 : 0.12;
      const does = {
        ArrowLeft: () => { view.yaw -= step; }, ArrowRight: () => { view.yaw += step; }, ArrowUp: () => { view.pitch = Math.min(1.55, view.pitch + step); },
        ArrowDown: () => { view.pitch = Math.max(-1.55, view.pitch - step); }, "+": () => zoom(1 / 1.15), "=": () => zoom(1 / 1.15), "-": () => zoom(1.15),
        0: () => { Object.assign(view, home); isFitted = true; },
      }[event.key];
      if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      does();
      draw();
    });
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey) return; // the page goes on to scroll until the view is chosen
      event.preventDefault();
      zoom(Math.exp(0.0015 * event.deltaY));
      draw();
    }, { passive: false });
    const fingers = new Map();
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); fingers.set(event.pointerId, event); canvas.focus({ preventScroll: true }); });
    canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
      if (fingers.size === 2) {
        const [other] = [...fingers.values()].filter((one) => one.pointerId !== event.pointerId);
        const apart = (one) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY) || 1;
        zoom(apart(before) / apart(event));
      } else if (event.shiftKey || event.buttons === 4 || event.buttons === 2) {
        const camera = cameraOf(view, canvas.clientWidth, canvas.clientHeight);
        const scale = view.distance * FIELD / canvas.clientHeight * 2;
        isFitted = false;
        view.target = plus(view.target, plus(times(camera.right, -dx * scale), times(camera.up, dy * scale)));
      } else { view.yaw -= 0.008 * dx; view.pitch = Math.min(1.55, Math.max(-1.55, view.pitch + 0.008 * dy)); }
      fingers.set(event.pointerId, event);
      draw();
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    const watch = new ResizeObserver(draw);
    watch.observe(canvas);
    addEventListener("theme", draw);
    const paper = matchMedia("print");
    paper.addEventListener("change", paint); // at once: what is drawn later is not printed
    clock.on(draw);

    const turn = (name, yaw, pitch) => h("button", { type: "button", onclick: () => { Object.assign(view, home, { yaw, pitch }); isFitted = true; draw(); } }, name);
    const names = [...new Set(things.flat().map((one) => one.name)), ...(robots.flat().length ? [ROBOT] : [])];
    const controls = h("div", { class: "scene-controls" },
      h("div", { role: "group", "aria-label": "View" }, turn("3D", home.yaw, home.pitch), turn("Top", -Math.PI / 2, 1.55), turn("Front", -Math.PI / 2, 0), turn("Side", 0, 0),
        h("button", { type: "button", "aria-label": "Nearer", onclick: () => { zoom(1 / 1.25); draw(); } }, "+"),
        h("button", { type: "button", "aria-label": "Farther", onclick: () => { zoom(1.25); draw(); } }, "−")),
      names.length > 1 ? h("div", { role: "group", "aria-label": "Shown" }, names.map((name) => h("label", { class: "toggle" },
        h("input", { type: "checkbox", checked: true, onchange: (event) => { if (event.target.checked) shown.add(name); else shown.delete(name); draw(); } }), name === ROBOT ? "robot" : name))) : null);
    const stop = () => { watch.disconnect(); removeEventListener("theme", draw); paper.removeEventListener("change", paint); };
    return { canvas, controls, stop };
  }

  const YAW = -1.05, ASIDE = 1.1;
  /** From where an arm is seen from its side, its tool in front; without one, or with several, the usual. */
  function yawBeside(lines, time) {
    const row = lines.length && at(lines[0], time);
    if (!row) return YAW;
    const [x, y] = [row[row.length - 3] - row[0], row[row.length - 2] - row[1]];
    if (Math.hypot(x, y) < 0.1) return YAW;
    const off = (yaw) => Math.abs(Math.atan2(Math.sin(yaw - YAW), Math.cos(yaw - YAW)));
    return [ASIDE, -ASIDE].map((by) => Math.atan2(y, x) + by).sort((one, other) => off(one) - off(other))[0];
  }

  function boundsOf(tracks, blocks) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const one of tracks) for (const row of one.rows) for (let axis = 0; axis < 3; axis += 1) { low[axis] = Math.min(low[axis], row[axis]); high[axis] = Math.max(high[axis], row[axis]); }
    if (low[0] === Infinity) for (const one of blocks) for (let axis = 0; axis < 3; axis += 1) { low[axis] = Math.min(low[axis], one.centre[axis]); high[axis] = Math.max(high[axis], one.centre[axis]); }
    if (low[0] === Infinity) return { centre: [0, 0, 0], radius: 1 };
    const centre = times(plus(low, high), 0.5);
    return { centre, radius: Math.max(0.1, 0.5 * Math.hypot(...minus(high, low))) };
  }

  function cameraOf(view, width, height) {
    const forward = [-Math.cos(view.pitch) * Math.cos(view.yaw), -Math.cos(view.pitch) * Math.sin(view.yaw), -Math.sin(view.pitch)];
    const right = [-Math.sin(view.yaw), Math.cos(view.yaw), 0];
    const up = [-Math.sin(view.pitch) * Math.cos(view.yaw), -Math.sin(view.pitch) * Math.sin(view.yaw), Math.cos(view.pitch)];
    const eye = minus(view.target, times(forward, view.distance));
    const scale = Math.min(height, width) / (2 * FIELD);
    const project = (point) => {
      const from = minus(point, eye);
      const depth = Math.max(0.02, dot(from, forward));
      return [width / 2 + scale * dot(from, right) / depth, height / 2 - scale * dot(from, up) / depth, depth];
    };
    return { eye, forward, right, up, project, scale };
  }

  /** Bring a view so near that points fill it but for a margin for their names, and their middle to its own. */
  function fit(view, points, width, height) {
    if (!points.length) return;
    for (let pass = 0; pass < 4; pass += 1) {
      const camera = cameraOf(view, width, height);
      const [xs, ys] = [0, 1].map((axis) => { const all = points.map((point) => camera.project(point)[axis]); return [Math.min(...all), Math.max(...all)]; });
      const scale = view.distance * 2 * FIELD / Math.min(width, height);
      view.target = plus(view.target, plus(times(camera.right, scale * ((xs[0] + xs[1]) / 2 - width / 2)), times(camera.up, scale * (height / 2 - (ys[0] + ys[1]) / 2))));
      view.distance = Math.max(0.1, view.distance * Math.max((xs[1] - xs[0]) / (0.68 * width), (ys[1] - ys[0]) / (0.76 * height)));
    }
  }

  /** The corners of one side of a box whose edges go along `frame`. */
  function side(centre, half, frame, axis, sign) {
    const [u, v] = [0, 1, 2].filter((one) => one !== axis);
    const middle = plus(centre, times(frame[axis], sign * half[axis]));
    return [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([a, b]) => plus(middle, plus(times(frame[u], a * half[u]), times(frame[v], b * half[v]))));
  }
  const UPRIGHT = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

  function box(pen, camera, centre, half, frame, style) {
    for (const [axis, sign] of FACES) {
      const normal = times(frame[axis], sign);
      if (dot(minus(camera.eye, plus(centre, times(normal, half[axis]))), normal) <= 0) continue;
      const points = side(centre, half, frame, axis, sign).map(camera.project);
      pen.beginPath();
      points.forEach(([x, y], index) => (index ? pen.lineTo(x, y) : pen.moveTo(x, y)));
      pen.closePath();
      pen.globalAlpha = style.alpha * (0.72 + 0.28 * Math.max(0, normal[2]) + 0.1 * normal[0]);
      pen.fillStyle = style.fill;
      if (style.fill) pen.fill();
      pen.globalAlpha = style.edgeAlpha;
      pen.strokeStyle = style.edge;
      pen.lineWidth = style.width;
      pen.setLineDash(style.dash || []);
      pen.stroke();
    }
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }

  const LONGEST = 28;
  const APART = 24; // pixels from which on an original has a name of its own
  /** A name on paper of its own at a point, moved as far as it must be to stay whole on the canvas. */
  function write(pen, text, x, y, fill, colours) {
    const { clientWidth: width, clientHeight: height } = pen.canvas;
    const wide = pen.measureText(text).width, left = { left: 0, center: wide / 2, right: wide }[pen.textAlign], room = 4 * colours.unit;
    const at = [Math.max(room + left, Math.min(width - room - wide + left, x)), Math.max(4 * room, Math.min(height - room, y))];
    pen.lineWidth = 3;
    pen.strokeStyle = colours.paper;
    pen.strokeText(text, ...at);
    pen.fillStyle = fill;
    pen.fillText(text, ...at);
  }

  const label = (name) => { const text = mutabot.legible(name); return text.length > LONGEST ? `${text.slice(0, LONGEST)}…` : text; };

  function drawBlocks(pen, camera, blocks, colours) {
    const sorted = [...blocks].sort((one, other) => camera.project(other.centre)[2] - camera.project(one.centre)[2]);
    for (const one of sorted) box(pen, camera, one.centre, one.half, UPRIGHT, { fill: colours.block, alpha: 1, edge: colours.edge, edgeAlpha: 1, width: 1 });
  }

  function nameBlocks(pen, camera, blocks, colours) {
    pen.font = colours.small;
    pen.textAlign = "center";
    for (const one of blocks) {
      const [x, y] = camera.project(plus(one.centre, [0, 0, one.half[2]]));
      const { clientWidth: width, clientHeight: height } = pen.canvas;
      if (x > 0 && x < width && y > 0 && y < height) write(pen, label(one.name), x, y + 4, colours.muted, colours);
    }
  }

  /** Whether a block stands between the eye and a point. */
  function hidden(eye, point, blocks) {
    const way = minus(point, eye);
    return blocks.some(({ centre, half }) => {
      let near = 0, far = 0.985;
      for (let axis = 0; axis < 3; axis += 1) {
        const low = centre[axis] - half[axis] - eye[axis], high = centre[axis] + half[axis] - eye[axis];
        if (Math.abs(way[axis]) < 1e-9) { if (low > 0 || high < 0) return false; continue; }
        const a = low / way[axis], b = high / way[axis];
        near = Math.max(near, Math.min(a, b));
        far = Math.min(far, Math.max(a, b));
      }
      return near < far;
    });
  }

  function path(pen, camera, one, world, blocks, time, colours) {
    const now = at(one, time);
    const points = [];
    one.times.forEach((when, index) => {
      if (now && when > time && (index === 0 || one.times[index - 1] <= time)) points.push([now, time]);
      points.push([one.rows[index], when]);
    });
    pen.strokeStyle = world.ink();
    pen.lineWidth = world.width * colours.unit;
    pen.lineJoin = "round";
    pen.lineCap = "round";
    let style = -1;
    points.forEach(([row, when], index) => {
      if (!index) return;
      const [before, began] = points[index - 1];
      if (one.gaps.some(([from, to]) => began < to && when > from)) return;
      const middle = times(plus(before, row), 0.5);
      const wanted = (hidden(camera.eye, middle, blocks) ? 2 : 0) + (when > time + 1e-9 ? 1 : 0);
      const [x, y] = camera.project(row);
      if (wanted !== style) {
        if (style >= 0) pen.stroke();
        style = wanted;
        pen.globalAlpha = [1, 0.5, 0.36, 0.2][style];
        pen.setLineDash(style >= 2 ? [2, 4] : world.dash);
        pen.beginPath();
        const [x0, y0] = camera.project(before);
        pen.moveTo(x0, y0);
      }
      pen.lineTo(x, y);
    });
    if (style >= 0) pen.stroke();
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }

  /** The points of a line at a moment: three numbers each. */
  const pointsOf = (row) => Array.from({ length: row.length / 3 }, (_, index) => row.slice(3 * index, 3 * index + 3));

  /** A robot at a time, link by link, the farthest first; of the original as one translucent shape. */
  function robot(pen, camera, lines, blocks, time, world, isGhost) {
    const links = lines.flatMap((one) => {
      const row = at(one, time);
      const points = row ? pointsOf(row) : [];
      return points.slice(1).map((point, index) => ({ ends: [points[index], point], radii: one.radii.slice(index, index + 2) }));
    });
    if (!links.length) return;
    for (const one of links) {
      one.seen = one.ends.map(camera.project);
      one.middle = times(plus(...one.ends), 0.5);
    }
    links.sort((one, other) => other.seen[0][2] + other.seen[1][2] - one.seen[0][2] - one.seen[1][2]);
    const [light, usual, dark] = isGhost ? [world.ink(), world.ink(), world.ink()] : ["robot-light", "robot", "robot-dark"].map(ink);
    if (isGhost) {
      const layer = h("canvas", { width: pen.canvas.width, height: pen.canvas.height });
      const under = layer.getContext("2d");
      under.setTransform(pen.getTransform());
      links.forEach((one) => link(under, camera, one, [light, usual, dark], null));
      pen.save();
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.globalAlpha = 0.42;
      pen.drawImage(layer, 0, 0);
      pen.restore();
      return;
    }
    links.forEach((one) => { pen.globalAlpha = hidden(camera.eye, one.middle, blocks) ? 0.3 : 1; link(pen, camera, one, [light, usual, dark], world.ink()); });
    pen.globalAlpha = 1;
  }

  /** A link: round at both ends, lit from above; a ring in the colour of its side at the joint where it begins. */
  function link(pen, camera, { seen: [[x, y, near], [x2, y2, far]], radii }, [light, usual, dark], accent) {
    const [r, r2] = [camera.scale * radii[0] / near, camera.scale * radii[1] / far];
    const long = Math.hypot(x2 - x, y2 - y), way = Math.atan2(y2 - y, x2 - x), half = Math.acos(Math.max(-1, Math.min(1, (r - r2) / (long || 1))));
    pen.beginPath();
    if (long <= Math.abs(r - r2)) { const [cx, cy, most] = r > r2 ? [x, y, r] : [x2, y2, r2]; pen.arc(cx, cy, most, 0, 2 * Math.PI); }
    else { pen.arc(x, y, r, way + half, way - half + 2 * Math.PI); pen.arc(x2, y2, r2, way - half, way + half); }
    pen.closePath();
    const side = Math.cos(way) < 0 ? -1 : 1, most = Math.max(r, r2), across = [side * Math.sin(way) * most, -side * Math.cos(way) * most];
    const shade = pen.createLinearGradient(x + across[0], y + across[1], x - across[0], y - across[1]);
    [[0, usual], [0.3, light], [0.62, usual], [1, dark]].forEach(([at, colour]) => shade.addColorStop(at, colour));
    pen.fillStyle = shade;
    pen.fill();
    pen.strokeStyle = dark;
    pen.lineWidth = 0.8;
    pen.stroke();
    if (!accent || r < 3) return;
    pen.strokeStyle = accent;
    pen.lineWidth = Math.max(1.5, 0.28 * r);
    pen.beginPath(); pen.arc(x, y, 0.62 * r, 0, 2 * Math.PI); pen.stroke();
  }

  /** Where a thing is now: its box, or a ring with its z axis. */
  function body(pen, camera, one, world, time, colours, index) {
    const row = at(one, time);
    if (!row) return;
    const colour = world.ink();
    const frame = one.kind === "pose" ? axes(row) : UPRIGHT;
    if (one.size) {
      box(pen, camera, row, times(one.size, 0.5), frame, { fill: index ? colour : colours.paper, alpha: index ? 0.55 : 0.35, edge: colour, edgeAlpha: 1, width: index ? 1.6 : 1.2, dash: index ? null : [3, 2] });
    } else {
      const [x, y, depth] = camera.project(row);
      if (one.kind === "pose") {
        const [x2, y2] = camera.project(plus(row, times(frame[2], 0.05 * depth)));
        pen.strokeStyle = colour;
        pen.lineWidth = 2;
        pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x2, y2); pen.stroke();
      }
      pen.fillStyle = index ? colour : colours.paper;
      pen.strokeStyle = colour;
      pen.lineWidth = 1.8;
      pen.beginPath(); pen.arc(x, y, 4.5 * colours.unit, 0, 2 * Math.PI); pen.fill(); pen.stroke();
    }
    const [x, y] = camera.project(row);
    pen.font = colours.font;
    pen.textAlign = "left";
    const twin = index === 0;
    if (twin) return; // the mutant's label stands for both where they meet
    write(pen, label(one.name), x + 9 * colours.unit, y - 7 * colours.unit, colour, colours);
  }

  /** Where the original of a thing is now, named and joined to the mutant's where the two are apart on the view. */
  function ghost(pen, camera, usual, one, colour, time, colours) {
    const [there, here] = [usual && at(usual, time), at(one, time)];
    if (!there || !here) return;
    const [[x, y], [x2, y2]] = [camera.project(there), camera.project(here)];
    if (Math.hypot(x2 - x, y2 - y) < APART * colours.unit) return;
    pen.strokeStyle = colours.muted;
    pen.lineWidth = 1;
    pen.setLineDash([1, 3]);
    pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x2, y2); pen.stroke();
    pen.setLineDash([]);
    pen.font = colours.small;
    pen.textAlign = "left";
    write(pen, `${label(one.name)}, original`, x + 9 * colours.unit, y + 14 * colours.unit, colour, colours);
  }

  /** The moment of the fault, on the way of the first thing that is tracked. */
  function fault(pen, camera, worlds, things, shown, colours) {
    const world = worlds[worlds.length - 1];
    const when = world.recording.fault;
    const one = things[worlds.length - 1].find((thing) => shown.has(thing.name));
    const row = when !== null && when !== undefined && one ? at(one, when) : null;
    if (!row) return;
    const [x, y] = camera.project(row);
    pen.fillStyle = colours.ink;
    pen.strokeStyle = colours.paper;
    pen.lineWidth = 2;
    pen.beginPath();
    const size = 6.5 * colours.unit;
    pen.moveTo(x, y - size); pen.lineTo(x + size, y); pen.lineTo(x, y + size); pen.lineTo(x - size, y);
    pen.closePath();
    pen.stroke();
    pen.fill();
    pen.font = colours.font;
    const text = `fault ${number(when, 4)} s`, isBeside = x > pen.measureText(text).width + 14 * colours.unit;
    pen.textAlign = isBeside ? "right" : "left";
    write(pen, text, isBeside ? x - 10 * colours.unit : 0, y + (isBeside ? 4 : 20) * colours.unit, colours.ink, colours);
  }

  /** Which way x, y and z go, in the corner. */
  function corner(pen, camera, height, colours) {
    const long = 22 * colours.unit, middle = [1.6 * long, height - 1.6 * long];
    pen.font = colours.small;
    pen.textAlign = "center";
    UPRIGHT.forEach((axis, index) => {
      const x = middle[0] + long * dot(axis, camera.right), y = middle[1] - long * dot(axis, camera.up);
      pen.strokeStyle = colours.muted;
      pen.fillStyle = colours.muted;
      pen.lineWidth = 1.3;
      pen.beginPath(); pen.moveTo(...middle); pen.lineTo(x, y); pen.stroke();
      pen.fillText("xyz"[index], middle[0] + 1.35 * long * dot(axis, camera.right), middle[1] - 1.35 * long * dot(axis, camera.up) + 3 * colours.unit);
    });
  }

  mutabot.scene = scene;
})();
