// The rod, pulled aside by hand and let go.

import { place } from './drawing.js';

const FARTHEST = 1.55; // rad

export function bindPull(canvas, ask, bench) {
  const angleAt = (event) => {
    const { x, y } = place(canvas.clientWidth, canvas.clientHeight, bench.rig);
    const angle = Math.atan2(event.offsetX - x, y - event.offsetY);
    return Math.min(Math.max(angle, -FARTHEST), FARTHEST);
  };
  canvas.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !bench.rig || !bench.rig.works) return;
    canvas.setPointerCapture(event.pointerId);
    bench.pulled = angleAt(event);
  });
  canvas.addEventListener('pointermove', (event) => {
    if (bench.pulled !== null) bench.pulled = angleAt(event);
  });
  canvas.addEventListener('pointerup', (event) => {
    if (bench.pulled === null) return;
    const angle = angleAt(event);
    bench.pulled = null;
    ask('angle', Number(angle.toFixed(3)));
    ask('release');
  });
  canvas.addEventListener('pointercancel', () => {
    bench.pulled = null;
  });
}
