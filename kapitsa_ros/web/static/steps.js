// The motion in steps, as the server sends it, and what is seen of it.

const HEADER = 28; // bytes
const SPREAD = 0.618034; // whose multiples are spread evenly between whole numbers
const EDGE = 1e-6; // s by which steps that follow one another may seem apart

// The steps in a buffer, one after the other.
export function readSteps(buffer) {
  const view = new DataView(buffer);
  const found = [];
  for (let at = 0; at < buffer.byteLength;) {
    const run = view.getUint32(at, true);
    const samples = view.getUint32(at + 4, true);
    const start = view.getFloat64(at + 8, true);
    const period = view.getFloat64(at + 16, true);
    const flashes = view.getUint32(at + 24, true);
    const floats = (from, count) => {
      const values = new Float32Array(count);
      for (let i = 0; i < count; i++) values[i] = view.getFloat32(at + HEADER + 4 * (from + i), true);
      return values;
    };
    found.push({
      run, start, end: start + period * (samples - 1), period,
      angle: floats(0, samples), height: floats(samples, samples),
      times: floats(2 * samples, flashes), marks: floats(2 * samples + flashes, flashes),
    });
    at += HEADER + 4 * (2 * samples + 2 * flashes);
  }
  return found;
}

// Steps in the order of their times.
export class Steps {
  steps = [];

  // The last step that has begun at a time, or the first one; null where there is none.
  stepAt(time) {
    let low = 0;
    let high = this.steps.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.steps[middle].start > time) high = middle;
      else low = middle;
    }
    return this.steps[low] || null;
  }

  // Whether a time lies in one of the steps.
  covers(time) {
    const step = this.stepAt(time);
    return Boolean(step) && step.start <= time + EDGE && step.end >= time - EDGE;
  }

  // Angle (rad) and height (m) at a time; null where no step has it.
  at(time) {
    if (!this.covers(time)) return null;
    const step = this.stepAt(time);
    const place = Math.min(Math.max((time - step.start) / step.period, 0), step.angle.length - 1);
    const before = Math.min(Math.floor(place), step.angle.length - 2);
    const part = place - before;
    const between = (values) => values[before] + part * (values[before + 1] - values[before]);
    return { angle: between(step.angle), height: between(step.height) };
  }

  // What an exposure shows, at the rate of the samples; where these are too many, at `most` times in as many equal
  // parts, within a part at any: equally far apart, a shaft that turns once or twice in a part would seem to stand.
  exposure(from, to, most) {
    const period = this.steps.length ? this.steps[0].period : 0.001;
    const all = Math.max(1, Math.round((to - from) / period));
    const count = Math.min(most, all);
    const seen = [];
    for (let i = 1; i <= count; i++) {
      const place = all > most ? i - ((i * SPREAD) % 1) : i;
      const state = this.at(from + ((to - from) * place) / count);
      if (state) seen.push(state);
    }
    return seen;
  }

  // Heights of the mark at the flashes of an interval, in amplitudes.
  flashes(from, to) {
    const seen = [];
    for (const step of this.steps) {
      if (step.end < from || step.start > to) continue;
      step.times.forEach((time, i) => {
        if (step.start + time > from && step.start + time <= to) seen.push(step.marks[i]);
      });
    }
    return seen;
  }
}
