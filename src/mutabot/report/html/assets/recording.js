/* Recordings: from the few numbers of the data to where everything was at any moment. */
"use strict";
(() => {
  function summed(differences) {
    const found = new Array(differences.length);
    let now = 0;
    for (let index = 0; index < differences.length; index += 1) { now += differences[index]; found[index] = now; }
    return found;
  }

  /** A track with times in s and rows of numbers. */
  function track(data) {
    const times = summed(data.t).map((time) => time / 1000);
    const channels = data.v.map((one, axis) => summed(one).map((value) => value * data.scales[axis]));
    const rows = times.map((_, index) => channels.map((one) => one[index]));
    const gaps = (data.gaps || []).map(([from, to]) => [from / 1000, to / 1000]);
    return { name: data.name, kind: data.kind, unit: data.unit, size: data.size, radii: data.radii, times, rows, gaps };
  }

  function recording(data) {
    const tracks = new Map(data.tracks.map((one) => [one.name, track(one)]));
    return { ...data, tracks, calls: data.calls.map(call) };
  }
  const call = ([began, ended, operation, place, pattern, written, read, role]) => ({ began, ended, operation, place, pattern, written, read, role });

  /** Where a track was at a time: between two rows, on the line between them. Null where it was not there. */
  function at(one, time) {
    const { times, rows } = one;
    if (!times.length || one.gaps.some(([from, to]) => time >= from && time < to)) return null;
    let low = 0;
    let high = times.length - 1;
    if (time <= times[0]) return rows[0];
    if (time >= times[high]) return rows[high];
    while (high - low > 1) { const middle = (low + high) >> 1; if (times[middle] <= time) low = middle; else high = middle; }
    const span = times[high] - times[low];
    const share = span > 0 ? (time - times[low]) / span : 0;
    const row = rows[low].map((value, axis) => value + share * (rows[high][axis] - value));
    if (one.kind === "pose") {
      const size = Math.hypot(row[3], row[4], row[5], row[6]) || 1;
      for (let axis = 3; axis < 7; axis += 1) row[axis] /= size;
    }
    return row;
  }

  /** What quaternions turn the axes to: three columns. */
  function axes([, , , w, x, y, z]) {
    return [
      [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
      [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
      [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ];
  }
  /** The angle between two orientations, deg. */
  function turned(one, other) {
    const dot = Math.abs(one[3] * other[3] + one[4] * other[4] + one[5] * other[5] + one[6] * other[6]);
    return (360 / Math.PI) * Math.acos(Math.min(1, dot));
  }

  /** The moment that all drawings of a page show. */
  class Clock {
    constructor(end, time) { this.end = end; this.time = time; this.listeners = []; }
    on(listener) { this.listeners.push(listener); listener(this.time); }
    set(time) { this.time = Math.min(this.end, Math.max(0, time)); for (const listener of this.listeners) listener(this.time); }
  }

  /** A command's pattern as texts name it, without format specifications. */
  const command = (pattern) => pattern.replace(/:[^{}]*}/g, "}");

  Object.assign(mutabot, { command, recordings: { recording, at, axes, turned, Clock } });
})();
