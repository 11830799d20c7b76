// The rig and the mark under the lamp, on canvas.

const COVER = 0.05; // what shines through where the rod has been all the time
const MOST = 64; // pictures of an exposure

export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// Fit a canvas to its place and the display; return what draws on it, in CSS pixels.
export function prepare(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext('2d');
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}

// Where the pivot is in mid-stroke, and pixels a metre.
export function place(width, height, rig) {
  const reach = rig.length + 2 * rig.amplitude;
  return { x: width / 2, y: 0.72 * height, scale: Math.min((0.62 * height) / reach, (0.47 * width) / reach) };
}

export function drawRig(canvas, rig, colors, store, time, exposure, pulled) {
  const { pen, width, height } = prepare(canvas);
  const { x, y, scale } = place(width, height, rig);
  drawRuler(pen, x, y, (rig.length + rig.amplitude) * scale + 10, colors);
  pen.fillStyle = colors.metal; // body and guard of the jigsaw
  pen.fillRect(x - 46, y + 34, 92, height - y - 34);
  pen.fillRect(x - 70, y + 26, 140, 8);
  pen.fillRect(x - 20, y + 8, 4, 20);
  pen.fillRect(x + 16, y + 8, 4, 20);
  const seen = store.exposure(time - exposure, time, MOST);
  if (!seen.length) return;
  const alpha = 1 - COVER ** (1 / seen.length);
  pen.lineCap = 'round';
  for (const state of seen) drawRod(pen, x, y - state.height * scale, state.angle, rig.length * scale, colors, alpha);
  if (pulled !== null) drawRod(pen, x, y, pulled, rig.length * scale, { rod: colors.accent, metal: colors.accent }, 0.7);
  pen.globalAlpha = 1;
}

function drawRod(pen, x, y, angle, length, colors, alpha) {
  pen.globalAlpha = alpha;
  pen.strokeStyle = colors.metal; // slider
  pen.lineWidth = 8;
  pen.beginPath();
  pen.moveTo(x, y + 6);
  pen.lineTo(x, y + 44);
  pen.stroke();
  pen.strokeStyle = colors.rod;
  pen.lineWidth = 6;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x + length * Math.sin(angle), y - length * Math.cos(angle));
  pen.stroke();
  pen.fillStyle = colors.metal; // bolt
  pen.beginPath();
  pen.arc(x, y, 5, 0, 2 * Math.PI);
  pen.fill();
}

function drawRuler(pen, x, y, radius, colors) {
  pen.strokeStyle = colors.line;
  pen.fillStyle = colors.faint;
  pen.lineWidth = 1;
  pen.font = '11px system-ui, sans-serif';
  pen.textAlign = 'center';
  for (let i = -6; i <= 6; i++) {
    const angle = 0.05 * i;
    const long = i % 2 === 0 ? 10 : 6;
    pen.beginPath();
    pen.moveTo(x + radius * Math.sin(angle), y - radius * Math.cos(angle));
    pen.lineTo(x + (radius + long) * Math.sin(angle), y - (radius + long) * Math.cos(angle));
    pen.stroke();
    if (i % 2 === 0) {
      const text = (radius + 20) * Math.cos(angle);
      pen.fillText(Math.abs(angle).toFixed(1), x + (radius + 20) * Math.sin(angle), y - text + 4);
    }
  }
}

export function drawLamp(canvas, rig, store, time, lit, offText) {
  const { pen, width, height } = prepare(canvas);
  pen.fillStyle = '#08090b';
  pen.fillRect(0, 0, width, height);
  const margin = 18;
  const stroke = height - 2 * margin;
  pen.strokeStyle = '#3a3d44'; // guide of the blade
  pen.lineWidth = 2;
  for (const side of [-1, 1]) {
    pen.beginPath();
    pen.moveTo(width / 2 + side * 40, margin - 8);
    pen.lineTo(width / 2 + side * 40, height - margin + 8);
    pen.stroke();
  }
  if (!lit) {
    pen.fillStyle = '#c9ced6';
    pen.font = '14px system-ui, sans-serif';
    pen.textAlign = 'center';
    pen.fillText(offText, width / 2, height / 2);
    return;
  }
  const heights = store.flashes(time - rig.afterimage, time);
  const alpha = 1 - COVER ** (1 / Math.max(1, heights.length));
  pen.fillStyle = '#ffe9a8';
  pen.globalAlpha = alpha;
  const thick = Math.max(2, rig.mark_width * stroke);
  for (const mark of heights) {
    pen.fillRect(width / 2 - 34, margin + ((1 - mark) / 2) * stroke - thick / 2, 68, thick);
  }
  pen.globalAlpha = 1;
}

// A needle over graduations that move.
export function drawScale(canvas, value, graduation, colors) {
  const { pen, width, height } = prepare(canvas);
  const apart = 12; // px
  const unit = graduation || 10;
  pen.strokeStyle = colors.line;
  pen.fillStyle = colors.faint;
  pen.font = '11px system-ui, sans-serif';
  pen.textAlign = 'center';
  const middle = Math.round(value / unit);
  const reach = Math.ceil(width / 2 / apart) + 1;
  for (let i = middle - reach; i <= middle + reach; i++) {
    if (i < 0) continue;
    const x = width / 2 + (i - value / unit) * apart;
    pen.beginPath();
    pen.moveTo(x, height);
    pen.lineTo(x, height - (i % 5 === 0 ? 14 : 8));
    pen.stroke();
    if (i % 5 === 0) pen.fillText(String(Math.round(i * unit)), x, height - 17);
  }
  pen.strokeStyle = colors.accent;
  pen.lineWidth = 2;
  pen.beginPath();
  pen.moveTo(width / 2, 4);
  pen.lineTo(width / 2, height);
  pen.stroke();
}
