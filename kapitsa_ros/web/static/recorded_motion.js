// A recorded run: its motion is fetched a piece at a time, and looked at in any order.

import { Steps, readSteps } from './steps.js';

const PIECE = 50; // steps
const KEPT = 24; // pieces
const AHEAD = 1.5; // s of wall time for which the motion is there before it is looked at

export class RecordedMotion extends Steps {
  constructor(address, run, fail) {
    super();
    this.address = address;
    this.run = run;
    this.fail = fail;
    this.dial = 0;
    this.pieces = new Map(); // by number: null while it is on its way
    this.time = 0;
    this.pace = 1;
    this.playing = false;
    this.wall = 0;
  }

  turn(dial) {
    this.dial = dial;
    this.pieces.clear(); // those that are shown stay until others are there
    this.fetchAround();
  }

  goTo(time) {
    this.time = Math.min(Math.max(time, 0), this.run.duration);
    this.fetchAround();
  }

  // Simulated time, s of the run, at a wall time; it waits for what is on its way.
  now(wall) {
    const passed = Math.min(wall - this.wall, 0.5);
    this.wall = wall;
    if (this.playing && this.isThere(this.time)) this.goTo(this.time + this.pace * passed);
    return this.time;
  }

  get ended() {
    return this.time >= this.run.duration;
  }

  isThere(time) {
    return Boolean(this.pieces.get(this.pieceOf(time)));
  }

  // Whether the bag lacks the step of a time.
  isMissing(time) {
    return this.isThere(time) && !this.covers(time);
  }

  // Whether the step of a time is still on its way.
  isComing(time) {
    return !this.isThere(time) && !this.covers(time);
  }

  pieceOf(time) {
    return Math.floor(Math.min(time, this.run.duration - 1e-6) / this.run.step / PIECE);
  }

  fetchAround() {
    if (!this.run.step) return;
    const first = this.pieceOf(Math.max(0, this.time - 6)); // what the curve of the angle shows
    const last = this.pieceOf(Math.min(this.run.duration, this.time + Math.max(2, AHEAD * this.pace)));
    const here = this.pieceOf(this.time);
    const order = [here];
    for (let number = here + 1; number <= last; number++) order.push(number);
    for (let number = here - 1; number >= first; number--) order.push(number);
    for (const number of order) if (!this.pieces.has(number)) this.fetchPiece(number);
  }

  async fetchPiece(number) {
    const { dial } = this;
    this.pieces.set(number, null);
    try {
      const answer = await fetch(this.address({ run: this.run.place, from: number * PIECE, count: PIECE, dial }));
      if (!answer.ok) throw new Error(await answer.text());
      const steps = readSteps(await answer.arrayBuffer());
      if (dial !== this.dial) return;
      this.pieces.set(number, steps);
      this.forgetFarthest();
      const numbers = [...this.pieces.keys()].sort((a, b) => a - b);
      this.steps = numbers.flatMap((each) => this.pieces.get(each) || []);
    } catch (error) {
      if (dial === this.dial) setTimeout(() => this.pieces.delete(number) && this.fetchAround(), 1000);
      this.fail(String(error.message));
    }
  }

  forgetFarthest() {
    const here = this.pieceOf(this.time);
    while (this.pieces.size > KEPT) {
      const [farthest] = [...this.pieces.keys()].sort((a, b) => Math.abs(b - here) - Math.abs(a - here));
      this.pieces.delete(farthest);
    }
  }
}
