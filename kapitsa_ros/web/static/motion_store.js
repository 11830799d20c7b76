// The motion as it comes in steps, and the simulated time at which it is looked at.

const KEPT = 320; // steps
const LATE = 0.25; // s of simulated time by which a step may be late before the clock follows it
const HEADER = 28; // bytes

export class MotionStore {
  constructor() {
    this.pace = 1;
    this.standing = false;
    this.forget(0);
  }

  forget(run) {
    this.run = run;
    this.steps = [];
    this.end = 0;
    this.shown = 0;
    this.offset = null;
  }

  setPace(pace, standing) {
    if (pace !== this.pace || standing !== this.standing) this.offset = null;
    this.pace = pace;
    this.standing = standing;
  }

  add(buffer, wall) {
    const view = new DataView(buffer);
    const run = view.getUint32(0, true);
    const samples = view.getUint32(4, true);
    const start = view.getFloat64(8, true);
    const period = view.getFloat64(16, true);
    const flashes = view.getUint32(24, true);
    const floats = (from, count) => {
      const values = new Float32Array(count);
      for (let i = 0; i < count; i++) values[i] = view.getFloat32(HEADER + 4 * (from + i), true);
      return values;
    };
    if (run > this.run) this.forget(run);
    if (run < this.run) return;
    const end = start + period * (samples - 1);
    this.steps.push({
      start, end, period,
      angle: floats(0, samples), height: floats(samples, samples),
      times: floats(2 * samples, flashes), marks: floats(2 * samples + flashes, flashes),
    });
    if (this.steps.length > KEPT) this.steps.shift();
    const offset = start - this.pace * wall;
    if (this.offset === null || offset > this.offset || offset < this.offset - LATE) this.offset = offset;
    this.end = end;
  }

  // Simulated time, s of the run: it never goes back, and not beyond what is known.
  now(wall) {
    if (this.offset === null) return this.standing || this.pace === 0 ? (this.shown = Math.max(this.shown, this.end)) : this.shown;
    const led = this.pace === 0 || this.standing ? this.end : this.pace * wall + this.offset;
    this.shown = Math.max(this.shown, Math.min(led, this.end));
    return this.shown;
  }

  // Angle (rad) and height (m) at a time; null before anything is known.
  at(time) {
    for (let i = this.steps.length - 1; i >= 0; i--) {
      const step = this.steps[i];
      if (step.start > time && i > 0) continue;
      const place = Math.min(Math.max((time - step.start) / step.period, 0), step.angle.length - 1);
      const before = Math.min(Math.floor(place), step.angle.length - 2);
      const part = place - before;
      const between = (values) => values[before] + part * (values[before + 1] - values[before]);
      return { angle: between(step.angle), height: between(step.height) };
    }
    return null;
  }

  // What an exposure shows, at the rate of the samples or at most `most` times.
  exposure(from, to, most) {
    const period = this.steps.length ? this.steps[0].period : 0.001;
    const count = Math.min(most, Math.max(1, Math.round((to - from) / period)));
    const seen = [];
    for (let i = 1; i <= count; i++) {
      const state = this.at(from + ((to - from) * i) / count);
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
