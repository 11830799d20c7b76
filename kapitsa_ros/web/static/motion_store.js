// The motion as it comes in steps, and the simulated time at which it is looked at.

import { Steps, readSteps } from './steps.js';

const KEPT = 320; // steps
const LATE = 0.25; // s of simulated time by which a step may be late before the clock follows it

export class MotionStore extends Steps {
  constructor() {
    super();
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
    for (const step of readSteps(buffer)) {
      if (step.run > this.run) this.forget(step.run);
      if (step.run < this.run) continue;
      this.steps.push(step);
      if (this.steps.length > KEPT) this.steps.shift();
      const offset = step.start - this.pace * wall;
      if (this.offset === null || offset > this.offset || offset < this.offset - LATE) this.offset = offset;
      this.end = step.end;
    }
  }

  // Simulated time, s of the run: it never goes back, and not beyond what is known.
  now(wall) {
    if (this.offset === null) return this.standing || this.pace === 0 ? (this.shown = Math.max(this.shown, this.end)) : this.shown;
    const led = this.pace === 0 || this.standing ? this.end : this.pace * wall + this.offset;
    this.shown = Math.max(this.shown, Math.min(led, this.end));
    return this.shown;
  }
}
