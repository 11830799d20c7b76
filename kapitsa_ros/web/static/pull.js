// The rod, pulled aside by hand and let go.

import { place } from './drawing.js';

const FARTHEST = 1.55; // rad
const REACH = 32; // px from the rod within which it is taken hold of
const PULLED = 4; // px: less is a touch, which lets nothing go

export function bindPull(canvas, ask, bench, seen) {
  let taken = null; // where, px
  const isNear = (event) => {
    const state = seen();
    if (!state) return false;
    const { x, y, scale } = place(canvas.clientWidth, canvas.clientHeight, bench.rig);
    const [right, up] = [Math.sin(state.angle), Math.cos(state.angle)];
    const [dx, dy] = [event.offsetX - x, y - event.offsetY];
    const along = Math.min(Math.max(dx * right + dy * up, 0), bench.rig.length * scale);
    return Math.hypot(dx - along * right, dy - along * up) <= REACH;
  };
  const angleAt = (event) => {
    const { x, y } = place(canvas.clientWidth, canvas.clientHeight, bench.rig);
    const angle = Math.atan2(event.offsetX - x, y - event.offsetY);
    return Math.min(Math.max(angle, -FARTHEST), FARTHEST);
  };
  canvas.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !bench.rig || !bench.rig.works || !isNear(event)) return;
    canvas.setPointerCapture(event.pointerId);
    taken = [event.offsetX, event.offsetY];
  });
  canvas.addEventListener('pointermove', (event) => {
    if (taken === null) return;
    const moved = Math.hypot(event.offsetX - taken[0], event.offsetY - taken[1]);
    if (bench.pulled !== null || moved >= PULLED) bench.pulled = angleAt(event);
  });
  canvas.addEventListener('pointerup', (event) => {
    taken = null;
    if (bench.pulled === null) return;
    const angle = angleAt(event);
    bench.pulled = null;
    ask('angle', Number(angle.toFixed(3)));
    ask('release');
  });
  canvas.addEventListener('pointercancel', () => {
    taken = null;
    bench.pulled = null;
  });
}
