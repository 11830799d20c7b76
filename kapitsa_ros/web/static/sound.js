// The sound of the saw, off until it is asked for: the pitch is that of the shaft as it turns.

const LOUDNESS = 0.05;
const SPAN = 0.2; // s of the motion from which the pitch is heard

export class Saw {
  toggle() {
    if (this.context) {
      this.context.close();
      this.context = null;
      return false;
    }
    this.context = new AudioContext();
    this.tone = new OscillatorNode(this.context, { type: 'sawtooth', frequency: 0 });
    this.gain = new GainNode(this.context, { gain: 0 });
    this.tone.connect(this.gain).connect(this.context.destination);
    this.tone.start();
    return true;
  }

  follow(store, time, rig) {
    if (!this.context) return;
    const heights = store.exposure(time - SPAN, time, 200).map((state) => state.height);
    let crossings = 0;
    for (let i = 1; i < heights.length; i++) if (heights[i - 1] < 0 !== heights[i] < 0) crossings += 1;
    const running = crossings > 1 && !rig.paused;
    this.tone.frequency.setTargetAtTime((crossings / 2 / SPAN) * rig.pace, this.context.currentTime, 0.05);
    this.gain.gain.setTargetAtTime(running ? LOUDNESS : 0, this.context.currentTime, 0.05);
  }
}
